/* A passive seat in one block, the C twin of passive_seat.py. */
#ifndef PASSIVE_SEAT_H
#define PASSIVE_SEAT_H

#include "seat_blocks_interface.h"

typedef seat_plant_state passive_seat_state;
typedef seat_plant_coefficients passive_seat_coefficients;

/* Derive the coefficients. Returns NULL, or a message about the parameters of the seat in terms of their names there.
 */
const char *passive_seat_prepare(const passive_seat_parameters *parameters, passive_seat_coefficients *coefficients);

/* Return a warning about legal parameters: always NULL. */
const char *passive_seat_warning(const passive_seat_parameters *parameters);

/* Check that a run can have a state with finite numbers. */
int passive_seat_is_valid_state(const passive_seat_state *state, const passive_seat_parameters *parameters,
                                double time);

/* Set the seat at rest. */
void passive_seat_initialize(passive_seat_state *state, const passive_seat_inputs *inputs,
                             const passive_seat_coefficients *coefficients, double time, passive_seat_outputs *outputs);

/* Integrate over a communication step. */
void passive_seat_advance(passive_seat_state *state, const passive_seat_inputs *inputs,
                          const passive_seat_coefficients *coefficients, double time, double step_size,
                          passive_seat_outputs *outputs);

#endif
