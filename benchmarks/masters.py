"""What a step of the seat suspension costs in several masters: ``python -m benchmarks.masters``.

Three native FMUs of FMI 2.0, 30 000 steps of 2 ms, time and six signals recorded; medians over rounds in which the
masters take turns, and the quickest rounds, which other programs disturbed least. The C program does the same calls as
this project's master, and its rows are compared with ours bit for bit. The peers run ``SeatSuspension.ssp``; libcosim
in the Python that ``--libcosimpy`` names, if it is installed there.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Callable
from contextlib import ExitStack, redirect_stdout
from io import StringIO
from pathlib import Path
from statistics import median
from time import perf_counter

import click
import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave
from rich.box import SIMPLE
from rich.console import Console
from rich.table import Table

from cosim import Result
from cosim.engine.network import VariableRef
from cosim.engine.run_options import RunOptions
from cosim.engine.session import Session
from cosim.fmi.description import ModelDescription
from fmus.export.native_fmu import OPTIONS
from seat_cosim.scenarios import seat_suspension

STEPS, H = 30_000, 0.002
SIGNALS = [
    "shaker.floor_displacement",
    "seat.suspension_deflection",
    "shaker.floor_acceleration",
    "seat.seat_acceleration",
    "seat.driver_acceleration",
    "controller.force",
]
"""In the order of masters.c."""

REFS = [VariableRef(*name.split(".")) for name in SIGNALS]
PARAMETERS = {"seat.driver_mass": 70.0, "controller.driver_mass": 70.0, "shaker.profile": "bump"}
ROUNDS = {True: 25, False: 3}
"""Rounds of quick masters and of slow ones."""

HEADERS = Path(fmpy.__file__).with_name("c-code")

COSIM = """
import sys
from time import perf_counter
from libcosimpy.CosimEnums import CosimVariableType
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimObserver import CosimObserver

ssp, steps, step, signals = sys.argv[1], int(sys.argv[2]), round(1e9 * float(sys.argv[3])), sys.argv[4:]
execution = CosimExecution.from_ssp_file(ssp, step)
observer = CosimObserver.create_time_series(steps + 1)
execution.add_observer(observer)
for signal in signals:
    component, _, variable = signal.partition(".")
    slave = execution.slave_index_from_instance_name(component)
    found = [v.reference for v in execution.slave_variables(slave) if v.name.decode() == variable]
    assert observer.start_time_series(slave, found[0], CosimVariableType.REAL)
