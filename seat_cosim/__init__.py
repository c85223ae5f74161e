"""The application: the seat suspension, its scenarios, evaluation, the paper's experiments, the command line."""

from __future__ import annotations

from seat_cosim.carried import fmu, ssp

__all__ = ["fmu", "ssp"]
