/* The seat: two masses on a suspension with Bouc-Wen friction (1)-(2), (35)-(36). See seat.h; seat.py, friction.py and
 * floor.py tell why it is integrated, solved and derived as it is.
 *
 *   m_s z_s'' = -k_f (z_s - z_v) - c_f (z_s' - z_v') + k_c (z_b - z_s) + c_c (z_b' - z_s') - f_r + u_sat        (1)
 *   m_b z_b'' = -k_c (z_b - z_s) - c_c (z_b' - z_s')                                                            (2)
 *   f_r       = alpha z_d                                                                                       (35)
 *   z_d'      = A_d v - gamma_d |v| |z_d| z_d - beta_d v z_d^2,   v = z_s' - z_v'                               (36)
 */
#include "seat.h"

#include <math.h>
#include <stddef.h>

typedef seat_plant_state state_t;
typedef seat_plant_coefficients coefficients_t;

/* Upper bound of the Runge-Kutta substep in s, substeps per radian of the fastest motion, and the substep in s that is
 * too short. */
static const double longest_substep = 0.5e-3;
static const double substeps_per_radian = 2.0;
static const double shortest_substep = 1e-5;

/* States of smaller magnitude are zero: fading out, they would become denormal, which is slow. */
static double flushed(double state)
{
    return fabs(state) < 1e-30 ? 0.0 : state;
}

/* ---- friction ---------------------------------------------------------------------------------------------------- */

/* A state within this share of the plateau is on it, and stays there as long as the deflection moves on. */
static const double settled = 1e-12;

static const double quarter_turn = 1.57079632679489661923;

/* Move z_d along a one-way change of the deflection, exactly: tanh while loading, tan while unloading, each written so
 * that it costs one exponential or one tangent. */
static double friction_state(double state, double increment, const seat_plant_friction *c)
{
    if (increment == 0.0) {
        return state;
    }
    double distance = fabs(increment);
    const double sign = increment >= 0.0 ? 1.0 : -1.0;
    double zeta = sign * state;
    if (zeta < 0.0) { /* unloading, up to zeta = 0 at most */
        const double depth = -zeta / c->unloading_scale;
        const double angle = c->unloading_rate * distance;
        const double climb = angle < quarter_turn ? tan(angle) : INFINITY;
        if (climb <= depth) {
            return sign * c->unloading_scale * (climb - depth) / (1.0 + climb * depth); /* tan(angle - atan(depth)) */
        }
        distance -= atan(depth) / c->unloading_rate;
        zeta = 0.0;
    }
    if (fabs(zeta - c->plateau) <= settled * c->plateau) {
        return sign * c->plateau;
    }
    const double fading = exp(-2.0 * c->loading_rate * distance); /* the step's tanh is (1 - fading)/(1 + fading) */
    const double rest = 1.0 + fading, rise = 1.0 - fading;
    return sign * (zeta * rest + c->plateau * rise) / (rest + zeta / c->plateau * rise);
}

/* Move z_d from one (deflection x, rate v) to the next, by way of the turning point where the rate, linear over the
 * substep, changes sign. */
static double turned(double friction, double x_0, double v_0, double x_1, double v_1, double h,
                     const seat_plant_friction *c)
{
    if (v_0 * v_1 < 0.0) {
        const double share = v_0 / (v_0 - v_1);
        const double turning = 0.5 * (x_0 + x_1 + h * (v_0 * share - v_1 * (1.0 - share)) * 0.5);
        friction = friction_state(friction, turning - x_0, c);
        x_0 = turning;
    }
    return friction_state(friction, x_1 - x_0, c);
}

/* ---- floor -------------------------------------------------------------------------------------------------------- */

/* A sample that comes sooner after the last one, in s, is left out: differences would show little but rounding. */
static const double shortest_interval = 1e-5;

/* The floor over a step: second-order Taylor series about the step's begin. */
typedef struct {
    double displacement, velocity, acceleration;
} floor_t;

static double displacement_at(const floor_t *floor, double tau)
{
    return floor->displacement + tau * (floor->velocity + 0.5 * tau * floor->acceleration);
}

static double velocity_at(const floor_t *floor, double tau)
{
    return floor->velocity + tau * floor->acceleration;
}

