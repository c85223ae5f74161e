/* A semi-active seat in one block, the C twin of semi_active_seat.py. */
#ifndef SEMI_ACTIVE_SEAT_H
#define SEMI_ACTIVE_SEAT_H

#include "skyhook.h"

typedef struct {
    skyhook_state law;
    double acceleration, deflection; /* measurements of the seat at the end of the last step, in m/s2 and m */
    double damping;                  /* c of the damper, in N.s/m */
    seat_plant_state seat;
} semi_active_seat_state;

typedef struct {
    skyhook_coefficients law;
    actuator_coefficients damper; /* its lag */
    seat_plant_coefficients seat; /* with the greatest damping */
} semi_active_seat_coefficients;

/* Derive the coefficients. Returns NULL, or a message about the parameters. */
const char *semi_active_seat_prepare(const semi_active_seat_parameters *parameters,
                                     semi_active_seat_coefficients *coefficients);

/* Return a warning about legal parameters: always NULL. */
const char *semi_active_seat_warning(const semi_active_seat_parameters *parameters);

/* Check that a run that has reached a time can have a state with finite numbers. */
int semi_active_seat_is_valid_state(const semi_active_seat_state *state, const semi_active_seat_parameters *parameters,
                                    double time);

/* Set the state at the start: the seat at rest, the damper open. */
void semi_active_seat_initialize(semi_active_seat_state *state, const semi_active_seat_inputs *inputs,
                                 const semi_active_seat_coefficients *coefficients, double time,
                                 semi_active_seat_outputs *outputs);

/* Take samples and integrate over a communication step, from sample to sample. */
void semi_active_seat_advance(semi_active_seat_state *state, const semi_active_seat_inputs *inputs,
                              const semi_active_seat_coefficients *coefficients, double time, double step_size,
                              semi_active_seat_outputs *outputs);

#endif