begin = perf_counter()
execution.simulate_until(steps * step)
print(1e6 * (perf_counter() - begin) / steps, file=sys.stderr)
"""
"""Runs in a Python that has libcosimpy; prints us per step, not to where libcosim logs."""


def header(models: dict[str, ModelDescription], libraries: dict[str, Path], wiring: dict[str, list[str]]) -> str:
    """Write what the C program has to know of the FMUs."""
    lines = [f"enum {{ STEPS = {STEPS} }};", f"static const double STEP_SIZE = {H!r};"]
    for name, model in models.items():
        lines += [f'#define {name.upper()}_LIBRARY "{libraries[name]}"']
        lines += [f'#define {name.upper()}_GUID "{model.description.guid}"']
        for what, kinds in (("outputs", ("Real",)), ("flags", ("Boolean",)), ("codes", ("Integer", "Enumeration"))):
            found = [v for v in model.outputs if v.type in kinds]
            if found:
                indices = [f"{name.upper()}_{v.name}" for v in found]
                lines += [f"enum {{ {', '.join(indices)}, {name.upper()}_{what.upper()} }};"]
                lines += [_references(f"{name}_{what}", [v.valueReference for v in found])]
        if name in wiring:
            lines += [_references(f"{name}_inputs", [model.variables[v].valueReference for v in wiring[name]])]
    return "\n".join(lines) + "\n"


def _references(name: str, references: list[int]) -> str:
    return f"static const fmi2ValueReference {name}[] = {{{', '.join(map(str, references))}}};"


def build_program(folder: Path, fmus: Path) -> Path:
    """Compile the C program by zig, with the options of the FMUs."""
    system = seat_suspension(fmus)
    libraries = {}
    for name, model in system.models.items():
        fmpy.extract(str(model.path), str(folder / name))
        stem = model.description.coSimulation.modelIdentifier + fmpy.sharedLibraryExtension
        libraries[name] = folder / name / "binaries" / fmpy.platform / stem
    wiring: dict[str, list[str]] = {}
    for sink in system.connections:
        wiring.setdefault(sink.component, []).append(sink.variable)
    (folder / "system.h").write_text(header(system.models, libraries, wiring))
    command = [sys.executable, "-m", "ziglang", "cc", *OPTIONS, "-std=gnu99", "-I", str(HEADERS), "-I", str(folder)]
    source, program = Path(__file__).with_suffix(".c"), folder / "masters"
    subprocess.run([*command, str(source), "-o", str(program), "-ldl"], check=True)
    return program


class Plain:
    """The loop as a user of fmpy writes it."""

    def __init__(self, fmus: Path, stack: ExitStack) -> None:
        system = seat_suspension(fmus)
        self._fmus, self._references = {}, {}
        for name, model in system.models.items():
            folder = stack.enter_context(tempfile.TemporaryDirectory())
            fmpy.extract(str(model.path), folder)
            identifier = model.description.coSimulation.modelIdentifier
            fmu = FMU2Slave(
                guid=model.description.guid, modelIdentifier=identifier, unzipDirectory=folder, instanceName=name
            )
            fmu.instantiate()
            stack.callback(fmu.freeInstance)
            self._fmus[name] = fmu
            self._references[name] = {v.name: v.valueReference for v in model.description.modelVariables}
        self._connections = {sink: feed.source for sink, feed in system.connections.items()}

    def run(self) -> None:
        """Step from 0 to the stop time."""
        wanted = {*self._connections.values(), *REFS}
        inputs = {name: [p for p in self._connections if p.component == name] for name in self._fmus}
        outputs = {name: sorted(p for p in wanted if p.component == name) for name in self._fmus}
        to_set = {name: [self._references[name][ref.variable] for ref in refs] for name, refs in inputs.items()}
        to_get = {name: [self._references[name][ref.variable] for ref in refs] for name, refs in outputs.items()}
        values: dict[VariableRef, float] = {}
        for name, fmu in self._fmus.items():
            fmu.reset()
            fmu.setupExperiment(startTime=0.0)
            fmu.enterInitializationMode()
            fmu.exitInitializationMode()
            values.update(zip(outputs[name], fmu.getReal(to_get[name]), strict=True))
        rows = []
        for k in range(STEPS):
            time = k * H
            rows.append((time, *(values[ref] for ref in REFS)))
            for name in ("controller", "seat", "shaker"):
                fmu = self._fmus[name]
                if inputs[name]:
                    fmu.setReal(to_set[name], [values[self._connections[port]] for port in inputs[name]])
                fmu.doStep(currentCommunicationPoint=time, communicationStepSize=H)
                values.update(zip(outputs[name], fmu.getReal(to_get[name]), strict=True))
        for fmu in self._fmus.values():
            fmu.terminate()


def timed(run: Callable[[], object]) -> float:
    """Measure a run of all steps; in us per step."""
    begin = perf_counter()
    run()
    return 1e6 * (perf_counter() - begin) / STEPS


def fmpy_ssp(ssp: Path) -> Callable[[], object]:
    """Return a run of fmpy's own master, which prints."""
    from fmpy.ssp.simulation import simulate_ssp

    def run() -> None:
        with redirect_stdout(StringIO()):
            simulate_ssp(str(ssp), stop_time=STEPS * H, step_size=H)

    return run


def libcosim(python: str, ssp: Path) -> float:
    """Run libcosim; us per step."""
    command = [python, "-c", COSIM, str(ssp.resolve()), str(STEPS), str(H), *SIGNALS]
    found = subprocess.run(command, capture_output=True, text=True, check=False)
    if found.returncode:
        raise RuntimeError((found.stderr.strip() or "no reason given").splitlines()[-1])
    return float(found.stderr.split()[-1])


