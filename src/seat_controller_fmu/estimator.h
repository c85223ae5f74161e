/* Estimator of the driver's mass and the suspension's friction, the C twin of estimator.py. */
#ifndef SEAT_CONTROLLER_ESTIMATOR_H
#define SEAT_CONTROLLER_ESTIMATOR_H

#include "interface.h"

/* Estimates, and weighted sums over the samples in which the seat slides: a, s, y are the driver's acceleration in
 * m/s2, the direction of sliding and the force in N. */
typedef struct {
    seat_controller_real mass;      /* in kg */
    seat_controller_real friction;  /* in N */
    seat_controller_real direction; /* of sliding: -1, 1, or 0 while the seat does not slide */
    seat_controller_real sliding;   /* samples since the seat slides in this direction */
    seat_controller_real fresh;     /* samples since the last solution */
    seat_controller_real n, s, a, sa, aa, y, sy, ay;
    bool mass_trusted, friction_trusted;
} estimator_state;

typedef struct {
    seat_controller_real memory;           /* factor on the sums a sample */
    seat_controller_real nominal_mass;     /* in kg */
    seat_controller_real nominal_friction; /* in N */
} estimator_coefficients;

/* Derive the coefficients. */
estimator_coefficients estimator_prepare(const seat_controller_parameters *parameters);

/* Set the estimates to the nominal values, without information. */
void estimator_start(estimator_state *state, const estimator_coefficients *c);

/* Count the samples of sliding from the deflection's rate in m/s; returns the direction once they are enough, else 0.
 */
seat_controller_real estimator_slide(estimator_state *state, seat_controller_real rate);

/* Take a sample of sliding: force y = u - k_f delta - m_s a_s in N, the driver's acceleration in m/s2, the direction.
 */
void estimator_step(estimator_state *state, seat_controller_real force, seat_controller_real acceleration,
                    seat_controller_real direction, const estimator_coefficients *c);

#endif
