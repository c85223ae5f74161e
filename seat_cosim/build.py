"""Everything that ``seat-cosim build`` builds: FMUs, systems of them, and the master's loop in C."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import chain
from pathlib import Path

from cosim.engine import native_stepper
from fmus import FLAVOURS
from fmus.export.build import PLATFORMS, build_library, host_platform
from fmus.export.fmu_file import BuildResult
from seat_cosim import components
from seat_cosim.scenarios import SCENARIOS, SHAKER, SYSTEM_FILES, TRUCK, seat_suspension

__all__ = ["PLATFORMS", "build_all"]

_WITHOUT_COMPILER = {"python"}
"""Flavours that are built without a compiler."""

_SCENARIOS = {SHAKER: SCENARIOS["bump"], TRUCK: SCENARIOS["truck"]}
"""Component that moves the floor to the scenario that its FMU runs by default."""


def build_all(folder: Path, flavours: Sequence[str] = (), platforms: Sequence[str] = ()) -> Iterator[BuildResult]:
    """Build the FMUs, then the loop in C where a compiler is used, then the systems of native FMUs.

    A file that would not change is not written.

    Parameters
    ----------
    folder
        Folder of the systems; each flavour's FMUs go to the subfolder of its name.
    flavours
        Names from :data:`fmus.FLAVOURS`; all where empty.
    platforms
        Names from :data:`PLATFORMS`; the host's where empty.

    Yields
    ------
    BuildResult
        Each file after it was built.

    Raises
    ------
    BuildError
        If a build tool fails.
    """
    chosen = flavours or FLAVOURS
    libraries: Iterable[BuildResult] = ()
    if set(chosen) != _WITHOUT_COMPILER:
        stepper = native_stepper
        libraries = build_library(stepper.NAME, stepper.sources(), stepper.fingerprint(), stepper.BUILT, platforms)
    yield from chain(components.build(folder, chosen, platforms), libraries, _build_systems(folder, chosen, platforms))


def _build_systems(folder: Path, flavours: Iterable[str], platforms: Iterable[str]) -> Iterator[BuildResult]:
    """Build systems of native FMUs that run a scenario each; FMUs of other machines cannot be connected here."""
    host = host_platform()
    for flavour, names in SYSTEM_FILES.items():
        if flavour not in flavours or host not in (tuple(platforms) or (host,)):
            continue
        for floor, name in names.items():
            system = seat_suspension(folder / flavour, floor)
            system.stop_time = _SCENARIOS[floor].stop_time
            yield BuildResult(folder / name, system.save(folder / name))
