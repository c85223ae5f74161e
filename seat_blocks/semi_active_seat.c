/* A semi-active seat in one block; see semi_active_seat.py. */
#include "semi_active_seat.h"

#include "parts.h"

#include <stddef.h>

const char *semi_active_seat_prepare(const semi_active_seat_parameters *parameters,
                                     semi_active_seat_coefficients *coefficients)
{
    const semi_active_seat_parameters *p = parameters;
    seat_plant_parameters of_seat = p->seat;
    if (!(p->damper.minimum <= p->damper.maximum)) {
        return "expected damper.minimum <= damper.maximum";
    }
    coefficients->law = skyhook_prepare(&p->damper, p->sample_time);
    coefficients->damper = actuator_prepare(0.0, 0.0, p->damper.time_constant);
    of_seat.suspension_damping = p->damper.maximum;
    return prepare_seat(&of_seat, &coefficients->seat);
}

const char *semi_active_seat_warning(const semi_active_seat_parameters *parameters)
{
    return seat_plant_warning(&parameters->seat);
}

int semi_active_seat_is_valid_state(const semi_active_seat_state *state, const semi_active_seat_parameters *parameters,
                                    double time)
{
    return skyhook_is_valid_state(&state->law, parameters->sample_time, time) && state->damping >= 0.0 &&
           state->law.damping >= 0.0 && seat_plant_is_valid_state(&state->seat, &parameters->seat, time);
}

static void give_outputs(const seat_plant_outputs *of_seat, double damping, double velocity,
                         semi_active_seat_outputs *outputs)
{
    outputs->seat = seat_signals_of(of_seat);
    outputs->measured = measurements_of(of_seat);
    outputs->force = -damping * of_seat->deflection_rate;
    outputs->damping = damping;
    outputs->velocity_estimate = velocity;
}

void semi_active_seat_initialize(semi_active_seat_state *state, const semi_active_seat_inputs *inputs,
                                 const semi_active_seat_coefficients *coefficients, double time,
                                 semi_active_seat_outputs *outputs)
{
    const seat_plant_inputs at_rest = seat_inputs_of(inputs);
    seat_plant_coefficients seat = coefficients->seat;
    seat_plant_outputs of_seat;
    skyhook_start(&state->law, &coefficients->law, time);
    seat.c_f = state->damping = state->law.damping;
    seat_plant_initialize(&state->seat, &at_rest, &seat, time, &of_seat);
    state->acceleration = of_seat.seat_acceleration_measured;
    state->deflection = of_seat.suspension_deflection_measured;
    give_outputs(&of_seat, state->damping, state->law.velocity, outputs);
}

/* Let the damper follow its law over a part of a step of this length in s; returns its mean damping. */
static double follow(semi_active_seat_state *state, const actuator_coefficients *damper, double length)
{
    double first, last;
    actuator_lag prepared;
    const actuator_lag *lag = NULL;
    if (damper->time_constant > 0.0) {
        prepared = actuator_prepare_lag(damper, length);
        lag = &prepared;
    }
    state->damping = actuator_apply_lag(state->damping, state->law.damping, lag, &first, &last);
    return 0.5 * (first + last);
}

void semi_active_seat_advance(semi_active_seat_state *state, const semi_active_seat_inputs *inputs,
                              const semi_active_seat_coefficients *coefficients, double time, double step_size,
                              semi_active_seat_outputs *outputs)
{
    const semi_active_seat_coefficients *c = coefficients;
    const seat_plant_inputs floor_inputs = seat_inputs_of(inputs);
    const floor_motion motion = seat_plant_begin_step(&state->seat, &floor_inputs, &c->seat, step_size);
    seat_plant_coefficients seat = c->seat;
    seat_plant_outputs of_seat;
    double begin = 0.0;
    do {
        const double end = end_of_part(time, begin, step_size, c->law.sample_time);
        const floor_motion rest = motion_from_time(&motion, begin);
        skyhook_advance(&state->law, state->acceleration, state->deflection, &c->law, time + begin, end - begin);
        seat.c_f = follow(state, &c->damper, end - begin);
        seat_plant_advance_on_floor(&state->seat, &rest, 0.0, 0.0, &seat, time + begin, end - begin, &of_seat);
        state->acceleration = of_seat.seat_acceleration_measured;
        state->deflection = of_seat.suspension_deflection_measured;
        begin = end;
    } while (begin < step_size);
    give_outputs(&of_seat, seat.c_f, state->law.velocity, outputs);
}
