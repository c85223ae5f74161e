/* Profiles that are functions of time: the twin of profiles.py. Times in s. */
#ifndef PROFILES_H
#define PROFILES_H

#include "interface.h"

/* The bump (34): a in m, l in m, v_0 in m/s; right limits. */
void profile_bump(double time, double height, double length, double speed, shaker_outputs *floor);

/* z_v = A sin(2 pi f t), f in Hz, A in m. */
void profile_sine(double time, double frequency, double amplitude, shaker_outputs *floor);

/* The logarithmic sweep; at rest before 0 and after its duration. */
void profile_sweep(double time, const shaker_parameters *parameters, shaker_outputs *floor);

/* Fade in from 0 and out to the duration: value, first and second derivative. */
void profile_envelope(double time, double duration, double fade, double envelope[3]);

#endif
