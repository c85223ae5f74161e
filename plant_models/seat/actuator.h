/* Force limit, delay and lag of the actuator, the C twin of actuator.py. Times in s; forces in N, up positive. */
#ifndef ACTUATOR_H
#define ACTUATOR_H

#include "subnormal.h"

#include <stddef.h>

/* limit: largest magnitude of the force in N, may be infinite; delay: T_d in s; time_constant: T_a of the lag in s. */
typedef struct {
    double limit, delay, time_constant;
} actuator_coefficients;

/* Number of force changes in the delay line. */
enum { DELAY_LINE_CAPACITY = 128 };

typedef struct {
    double commanded;                     /* latest force that entered the delay line, in N */
    double target;                        /* latest force that left the delay line, in N */
    double force;                         /* on the seat, in N */
    double line_length;                   /* number of values in use in the line */
    double line[2 * DELAY_LINE_CAPACITY]; /* time of arrival in s and force in N of each change, then zeros */
} actuator_state;

/* Effect of the lag over a substep, as factors on the deviation of the force from its target: at both ends of the
 * straight line, and after the substep. */
typedef struct {
    double first, last, remaining;
} actuator_lag;

/* Derive the coefficients; a force limit of 0 is none. */
actuator_coefficients actuator_prepare(double force_limit, double delay, double time_constant);

/* Check that the delay line holds complete pairs and not more than its capacity. */
int actuator_is_valid_state(const actuator_state *state);

/* Set the steady state at a constant force input. */
void actuator_initialize(actuator_state *state, double force, const actuator_coefficients *c);

/* Append a change of force to the delay line, unless it is no change, too early or the line is full. */
void actuator_enqueue(actuator_state *state, double force, const actuator_coefficients *c, double time);

/* Take the changes out of the delay line that are due `begin` seconds after `time`, where the step begins. Returns the
 * time since then, in s, until which the new target holds: the next change or the end of the step. */
double actuator_release_due(actuator_state *state, double time, double begin, double step_size);

/* Derive the effect of the lag over a substep of length h in s; the time constant is above 0. */
actuator_lag actuator_prepare_lag(const actuator_coefficients *c, double h);

/* Limit a force to [-limit, limit]. */
static inline double actuator_clip_force(double force, const actuator_coefficients *c)
{
    const double raised = -c->limit > force ? -c->limit : force;
    return c->limit < raised ? c->limit : raised;
}

/* Set the force input from a time on. */
static inline void actuator_command(actuator_state *state, double force, const actuator_coefficients *c, double time)
{
    force = actuator_clip_force(force, c);
    if (c->delay == 0.0) {
        state->commanded = state->target = force;
    } else {
        actuator_enqueue(state, force, c, time);
    }
}

/* Advance the force over a substep; the lag is NULL where there is none. Gives both ends of the straight line over the
 * substep and returns the force after it. */
static inline double actuator_apply_lag(double force, double target, const actuator_lag *lag, double *first,
                                        double *last)
{
    if (lag == NULL) {
        return *first = *last = target;
    }
    const double deviation = force - target;
    *first = target + deviation * lag->first;
    *last = target + deviation * lag->last;
    return flush_subnormal(target + deviation * lag->remaining);
}

#endif
