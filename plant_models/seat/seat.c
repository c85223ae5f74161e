/* The seat: two masses on a suspension with Bouc-Wen friction (1)-(2), (35)-(36). See seat.py and friction.py for the
 * methods of integration and solution.
 *
 *   m_s z_s'' = -k_f (z_s - z_v) - c_f (z_s' - z_v') + k_c (z_b - z_s) + c_c (z_b' - z_s') - f_r + u_sat        (1)
 *   m_b z_b'' = -k_c (z_b - z_s) - c_c (z_b' - z_s')                                                            (2)
 *   f_r       = alpha z_d                                                                                       (35)
 *   z_d'      = A_d v - gamma_d |v| |z_d| z_d - beta_d v z_d^2,   v = z_s' - z_v'                               (36)
 *
 * A seated driver has the equations of body.h in place of (2), an external one is a held force on the seat.
 */
#include "seat.h"

#include "runge_kutta.h"
#include "subnormal.h"

#include <math.h>
#include <stddef.h>

typedef seat_plant_state state_t;
typedef seat_plant_masses masses_t;
typedef seat_plant_coefficients coefficients_t;

static const double pi = 3.14159265358979323846;

/* ---- mechanics --------------------------------------------------------------------------------------------------- */

/* Return which end stop is in contact: 1 for the upper, -1 for the lower, 0 for none. */
static double contact_side(double deflection, const coefficients_t *c)
{
    const double position = deflection + c->x_m;
    return fabs(position) <= c->x_e ? 0.0 : position > 0.0 ? 1.0 : -1.0;
}

/* Return the force of an end stop on the seat in N, up positive; like rubber, it never pulls. */
static double end_stop_force(double deflection, double rate, double side, const coefficients_t *c)
{
    const double depth = side * (deflection + c->x_m) - c->x_e;
    const double push = c->k_e * depth + c->c_e * side * rate;
    return -side * (push > 0.0 ? push : 0.0);
}

/* Return the force of spring, damper and friction on the seat in N, up positive. */
static double suspension_force(double deflection, double rate, double z_d, const coefficients_t *c)
{
    return -c->k_f * deflection - c->c_f * rate - c->alpha * z_d;
}

/* Solve (1) for z_s'' in m/s2, without end stops. */
static double seat_acceleration(double deflection, double rate, double cushion_deflection, double cushion_rate,
                                double z_d, double force, const coefficients_t *c)
{
    const double suspension = suspension_force(deflection, rate, z_d, c);
    return (suspension + c->k_c * cushion_deflection + c->c_c * cushion_rate + force) * c->per_m_s;
}

/* Solve (2) for z_b'' in m/s2. */
static double driver_acceleration(double cushion_deflection, double cushion_rate, const coefficients_t *c)
{
    return (-c->k_c * cushion_deflection - c->c_c * cushion_rate) * c->per_m_b;
}

typedef struct {
    double seat, driver;
} accelerations;

/* Return the accelerations in m/s2 at a stage of the substep, tau seconds after the begin of the step. At the begin of
 * the substep the friction state is z_d and the deflection x_0. */
static accelerations slope(double z_s, double v_s, double z_b, double v_b, double tau, double z_d, double x_0,
                           const floor_motion *motion, double force, double side, const coefficients_t *c)
{
    const double x = z_s - motion_displacement_at(motion, tau);
    const double v = v_s - motion_velocity_at(motion, tau);
    const double z_d_stage = friction_after_slip(z_d, x - x_0, &c->friction);
    const double cushion_deflection = z_b - z_s, cushion_rate = v_b - v_s;
    accelerations a;
    a.seat = seat_acceleration(x, v, cushion_deflection, cushion_rate, z_d_stage, force, c);
    if (side != 0.0) {
        a.seat += end_stop_force(x, v, side, c) * c->per_m_s;
    }
    a.driver = driver_acceleration(cushion_deflection, cushion_rate, c);
    return a;
}

/* Return z_d in m after a substep that ends with a displacement in m and a velocity in m/s of the seat. */
static double friction_after(const masses_t *masses, double z_s, double v_s, const floor_motion *motion, double tau,
                             double h, const coefficients_t *c)
{
    const double x_0 = masses->seat_displacement - motion_displacement_at(motion, tau);
    const double x_1 = z_s - motion_displacement_at(motion, tau + h);
    return friction_through_reversal(masses->friction, x_0, masses->seat_velocity - motion_velocity_at(motion, tau),
                                     x_1, v_s - motion_velocity_at(motion, tau + h), h, &c->friction);
}

