/* Low-pass, noise, bias and resolution of the sensors: the twin of sensors.py. */
#ifndef SENSORS_H
#define SENSORS_H

#include <stdint.h>

/* What a sensor does to its signal, and its stream of random numbers. */
typedef struct {
    double noise, bias, resolution;
    uint64_t stream;
    int ideal; /* whether it does nothing */
} sensor_coefficients;

/* Add noise and bias to a signal at a time in s, and round it. */
double sensor_spoiled(double value, const sensor_coefficients *sensor, double time);

/* What a sensor reports of a signal that has passed its low-pass, at a time in s. */
static inline double sensor_reading(double value, const sensor_coefficients *sensor, double time)
{
    return sensor->ideal ? value : sensor_spoiled(value, sensor, time);
}

/* Move a first-order low-pass over a substep: the signal at both ends, corner in rad/s times length. */
double sensor_low_passed(double filtered, double begin, double end, double angle);

#endif
