/* The law of the mode robust. The equations are in robust.py and docs/explanation/robust.md. */
#include "robust.h"

#include <math.h>
#include <stddef.h>

typedef seat_controller_real real;

#define REAL(number) ((real)(number))

static const double pi = 3.14159265358979323846;

/* Constants as in robust.py. */
static const double follow_filter = 4.0;
static const double prediction_time = 0.001;
static const double lead_floor = 0.003, lead_share = 0.4;
static const double bias_bound = 0.2, start_rate = 2.0, start_time = 2.0;
static const double still_rate = 0.009, still_range = 0.0072, still_filter = 1.0, still_time = 0.3, still_leak = 20.0;
static const double overload_stiffness = 1500.0;
static const double fade_time = 0.1;

static real clip(real x, real low, real high)
{
    return x < low ? low : x > high ? high : x;
}

static real magnitude(real x)
{
    return x < REAL(0.0) ? -x : x;
}

static real square_root(real x)
{
    return sizeof(real) == sizeof(float) ? REAL(sqrtf((float)x)) : REAL(sqrt((double)x));
}

/* Return a state, or zero if its magnitude is below 1e-30: arithmetic with subnormal numbers is slow. */
static real flush_subnormal(real state)
{
    const real smallest = REAL(1e-30);
    return state < smallest && state > -smallest ? REAL(0.0) : state;
}

/* Return the share of a step that a first-order lag takes in a sample; the angle is h over its time constant. */
static real lag_gain(real angle)
{
    return REAL(1.0 - exp(-(double)angle));
}

/* Return the model with a driver of a mass in kg: H_c = (c_c s + k_c)/(m_b s^2 + c_c s + k_c) by Tustin's rule. */
static robust_model model_of(real mass, const robust_coefficients *c)
{
    const real inertia = mass * c->inertia;
    const real scale = REAL(1.0) / (inertia + c->cushion_damping + c->cushion_stiffness);
    robust_model model;
    model.mass = mass + c->m_s;
    model.b_0 = (c->cushion_damping + c->cushion_stiffness) * scale;
    model.b_1 = REAL(2.0) * c->cushion_stiffness * scale;
    model.b_2 = (c->cushion_stiffness - c->cushion_damping) * scale;
    model.a_1 = REAL(2.0) * (c->cushion_stiffness - inertia) * scale;
    model.a_2 = (inertia - c->cushion_damping + c->cushion_stiffness) * scale;
    return model;
}

static void prepare_observers(const seat_controller_parameters *p, robust_coefficients *c)
{
    const real h = p->sample_time;
    const real angle = REAL(2.0 * pi) * p->robust_motion_bandwidth;
    c->h = h;
    c->half_h = REAL(0.5) * h;
    c->motion_1 = REAL(2.0) * angle * h;
    c->motion_2 = REAL(2.0) * angle * angle * h;
    c->motion_3 = angle * angle * angle * h;
    c->k_f = p->suspension_stiffness;
    c->m_s = p->seat_mass;
    c->limit = p->force_limit;
    c->inertia = REAL(4.0) / (h * h);
    c->cushion_damping = p->robust_cushion_damping * REAL(2.0) / h;
    c->cushion_stiffness = p->robust_cushion_stiffness;
    c->nominal = model_of(p->driver_mass, c);
    c->observer_gain = lag_gain(p->robust_observer_rate * h);
}

/* Return the actuator's delay in samples, rounded. */
static real delay_in_samples(const seat_controller_parameters *p)
{
    return REAL(floor((double)(p->actuator_delay / p->sample_time) + 0.5));
}

