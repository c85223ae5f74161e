"""Measured signals from files of data loggers: text, MDF, MAT and Parquet, in SI units at a constant rate.

The reader finds what it can and refuses what it would have to guess. It knows quantities and units, but no seat.
"""

from cosim.recordings.quantities import ACCELERATION, DISPLACEMENT, Quantity
from cosim.recordings.recording import Part, Recording, read_recording
from cosim.recordings.requests import ChannelRequest, ClockRequest, ReadOptions, TextOptions

__all__ = [
    "ACCELERATION",
    "DISPLACEMENT",
    "ChannelRequest",
    "ClockRequest",
    "Part",
    "Quantity",
    "ReadOptions",
    "Recording",
    "TextOptions",
    "read_recording",
]
