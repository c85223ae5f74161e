"""``seat-cosim info``: what is in an FMU, a system, a parameter set or a run."""

from __future__ import annotations

import re
import zipfile
from pathlib import Path
from typing import Any

import click
from rich.box import SIMPLE
from rich.table import Column, Table

from cosim.errors import SetupError
from cosim.fmi.description import ModelDescription
from seat_cosim.carried import fmu, ssp
from seat_cosim.cli.console import console


@click.command()
@click.argument("file", metavar="FILE|NAME")
def info(file: str) -> None:
    """Show what is in an FMU, a system, a parameter set or a run.json.

    That is: variables with units, ranges and start values; components and connections; values; how a run was made.

    \b
    Without a suffix: an FMU of this project (SeatController, SeatPlant, Shaker, TruckCab, SeatedDriver, ActiveSeat,
    PassiveSeat, SemiActiveSeat), a system (SeatSuspension, TruckSeat, and -fmi3 of both), or a parameter set (load,
    passive, prototype, ride).
    Examples:
      seat-cosim info SeatController
      seat-cosim info SeatSuspension
      seat-cosim info Foreign.fmu
    """
    path = _path(file)
    shown = {".fmu": _fmu, ".ssp": _system, ".ssd": _system, ".ssv": _parameters, ".json": _run}.get(path.suffix)
    if shown is None:
        raise SetupError(f"{file}: expected an .fmu, .ssp, .ssd, .ssv or run.json, got {path.suffix or 'no suffix'}")
    shown(path)


def _path(file: str) -> Path:
    """Return the path of a file, or of a file of this project by its name."""
    from plant_models import parameter_sets
    from seat_cosim.scenarios import SYSTEM_FILES

    path = Path(file).expanduser()
    if path.suffix or path.exists() or path.name != file:
        return path
    if file in parameter_sets.NAMES:
        return parameter_sets.path(file)
    systems = {Path(name).stem for names in SYSTEM_FILES.values() for name in names.values()}
    return ssp(file) if file in systems else fmu(file)


def _fmu(path: Path) -> None:
    model = ModelDescription.read(path)
    about = model.description
    console.print(f"{about.modelName}, FMI {about.fmiVersion}, {path}", soft_wrap=True, markup=False)
    if about.description:
        console.print(about.description, soft_wrap=True, markup=False)
    with zipfile.ZipFile(path) as archive:
        platforms = sorted(set(re.findall(r"^binaries/([^/\n]+)/", "\n".join(archive.namelist()), re.MULTILINE)))
    console.print(f"binaries: {', '.join(platforms) or 'none'}", soft_wrap=True, markup=False)
    if about.defaultExperiment is not None and about.defaultExperiment.stepSize:
        console.print(f"step size: {about.defaultExperiment.stepSize} s by default")
    table = Table(
        Column("variable", no_wrap=True), "causality", "type", "unit", "start", "min", "max", "description", box=SIMPLE
    )
    for variable in model.variables.values():
        low, high = model.bounds.get(variable.name, (None, None))
        table.add_row(
            variable.name,
            variable.causality,
            variable.type,
            model.unit(variable) or "",
            "" if variable.start is None else str(variable.start),
            "" if low is None else f"{low:g}",
            "" if high is None else f"{high:g}",
            " ".join(filter(None, [variable.description, _items(variable)])),
        )
    console.print(table, markup=False)


def _items(variable: Any) -> str:
    """Return the items of an enumeration with their numbers, in brackets; nothing for other types."""
    if variable.type != "Enumeration" or variable.declaredType is None:
        return ""
    return f"({', '.join(f'{item.value} {item.name}' for item in variable.declaredType.items)})"


def _system(path: Path) -> None:
    from cosim.system import System

    system = System.load(path)
    console.print(f"{system.name}, {path}", soft_wrap=True, markup=False)
    stop = "no stop time" if system.stop_time is None else f"stop time {system.stop_time:g} s"
    step = "no step size" if system.step_size is None else f"step size {system.step_size:g} s"
    console.print(f"{stop}, {step}, {system.algorithm}, order {', '.join(system.order)}", soft_wrap=True)
    components = Table("component", "FMU", "FMI", "inputs", "outputs", box=SIMPLE)
    for name, model in system.models.items():
        causalities = [variable.causality for variable in model.variables.values()]
        counts = [str(causalities.count(kind)) for kind in ("input", "output")]
        components.add_row(name, model.where.name, model.description.fmiVersion, *counts)
    console.print(components)
    connections = Table("from", "to", "unit", "transformation", box=SIMPLE)
    for sink, connection in system.connections.items():
        factor, offset = connection.transformation
        text = "" if (factor, offset) == (1.0, 0.0) else f"{factor:g} x {offset:+g}"
        connections.add_row(str(connection.source), str(sink), system.unit(str(sink)) or "", text)
    console.print(connections)
    if system.parameters:
        parameters = Table("parameter", "value", "unit", box=SIMPLE)
        for name, value in sorted(system.parameters.items()):
            parameters.add_row(name, str(value), system.unit(name) or "")
        console.print(parameters)
    for note in system.notes():
        console.print(f"note: {note}", soft_wrap=True, markup=False)


def _parameters(path: Path) -> None:
    from cosim.ssp.ssv import read_parameter_set

    try:
        content = path.read_bytes()
    except OSError as error:
        raise SetupError(f"{path}: expected a parameter set (.ssv), got: {error.strerror}") from None
    found = read_parameter_set(content, str(path))
    console.print(f"{found.name}, {path}", soft_wrap=True, markup=False)
    if found.description:
        console.print(found.description, soft_wrap=True, markup=False)
    table = Table("parameter", "value", "unit", "description", box=SIMPLE)
    for parameter in found.parameters:
        typed = parameter.typed_value
        table.add_row(parameter.name, str(typed.value), typed.unit or "", parameter.description or "")
    console.print(table, markup=False)


def _run(path: Path) -> None:
    from cosim.manifest import Manifest

    run = Manifest.read(path)
    end = "complete" if run.complete else f"incomplete: {run.error}" if run.error else "incomplete"
    console.print(f"{run.name}, {run.rows} rows, {end}", soft_wrap=True, markup=False)
    console.print(f"{run.stop_time:g} s in steps of {run.step_size:g} s, {run.algorithm}", soft_wrap=True)
    if run.command:
        console.print(f"command: {' '.join(run.command)}", soft_wrap=True, markup=False)
    components = Table("component", "FMU", "FMI", "sha256", box=SIMPLE)
    for name, component in run.components.items():
        components.add_row(name, component.fmu, component.fmi, component.sha256[:12])
    console.print(components)
    parameters = Table("parameter", "value", box=SIMPLE)
    for name, value in run.parameters.items():
        parameters.add_row(name, str(value))
    console.print(parameters)
    for text in run.warnings:
        console.print(f"warning: {text}", soft_wrap=True, markup=False)
