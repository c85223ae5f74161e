"""The file ``run.json``: how to repeat the run that gave the result beside it, and the hashes of the result's files."""

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
from cosim.errors import Problems, SetupError, prefixed
from cosim.fmi.archive import is_file
from cosim.fmi.description import ModelDescription
from cosim.fmi.isolated import TIME_LIMIT
from cosim.fmi.values import Checked
from cosim.fmi.variable_types import KINDS
from cosim.json_data import dump, load
from cosim.results.file_sink import FileSink
from cosim.results.formats import FORMATS
from cosim.results.result import MANIFEST
from cosim.system import System
from cosim.units import Linear

_PACKAGES = ("seat-cosim", "fmpy", "numpy")
"""Packages that influence every result."""


@dataclass(frozen=True)
class ComponentRecord:
    """An FMU of a run.

    Attributes
    ----------
    fmu
        Path of the FMU, or of the archive (an ``.ssp`` file) that holds it, as given to the run: absolute, or relative
        to the folder in which the run was started.
    member
        Name of the FMU in the archive; None where ``fmu`` is the FMU itself.
    sha256
        Hash of the FMU.
    model, guid, fmi
        Model name, GUID (instantiation token in FMI 3) and version of FMI from the model description.
    step_size
        The component's own step size in s; None where it is that of the run.
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
    """A connection of a run: input = ``factor`` * output + ``offset``.

    Attributes
    ----------
    output, input
        ``component.variable`` of each end.
    factor, offset
        The transformation, which includes the conversion of units.
    """

    output: str
    input: str
    factor: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True)
class Manifest:
    """A run and its end; independent of the date and of the folder in which it is stored.

    Attributes
    ----------
    format
        Version of the file format.
    complete
        Whether the run reached its stop time; false during the run.
    rows
        Number of rows of the result.
    error
        Why the run is incomplete; None where it is complete.
    warnings
        Warnings of the FMUs.
    files
        Name of each result file to its sha256.
    command
        Words of the command line; empty if the run was not started from one.
    versions
        Package, and ``python``, to the version that ran.
    platform
        Operating system and machine.
    name
        Name of the system.
    components
        Name to component, in the order in which they were added.
    connections
        In the order in which they were made.
    order, algorithm
        Order in which the components step, and how they exchange values.
    parameters
        ``component.variable`` to value, for all parameters that were given; enumerations by item name.
    stop_time, step_size
        Stop time and communication step size in s.
    record
        The recorded outputs as ``component.variable``.
    units
        Those of them that have a unit, and it: the CSV file does not keep units.
    record_every
        N, where every N-th communication point is recorded.
    formats
        Names of the formats of the result files.
    real_time
        Whether it was paced; a run again is not, the values are the same.
    isolate, time_limit
        Components that ran in processes of their own, and how long a call of them could take, in s.
    start_time
        In s.
    tolerance
        For all FMUs; None where each had that of its default experiment.
    reached
        Time of the last row, in s; None where there are no rows.
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
    units: dict[str, str] = field(default_factory=dict)
    record_every: int = 1
    formats: list[str] = field(default_factory=lambda: ["csv"])
    real_time: bool = False
    isolate: list[str] = field(default_factory=list)
    time_limit: float = TIME_LIMIT
    start_time: float = 0.0
    tolerance: float | None = None
    reached: float | None = None

    @classmethod
    def of(
        cls,
        system: Structure,
        options: RunOptions | None = None,
        command: Sequence[str] = (),
        checked: CheckedRun | None = None,
    ) -> Manifest:
        """Describe a run before it begins.

        Parameters
        ----------
        system
            The system that runs.
        options
            Options of the run.
        command
            Words of the user's command line, if any.
        checked
            The options as checked by :meth:`RunOptions.check` for the system, where that was done already.

        Returns
        -------
        Manifest
            Incomplete, without rows and files.

        Raises
        ------
        SetupError
            If the options are not valid for the system.
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
            parameters=_parameters(system, checked.values, checked.sizes),
            start_time=checked.clock.start_time,
            stop_time=checked.clock.stop_time,
            step_size=checked.clock.step_size,
            record=checked.record,
            units={name: unit for name in checked.record if (unit := system.unit(name))},
            record_every=options.record_every,
            formats=formats,
            real_time=options.real_time,
            isolate=[name for name in system.models if name in set(options.isolate)],
            time_limit=options.time_limit,
            tolerance=options.tolerance,
        )

    def ended(self, complete: bool, error: str | None, warnings: Iterable[str], sinks: Sequence[FileSink]) -> Manifest:
        """Describe the same run after its end, when its files are written.

        Parameters
        ----------
        complete
            Whether the run reached its stop time.
        error
            Why it did not; None where it did.
        warnings
            Warnings of the FMUs.
        sinks
            The sinks that wrote the result files; the first one is that of the CSV file.

        Returns
        -------
        Manifest
            A copy with the end of the run.
        """
        return replace(
            self.reaching(sinks[0]),
            complete=complete,
            error=error,
            warnings=list(warnings),
            files={sink.path.name: sha256(sink.path) for sink in sinks if sink.path.is_file()},
        )

    def reaching(self, sink: FileSink) -> Manifest:
        """Describe the same run after some of its rows.

        Parameters
        ----------
        sink
            The sink that wrote them.

        Returns
        -------
        Manifest
            A copy with their number and the time of the last one.
        """
        return replace(self, rows=sink.rows, reached=sink.reached if sink.rows else None)

    def write(self, folder: Path) -> None:
        """Write ``run.json`` to an existing folder; an earlier one is replaced atomically.

        Parameters
        ----------
        folder
            An existing folder.
        """
        unfinished = folder / f"{MANIFEST}.tmp"
        unfinished.write_text(dump(self), encoding="utf-8")
        unfinished.replace(folder / MANIFEST)

    @classmethod
    def read(cls, path: Path) -> Manifest:
        """Read a manifest from a ``run.json``.

        Parameters
        ----------
        path
            The file.

        Returns
        -------
        Manifest
            Of a complete or an incomplete run.

        Raises
        ------
        SetupError
            With all problems: no such file, invalid JSON, another version of the file format, missing or unknown keys,
            values of wrong types.
        """
        try:
            text = path.read_text(encoding="utf-8", errors="replace")
        except OSError as error:
            raise SetupError(f"{path}: expected the {MANIFEST} of a run, got: {error.strerror}") from None
        return load(cls, text, str(path))

    def system(self) -> System:
        """Rebuild the system of the run.

        Raises
        ------
        SetupError
            With all FMUs that are missing or differ from those of the run; if connections or parameters are not valid.
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
        system.start_time, system.stop_time, system.step_size = self.start_time, self.stop_time, self.step_size
        return system

    def _models(self) -> dict[str, ModelDescription]:
        """Read the FMUs' descriptions and compare the FMUs with those of the run."""
        models: dict[str, ModelDescription] = {}
        problems = Problems()
        for name, component in self.components.items():
            with problems.collected(), prefixed(name):
                models[name] = _model(component)
        problems.raise_any()
        return models


