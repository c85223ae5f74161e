"""What a sweep is to do: base system, what is fixed, what is varied, what is measured; read strictly from TOML."""

from __future__ import annotations

import hashlib
import json
import math
import tomllib
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from cosim.engine.structure import ALGORITHMS, Algorithm
from cosim.errors import Problems, SetupError, did_you_mean
from cosim.fmi.values import Scalar
from cosim.sweep.design import DESIGNS, SCALES, Block, Design, Range, Scale, Values, Variable
from cosim.sweep.table_reader import TableReader, list_of, number, one_of, scalar, table, table_of, text, truth, whole
from cosim.sweep.vocabulary import Vocabulary

OPTIONS = ("stop_time", "step_size", "algorithm")
"""Options of the master that a study may fix or vary."""

REPLACE = "replace."
"""Beginning of the name of a variable that says which FMU is in a component's place."""


@dataclass(frozen=True)
class Study:
    """A study: one system, and its runs.

    Attributes
    ----------
    name
        Name of the study, and of its folder.
    system
        The base system: a file, or a name that the vocabulary knows.
    question
        What the study is to answer.
    replace
        Component to the FMU that takes its place.
    connect
        Connections of replaced components, each as ``output=input``.
    stop_time, step_size
        In s; where None, what the vocabulary suggests, or the system's.
    algorithm
        How components exchange values; the system's where None.
    warm_up
        Time at the beginning of a run that is not evaluated, in s.
    words
        Choices of the vocabulary to their values.
    parameters
        ``component.variable`` to value, in all runs.
    vary
        Blocks of variables; runs are their product. Empty for one run.
    metrics
        Names of the vocabulary's metrics, or functions such as ``rms(seat.force)``; the vocabulary's where empty.
    series
        Outputs of which the dataset has the samples.
    series_every
        N: it has every N-th communication point of them.
    figure
        Figure that shows the answer, by the vocabulary's name; None for none.
    vocabulary
        What choices and metrics mean.
    folder
        Folder in which relative paths start.
    source
        The text of the file, for the dataset; empty for a study of a script.
    """

    name: str
    system: str
    question: str = ""
    replace: Mapping[str, str] = field(default_factory=dict)
    connect: tuple[str, ...] = ()
    stop_time: float | None = None
    step_size: float | None = None
    algorithm: Algorithm | None = None
    warm_up: float = 0.0
    words: Mapping[str, Scalar] = field(default_factory=dict)
    parameters: Mapping[str, Scalar] = field(default_factory=dict)
    vary: tuple[Block, ...] = ()
    metrics: tuple[str, ...] = ()
    series: tuple[str, ...] = ()
    series_every: int = 1
    figure: str | None = None
    vocabulary: Vocabulary = field(default_factory=Vocabulary, compare=False)
    folder: Path = field(default=Path(), compare=False)
    source: str = field(default="", compare=False, repr=False)

    def __post_init__(self) -> None:
        """Check what can be checked without the system."""
        for name in ("connect", "vary", "metrics", "series"):
            object.__setattr__(self, name, tuple(getattr(self, name)))
        problems = Problems()
        if not self.name or Path(self.name).name != self.name or self.name in (".", ".."):
            problems.found.append(f"name: expected a name of a folder, got {self.name or 'none'}")
        for name in ("stop_time", "step_size"):
            value = getattr(self, name)
            if value is not None and not (math.isfinite(value) and value > 0.0):
                problems.found.append(f"{name}: expected a finite time above 0 s, got {value:g} s")
        if not (math.isfinite(self.warm_up) and self.warm_up >= 0.0):
            problems.found.append(f"warm_up: expected a finite time from 0 s, got {self.warm_up:g} s")
        if self.series_every < 1:
            problems.found.append(f"series, every: expected a whole number from 1, got {self.series_every}")
        known = self.vocabulary.words
        problems.found += [
            f"{word}: expected a choice among {', '.join(known) or 'none'}, got {word}{did_you_mean(word, known)}"
            for word in self.words
            if word not in known
        ]
        if self.figure is not None and self.figure not in self.vocabulary.figures:
            figures = self.vocabulary.figures
            problems.found.append(
                f"figure: expected one of {', '.join(figures) or 'none'}, got {self.figure}"
                f"{did_you_mean(self.figure, figures)}"
            )
        with problems.collected():
            Design(self.vary)
        problems.raise_any()

    @property
    def design(self) -> Design:
        """The product of all blocks."""
        return Design(self.vary)

    def as_json(self) -> str:
        """Return all that the study says, in one form: studies that mean the same give the same text."""
        blocks = [asdict(block) for block in self.vary]
        names = ("name", "system", "question", "connect", "stop_time", "step_size", "algorithm", "warm_up")
        rest = ("metrics", "series", "series_every", "figure")
        data = {name: getattr(self, name) for name in (*names, *rest)}
        data |= {name: dict(getattr(self, name)) for name in ("replace", "words", "parameters")}
        return json.dumps({**data, "vary": blocks}, indent=1, ensure_ascii=False)

    def hash(self, *more: str) -> str:
        """Return the SHA-256 hash of what the study says.

        Parameters
        ----------
        *more
            Texts that the results depend on, too.
        """
        return hashlib.sha256("\0".join((self.as_json(), *more)).encode()).hexdigest()

    @classmethod
    def read(cls, path: str | Path, vocabulary: Vocabulary | None = None) -> Study:
        """Read a study from a TOML file.

        Parameters
        ----------
        path
            The file; relative paths in it start in its folder.
        vocabulary
            What choices and metrics mean.

        Returns
        -------
        Study
            The study.

        Raises
        ------
        SetupError
            With all problems found.
        """
        path = Path(path)
        try:
            source = path.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            got = error.strerror if isinstance(error, OSError) else "no text in UTF-8"
            raise SetupError(f"{path}: expected a study in TOML, got: {got}") from None
        return cls.parse(source, str(path), path.parent, vocabulary)

    @classmethod
    def parse(
        cls, source: str, where: str = "study", folder: Path = Path(), vocabulary: Vocabulary | None = None
    ) -> Study:
        """Read a study from a text in TOML.

        Parameters
        ----------
        source
            The text.
        where
            Name of the study in messages.
        folder
            Folder in which relative paths start.
        vocabulary
            What choices and metrics mean.

        Returns
        -------
        Study
            The study.

        Raises
        ------
        SetupError
            With all problems found.
        """
        vocabulary = vocabulary or Vocabulary()
        try:
            data = tomllib.loads(source)
        except (tomllib.TOMLDecodeError, RecursionError) as error:
            raise SetupError(f"{where}: expected TOML, got: {error}") from None
        problems = Problems()
        given = _read_study(TableReader(data, where, problems), data, vocabulary, problems, where)
        problems.raise_any()
        with problems.collected(lambda problem: f"{where}: {problem}"):
            return cls(**given, vocabulary=vocabulary, folder=folder, source=source)
        problems.raise_any()
        raise AssertionError  # for the type checker: one of the two lines above ends the function


