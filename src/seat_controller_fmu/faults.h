/* Detection of sensor faults, the C twin of faults.py. */
#ifndef SEAT_CONTROLLER_FAULTS_H
#define SEAT_CONTROLLER_FAULTS_H

#include "interface.h"

typedef struct {
    double fault;                                            /* number of the latched one */
    seat_controller_real acceleration;                       /* of the last sample, in m/s2 */
    seat_controller_real beyond_range;                       /* samples since the acceleration is beyond its range */
    seat_controller_real same_acceleration, same_deflection; /* samples since they have not changed by a bit */
    seat_controller_real path;        /* of the deflection since the acceleration has not changed, in m */
    seat_controller_real rate_before; /* rate before the deflection stood still, in m/s */
    seat_controller_real clear;       /* samples since an end stop was near, at most those of clear_time */
    seat_controller_real balance;     /* low-passed balance of forces in N */
    seat_controller_real low_passed;  /* acceleration in m/s2 */
    seat_controller_real imbalance;   /* leaky integral of the excess of the force balance, in N.s */
    seat_controller_real biased;      /* samples since the bias is at its bound */
} faults_state;

typedef struct {
    seat_controller_real sample_time;        /* h in s */
    seat_controller_real balance_gain;       /* of the low-pass a sample */
    seat_controller_real imbalance_decay;    /* factor a sample */
    seat_controller_real acceleration_range; /* in m/s2 */
    seat_controller_real deflection_range;   /* in m */
    bool knows_stops;
    seat_controller_real near_stop; /* deflection in m from which on an end stop is near */
} faults_coefficients;

/* Derive the coefficients. */
faults_coefficients faults_prepare(const seat_controller_parameters *parameters);

/* Set the state without a fault. */
void faults_start(faults_state *state);

/* Check the measurements of a sample, in m/s2 and m, against those before; `rate` is the filtered rate in m/s. */
void faults_check_signals(faults_state *state, seat_controller_real acceleration, seat_controller_real deflection,
                          seat_controller_real deflection_before, seat_controller_real rate,
                          const faults_coefficients *c);

/* Check how far in m the deflection is from the observed motion's prediction. */
void faults_check_prediction(faults_state *state, seat_controller_real surprise);

/* Check the balance of forces in N, which healthy sensors keep at the friction times the direction of sliding, or
 * within it, and the estimated bias. */
void faults_check_balance(faults_state *state, seat_controller_real balance, seat_controller_real friction,
                          seat_controller_real direction, bool bias_at_bound, const faults_coefficients *c);

/* Whether no end stop was near for a time that lets the seat settle after an impact, or a shorter one for the
 * estimator. */
bool faults_clear_of_stops(const faults_state *state);

/* Whether the deflection can be trusted in spite of the fault. */
bool faults_deflection_is_trusted(const faults_state *state);

#endif
