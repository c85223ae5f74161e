/* A motion over a communication step, the C twin of motion.py: a second-order Taylor series about its begin. */
#ifndef MOTION_H
#define MOTION_H

/* At the begin of the step in m, m/s, m/s2, up positive. */
typedef struct {
    double displacement, velocity, acceleration;
} base_motion;

/* Return the displacement in m at tau seconds after the begin of the step. */
static inline double motion_displacement_at(const base_motion *motion, double tau)
{
    return motion->displacement + tau * (motion->velocity + 0.5 * tau * motion->acceleration);
}

/* Return the velocity in m/s at tau seconds after the begin of the step. */
static inline double motion_velocity_at(const base_motion *motion, double tau)
{
    return motion->velocity + tau * motion->acceleration;
}

/* Return the same motion about the time tau seconds after the begin of the step. */
static inline base_motion motion_from_time(const base_motion *motion, double tau)
{
    const base_motion later = {motion_displacement_at(motion, tau), motion_velocity_at(motion, tau),
                               motion->acceleration};
    return later;
}

#endif
