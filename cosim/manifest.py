"""``run.json``: what is needed to repeat the run that made the result beside it, and to compare the bytes."""

from __future__ import annotations

import hashlib
import platform
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Literal

from cosim.engine.run_options import CheckedRun, RunOptions
from cosim.engine.structure import Algorithm, Structure
from cosim.errors import SetupError
from cosim.fmi.archive import is_file
from cosim.fmi.description import ModelDescription
from cosim.fmi.isolated import TIME_LIMIT
from cosim.fmi.variable_types import KINDS
from cosim.json_data import dump, load
from cosim.results.file_sink import FileSink
from cosim.results.formats import FORMATS
from cosim.results.result import MANIFEST
from cosim.system import System
from cosim.units import Linear

_PACKAGES = ("seat-cosim", "fmpy", "numpy")


@dataclass(frozen=True)
class ComponentRecord:
    """An FMU of a run.

    Attributes
    ----------
    fmu
        Its file, or the archive (an ``.ssp`` file) that holds it, as the run was given it: absolute, or relative to the
        folder the run was started in.
    member
        Its name in the archive; None for a file of its own.
    sha256
        Of the FMU, in an archive or not.
    model, guid, fmi
        What its description says of itself: name, GUID (instantiation token in FMI 3), version of the standard.
    step_size
        Its own, in s; None where it is that of the run.
    """

    fmu: str
    member: str | None
    sha256: str
    model: str
    guid: str
    fmi: str
    step_size: float | None = None


@dataclass(frozen=True)
class ConnectionRecord:
    """What feeds an input: ``factor`` * output + ``offset``, the conversion of units included.

    Attributes
    ----------
    output, input
        As ``component.variable``.
    factor, offset
        Of the transformation.
    """

    output: str
    input: str
    factor: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True)
