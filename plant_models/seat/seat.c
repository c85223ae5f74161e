/* The seat: two masses on a suspension with Bouc-Wen friction (1)-(2), (35)-(36). See seat.h; seat.py and friction.py
 * tell why it is integrated and solved as it is.
 *
 *   m_s z_s'' = -k_f (z_s - z_v) - c_f (z_s' - z_v') + k_c (z_b - z_s) + c_c (z_b' - z_s') - f_r + u_sat        (1)
 *   m_b z_b'' = -k_c (z_b - z_s) - c_c (z_b' - z_s')                                                            (2)
 *   f_r       = alpha z_d                                                                                       (35)
 *   z_d'      = A_d v - gamma_d |v| |z_d| z_d - beta_d v z_d^2,   v = z_s' - z_v'                               (36)
 */
#include "seat.h"

#include "random_numbers.h"
#include "subnormal.h"

#include <math.h>
#include <stddef.h>

typedef seat_plant_state state_t;
typedef seat_plant_masses masses_t;
typedef seat_plant_coefficients coefficients_t;

/* Upper bound of the Runge-Kutta substep in s, substeps per radian of the fastest motion, and the substep in s that is
 * too short. */
static const double longest_substep = 0.5e-3;
static const double substeps_per_radian = 2.0;
static const double shortest_substep = 1e-5;

static const double pi = 3.14159265358979323846;

/* ---- mechanics --------------------------------------------------------------------------------------------------- */

/* Which end stop is touched: 1 the upper, -1 the lower, 0 none. */
static double contact_side(double deflection, const coefficients_t *c)
{
    return fabs(deflection) <= c->x_e ? 0.0 : deflection > 0.0 ? 1.0 : -1.0;
}

/* An end stop's part of z_s'': like rubber, it never pulls. */
static double end_stop(double deflection, double rate, double side, const coefficients_t *c)
{
    const double push = c->k_e * (side * deflection - c->x_e) + c->c_e * side * rate;
    return -side * (push > 0.0 ? push : 0.0) * c->per_m_s;
}

/* Solve (1) for z_s'', end stops aside; , friction is z_d. */
static double seat_acceleration(double deflection, double rate, double cushion_deflection, double cushion_rate, double friction,
                                double force, const coefficients_t *c)
{
    const double suspension = -c->k_f * deflection - c->c_f * rate - c->alpha * friction;
    return (suspension + c->k_c * cushion_deflection + c->c_c * cushion_rate + force) * c->per_m_s;
}

/* Solve (2) for z_b''. */
static double driver_acceleration(double cushion_deflection, double cushion_rate, const coefficients_t *c)
{
    return (-c->k_c * cushion_deflection - c->c_c * cushion_rate) * c->per_m_b;
}

typedef struct {
    double seat, driver;
} accelerations;

/* Accelerations at a stage of the substep, tau seconds after the floor was given: the friction has come from z_d at the
 * deflection x_0. */
static accelerations slope(double z_s, double v_s, double z_b, double v_b, double tau, double z_d, double x_0,
                           const floor_motion *floor, double force, double side, const coefficients_t *c)
{
    const double x = z_s - floor_displacement_at(floor, tau);
    const double v = v_s - floor_velocity_at(floor, tau);
    const double friction = friction_state(z_d, x - x_0, &c->friction);
    const double cushion_deflection = z_b - z_s, cushion_rate = v_b - v_s;
    accelerations a;
    a.seat = seat_acceleration(x, v, cushion_deflection, cushion_rate, friction, force, c);
    if (side != 0.0) {
        a.seat += end_stop(x, v, side, c);
    }
    a.driver = driver_acceleration(cushion_deflection, cushion_rate, c);
    return a;
}

/* One step of classical Runge-Kutta over the four mechanical states, friction in closed form at every stage; h is the
 * substep's length, the force is straight between its ends, side is the end stop that is touched all the while. */
