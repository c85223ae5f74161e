/* Recorded signals in CSV files, the C twin of recording.py. Allocates memory and reads a file while it is called. */
#ifndef RECORDING_H
#define RECORDING_H

#include <stddef.h>

/* Smallest number of rows. */
enum { RECORDING_MIN_ROWS = 10 };

/* Columns that a file must have: the one that rises with its unit, and those of which there must be exactly one. The
 * second quantity is NULL where there is only one. */
typedef struct {
    const char *axis, *unit;
    const char *quantities[2];
} recording_columns;

typedef struct {
    int quantity; /* index in the quantities of the columns */
    size_t count;
    double *axis, *values; /* times in s or distances in m, rising from 0 */
} recording_samples;

/* Read a recording. Returns NULL, or what is wrong in `message`, which has room for `size` bytes; then there are no
 * samples. */
const char *recording_read(const char *path, const recording_columns *columns, recording_samples *samples,
                           char *message, size_t size);

/* Free the samples. */
void recording_free(recording_samples *samples);

#endif