static floor_t given(const seat_plant_inputs *inputs)
{
    const floor_t floor = {inputs->floor_displacement, inputs->floor_velocity, inputs->floor_acceleration};
    return floor;
}

/* Start from the motion at initialisation, with the sample in place of its own part of it. */
static void first_sample(floor_t *node, const seat_plant_inputs *inputs, int signals)
{
    if (signals == SEAT_PLANT_DISPLACEMENT) {
        node->displacement = inputs->floor_displacement;
    } else if (signals == SEAT_PLANT_VELOCITY) {
        node->velocity = inputs->floor_velocity;
    } else {
        node->acceleration = inputs->floor_acceleration;
    }
}

/* Derive the motion at a new sample from that at the last one. */
static void next_sample(floor_t *node, double age, double interval, const seat_plant_inputs *inputs, int signals)
{
    const double z = node->displacement, v = node->velocity, a = node->acceleration;
    if (signals == SEAT_PLANT_DISPLACEMENT) {
        const double slope = (inputs->floor_displacement - z) / age;
        const double slope_before = v - 0.5 * a * interval;
        node->displacement = inputs->floor_displacement;
        node->acceleration = interval > 0.0 ? 2.0 * (slope - slope_before) / (age + interval) : 0.0;
        node->velocity = slope + 0.5 * age * node->acceleration;
    } else if (signals == SEAT_PLANT_VELOCITY) {
        node->velocity = inputs->floor_velocity;
        node->displacement = z + 0.5 * age * (v + node->velocity);
        node->acceleration = (node->velocity - v) / age;
    } else {
        node->acceleration = inputs->floor_acceleration;
        node->velocity = v + 0.5 * age * (a + node->acceleration);
        node->displacement = z + age * (v + age * (2.0 * a + node->acceleration) / 6.0);
    }
}

/* Derive the floor over a step from the one signal that is alive, and move its history to the step's end. */
static floor_t derived(state_t *state, const seat_plant_inputs *inputs, int signals, double step_size)
{
    const double age = state->floor_age;
    floor_t node = {state->floor_displacement, state->floor_velocity, state->floor_acceleration};
    floor_t floor;
    if (age > 0.0 && age < shortest_interval) {
        floor.displacement = displacement_at(&node, age);
        floor.velocity = velocity_at(&node, age);
        floor.acceleration = node.acceleration;
        state->floor_age = age + step_size;
    } else {
        if (age > 0.0) {
            next_sample(&node, age, state->floor_interval, inputs, signals);
            state->floor_interval = age;
        } else {
            first_sample(&node, inputs, signals);
            state->floor_reached = node.displacement;
        }
        floor = node;
        state->floor_age = step_size;
    }
    /* never faster than the error arose: a short step after a long one would be a jump */
    floor.velocity += (floor.displacement - state->floor_reached) / (step_size > age ? step_size : age);
    floor.displacement = state->floor_reached;
    state->floor_displacement = node.displacement;
    state->floor_velocity = node.velocity;
    state->floor_acceleration = node.acceleration;
    state->floor_reached = displacement_at(&floor, step_size);
    return floor;
}

/* ---- mechanics --------------------------------------------------------------------------------------------------- */

/* Solve (1) for z_s''; stretch is z_b - z_s, friction is z_d. */
static double seat_acceleration(double deflection, double rate, double stretch, double stretch_rate, double friction,
                                double force, const coefficients_t *c)
{
    const double suspension = -c->k_f * deflection - c->c_f * rate - c->alpha * friction;
    return (suspension + c->k_c * stretch + c->c_c * stretch_rate + force) * c->per_m_s;
}

/* Solve (2) for z_b''. */
static double driver_acceleration(double stretch, double stretch_rate, const coefficients_t *c)
{
    return (-c->k_c * stretch - c->c_c * stretch_rate) * c->per_m_b;
}

typedef struct {
    double seat, driver;
} accelerations;

/* Accelerations at a stage of the substep, tau seconds after the floor was given: the friction has come from z_d at the
 * deflection x_0. */
