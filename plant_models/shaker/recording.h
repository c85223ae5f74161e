/* Recorded motion, the samples of a CSV file: the twin of recording.py. Allocates, reads a file; keeps neither. */
#ifndef RECORDING_H
#define RECORDING_H

#include <stddef.h>

enum { RECORDING_FEWEST_ROWS = 10 };

typedef struct {
    int of_acceleration;    /* values in m/s2, else in m */
    size_t count;
    double *times, *values; /* times in s, rising from 0 */
} recording_samples;

/* Read a recording. Returns NULL, or what is wrong in a message of that size; then there are no samples. */
const char *recording_read(const char *path, recording_samples *samples, char *message, size_t size);

/* Free the samples. */
void recording_free(recording_samples *samples);

#endif
