"""The FMUs under test, as they are built or with sanitizers, and what an instance of one should be at any time."""

from __future__ import annotations

import math
import shutil
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from cosim.fmi.description import ModelDescription
from cosim.fmi.variable_types import KINDS
from fmus.component import MAX_STEP_SIZE, MAX_TIME, TIME_TOLERANCE
from fmus.export.native_fmu import STANDARDS, source_files
from seat_cosim.components import COMPONENTS
from tests.system.hostile.caller import Library

FLAVOURS = ("fmi2", "fmi3", "python")

SANITIZERS = ("-fsanitize=address,undefined,float-cast-overflow", "-fno-sanitize-recover=all")


@dataclass(frozen=True)
class Settable:
    """A parameter or an input, as the FMU's own description tells of it.

    Attributes
    ----------
    kind
        ``Real``, ``Integer`` (enumerations are), ``Boolean`` or ``String``.
    tunable
        Whether it may be set while the FMU steps.
    """

    name: str
    reference: int
    kind: str
    is_input: bool
    tunable: bool
    start: Any
    minimum: float
    maximum: float

    def is_legal(self, value: Any) -> bool:
        """Whether the FMU has to take a value; an input takes any, its steps do not."""
        if self.kind == "String":
            return len(value) <= 1023
        return (
            self.is_input or self.kind == "Boolean" or (math.isfinite(value) and self.minimum <= value <= self.maximum)
        )


@dataclass(frozen=True)
class ExtractedFmu:
    """An FMU that was extracted."""

    flavour: str
    name: str
    library: Library
    settable: tuple[Settable, ...]
    outputs: dict[str, list[int]] = field(hash=False)

    def __str__(self) -> str:
        return f"{self.flavour}/{self.name}"

    @property
    def is_native(self) -> bool:
        return self.flavour != "python"

    @property
    def inputs(self) -> tuple[Settable, ...]:
        return tuple(variable for variable in self.settable if variable.is_input)


def _kind(variable: Any) -> str:
    kind = KINDS[variable.type]
    return "Integer" if kind == "Enumeration" else str(kind)


def _settable(model: ModelDescription) -> Iterator[Settable]:
    for variable in model.variables.values():
        if variable.causality not in ("parameter", "input"):
            continue
        kind, (low, high) = _kind(variable), model.bounds[variable.name]
        if variable.type == "Enumeration":
            numbers = [int(item.value) for item in variable.declaredType.items]
            low, high = min(numbers), max(numbers)
        text = variable.start
        starts: dict[str, Any] = {"Boolean": text == "true", "String": text}
        yield Settable(
            name=variable.name,
            reference=variable.valueReference,
            kind=kind,
            is_input=variable.causality == "input",
            tunable=variable.causality == "input" or variable.variability == "tunable",
            start=starts[kind] if kind in starts else int(text) if kind == "Integer" else float(text),
            minimum=-math.inf if low is None else low,
            maximum=math.inf if high is None else high,
        )


def extracted_fmu(fmu: Path, flavour: str, folder: Path) -> ExtractedFmu:
    """Extract an FMU to a folder and describe it."""
    model = ModelDescription.read(fmu)
    place = folder / flavour / fmu.stem
    model.extract(place)
    version = model.description.fmiMajorVersion
    (binary,) = [path for path in (place / "binaries").rglob(f"{fmu.stem}.so") if "64" in path.parent.name]
    outputs: dict[str, list[int]] = {}
    for variable in model.outputs:
        outputs.setdefault(_kind(variable), []).append(variable.valueReference)
    library = Library(binary, version, model.description.guid, place / "resources")
    return ExtractedFmu(flavour, fmu.stem, library, tuple(_settable(model)), outputs)


def extracted_fmus(built: Path, folder: Path) -> list[ExtractedFmu]:
    """Extract all FMUs of all flavours; ``built`` holds the flavours' folders."""
    return [
        extracted_fmu(built / flavour / f"{c.name}.fmu", flavour, folder) for flavour in FLAVOURS for c in COMPONENTS
    ]


def sanitized(plain: ExtractedFmu) -> ExtractedFmu:
    """Compile a native FMU's sources again, with sanitizers that end the process where they find something."""
    (component,) = [component for component in COMPONENTS if component.name == plain.name]
    folder = plain.library.path.parent / "sanitized"
    folder.mkdir(exist_ok=True)
    for name, content in source_files(component, STANDARDS[plain.flavour], plain.library.token).items():
        (folder / name).write_bytes(content)
    library = folder / "sanitized.so"
    sources = sorted(path.name for path in folder.glob("*.c"))
    command = ["gcc", "-std=c99", "-g", "-O1", "-ffp-contract=off", "-shared", "-fPIC", "-I.", *SANITIZERS, *sources]
    subprocess.run([*command, "-o", library.name, "-lm"], cwd=folder, check=True)
    return replace(plain, library=replace(plain.library, path=library))


def sanitizers() -> dict[str, str]:
    """Return what the environment of a process has to say that loads a library with sanitizers."""
    found = [
        subprocess.run(["gcc", f"-print-file-name={name}"], capture_output=True, text=True, check=True).stdout.strip()
        for name in ("libasan.so", "libubsan.so")
    ]
    return {
        "LD_PRELOAD": " ".join(found),
        "ASAN_OPTIONS": "detect_leaks=0:allocator_may_return_null=1",  # leaks of Python itself drown ours
        "UBSAN_OPTIONS": "print_stacktrace=1",
    }


def can_sanitize() -> bool:
    return shutil.which("gcc") is not None


@dataclass
class Twin:
    """What an instance should be: its phase, its time and its values, by the description and the contract alone."""

    fmu: ExtractedFmu
    phase: str = "instantiated"
    time: float = 0.0
    values: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.values = self.values or {variable.name: variable.start for variable in self.fmu.settable}

    def __repr__(self) -> str:
        changed = {v.name: self.values[v.name] for v in self.fmu.settable if self.values[v.name] != v.start}
        return f"{self.fmu}, {self.phase} at t = {self.time!r} s with {changed}"

    def copy(self) -> Twin:
        return replace(self, values=dict(self.values))

    def may_set(self, variable: Settable) -> bool:
        """Whether the FMU may get a value now."""
        return variable.tunable and self.phase != "terminated" if self.phase in ("stepping", "terminated") else True

    def bad_inputs(self) -> dict[str, float]:
        """Inputs whose value no step can be made from."""
        return {v.name: self.values[v.name] for v in self.fmu.inputs if not math.isfinite(self.values[v.name])}

    def what_spoils_a_step(self) -> tuple[str, ...]:
        """What an error about an input has to say: variable, value and time."""
        return next(((name, f"{value:g}", f"{self.time:.10g}") for name, value in self.bad_inputs().items()), ())

    def is_next(self, time: float, step_size: float) -> bool:
        """Whether a step goes on where the last one ended, by a legal step size."""
        in_time = (
            abs(time - self.time) <= TIME_TOLERANCE * max(1.0, abs(self.time)) and 0.0 < step_size <= MAX_STEP_SIZE
        )
        within = abs(time + step_size) <= MAX_TIME
        return self.phase == "stepping" and in_time and within

    def may_step(self, time: float, step_size: float) -> bool:
        """Whether a step is one that has to be tried."""
        return self.is_next(time, step_size) and not self.bad_inputs()

    @property
    def tame(self) -> bool:
        """Whether all is as at the start, inputs aside, and these are moderate: then nothing may fail."""
        starts = all(self.values[v.name] == v.start for v in self.fmu.settable if not v.is_input)
        return starts and all(abs(self.values[v.name]) <= 10.0 for v in self.fmu.inputs)
