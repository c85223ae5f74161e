"""A system as one FMU: a container, made by ``fmucontainer`` of the FMU Manipulation Toolbox.

Its own reader of SSP files takes components and connections, but neither values of parameters, nor a choice of signals
to show, nor ``-sequential``: components then always exchange values all at once. So a system is also written as the
tool's own configuration, which has all of that, but no transformations.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from cosim.engine.network import VariableRef
from cosim.engine.structure import Structure
from cosim.units import IDENTITY

TOOLS = Path(sys.executable).parent
"""Where the toolbox's commands are."""


def shown_as(signal: str) -> str:
    """Name an output of the container, which already calls the link itself ``component.variable``."""
    return signal.replace(".", "_", 1)


def configuration(system: Structure, step_size: float, signals: Sequence[str], sequential: bool) -> dict[str, Any]:
    """Write a system in the tool's words; components are called ``NAME.fmu``, in the order in which they step."""

    def words(port: VariableRef) -> list[str]:
        return [f"{port.component}.fmu", port.variable]

    transformed = [str(sink) for sink, feed in system.connections.items() if feed.transformation != IDENTITY]
    if transformed:
        raise ValueError(
            f"{', '.join(transformed)}: expected connections without transformation, which containers lack"
        )
    return {
        "name": "container.fmu",
        "step_size": step_size,
        "sequential": sequential,
        "auto_link": False,
        "auto_input": False,
        "auto_output": False,
        "fmu": [f"{name}.fmu" for name in system.order],
        "link": [[*words(feed.source), *words(sink)] for sink, feed in system.connections.items()],
        "output": [[*words(system.parse(signal)), shown_as(signal)] for signal in signals],
        "start": [[*words(system.parse(name)), value] for name, value in system.parameters.items()],
    }


def contain(system: Structure, folder: Path, step_size: float, signals: Sequence[str], sequential: bool) -> Path:
    """Make a system into one FMU.

    Parameters
    ----------
    system
        Without transformations.
    folder
        Where the FMU and what it is made of are put; it exists.
    step_size
        In s.
    signals
        Outputs to show, as ``component.variable``; see :func:`shown_as`.
    sequential
        Whether components step one after the other, each with the newest values, or exchange them all at once.

    Raises
    ------
    RuntimeError
        If the tool fails, with what it said.
    """
    for name, model in system.models.items():
        (folder / f"{name}.fmu").write_bytes(model.content())
    text = json.dumps(configuration(system, step_size, signals, sequential))
    (folder / "container.json").write_text(text, encoding="utf-8")
    return _made(folder, "container.json")


def contain_ssp(ssp: Path, step_size: float) -> Path:
    """Make an SSP file into one FMU beside it, by the tool's own reader; linked signals are shown.

    Raises
    ------
    RuntimeError
        As :func:`contain`.
    """
    return _made(ssp.parent, f"{ssp.name}:{step_size}", "-sequential", "-auto-local", made=ssp.with_suffix(".fmu").name)


def _made(folder: Path, source: str, *options: str, made: str = "container.fmu") -> Path:
    words = [str(TOOLS / "fmucontainer"), "-container", source, "-fmu-directory", ".", *options]
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False, timeout=120)
    if done.returncode or not (folder / made).is_file():
        raise RuntimeError(f"fmucontainer ended with {done.returncode}: {(done.stdout + done.stderr).strip()[-500:]}")
    return folder / made


def checked(fmu: Path) -> list[str]:
    """Let ``fmutool -check`` look at an FMU; returns what it has against it.

    Raises
    ------
    RuntimeError
        If it did not look.
    """
    words = [str(TOOLS / "fmutool"), "-input", str(fmu), "-check"]
    done = subprocess.run(words, capture_output=True, text=True, check=False, timeout=120)
    said = (done.stdout + done.stderr).splitlines()
    if done.returncode or not any("Conformity Checks" in line for line in said):
        raise RuntimeError(f"fmutool ended with {done.returncode}: {' '.join(said)[-500:]}")
    return [line for line in said if not line.startswith("INFO")]