static accelerations slope(double z_s, double v_s, double z_b, double v_b, double tau, double z_d, double x_0,
                           const floor_t *floor, double force, const coefficients_t *c)
{
    const double x = z_s - displacement_at(floor, tau);
    const double v = v_s - velocity_at(floor, tau);
    const double friction = friction_state(z_d, x - x_0, &c->friction);
    const double stretch = z_b - z_s, stretch_rate = v_b - v_s;
    accelerations a;
    a.seat = seat_acceleration(x, v, stretch, stretch_rate, friction, force, c);
    a.driver = driver_acceleration(stretch, stretch_rate, c);
    return a;
}

/* One step of classical Runge-Kutta over the four mechanical states, friction in closed form at every stage; h is the
 * substep's length. */
static void substep(state_t *state, const floor_t *floor, double force, double tau, double h, const coefficients_t *c)
{
    const double z_s = state->seat_displacement, v_s = state->seat_velocity;
    const double z_b = state->driver_displacement, v_b = state->driver_velocity;
    const double z_d = state->friction;
    const double x_0 = z_s - displacement_at(floor, tau);
    const double half = 0.5 * h;
    const accelerations a_1 = slope(z_s, v_s, z_b, v_b, tau, z_d, x_0, floor, force, c);
    const double v_s2 = v_s + half * a_1.seat, v_b2 = v_b + half * a_1.driver;
    const accelerations a_2 =
        slope(z_s + half * v_s, v_s2, z_b + half * v_b, v_b2, tau + half, z_d, x_0, floor, force, c);
    const double v_s3 = v_s + half * a_2.seat, v_b3 = v_b + half * a_2.driver;
    const accelerations a_3 =
        slope(z_s + half * v_s2, v_s3, z_b + half * v_b2, v_b3, tau + half, z_d, x_0, floor, force, c);
    const double v_s4 = v_s + h * a_3.seat, v_b4 = v_b + h * a_3.driver;
    const accelerations a_4 = slope(z_s + h * v_s3, v_s4, z_b + h * v_b3, v_b4, tau + h, z_d, x_0, floor, force, c);
    const double sixth = h / 6.0;
    const double z_s_end = z_s + sixth * (v_s + 2.0 * (v_s2 + v_s3) + v_s4);
    const double z_b_end = z_b + sixth * (v_b + 2.0 * (v_b2 + v_b3) + v_b4);
    const double v_s_end = v_s + sixth * (a_1.seat + 2.0 * (a_2.seat + a_3.seat) + a_4.seat);
    const double v_b_end = v_b + sixth * (a_1.driver + 2.0 * (a_2.driver + a_3.driver) + a_4.driver);
    const double x_end = z_s_end - displacement_at(floor, tau + h);
    const double z_d_end = turned(z_d, x_0, v_s - velocity_at(floor, tau), x_end,
                                  v_s_end - velocity_at(floor, tau + h), h, &c->friction);
    state->seat_displacement = flushed(z_s_end);
    state->seat_velocity = flushed(v_s_end);
    state->driver_displacement = flushed(z_b_end);
    state->driver_velocity = flushed(v_b_end);
    state->friction = flushed(z_d_end);
}

/* Outputs of a state, tau seconds after the floor was given, the force still acting. */
static void evaluate(const state_t *state, const floor_t *floor, double force, double tau, const coefficients_t *c,
                     seat_plant_outputs *outputs)
{
    const double deflection = state->seat_displacement - displacement_at(floor, tau);
    const double rate = state->seat_velocity - velocity_at(floor, tau);
    const double stretch = state->driver_displacement - state->seat_displacement;
    const double stretch_rate = state->driver_velocity - state->seat_velocity;
    outputs->seat_acceleration =
        seat_acceleration(deflection, rate, stretch, stretch_rate, state->friction, force, c);
    outputs->suspension_deflection = deflection;
    outputs->deflection_rate = rate;
    outputs->driver_acceleration = driver_acceleration(stretch, stretch_rate, c);
    outputs->seat_displacement = state->seat_displacement;
    outputs->driver_displacement = state->driver_displacement;
    outputs->friction_force = c->alpha * state->friction; /* (35) */
    outputs->seat_acceleration_measured = outputs->seat_acceleration;
    outputs->suspension_deflection_measured = deflection;
}

