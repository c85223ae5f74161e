"""A study that was checked against its system: its cases, and how a worker runs a batch of them."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field, replace
from itertools import product
from pathlib import Path
from time import perf_counter
from typing import Any, Literal, NamedTuple

from cosim.engine.editing import edit
from cosim.engine.run_options import RunOptions
from cosim.errors import CosimError, Problems, SetupError, did_you_mean, listed
from cosim.fmi.description import ModelDescription
from cosim.fmi.values import Scalar, Value
from cosim.fmi.variable_types import KINDS
from cosim.manifest import package_versions, sha256
from cosim.results.result import Result
from cosim.sweep.design import Point, Range, Values, Variable
from cosim.sweep.loaded import LoadedSystem
from cosim.sweep.study import OPTIONS, REPLACE, Study
from cosim.sweep.vocabulary import SignalMetric, Vocabulary
from cosim.system import System

ColumnKind = Literal["integer", "number", "truth", "text", "series"]

RUN, ERROR, WARNINGS = "run", "error", "warnings"
"""Columns of every dataset: index of the run from 0; why it failed; warnings of the FMUs, a line each."""

TIME = "time"
"""Column with the times of the series, in s."""

_MAX_SYSTEMS = 1000

_PACKAGES = ("seat-cosim", "fmpy", "numpy", "scipy")
"""Packages that influence runs and metrics."""


@dataclass(frozen=True)
class Column:
    """A column of the dataset.

    Attributes
    ----------
    name
        Its name.
    kind
        What its values are; None stands for a missing one of any kind.
    unit
        Their unit; None where there is none.
    """

    name: str
    kind: ColumnKind
    unit: str | None = None


class Batch(NamedTuple):
    """Runs that a worker does in one go.

    Attributes
    ----------
    start
        Index of the first run; the others follow.
    points
        Values of the variables in each run.
    """

    start: int
    points: Sequence[Point]


class Rows(NamedTuple):
    """Results of a batch.

    Attributes
    ----------
    start
        Index of the first run.
    columns
        Name of each column to its values, one for each run.
    seconds
        Time that the batch took, of which ``metrics`` went to metrics and series.
    metrics
        In s.
    """

    start: int
    columns: dict[str, list[Any]]
    seconds: float
    metrics: float = 0.0

    @property
    def runs(self) -> int:
        """Number of runs of the batch."""
        return len(self.columns[RUN])

    @property
    def failed(self) -> int:
        """Number of runs that failed."""
        return sum(error is not None for error in self.columns[ERROR])


class Case(NamedTuple):
    """One run of a study.

    Attributes
    ----------
    system
        The system, with its own parameters.
    options
        Options of the run.
    """

    system: System
    options: RunOptions


@dataclass
class Plan:
    """A study that was checked; it travels to the workers and runs batches there.

    Attributes
    ----------
    name
        Of the study.
    fingerprint
        SHA-256 of all that the results depend on.
    systems
        FMUs in the places of components to the system that they make.
    columns
        Of the dataset.
    files
        Text of a parameter to the file that it names.
    versions
        Packages that the results depend on, and their versions.
    """

    name: str
    fingerprint: str
    versions: dict[str, str]
    systems: dict[tuple[tuple[str, str], ...], System]
    columns: tuple[Column, ...]
    files: dict[str, str]
    _study: Study = field(repr=False)
    _variables: dict[str, Variable] = field(repr=False)
    _metrics: tuple[str, ...] = field(repr=False)
    _functions: dict[str, SignalMetric] = field(repr=False)
    _record: dict[int, list[str]] = field(default_factory=dict, repr=False)

    @property
    def metrics(self) -> tuple[str, ...]:
        """Names of all metrics."""
        return (*self._metrics, *self._functions)

    @property
    def _vocabulary(self) -> Vocabulary:
        return self._study.vocabulary

    # ---- where the FMUs and files lie --------------------------------------------------------------------------------

    def assets(self) -> dict[str, tuple[str, bytes]]:
        """Return the content of all FMUs and files.

        Returns
        -------
        dict
            SHA-256 of each to its suffix and its bytes.
        """
        contents = [(".fmu", model.content()) for model in self._models()]
        contents += [(Path(path).suffix, Path(path).read_bytes()) for path in self.files.values()]
        return {hashlib.sha256(content).hexdigest(): (suffix, content) for suffix, content in contents}

    def hashed(self) -> Plan:
        """Return the plan with hashes in the place of paths, for workers that do not see the same disk."""
        return self._moved(lambda model: Path(hashlib.sha256(model.content()).hexdigest()), sha256_of_path)

    def located(self, folder: Path) -> Plan:
        """Return the plan of :meth:`hashed` with the paths of files of a folder.

        Parameters
        ----------
        folder
            Folder of the assets; the name of each is its hash with its suffix.
        """
        return self._moved(lambda m: folder / f"{m.path}.fmu", lambda name: str(folder / name))

    def _moved(self, fmu: Any, file: Any) -> Plan:
        systems = {}
        for key, system in self.systems.items():
            systems[key] = moved = copy(system)
            moved.models = {n: replace(m, path=fmu(m), member=None) for n, m in system.models.items()}
        return replace(self, systems=systems, files={name: file(path) for name, path in self.files.items()})

    def _models(self) -> Iterator[ModelDescription]:
        found = {model.where: model for system in self.systems.values() for model in system.models.values()}
        yield from found.values()

    def fmus(self) -> Iterator[tuple[str, ModelDescription, str]]:
        """Yield each FMU: name of a component that it is, its description, its SHA-256."""
        known: dict[Path, str] = {}
        for system in self.systems.values():
            for name, model in system.models.items():
                if model.where not in known:
                    known[model.where] = hashlib.sha256(model.content()).hexdigest()
                    yield name, model, known[model.where]

    # ---- cases -------------------------------------------------------------------------------------------------------

    def case(self, point: Point) -> Case:
        """Return the run at a point of the design.

        Parameters
        ----------
        point
            Variable to value.

        Raises
        ------
        SetupError
            If the values do not fit the system.
        """
        study = self._study
        options: dict[str, Any] = {name: getattr(study, name) for name in OPTIONS}
        words, given, fmus = dict(study.words), dict(study.parameters), dict(study.replace)
        for name, value in point.items():
            if self._variables[name].targets:
                given |= dict.fromkeys(self._variables[name].sets, value)
            elif name in self._vocabulary.words:
                words[name] = value
            elif name in OPTIONS:
                options[name] = value
            elif name.startswith(REPLACE):
                fmus[name.removeprefix(REPLACE)] = str(value)
            else:
                given[name] = value
        system = self.systems[tuple(sorted(fmus.items()))]
        given = {
            name: self.files.get(value, value) if isinstance(value, str) else value for name, value in given.items()
        }
        parameters = self._vocabulary.parameters(words, given, system)
        for name, value in point.items():
            for target in self._variables[name].scales:
                parameters[target] = _number(target, parameters, system) * _factor(name, value)
            for target in self._variables[name].adds:
                parameters[target] = _number(target, parameters, system) + _factor(name, value)
        if options["stop_time"] is None:
            options["stop_time"] = self._vocabulary.default_stop_time(words)
        return Case(system, RunOptions(**options, parameters=parameters, record=self._recorded(system)))

    def _recorded(self, system: System) -> list[str]:
        """Return the outputs that metrics and series of a system need."""
        if id(system) not in self._record:
            needed = self._vocabulary.signals(self._metrics, system) if self._metrics else []
            needed += [each.signal for each in self._functions.values()]
            self._record[id(system)] = list(dict.fromkeys((*needed, *self._study.series)))
        return self._record[id(system)]

    def __getstate__(self) -> dict[str, Any]:
        """Return what travels: not the lists of this process's objects, nor the design, whose points travel."""
        return {**vars(self), "_record": {}, "_study": replace(self._study, vary=(), source="")}

    # ---- in the worker -----------------------------------------------------------------------------------------------

    def __call__(self, loaded: LoadedSystem, batch: Batch) -> Rows:
        """Run a batch.

        Parameters
        ----------
        loaded
            The worker's loaded system.
        batch
            What to run.
        """
        begin, metrics = perf_counter(), 0.0
        found: list[dict[str, Any]] = [{} for _ in batch.points]
        cases = [self._case_or_error(point) for point in batch.points]
        places = {id(system): place for place, system in enumerate(self.systems.values())}
        by_system = sorted(range(len(cases)), key=lambda i: _place(cases[i], places))
        for i in by_system:
            found[i], spent = self._run(loaded, cases[i])
            metrics += spent
        columns: dict[str, list[Any]] = {RUN: list(range(batch.start, batch.start + len(found)))}
        for name in self._variables:
            columns[name] = [point[name] for point in batch.points]
        for column in self.columns:
            if column.name not in columns:
                columns[column.name] = [row.get(column.name) for row in found]
        return Rows(batch.start, columns, perf_counter() - begin, metrics)

    def failed(self, batch: Batch, error: str) -> Rows:
        """Return the rows of a batch that could not be run.

        Parameters
        ----------
        batch
            The batch.
        error
            Why.
        """
        columns: dict[str, list[Any]] = {column.name: [None] * len(batch.points) for column in self.columns}
        columns[RUN] = list(range(batch.start, batch.start + len(batch.points)))
        columns |= {name: [point[name] for point in batch.points] for name in self._variables}
        columns[ERROR] = [error] * len(batch.points)
        return Rows(batch.start, columns, 0.0)

    def _case_or_error(self, point: Point) -> Case | str:
        try:
            return self.case(point)
        except CosimError as error:
            return str(error)

    def _run(self, loaded: LoadedSystem, case: Case | str) -> tuple[dict[str, Any], float]:
        """Run a case; returns its row, and the time in s that its metrics took."""
        if isinstance(case, str):
            return {ERROR: case}, 0.0
        row: dict[str, Any] = {}
        begin = None
        try:
            result = loaded.session(case.system).run(**_fields(case.options))
            row[WARNINGS] = "\n".join(result.warnings) or None
            if result.error is not None:
                raise result.error
            begin = perf_counter()
            row |= self._measure(case, result)
        except Exception as error:  # whatever it is, it is the result of this run, and no other's
            row[ERROR] = str(error) if isinstance(error, CosimError) else f"{type(error).__name__}: {error}"
            if begin is None and not isinstance(error, SetupError):
                loaded.free()  # what an FMU does after an error is not known
        return row, 0.0 if begin is None else perf_counter() - begin

    def _measure(self, case: Case, result: Result) -> dict[str, Any]:
        """Compute metrics and thin out series of a run that has reached its stop time."""
        study, options = self._study, case.options
        rate = 1.0 / case.system.clock(options.stop_time, options.step_size).step_size
        found: dict[str, Any] = {}
        if self._metrics:
            ridden = copy(case.system)
            ridden.parameters = {**case.system.parameters, **options.values}
            found |= self._vocabulary.measure(self._metrics, ridden, result, rate, study.warm_up)
        found |= {name: each.of(result, rate, study.warm_up) for name, each in self._functions.items()}
        every = study.series_every
        if study.series:
            found[TIME] = result.time[::every].copy()
        return found | {name: result[name][::every].copy() for name in study.series}


