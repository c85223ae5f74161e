/* Recorded motion in CSV files, the C twin of recording.py. Allocates memory and reads a file while it is called. */
#ifndef RECORDING_H
#define RECORDING_H

#include <stddef.h>

/* Smallest number of rows. */
enum { RECORDING_MIN_ROWS = 10 };

typedef struct {
    int is_acceleration; /* values in m/s2, otherwise displacements in m */
    size_t count;
    double *times, *values; /* times in s, rising from 0 */
} recording_samples;

/* Read a recording. Returns NULL, or what is wrong in `message`, which has room for `size` bytes; then there are no
 * samples. */
const char *recording_read(const char *path, recording_samples *samples, char *message, size_t size);

/* Free the samples. */
void recording_free(recording_samples *samples);

#endif
