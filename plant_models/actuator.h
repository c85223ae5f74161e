/* Force limit, delay and lag of the actuator: the twin of actuator.py. Times in s, forces in N. */
#ifndef ACTUATOR_H
#define ACTUATOR_H

#include "seat.h"

/* What a lag makes of the deviation from its target: at both ends of the straight line, and what is left of it. */
typedef struct {
    double first, last, left;
} actuator_lag;

static const actuator_lag actuator_no_lag = {0.0, 0.0, 0.0};

/* Start with a force that has always been asked for. */
void actuator_settle(seat_plant_state *state, double force, const seat_plant_actuator *actuator);

static inline double actuator_limited(double force, const seat_plant_actuator *actuator)
{
    const double raised = -actuator->limit > force ? -actuator->limit : force;
    return actuator->limit < raised ? actuator->limit : raised;
}

/* Put a force into the delay line. */
void actuator_enter(seat_plant_state *state, double force, const seat_plant_actuator *actuator, double time);

/* Ask for a force from a time on. */
static inline void actuator_command(seat_plant_state *state, double force, const seat_plant_actuator *actuator,
                                    double time)
{
    force = actuator_limited(force, actuator);
    if (actuator->delay == 0.0) {
        state->force_commanded = state->force_target = force;
    } else {
        actuator_enter(state, force, actuator, time);
    }
}

/* Let the changes leave the delay that are due when a part of the step is over. Returns how far into the step the target
 * holds: until the next change, or the end. */
double actuator_arrive(seat_plant_state *state, double time, double begin, double step_size);

/* Prepare substeps of a length, where there is a lag. */
actuator_lag actuator_lag_for(const seat_plant_actuator *actuator, double h);

#endif