/* Write the accelerations of a seated body in m/s2, from the displacements in m and velocities in m/s of seat and
 * body. */
static void seated_accelerations(const double z[], const double v[], const coefficients_t *c, double a[])
{
    const double contact = body_contact_force(z[1] - z[0], v[1] - v[0], &c->body);
    body_accelerations(z + 1, v + 1, contact, &c->body, a);
}

enum { SEATED_MASSES = 1 + BODY_MASSES };

/* Write displacements in m and velocities in m/s of seat and seated body, upwards. */
static void gather(const masses_t *masses, double z[], double v[])
{
    z[0] = masses->seat_displacement;
    v[0] = masses->seat_velocity;
    z[1] = masses->driver_displacement;
    v[1] = masses->driver_velocity;
    for (int i = 2; i < SEATED_MASSES; ++i) {
        z[i] = masses->upper_displacements[i - 2];
        v[i] = masses->upper_velocities[i - 2];
    }
}

/* What the accelerations at a stage of a substep with a seated driver depend on. */
typedef struct {
    const floor_motion *motion;
    const coefficients_t *c;
    double first, last, side, tau, h, z_d, x_0; /* as of slope() and substep() */
} seated_stage;

static void seated_slope(const double z[], const double v[], double share, double a[], const void *context)
{
    const seated_stage *s = context;
    const double force = s->first + share * (s->last - s->first);
    const double tau = s->tau + share * s->h;
    a[0] = slope(z[0], v[0], z[1], v[1], tau, s->z_d, s->x_0, s->motion, force, s->side, s->c).seat;
    seated_accelerations(z, v, s->c, a + 1);
}

/* Take a substep with a seated driver; as substep(). */
static void seated_substep(masses_t *masses, const floor_motion *motion, double first, double last, double side,
                           double tau, double h, const coefficients_t *c)
{
    const double x_0 = masses->seat_displacement - motion_displacement_at(motion, tau);
    const seated_stage stage = {motion, c, first, last, side, tau, h, masses->friction, x_0};
    double z[SEATED_MASSES], v[SEATED_MASSES];
    gather(masses, z, v);
    runge_kutta_step(SEATED_MASSES, z, v, h, seated_slope, &stage);
    masses->friction = flush_subnormal(friction_after(masses, z[0], v[0], motion, tau, h, c));
    masses->seat_displacement = z[0];
    masses->seat_velocity = v[0];
    masses->driver_displacement = z[1];
    masses->driver_velocity = v[1];
    for (int i = 2; i < SEATED_MASSES; ++i) {
        masses->upper_displacements[i - 2] = z[i];
        masses->upper_velocities[i - 2] = v[i];
    }
}

/* Take one step of classical Runge-Kutta over the four mechanical states of two masses, friction in closed form at
 * every stage. The substep begins tau seconds after the begin of the step and has the length h in s. The force in N is
 * linear between its ends. `side` is the end stop that is in contact over the substep. */