static void substep(masses_t *masses, const floor_motion *floor, double first, double last, double side, double tau, double h,
                    const coefficients_t *c)
{
    const double middle = 0.5 * (first + last);
    const double z_s = masses->seat_displacement, v_s = masses->seat_velocity;
    const double z_b = masses->driver_displacement, v_b = masses->driver_velocity;
    const double z_d = masses->friction;
    const double x_0 = z_s - floor_displacement_at(floor, tau);
    const double half = 0.5 * h;
    const accelerations a_1 = slope(z_s, v_s, z_b, v_b, tau, z_d, x_0, floor, first, side, c);
    const double v_s2 = v_s + half * a_1.seat, v_b2 = v_b + half * a_1.driver;
    const accelerations a_2 =
        slope(z_s + half * v_s, v_s2, z_b + half * v_b, v_b2, tau + half, z_d, x_0, floor, middle, side, c);
    const double v_s3 = v_s + half * a_2.seat, v_b3 = v_b + half * a_2.driver;
    const accelerations a_3 =
        slope(z_s + half * v_s2, v_s3, z_b + half * v_b2, v_b3, tau + half, z_d, x_0, floor, middle, side, c);
    const double v_s4 = v_s + h * a_3.seat, v_b4 = v_b + h * a_3.driver;
    const accelerations a_4 = slope(z_s + h * v_s3, v_s4, z_b + h * v_b3, v_b4, tau + h, z_d, x_0, floor, last, side, c);
    const double sixth = h / 6.0;
    const double z_s_end = z_s + sixth * (v_s + 2.0 * (v_s2 + v_s3) + v_s4);
    const double z_b_end = z_b + sixth * (v_b + 2.0 * (v_b2 + v_b3) + v_b4);
    const double v_s_end = v_s + sixth * (a_1.seat + 2.0 * (a_2.seat + a_3.seat) + a_4.seat);
    const double v_b_end = v_b + sixth * (a_1.driver + 2.0 * (a_2.driver + a_3.driver) + a_4.driver);
    const double x_end = z_s_end - floor_displacement_at(floor, tau + h);
    const double z_d_end = friction_through_reversal(z_d, x_0, v_s - floor_velocity_at(floor, tau), x_end,
                                  v_s_end - floor_velocity_at(floor, tau + h), h, &c->friction);
    masses->seat_displacement = flush_subnormal(z_s_end);
    masses->seat_velocity = flush_subnormal(v_s_end);
    masses->driver_displacement = flush_subnormal(z_b_end);
    masses->driver_velocity = flush_subnormal(v_b_end);
    masses->friction = flush_subnormal(z_d_end);
}

/* Outputs of a state, tau seconds after the floor was given, the force still acting. */
static inline void evaluate(const masses_t *masses, const floor_motion *floor, double force, double tau, const coefficients_t *c,
                     seat_plant_outputs *outputs)
{
    const double deflection = masses->seat_displacement - floor_displacement_at(floor, tau);
    const double rate = masses->seat_velocity - floor_velocity_at(floor, tau);
    const double cushion_deflection = masses->driver_displacement - masses->seat_displacement;
    const double cushion_rate = masses->driver_velocity - masses->seat_velocity;
    outputs->seat_acceleration =
        seat_acceleration(deflection, rate, cushion_deflection, cushion_rate, masses->friction, force, c);
    const double side = contact_side(deflection, c);
    if (side != 0.0) {
        outputs->seat_acceleration += end_stop(deflection, rate, side, c);
    }
    outputs->suspension_deflection = deflection;
    outputs->deflection_rate = rate;
    outputs->driver_acceleration = driver_acceleration(cushion_deflection, cushion_rate, c);
    outputs->seat_displacement = masses->seat_displacement;
    outputs->driver_displacement = masses->driver_displacement;
    outputs->friction_force = c->alpha * masses->friction; /* (35) */
}

/* Add what the sensors make of the truth, or of what has passed their low-pass. */
static void report(const state_t *state, const coefficients_t *c, double time, seat_plant_outputs *outputs)
{
    const int low_pass = c->bandwidth > 0.0;
    const double acceleration = low_pass ? state->sensed.acceleration : outputs->seat_acceleration;
    const double deflection = low_pass ? state->sensed.deflection : outputs->suspension_deflection;
    outputs->seat_acceleration_measured = sensor_reading(acceleration, &c->accelerometer, time);
    outputs->suspension_deflection_measured = sensor_reading(deflection, &c->deflection_sensor, time);
}

/* Move the sensors' low-pass over a substep, from the outputs at its begin to those at its end. */
static void sense(state_t *state, const seat_plant_outputs *begin, const seat_plant_outputs *end, double angle)
{
    state->sensed.acceleration =
        sensor_low_passed(state->sensed.acceleration, begin->seat_acceleration, end->seat_acceleration, angle);
    state->sensed.deflection =
        sensor_low_passed(state->sensed.deflection, begin->suspension_deflection, end->suspension_deflection, angle);
}

/* How many substeps a time takes. */
static double substeps(double time, const coefficients_t *c)
{
    const double needed = ceil(time / c->substep - 1e-6);
    return needed > 1.0 ? needed : 1.0;
}

