/* Random floor motion of the ISO 7096 classes: the twin of noise.py. Times in s. */
#ifndef NOISE_H
#define NOISE_H

#include "shaker.h"

/* Derive the modes of a class, from 1 for EM1; noise is held over ticks. */
void noise_prepare(int chosen, double scale, double tick, noise_coefficients *coefficients);

/* Move the modes, real and imaginary part of each, over the tick of a number. */
void noise_advance(double state[], const noise_coefficients *coefficients, uint64_t stream, double tick);

/* Evaluate the motion within a tick, some time after its begin. */
void noise_motion(const double state[], const noise_coefficients *coefficients, uint64_t stream, double tick,
                  double since, shaker_outputs *floor);

#endif
