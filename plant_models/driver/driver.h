/* The seated driver, the C twin of driver.py. No allocation, no globals, no recursion, no input or output. Up is
 * positive; times in s. */
#ifndef DRIVER_H
#define DRIVER_H

#include "body.h"
#include "driver_interface.h"

/* Pelvis and thighs, lower torso, chest and upper torso, head and neck, in m and m/s. */
typedef struct {
    double displacements[BODY_MASSES], velocities[BODY_MASSES];
} seated_driver_state;

typedef struct {
    body_coefficients body;
    double substep; /* longest Runge-Kutta substep in s */
} seated_driver_coefficients;

/* Derive the coefficients. Returns NULL, or a message about the parameters in terms of their names. */
const char *seated_driver_prepare(const seated_driver_parameters *parameters, seated_driver_coefficients *coefficients);

/* Return a warning about legal parameters: always NULL. */
const char *seated_driver_warning(const seated_driver_parameters *parameters);

/* Check that a run can have a state with finite numbers: always. */
int seated_driver_is_valid_state(const seated_driver_state *state, const seated_driver_parameters *parameters,
                                 double time);

/* Set the state of a driver who sits unstrained on the seat and moves with it. */
void seated_driver_initialize(seated_driver_state *state, const seated_driver_inputs *inputs,
                              const seated_driver_coefficients *coefficients, double time,
                              seated_driver_outputs *outputs);

/* Integrate the equations of the body over one communication step; the seat is extrapolated. */
void seated_driver_advance(seated_driver_state *state, const seated_driver_inputs *inputs,
                           const seated_driver_coefficients *coefficients, double time, double step_size,
                           seated_driver_outputs *outputs);

#endif