def sha256_of_path(path: str) -> str:
    """Return the hash of a file, with its suffix.

    Parameters
    ----------
    path
        The file.
    """
    return f"{sha256(Path(path))}{Path(path).suffix}"


def _place(case: Case | str, places: Mapping[int, int]) -> int:
    return -1 if isinstance(case, str) else places[id(case.system)]


def _fields(options: RunOptions) -> dict[str, Any]:
    names = ("stop_time", "step_size", "algorithm", "parameters", "record")
    return {name: getattr(options, name) for name in names}


def _number(name: str, parameters: Mapping[str, Value], system: System) -> float:
    """Return the number that a parameter has in a run."""
    value = parameters.get(name, system.parameters.get(name))
    return system.start(name) if value is None else _factor(name, value)


def _factor(name: str, value: Value) -> float:
    try:
        return float(value)  # type: ignore[arg-type]  # what is no number is caught
    except (TypeError, ValueError):
        raise SetupError(f"{name}: expected a number, which is scaled or added to, got {value}") from None


# ---- from a study to its plan ----------------------------------------------------------------------------------------


def make_plan(study: Study) -> Plan:
    """Check a study against its system.

    Parameters
    ----------
    study
        The study.

    Returns
    -------
    Plan
        The plan; nothing is loaded.

    Raises
    ------
    SetupError
        With all problems found: an unknown name, a value out of range, a metric that the system does not have.
    """
    systems = _systems(study)
    _check_names(study, next(iter(systems.values())))
    for system in systems.values():
        _load_words(study, system)
    first = next(iter(systems.values()))
    metrics, functions = _split_metrics(study, first)
    files = _files(study, first)
    versions = package_versions(_PACKAGES)
    plan = Plan(study.name, "", versions, systems, (), files, study, study.design.variables, metrics, functions)
    _check_corners(plan, study)
    plan.columns = tuple(_columns(plan, study, first))
    _check_columns(plan)
    models = [digest for _, _, digest in plan.fmus()]
    contents = [study.vocabulary.content(), *(sha256(Path(path)) for path in files.values())]
    plan.fingerprint = study.hash(*models, *contents, *(f"{k} {v}" for k, v in sorted(versions.items())))
    return plan


