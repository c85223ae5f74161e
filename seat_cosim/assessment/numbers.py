"""Numbers of a measured ride: metrics of each channel, SEAT, and daily exposure."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from cosim.errors import SetupError, SignalError
from cosim.metrics import (
    ACTION,
    LIMIT,
    Ride,
    SeatFactor,
    a8,
    comfort,
    daily_vdv,
    hours_to_a8,
    hours_to_vdv,
    peak,
    ride,
    rms,
    seat_factor,
    weighted,
)
from cosim.metrics.whole_body import MTVV_TIME
from cosim.recordings import Recording
from seat_cosim.assessment.spectra import RideSpectra, resolution_for, ride_spectra


@dataclass(frozen=True)
class Exposure:
    """Daily exposure by Directive 2002/44/EC.

    Attributes
    ----------
    hours
        Daily duration in h.
    a8
        A(8) in m/s2.
    vdv
        Daily vibration dose value in m/s^1.75.
    to_action, to_limit
        Hours until A(8) reaches the action and the limit value; infinite without vibration.
    to_action_vdv, to_limit_vdv
        Hours until the vibration dose value reaches them.
    """

    hours: float
    a8: float
    vdv: float
    to_action: float
    to_limit: float
    to_action_vdv: float
    to_limit_vdv: float

    @classmethod
    def of(cls, measured: Ride, hours: float) -> Exposure:
        """Extrapolate a ride to a day.

        Parameters
        ----------
        measured
            Metrics of the ride.
        hours
            Daily duration in h.

        Returns
        -------
        Exposure
            The exposure.
        """
        return cls(
            hours,
            a8(measured.a_w, hours),
            daily_vdv(measured.vdv, measured.duration, hours),
            hours_to_a8(measured.a_w, ACTION),
            hours_to_a8(measured.a_w, LIMIT),
            hours_to_vdv(measured.vdv, measured.duration, ACTION),
            hours_to_vdv(measured.vdv, measured.duration, LIMIT),
        )


@dataclass(frozen=True)
class ChannelNumbers:
    """Numbers of one channel.

    Attributes
    ----------
    ride
        Metrics of the weighted acceleration.
    rms, peak
        RMS and largest magnitude of the unweighted acceleration in m/s2.
    exposure
        Daily exposure.
    """

    ride: Ride
    rms: float
    peak: float
    exposure: Exposure

    @property
    def comfort(self) -> str:
        """Likely reaction of passengers by ISO 2631-1, annex C."""
        return " or ".join(comfort(self.ride.a_w))


@dataclass(frozen=True)
class Assessment:
    """Assessment of a measured ride.

    Attributes
    ----------
    recording
        What was measured.
    channels
        ``floor``, ``seat`` or both to their numbers.
    seat_factor
        SEAT by a_w and by VDV; None without one of both channels.
    spectra
        Spectra and transmissibility.
    notes
        What a reader must know.
    """

    recording: Recording
    channels: Mapping[str, ChannelNumbers]
    seat_factor: SeatFactor | None
    spectra: RideSpectra
    notes: Sequence[str]

    @property
    def main(self) -> str:
        """The channel whose exposure counts: that of the seat, where there is one."""
        return "seat" if "seat" in self.channels else "floor"


def assess(recording: Recording, hours: float = 8.0, resolution: float | None = None) -> Assessment:
    """Assess a measured ride.

    Parameters
    ----------
    recording
        Accelerations of ``floor``, ``seat`` or both, without gravity.
    hours
        Daily duration of such rides in h.
    resolution
        Distance of the lines of spectra in Hz; chosen by the duration where None.

    Returns
    -------
    Assessment
        All numbers.

    Raises
    ------
    SetupError
        If metrics cannot be computed of the samples.
    """
    if not (math.isfinite(hours) and 0.0 < hours <= 24.0):
        raise SetupError(f"--hours {hours:g}: expected a daily duration above 0 and up to 24 h")
    notes = list(recording.notes)
    least = math.ceil(MTVV_TIME * recording.rate)
    used = tuple(part for part in recording.parts if part.size >= least)
    if not used:
        longest = max(part.size for part in recording.parts) / recording.rate
        raise SetupError(f"{recording.path}: expected at least {MTVV_TIME:g} s without a gap, got {longest:.3g} s")
    if len(used) < len(recording.parts):
        lost = recording.duration - sum(part.size for part in used) / recording.rate
        notes.append(f"{recording.path}: parts shorter than {MTVV_TIME:g} s are left out, {lost:.3g} s in all")
    recording = replace(recording, parts=used)
    lowest = min(info.rate for info in recording.channels.values())
    try:
        weighted([0.0], lowest)  # refuses a rate that is too low, also where another channel's is higher
        channels = {key: _numbers(recording, key, hours) for key in recording.channels}
        both = {"floor", "seat"} <= set(channels)
        factor = seat_factor(channels["seat"].ride, channels["floor"].ride) if both else None
        spectra = ride_spectra(recording, resolution or resolution_for(recording))
    except SignalError as error:
        raise SetupError(f"{recording.path}: {error}") from None
    if spectra.left_out:
        notes.append(f"{recording.path}: spectra leave out short parts, {spectra.left_out:.3g} s in all")
    main = channels["seat" if "seat" in channels else "floor"]
    if not main.ride.rms_suffices:
        notes.append("the ride has shocks, which a_w underestimates: judge it by VDV (ISO 2631-1, 6.3)")
    return Assessment(recording, channels, factor, spectra, tuple(notes))


def _numbers(recording: Recording, key: str, hours: float) -> ChannelNumbers:
    """Return the numbers of a channel over all parts."""
    rides = [ride(part.values[key], recording.rate) for part in recording.parts]
    whole = combined(rides)
    samples = recording.samples(key)
    return ChannelNumbers(whole, rms(samples), peak(samples), Exposure.of(whole, hours))


def combined(rides: Sequence[Ride]) -> Ride:
    """Combine the metrics of rides one after the other.

    Parameters
    ----------
    rides
        Metrics of each.

    Returns
    -------
    Ride
        a_w by energy, VDV by dose, the largest MTVV, and the largest weighted peak over a_w.
    """
    if len(rides) == 1:
        return rides[0]
    duration = sum(each.duration for each in rides)
    a_w = math.sqrt(sum(each.a_w**2 * each.duration for each in rides) / duration)
    dose = sum(each.vdv**4 for each in rides) ** 0.25
    largest = max((each.crest_factor * each.a_w for each in rides if each.a_w > 0.0), default=math.nan)
    return Ride(a_w, dose, max(each.mtvv for each in rides), largest / a_w if a_w else math.nan, duration)
