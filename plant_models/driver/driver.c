/* The seated driver on a seat whose motion is given; see driver.py and body.py. */
#include "driver.h"

#include "motion.h"
#include "runge_kutta.h"

#include <stddef.h>

/* What the accelerations at a stage depend on. */
typedef struct {
    const body_coefficients *body;
    const base_motion *seat;
    double tau, h; /* begin of the substep since that of the step, and its length, in s */
} stage_context;

const char *seated_driver_prepare(const seated_driver_parameters *parameters, seated_driver_coefficients *coefficients)
{
    const seated_driver_parameters *p = parameters;
    body_prepare(p->driver_mass, p->contact_stiffness, p->contact_damping, &coefficients->body);
    coefficients->substep = runge_kutta_substep_for(body_fastest(&coefficients->body));
    if (!(coefficients->substep >= runge_kutta_min_substep)) {
        return "expected a fastest motion below 50000 rad/s from contact_stiffness and contact_damping";
    }
    return NULL;
}

const char *seated_driver_warning(const seated_driver_parameters *parameters)
{
    (void)parameters;
    return NULL;
}

int seated_driver_is_valid_state(const seated_driver_state *state, const seated_driver_parameters *parameters,
                                 double time)
{
    (void)state, (void)parameters, (void)time;
    return 1;
}

/* Return the force on the seat in N, tau seconds after the begin of the step. */
static double contact(const double z[], const double v[], const base_motion *seat, double tau,
                      const body_coefficients *body)
{
    return body_contact_force(z[0] - motion_displacement_at(seat, tau), v[0] - motion_velocity_at(seat, tau), body);
}

static void slope(const double z[], const double v[], double share, double a[], const void *context)
{
    const stage_context *c = context;
    body_accelerations(z, v, contact(z, v, c->seat, c->tau + share * c->h, c->body), c->body, a);
}

/* Evaluate the outputs tau seconds after the begin of the step. */
static void evaluate_outputs(const seated_driver_state *state, const base_motion *seat, double tau,
                             const body_coefficients *body, seated_driver_outputs *outputs)
{
    const double *z = state->displacements, *v = state->velocities;
    double a[BODY_MASSES];
    outputs->contact_force = contact(z, v, seat, tau, body);
    body_accelerations(z, v, outputs->contact_force, body, a);
    outputs->driver_acceleration = a[0];
    outputs->head_acceleration = a[BODY_MASSES - 1];
    outputs->driver_displacement = z[0];
    outputs->head_displacement = z[BODY_MASSES - 1];
}

/* Return the motion that the inputs describe. */
static base_motion motion_of(const seated_driver_inputs *inputs)
{
    const base_motion seat = {inputs->seat_displacement, inputs->seat_velocity, inputs->seat_acceleration};
    return seat;
}

void seated_driver_initialize(seated_driver_state *state, const seated_driver_inputs *inputs,
                              const seated_driver_coefficients *coefficients, double time,
                              seated_driver_outputs *outputs)
{
    const base_motion seat = motion_of(inputs);
    (void)time;
    for (int i = 0; i < BODY_MASSES; ++i) {
        state->displacements[i] = seat.displacement;
        state->velocities[i] = seat.velocity;
    }
    evaluate_outputs(state, &seat, 0.0, &coefficients->body, outputs);
}

void seated_driver_advance(seated_driver_state *state, const seated_driver_inputs *inputs,
                           const seated_driver_coefficients *coefficients, double time, double step_size,
                           seated_driver_outputs *outputs)
{
    const base_motion seat = motion_of(inputs);
    const double count = runge_kutta_substep_count(step_size, coefficients->substep);
    stage_context context = {&coefficients->body, &seat, 0.0, step_size / count};
    (void)time;
    for (double index = 0.0; index < count; index += 1.0) {
        context.tau = index * context.h;
        runge_kutta_step(BODY_MASSES, state->displacements, state->velocities, context.h, slope, &context);
    }
    evaluate_outputs(state, &seat, step_size, &coefficients->body, outputs);
}
