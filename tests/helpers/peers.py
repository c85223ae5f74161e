"""Other masters that read SSP files, each run in a process of its own: they print, and keep what they loaded.

libcosim takes the step from the file, the others as an argument. All but the sequential container exchange all values
at once, after every step.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from cosim import System
from cosim.engine.structure import Algorithm
from tests.helpers.paths import ROOT

Signals = Sequence[str]
"""Names of numbers as ``component.variable``."""


def libcosim(ssp: str, steps: int, step_size: float, signals: Signals) -> list[list[float]]:
    """Run in libcosim; returns one row a step, the values after it."""
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimObserver import CosimObserver

    log_output_level(CosimLogLevel.FATAL)
    execution = CosimExecution.from_ssp_file(ssp_path=ssp)
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    places = []
    for signal in signals:
        component, _, variable = signal.partition(".")
        slave = execution.slave_index_from_instance_name(component)
        known = {v.name.decode(): v.reference for v in execution.slave_variables(slave)}
        places.append((slave, [known[variable]]))
    rows = []
    for _ in range(steps):
        if not execution.step():
            raise RuntimeError(f"libcosim stopped at {execution.status().current_time} ns")
        rows.append([observer.last_real_values(*place)[0] for place in places])
    if execution.status().current_time != round(1e9 * steps * step_size):
        raise RuntimeError(f"libcosim took steps of {execution.status().current_time / steps} ns")
    return rows


def ecos(ssp: str, steps: int, step_size: float, signals: Signals) -> list[list[float]]:
    """Run in Ecos; as :func:`libcosim`."""
    from ecospy import EcosLib, EcosSimulation

    EcosLib.set_log_level("off")
    with EcosSimulation(ssp_path=ssp, step_size=step_size) as simulation:
        simulation.init(parameter_set="parameters")  # as the sets are called that are written here
        rows = []
        for _ in range(steps):
            simulation.step(1)
            rows.append([simulation.get_real(signal.replace(".", "::", 1)) for signal in signals])
        simulation.terminate()
    return rows


def fmpy_ssp(ssp: str, steps: int, step_size: float, signals: Signals) -> list[list[float]]:
    """Run in fmpy's own simulation of SSP files, which begins without an exchange; as :func:`libcosim`."""
    from fmpy.ssp.simulation import simulate_ssp

    result = simulate_ssp(ssp, stop_time=(steps - 0.5) * step_size, step_size=step_size)
    return [[float(row[signal]) for signal in signals] for row in result]


def container(ssp: str, steps: int, step_size: float, signals: Signals, sequential: bool = False) -> list[list[float]]:
    """Run as one container FMU of the FMU Manipulation Toolbox, which fmpy steps; as :func:`libcosim`."""
    from fmpy import simulate_fmu

    from tests.helpers.containers import contain, shown_as

    with tempfile.TemporaryDirectory() as folder:
        fmu = contain(System.load(ssp), Path(folder), step_size, signals, sequential)
        result = simulate_fmu(str(fmu), stop_time=steps * step_size, step_size=step_size, output_interval=step_size)
    return [[float(row[shown_as(signal)]) for signal in signals] for row in result[1:]]


PEERS: Mapping[str, Callable[[str, int, float, Signals], list[list[float]]]] = {
    "libcosim": libcosim,
    "Ecos": ecos,
    "fmpy.ssp": fmpy_ssp,
    "fmucontainer": container,
    "fmucontainer, sequential": partial(container, sequential=True),
}
"""Names of the masters and how to run them."""

PACKAGES = {
    "libcosim": "libcosimpy",
    "Ecos": "ecospy",
    "fmpy.ssp": "fmpy",
    "fmucontainer": "fmu_manipulation_toolbox",
    "fmucontainer, sequential": "fmu_manipulation_toolbox",
}
"""Their packages, which bring all but one library along: Ecos needs libtbb12."""


def run(peer: str, ssp: Path, steps: int, step_size: float, signals: Signals) -> dict[str, np.ndarray]:
    """Run a system in another master.

    Parameters
    ----------
    peer
        Name from :data:`PEERS`.
    ssp
        The system's file.
    steps, step_size
        How many steps of how many s.
    signals
        What to record, as ``component.variable``.

    Returns
    -------
    dict
        Signal to its values at t_1 ... t_N, after each step.

    Raises
    ------
    RuntimeError
        If the other master fails, with what it said last.
    """
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "rows.npy"
        command = [
            sys.executable,
            "-m",
            __spec__.name,
            peer,
            str(ssp),
            str(steps),
            str(step_size),
            str(target),
            *signals,
        ]
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120, cwd=ROOT)
        if not target.exists():
            raise RuntimeError(f"{peer} ended with {done.returncode}: {done.stderr.strip()[-500:]}")
        return dict(zip(signals, np.load(target).T, strict=True))


def missing(peer: str) -> str | None:
    """Say why a master cannot be run here; None if it can."""
    command = [sys.executable, "-c", f"import {PACKAGES[peer]}"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)
    return done.stderr.strip().splitlines()[-1] if done.returncode else None


SIGNALS = {"seat.driver_acceleration": "m/s²", "controller.force": "N"}
"""What is compared, and its unit."""


Values = Mapping[str, np.ndarray]
"""Signal to its values at t_1 ... t_N, after each step."""


def here(system: System, algorithm: Algorithm) -> Values:
    """Run a system in this master.

    A row holds the discrete outputs that follow from its own instant, which other masters show one step later.
    """
    result = system.simulate(record=list(SIGNALS), algorithm=algorithm)
    return {
        "seat.driver_acceleration": result["seat.driver_acceleration"][1:],
        "controller.force": result["controller.force"][:-1],
    }


def differences(one: Values, other: Values) -> list[float]:
    """Return the largest difference of each of :data:`SIGNALS`, in its unit."""
    return [float(np.abs(one[name] - other[name]).max()) for name in SIGNALS]


if __name__ == "__main__":
    _, name, file, count, size, output, *names = sys.argv
    np.save(output, PEERS[name](file, int(count), float(size), names))
