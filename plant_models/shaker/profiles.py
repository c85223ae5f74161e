"""Profiles that are functions of time: bump (34), sine, sweep.

The sweep z = e(t) A(t) sin(phi(t)) runs at omega = omega_0 exp(beta t), beta = ln(f_1/f_0)/T, which makes its phase

    phi = omega_0 (exp(beta t) - 1)/beta.

Its amplitude is A = c omega^(-n): n = 0 keeps that of the displacement; n = 2 that of the acceleration, but for the
sweep's own speed, which adds (beta/omega)^2/2 of it: 0.02 % at 0.5 Hz where a minute leads to 20 Hz, and less above.
Velocity and acceleration are the exact derivatives. The envelope e, twice continuously differentiable, leads from rest
and back to rest.
"""

from __future__ import annotations

import math

from plant_models.shaker.interface import Outputs, Parameters, SweepMode

SAME_INSTANT = 1e-9
"""Times closer than this, in s, are one instant: communication points carry rounding errors."""


def bump(time: float, height: float, length: float, speed: float) -> Outputs:
    """Evaluate the bump (34), z_v = a/2 (1 - cos(2 pi v_0 t/l)) for 0 <= t <= l/v_0, and its derivatives.

    Parameters
    ----------
    time
        Since the wheel met the bump, in s.
    height, length, speed
        a in m, l in m, v_0 in m/s.

    Returns
    -------
    Outputs
        Right limits: the acceleration jumps at both ends of the bump.
    """
    if not -SAME_INSTANT <= time < length / speed - SAME_INSTANT:
        return Outputs()
    omega = 2.0 * math.pi * speed / length
    half = 0.5 * height
    return Outputs(
        floor_displacement=half * (1.0 - math.cos(omega * time)),
        floor_velocity=half * omega * math.sin(omega * time),
        floor_acceleration=half * omega * omega * math.cos(omega * time),
    )


def sine(time: float, frequency: float, amplitude: float) -> Outputs:
    """Evaluate z_v = A sin(2 pi f t) and its derivatives.

    Parameters
    ----------
    time
        In s.
    frequency, amplitude
        f in Hz, A in m.
    """
    omega = 2.0 * math.pi * frequency
    return Outputs(
        floor_displacement=amplitude * math.sin(omega * time),
        floor_velocity=amplitude * omega * math.cos(omega * time),
        floor_acceleration=-amplitude * omega * omega * math.sin(omega * time),
    )


def rise(x: float) -> tuple[float, float, float]:
    """Rise from 0 at x = 0 to 1 at x = 1, flat and without curvature at both: value, slope, curvature."""
    if x <= 0.0:
        return 0.0, 0.0, 0.0
    if x >= 1.0:
        return 1.0, 0.0, 0.0
    return (
        x * x * x * (10.0 + x * (6.0 * x - 15.0)),
        30.0 * x * x * (1.0 - x) * (1.0 - x),
        60.0 * x * (1.0 - x) * (1.0 - 2.0 * x),
    )


def envelope(time: float, duration: float, fade: float) -> tuple[float, float, float]:
    """Fade in from 0 and out to ``duration``: value, first and second derivative; times in s, two fades fit in."""
    if time + time <= duration:
        value, slope, curvature = rise(time / fade)
    else:
        value, slope, curvature = rise((duration - time) / fade)
        slope = -slope
    return value, slope / fade, curvature / (fade * fade)


def sweep(time: float, p: Parameters) -> Outputs:
    """Evaluate the sweep and its derivatives at a time in s; at rest before 0 and after its duration."""
    if not 0.0 < time < p.sweep_duration:
        return Outputs()
    beta = math.log(p.sweep_stop_frequency / p.sweep_start_frequency) / p.sweep_duration
    omega_0 = 2.0 * math.pi * p.sweep_start_frequency
    grown = math.expm1(beta * time)
    omega = omega_0 * (1.0 + grown)
    phase = omega_0 * (grown / beta if beta != 0.0 else time)
    if p.sweep_mode == SweepMode.displacement:
        decay, amplitude = 0.0, p.sweep_displacement
    else:
        decay, amplitude = 2.0 * beta, p.sweep_acceleration / (omega * omega)  # A' = -decay A
    s, c = amplitude * math.sin(phase), amplitude * math.cos(phase)
    velocity = omega * c - decay * s
    acceleration = (decay * decay - omega * omega) * s + (beta - 2.0 * decay) * omega * c
    e, slope, curvature = envelope(time, p.sweep_duration, p.sweep_fade)
    return Outputs(
        floor_displacement=e * s,
        floor_velocity=e * velocity + slope * s,
        floor_acceleration=e * acceleration + 2.0 * slope * velocity + curvature * s,
    )
