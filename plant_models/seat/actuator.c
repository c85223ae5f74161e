/* The actuator; see actuator.py for the method. */
#include "actuator.h"

#include <math.h>
#include <string.h>

/* Times closer than this, in s, are equal: communication points carry rounding errors. */
static const double time_tolerance = 1e-9;

actuator_coefficients actuator_prepare(double force_limit, double delay, double time_constant)
{
    const actuator_coefficients c = {force_limit > 0.0 ? force_limit : INFINITY, delay, time_constant};
    return c;
}

int actuator_is_valid_state(const actuator_state *state)
{
    const double pairs = 0.5 * state->line_length;
    return pairs >= 0.0 && pairs <= (double)DELAY_LINE_CAPACITY && pairs == floor(pairs);
}

void actuator_initialize(actuator_state *state, double force, const actuator_coefficients *c)
{
    state->commanded = state->target = state->force = actuator_clip_force(force, c);
}

void actuator_enqueue(actuator_state *state, double force, const actuator_coefficients *c, double time)
{
    const size_t length = (size_t)state->line_length;
    const double arrival = time + c->delay;
    const double spacing = c->delay / DELAY_LINE_CAPACITY - time_tolerance;
    const int early = length > 0 && arrival - state->line[length - 2] < spacing;
    if (force == state->commanded || early || length == 2 * DELAY_LINE_CAPACITY) {
        return;
    }
    state->line[length] = arrival;
    state->line[length + 1] = force;
    state->line_length = (double)(length + 2);
    state->commanded = force;
}

double actuator_release_due(actuator_state *state, double time, double begin, double step_size)
{
    const size_t length = (size_t)state->line_length;
    double *line = state->line;
    size_t due = 0;
    while (due < length && line[due] - time < begin + time_tolerance) {
        state->target = line[due + 1];
        due += 2;
    }
    if (due > 0) {
        memmove(line, line + due, (length - due) * sizeof *line);
        memset(line + length - due, 0, due * sizeof *line);
        state->line_length = (double)(length - due);
    }
    return due < length && line[0] - time < step_size - time_tolerance ? line[0] - time : step_size;
}

actuator_lag actuator_prepare_lag(const actuator_coefficients *c, double h)
{
    const double x = h / c->time_constant;
    const double decay = expm1(-x);
    const double impulse = -decay / x;           /* of exp(-x s) over s from 0 to 1 */
    const double moment = (x + decay) / (x * x); /* of exp(-x s) (1 - s) */
    actuator_lag lag;
    lag.first = 6.0 * moment - 2.0 * impulse;
    lag.last = 2.0 * impulse - lag.first;
    lag.remaining = 1.0 + decay;
    return lag;
}
