"""Profiles that are functions of time: bump (34), sine, sweep.

The sweep z = e(t) A(t) sin(phi(t)) has the angular frequency omega = omega_0 exp(beta t), beta = ln(f_1/f_0)/T, and so
the phase

    phi = omega_0 (exp(beta t) - 1)/beta.

Its amplitude is A = c omega^(-n). With n = 0 the amplitude of the displacement is constant. With n = 2 that of the
acceleration is, except for (beta/omega)^2/2 of it, which the changing frequency adds: 0.02 % at 0.5 Hz in a sweep to
20 Hz in one minute, and less above. Velocity and acceleration are the exact derivatives. The envelope e is twice
continuously differentiable and fades the motion in from rest and out to rest.
"""

from __future__ import annotations

import math

from plant_models.shaker.interface import Outputs, Parameters, SweepMode
from plant_models.smooth_step import smooth_step

TIME_TOLERANCE = 1e-9
"""Times closer than this, in s, are equal: communication points carry rounding errors."""


def bump(time: float, height: float, length: float, speed: float) -> Outputs:
    """Evaluate the bump (34), z_v = a/2 (1 - cos(2 pi v_0 t/l)) for 0 <= t <= l/v_0, and its derivatives.

    Parameters
    ----------
    time
        Time since the begin of the bump, in s.
    height, length, speed
        a in m, l in m, v_0 in m/s.

    Returns
    -------
    Outputs
        Right limits: the acceleration jumps at both ends of the bump.

    Examples
    --------
    >>> bump(0.4, height=0.07, length=0.8, speed=1.0).floor_displacement
    0.07
    """
    if not -TIME_TOLERANCE <= time < length / speed - TIME_TOLERANCE:
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

    Returns
    -------
    Outputs
        Motion of the floor.
    """
    omega = 2.0 * math.pi * frequency
    return Outputs(
        floor_displacement=amplitude * math.sin(omega * time),
        floor_velocity=amplitude * omega * math.cos(omega * time),
        floor_acceleration=-amplitude * omega * omega * math.sin(omega * time),
    )


def envelope(time: float, duration: float, fade: float) -> tuple[float, float, float]:
    """Evaluate a window that fades in from time 0 and out to ``duration``.

    Parameters
    ----------
    time
        In s.
    duration
        Duration of the window, in s.
    fade
        Duration of each fade, in s; at most half the duration of the window.

    Returns
    -------
    value, slope, curvature : float
        From 0 to 1, and the derivatives in 1/s and 1/s2.
    """
    if time + time <= duration:
        value, slope, curvature = smooth_step(time / fade)
    else:
        value, slope, curvature = smooth_step((duration - time) / fade)
        slope = -slope
    return value, slope / fade, curvature / (fade * fade)


def sweep(time: float, p: Parameters) -> Outputs:
    """Evaluate the sweep and its derivatives; it is at rest before 0 and after its duration.

    Parameters
    ----------
    time
        Time since the begin of the sweep, in s.
    p
        Parameters of the shaker.

    Returns
    -------
    Outputs
        Motion of the floor.
    """
    if not 0.0 < time < p.sweep_duration:
        return Outputs()
    beta = math.log(p.sweep_stop_frequency / p.sweep_start_frequency) / p.sweep_duration
    omega_0 = 2.0 * math.pi * p.sweep_start_frequency
    growth = math.expm1(beta * time)
    omega = omega_0 * (1.0 + growth)
    phase = omega_0 * (growth / beta if beta != 0.0 else time)
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
