/* The sampled controller: rate filter, observer (21), control law (24), saturation (6), torque (33). See controller.h.
 *
 * One sample k, with delta the measured deflection, Y_2 the measured seat acceleration and h the sample time:
 *
 *   v_k   = (tau v_(k-1) + delta_k - delta_(k-1)) / (tau + h),   tau = 1/(2 pi f_c)
 *   F_k   = F_(k-1) + h L_h [ Y_2 - ( -(k_f/M) delta_k + (u_(k-1) - F_(k-1))/M ) ]                  (21)
 *   u_k   = K_h [delta_k, v_k]' + F_k                                                               (24)
 *   u_sat = clip(u_k, -u_lim, u_lim)                                                                (6)
 *   T     = u_sat sqrt(L^2 - (h_0 + delta_k)^2) / (2 r_g)                                           (33)
 *
 * A sample costs 10 multiplications, 10 additions and a square root.
 */
#include "controller.h"

#include "sampling.h"

#include <math.h>
#include <stddef.h>

typedef seat_controller_real real;

#define REAL(number) ((real)(number))

/* Largest distance of the next sample from the time that a run has reached, in s; allows for rounding errors of hosts.
 */
static const double clock_tolerance = 1.0;

/* Return a state, or zero if its magnitude is below 1e-30: arithmetic with subnormal numbers is slow. */
static real flush_subnormal(real state)
{
    const real smallest = REAL(1e-30);
    return state < smallest && state > -smallest ? REAL(0.0) : state;
}

static real square_root(real x)
{
    return sizeof(real) == sizeof(float) ? REAL(sqrtf((float)x)) : REAL(sqrt((double)x));
}

/* Vertices of the Takagi-Sugeno model: M_min and M_max, the total masses (4) in kg. */
typedef struct {
    real minimum, maximum;
} mass_range;

/* Return the membership h_1 (12) of the total mass M in kg, clamped to [0, 1]; h_2 = 1 - h_1. */
static real membership(mass_range range, real mass)
{
    const real slowest = REAL(1.0) / range.maximum, fastest = REAL(1.0) / range.minimum;
    const real h_1 = (REAL(1.0) / mass - slowest) / (fastest - slowest);
    return h_1 > REAL(1.0) ? REAL(1.0) : h_1 > REAL(0.0) ? h_1 : REAL(0.0);
}

/* Return L_i in kg/s: as set, or D_2i/Gamma with D_2i = 1/M_i (23) where it is 0. */
static real observer_gain(real set, real mass, real gamma)
{
    return set < REAL(0.0) || set > REAL(0.0) ? set : REAL(1.0) / (mass * gamma);
}

const char *seat_controller_prepare(const seat_controller_parameters *parameters,
                                    seat_controller_coefficients *coefficients)
{
    const seat_controller_parameters *p = parameters;
    seat_controller_coefficients *c = coefficients;
    if (!(p->driver_mass_min < p->driver_mass_max)) {
        return "expected driver_mass_min < driver_mass_max";
    }
    const mass_range range = {p->driver_mass_min + p->seat_mass, p->driver_mass_max + p->seat_mass};
    if (!(REAL(1.0) / range.maximum < REAL(1.0) / range.minimum)) {
        return "expected driver_mass_min < driver_mass_max by more than is lost beside seat_mass";
    }
    const real mass = p->driver_mass + p->seat_mass; /* (4) */
    const real h_1 = membership(range, mass), h_2 = REAL(1.0) - h_1;
    const real L_1 = observer_gain(p->L1, range.minimum, p->observer_gamma);
    const real L_2 = observer_gain(p->L2, range.maximum, p->observer_gamma);
    const real h = p->sample_time;
    const real hL = h * (h_1 * L_1 + h_2 * L_2);
    const real D_2 = h_1 / range.minimum + h_2 / range.maximum; /* 1/M (11) */
    rate_filter(p->rate_filter_cutoff, h, &c->rate_decay, &c->rate_gain);
    c->observer_acceleration = hL;
    c->observer_deflection = hL * p->suspension_stiffness * D_2;
    c->observer_force = hL * D_2;
    c->deflection_gain = h_1 * p->K1_deflection + h_2 * p->K2_deflection;
    c->rate_gain_K = h_1 * p->K1_rate + h_2 * p->K2_rate;
    c->limit = p->force_limit;
    c->link_squared = p->link_length * p->link_length;
    c->height = p->initial_height;
    c->torque_gain = REAL(1.0) / (REAL(2.0) * p->gear_ratio);
    c->enabled = p->enabled;
    c->anti_windup = p->anti_windup;
    c->sample_time = (double)h;
    c->is_robust = p->mode == SEAT_CONTROLLER_ROBUST;
    return robust_prepare(p, &c->robust);
}

const char *seat_controller_warning(const seat_controller_parameters *parameters)
{
    const seat_controller_parameters *p = parameters;
    const int within = p->driver_mass_min <= p->driver_mass && p->driver_mass <= p->driver_mass_max;
    if (within || p->mode == SEAT_CONTROLLER_ROBUST) {
        return NULL;
    }
    return "driver_mass lies outside [driver_mass_min, driver_mass_max]: the gains of the nearer end are used";
}

