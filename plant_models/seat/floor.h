/* Motion of the floor over a communication step, the C twin of floor.py. Times in s, up positive. */
#ifndef FLOOR_H
#define FLOOR_H

#include "seat_interface.h"

/* Second-order Taylor series about the begin of the step: z_v in m, z_v' in m/s, z_v'' in m/s2. */
typedef struct {
    double displacement, velocity, acceleration;
} floor_motion;

/* State of a derived floor. */
typedef struct {
    double displacement, velocity, acceleration; /* motion at the last sample, given or derived, in m, m/s, m/s2 */
    double age;                                  /* time since the last sample in s, 0 before the first one */
    double interval;                             /* time between the last two samples in s, 0 where there is one only */
    double end_displacement;                     /* at the end of the last step, in m */
} floor_history;

/* Return z_v in m at tau seconds after the begin of the step. */
static inline double floor_displacement_at(const floor_motion *motion, double tau)
{
    return motion->displacement + tau * (motion->velocity + 0.5 * tau * motion->acceleration);
}

/* Return z_v' in m/s at tau seconds after the begin of the step. */
static inline double floor_velocity_at(const floor_motion *motion, double tau)
{
    return motion->velocity + tau * motion->acceleration;
}

/* Return the same motion about the time tau seconds after the begin of the step. */
static inline floor_motion floor_from_time(const floor_motion *motion, double tau)
{
    const floor_motion later = {floor_displacement_at(motion, tau), floor_velocity_at(motion, tau),
                                motion->acceleration};
    return later;
}

/* Return the motion that the three floor inputs describe. */
static inline floor_motion floor_motion_from_inputs(const seat_plant_inputs *inputs)
{
    const floor_motion motion = {inputs->floor_displacement, inputs->floor_velocity, inputs->floor_acceleration};
    return motion;
}

/* Derive the motion over a step from the one signal that is used, and move its history to the end of the step. */
floor_motion floor_derive_motion(floor_history *history, const seat_plant_inputs *inputs, int signals,
                                 double step_size);

#endif