/* Integrate over substeps of one length, from a time since the step's begin on; the force is straight over each, and one
 * end stop touched, or none. */
static void integrate(masses_t *masses, const floor_motion *floor, double begin, double h, double count, double first,
                      double last, double side, const coefficients_t *c)
{
    for (double index = 0.0; index < count; index += 1.0) {
        substep(masses, floor, first, last, side, begin + index * h, h, c);
    }
}

/* When an end stop is met or left, in s, as deflection, rate and acceleration show; infinity for never. */
static double until_contact(const seat_plant_outputs *begin, double side, const floor_motion *floor, const coefficients_t *c)
{
    const double sign = side != 0.0 ? side : copysign(1.0, begin->deflection_rate);
    const double depth = sign * begin->suspension_deflection - c->x_e;
    const double rate = sign * begin->deflection_rate;
    const double square = rate * rate - 2.0 * depth * sign * (begin->seat_acceleration - floor->acceleration);
    if (square < 0.0) {
        return INFINITY;
    }
    const double divisor = rate + copysign(sqrt(square), rate);
    const double time = divisor != 0.0 ? -2.0 * depth / divisor : 0.0;
    return time > 0.0 ? time : INFINITY;
}

/* Take a substep, in two parts where an end stop is met or left on the way: its damper's force jumps there. */
static void substep_with_contact(masses_t *masses, const floor_motion *floor, double tau, double h, double first, double last,
                    const coefficients_t *c)
{
    double begin = tau, length = h, side = 0.0;
    if (c->x_e < INFINITY) {
        seat_plant_outputs outputs;
        evaluate(masses, floor, first, tau, c, &outputs);
        side = contact_side(outputs.suspension_deflection, c);
        const double part = until_contact(&outputs, side, floor, c);
        if (part < h) {
            const double middle = first + (last - first) * (part / h);
            integrate(masses, floor, tau, part, 1.0, first, middle, side, c);
            begin = tau + part;
            length = h - part;
            first = middle;
            side = side != 0.0 ? 0.0 : copysign(1.0, outputs.deflection_rate);
        }
    }
    integrate(masses, floor, begin, length, 1.0, first, last, side, c);
}

/* Integrate over a span of the step, in s since its begin, in which the actuator's target holds. The force may lag behind
 * it, and the sensors behind the truth. */
static void integrate_span(state_t *state, const floor_motion *floor, double begin, double end, const coefficients_t *c)
{
    const double count = substeps(end - begin, c);
    const double h = (end - begin) / count;
    const int lagging = c->actuator.time_constant > 0.0, low_pass = c->bandwidth > 0.0;
    const actuator_lag lag = lagging ? actuator_lag_for(&c->actuator, h) : actuator_no_lag;
    const double target = state->actuator.target;
    double force = lagging ? state->actuator.force : target;
    for (double index = 0.0; index < count; index += 1.0) {
        const double tau = begin + index * h, deviation = force - target;
        const double first = lagging ? target + deviation * lag.first : target;
        const double last = lagging ? target + deviation * lag.last : target;
        seat_plant_outputs before, after;
        if (low_pass) {
            evaluate(&state->masses, floor, force, tau, c, &before);
        }
        force = lagging ? flush_subnormal(target + deviation * lag.left) : target;
        substep_with_contact(&state->masses, floor, tau, h, first, last, c);
        if (low_pass) {
            evaluate(&state->masses, floor, force, tau + h, c, &after);
            sense(state, &before, &after, c->bandwidth * h);
        }
    }
    state->actuator.force = force;
}

/* Integrate over a step, span by span between the changes that leave the actuator's delay. */
static void integrate_spans(state_t *state, const floor_motion *floor, double time, double step_size, const coefficients_t *c)
{
    double begin = 0.0;
    while (begin < step_size) {
        const double end = actuator_arrive(&state->actuator, time, begin, step_size);
        integrate_span(state, floor, begin, end, c);
        begin = end;
    }
}

/* ---- the component ----------------------------------------------------------------------------------------------- */

