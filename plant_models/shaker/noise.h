/* Random floor motion of the ISO 7096 classes, the C twin of noise.py. Times in s. */
#ifndef NOISE_H
#define NOISE_H

#include "interface.h"

#include <stdint.h>

/* Number of pole pairs in EM7, which has the most. */
enum { NOISE_MAX_MODES = 8 };

typedef struct {
    double re, im;
} noise_complex;

/* One mode of the noise filter: pole p in rad/s, exp(p tick), (exp(p tick) - 1)/p, factors on the state in the three
 * output signals. */
typedef struct {
    noise_complex pole, transition, input_gain;
    noise_complex displacement, velocity, acceleration;
} noise_mode;

typedef struct {
    int count;
    noise_mode modes[NOISE_MAX_MODES];
} noise_coefficients;

/* Derive the modes of a class, 1 for EM1; the noise is held over ticks of this length. */
void noise_prepare(int random_class, double scale, double tick, noise_coefficients *coefficients);

/* Advance the modes, real and imaginary part of each, over the tick of a number. */
void noise_advance(double state[], const noise_coefficients *coefficients, uint64_t stream, double tick);

/* Evaluate the motion within the tick of a number, at a time since its begin. */
void noise_motion(const double state[], const noise_coefficients *coefficients, uint64_t stream, double tick,
                  double elapsed, shaker_outputs *floor);

#endif