def _read_study(
    reader: TableReader, data: Mapping[str, Any], vocabulary: Vocabulary, problems: Problems, where: str
) -> dict[str, Any]:
    """Read the keys of a study; returns fields of :class:`Study`."""
    given: dict[str, Any] = {
        "name": reader.take("name", text, "", required=True),
        "system": reader.take("system", text, "", required=True),
        "question": reader.take("question", text, ""),
        "replace": reader.take("replace", table_of(text), {}),
        "connect": reader.take("connect", list_of(text), ()),
        "stop_time": reader.take("stop_time", number, None),
        "step_size": reader.take("step_size", number, None),
        "algorithm": reader.take("algorithm", one_of(*ALGORITHMS), None),
        "warm_up": reader.take("warm_up", number, 0.0),
        "parameters": reader.take("parameters", table_of(scalar), {}),
        "metrics": reader.take("metrics", list_of(text), ()),
        "figure": reader.take("figure", text, None),
    }
    found = {word: reader.take(word, scalar, None) for word in vocabulary.words}
    given["words"] = {word: value for word, value in found.items() if value is not None}
    if "series" in reader:
        series = TableReader(reader.take("series", table, {}), f"{where}: series", problems)
        given["series"] = series.take("signals", list_of(text), (), required=True)
        given["series_every"] = series.take("every", whole, 1)
        series.close()
    blocks = reader.take("vary", list_of(table), ())
    reader.close()
    read = [_read_block(each, f"{where}: vary, block {i}", problems) for i, each in enumerate(blocks, 1)]
    given["vary"] = tuple(block for block in read if block is not None)
    return given