static void prepare_actuator(const seat_controller_parameters *p, robust_coefficients *c)
{
    const real h = p->sample_time, lag = p->actuator_time_constant;
    const real shortest = REAL(lead_share) * lag > REAL(lead_floor) ? REAL(lead_share) * lag : REAL(lead_floor);
    const real left = lag < shortest ? lag : shortest; /* time constant of actuator and lead */
    const real late = left + p->actuator_delay;
    c->has_lead = lag > shortest;
    c->lead_gain = lag_gain(h / shortest);
    c->lead_direct = lag / shortest;
    c->lead_lagging = REAL(1.0) - c->lead_direct;
    c->applied_gain = lag > REAL(0.0) ? lag_gain(h / lag) : REAL(1.0);
    c->answered_gain = left > REAL(0.0) ? lag_gain(h / left) : REAL(1.0);
    c->delay = delay_in_samples(p);
    c->rate_gain = c->k_f * (late + REAL(prediction_time));
    c->lead_time = late;
    c->follow_gain = REAL(1.0) / (REAL(1.0) / p->robust_observer_rate + late);
}

static void prepare_law(const seat_controller_parameters *p, robust_coefficients *c)
{
    const real h = p->sample_time;
    const real w_0 = REAL(2.0 * pi) * p->robust_centring_frequency;
    const real w_l = REAL(2.0 * pi) * p->robust_centring_filter;
    const bool has_stops = p->travel > REAL(0.0);
    const real per_travel = has_stops ? REAL(1.0) / p->travel : REAL(0.0);
    c->envelope_keep = REAL(1.0) - h * p->robust_envelope_decay;
    c->rate_to_deflection = REAL(1.0) / (REAL(2.0 * pi) * p->robust_envelope_frequency);
    c->follow_begin = p->robust_follow_begin * p->travel;
    c->follow_slope = p->robust_follow_slope * per_travel;
    c->follow_min = REAL(0.0);
    c->follow_max = p->robust_follow_max;
    c->follow_filter = lag_gain(REAL(2.0 * pi * follow_filter) * h);
    c->per_friction_rate = REAL(1.0) / p->robust_friction_rate;
    c->friction_share = p->robust_friction_share;
    c->centring_stiffness = w_0 * w_0;
    c->centring_damping = REAL(2.0) * p->robust_centring_damping * w_0 * w_l;
    c->centring_filter = lag_gain(w_l * h);
    c->overload_begin = p->robust_overload_begin * p->travel;
    c->overload_slope = per_travel / (p->robust_overload_end - p->robust_overload_begin);
    c->overload_damping = p->robust_overload_damping;
    c->overload_stiffness = REAL(overload_stiffness);
    c->bias_gain = h * p->robust_bias_rate;
    c->per_k_f = REAL(1.0) / c->k_f;
    c->bias_bound = REAL(bias_bound);
    c->start_rate = REAL(start_rate) * h;
    c->start_keep = REAL(1.0) - h / REAL(start_time);
    c->still_begin = REAL(still_rate);
    c->still_slope = REAL(1.0) / REAL(still_range);
    c->still_filter = lag_gain(REAL(2.0 * pi * still_filter) * h);
    c->still_bias = h / REAL(still_time);
    c->still_leak = h * REAL(still_leak);
    c->ramp = h / p->robust_ramp_time;
    c->fade = h / REAL(fade_time);
    c->safe_damping = p->robust_safe_damping;
    c->adapts_mass = p->robust_estimator == ESTIMATOR_FRICTION_AND_MASS;
    c->adapts_friction = p->robust_estimator == ESTIMATOR_FRICTION || c->adapts_mass;
    c->estimates = p->robust_estimator != ESTIMATOR_OFF;
}

/* Return what is wrong with parameters of the mode robust, or NULL. */
static const char *check(const seat_controller_parameters *p)
{
    const real w_0 = REAL(2.0 * pi) * p->robust_centring_frequency;
    if (!(p->robust_bias_rate < REAL(2.0) * p->robust_centring_damping * w_0 * w_0 * w_0)) {
        return "expected robust.bias_rate below 2 robust.centring_damping (2 pi robust.centring_frequency)^3, where "
               "the "
               "centring is stable";
    }
    if (!(p->robust_overload_begin < p->robust_overload_end)) {
        return "expected robust.overload_begin < robust.overload_end";
    }
    if (!(p->travel <= p->robust_deflection_range)) {
        return "expected travel <= robust.deflection_range";
    }
    return NULL;
}