def _systems(study: Study) -> dict[tuple[tuple[str, str], ...], System]:
    """Make the system of each combination of FMUs."""
    choices: dict[str, tuple[str, ...]] = {REPLACE + component: (fmu,) for component, fmu in study.replace.items()}
    for name, variable in study.design.variables.items():
        if name.startswith(REPLACE) and not variable.targets:
            if not isinstance(variable.domain, Values):
                raise SetupError(f"{name}: expected a list of FMUs, got a range")
            choices[name] = tuple(str(value) for value in variable.domain.values)
    combinations = list(product(*choices.values()))
    if len(combinations) > _MAX_SYSTEMS:
        raise SetupError(f"{REPLACE}*: expected at most {_MAX_SYSTEMS} combinations of FMUs, got {len(combinations)}")
    found = {}
    for combination in combinations:
        fmus = {name.removeprefix(REPLACE): fmu for name, fmu in zip(choices, combination, strict=True)}
        system = System.load(study.vocabulary.system_file(study.system, study.folder))
        new = {name: study.vocabulary.fmu(fmu, study.folder) for name, fmu in fmus.items() if fmu}
        if new or study.connect:
            edit(system, new, (), study.connect if new or not study.replace else ())
        found[tuple(sorted(fmus.items()))] = system
    return found


