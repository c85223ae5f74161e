/* The law of the mode robust, the C twin of robust.py. */
#ifndef SEAT_CONTROLLER_ROBUST_H
#define SEAT_CONTROLLER_ROBUST_H

#include "estimator.h"
#include "faults.h"

/* Number of samples of the actuator's delay that the law can follow. */
enum { ROBUST_MAX_DELAY = 50 };

/* Model of the seat with its driver: M in kg, and the driver's acceleration over that of the seat, a filter with the
 * coefficients b and a. */
typedef struct {
    seat_controller_real mass, b_0, b_1, b_2, a_1, a_2;
} robust_model;

typedef struct {
    bool active;                               /* whether the law runs; otherwise it begins anew with the next sample */
    seat_controller_real level;                /* share of the law's force that is let through */
    seat_controller_real held;                 /* force before a fault in N */
    seat_controller_real safety;               /* share of the damper of the safe state that is let through */
    seat_controller_real position, rate;       /* of the deflection as observed, in m, m/s */
    seat_controller_real floor;                /* acceleration of the floor as observed, in m/s2 */
    seat_controller_real applied;              /* force that acts in N, as modelled */
    seat_controller_real answered;             /* part of it that the observer answers for */
    seat_controller_real part;                 /* part of the last force that the observer will answer for */
    seat_controller_real cushion_1, cushion_2; /* state of the driver's filter in m/s2 */
    seat_controller_real estimate;             /* F_hat in N */
    seat_controller_real bias;                 /* b in m/s2 */
    seat_controller_real start;                /* rate of the bias estimate after the start, falling, per sample */
    seat_controller_real envelope;             /* A in m */
    seat_controller_real followed;             /* low-passed rate in m/s */
    seat_controller_real slow;                 /* low-passed deflection in m */
    seat_controller_real speed;                /* low-passed magnitude of the rate in m/s */
    seat_controller_real lagging;              /* state of the lead in N */
    estimator_state estimator;
    faults_state faults;
    seat_controller_real place;                      /* index of the oldest pair in the delay line */
    seat_controller_real line_length;                /* number of values in use in the delay line */
    seat_controller_real line[2 * ROBUST_MAX_DELAY]; /* part and force in N of each delayed sample */
} robust_state;

typedef struct {
    seat_controller_real h, half_h;
    seat_controller_real motion_1, motion_2, motion_3; /* gains of the motion observer: 1, 1/s, 1/s2 */
    seat_controller_real applied_gain, answered_gain;  /* of the actuator's lag a sample */
    seat_controller_real delay;                        /* in samples */
    seat_controller_real k_f, m_s, limit;
    seat_controller_real cushion_damping, cushion_stiffness; /* c_c 2/h, k_c */
    seat_controller_real inertia;                            /* (2/h)^2 */
    robust_model nominal;                                    /* with the driver of the parameters */
    seat_controller_real observer_gain;                      /* 1 - e^(-P h) */
    seat_controller_real envelope_keep, rate_to_deflection;
    seat_controller_real follow_begin, follow_slope, follow_min, follow_max, follow_gain, follow_filter;
    seat_controller_real lead_time, per_friction_rate, friction_share; /* T_v, 1/v_0, mu */
    seat_controller_real rate_gain;                                    /* k_f T_k */
    seat_controller_real centring_stiffness, centring_damping, centring_filter;
    seat_controller_real overload_begin, overload_slope, overload_damping, overload_stiffness;
    bool has_lead;
    seat_controller_real lead_direct, lead_lagging, lead_gain;
    seat_controller_real bias_gain, per_k_f, bias_bound, start_rate, start_keep;
    seat_controller_real still_begin, still_slope, still_filter, still_bias, still_leak;
    seat_controller_real ramp, fade, safe_damping;
    bool adapts_friction, adapts_mass, estimates;
    estimator_coefficients estimator;
    faults_coefficients faults;
} robust_coefficients;

/* What a sample gives to the law: measurements in m/s2 and m, the deflection before, the filtered rate of the
 * deflection in m/s, the force of the last sample in N. */
typedef struct {
    seat_controller_real acceleration, deflection, deflection_before, rate, force;
    bool enabled;
} robust_sample;

/* Derive the coefficients. Returns NULL, or a message about the parameters in terms of their names. */
const char *robust_prepare(const seat_controller_parameters *parameters, robust_coefficients *coefficients);

/* Check that a run can have a state with finite numbers. */
bool robust_is_valid_state(const robust_state *state, const seat_controller_parameters *parameters);

/* Set the state before the first sample. */
void robust_start(robust_state *state, const robust_coefficients *c);

/* Take a sample: returns the force demand and the force in N. */
void robust_step(robust_state *state, const robust_sample *sample, const robust_coefficients *c,
                 seat_controller_real *demand, seat_controller_real *force);

#endif