class Manifest:
    """A run and how it ended. Holds no date, and nothing of the folder it lies in.

    Attributes
    ----------
    format
        Version of this file's form.
    complete
        Whether the run reached its stop time; false as long as it runs.
    rows, error, warnings
        Of the result: how many, why it is not complete, what the FMUs said.
    files
        Name of each file of the result to its sha256.
    command
        What was typed, word by word; empty if the run was not started from a command line.
    versions, platform
        Of what ran it.
    name
        Of the system.
    components
        By name, in the order they were added.
    connections
        In the order they were made.
    order, algorithm
        How values are exchanged.
    parameters
        All that were given, ``component.variable`` to value; enumerations by name.
    stop_time, step_size
        In s.
    record, record_every
        Which outputs, and every how many steps.
    formats
        Of the files.
    real_time
        Whether it was paced; a run again is not, the values are the same.
    isolate, time_limit
        Components that ran in processes of their own, and how long a call of them could take, in s.
    """

    format: Literal[1]
    complete: bool
    rows: int
    error: str | None
    warnings: list[str]
    files: dict[str, str]
    command: list[str]
    versions: dict[str, str]
    platform: str
    name: str
    components: dict[str, ComponentRecord]
    connections: list[ConnectionRecord]
    order: list[str]
    algorithm: Algorithm
    parameters: dict[str, bool | int | float | str]
    stop_time: float
    step_size: float
    record: list[str]
    record_every: int = 1
    formats: list[str] = field(default_factory=lambda: ["csv"])
    real_time: bool = False
    isolate: list[str] = field(default_factory=list)
    time_limit: float = TIME_LIMIT

    @classmethod
    def of(
        cls,
        system: Structure,
        options: RunOptions | None = None,
        command: Sequence[str] = (),
        checked: CheckedRun | None = None,
    ) -> Manifest:
        """Describe a run that is about to begin.

        Parameters
        ----------
        system
            What runs.
        options
            Of the run.
        command
            The user's command line, if any.
        checked
            What :meth:`RunOptions.check` returned for the system, where it was called already.

        Raises
        ------
        SetupError
            If the run is not possible.
        """
        options = options or RunOptions()
        checked = checked or options.check(system)
        formats = list(dict.fromkeys([next(iter(FORMATS)), *options.formats]))
        return cls(
            format=1,
            complete=False,
            rows=0,
            error=None,
            warnings=[],
            files={},
            command=list(command),
            versions=_versions(formats),
            platform=platform.platform(),
            name=system.name,
            components={name: _component(system, name) for name in system.models},
            connections=[
                ConnectionRecord(str(connection.source), str(sink), *connection.transformation)
                for sink, connection in system.connections.items()
            ],
            order=list(system.order),
            algorithm=options.algorithm or system.algorithm,
            parameters=_parameters(system, checked.values),
            stop_time=checked.clock.stop_time,
            step_size=checked.clock.step_size,
            record=checked.record,
            record_every=options.record_every,
            formats=formats,
            real_time=options.real_time,
            isolate=[name for name in system.models if name in set(options.isolate)],
            time_limit=options.time_limit,
        )

    def ended(
        self, complete: bool, error: Exception | None, warnings: Iterable[str], sinks: Sequence[FileSink]
    ) -> Manifest:
        """Describe the same run when it is over, its files written."""
        return replace(
            self,
            complete=complete,
            rows=sinks[0].rows,
            error=None if error is None else str(error),
            warnings=list(warnings),
            files={sink.path.name: sha256(sink.path) for sink in sinks if sink.path.is_file()},
        )

    def write(self, folder: Path) -> None:
        """Write ``run.json`` to a folder; an earlier one is replaced at once."""
        unfinished = folder / f"{MANIFEST}.tmp"
        unfinished.write_text(dump(self), encoding="utf-8")
        unfinished.replace(folder / MANIFEST)

    @classmethod
    def read(cls, path: Path) -> Manifest:
        """Read a ``run.json``.

        Raises
        ------
        SetupError
            With all problems: no such file, no JSON, another format version, missing or unknown keys, wrong types.
        """
        try:
            text = path.read_text(encoding="utf-8", errors="replace")
        except OSError as error:
            raise SetupError(f"{path}: expected the {MANIFEST} of a run, got: {error.strerror}") from None
        return load(cls, text, str(path))

    def system(self) -> System:
        """Build the system again.

        Raises
        ------
        SetupError
            With all FMUs that are missing or not those of the run; if something does not fit them.
        """
        system = System()
        system.name = self.name
        for name, model in self._models().items():
            system.add(name, model)
        for name, component in self.components.items():
            if component.step_size is not None:
                system.component_steps[name] = component.step_size
        for c in self.connections:
            system.connect(c.output, c.input, Linear(c.factor, c.offset), convert_units=False)
        system.order = self.order
        system.algorithm = self.algorithm
        system.parameters.update(self.parameters)
        system.stop_time, system.step_size = self.stop_time, self.step_size
        return system

    def _models(self) -> dict[str, ModelDescription]:
        """Read the FMUs, if they are those of the run."""
        models: dict[str, ModelDescription] = {}
        problems: list[str] = []
        for name, component in self.components.items():
            path = Path(component.fmu)
            where = "" if path.is_absolute() or is_file(path) else f" in {Path.cwd()}, where its path starts"
            try:
                model = models[name] = ModelDescription.read(path, component.member)
            except SetupError as error:
                problems += [f"{name}: {problem}{where}" for problem in error.problems]
                continue
            if (found := _hash(model)) != component.sha256:
                expected = f"the FMU of the run (sha256 {component.sha256:.12}…)"
                problems.append(f"{name}: {model.where}: expected {expected}, got another ({found:.12}…)")
        if problems:
            raise SetupError(*problems)
        return models


def sha256(path: Path) -> str:
    """Hash a file."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def _hash(model: ModelDescription) -> str:
    return hashlib.sha256(model.content()).hexdigest()


def _component(system: Structure, name: str) -> ComponentRecord:
    model = system.models[name]
    about = model.description
    return ComponentRecord(
        fmu=model.path.as_posix(),
        member=model.member,
        sha256=_hash(model),
        model=about.modelName,
        guid=about.guid,
        fmi=about.fmiVersion,
        step_size=system.component_steps.get(name),
    )


def _parameters(
    system: Structure, values: Mapping[str, Mapping[str, float | str]]
) -> dict[str, bool | int | float | str]:
    """List all parameters given by the system or the run, by name, in the form of their types."""
    found = {
        f"{component}.{variable}": _shown(system.models[component], variable, value)
        for component, given in values.items()
        for variable, value in given.items()
    }
    return dict(sorted(found.items()))


def _shown(model: ModelDescription, name: str, value: float | str) -> bool | int | float | str:
    """Show what an FMU takes for a variable as its type means it."""
    variable = model.variables[name]
    kind = KINDS[variable.type]
    if kind == "Enumeration":
        return next((str(i.name) for i in variable.declaredType.items if float(i.value) == value), value)
    as_meant = {"Boolean": bool, "Integer": int}.get(kind)
    return as_meant(value) if as_meant else value


def _versions(formats: Iterable[str]) -> dict[str, str]:
    """List versions of what has a part in the result's bytes."""
    packages = (*_PACKAGES, *(p for name in formats if (p := FORMATS[name].package)))
    return {"python": platform.python_version(), **{name: _version(name) for name in sorted(packages)}}


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"
