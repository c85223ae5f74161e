/* Controller and seat in one block, the C twin of active_seat.py. No allocation, no globals, no recursion, no input or
 * output. Times in s. */
#ifndef ACTIVE_SEAT_H
#define ACTIVE_SEAT_H

#include "controller.h"
#include "seat_blocks_interface.h"

typedef seat_block_inputs active_seat_inputs;

typedef struct {
    seat_signals seat;
    seat_measurements measured;
    seat_controller_outputs controller;
} active_seat_outputs;

typedef struct {
    double inner_step_size; /* h_i in s, 0: one exchange in each communication step */
    seat_controller_parameters controller;
    seat_plant_parameters seat;
} active_seat_parameters;

typedef struct {
    seat_controller_state controller;
    double acceleration, deflection; /* measurements of the seat at the end of the last step, in m/s2 and m */
    seat_plant_state seat;
} active_seat_state;

typedef struct {
    seat_controller_coefficients controller;
    seat_plant_coefficients seat;
    double interval; /* time between exchanges in s, 0 for one in each communication step */
} active_seat_coefficients;

/* Derive the coefficients. Returns NULL, or a message about the parameters of a part in terms of their names there. */
const char *active_seat_prepare(const active_seat_parameters *parameters, active_seat_coefficients *coefficients);

/* Return a warning about legal parameters, or NULL. */
const char *active_seat_warning(const active_seat_parameters *parameters);

/* Check that a run that has reached a time can have a state with finite numbers. */
int active_seat_is_valid_state(const active_seat_state *state, const active_seat_parameters *parameters, double time);

/* Set the state at the start: the controller before its first sample, the seat at rest. */
void active_seat_initialize(active_seat_state *state, const active_seat_inputs *inputs,
                            const active_seat_coefficients *coefficients, double time, active_seat_outputs *outputs);

/* Take samples and integrate over a communication step, part by part. */
void active_seat_advance(active_seat_state *state, const active_seat_inputs *inputs,
                         const active_seat_coefficients *coefficients, double time, double step_size,
                         active_seat_outputs *outputs);

#endif
