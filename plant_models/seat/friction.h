/* Bouc-Wen friction (35)-(36) as an exact function of the deflection: the twin of friction.py, which explains it. In a
 * header, so that the compiler can put it into the Runge-Kutta stages. */
#ifndef FRICTION_H
#define FRICTION_H

#include <math.h>

/* Coefficients of the closed-form step. */
typedef struct {
    double plateau;         /* sqrt(A_d/(gamma_d + beta_d)) in m */
    double loading_rate;    /* sqrt(A_d (gamma_d + beta_d)) in 1/m */
    double unloading_scale; /* sqrt(A_d/(gamma_d - beta_d)) in m */
    double unloading_rate;  /* sqrt(A_d (gamma_d - beta_d)) in 1/m */
} friction_coefficients;

/* A state within this share of the plateau is on it, and stays there as long as the deflection moves on. */
static const double friction_settled = 1e-12;

static const double friction_quarter_turn = 1.57079632679489661923;

/* Derive the coefficients; false where (36) has no plateau. */
static inline int friction_prepare(double gamma, double beta, double amplitude, friction_coefficients *c)
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

/* Move z_d along a one-way change of the deflection that is not zero, exactly: tanh while loading, tan while unloading,
 * each written so that it costs one exponential or one tangent. */
static inline double friction_after_slip(double state, double increment, const friction_coefficients *c)
{
    double distance = fabs(increment);
    const double sign = increment >= 0.0 ? 1.0 : -1.0;
    double zeta = sign * state;
    if (zeta < 0.0) { /* unloading, up to zeta = 0 at most */
        const double depth = -zeta / c->unloading_scale;
        const double angle = c->unloading_rate * distance;
        const double climb = angle < friction_quarter_turn ? tan(angle) : INFINITY;
        if (climb <= depth) {
            return sign * c->unloading_scale * (climb - depth) / (1.0 + climb * depth); /* tan(angle - atan(depth)) */
        }
        distance -= atan(depth) / c->unloading_rate;
        zeta = 0.0;
    }
    if (fabs(zeta - c->plateau) <= friction_settled * c->plateau) {
        return sign * c->plateau;
    }
    const double fading = exp(-2.0 * c->loading_rate * distance); /* the step's tanh is (1 - fading)/(1 + fading) */
    const double rest = 1.0 + fading, rise = 1.0 - fading;
    return sign * (zeta * rest + c->plateau * rise) / (rest + zeta / c->plateau * rise);
}

/* Move z_d along a one-way change of the deflection. */
static inline double friction_state(double state, double increment, const friction_coefficients *c)
{
    return increment == 0.0 ? state : friction_after_slip(state, increment, c);
}

/* Move z_d from one (deflection x, rate v) to the next, by way of the turning point where the rate, linear over the
 * substep, changes sign. */
static inline double friction_through_reversal(double friction, double x_0, double v_0, double x_1, double v_1, double h,
                                               const friction_coefficients *c)
{
    if (v_0 * v_1 < 0.0) {
        const double share = v_0 / (v_0 - v_1);
        const double turning = 0.5 * (x_0 + x_1 + h * (v_0 * share - v_1 * (1.0 - share)) * 0.5);
        friction = friction_state(friction, turning - x_0, c);
        x_0 = turning;
    }
    return friction_state(friction, x_1 - x_0, c);
}

#endif