const char *robust_prepare(const seat_controller_parameters *parameters, robust_coefficients *coefficients)
{
    const char *problem = check(parameters);
    if (problem == NULL) {
        prepare_observers(parameters, coefficients);
        prepare_actuator(parameters, coefficients);
        prepare_law(parameters, coefficients);
        coefficients->estimator = estimator_prepare(parameters);
        coefficients->faults = faults_prepare(parameters);
    }
    return problem;
}

void robust_start(robust_state *state, const robust_coefficients *c)
{
    const robust_state none = {0};
    *state = none;
    estimator_start(&state->estimator, &c->estimator);
    faults_start(&state->faults);
    state->line_length = REAL(2.0) * c->delay;
}

/* Begin with the motion at rest under the present measurements and no force; estimates and level stay. */
static void begin(robust_state *s, const robust_sample *m, const robust_coefficients *c)
{
    const robust_model *n = &c->nominal;
    robust_state fresh = {0};
    fresh.active = true;
    fresh.level = s->level;
    fresh.position = fresh.slow = m->deflection;
    fresh.floor = m->acceleration;
    fresh.cushion_2 = (n->b_2 - n->a_2) * m->acceleration;
    fresh.cushion_1 = (n->b_1 - n->a_1) * m->acceleration + fresh.cushion_2;
    fresh.estimate = -c->k_f * m->deflection; /* friction holds the spring: no force at first */
    fresh.start = c->start_rate;
    fresh.estimator = s->estimator;
    fresh.faults = s->faults;
    fresh.line_length = REAL(2.0) * c->delay;
    *s = fresh;
}

/* Predicted motion of the deflection: change of the rate in m/s, position in m. */
typedef struct {
    real change, position;
} prediction;

static prediction predict_motion(const robust_state *s, real acceleration, const robust_coefficients *c)
{
    prediction ahead;
    ahead.change = c->h * (acceleration - s->floor);
    ahead.position = s->position + c->h * s->rate + c->half_h * ahead.change;
    return ahead;
}

/* Correct the observed motion by the measured deflection; returns the acceleration of the deflection in m/s2. */
static real observe_motion(robust_state *s, const robust_sample *m, const prediction *ahead,
                           const robust_coefficients *c)
{
    const real error = m->deflection - ahead->position;
    s->position = ahead->position + c->motion_1 * error;
    s->rate = s->rate + ahead->change + c->motion_2 * error;
    s->floor = s->floor - c->motion_3 * error;
    return m->acceleration - s->floor;
}

/* Advance the modelled actuator by a sample, whose command was the last sample's. */
static void model_actuator(robust_state *s, real force, const robust_coefficients *c)
{
    real part = s->part, target = force;
    if (c->delay > REAL(0.0)) {
        real *pair = s->line + 2 * (size_t)s->place;
        const real next = s->place + REAL(1.0);
        part = pair[0];
        target = pair[1];
        pair[0] = s->part;
        pair[1] = force;
        s->place = next < c->delay ? next : REAL(0.0);
    }
    s->answered = s->answered + c->answered_gain * (part - s->answered);
    s->applied = s->applied + c->applied_gain * (target - s->applied);
}

/* Return the driver's acceleration in m/s2. */
static real driver_acceleration(robust_state *s, real a, const robust_model *n)
{
    const real y = n->b_0 * a + s->cushion_1;
    s->cushion_1 = n->b_1 * a - n->a_1 * y + s->cushion_2;
    s->cushion_2 = n->b_2 * a - n->a_2 * y;
    return y;
}

/* Return the share to which the seat is still, from the low-passed speed. */
static real stillness(robust_state *s, const robust_coefficients *c)
{
    const real moving = clip((s->speed - c->still_begin) * c->still_slope, REAL(0.0), REAL(1.0));
    s->speed = s->speed + c->still_filter * (magnitude(s->rate) - s->speed);
    return REAL(1.0) - moving;
}

