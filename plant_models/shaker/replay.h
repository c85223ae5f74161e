/* Recorded samples as a smooth motion: the twin of replay.py. Allocates while preparing. */
#ifndef REPLAY_H
#define REPLAY_H

#include "interface.h"

#include <stddef.h>

/* A recorded motion at its knots: s, m, m/s, m/s2. */
typedef struct {
    size_t count;
    double *times, *displacements, *velocities, *accelerations;
    double *memory;                                       /* of all of them, NULL for none */
    char message[1024];                                   /* what is wrong with the file */
} replay_curve;

/* Make a motion of a file; corner frequency in Hz, fade in s. Returns NULL, or what is wrong, in the curve's message;
 * then it holds no memory. */
const char *replay_load(const char *path, double high_pass, double fade, replay_curve *curve);

/* Free a curve's memory, if there is any. */
void replay_free(replay_curve *curve);

/* Evaluate the motion at a time in s. */
void replay_motion(const replay_curve *curve, double time, shaker_outputs *floor);

#endif
