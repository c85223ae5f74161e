/* The shaker: the cabin floor's displacement, velocity and acceleration as functions of time. See shaker.h. */
#include "shaker.h"

#include <math.h>
#include <stddef.h>

static const double pi = 3.14159265358979323846;

/* Times closer than this, in s, are one instant: communication points carry rounding errors. */
static const double same_instant = 1e-9;

/* The bump (34), z_v = a/2 (1 - cos(2 pi v_0 t/l)) for 0 <= t <= l/v_0, and its derivatives; right limits. */
static shaker_outputs bump(double time, double height, double length, double speed)
{
    shaker_outputs floor = {0.0, 0.0, 0.0};
    if (time >= -same_instant && time < length / speed - same_instant) {
        const double omega = 2.0 * pi * speed / length;
        const double half = 0.5 * height;
        floor.floor_displacement = half * (1.0 - cos(omega * time));
        floor.floor_velocity = half * omega * sin(omega * time);
        floor.floor_acceleration = half * omega * omega * cos(omega * time);
    }
    return floor;
}

/* z_v = A sin(2 pi f t) and its derivatives. */
static shaker_outputs sine(double time, double frequency, double amplitude)
{
    const double omega = 2.0 * pi * frequency;
    shaker_outputs floor;
    floor.floor_displacement = amplitude * sin(omega * time);
    floor.floor_velocity = amplitude * omega * cos(omega * time);
    floor.floor_acceleration = -amplitude * omega * omega * sin(omega * time);
    return floor;
}

static shaker_outputs floor_motion(double time, const shaker_parameters *p)
{
    if (p->profile == SHAKER_SINE) {
        return sine(time, p->sine_frequency, p->sine_amplitude);
    }
    return bump(time, p->bump_height, p->bump_length, p->bump_speed);
}

const char *shaker_prepare(const shaker_parameters *parameters, shaker_coefficients *coefficients)
{
    *coefficients = *parameters;
    return NULL;
}

const char *shaker_warning(const shaker_parameters *parameters)
{
    (void)parameters;
    return NULL;
}

void shaker_initial(shaker_state *state, const shaker_inputs *inputs, const shaker_coefficients *coefficients,
                    double time, shaker_outputs *outputs)
{
    (void)inputs;
    state->none = 0;
    *outputs = floor_motion(time, coefficients);
}

void shaker_advance(shaker_state *state, const shaker_inputs *inputs, const shaker_coefficients *coefficients,
                    double time, double step_size, shaker_outputs *outputs)
{
    (void)state;
    (void)inputs;
    *outputs = floor_motion(time + step_size, coefficients);
}
