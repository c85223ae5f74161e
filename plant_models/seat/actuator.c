/* The actuator; explained in actuator.py. */
#include "actuator.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

/* Times closer than this are one instant: communication points carry rounding errors. */
static const double same_instant = 1e-9;

int actuator_is_valid_state(const actuator_state *state)
{
    const double pairs = 0.5 * state->line_length;
    return pairs >= 0.0 && pairs <= (double)ACTUATOR_PLACES && pairs == floor(pairs);
}

void actuator_settle(actuator_state *state, double force, const actuator_coefficients *actuator)
{
    state->commanded = state->target = state->force = actuator_limited(force, actuator);
}

void actuator_enter(actuator_state *state, double force, const actuator_coefficients *actuator, double time)
{
    const size_t length = (size_t)state->line_length;
    const double arrival = time + actuator->delay;
    const double spacing = actuator->delay / ACTUATOR_PLACES - same_instant;
    const int early = length > 0 && arrival - state->line[length - 2] < spacing;
    if (force == state->commanded || early || length == 2 * ACTUATOR_PLACES) {
        return;
    }
    state->line[length] = arrival;
    state->line[length + 1] = force;
    state->line_length = (double)(length + 2);
    state->commanded = force;
}

double actuator_arrive(actuator_state *state, double time, double begin, double step_size)
{
    const size_t length = (size_t)state->line_length;
    double *line = state->line;
    size_t due = 0;
    while (due < length && line[due] - time < begin + same_instant) {
        state->target = line[due + 1];
        due += 2;
    }
    if (due > 0) {
        memmove(line, line + due, (length - due) * sizeof *line);
        memset(line + length - due, 0, due * sizeof *line);
        state->line_length = (double)(length - due);
    }
    return due < length && line[0] - time < step_size - same_instant ? line[0] - time : step_size;
}

actuator_lag actuator_lag_for(const actuator_coefficients *actuator, double h)
{
    const double x = h / actuator->time_constant;
    const double faded = expm1(-x);
    const double impulse = -faded / x;         /* of exp(-x s) over s from 0 to 1 */
    const double moment = (x + faded) / (x * x); /* of exp(-x s) (1 - s) */
    actuator_lag lag;
    lag.first = 6.0 * moment - 2.0 * impulse;
    lag.last = 2.0 * impulse - lag.first;
    lag.left = 1.0 + faded;
    return lag;
}
