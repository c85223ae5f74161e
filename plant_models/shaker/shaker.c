/* The cabin floor's motion: a profile, and a platform that may follow it. See shaker.h and shaker.py. */
#include "shaker.h"

#include "profiles.h"
#include "random_numbers.h"
#include "subnormal.h"

#include <math.h>
#include <stddef.h>

/* In s: what noise and the platform's acceleration are held for. */
static const double tick_length = 0.002;

/* In s: how far a tick may be from the time reached, hosts' rounding errors at late times included. */
static const double farthest = 1.0;

typedef shaker_coefficients coefficients_t;

static int is_ticking(const shaker_parameters *p)
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
    c->curve.memory = NULL;
    c->parameters = *p;
    c->parameters.file_path = NULL; /* the caller's */
    c->stream = random_stream((uint32_t)p->random_seed, 0);
    if (p->profile == SHAKER_RANDOM) {
        noise_prepare(p->random_class, p->random_scale, tick_length, &c->noise);
    }
    const char *problem = platform_prepare(p, tick_length, &c->platform);
    c->ticking = is_ticking(p);
    if (problem == NULL && p->profile == SHAKER_FILE) {
        problem = replay_load(p->file_path, p->file_high_pass, p->file_fade, &c->curve);
    }
    return problem;
}

void shaker_release(shaker_coefficients *coefficients)
{
    replay_free(&coefficients->curve);
}

const char *shaker_warning(const shaker_parameters *parameters)
{
    (void)parameters;
    return NULL;
}

/* A profile that is a function of time. */
static void profile(double time, const coefficients_t *c, shaker_outputs *floor)
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
        replay_motion(&c->curve, time, floor);
        break;
    default:
        profile_bump(time, p->bump_height, p->bump_length, p->bump_speed, floor);
    }
}

/* Let the platform follow the profile at the tick's begin. */
static void accelerate(shaker_state *state, const coefficients_t *c)
{
    shaker_outputs command;
    if (!c->platform.present) {
        return;
    }
    if (c->parameters.profile == SHAKER_RANDOM) {
        noise_motion(state->modes, &c->noise, c->stream, state->tick, 0.0, &command);
    } else {
        profile(state->tick * tick_length, c, &command);
    }
    state->platform_acceleration =
        platform_acceleration(state->platform_displacement, state->platform_velocity, &command, &c->platform);
}

/* The platform some time after the tick's begin. */
static void platform_motion(const shaker_state *state, double since, shaker_outputs *floor)
{
    const double velocity = state->platform_velocity, acceleration = state->platform_acceleration;
    floor->floor_displacement = state->platform_displacement + since * (velocity + 0.5 * since * acceleration);
    floor->floor_velocity = velocity + since * acceleration;
    floor->floor_acceleration = acceleration;
}

/* Go to the next tick. */
static void go_on(shaker_state *state, const coefficients_t *c)
{
    shaker_outputs floor;
    platform_motion(state, tick_length, &floor);
    if (c->parameters.profile == SHAKER_RANDOM) {
        noise_advance(state->modes, &c->noise, c->stream, state->tick);
    }
    state->tick += 1.0;
    state->platform_displacement = flush_subnormal(floor.floor_displacement);
    state->platform_velocity = flush_subnormal(floor.floor_velocity);
    accelerate(state, c);
}

/* Noise or platform at a time, not before the state's tick unless that is the first. */
static void ticking_floor(double time, const shaker_state *state, const coefficients_t *c, shaker_outputs *floor)
{
    static const shaker_outputs rest = {0.0, 0.0, 0.0};
    const double elapsed = time - state->tick * tick_length;
    const double since = elapsed > SHAKER_SAME_INSTANT ? elapsed : 0.0;
    if (elapsed < -SHAKER_SAME_INSTANT) {
        *floor = rest;
    } else if (c->platform.present) {
        platform_motion(state, since, floor);
    } else {
        noise_motion(state->modes, &c->noise, c->stream, state->tick, since, floor);
    }
}

int shaker_is_valid_state(const shaker_state *state, const shaker_parameters *parameters, double time)
{
    return !is_ticking(parameters) || fabs(state->tick * tick_length - time) <= farthest;
}

void shaker_initial(shaker_state *state, const shaker_inputs *inputs, const shaker_coefficients *coefficients,
                    double time, shaker_outputs *outputs)
{
    static const shaker_state rest;
    (void)inputs;
    *state = rest;
    state->tick = ceil((time - SHAKER_SAME_INSTANT) / tick_length);
    accelerate(state, coefficients);
    if (coefficients->ticking) {
        ticking_floor(time, state, coefficients, outputs);
    } else {
        profile(time, coefficients, outputs);
    }
}

void shaker_advance(shaker_state *state, const shaker_inputs *inputs, const shaker_coefficients *coefficients,
                    double time, double step_size, shaker_outputs *outputs)
{
    const double end = time + step_size;
    (void)inputs;
    if (!coefficients->ticking) {
        profile(end, coefficients, outputs);
        return;
    }
    const double last = floor((end + SHAKER_SAME_INSTANT) / tick_length);
    while (state->tick < last) {
        go_on(state, coefficients);
    }
    ticking_floor(end, state, coefficients, outputs);
}
