/* Low-pass, noise, bias and resolution of the sensors, the C twin of sensors.py. */
#ifndef SENSORS_H
#define SENSORS_H

#include <stdint.h>

/* Errors that a sensor adds to its signal, in the unit of the signal. */
typedef struct {
    double noise;      /* RMS */
    double bias;       /* offset */
    double resolution; /* smallest step, 0 for none */
    uint64_t stream;   /* of random numbers */
    int ideal;         /* whether there are no errors */
} sensor_coefficients;

/* Derive the coefficients; sensors of different numbers have independent noise. */
sensor_coefficients sensor_prepare(double noise, double bias, double resolution, int seed, uint32_t number);

/* Add noise and bias to a signal at a time in s and round it to the resolution. */
double sensor_add_errors(double value, const sensor_coefficients *c, double time);

/* Return the measurement of a signal that has passed its low-pass, at a time in s. */
static inline double sensor_measure(double value, const sensor_coefficients *c, double time)
{
    return c->ideal ? value : sensor_add_errors(value, c, time);
}

/* Advance a first-order low-pass over a substep: the signal at both ends, linear in between; the angle is the corner
 * frequency in rad/s times the length of the substep in s. */
double sensor_low_pass(double filtered, double begin, double end, double angle);

#endif