/* Return the force that the observer shall not answer for: friction ahead, and the follow term. */
static real feed_forward(robust_state *s, real relative, real moving, real mass, const robust_coefficients *c)
{
    const real friction = c->adapts_friction ? s->estimator.friction : c->estimator.nominal_friction;
    const real direction = clip((s->rate + c->lead_time * relative) * c->per_friction_rate, REAL(-1.0), REAL(1.0));
    const real beta = clip((s->envelope - c->follow_begin) * c->follow_slope, c->follow_min, c->follow_max);
    s->followed = s->followed + c->follow_filter * (s->rate - s->followed);
    return c->friction_share * friction * moving * direction - beta * c->follow_gain * mass * s->followed;
}

/* Update the envelope of the deflection that is to come. */
static void update_envelope(robust_state *s, real deflection, const robust_coefficients *c)
{
    const real ahead = c->rate_to_deflection * s->rate;
    const real amplitude = square_root(deflection * deflection + ahead * ahead);
    const real kept = c->envelope_keep * s->envelope;
    s->envelope = amplitude > kept ? amplitude : kept;
}

/* Update the bias from deflection and force, or while the seat is still from the acceleration. */
static void update_bias(robust_state *s, const robust_sample *m, real force, real still, const robust_coefficients *c)
{
    const real error = m->acceleration - s->bias;
    const real moving = s->bias - c->bias_gain * (m->deflection + force * c->per_k_f) + s->start * error;
    const real resting = s->bias + c->still_bias * error;
    s->bias = clip(moving + still * (resting - moving), -c->bias_bound, c->bias_bound);
    s->estimate = s->estimate - still * c->still_leak * s->estimate;
    s->start = c->start_keep * s->start;
}

static void flush(robust_state *s)
{
    real *const states[] = {&s->position,  &s->rate,      &s->floor,    &s->applied, &s->answered, &s->part,
                            &s->cushion_1, &s->cushion_2, &s->estimate, &s->bias,    &s->start,    &s->envelope,
                            &s->followed,  &s->slow,      &s->speed,    &s->lagging, &s->held};
    for (size_t i = 0; i < sizeof states / sizeof *states; ++i) {
        *states[i] = flush_subnormal(*states[i]);
    }
}

/* Move a share towards 1 or 0 by a step, within these. */
static real moved(real share, bool up, real step)
{
    return clip(up ? share + step : share - step, REAL(0.0), REAL(1.0));
}

