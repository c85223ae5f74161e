/* Recorded samples as a smooth motion: the twin of replay.py. Allocates while preparing. */
#ifndef REPLAY_H
#define REPLAY_H

#include "shaker.h"

/* Make a motion of a file; corner frequency in Hz, fade in s. Returns NULL, or what is wrong, in the curve's message;
 * then it holds no memory. */
const char *replay_load(const char *path, double high_pass, double fade, replay_curve *curve);

/* Free a curve's memory, if there is any. */
void replay_free(replay_curve *curve);

/* Evaluate the motion at a time in s. */
void replay_motion(const replay_curve *curve, double time, shaker_outputs *floor);

#endif
