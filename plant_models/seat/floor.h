/* Motion of the floor over a communication step, the C twin of floor.py. Times in s, up positive. */
#ifndef FLOOR_H
#define FLOOR_H

#include "motion.h"
#include "seat_interface.h"

/* Motion z_v, z_v', z_v'' of the floor over one step. */
typedef base_motion floor_motion;

/* State of a derived floor. */
typedef struct {
    double displacement, velocity, acceleration; /* motion at the last sample, given or derived, in m, m/s, m/s2 */
    double age;                                  /* time since the last sample in s, 0 before the first one */
    double interval;                             /* time between the last two samples in s, 0 where there is one only */
    double end_displacement;                     /* at the end of the last step, in m */
} floor_history;

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
