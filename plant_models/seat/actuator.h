/* Force limit, delay and lag of the actuator: the twin of actuator.py. Times in s, forces in N. */
#ifndef ACTUATOR_H
#define ACTUATOR_H

/* What the actuator does to a force; the limit may be infinite. */
typedef struct {
    double limit, delay, time_constant;
} actuator_coefficients;

/* Changes in the delay line. */
enum { ACTUATOR_PLACES = 128 };

typedef struct {
    double commanded, target, force;  /* latest into the delay, latest out of it, on the seat in N */
    double line_length;               /* numbers in use of the delay line: */
    double line[2 * ACTUATOR_PLACES]; /* arrival in s and force in N of each change, then zeros */
} actuator_state;

/* Whether the delay line holds pairs, no more than there is room for. */
int actuator_is_valid_state(const actuator_state *state);

/* What a lag makes of the deviation from its target: at both ends of the straight line, and what is left of it. */
typedef struct {
    double first, last, left;
} actuator_lag;

static const actuator_lag actuator_no_lag = {0.0, 0.0, 0.0};

/* Start with a force that has always been asked for. */
void actuator_settle(actuator_state *state, double force, const actuator_coefficients *actuator);

static inline double actuator_limited(double force, const actuator_coefficients *actuator)
{
    const double raised = -actuator->limit > force ? -actuator->limit : force;
    return actuator->limit < raised ? actuator->limit : raised;
}

/* Put a force into the delay line. */
void actuator_enter(actuator_state *state, double force, const actuator_coefficients *actuator, double time);

/* Ask for a force from a time on. */
static inline void actuator_command(actuator_state *state, double force, const actuator_coefficients *actuator,
                                    double time)
{
    force = actuator_limited(force, actuator);
    if (actuator->delay == 0.0) {
        state->commanded = state->target = force;
    } else {
        actuator_enter(state, force, actuator, time);
    }
}

/* Let the changes leave the delay that are due when a part of the step is over. Returns how far into the step the target
 * holds: until the next change, or the end. */
double actuator_arrive(actuator_state *state, double time, double begin, double step_size);

/* Prepare substeps of a length, where there is a lag. */
actuator_lag actuator_lag_for(const actuator_coefficients *actuator, double h);

#endif
