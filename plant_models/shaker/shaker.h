/* The shaker, the C twin of shaker.py. No globals, no recursion; memory and files only while a recording is prepared.
 * Up is positive, times are in s. */
#ifndef SHAKER_H
#define SHAKER_H

#include "interface.h"
#include "noise.h"
#include "platform.h"
#include "replay.h"

#include <stdint.h>

/* State at the begin of a tick. */
typedef struct {
    double tick;                                     /* number, from time 0 */
    double modes[2 * NOISE_MAX_MODES];               /* real and imaginary parts */
    double platform_displacement, platform_velocity; /* in m, m/s */
    double platform_acceleration;                    /* in m/s2, over the tick */
} shaker_state;

typedef struct {
    shaker_parameters parameters; /* of the profile */
    int has_ticks;                /* whether there is noise or a platform with a lag */
    uint64_t stream;              /* of random numbers */
    noise_coefficients noise;
    replay_spline spline;
    platform_coefficients platform;
} shaker_coefficients;

/* Derive the coefficients; they own the memory of a recording until they are released. Returns NULL, or a message about
 * the parameters in terms of their names or about the recording; then there is nothing to release. */
const char *shaker_prepare(const shaker_parameters *parameters, shaker_coefficients *coefficients);

/* Free the memory of coefficients that are prepared or all zero. */
void shaker_release(shaker_coefficients *coefficients);

/* Return a warning about legal parameters: always NULL. */
const char *shaker_warning(const shaker_parameters *parameters);

/* Check that a run that has reached a time can have a state: its tick is near that time. */
int shaker_is_valid_state(const shaker_state *state, const shaker_parameters *parameters, double time);

/* Set the state at the start time; noise and platform are at rest until the first tick. */
void shaker_initialize(shaker_state *state, const shaker_inputs *inputs, const shaker_coefficients *coefficients,
                       double time, shaker_outputs *outputs);

/* Advance the motion of the floor to time + step_size. */
void shaker_advance(shaker_state *state, const shaker_inputs *inputs, const shaker_coefficients *coefficients,
                    double time, double step_size, shaker_outputs *outputs);

#endif