def sha256(path: Path) -> str:
    """Return the SHA-256 hash of a file as hexadecimal digits."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def _hash(model: ModelDescription) -> str:
    return hashlib.sha256(model.content()).hexdigest()


def _model(component: ComponentRecord) -> ModelDescription:
    """Read the description of a component's FMU and compare the FMU with that of the run."""
    path = Path(component.fmu)
    try:
        model = ModelDescription.read(path, component.member)
    except SetupError as error:
        if path.is_absolute() or is_file(path):
            raise
        raise SetupError(*(f"{p} in {Path.cwd()}, where its path starts" for p in error.problems)) from None
    if (found := _hash(model)) != component.sha256:
        expected = f"the FMU of the run (sha256 {component.sha256:.12}…)"
        raise SetupError(f"{model.where}: expected {expected}, got another ({found:.12}…)")
    return model


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
    system: Structure, values: Mapping[str, Mapping[str, Checked]], sizes: Mapping[str, Mapping[int, int]]
) -> dict[str, bool | int | float | str]:
    """List all parameters given by the system or the run, arrays by element, in the form of their types."""
    found = {}
    for component, given in values.items():
        model = system.models[component]
        for variable, value in given.items():
            names = model.elements(component, variable, sizes[component]).names
            for name, element in zip(names, value if isinstance(value, tuple) else [value], strict=True):
                found[f"{component}.{name}"] = _typed_value(model, variable, element)
    return dict(sorted(found.items()))


def _typed_value(model: ModelDescription, name: str, value: float | str) -> bool | int | float | str:
    """Convert a value of :meth:`ModelDescription.value` to its type: item names, Booleans, integers."""
    variable = model.variables[name]
    kind = KINDS[variable.type]
    if kind == "Enumeration":
        return next((str(i.name) for i in variable.declaredType.items if float(i.value) == value), value)
    convert = {"Boolean": bool, "Integer": int}.get(kind)
    return convert(value) if convert else value


def _versions(formats: Iterable[str]) -> dict[str, str]:
    """Return the versions of Python and of the packages that influence the result's bytes."""
    return package_versions((*_PACKAGES, *(p for name in formats if (p := FORMATS[name].package))))


def package_versions(packages: Iterable[str]) -> dict[str, str]:
    """Return the versions of Python and of packages.

    Parameters
    ----------
    packages
        Names of the packages.
    """
    return {"python": platform.python_version(), **{name: _version(name) for name in sorted(packages)}}


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"