def further_run(session: Session) -> dict[str, tuple[float, float]]:
    """Measure what a further run costs beside its steps; medians and quickest in us."""
    options = RunOptions(H, H, PARAMETERS, SIGNALS)
    session.execute(options)
    checked = options.check(session._system)
    ready = session._prepared(options, checked)
    times: dict[str, list[float]] = {"a": [], "b": []}
    for _ in range(2000):
        with session._calling_fmus():
            begin = perf_counter()
            session._initialize(ready, checked, options)
            middle = perf_counter()
            session._terminate()
        times["a"].append(middle - begin)
        begin = perf_counter()
        session.run(H, H, PARAMETERS, SIGNALS)
        times["b"].append(perf_counter() - begin)
    setting_up, whole = ((1e6 * median(found), 1e6 * min(found)) for found in times.values())
    return {"reset, parameters, initialise": setting_up, "a whole run of one step, result and all": whole}


def same(result: Result, rows: Path) -> bool:
    """Compare our rows with the C program's, bit for bit."""
    ours = np.column_stack([result.time, *(result[name] for name in SIGNALS)])
    return ours.tobytes() == rows.read_bytes()


@click.command()
@click.option("--fmus", type=click.Path(path_type=Path), default=Path("fmus"), show_default=True)
@click.option("--ssp", type=click.Path(path_type=Path), default=Path("fmus/SeatSuspension.ssp"), show_default=True)
@click.option("--libcosimpy", "python", default=sys.executable, help="A Python that has libcosimpy [default: this one]")
def main(fmus: Path, ssp: Path, python: str) -> None:
    """Print a table."""
    console = Console(width=110, highlight=False)
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        executable, rows = build_program(folder, fmus / "fmi2"), folder / "rows"
        session = stack.enter_context(seat_suspension(fmus / "fmi2").open())
        plain = Plain(fmus / "fmi2", stack)

        def c_program() -> float:
            return float(subprocess.run([executable, rows], capture_output=True, text=True, check=True).stdout)

        def ours(stepper: str) -> Callable[[], float]:
            return lambda: timed(lambda: session.run(STEPS * H, H, record=SIGNALS, stepper=stepper))  # type: ignore[arg-type]

        masters: dict[str, tuple[bool, Callable[[], float]]] = {
            "C program, dlopen": (True, c_program),
            "this project, loop in C": (True, ours("c")),
            "this project, loop in Python": (False, ours("python")),
            "fmpy: setReal, doStep, getReal": (False, lambda: timed(plain.run)),
        }
        if ssp.is_file():
            masters["fmpy.ssp"] = (False, lambda: timed(fmpy_ssp(ssp)))
            masters["libcosim"] = (False, lambda: libcosim(python, ssp))
        else:
            console.print(f"{ssp}: no such file, so fmpy.ssp and libcosim are left out")
        found: dict[str, list[float]] = {name: [] for name in masters}
        for round_ in range(ROUNDS[True]):
            for name, (quick, run) in list(masters.items()):
                if round_ < ROUNDS[quick]:
                    try:
                        found[name].append(run())
                    except Exception as error:  # a peer's; ours have no reason to fail
                        console.print(f"{name} is left out: {error}", markup=False)
                        del masters[name]
        equal = same(session.run(STEPS * H, H, record=SIGNALS, stepper="c"), rows)
        further = further_run(session)
    table = Table("master", box=SIMPLE, title=f"{STEPS} steps of {1e3 * H:g} ms", title_justify="left")
    for title in ("us per step", "quickest", "against C", "quickest", "against ours"):
        table.add_column(title, justify="right")
    program, own = (found[name] for name in list(masters)[:2])
    for name in masters:
        middle, quickest = median(found[name]), min(found[name])
        ratios = f"{middle / median(program):.2f}", f"{quickest / min(program):.2f}", f"{middle / median(own):.1f}"
        table.add_row(name, f"{middle:.3f}", f"{quickest:.3f}", *ratios)
    console.print(table)
    console.print(f"rows of the C program and ours: {'the same bits' if equal else 'DIFFERENT'}")
    for name, (middle, quickest) in further.items():
        console.print(f"a further run of the loaded system, {name}: {middle:.1f} us, quickest {quickest:.1f} us")


if __name__ == "__main__":
    main()
