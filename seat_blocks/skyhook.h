/* The law of a variable damper, the C twin of skyhook.py. Times in s, up positive. */
#ifndef SKYHOOK_H
#define SKYHOOK_H

#include "seat_blocks_interface.h"

#include <stdbool.h>

/* State of the law after a sample. */
typedef struct {
    double next_sample;              /* number k of the next sample, due at k h */
    bool started;                    /* whether a sample was taken */
    double acceleration, deflection; /* a in m/s2 and delta in m of the last sample */
    double velocity, rate;           /* w and v of the last sample, in m/s */
    double damping;                  /* c of the last sample, in N.s/m */
} skyhook_state;

/* Factors of the law. */
typedef struct {
    double c_min, c_max, c_sky;   /* in N.s/m */
    double half_step;             /* h/2 in s */
    double leak;                  /* 1 + 2 pi f_l h */
    double rate_decay, rate_gain; /* of the rate filter, the second in 1/s */
    double sample_time;           /* h in s */
} skyhook_coefficients;

/* Derive the factors of the law. */
skyhook_coefficients skyhook_prepare(const damper_parameters *parameters, double sample_time);

/* Set the state before the first sample, with an open damper. */
void skyhook_start(skyhook_state *state, const skyhook_coefficients *c, double time);

/* Take every sample due in [time, time + duration), all with the same measurements in m/s2 and m. */
void skyhook_advance(skyhook_state *state, double acceleration, double deflection, const skyhook_coefficients *c,
                     double time, double duration);

/* Check that a run that has reached a time can have a state. */
int skyhook_is_valid_state(const skyhook_state *state, double sample_time, double time);

#endif