static void substep(masses_t *masses, const floor_motion *motion, double first, double last, double side, double tau,
                    double h, const coefficients_t *c)
{
    const double middle = 0.5 * (first + last);
    const double z_s = masses->seat_displacement, v_s = masses->seat_velocity;
    const double z_b = masses->driver_displacement, v_b = masses->driver_velocity;
    const double z_d = masses->friction;
    const double x_0 = z_s - motion_displacement_at(motion, tau);
    const double half = 0.5 * h;
    const accelerations a_1 = slope(z_s, v_s, z_b, v_b, tau, z_d, x_0, motion, first, side, c);
    const double v_s2 = v_s + half * a_1.seat, v_b2 = v_b + half * a_1.driver;
    const accelerations a_2 =
        slope(z_s + half * v_s, v_s2, z_b + half * v_b, v_b2, tau + half, z_d, x_0, motion, middle, side, c);
    const double v_s3 = v_s + half * a_2.seat, v_b3 = v_b + half * a_2.driver;
    const accelerations a_3 =
        slope(z_s + half * v_s2, v_s3, z_b + half * v_b2, v_b3, tau + half, z_d, x_0, motion, middle, side, c);
    const double v_s4 = v_s + h * a_3.seat, v_b4 = v_b + h * a_3.driver;
    const accelerations a_4 =
        slope(z_s + h * v_s3, v_s4, z_b + h * v_b3, v_b4, tau + h, z_d, x_0, motion, last, side, c);
    const double sixth = h / 6.0;
    const double z_s_end = z_s + sixth * (v_s + 2.0 * (v_s2 + v_s3) + v_s4);
    const double z_b_end = z_b + sixth * (v_b + 2.0 * (v_b2 + v_b3) + v_b4);
    const double v_s_end = v_s + sixth * (a_1.seat + 2.0 * (a_2.seat + a_3.seat) + a_4.seat);
    const double v_b_end = v_b + sixth * (a_1.driver + 2.0 * (a_2.driver + a_3.driver) + a_4.driver);
    const double z_d_end = friction_after(masses, z_s_end, v_s_end, motion, tau, h, c);
    masses->seat_displacement = flush_subnormal(z_s_end);
    masses->seat_velocity = flush_subnormal(v_s_end);
    masses->driver_displacement = flush_subnormal(z_b_end);
    masses->driver_velocity = flush_subnormal(v_b_end);
    masses->friction = flush_subnormal(z_d_end);
}

/* Set the outputs about the driver, with the acceleration of the seat known. */
static inline void evaluate_driver(const masses_t *masses, double cushion_deflection, double cushion_rate,
                                   const coefficients_t *c, seat_plant_outputs *outputs)
{
    outputs->driver_displacement = masses->driver_displacement;
    if (c->driver_model == SEAT_PLANT_SEATED) {
        double z[SEATED_MASSES], v[SEATED_MASSES], a[BODY_MASSES];
        gather(masses, z, v);
        seated_accelerations(z, v, c, a);
        outputs->driver_acceleration = a[0];
        outputs->head_acceleration = a[BODY_MASSES - 1];
        return;
    }
    if (c->driver_model == SEAT_PLANT_EXTERNAL) {
        outputs->driver_displacement = masses->seat_displacement;
        outputs->driver_acceleration = outputs->seat_acceleration;
    } else {
        outputs->driver_acceleration = driver_acceleration(cushion_deflection, cushion_rate, c);
    }
    outputs->head_acceleration = outputs->driver_acceleration;
}

/* Evaluate the outputs, without measurements, tau seconds after the begin of the step; `force` is that of the actuator
 * and `push` that of an external driver, in N. */
static inline void evaluate_outputs(const masses_t *masses, const floor_motion *motion, double force, double push,
                                    double tau, const coefficients_t *c, seat_plant_outputs *outputs)
{
    const double deflection = masses->seat_displacement - motion_displacement_at(motion, tau);
    const double rate = masses->seat_velocity - motion_velocity_at(motion, tau);
    const double cushion_deflection = masses->driver_displacement - masses->seat_displacement;
    const double cushion_rate = masses->driver_velocity - masses->seat_velocity;
    outputs->seat_acceleration =
        seat_acceleration(deflection, rate, cushion_deflection, cushion_rate, masses->friction, force + push, c);
    outputs->floor_force = -suspension_force(deflection, rate, masses->friction, c) - force;
    const double side = contact_side(deflection, c);
    if (side != 0.0) {
        const double end_stop = end_stop_force(deflection, rate, side, c);
        outputs->seat_acceleration += end_stop * c->per_m_s;
        outputs->floor_force -= end_stop;
    }
    outputs->suspension_deflection = deflection;
    outputs->deflection_rate = rate;
    outputs->seat_displacement = masses->seat_displacement;
    outputs->seat_velocity = masses->seat_velocity;
    evaluate_driver(masses, cushion_deflection, cushion_rate, c, outputs);
    outputs->friction_force = c->alpha * masses->friction; /* (35) */
}

/* Add the measurements of the two sensors to the outputs. */
static void add_measurements(const state_t *state, const coefficients_t *c, double time, seat_plant_outputs *outputs)
{
    const int low_pass = c->bandwidth > 0.0;
    const double acceleration = low_pass ? state->filtered.acceleration : outputs->seat_acceleration;
    const double deflection = low_pass ? state->filtered.deflection : outputs->suspension_deflection;
    outputs->seat_acceleration_measured = sensor_measure(acceleration, &c->accelerometer, time);
    outputs->suspension_deflection_measured = sensor_measure(deflection, &c->deflection_sensor, time);
}

