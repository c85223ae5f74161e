"""The road under the two axles: a random road of a class of ISO 8608, a single obstacle, or a road from a file.

The power spectral density of the elevation of a random road is

    G(n) = Gd(n_0) n_0^2/(n^2 + n_c^2),    n_0 = 0.1 cycle/m,    n_c = 0.01 cycle/m,

which is Gd(n_0) (n/n_0)^-2 of ISO 8608 above the corner n_c, and bounded below it. It is the response of

    dz/dx = -2 pi n_c z + w

to white noise w with the density (2 pi n_0)^2 Gd(n_0). The noise is held over cells of 50 mm, and z follows by the
trapezoidal rule, which needs no exponential: all machines compute the same bits. In a cell z is linear. So the density
is G(n) sinc^2(n cell): 0.8 % below G at 1 cycle/m, 6 % at 2.8 cycle/m.

The noise of a cell follows from seed and number of the cell alone. Each axle has a filter of its own, the rear one the
wheelbase behind the front one: both meet the same road, and nothing has to be kept in a buffer. The road is flat up to
the front axle's place at the start.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from typing import NamedTuple

from plant_models import recording
from plant_models.random_numbers import random_normal, random_stream
from plant_models.recording import Samples
from plant_models.smooth_step import smooth_step
from plant_models.truck.interface import Parameters, Profile, RoadClass

CELLS_PER_METRE = 20.0
"""Number of cells of constant noise in a metre."""

CORNER = 0.01
"""n_c, in cycle/m."""

REFERENCE = 0.1
"""n_0, in cycle/m."""

LEVELS = {
    RoadClass.A: 16e-6,
    RoadClass.B: 64e-6,
    RoadClass.C: 256e-6,
    RoadClass.D: 1024e-6,
    RoadClass.E: 4096e-6,
}
"""Geometric mean of Gd(n_0) of a class, in m3, one-sided (ISO 8608 [9])."""


class Track(NamedTuple):
    """Random road in the cell under an axle.

    Attributes
    ----------
    cell
        Number of the cell; -1 before the road.
    begin, end
        Elevation at both ends of the cell, in m.
    """

    cell: int
    begin: float
    end: float


BEFORE = Track(-1, 0.0, 0.0)
"""An axle on the flat before the road."""


class Road(NamedTuple):
    """Coefficients of the road.

    Attributes
    ----------
    profile
        Profile of the road.
    decay, gain
        Factors on the elevation at the begin of a cell and on the normal number of the cell, 1 and m.
    stream
        Stream of random numbers.
    fade
        Distance over which the road rises from flat, in m.
    height, length, position
        Of the obstacle, in m.
    samples
        Road from a file; None for other profiles.
    """

    profile: Profile
    decay: float
    gain: float
    stream: int
    fade: float
    height: float
    length: float
    position: float
    samples: Samples | None


def prepare(p: Parameters) -> Road:
    """Derive the coefficients of the road.

    Parameters
    ----------
    p
        Parameters of the truck.

    Returns
    -------
    Road
        For :func:`advance` and :func:`elevation`.

    Raises
    ------
    ParameterError
        If the file of a road cannot be used.
    """
    cell = 1.0 / CELLS_PER_METRE
    half = math.pi * CORNER * cell
    return Road(
        profile=p.road_profile,
        decay=(1.0 - half) / (1.0 + half),
        gain=2.0 * math.pi * REFERENCE * math.sqrt(0.5 * LEVELS[p.road_class] * cell) / (1.0 + half),
        stream=random_stream(p.road_seed),
        fade=p.road_fade,
        height=p.obstacle_height,
        length=p.obstacle_length,
        position=p.obstacle_position,
        samples=recording.read(p.road_file, recording.ROAD) if p.road_profile == Profile.file else None,
    )


def advance(track: Track, distance: float, road: Road) -> Track:
    """Advance an axle to the cell at a distance.

    Parameters
    ----------
    track
        Cell in which the axle is.
    distance
        Distance of the axle from the begin of the road, in m.
    road
        Coefficients from :func:`prepare`.

    Returns
    -------
    Track
        The same where the axle is still in its cell; always before the road for other profiles than a random road.
    """
    if road.profile != Profile.iso8608:
        return track
    cell, begin, end = track
    while cell + 1 <= distance * CELLS_PER_METRE:
        cell += 1
        begin, end = end, road.decay * end + road.gain * random_normal(road.stream, cell)
    return Track(cell, begin, end)


def _recorded(distance: float, samples: Samples) -> float:
    """Interpolate the elevation from a file in m; the road is flat after its end."""
    x, z = samples.axis, samples.values
    if distance >= x[-1]:
        return z[-1] - z[0]
    i = bisect_right(x, distance) - 1
    return z[i] + (z[i + 1] - z[i]) * ((distance - x[i]) / (x[i + 1] - x[i])) - z[0]


def _obstacle(distance: float, road: Road) -> float:
    """Evaluate a single obstacle in m: bump and pothole are one period of a cosine, the kerb is a smooth step."""
    share = (distance - road.position) / road.length
    if road.profile == Profile.kerb:
        return road.height * smooth_step(share)[0]
    if not 0.0 < share < 1.0:
        return 0.0
    rise = 0.5 * road.height * (1.0 - math.cos(2.0 * math.pi * share))
    return -rise if road.profile == Profile.pothole else rise


def elevation(track: Track, distance: float, road: Road) -> float:
    """Evaluate the elevation of the road under an axle.

    Parameters
    ----------
    track
        Cell in which the axle is, from :func:`advance`.
    distance
        Distance of the axle from the begin of the road, in m.
    road
        Coefficients from :func:`prepare`.

    Returns
    -------
    float
        In m, up positive.
    """
    if distance <= 0.0:
        return 0.0
    if road.profile == Profile.iso8608:
        cell, begin, end = track
        rough = begin + (end - begin) * (distance * CELLS_PER_METRE - cell)
    elif road.samples is not None:
        rough = _recorded(distance, road.samples)
    else:
        return _obstacle(distance, road)
    return smooth_step(distance / road.fade)[0] * rough