def _read_block(data: Mapping[str, Any], where: str, problems: Problems) -> Block | None:
    reader = TableReader(data, where, problems)
    before = len(problems.found)
    design = reader.take("design", one_of(*DESIGNS), "grid")
    n, seed = reader.take("n", whole, None), reader.take("seed", whole, 1)
    samples = reader.take("samples", list_of(table_of(scalar)), ())
    if design == "samples" and not samples and len(problems.found) == before:
        reader.add("expected samples, a list of tables, for design samples, got none")
    if samples and design != "samples":
        reader.add(f"samples: expected with design samples, got design {design}")
    known = {name: Values(tuple(dict.fromkeys(s[name] for s in samples if name in s))) for s in samples for name in s}
    texts: dict[str, Any] = reader.take("variables", table, {}, required=not samples and design != "samples")
    reader.close()
    variables = {name: Variable(domain) for name, domain in known.items()}
    for name, spec in texts.items():
        with problems.collected(lambda problem, at=f"{where}: {name}": f"{at}: {problem}"):  # type: ignore[misc]
            variables[name] = _read_variable(spec, f"{where}: {name}", problems, known.get(name))
    if len(problems.found) > before:
        return None
    with reader.checking():
        return Block(variables, design, n, seed, samples)
    return None


_FORMS = ("values", "linspace", "logspace", "low")
"""Keys of which a variable's table has one: they say which values it takes."""


def _read_variable(spec: Any, where: str, problems: Problems, known: Values | None) -> Variable:
    """Read a variable: a list of values, or a table with its values and what it acts on."""
    if isinstance(spec, list):
        spec = {"values": spec}
    if not isinstance(spec, dict):
        raise SetupError(f"expected a list of values or a table, got {spec!r}")
    reader = TableReader(spec, where, problems)
    before = len(problems.found)
    values = reader.take("values", list_of(scalar), None)
    spaced = {form: reader.take(form, list_of(number, 3), None) for form in ("linspace", "logspace")}
    low, high = reader.take("low", number, None), reader.take("high", number, None)
    scale: Scale = reader.take("scale", one_of(*SCALES), "linear")
    integer = reader.take("integer", truth, False)
    acting = {key: reader.take(key, list_of(text), ()) for key in ("sets", "scales", "adds")}
    unit = reader.take("unit", text, None)
    reader.close()
    forms = [form for form in _FORMS if form in reader]
    if len(forms) != (known is None):
        expected = f"one of the keys {', '.join(_FORMS)}" if known is None else "no values beside those of samples"
        reader.add(f"expected {expected}, got {', '.join(forms) or 'none'}")
    if (low is None) != (high is None):
        reader.add(f"expected both low and high, got {'high' if low is None else 'low'} alone")
    if low is None and ("scale" in reader or "integer" in reader):
        reader.add("expected scale and integer with low and high, got other values")
    if len(problems.found) > before:
        return Variable(Values((0.0,)))
    if known is not None:
        return Variable(known, **acting, unit=unit)
    if low is not None and high is not None:
        return Variable(Range(low, high, scale, integer), **acting, unit=unit)
    return Variable(Values(values if values is not None else _spaced(spaced)), **acting, unit=unit)


def _spaced(spaced: Mapping[str, tuple[float, float, float] | None]) -> tuple[float, ...]:
    """Return values at even distances, or at even ratios."""
    form, (low, high, count) = next((form, given) for form, given in spaced.items() if given is not None)
    if not (count.is_integer() and count >= 2):
        raise SetupError(f"{form}: expected [first, last, how many], 2 or more, got {count:g}")
    if form == "logspace" and not (low > 0.0 and high > 0.0):
        raise SetupError(f"logspace: expected first and last above 0, got {low:g} and {high:g}")
    space = np.linspace if form == "linspace" else np.geomspace
    return tuple(space(low, high, int(count)).tolist())