/* Advance the low-pass of the sensors over a substep, from the outputs at its begin to those at its end. */
static void filter_signals(state_t *state, const seat_plant_outputs *begin, const seat_plant_outputs *end, double angle)
{
    state->filtered.acceleration =
        sensor_low_pass(state->filtered.acceleration, begin->seat_acceleration, end->seat_acceleration, angle);
    state->filtered.deflection =
        sensor_low_pass(state->filtered.deflection, begin->suspension_deflection, end->suspension_deflection, angle);
}

/* Take substeps of one length, from a time since the begin of the step on. The force is linear over each from `first`
 * to `last`, and the contact does not change. */
static void take_substeps(masses_t *masses, const floor_motion *motion, double begin, double h, double count,
                          double first, double last, double side, const coefficients_t *c)
{
    if (c->driver_model == SEAT_PLANT_SEATED) {
        for (double index = 0.0; index < count; index += 1.0) {
            seated_substep(masses, motion, first, last, side, begin + index * h, h, c);
        }
        return;
    }
    for (double index = 0.0; index < count; index += 1.0) {
        substep(masses, motion, first, last, side, begin + index * h, h, c);
    }
}

/* Return the time in s until the contact with an end stop begins or ends, infinite for never. Deflection, rate and
 * acceleration are those at the begin of the substep; the acceleration is taken as constant. */
static double time_to_contact(const seat_plant_outputs *begin, double side, const floor_motion *motion,
                              const coefficients_t *c)
{
    const double sign = side != 0.0 ? side : copysign(1.0, begin->deflection_rate);
    const double depth = sign * (begin->suspension_deflection + c->x_m) - c->x_e;
    const double rate = sign * begin->deflection_rate;
    const double square = rate * rate - 2.0 * depth * sign * (begin->seat_acceleration - motion->acceleration);
    if (square < 0.0) {
        return INFINITY;
    }
    const double divisor = rate + copysign(sqrt(square), rate);
    const double time = divisor != 0.0 ? -2.0 * depth / divisor : 0.0;
    return time > 0.0 ? time : INFINITY;
}

/* Take a substep, in two parts if a contact with an end stop begins or ends in it: the damper's force jumps there. */
static void substep_with_contact(masses_t *masses, const floor_motion *motion, double tau, double h, double first,
                                 double last, const coefficients_t *c)
{
    double begin = tau, length = h, side = 0.0;
    if (c->x_e < INFINITY) {
        seat_plant_outputs outputs;
        evaluate_outputs(masses, motion, first, 0.0, tau, c, &outputs);
        side = contact_side(outputs.suspension_deflection, c);
        const double part = time_to_contact(&outputs, side, motion, c);
        if (part < h) {
            const double middle = first + (last - first) * (part / h);
            take_substeps(masses, motion, tau, part, 1.0, first, middle, side, c);
            begin = tau + part;
            length = h - part;
            first = middle;
            side = side != 0.0 ? 0.0 : copysign(1.0, outputs.deflection_rate);
        }
    }
    take_substeps(masses, motion, begin, length, 1.0, first, last, side, c);
}

/* Integrate over a span of the step, in s since its begin, in which the target of the actuator is constant; `push` is
 * the force of an external driver in N. */
static void integrate_span(state_t *state, const floor_motion *motion, double push, double begin, double end,
                           const coefficients_t *c)
{
    const double count = runge_kutta_substep_count(end - begin, c->substep);
    const double h = (end - begin) / count;
    const int has_lag = c->actuator.time_constant > 0.0, has_low_pass = c->bandwidth > 0.0;
    actuator_lag prepared;
    const actuator_lag *lag = NULL;
    if (has_lag) {
        prepared = actuator_prepare_lag(&c->actuator, h);
        lag = &prepared;
    }
    const double target = state->actuator.target;
    double force = has_lag ? state->actuator.force : target;
    for (double index = 0.0; index < count; index += 1.0) {
        const double tau = begin + index * h;
        double first, last;
        seat_plant_outputs before, after;
        if (has_low_pass) {
            evaluate_outputs(&state->masses, motion, force, push, tau, c, &before);
        }
        force = actuator_apply_lag(force, target, lag, &first, &last);
        substep_with_contact(&state->masses, motion, tau, h, first + push, last + push, c);
        if (has_low_pass) {
            evaluate_outputs(&state->masses, motion, force, push, tau + h, c, &after);
            filter_signals(state, &before, &after, c->bandwidth * h);
        }
    }
    state->actuator.force = force;
}

