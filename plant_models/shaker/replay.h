/* Recorded samples as a smooth motion, the C twin of replay.py. Allocates memory in replay_load only. */
#ifndef REPLAY_H
#define REPLAY_H

#include "interface.h"

#include <stddef.h>

/* Motion at the knots; between them the acceleration is linear. */
typedef struct {
    size_t count;
    double *times;                                      /* in s, rising from 0 */
    double *displacements, *velocities, *accelerations; /* in m, m/s, m/s2 */
    double *memory;                                     /* holds all four arrays, NULL where there are none */
    char message[1024];                                 /* what is wrong with the file */
} replay_spline;

/* Read a recording and make a motion of it: corner frequency of the high-pass in Hz, 0 for none; duration of the fades
 * in s. Returns NULL, or what is wrong, in the message of the spline; then it holds no memory. */
const char *replay_load(const char *path, double high_pass, double fade, replay_spline *spline);

/* Free the memory of a spline, if there is any. */
void replay_free(replay_spline *spline);

/* Evaluate the motion at a time since the begin of the recording in s. */
void replay_motion(const replay_spline *spline, double time, shaker_outputs *floor);

#endif
