/* Bump, sine and sweep; see profiles.py for the formulas. */
#include "profiles.h"

#include "smooth_step.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

void profile_bump(double time, double height, double length, double speed, shaker_outputs *floor)
{
    floor->floor_displacement = floor->floor_velocity = floor->floor_acceleration = 0.0;
    if (time >= -SHAKER_TIME_TOLERANCE && time < length / speed - SHAKER_TIME_TOLERANCE) {
        const double omega = 2.0 * pi * speed / length;
        const double half = 0.5 * height;
        floor->floor_displacement = half * (1.0 - cos(omega * time));
        floor->floor_velocity = half * omega * sin(omega * time);
        floor->floor_acceleration = half * omega * omega * cos(omega * time);
    }
}

void profile_sine(double time, double frequency, double amplitude, shaker_outputs *floor)
{
    const double omega = 2.0 * pi * frequency;
    floor->floor_displacement = amplitude * sin(omega * time);
    floor->floor_velocity = amplitude * omega * cos(omega * time);
    floor->floor_acceleration = -amplitude * omega * omega * sin(omega * time);
}

void profile_envelope(double time, double duration, double fade, double envelope[3])
{
    const int rising = time + time <= duration;
    smooth_step((rising ? time : duration - time) / fade, envelope);
    envelope[1] = (rising ? envelope[1] : -envelope[1]) / fade;
    envelope[2] = envelope[2] / (fade * fade);
}

void profile_sweep(double time, const shaker_parameters *p, shaker_outputs *floor)
{
    floor->floor_displacement = floor->floor_velocity = floor->floor_acceleration = 0.0;
    if (time > 0.0 && time < p->sweep_duration) {
        const double beta = log(p->sweep_stop_frequency / p->sweep_start_frequency) / p->sweep_duration;
        const double omega_0 = 2.0 * pi * p->sweep_start_frequency;
        const double growth = expm1(beta * time);
        const double omega = omega_0 * (1.0 + growth);
        const double phase = omega_0 * (beta != 0.0 ? growth / beta : time);
        const int of_displacement = p->sweep_mode == SHAKER_SWEEP_DISPLACEMENT;
        const double decay = of_displacement ? 0.0 : 2.0 * beta; /* A' = -decay A */
        const double amplitude = of_displacement ? p->sweep_displacement : p->sweep_acceleration / (omega * omega);
        const double s = amplitude * sin(phase), c = amplitude * cos(phase);
        const double velocity = omega * c - decay * s;
        const double acceleration = (decay * decay - omega * omega) * s + (beta - 2.0 * decay) * omega * c;
        double e[3];
        profile_envelope(time, p->sweep_duration, p->sweep_fade, e);
        floor->floor_displacement = e[0] * s;
        floor->floor_velocity = e[0] * velocity + e[1] * s;
        floor->floor_acceleration = e[0] * acceleration + 2.0 * e[1] * velocity + e[2] * s;
    }
}
