"""Measured accelerations: gravity and offsets, plausibility of units, and recordings for the shaker."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from cosim.errors import SetupError, writing_to
from cosim.recordings import ACCELERATION, DISPLACEMENT, ChannelRequest, Part, ReadOptions, Recording, read_recording
from cosim.results.csv_file import format_header, format_rows
from cosim.units import GRAVITY
from plant_models.recording import MAX_ROWS
from seat_cosim.plausibility import MAX_ACCELERATION, QUIET_FLOOR

MAX_OFFSET = 0.05
"""Largest mean of an acceleration in m/s2 that is no offset."""

_IS_GRAVITY = 0.1
"""Largest deviation of a mean from that of gravity, as a share of it, that a tilted sensor explains."""


def without_offsets(recording: Recording) -> Recording:
    """Subtract gravity and offsets from the accelerations of a recording, and add notes on what was found.

    Parameters
    ----------
    recording
        The recording.

    Returns
    -------
    Recording
        Accelerations whose mean was above :data:`MAX_OFFSET` have a mean of 0.

    Raises
    ------
    SetupError
        If a channel without a unit has a mean of 1: it is in g, unless the caller says otherwise.
    """
    offsets: dict[str, float] = {}
    notes = list(recording.notes)
    for key, info in recording.channels.items():
        if info.quantity != ACCELERATION:
            continue
        where = f"{recording.path}, {info.column}"
        values = recording.samples(key)
        mean = float(values.mean())
        if info.unit is None and abs(abs(mean) - 1.0) < _IS_GRAVITY:
            raise SetupError(
                f"{where}: expected a unit, got none and a mean of {mean:.3g}, as of gravity in g; --unit g (or m/s2) "
                "says what it is"
            )
        if abs(abs(mean) - GRAVITY) < _IS_GRAVITY * GRAVITY:
            notes.append(f"{where}: contains gravity; the mean of {mean:.4g} m/s2 is subtracted")
            offsets[key] = mean
        elif abs(mean) > MAX_OFFSET:
            notes.append(f"{where}: has an offset; the mean of {mean:.4g} m/s2 is subtracted")
            offsets[key] = mean
        notes += _doubts(where, values - mean, info.unit)
    parts = tuple(Part(part.begin, _shifted(part.values, offsets)) for part in recording.parts)
    return replace(recording, parts=parts, notes=tuple(notes))


def _shifted(values: Mapping[str, np.ndarray], offsets: Mapping[str, float]) -> dict[str, np.ndarray]:  # type: ignore[type-arg]
    return {key: samples - offsets[key] if key in offsets else samples for key, samples in values.items()}


def _doubts(where: str, values: np.ndarray, unit: str | None) -> list[str]:  # type: ignore[type-arg]
    """Return what is doubtful about the size of an acceleration in m/s2."""
    root, largest = float(np.sqrt(np.mean(np.square(values)))), float(np.abs(values).max())
    if unit is None and 0.0 < root < QUIET_FLOOR:
        return [f"{where}: {root:.2g} m/s2 RMS is less than a smooth road gives: is it in g (--unit g)?"]
    if largest > MAX_ACCELERATION:
        return [f"{where}: reaches {largest:.3g} m/s2, beyond what drivers survive: check the unit, and for spikes"]
    return []


def read_ride(path: Path, channels: Mapping[str, tuple[str, str | None]], options: ReadOptions) -> Recording:
    """Read the accelerations of a measured ride.

    Parameters
    ----------
    path
        The measurement file.
    channels
        ``floor``, ``seat`` or both to the name of the column and to the unit of its values; None for the file's.
    options
        How to read the file.

    Returns
    -------
    Recording
        Accelerations without gravity and offset.

    Raises
    ------
    SetupError
        If the file cannot be used.
    """
    requests = {key: ChannelRequest(name, f"--{key}", (ACCELERATION,), unit) for key, (name, unit) in channels.items()}
    return without_offsets(read_recording(path, requests, options))


@dataclass(frozen=True)
class FloorRecording:
    """A recorded motion for the shaker.

    Attributes
    ----------
    recording
        The channel ``floor``, without a gap.
    """

    recording: Recording

    @property
    def duration(self) -> float:
        """Time from the first to the last sample, in s."""
        return (self.recording.parts[0].size - 1) / self.recording.rate

    @property
    def notes(self) -> tuple[str, ...]:
        """What was recognized, converted or resampled."""
        return self.recording.notes

    def stop_time(self, step_size: float) -> float:
        """Return the last multiple of a step within the recording.

        Parameters
        ----------
        step_size
            In s.

        Returns
        -------
        float
            In s.
        """
        return float(np.floor(self.duration / step_size + 1e-6)) * step_size

    def write(self, path: Path) -> None:
        """Write the file that the shaker reads: time in s, and acceleration in m/s2 or displacement in m.

        Parameters
        ----------
        path
            The file; its folder is made if it does not exist.

        Raises
        ------
        SetupError
            If it cannot be written.
        """
        samples = self.recording.parts[0].values["floor"]
        rows = np.column_stack([np.arange(len(samples)) / self.recording.rate, samples])
        with writing_to(path.parent):
            path.parent.mkdir(parents=True, exist_ok=True)
            text = format_header(["time", self.recording.channels["floor"].quantity.name]) + format_rows(rows)
            path.write_text(text, encoding="utf-8", newline="")


def read_floor(path: Path, channel: str, unit: str | None, options: ReadOptions) -> FloorRecording:
    """Read a recorded motion for the shaker.

    Parameters
    ----------
    path
        The measurement file.
    channel
        Name of its channel: an acceleration, or a displacement.
    unit
        Unit of its values; None for that of the file.
    options
        How to read the file; gaps are refused.

    Returns
    -------
    FloorRecording
        Accelerations without gravity and offset.

    Raises
    ------
    SetupError
        If the file cannot be used.
    """
    request = ChannelRequest(channel, "--channel", (ACCELERATION, DISPLACEMENT), unit)
    recording = without_offsets(read_recording(path, {"floor": request}, replace(options, gaps="error")))
    count = recording.parts[0].size
    if count > MAX_ROWS:
        raise SetupError(
            f"{path}: expected at most {MAX_ROWS} samples for the shaker, got {count}; choose a part by --from and --to"
        )
    return FloorRecording(recording)