/* Run the law for a sample. */
static void run_law(robust_state *s, const robust_sample *m, const prediction *predicted, const robust_coefficients *c,
                    real *demand, real *force)
{
    const real delta = m->deflection, a = m->acceleration;
    const bool adapts = c->adapts_mass && s->estimator.mass_trusted;
    const robust_model model = adapts ? model_of(s->estimator.mass, c) : c->nominal;
    const real relative = observe_motion(s, m, predicted, c);
    const real before = s->applied;
    model_actuator(s, m->force, c);
    const real a_b = driver_acceleration(s, a, &model);
    const real spring = c->k_f * delta;
    const real rest = REAL(0.5) * (before + s->applied) - spring - c->m_s * a; /* as late as the sensors are */
    const real free_force = model.mass * s->bias - spring - c->m_s * a - (model.mass - c->m_s) * a_b;
    s->estimate = s->estimate + c->observer_gain * (s->answered + free_force - s->estimate);
    update_envelope(s, delta, c);
    const real still = stillness(s, c);
    real ahead = feed_forward(s, relative, REAL(1.0) - still, model.mass, c);
    const real gap = delta - s->slow;
    s->slow = s->slow + c->centring_filter * gap;
    const real centring = model.mass * (c->centring_stiffness * s->slow + c->centring_damping * gap);
    real u = spring + c->rate_gain * s->rate + s->estimate - centring + ahead;
    const real overload = clip((s->envelope - c->overload_begin) * c->overload_slope, REAL(0.0), REAL(1.0));
    if (overload > REAL(0.0)) {
        u = u + overload * (c->overload_stiffness * delta - c->overload_damping * s->rate - u);
        ahead = (REAL(1.0) - overload) * ahead;
    }
    real commanded = u;
    if (c->has_lead) {
        s->lagging = s->lagging + c->lead_gain * (u - s->lagging);
        commanded = c->lead_direct * u + c->lead_lagging * s->lagging;
    }
    s->level = moved(s->level, m->enabled, c->ramp);
    *demand = s->level * commanded;
    *force = clip(*demand, -c->limit, c->limit);
    s->part = u + (*force - commanded) - s->level * ahead;
    s->held = *force;
    s->safety = REAL(0.0);
    update_bias(s, m, *force, still, c);
    const real sliding = estimator_slide(&s->estimator, s->rate);
    const bool slides = sliding > REAL(0.0) || sliding < REAL(0.0);
    if (c->estimates && slides && faults_clear_of_stops(&s->faults)) {
        estimator_step(&s->estimator, rest, a_b, sliding, &c->estimator);
    }
    faults_check_balance(&s->faults, s->applied + free_force, s->estimator.friction, sliding,
                         !(magnitude(s->bias) < c->bias_bound), &c->faults);
}

/* The safe state after a fault: the last force fades, a damper takes its place where the deflection is trusted. */
static void run_safe(robust_state *s, const robust_sample *m, const robust_coefficients *c, real *demand, real *force)
{
    if (s->active) {
        s->active = false;
        s->level = REAL(1.0); /* of the held force, which has the former level in it */
    }
    s->level = moved(s->level, false, c->fade);
    s->safety = moved(s->safety, m->enabled && faults_deflection_is_trusted(&s->faults), c->fade);
    *demand = s->level * s->held - s->safety * c->safe_damping * m->rate;
    *force = clip(*demand, -c->limit, c->limit);
}

void robust_step(robust_state *state, const robust_sample *sample, const robust_coefficients *c, real *demand,
                 real *force)
{
    robust_state *s = state;
    const bool off = !sample->enabled && !(s->level > REAL(0.0)) && !(s->safety > REAL(0.0));
    if (off) { /* the way to acknowledge a fault */
        s->active = false;
        faults_start(&s->faults);
    }
    faults_check_signals(&s->faults, sample->acceleration, sample->deflection, sample->deflection_before, sample->rate,
                         &c->faults);
    *demand = *force = REAL(0.0);
    prediction predicted = {0};
    if (!off && !(s->faults.fault > FAULT_NONE)) {
        if (!s->active) {
            begin(s, sample, c);
        }
        predicted = predict_motion(s, sample->acceleration, c);
        faults_check_prediction(&s->faults, sample->deflection - predicted.position);
    }
    if (s->faults.fault > FAULT_NONE) {
        run_safe(s, sample, c, demand, force);
    } else if (!off) {
        run_law(s, sample, &predicted, c, demand, force);
        flush(s);
    }
    if (!c->estimates) {
        s->estimator.mass = c->estimator.nominal_mass;
        s->estimator.friction = c->estimator.nominal_friction;
    }
}

bool robust_is_valid_state(const robust_state *state, const seat_controller_parameters *parameters)
{
    const real delay = delay_in_samples(parameters), place = state->place;
    const double fault = state->faults.fault;
    const bool line = !(state->line_length < REAL(2.0) * delay) && !(state->line_length > REAL(2.0) * delay);
    const bool inside = !(place < REAL(0.0)) && (place < delay || !(place > REAL(0.0)));
    if (!line || !inside || !(fault >= FAULT_NONE && fault <= FAULT_DEFLECTION_FROZEN)) {
        return false;
    }
    return !(fault > floor(fault)) && !((double)place > floor((double)place));
}
