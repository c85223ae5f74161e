/* The sampled controller in C99, the C twin of controller.py with the same arithmetic operations.
 *
 * This header, those that it includes and the C files of the same names need no other file: no allocation, no globals,
 * no recursion, no input or output; all memory belongs to the caller and has a fixed size. Symbols and equation numbers
 * are those of the paper, see NOMENCLATURE.md; the equations are in controller.c. Up is positive, times are in s.
 *
 * Use: fill the parameters, call seat_controller_prepare() once (and again after a change), seat_controller_start(),
 * then seat_controller_step() every sample_time.
 */
#ifndef SEAT_CONTROLLER_H
#define SEAT_CONTROLLER_H

#include "interface.h"
#include "robust.h"

/* State after the last sample. */
typedef struct {
    double next_sample; /* number k of the next sample, due at k h; used by seat_controller_advance only */
    bool started;       /* whether a sample was taken: before the first one there is no previous deflection */
    seat_controller_real deflection;              /* delta in m */
    seat_controller_real rate;                    /* v in m/s */
    seat_controller_real demand, force, estimate; /* u, u_sat and F_hat in N */
    robust_state robust;                          /* of the mode robust */
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
    bool is_robust;     /* whether the mode is robust */
    robust_coefficients robust;
} seat_controller_coefficients;

/* Derive the coefficients. Returns NULL, or a message about the parameters in terms of their names. */
const char *seat_controller_prepare(const seat_controller_parameters *parameters,
                                    seat_controller_coefficients *coefficients);

/* Return a warning about legal parameters in terms of their names, or NULL. */
const char *seat_controller_warning(const seat_controller_parameters *parameters);

/* Set the state before the first sample; no sample is taken. */
void seat_controller_start(seat_controller_state *state, const seat_controller_coefficients *coefficients);

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
