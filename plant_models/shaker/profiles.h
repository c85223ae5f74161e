/* Profiles that are functions of time, the C twin of profiles.py. Times in s. */
#ifndef PROFILES_H
#define PROFILES_H

#include "interface.h"

/* Evaluate the bump (34): a in m, l in m, v_0 in m/s. The acceleration is its right limit at both ends. */
void profile_bump(double time, double height, double length, double speed, shaker_outputs *floor);

/* Evaluate z_v = A sin(2 pi f t): f in Hz, A in m. */
void profile_sine(double time, double frequency, double amplitude, shaker_outputs *floor);

/* Evaluate the logarithmic sweep; it is at rest before 0 and after its duration. */
void profile_sweep(double time, const shaker_parameters *parameters, shaker_outputs *floor);

/* Evaluate a window that fades in from time 0 and out to the duration: value, slope in 1/s, curvature in 1/s2. */
void profile_envelope(double time, double duration, double fade, double envelope[3]);

#endif
