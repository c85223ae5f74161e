/* A passive seat in one block; see passive_seat.py. */
#include "passive_seat.h"

#include "parts.h"

const char *passive_seat_prepare(const passive_seat_parameters *parameters, passive_seat_coefficients *coefficients)
{
    return prepare_seat(&parameters->seat, coefficients);
}

const char *passive_seat_warning(const passive_seat_parameters *parameters)
{
    return seat_plant_warning(&parameters->seat);
}

int passive_seat_is_valid_state(const passive_seat_state *state, const passive_seat_parameters *parameters, double time)
{
    return seat_plant_is_valid_state(state, &parameters->seat, time);
}

void passive_seat_initialize(passive_seat_state *state, const passive_seat_inputs *inputs,
                             const passive_seat_coefficients *coefficients, double time, passive_seat_outputs *outputs)
{
    const seat_plant_inputs of_floor = seat_inputs_of(inputs);
    seat_plant_outputs of_seat;
    seat_plant_initialize(state, &of_floor, coefficients, time, &of_seat);
    outputs->seat = seat_signals_of(&of_seat);
    outputs->force = 0.0;
}

void passive_seat_advance(passive_seat_state *state, const passive_seat_inputs *inputs,
                          const passive_seat_coefficients *coefficients, double time, double step_size,
                          passive_seat_outputs *outputs)
{
    const seat_plant_inputs of_floor = seat_inputs_of(inputs);
    seat_plant_outputs of_seat;
    seat_plant_advance(state, &of_floor, coefficients, time, step_size, &of_seat);
    outputs->seat = seat_signals_of(&of_seat);
    outputs->force = 0.0;
}