/* ---- the component ----------------------------------------------------------------------------------------------- */

/* Prepare the closed-form step of (36); false where it has no plateau. */
static int bouc_wen(double gamma, double beta, double amplitude, seat_plant_friction *c)
{
    const double loading = gamma + beta, unloading = gamma - beta;
    if (!(amplitude > 0.0 && loading > 0.0 && unloading > 0.0)) {
        return 0;
    }
    c->plateau = sqrt(amplitude / loading);
    c->loading_rate = sqrt(amplitude * loading);
    c->unloading_scale = sqrt(amplitude / unloading);
    c->unloading_rate = sqrt(amplitude * unloading);
    return 1;
}

/* Substep in s for the fastest motion that these parameters allow. */
static double substep_for(const seat_plant_parameters *p)
{
    /* the steepest friction can get: unloading at the plateau, d zeta/dy = A 2 gamma/(gamma + beta) */
    const double slope = 2.0 * p->friction_amplitude * p->friction_gamma / (p->friction_gamma + p->friction_beta);
    const double stiffness = p->suspension_stiffness + p->cushion_stiffness + p->friction_alpha * slope;
    const double damping = p->suspension_damping + p->cushion_damping;
    const double lightest = p->driver_mass < p->seat_mass ? p->driver_mass : p->seat_mass;
    const double fastest = sqrt(stiffness / lightest) + damping / lightest;
    const double needed = 1.0 / (substeps_per_radian * fastest);
    return fastest > 0.0 && !(longest_substep <= needed) ? needed : longest_substep;
}

const char *seat_plant_prepare(const seat_plant_parameters *parameters, seat_plant_coefficients *coefficients)
{
    const seat_plant_parameters *p = parameters;
    coefficients_t *c = coefficients;
    if (!bouc_wen(p->friction_gamma, p->friction_beta, p->friction_amplitude, &c->friction)) {
        return "expected friction.A > 0 and friction.gamma > |friction.beta|";
    }
    c->substep = substep_for(p);
    if (!(c->substep >= shortest_substep)) {
        return "expected a fastest motion below 50000 rad/s from the stiffnesses suspension_stiffness, "
               "cushion_stiffness and friction.alpha and the dampings suspension_damping and cushion_damping "
               "on seat_mass and driver_mass";
    }
    c->per_m_s = 1.0 / p->seat_mass;
    c->per_m_b = 1.0 / p->driver_mass;
    c->k_f = p->suspension_stiffness;
    c->c_f = p->suspension_damping;
    c->k_c = p->cushion_stiffness;
    c->c_c = p->cushion_damping;
    c->alpha = p->friction_alpha;
    c->floor_signals = p->floor_signals;
    return NULL;
}

const char *seat_plant_warning(const seat_plant_parameters *parameters)
{
    (void)parameters;
    return NULL;
}

void seat_plant_initial(seat_plant_state *state, const seat_plant_inputs *inputs,
                        const seat_plant_coefficients *coefficients, double time, seat_plant_outputs *outputs)
{
    const seat_plant_state rest = {0};
    const floor_t floor = given(inputs);
    (void)time;
    *state = rest;
    state->floor_displacement = floor.displacement;
    state->floor_velocity = floor.velocity;
    state->floor_acceleration = floor.acceleration;
    evaluate(state, &floor, inputs->force, 0.0, coefficients, outputs);
}

void seat_plant_advance(seat_plant_state *state, const seat_plant_inputs *inputs,
                        const seat_plant_coefficients *coefficients, double time, double step_size,
                        seat_plant_outputs *outputs)
{
    const double needed = ceil(step_size / coefficients->substep - 1e-6);
    const double count = needed > 1.0 ? needed : 1.0;
    const double h = step_size / count;
    const int signals = coefficients->floor_signals;
    const floor_t floor = signals == SEAT_PLANT_ALL ? given(inputs) : derived(state, inputs, signals, step_size);
    (void)time;
    for (double index = 0.0; index < count; index += 1.0) {
        substep(state, &floor, inputs->force, index * h, h, coefficients);
    }
    evaluate(state, &floor, inputs->force, step_size, coefficients, outputs);
}