def _check_names(study: Study, system: System) -> None:
    """Check the names of variables that act by their name."""
    problems = Problems()
    known = (*study.vocabulary.words, *OPTIONS, *(REPLACE + name for name in system.models))
    for name, variable in study.design.variables.items():
        for target in variable.targets or (name,):
            if target in known and not variable.targets:
                continue
            if target.partition(".")[0] not in system.models:
                problems.found.append(
                    f"{name}: expected a parameter as component.variable, with a component among "
                    f"{', '.join(system.models)}, or one of {', '.join(known)}, got {target}"
                    f"{did_you_mean(target, known)}"
                )
                continue
            with problems.collected(lambda problem, at=name: f"vary {at}: {problem}"):  # type: ignore[misc]
                system.variable(system.parse(target))
    problems.raise_any()


def _load_words(study: Study, system: System) -> None:
    """Let the vocabulary read what the choices of all runs need."""
    problems = Problems()
    choices = [(word, value) for word, value in study.words.items()]
    for name, variable in study.design.variables.items():
        if name in study.vocabulary.words and not variable.targets:
            choices += [(name, value) for value in variable.domain.extremes]
    for word, value in choices:
        with problems.collected():
            study.vocabulary.load(word, value, system, study.folder)
    problems.raise_any()


def _split_metrics(study: Study, system: System) -> tuple[tuple[str, ...], dict[str, SignalMetric]]:
    """Split the metrics of a study into the vocabulary's and functions of signals."""
    problems = Problems()
    functions: dict[str, SignalMetric] = {}
    names: list[str] = []
    known = study.vocabulary.metrics
    for name in study.metrics or study.vocabulary.default_metrics(system):
        with problems.collected():
            if (function := SignalMetric.parse(name)) is not None:
                functions[name] = function
            elif name in known:
                names.append(name)
            else:
                expected = f"one of {', '.join(known)}, or a function" if known else "a function"
                raise SetupError(
                    f"metric {name}: expected {expected} such as rms(A.x), got {name}{did_you_mean(name, known)}"
                )
    problems.raise_any()
    if not (names or functions or study.series):
        raise SetupError(f"metrics: expected at least one, or a series, got none that {system.name} has by itself")
    return tuple(names), functions


