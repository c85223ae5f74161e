"""Sets of assumptions that fit the paper's 55 kg column, and what they predict, from a study that is kept as a file.

``python -m studies.fitting_sets --write`` makes the file; docs/explanation/calibration.md describes the study.
"""

from __future__ import annotations

import csv
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np

from cosim.metrics.samples import Samples

FILE = Path(__file__).with_name("fitting_sets.csv")
"""One row for each set: assumptions, RMS at 55 kg, predictions."""


@dataclass(frozen=True)
class Predictions:
    """Predictions of one set.

    Attributes
    ----------
    reduction_55, reduction_70
        Reduction of the RMS from the passive to the controlled seat, in %; that of 55 kg is fitted within its scatter.
    bump_passive_55, bump_controlled_55, bump_passive_70, bump_controlled_70
        Peaks of the measured seat acceleration on the bump (34), in m/s2.
    """

    reduction_55: float
    reduction_70: float
    bump_passive_55: float
    bump_controlled_55: float
    bump_passive_70: float
    bump_controlled_70: float


def extremes(values: Samples) -> tuple[float, float]:
    """Return the least and the largest of some predictions."""
    return float(values.min()), float(values.max())


def read(path: Path = FILE) -> dict[str, Samples]:
    """Read the predictions of all sets.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    dict
        Field of :class:`Predictions` to its values, shape (sets,).
    """
    with path.open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    return {field.name: np.array([float(row[field.name]) for row in rows]) for field in fields(Predictions)}
