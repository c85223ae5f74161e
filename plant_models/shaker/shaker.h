/* The shaker in C99: the twin of shaker.py. No globals, no recursion; memory and files in preparing a recording only. */
#ifndef SHAKER_H
#define SHAKER_H

#include "interface.h"
#include "noise.h"
#include "platform.h"
#include "replay.h"

#include <stdint.h>

/* All of it at the begin of a tick. */
typedef struct {
    double tick;                                          /* number, from time 0 */
    double modes[2 * NOISE_MODES];                        /* real and imaginary parts */
    double platform_displacement, platform_velocity;      /* in m, m/s */
    double platform_acceleration;                         /* in m/s2, over the tick */
} shaker_state;

typedef struct {
    shaker_parameters parameters;
    int ticking;                                          /* whether there is noise or a platform */
    uint64_t stream;                                      /* of random numbers */
    noise_coefficients noise;
    replay_curve curve;
    platform_coefficients platform;
} shaker_coefficients;

/* Derive the coefficients; a recording's memory is theirs until they are released. Returns NULL, or what is wrong with the
 * parameters in terms of their names or with the recording; then there is nothing to release. */
const char *shaker_prepare(const shaker_parameters *parameters, shaker_coefficients *coefficients);

/* Free the memory of coefficients, prepared or all zero. */
void shaker_release(shaker_coefficients *coefficients);

/* Nothing to think about: NULL. */
const char *shaker_warning(const shaker_parameters *parameters);

/* Whether the state can be one of a run that has reached a time, in s: noise and platform are at its tick. */
int shaker_is_valid_state(const shaker_state *state, const shaker_parameters *parameters, double time);

/* Evaluate the floor at the start time, in s; noise and platform are at rest until the first tick. */
void shaker_initial(shaker_state *state, const shaker_inputs *inputs, const shaker_coefficients *coefficients,
                    double time, shaker_outputs *outputs);

/* Move the floor to time + step_size, both in s. */
void shaker_advance(shaker_state *state, const shaker_inputs *inputs, const shaker_coefficients *coefficients,
                    double time, double step_size, shaker_outputs *outputs);

#endif
