/* Bouc-Wen friction (35)-(36) as an exact function of the deflection, the C twin of friction.py, which derives it. In a
 * header, so that the compiler can inline it into the Runge-Kutta stages. */
#ifndef FRICTION_H
#define FRICTION_H

#include <math.h>

/* Coefficients of the closed-form step. */
typedef struct {
    double plateau;         /* sqrt(A_d/(gamma_d + beta_d)) in m: the largest z_d that loading reaches */
    double loading_rate;    /* sqrt(A_d (gamma_d + beta_d)) in 1/m */
    double unloading_scale; /* sqrt(A_d/(gamma_d - beta_d)) in m */
    double unloading_rate;  /* sqrt(A_d (gamma_d - beta_d)) in 1/m */
} friction_coefficients;

/* A state within this share of the plateau is on it, and stays there while the deflection moves on. */
static const double friction_plateau_tolerance = 1e-12;

static const double friction_quarter_turn = 1.57079632679489661923;

/* Derive the coefficients from gamma_d and beta_d in 1/m2 and A_d; returns 0 where (36) has no plateau, else 1. */
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

/* Advance z_d in m along a change of the deflection in m in one direction, exactly: tanh while loading, tan while
 * unloading, each written so that it costs one exponential or one tangent. */
static inline double friction_after_slip(double z_d, double increment, const friction_coefficients *c)
{
    if (increment == 0.0) {
        return z_d;
    }
    double distance = fabs(increment);
    const double sign = increment >= 0.0 ? 1.0 : -1.0;
    double zeta = sign * z_d;
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
    if (fabs(zeta - c->plateau) <= friction_plateau_tolerance * c->plateau) {
        return sign * c->plateau;
    }
    const double decay = exp(-2.0 * c->loading_rate * distance); /* the tanh of the step is (1 - decay)/(1 + decay) */
    const double total = 1.0 + decay, rise = 1.0 - decay;
    return sign * (zeta * total + c->plateau * rise) / (total + zeta / c->plateau * rise);
}

/* Advance z_d in m over a substep of length h in s between two deflections x in m with rates v in m/s. Where the rate,
 * linear over the substep, changes its sign, the friction goes through the turning point. */
static inline double friction_through_reversal(double z_d, double x_0, double v_0, double x_1, double v_1, double h,
                                               const friction_coefficients *c)
{
    if (v_0 * v_1 < 0.0) {
        const double share = v_0 / (v_0 - v_1);
        const double turning = 0.5 * (x_0 + x_1 + h * (v_0 * share - v_1 * (1.0 - share)) * 0.5);
        z_d = friction_after_slip(z_d, turning - x_0, c);
        x_0 = turning;
    }
    return friction_after_slip(z_d, x_1 - x_0, c);
}

#endif
