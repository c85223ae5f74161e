/* A smooth step, with which signals fade in and out, the C twin of smooth_step.py. */
#ifndef SMOOTH_STEP_H
#define SMOOTH_STEP_H

/* Evaluate a smooth step from 0 at x = 0 to 1 at x = 1, without slope and curvature at both ends: value, slope,
 * curvature. */
void smooth_step(double x, double step[3]);

#endif