/* Integrate over a step, span by span between the changes that leave the delay line of the actuator. */
static void integrate_spans(state_t *state, const floor_motion *motion, double push, double time, double step_size,
                            const coefficients_t *c)
{
    double begin = 0.0;
    while (begin < step_size) {
        const double end = actuator_release_due(&state->actuator, time, begin, step_size);
        integrate_span(state, motion, push, begin, end, c);
        begin = end;
    }
}

/* ---- the component ----------------------------------------------------------------------------------------------- */

/* Set stiffness and damping between seat and driver, for (1). */
static void prepare_contact(const seat_plant_parameters *p, coefficients_t *c)
{
    const int lumped = p->driver_model == SEAT_PLANT_LUMPED, seated = p->driver_model == SEAT_PLANT_SEATED;
    body_prepare(p->driver_mass, p->contact_stiffness, p->contact_damping, &c->body);
    c->driver_model = p->driver_model;
    c->k_c = lumped ? p->cushion_stiffness : seated ? c->body.k[0] : 0.0;
    c->c_c = lumped ? p->cushion_damping : seated ? c->body.c[0] : 0.0;
}

/* Return the longest substep in s for the fastest motion of these parameters, with the contact prepared. */
static double max_substep(const seat_plant_parameters *p, const coefficients_t *c)
{
    /* the largest slope of the friction: unloading at the plateau, d zeta/dy = A 2 gamma/(gamma + beta) */
    const double slope = 2.0 * p->friction_amplitude * p->friction_gamma / (p->friction_gamma + p->friction_beta);
    const int stops = p->end_stop_travel > 0.0, lumped = p->driver_model == SEAT_PLANT_LUMPED;
    const double elastic = p->suspension_stiffness + c->k_c + p->friction_alpha * slope;
    const double stiffness = elastic + (stops ? p->end_stop_stiffness : 0.0);
    const double damping = p->suspension_damping + c->c_c + (stops ? p->end_stop_damping : 0.0);
    const double lightest = lumped && p->driver_mass < p->seat_mass ? p->driver_mass : p->seat_mass;
    const double on_seat = sqrt(stiffness / lightest) + damping / lightest;
    const double in_body = p->driver_model == SEAT_PLANT_SEATED ? body_fastest(&c->body) : 0.0;
    return runge_kutta_substep_for(in_body > on_seat ? in_body : on_seat);
}

const char *seat_plant_prepare(const seat_plant_parameters *parameters, seat_plant_coefficients *coefficients)
{
    const seat_plant_parameters *p = parameters;
    coefficients_t *c = coefficients;
    if (!friction_prepare(p->friction_gamma, p->friction_beta, p->friction_amplitude, &c->friction)) {
        return "expected friction.A > 0 and friction.gamma > |friction.beta|";
    }
    if (p->end_stop_travel > 0.0 && !(p->end_stop_stiffness > 0.0)) {
        return "expected end_stop.stiffness > 0 where end_stop.travel > 0";
    }
    if (p->end_stop_travel > 0.0 && !(fabs(p->end_stop_height) < p->end_stop_travel)) {
        return "expected |end_stop.height| < end_stop.travel: static equilibrium is between the end stops";
    }
    prepare_contact(p, c);
    c->substep = max_substep(p, c);
    if (!(c->substep >= runge_kutta_min_substep)) {
        return "expected a fastest motion below 50000 rad/s from the stiffnesses suspension_stiffness, "
               "cushion_stiffness (driver.contact_stiffness of a seated driver), friction.alpha and end_stop.stiffness "
               "and the dampings suspension_damping, cushion_damping (driver.contact_damping of a seated driver) and "
               "end_stop.damping on seat_mass and driver_mass";
    }
    c->per_m_s = 1.0 / p->seat_mass;
    c->per_m_b = 1.0 / p->driver_mass;
    c->k_f = p->suspension_stiffness;
    c->c_f = p->suspension_damping;
    c->alpha = p->friction_alpha;
    c->floor_signals = p->floor_signals;
    c->x_e = p->end_stop_travel > 0.0 ? p->end_stop_travel : INFINITY;
    c->x_m = p->end_stop_height;
    c->k_e = p->end_stop_stiffness;
    c->c_e = p->end_stop_damping;
    c->actuator = actuator_prepare(p->actuator_force_limit, p->actuator_delay, p->actuator_time_constant);
    c->bandwidth = 2.0 * pi * p->sensor_bandwidth;
    c->single_span = p->actuator_delay == 0.0 && p->actuator_time_constant == 0.0 && p->sensor_bandwidth == 0.0 &&
                     !(p->end_stop_travel > 0.0);
    c->accelerometer =
        sensor_prepare(p->acceleration_noise, p->acceleration_bias, p->acceleration_resolution, p->sensor_seed, 1);
    c->deflection_sensor =
        sensor_prepare(p->deflection_noise, p->deflection_bias, p->deflection_resolution, p->sensor_seed, 2);
    return NULL;
}

