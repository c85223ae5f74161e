/* A platform that follows a profile with a lag and limits: the twin of platform.py. */
#ifndef PLATFORM_H
#define PLATFORM_H

#include "interface.h"

typedef struct {
    int present;
    double stiffness, damping;                            /* omega^2 in 1/s2, 2 zeta omega in 1/s */
    double tick;                                          /* in s */
    double stroke, velocity_limit, acceleration_limit;    /* in m, m/s, m/s2; infinite where there is none */
    double braking;                                       /* deceleration before the end of the stroke, in m/s2 */
} platform_coefficients;

/* Derive the coefficients for ticks of a length in s. Returns NULL, or what is wrong with the parameters. */
const char *platform_prepare(const shaker_parameters *parameters, double tick, platform_coefficients *coefficients);

/* The acceleration over a tick in m/s2, from platform (m, m/s) and profile at its begin. */
double platform_acceleration(double displacement, double velocity, const shaker_outputs *command,
                             const platform_coefficients *coefficients);

#endif