def _files(study: Study, system: System) -> dict[str, str]:
    """Find the files that parameters name: text to absolute path."""
    texts: list[tuple[str, Scalar]] = list(study.parameters.items())
    for name, variable in study.design.variables.items():
        if isinstance(variable.domain, Values):
            targets = variable.sets or (() if variable.targets else (name,))
            texts += [(target, value) for target in targets for value in variable.domain.values]
    found = {}
    for name, value in texts:
        if not isinstance(value, str) or not system.has(name):
            continue
        path = study.folder / Path(value).expanduser()
        if KINDS[system.variable(system.parse(name)).type] == "String" and path.is_file():
            found[value] = str(path.resolve())
    return found


def _check_corners(plan: Plan, study: Study) -> None:
    """Check each value of each variable, and both ends of ranges, with the others as in the first run."""
    found: dict[str, tuple[str, ...]] = {}
    for name, point in [*study.design.corners()] or [("", study.design.point(0))]:
        try:
            case = plan.case(point)
            case.options.check(case.system)
            found[name] = ()
        except SetupError as error:
            found[name] = error.problems
    everywhere = set.intersection(*map(set, found.values()))
    places: dict[str, list[str]] = {}
    for name, each in found.items():
        for problem in each:
            places.setdefault(problem, []).append(name)
    if places:
        raise SetupError(*(p if p in everywhere else f"vary {listed(names, 3)}: {p}" for p, names in places.items()))


def _columns(plan: Plan, study: Study, system: System) -> Iterator[Column]:
    """Yield the columns of the dataset."""
    yield Column(RUN, "integer")
    for name, variable in study.design.variables.items():
        yield Column(name, _kind(variable), _unit(study, name, variable, system))
    for name in plan._metrics:
        unit = study.vocabulary.metrics[name]
        yield Column(name, "number", unit if unit != "1" else None)
    for name, function in plan._functions.items():
        yield Column(name, "number", system.unit(function.signal))
    if study.series:
        yield Column(TIME, "series", "s")
    for name in study.series:
        yield Column(name, "series", system.unit(name))
    yield Column(ERROR, "text")
    yield Column(WARNINGS, "text")


def _check_columns(plan: Plan) -> None:
    """Check that the columns have different names."""
    names = [column.name for column in plan.columns]
    if twice := sorted({name for name in names if names.count(name) > 1}):
        raise SetupError(
            *(
                f"{name}: expected one column of this name, got two; name the variable otherwise, and what it sets"
                for name in twice
            )
        )


def _kind(variable: Variable) -> ColumnKind:
    """Return what the values of a variable are; mixed ones are texts."""
    if isinstance(variable.domain, Range):
        return "integer" if variable.domain.integer else "number"
    kinds = {type(value) for value in variable.domain.values}
    if kinds == {bool}:
        return "truth"
    if kinds == {int}:
        return "integer"
    return "number" if kinds <= {int, float} else "text"


def _unit(study: Study, name: str, variable: Variable, system: System) -> str | None:
    """Return the unit of a variable."""
    if variable.unit is not None:
        return variable.unit
    if name in study.vocabulary.words:
        return study.vocabulary.words[name] or None
    if name in ("stop_time", "step_size") and not variable.targets:
        return "s"
    targets = (*variable.sets, *variable.adds) or (() if variable.scales else (name,))
    return system.unit(targets[0]) if targets and system.has(targets[0]) else None
