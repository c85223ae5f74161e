/* The floor over a step: the twin of floor.py. Times in s. */
#ifndef FLOOR_H
#define FLOOR_H

#include "interface.h"

/* The floor over a step: second-order Taylor series about the step's begin. */
typedef struct {
    double displacement, velocity, acceleration;
} floor_motion;

/* What a derived floor remembers. */
typedef struct {
    double displacement, velocity, acceleration; /* motion at the last sample, as given or derived, in m, m/s, m/s2 */
    double age, interval;                        /* the time since then and from the sample before till then, in s */
    double reached;                              /* where the last step has left the floor, in m */
} floor_history;

static inline double floor_displacement_at(const floor_motion *floor, double tau)
{
    return floor->displacement + tau * (floor->velocity + 0.5 * tau * floor->acceleration);
}

static inline double floor_velocity_at(const floor_motion *floor, double tau)
{
    return floor->velocity + tau * floor->acceleration;
}

static inline floor_motion floor_given(const seat_plant_inputs *inputs)
{
    const floor_motion floor = {inputs->floor_displacement, inputs->floor_velocity, inputs->floor_acceleration};
    return floor;
}

/* Derive the floor over a step from the one signal that is alive, and move its history to the step's end. */
floor_motion floor_derived(floor_history *history, const seat_plant_inputs *inputs, int signals, double step_size);

#endif
