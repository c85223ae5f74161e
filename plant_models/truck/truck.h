/* The truck, the C twin of truck.py. No globals, no recursion; memory and files only while a road from a file is
 * prepared. Up is positive, times are in s. */
#ifndef TRUCK_H
#define TRUCK_H

#include "interface.h"
#include "road.h"
#include "vehicle.h"

typedef struct {
    double start;           /* time at which the front axle is at the begin of the road */
    double seat_force;      /* at the end of the last step, in N */
    road_track front, rear; /* road under the axles */
    double displacements[VEHICLE_DEGREES], velocities[VEHICLE_DEGREES];
} truck_cab_state;

typedef struct {
    double speed, wheelbase; /* v in m/s, L in m */
    road_coefficients road;
    vehicle_coefficients vehicle;
} truck_cab_coefficients;

/* Derive the coefficients; they own the memory of a road from a file until they are released. Returns NULL, or a
 * message about the parameters in terms of their names or about the file; then there is nothing to release. */
const char *truck_cab_prepare(const truck_cab_parameters *parameters, truck_cab_coefficients *coefficients);

/* Free the memory of coefficients that are prepared or all zero. */
void truck_cab_release(truck_cab_coefficients *coefficients);

/* Return a warning about legal parameters: always NULL. */
const char *truck_cab_warning(const truck_cab_parameters *parameters);

/* Check that a run that has reached a time can have a state: it has started, and the axles are in the cells that the
 * truck has reached. */
int truck_cab_is_valid_state(const truck_cab_state *state, const truck_cab_parameters *parameters, double time);

/* Set the state of rest in static equilibrium, the front axle at the begin of the road. */
void truck_cab_initialize(truck_cab_state *state, const truck_cab_inputs *inputs,
                          const truck_cab_coefficients *coefficients, double time, truck_cab_outputs *outputs);

/* Integrate the equations of motion over one communication step; the force of the seat changes linearly from the
 * last input to this one. */
void truck_cab_advance(truck_cab_state *state, const truck_cab_inputs *inputs,
                       const truck_cab_coefficients *coefficients, double time, double step_size,
                       truck_cab_outputs *outputs);

#endif