/* Substep in s for the fastest motion that these parameters allow. */
static double substep_for(const seat_plant_parameters *p)
{
    /* the steepest friction can get: unloading at the plateau, d zeta/dy = A 2 gamma/(gamma + beta) */
    const double slope = 2.0 * p->friction_amplitude * p->friction_gamma / (p->friction_gamma + p->friction_beta);
    const int stops = p->end_stop_travel > 0.0;
    const double elastic = p->suspension_stiffness + p->cushion_stiffness + p->friction_alpha * slope;
    const double stiffness = elastic + (stops ? p->end_stop_stiffness : 0.0);
    const double damping = p->suspension_damping + p->cushion_damping + (stops ? p->end_stop_damping : 0.0);
    const double lightest = p->driver_mass < p->seat_mass ? p->driver_mass : p->seat_mass;
    const double fastest = sqrt(stiffness / lightest) + damping / lightest;
    const double needed = 1.0 / (substeps_per_radian * fastest);
    return fastest > 0.0 && !(longest_substep <= needed) ? needed : longest_substep;
}

static sensor_coefficients sensor(double noise, double bias, double resolution, int seed, uint32_t number)
{
    const int ideal = noise == 0.0 && bias == 0.0 && resolution == 0.0;
    const sensor_coefficients prepared = {noise, bias, resolution, random_stream((uint32_t)seed, number), ideal};
    return prepared;
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
    c->substep = substep_for(p);
    if (!(c->substep >= shortest_substep)) {
        return "expected a fastest motion below 50000 rad/s from the stiffnesses suspension_stiffness, "
               "cushion_stiffness, friction.alpha and end_stop.stiffness and the dampings suspension_damping, "
               "cushion_damping and end_stop.damping on seat_mass and driver_mass";
    }
    c->per_m_s = 1.0 / p->seat_mass;
    c->per_m_b = 1.0 / p->driver_mass;
    c->k_f = p->suspension_stiffness;
    c->c_f = p->suspension_damping;
    c->k_c = p->cushion_stiffness;
    c->c_c = p->cushion_damping;
    c->alpha = p->friction_alpha;
    c->floor_signals = p->floor_signals;
    c->x_e = p->end_stop_travel > 0.0 ? p->end_stop_travel : INFINITY;
    c->k_e = p->end_stop_stiffness;
    c->c_e = p->end_stop_damping;
    c->actuator.limit = p->actuator_force_limit > 0.0 ? p->actuator_force_limit : INFINITY;
    c->actuator.delay = p->actuator_delay;
    c->actuator.time_constant = p->actuator_time_constant;
    c->bandwidth = 2.0 * pi * p->sensor_bandwidth;
    c->steady = p->actuator_delay == 0.0 && p->actuator_time_constant == 0.0 && p->sensor_bandwidth == 0.0 &&
                !(p->end_stop_travel > 0.0);
    c->accelerometer =
        sensor(p->acceleration_noise, p->acceleration_bias, p->acceleration_resolution, p->sensor_seed, 1);
    c->deflection_sensor =
        sensor(p->deflection_noise, p->deflection_bias, p->deflection_resolution, p->sensor_seed, 2);
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

void seat_plant_initial(seat_plant_state *state, const seat_plant_inputs *inputs,
                        const seat_plant_coefficients *coefficients, double time, seat_plant_outputs *outputs)
{
    const seat_plant_state rest = {0};
    const floor_motion floor = floor_given(inputs);
    *state = rest;
    state->floor.displacement = floor.displacement;
    state->floor.velocity = floor.velocity;
    state->floor.acceleration = floor.acceleration;
    actuator_settle(&state->actuator, inputs->force, &coefficients->actuator);
    evaluate(&state->masses, &floor, state->actuator.force, 0.0, coefficients, outputs);
    state->sensed.acceleration = outputs->seat_acceleration;
    state->sensed.deflection = outputs->suspension_deflection;
    report(state, coefficients, time, outputs);
}

void seat_plant_advance(seat_plant_state *state, const seat_plant_inputs *inputs,
                        const seat_plant_coefficients *coefficients, double time, double step_size,
                        seat_plant_outputs *outputs)
{
    const int signals = coefficients->floor_signals;
    const floor_motion floor = signals == SEAT_PLANT_ALL ? floor_given(inputs) : floor_derived(&state->floor, inputs, signals, step_size);
    const double count = substeps(step_size, coefficients);
    actuator_command(&state->actuator, inputs->force, &coefficients->actuator, time);
    if (coefficients->steady && state->actuator.line_length == 0.0) {
        state->actuator.force = state->actuator.target;
        integrate(&state->masses, &floor, 0.0, step_size / count, count, state->actuator.force, state->actuator.force, 0.0,
                  coefficients);
    } else {
        integrate_spans(state, &floor, time, step_size, coefficients);
    }
    evaluate(&state->masses, &floor, state->actuator.force, step_size, coefficients, outputs);
    report(state, coefficients, time + step_size, outputs);
}