/* Evaluate the outputs of the last sample, the motor torque (33) with its radicand clamped at 0. */
static void held_outputs(const seat_controller_state *state, const seat_controller_coefficients *c,
                         seat_controller_outputs *outputs)
{
    const real height = c->height + state->deflection;
    const real radicand = c->link_squared - height * height;
    outputs->force = state->force;
    outputs->force_demand = state->demand;
    outputs->motor_torque = radicand > REAL(0.0) ? state->force * square_root(radicand) * c->torque_gain : REAL(0.0);
    outputs->disturbance_estimate = state->estimate;
    outputs->deflection_rate = state->rate;
    outputs->saturated = state->demand > state->force || state->demand < state->force;
    outputs->fault = (int)state->robust.faults.fault;
    const estimator_state *estimates = &state->robust.estimator;
    const estimator_coefficients *nominal = &c->robust.estimator;
    outputs->driver_mass_estimate = c->is_robust ? estimates->mass : nominal->nominal_mass;
    outputs->friction_estimate = c->is_robust ? estimates->friction : nominal->nominal_friction;
    outputs->driver_mass_trusted = estimates->mass_trusted;
    outputs->friction_trusted = estimates->friction_trusted;
}

/* Take one sample of the mode robust. A measurement that is not finite changes the fault alone. */
static void robust_sample_step(seat_controller_state *state, const seat_controller_inputs *inputs,
                               const seat_controller_coefficients *c)
{
    const real given = inputs->suspension_deflection;
    const real previous = state->started ? state->deflection : given - given < REAL(1.0) ? given : REAL(0.0);
    const real delta = given - given < REAL(1.0) ? given : previous;
    const real v = filtered_rate(state->rate, previous, delta, c->rate_decay, c->rate_gain);
    const robust_sample measured = {inputs->seat_acceleration, given, previous, v, state->force, c->enabled};
    real demand, force;
    robust_step(&state->robust, &measured, &c->robust, &demand, &force);
    state->started = true;
    state->deflection = flush_subnormal(delta);
    state->rate = flush_subnormal(v);
    state->demand = flush_subnormal(demand);
    state->force = flush_subnormal(force);
    state->estimate = state->robust.active ? state->robust.estimate : REAL(0.0);
}

/* Take one sample of the published law. */
static void published_sample(seat_controller_state *state, const seat_controller_inputs *inputs,
                             const seat_controller_coefficients *c)
{
    const real delta = inputs->suspension_deflection;
    const real previous = state->started ? state->deflection : delta;
    const real v = filtered_rate(state->rate, previous, delta, c->rate_decay, c->rate_gain);
    real F_hat = REAL(0.0), u = REAL(0.0), u_sat = REAL(0.0);
    if (c->enabled) {
        const real applied = c->anti_windup ? state->force : state->demand;
        const real innovation = c->observer_acceleration * inputs->seat_acceleration + c->observer_deflection * delta;
        F_hat = state->estimate + innovation - c->observer_force * (applied - state->estimate); /* (21) */
        u = c->deflection_gain * delta + c->rate_gain_K * v + F_hat;                            /* (24) */
        u_sat = u < -c->limit ? -c->limit : u > c->limit ? c->limit : u;                        /* (6) */
    }
    state->started = true;
    state->deflection = flush_subnormal(delta);
    state->rate = flush_subnormal(v);
    state->demand = flush_subnormal(u);
    state->force = flush_subnormal(u_sat);
    state->estimate = flush_subnormal(F_hat);
}

/* Take one sample. */
static void sample(seat_controller_state *state, const seat_controller_inputs *inputs,
                   const seat_controller_coefficients *c)
{
    if (c->is_robust) {
        robust_sample_step(state, inputs, c);
    } else {
        published_sample(state, inputs, c);
    }
}

int seat_controller_is_valid_state(const seat_controller_state *state, const seat_controller_parameters *parameters,
                                   double time)
{
    return fabs(state->next_sample * (double)parameters->sample_time - time) <= clock_tolerance &&
           robust_is_valid_state(&state->robust, parameters);
}

void seat_controller_start(seat_controller_state *state, const seat_controller_coefficients *coefficients)
{
    const seat_controller_state before_the_first = {0};
    *state = before_the_first;
    robust_start(&state->robust, &coefficients->robust);
}

void seat_controller_step(seat_controller_state *state, const seat_controller_inputs *inputs,
                          const seat_controller_coefficients *coefficients, seat_controller_outputs *outputs)
{
    sample(state, inputs, coefficients);
    held_outputs(state, coefficients, outputs);
}

void seat_controller_initialize(seat_controller_state *state, const seat_controller_inputs *inputs,
                                const seat_controller_coefficients *coefficients, double time,
                                seat_controller_outputs *outputs)
{
    (void)inputs; /* no sample is taken */
    seat_controller_start(state, coefficients);
    state->next_sample = samples_before(time, coefficients->sample_time);
    held_outputs(state, coefficients, outputs);
}

void seat_controller_advance(seat_controller_state *state, const seat_controller_inputs *inputs,
                             const seat_controller_coefficients *coefficients, double time, double step_size,
                             seat_controller_outputs *outputs)
{
    const double end = samples_before(time + step_size, coefficients->sample_time);
    while (state->next_sample < end) {
        sample(state, inputs, coefficients);
        state->next_sample += 1.0;
    }
    held_outputs(state, coefficients, outputs);
}
