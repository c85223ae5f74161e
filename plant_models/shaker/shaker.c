/* The motion of the cabin floor: a profile, and a platform that may follow it; see shaker.py. */
#include "shaker.h"

#include "profiles.h"
#include "random_numbers.h"
#include "subnormal.h"

#include <math.h>
#include <stddef.h>

/* Hold time of the noise and of the acceleration of the platform in s. */
static const double tick_length = 0.002;

/* Largest distance of a tick from the time that a run has reached, in s; allows for rounding errors of hosts. */
static const double clock_tolerance = 1.0;

typedef shaker_coefficients coefficients_t;

/* Whether there is noise or a platform with a lag. */
static int has_ticks(const shaker_parameters *p)
{
    return p->profile == SHAKER_RANDOM || p->platform_bandwidth > 0.0;
}

const char *shaker_prepare(const shaker_parameters *parameters, shaker_coefficients *coefficients)
{
    const shaker_parameters *p = parameters;
    coefficients_t *c = coefficients;
    if (p->profile == SHAKER_SWEEP && 2.0 * p->sweep_fade > p->sweep_duration) {
        return "expected sweep.fade up to half the sweep.duration";
    }
    c->spline.memory = NULL;
    c->parameters = *p;
    c->parameters.file_path = NULL; /* the caller's */
    c->stream = random_stream((uint32_t)p->random_seed, 0);
    if (p->profile == SHAKER_RANDOM) {
        noise_prepare(p->random_class, p->random_scale, tick_length, &c->noise);
    }
    const char *problem = platform_prepare(p, tick_length, &c->platform);
    c->has_ticks = has_ticks(p);
    if (problem == NULL && p->profile == SHAKER_FILE) {
        problem = replay_load(p->file_path, p->file_high_pass, p->file_fade, &c->spline);
    }
    return problem;
}

void shaker_release(shaker_coefficients *coefficients)
{
    replay_free(&coefficients->spline);
}

const char *shaker_warning(const shaker_parameters *parameters)
{
    (void)parameters;
    return NULL;
}

/* Evaluate a profile that is a function of time. */
static void evaluate_profile(double time, const coefficients_t *c, shaker_outputs *floor)
{
    const shaker_parameters *p = &c->parameters;
    switch (p->profile) {
    case SHAKER_SINE:
        profile_sine(time, p->sine_frequency, p->sine_amplitude, floor);
        break;
    case SHAKER_SWEEP:
        profile_sweep(time, p, floor);
        break;
    case SHAKER_FILE:
        replay_motion(&c->spline, time, floor);
        break;
    default:
        profile_bump(time, p->bump_height, p->bump_length, p->bump_speed, floor);
    }
}

/* Set the acceleration of the platform over the tick, from the profile at its begin. */
static void accelerate_platform(shaker_state *state, const coefficients_t *c)
{
    shaker_outputs command;
    if (!c->platform.has_lag) {
        return;
    }
    if (c->parameters.profile == SHAKER_RANDOM) {
        noise_motion(state->modes, &c->noise, c->stream, state->tick, 0.0, &command);
    } else {
        evaluate_profile(state->tick * tick_length, c, &command);
    }
    state->platform_acceleration =
        platform_acceleration(state->platform_displacement, state->platform_velocity, &command, &c->platform);
}

/* Evaluate the motion of the platform at a time since the begin of the tick. */
static void platform_motion(const shaker_state *state, double elapsed, shaker_outputs *floor)
{
    const double velocity = state->platform_velocity, acceleration = state->platform_acceleration;
    floor->floor_displacement = state->platform_displacement + elapsed * (velocity + 0.5 * elapsed * acceleration);
    floor->floor_velocity = velocity + elapsed * acceleration;
    floor->floor_acceleration = acceleration;
}

/* Advance to the next tick. */
static void advance_tick(shaker_state *state, const coefficients_t *c)
{
    shaker_outputs end;
    platform_motion(state, tick_length, &end);
    if (c->parameters.profile == SHAKER_RANDOM) {
        noise_advance(state->modes, &c->noise, c->stream, state->tick);
    }
    state->tick += 1.0;
    state->platform_displacement = flush_subnormal(end.floor_displacement);
    state->platform_velocity = flush_subnormal(end.floor_velocity);
    accelerate_platform(state, c);
}

/* Evaluate noise or platform at a time; before the first tick they are at rest. */
static void tick_motion(double time, const shaker_state *state, const coefficients_t *c, shaker_outputs *floor)
{
    static const shaker_outputs rest = {0.0, 0.0, 0.0};
    double elapsed = time - state->tick * tick_length;
    if (elapsed < -SHAKER_TIME_TOLERANCE) {
        *floor = rest;
        return;
    }
    elapsed = elapsed > SHAKER_TIME_TOLERANCE ? elapsed : 0.0;
    if (c->platform.has_lag) {
        platform_motion(state, elapsed, floor);
    } else {
        noise_motion(state->modes, &c->noise, c->stream, state->tick, elapsed, floor);
    }
}

/* Evaluate the motion of the floor at a time. */
static void evaluate_outputs(double time, const shaker_state *state, const coefficients_t *c, shaker_outputs *floor)
{
    if (c->has_ticks) {
        tick_motion(time, state, c, floor);
    } else {
        evaluate_profile(time, c, floor);
    }
}

int shaker_is_valid_state(const shaker_state *state, const shaker_parameters *parameters, double time)
{
    return !has_ticks(parameters) || fabs(state->tick * tick_length - time) <= clock_tolerance;
}

void shaker_initialize(shaker_state *state, const shaker_inputs *inputs, const shaker_coefficients *coefficients,
                       double time, shaker_outputs *outputs)
{
    static const shaker_state rest;
    (void)inputs;
    *state = rest;
    state->tick = ceil((time - SHAKER_TIME_TOLERANCE) / tick_length);
    accelerate_platform(state, coefficients);
    evaluate_outputs(time, state, coefficients, outputs);
}

void shaker_advance(shaker_state *state, const shaker_inputs *inputs, const shaker_coefficients *coefficients,
                    double time, double step_size, shaker_outputs *outputs)
{
    const double end = time + step_size;
    (void)inputs;
    if (coefficients->has_ticks) {
        const double last = floor((end + SHAKER_TIME_TOLERANCE) / tick_length);
        while (state->tick < last) {
            advance_tick(state, coefficients);
        }
    }
    evaluate_outputs(end, state, coefficients, outputs);
}
