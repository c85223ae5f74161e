/* Classical Runge-Kutta for masses that move along one line, and the length of its substeps; the C twin of
 * runge_kutta.py. In a header, so that the compiler can inline the slopes. */
#ifndef RUNGE_KUTTA_H
#define RUNGE_KUTTA_H

#include "subnormal.h"

#include <math.h>

/* Longest substep in s. */
static const double runge_kutta_max_substep = 0.5e-3;

/* Substeps per radian of the fastest motion. */
static const double runge_kutta_substeps_per_radian = 2.0;

/* Parameters that need a substep below this, in s, are refused: a step would take too long. */
static const double runge_kutta_min_substep = 1e-5;

/* Largest number of masses. */
enum { RUNGE_KUTTA_MAX_MASSES = 5 };

/* Write the accelerations in m/s2 at displacements in m, velocities in m/s and the share of the substep that has
 * passed: 0, 0.5 or 1. */
typedef void runge_kutta_slope(const double z[], const double v[], double share, double a[], const void *context);

/* Return the longest substep in s for the fastest motion of a model, in rad/s. */
static inline double runge_kutta_substep_for(double fastest)
{
    const double needed = 1.0 / (runge_kutta_substeps_per_radian * fastest);
    return fastest > 0.0 && !(runge_kutta_max_substep <= needed) ? needed : runge_kutta_max_substep;
}

/* Return the number of substeps over a time in s, at least 1. */
static inline double runge_kutta_substep_count(double time, double substep)
{
    const double needed = ceil(time / substep - 1e-6);
    return needed > 1.0 ? needed : 1.0;
}

static inline void runge_kutta_move(int count, const double x[], const double slope[], double h, double moved[])
{
    for (int i = 0; i < count; ++i) {
        moved[i] = x[i] + h * slope[i];
    }
}

static inline void runge_kutta_combine(int count, double x[], double sixth, const double s_1[], const double s_2[],
                                       const double s_3[], const double s_4[])
{
    for (int i = 0; i < count; ++i) {
        x[i] = flush_subnormal(x[i] + sixth * (s_1[i] + 2.0 * (s_2[i] + s_3[i]) + s_4[i]));
    }
}

/* Take one step of length h in s over the displacements and velocities of `count` masses. */
static inline void runge_kutta_step(int count, double z[], double v[], double h, runge_kutta_slope *slope,
                                    const void *context)
{
    const double half = 0.5 * h, sixth = h / 6.0;
    double moved[RUNGE_KUTTA_MAX_MASSES];
    double v_2[RUNGE_KUTTA_MAX_MASSES], v_3[RUNGE_KUTTA_MAX_MASSES], v_4[RUNGE_KUTTA_MAX_MASSES];
    double a_1[RUNGE_KUTTA_MAX_MASSES], a_2[RUNGE_KUTTA_MAX_MASSES];
    double a_3[RUNGE_KUTTA_MAX_MASSES], a_4[RUNGE_KUTTA_MAX_MASSES];
    slope(z, v, 0.0, a_1, context);
    runge_kutta_move(count, v, a_1, half, v_2);
    runge_kutta_move(count, z, v, half, moved);
    slope(moved, v_2, 0.5, a_2, context);
    runge_kutta_move(count, v, a_2, half, v_3);
    runge_kutta_move(count, z, v_2, half, moved);
    slope(moved, v_3, 0.5, a_3, context);
    runge_kutta_move(count, v, a_3, h, v_4);
    runge_kutta_move(count, z, v_3, h, moved);
    slope(moved, v_4, 1.0, a_4, context);
    runge_kutta_combine(count, z, sixth, v, v_2, v_3, v_4);
    runge_kutta_combine(count, v, sixth, a_1, a_2, a_3, a_4);
}

#endif
