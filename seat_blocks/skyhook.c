/* The law of a variable damper; the equations are in skyhook.py. */
#include "skyhook.h"

#include "sampling.h"
#include "subnormal.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

/* Largest distance of the next sample from the time that a run has reached, in s; allows for rounding errors of hosts.
 */
static const double clock_tolerance = 1.0;

skyhook_coefficients skyhook_prepare(const damper_parameters *parameters, double sample_time)
{
    skyhook_coefficients c;
    c.c_min = parameters->minimum;
    c.c_max = parameters->maximum;
    c.c_sky = parameters->skyhook;
    c.half_step = 0.5 * sample_time;
    c.leak = 1.0 + 2.0 * pi * parameters->velocity_corner * sample_time;
    rate_filter(parameters->rate_filter_cutoff, sample_time, &c.rate_decay, &c.rate_gain);
    c.sample_time = sample_time;
    return c;
}

void skyhook_start(skyhook_state *state, const skyhook_coefficients *c, double time)
{
    const skyhook_state before_the_first = {0};
    *state = before_the_first;
    state->next_sample = samples_before(time, c->sample_time);
    state->damping = c->c_min;
}

/* Take one sample. */
static void sample(skyhook_state *state, double acceleration, double deflection, const skyhook_coefficients *c)
{
    const double a_before = state->started ? state->acceleration : acceleration;
    const double delta_before = state->started ? state->deflection : deflection;
    const double w = flush_subnormal((state->velocity + c->half_step * (acceleration + a_before)) / c->leak);
    const double v = flush_subnormal(filtered_rate(state->rate, delta_before, deflection, c->rate_decay, c->rate_gain));
    double damping = c->c_min;
    if (w * v > 0.0) {
        damping = c->c_sky * w / v;
        damping = damping < c->c_min ? c->c_min : damping > c->c_max ? c->c_max : damping;
    }
    state->next_sample += 1.0;
    state->started = true;
    state->acceleration = flush_subnormal(acceleration);
    state->deflection = flush_subnormal(deflection);
    state->velocity = w;
    state->rate = v;
    state->damping = damping;
}

void skyhook_advance(skyhook_state *state, double acceleration, double deflection, const skyhook_coefficients *c,
                     double time, double duration)
{
    const double end = samples_before(time + duration, c->sample_time);
    while (state->next_sample < end) {
        sample(state, acceleration, deflection, c);
    }
}

int skyhook_is_valid_state(const skyhook_state *state, double sample_time, double time)
{
    return fabs(state->next_sample * sample_time - time) <= clock_tolerance;
}