const char *seat_plant_warning(const seat_plant_parameters *parameters)
{
    (void)parameters;
    return NULL;
}

int seat_plant_is_valid_state(const seat_plant_state *state, const seat_plant_parameters *parameters, double time)
{
    (void)parameters, (void)time;
    return actuator_is_valid_state(&state->actuator);
}

/* Return the force of an external driver in N, 0 with a driver inside. */
static double push_of(double driver_force, const coefficients_t *c)
{
    return c->driver_model == SEAT_PLANT_EXTERNAL ? driver_force : 0.0;
}

void seat_plant_initialize(seat_plant_state *state, const seat_plant_inputs *inputs,
                           const seat_plant_coefficients *coefficients, double time, seat_plant_outputs *outputs)
{
    const seat_plant_state rest = {0};
    const floor_motion motion = floor_motion_from_inputs(inputs);
    *state = rest;
    state->floor.displacement = motion.displacement;
    state->floor.velocity = motion.velocity;
    state->floor.acceleration = motion.acceleration;
    actuator_initialize(&state->actuator, inputs->force, &coefficients->actuator);
    const double push = push_of(inputs->driver_force, coefficients);
    evaluate_outputs(&state->masses, &motion, state->actuator.force, push, 0.0, coefficients, outputs);
    state->filtered.acceleration = outputs->seat_acceleration;
    state->filtered.deflection = outputs->suspension_deflection;
    add_measurements(state, coefficients, time, outputs);
}

floor_motion seat_plant_begin_step(seat_plant_state *state, const seat_plant_inputs *inputs,
                                   const seat_plant_coefficients *coefficients, double step_size)
{
    const int signals = coefficients->floor_signals;
    return signals == SEAT_PLANT_ALL ? floor_motion_from_inputs(inputs)
                                     : floor_derive_motion(&state->floor, inputs, signals, step_size);
}

void seat_plant_advance_on_floor(seat_plant_state *state, const floor_motion *motion, double force, double driver_force,
                                 const seat_plant_coefficients *coefficients, double time, double step_size,
                                 seat_plant_outputs *outputs)
{
    const double count = runge_kutta_substep_count(step_size, coefficients->substep);
    const double push = push_of(driver_force, coefficients);
    actuator_command(&state->actuator, force, &coefficients->actuator, time);
    if (coefficients->single_span && state->actuator.line_length == 0.0) {
        state->actuator.force = state->actuator.target;
        const double both = state->actuator.force + push;
        take_substeps(&state->masses, motion, 0.0, step_size / count, count, both, both, 0.0, coefficients);
    } else {
        integrate_spans(state, motion, push, time, step_size, coefficients);
    }
    evaluate_outputs(&state->masses, motion, state->actuator.force, push, step_size, coefficients, outputs);
    add_measurements(state, coefficients, time + step_size, outputs);
}

void seat_plant_advance(seat_plant_state *state, const seat_plant_inputs *inputs,
                        const seat_plant_coefficients *coefficients, double time, double step_size,
                        seat_plant_outputs *outputs)
{
    const floor_motion motion = seat_plant_begin_step(state, inputs, coefficients, step_size);
    seat_plant_advance_on_floor(state, &motion, inputs->force, inputs->driver_force, coefficients, time, step_size,
                                outputs);
}
