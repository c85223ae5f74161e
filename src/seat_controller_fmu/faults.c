/* Detection of sensor faults. See faults.py. */
#include "faults.h"

typedef seat_controller_real real;

#define REAL(number) ((real)(number))

/* Constants as in faults.py. */
static const double impact_samples = 50.0;
static const double frozen_samples = 45.0, frozen_path = 0.008, frozen_rate = 0.03;
static const double jump_rate = 3.0, largest_surprise = 0.8e-3;
static const double near_stop = 0.95, settling_samples = 150.0, estimator_samples = 50.0;
static const double balance_time = 0.02, balance_margin = 30.0, balance_mass = 45.0;
static const double friction_beyond = 1.2, friction_unknown = 0.25;
static const double imbalance_limit = 3.0, imbalance_rate = 4.0;
static const double biased_samples = 1000.0;

static real magnitude(real x)
{
    return x < REAL(0.0) ? -x : x;
}

static bool is_finite(real x)
{
    return !(x - x > REAL(0.0)) && !(x - x < REAL(0.0)) && x - x < REAL(1.0);
}

faults_coefficients faults_prepare(const seat_controller_parameters *parameters)
{
    faults_coefficients c;
    c.sample_time = parameters->sample_time;
    c.balance_gain = parameters->sample_time / REAL(balance_time);
    c.imbalance_decay = REAL(1.0) - REAL(imbalance_rate) * parameters->sample_time;
    c.acceleration_range = parameters->robust_acceleration_range;
    c.deflection_range = parameters->robust_deflection_range;
    c.knows_stops = parameters->travel > REAL(0.0);
    c.near_stop = REAL(near_stop) * parameters->travel;
    return c;
}

void faults_start(faults_state *state)
{
    const faults_state none = {0};
    *state = none;
    state->fault = FAULT_NONE;
}

/* Latch the first fault. */
static void latch(faults_state *state, bool found, int fault)
{
    if (found && !(state->fault > FAULT_NONE)) {
        state->fault = fault;
    }
}

/* Count a sample in which something holds, from 0 on. */
static real counted(real samples, bool holds)
{
    return holds ? samples + REAL(1.0) : REAL(0.0);
}

static bool equal(real a, real b)
{
    return !(a < b) && !(a > b);
}

void faults_check_signals(faults_state *state, real acceleration, real deflection, real deflection_before, real rate,
                          const faults_coefficients *c)
{
    const bool near = c->knows_stops && magnitude(deflection) > c->near_stop;
    const real waited = state->clear + REAL(1.0), settled = REAL(settling_samples);
    state->clear = near ? REAL(0.0) : waited < settled ? waited : settled;
    state->beyond_range = counted(state->beyond_range, magnitude(acceleration) > c->acceleration_range);
    const bool impacts = state->clear < settled || !c->knows_stops;
    const real allowed = impacts ? REAL(impact_samples) : REAL(0.0);

    const bool still = equal(deflection, deflection_before);
    state->rate_before = still ? state->rate_before : rate;
    state->same_deflection = counted(state->same_deflection, still);
    const bool constant = equal(acceleration, state->acceleration);
    state->same_acceleration = counted(state->same_acceleration, constant);
    state->path = constant ? state->path + magnitude(deflection - deflection_before) : REAL(0.0);
    state->acceleration = acceleration;

    latch(state, !is_finite(acceleration), FAULT_ACCELERATION_INVALID);
    latch(state, !is_finite(deflection), FAULT_DEFLECTION_INVALID);
    latch(state, magnitude(deflection) > c->deflection_range, FAULT_DEFLECTION_RANGE);
    latch(state, magnitude(deflection - deflection_before) > REAL(jump_rate) * c->sample_time, FAULT_DEFLECTION_JUMP);
    latch(state, state->beyond_range > allowed, FAULT_ACCELERATION_RANGE);
    latch(state, state->same_acceleration > REAL(frozen_samples) && state->path > REAL(frozen_path),
          FAULT_ACCELERATION_FROZEN);
    latch(state, state->same_deflection > REAL(frozen_samples) && magnitude(state->rate_before) > REAL(frozen_rate),
          FAULT_DEFLECTION_FROZEN);
}

void faults_check_prediction(faults_state *state, real surprise)
{
    const bool settled = !(state->clear < REAL(settling_samples));
    latch(state, settled && magnitude(surprise) > REAL(largest_surprise) && !(state->beyond_range > REAL(0.0)),
          FAULT_DEFLECTION_JUMP);
}

void faults_check_balance(faults_state *state, real balance, real friction, real direction, bool bias_at_bound,
                          const faults_coefficients *c)
{
    const bool slides = direction > REAL(0.0) || direction < REAL(0.0);
    state->low_passed = state->low_passed + c->balance_gain * (state->acceleration - state->low_passed);
    state->balance = state->balance + c->balance_gain * (balance - state->balance);
    const real unknown = slides ? REAL(friction_unknown) * friction : REAL(friction_beyond) * friction;
    const real allowed = REAL(balance_margin) + unknown + REAL(balance_mass) * magnitude(state->low_passed);
    const real excess = magnitude(state->balance - direction * friction) - allowed;
    const real kept = c->imbalance_decay * state->imbalance;
    const bool settled = !(state->clear < REAL(settling_samples));
    state->imbalance = settled ? (excess > REAL(0.0) ? kept + c->sample_time * excess : kept) : REAL(0.0);
    state->biased = counted(state->biased, bias_at_bound);
    latch(state, state->imbalance > REAL(imbalance_limit),
          state->same_deflection > REAL(frozen_samples) ? FAULT_DEFLECTION_FROZEN : FAULT_FORCE_BALANCE);
    latch(state, state->biased > REAL(biased_samples), FAULT_ACCELERATION_BIAS);
}

bool faults_clear_of_stops(const faults_state *state)
{
    return !(state->clear < REAL(estimator_samples));
}

bool faults_deflection_is_trusted(const faults_state *state)
{
    return state->fault < FAULT_DEFLECTION_INVALID;
}
