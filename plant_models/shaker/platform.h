/* The platform: second-order lag with limits of stroke, velocity and acceleration, the C twin of platform.py. */
#ifndef PLATFORM_H
#define PLATFORM_H

#include "interface.h"

typedef struct {
    int has_lag;               /* otherwise the floor is the profile and the rest is not set */
    double stiffness, damping; /* omega^2 in 1/s2, 2 zeta omega in 1/s */
    double tick;               /* hold time of the acceleration in s */
    double stroke;             /* at the ends of ticks, in m; infinite where there is no limit, as below */
    double velocity_limit;     /* in m/s */
    double acceleration_limit; /* in m/s2 */
    double braking;            /* deceleration before the end of the stroke in m/s2 */
} platform_coefficients;

/* Derive the coefficients for ticks of a length in s. Returns NULL, or a message about the parameters. */
const char *platform_prepare(const shaker_parameters *parameters, double tick, platform_coefficients *coefficients);

/* Return the acceleration in m/s2 over a tick, from the platform (m, m/s) and the profile at its begin. */
double platform_acceleration(double displacement, double velocity, const shaker_outputs *command,
                             const platform_coefficients *coefficients);

#endif
