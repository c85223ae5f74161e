/* The floor over a step: the twin of floor.py. Times in s. */
#ifndef FLOOR_H
#define FLOOR_H

#include "seat.h"

/* The floor over a step: second-order Taylor series about the step's begin. */
typedef struct {
    double displacement, velocity, acceleration;
} floor_t;

static inline double floor_displacement_at(const floor_t *floor, double tau)
{
    return floor->displacement + tau * (floor->velocity + 0.5 * tau * floor->acceleration);
}

static inline double floor_velocity_at(const floor_t *floor, double tau)
{
    return floor->velocity + tau * floor->acceleration;
}

static inline floor_t floor_given(const seat_plant_inputs *inputs)
{
    const floor_t floor = {inputs->floor_displacement, inputs->floor_velocity, inputs->floor_acceleration};
    return floor;
}

/* Derive the floor over a step from the one signal that is alive, and move its history to the step's end. */
floor_t floor_derived(seat_plant_state *state, const seat_plant_inputs *inputs, int signals, double step_size);

#endif
