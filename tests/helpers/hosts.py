"""Ways in which a session steps its FMUs."""

from __future__ import annotations

from cosim.results.result import StepperName

LOOPS: tuple[StepperName, ...] = ("c", "python")

HOSTS: list[tuple[StepperName, bool]] = [("c", False), ("python", False), ("python", True)]
"""Loop, and whether the FMUs are isolated."""
