/* Second-order lag with limits of stroke, velocity and acceleration; see platform.py for the method. */
#include "platform.h"

#include <math.h>
#include <stddef.h>

static const double pi = 3.14159265358979323846;

static double smaller(double a, double b)
{
    return b < a ? b : a;
}

static double larger(double a, double b)
{
    return b > a ? b : a;
}

static double limit(double value)
{
    return value > 0.0 ? value : INFINITY;
}

const char *platform_prepare(const shaker_parameters *p, double tick, platform_coefficients *c)
{
    c->has_lag = p->platform_bandwidth > 0.0;
    if (!c->has_lag) {
        return p->platform_stroke > 0.0 || p->platform_velocity_limit > 0.0 || p->platform_acceleration_limit > 0.0
                   ? "expected platform.bandwidth above 0 where platform.stroke, platform.velocity_limit or "
                     "platform.acceleration_limit are"
                   : NULL;
    }
    const double omega = 2.0 * pi * p->platform_bandwidth;
    c->stiffness = omega * omega;
    c->damping = 2.0 * p->platform_damping * omega;
    c->tick = tick;
    c->stroke = limit(p->platform_stroke);
    c->velocity_limit = limit(p->platform_velocity_limit);
    c->acceleration_limit = limit(p->platform_acceleration_limit);
    c->braking = smaller(c->acceleration_limit, omega * omega * c->stroke);
    if (c->stroke < INFINITY) {
        c->stroke = c->stroke - c->braking * tick * tick / 8.0; /* between two ticks it may exceed it by this much */
    }
    return NULL;
}

/* Return the largest velocity in m/s at the end of a tick from which the platform can brake within the stroke; `room`
 * is the rest of the stroke in m if this velocity is 0. */
static double max_braking_velocity(double room, const platform_coefficients *c)
{
    const double half = 0.5 * c->braking * c->tick;
    return sqrt(larger(0.0, half * half + 2.0 * c->braking * room)) - half;
}

double platform_acceleration(double displacement, double velocity, const shaker_outputs *command,
                             const platform_coefficients *c)
{
    const double half = 0.5 * c->tick;
    const double target =
        command->floor_displacement + half * (command->floor_velocity + 0.5 * half * command->floor_acceleration);
    const double demand = (c->stiffness * (target - displacement - half * velocity) - c->damping * velocity) /
                          (1.0 + half * c->damping + half * half * c->stiffness);
    double highest = (c->velocity_limit - velocity) / c->tick;
    double lowest = (-c->velocity_limit - velocity) / c->tick;
    if (c->stroke < INFINITY) {
        const double middle = displacement + half * velocity;
        highest = smaller(highest, (max_braking_velocity(c->stroke - middle, c) - velocity) / c->tick);
        lowest = larger(lowest, (-max_braking_velocity(c->stroke + middle, c) - velocity) / c->tick);
    }
    return larger(-c->acceleration_limit, smaller(c->acceleration_limit, larger(lowest, smaller(highest, demand))));
}
