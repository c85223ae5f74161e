/* The sampled controller in C99, the C twin of controller.py with the same arithmetic operations.
 *
 * This header and controller.c need no other file: no allocation, no globals, no recursion, no input or output; all
 * memory belongs to the caller and has a fixed size. Symbols and equation numbers are those of the paper, see
 * NOMENCLATURE.md; the equations are in controller.c. Up is positive, times are in s.
 *
 * Use: fill the parameters, call seat_controller_prepare() once (and again after a change), seat_controller_start(),
 * then seat_controller_step() every sample_time.
 */
#ifndef SEAT_CONTROLLER_H
#define SEAT_CONTROLLER_H

#include <stdbool.h>

/* Type of all signals: compile with -DSEAT_CONTROLLER_REAL=float for single precision. */
#ifndef SEAT_CONTROLLER_REAL
#define SEAT_CONTROLLER_REAL double
#endif
typedef SEAT_CONTROLLER_REAL seat_controller_real;

/* Measurements of the two sensors. */
typedef struct {
    seat_controller_real seat_acceleration;     /* Y_2 = z_s'' in m/s2, up positive */
    seat_controller_real suspension_deflection; /* delta = z_s - z_v in m */
} seat_controller_inputs;

/* Outputs after the last sample. */
typedef struct {
    seat_controller_real force;                /* u_sat (6) in N, to the actuator, up positive */
    seat_controller_real force_demand;         /* u (24) in N */
    seat_controller_real motor_torque;         /* T (33) in N.m, radicand clamped at 0 */
    seat_controller_real disturbance_estimate; /* F_hat (21) in N */
    seat_controller_real deflection_rate;      /* v in m/s, filtered */
    bool saturated;                            /* whether the force is limited */
} seat_controller_outputs;

typedef struct {
    seat_controller_real driver_mass;          /* m_b in kg */
    bool anti_windup;                          /* feed the observer u_sat instead of u */
    bool enabled;                              /* false: u = F_hat = 0, the rate filter continues */
    seat_controller_real force_limit;          /* u_lim in N */
    seat_controller_real observer_gamma;       /* Gamma in s/kg2, below 0 */
    seat_controller_real L1, L2;               /* observer gains in kg/s; 0: from Gamma by (23) */
    seat_controller_real rate_filter_cutoff;   /* f_c in Hz */
    seat_controller_real seat_mass;            /* m_s in kg */
    seat_controller_real suspension_stiffness; /* k_f in N/m */
    seat_controller_real driver_mass_min;      /* m_bmin in kg */
    seat_controller_real driver_mass_max;      /* m_bmax in kg */
    seat_controller_real K1_deflection;        /* K_1 in N/m */
    seat_controller_real K1_rate;              /* K_1 in N.s/m */
    seat_controller_real K2_deflection;        /* K_2 in N/m */
    seat_controller_real K2_rate;              /* K_2 in N.s/m */
    seat_controller_real link_length;          /* L in m */
    seat_controller_real initial_height;       /* h_0 in m */
    seat_controller_real gear_ratio;           /* r_g */
    seat_controller_real sample_time;          /* h in s */
} seat_controller_parameters;

/* State after the last sample. */
typedef struct {
    double next_sample; /* number k of the next sample, due at k h; used by seat_controller_advance only */
    bool started;       /* whether a sample was taken: before the first one there is no previous deflection */
    seat_controller_real deflection;              /* delta in m */
    seat_controller_real rate;                    /* v in m/s */
    seat_controller_real demand, force, estimate; /* u, u_sat and F_hat in N */
} seat_controller_state;

/* Factors of the sampled equations, derived from the parameters. */
typedef struct {
    seat_controller_real rate_decay;            /* tau/(tau + h) */
    seat_controller_real rate_gain;             /* 1/(tau + h) in 1/s */
    seat_controller_real observer_acceleration; /* h L_h in kg */
    seat_controller_real observer_deflection;   /* h L_h k_f/M in N/m */
    seat_controller_real observer_force;        /* h L_h/M */
    seat_controller_real deflection_gain;       /* K_h in N/m */
    seat_controller_real rate_gain_K;           /* K_h in N.s/m */
    seat_controller_real limit;                 /* u_lim in N */
    seat_controller_real link_squared;          /* L^2 in m2 */
    seat_controller_real height;                /* h_0 in m */
    seat_controller_real torque_gain;           /* 1/(2 r_g) */
    bool enabled, anti_windup;
    double sample_time; /* h in s */
} seat_controller_coefficients;

/* Derive the coefficients. Returns NULL, or a message about the parameters in terms of their names. */
const char *seat_controller_prepare(const seat_controller_parameters *parameters,
                                    seat_controller_coefficients *coefficients);

/* Return a warning about legal parameters in terms of their names, or NULL. */
const char *seat_controller_warning(const seat_controller_parameters *parameters);

/* Set the state before the first sample; no sample is taken. */
void seat_controller_start(seat_controller_state *state);

/* Take one sample; must be called every h with new measurements. */
void seat_controller_step(seat_controller_state *state, const seat_controller_inputs *inputs,
                          const seat_controller_coefficients *coefficients, seat_controller_outputs *outputs);

/* The functions below are for simulation, where communication steps differ from samples. */

/* Check that a run that has reached a time can have a state: its next sample is near that time. */
int seat_controller_is_valid_state(const seat_controller_state *state, const seat_controller_parameters *parameters,
                                   double time);

/* Set the state at a start time; the first sample is due at the first multiple of h from there on. All outputs are 0.
 */
void seat_controller_initialize(seat_controller_state *state, const seat_controller_inputs *inputs,
                                const seat_controller_coefficients *coefficients, double time,
                                seat_controller_outputs *outputs);

/* Take every sample due in [time, time + step_size), all with the same inputs; the outputs are those of the last one.
 */
void seat_controller_advance(seat_controller_state *state, const seat_controller_inputs *inputs,
                             const seat_controller_coefficients *coefficients, double time, double step_size,
                             seat_controller_outputs *outputs);

#endif
