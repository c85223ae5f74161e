/* Estimator of the driver's mass and the suspension's friction by gated least squares. See estimator.py.
 *
 *   y = u - k_f delta - m_s a_s = m_b a_b + F_r s + c,   s = sgn v
 *
 * in the samples in which the seat has been sliding one way for a while, with exponential forgetting. c, which takes
 * bias and offset, is eliminated, then F_r, then m_b; what is left beside m_b is its information.
 */
#include "estimator.h"

typedef seat_controller_real real;

#define REAL(number) ((real)(number))

/* Constants as in estimator.py. */
static const double sliding_rate = 0.05, sliding_samples = 20.0, forgetting = 0.15;
static const double samples_per_solution = 50.0, gain = 0.3;
static const double mass_ridge = 5.0, friction_ridge = 10.0;
static const double mass_information = 50.0, friction_information = 250.0;
static const double mass_min = 35.0, mass_max = 150.0, friction_max = 150.0;

static real clip(real x, real low, real high)
{
    return x < low ? low : x > high ? high : x;
}

estimator_coefficients estimator_prepare(const seat_controller_parameters *parameters)
{
    estimator_coefficients c;
    c.memory = REAL(1.0) - REAL(forgetting) * parameters->sample_time;
    c.nominal_mass = parameters->driver_mass;
    c.nominal_friction = parameters->robust_friction;
    return c;
}

void estimator_start(estimator_state *state, const estimator_coefficients *c)
{
    const estimator_state none = {0};
    *state = none;
    state->mass = c->nominal_mass;
    state->friction = c->nominal_friction;
}

/* Solve for mass and friction, and move the estimates towards the solution. */
static void solve(estimator_state *state, const estimator_coefficients *c)
{
    const real per_n = REAL(1.0) / state->n;
    const real s = state->s * per_n, a = state->a * per_n;
    const real ss = state->n + REAL(friction_ridge) - state->s * s;
    const real sa = state->sa - state->a * s, aa = state->aa - state->a * a;
    const real sy = state->sy + REAL(friction_ridge) * c->nominal_friction - state->y * s;
    const real ay = state->ay + REAL(mass_ridge) * c->nominal_mass - state->y * a;
    const real q = sa / ss;
    const real information = aa - sa * q;
    const real mass = (ay - q * sy) / (information + REAL(mass_ridge));
    const real friction = (sy - sa * mass) / ss;
    state->mass += REAL(gain) * (clip(mass, REAL(mass_min), REAL(mass_max)) - state->mass);
    state->friction += REAL(gain) * (clip(friction, REAL(0.0), REAL(friction_max)) - state->friction);
    state->mass_trusted = information > REAL(mass_information);
    state->friction_trusted = ss > REAL(friction_information);
}

real estimator_slide(estimator_state *state, real rate)
{
    const real limit = REAL(sliding_rate), needed = REAL(sliding_samples);
    const real direction = rate > limit ? REAL(1.0) : rate < -limit ? REAL(-1.0) : REAL(0.0);
    const bool changed = direction > state->direction || direction < state->direction;
    const bool at_rest = !(direction > REAL(0.0)) && !(direction < REAL(0.0));
    const real sliding = state->sliding + REAL(1.0);
    state->sliding = changed || at_rest ? REAL(0.0) : sliding < needed ? sliding : needed;
    state->direction = direction;
    return state->sliding < needed ? REAL(0.0) : direction;
}

void estimator_step(estimator_state *state, real force, real acceleration, real direction,
                    const estimator_coefficients *c)
{
    const real memory = c->memory;
    state->n = memory * state->n + REAL(1.0);
    state->s = memory * state->s + direction;
    state->a = memory * state->a + acceleration;
    state->sa = memory * state->sa + direction * acceleration;
    state->aa = memory * state->aa + acceleration * acceleration;
    state->y = memory * state->y + force;
    state->sy = memory * state->sy + direction * force;
    state->ay = memory * state->ay + acceleration * force;
    state->fresh += REAL(1.0);
    if (!(state->fresh < REAL(samples_per_solution))) {
        state->fresh = REAL(0.0);
        solve(state, c);
    }
}
