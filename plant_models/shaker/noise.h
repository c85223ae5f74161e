/* Random floor motion of the ISO 7096 classes: the twin of noise.py. Times in s. */
#ifndef NOISE_H
#define NOISE_H

#include "interface.h"

#include <stdint.h>

enum { NOISE_MODES = 8 };

typedef struct {
    double re, im;
} noise_complex;

/* One pole in rad/s, what a tick does to its state, and its share in the three signals. */
typedef struct {
    noise_complex pole, growth, push;
    noise_complex displacement, velocity, acceleration;
} noise_mode;

typedef struct {
    int count;
    noise_mode modes[NOISE_MODES];
} noise_coefficients;

/* Derive the modes of a class, from 1 for EM1; noise is held over ticks. */
void noise_prepare(int chosen, double scale, double tick, noise_coefficients *coefficients);

/* Move the modes, real and imaginary part of each, over the tick of a number. */
void noise_advance(double state[], const noise_coefficients *coefficients, uint64_t stream, double tick);

/* Evaluate the motion within a tick, some time after its begin. */
void noise_motion(const double state[], const noise_coefficients *coefficients, uint64_t stream, double tick,
                  double since, shaker_outputs *floor);

#endif
