"""A description as a table, alike for FMI 2.0 and 3.0: what stands in the XML and the defaults for what does not.

Nothing is judged here, and nothing fails on a description that is wrong: numbers that are none are read as NaN, names
that lead nowhere stay names. fmpy's own reading gives up on such files, which are the ones of interest here.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

FLOATS = ("Real", "Float32", "Float64")
INTEGERS = ("Integer", *(f"{sign}Int{bits}" for sign in ("", "U") for bits in (8, 16, 32, 64)))
TYPES = (*FLOATS, *INTEGERS, "Enumeration", "Boolean", "String", "Binary", "Clock")

_PARAMETERS = ("parameter", "calculatedParameter", "structuralParameter")


@dataclass(frozen=True)
class Variable:
    """A variable as its element says; absent attributes are None unless they have a default.

    Attributes
    ----------
    index
        Its place in the list, from 1.
    line
        Of the file.
    start
        Its start values as text, one for each element of an array; None where there is no start.
    minimum, maximum
        Its own or its type's; None where there is none, NaN for what is no number.
    given
        The attributes as written, without defaults.
    """

    name: str
    reference: int
    type: str
    causality: str
    variability: str
    initial: str | None
    start: tuple[str, ...] | None
    minimum: float | None
    maximum: float | None
    nominal: float | None
    unit: str | None
    display_unit: str | None
    declared: str | None
    derivative: int | None
    clocks: str | None
    aliases: tuple[str, ...]
    dimensions: tuple[tuple[str, str], ...]
    index: int
    line: int
    given: dict[str, str]

    def __str__(self) -> str:
        return f"{self.name} (line {self.line})"


@dataclass(frozen=True)
class Unknown:
    """An entry of the model structure.

    Attributes
    ----------
    list
        Name of the list it stands in, or of its element.
    target
        The variable: index in FMI 2.0, value reference in FMI 3.0.
    dependencies
        Variables it depends on, as ``target``; None where nothing is said.
    kinds
        How; None where nothing is said.
    """

    list: str
    target: int
    dependencies: tuple[int, ...] | None
    kinds: tuple[str, ...] | None
    line: int


@dataclass(frozen=True)
class Type:
    """A declared type: its name, its base type, unit and the values of its items."""

    name: str
    type: str
    unit: str | None
    items: tuple[float, ...]


@dataclass(frozen=True)
class Unit:
    """A declared unit: its name, whether it is defined in base units, names of its display units."""

    name: str
    defined: bool
    display_units: tuple[str, ...]


@dataclass(frozen=True)
class Description:
    """A model description.

    Attributes
    ----------
    standard
        Major version of FMI, 2 or 3.
    attributes
        Of the root element.
    interfaces
        Name of an interface to its attributes.
    experiment
        Attributes of the default experiment.
    source_files
        In FMI 2.0.
    """

    standard: int
    attributes: dict[str, str]
    interfaces: dict[str, dict[str, str]]
    experiment: dict[str, str]
    variables: tuple[Variable, ...]
    unknowns: tuple[Unknown, ...]
    types: tuple[Type, ...]
    units: tuple[Unit, ...]
    categories: tuple[str, ...]
    source_files: tuple[str, ...]
    by_target: dict[int, Variable] = field(repr=False)

    @property
    def co_simulation(self) -> dict[str, str]:
        """Attributes of the co-simulation interface; none where there is no such interface."""
        return self.interfaces.get("CoSimulation", {})

    @property
    def identifier(self) -> str:
        """Model identifier for co-simulation."""
        return self.co_simulation.get("modelIdentifier", "")

    @property
    def token(self) -> str:
        """GUID or instantiation token."""
        return self.attributes.get("guid" if self.standard == 2 else "instantiationToken", "")

    def can(self, capability: str) -> bool:
        """Whether a capability of co-simulation is declared; by its name in FMI 3.0, where names differ in capitals."""
        found = {name.lower(): value for name, value in self.co_simulation.items()}
        return found.get(capability.lower()) in ("true", "1")

    def target(self, number: int | None) -> Variable | None:
        """Look up what an index (FMI 2.0) or a value reference (FMI 3.0) names."""
        return None if number is None else self.by_target.get(number)


def number(text: str | None) -> float | None:
    """Read a number; NaN for what is none, None for None."""
    if text is None:
        return None
    try:
        return float(text)
    except ValueError:
        return math.nan


def _integer(text: str | None) -> int | None:
    try:
        return None if text is None else int(text)
    except ValueError:
        return -1


def default_variability(standard: int, kind: str, causality: str) -> str:
    """Return the variability of a variable whose element gives none."""
    if standard == 2:
        return "continuous"
    if causality in _PARAMETERS:
        return "fixed"
    return "continuous" if kind in FLOATS else "discrete"


def default_initial(causality: str, variability: str) -> str | None:
    """Return how a variable is initialised whose element does not say."""
    if causality in ("parameter", "structuralParameter", "input"):
        return "exact"
    if causality == "independent":
        return None
    return "exact" if variability == "constant" else "calculated"


def describe(root: Any) -> Description | None:
    """Read a description.

    Parameters
    ----------
    root
        Its root element.

    Returns
    -------
    Description or None
        None for other standards than FMI 2.0 and 3.0.
    """
    version = root.get("fmiVersion", "")
    standard = 2 if version == "2.0" else 3 if version.startswith("3.") else 0
    if not standard:
        return None
    types = tuple(map(_type, _type_elements(root, standard)))
    variables = tuple(_variables(root, standard))
    interfaces = ("ModelExchange", "CoSimulation", "ScheduledExecution")
    experiment = root.find("DefaultExperiment")
    return Description(
        standard=standard,
        attributes=dict(root.attrib),
        interfaces={name: dict(found.attrib) for name in interfaces if (found := root.find(name)) is not None},
        experiment={} if experiment is None else dict(experiment.attrib),
        variables=variables,
        unknowns=tuple(_unknowns(root, standard)),
        types=types,
        units=tuple(_units(root)),
        categories=tuple(c.get("name", "") for c in root.iterfind("LogCategories/Category")),
        source_files=tuple(f.get("name", "") for f in root.iterfind("CoSimulation/SourceFiles/File")),
        by_target={(v.index if standard == 2 else v.reference): v for v in reversed(variables)},
    )


def _type_elements(root: Any, standard: int) -> Iterator[tuple[str, Any]]:
    """Go through declared types: name, and the element that has their attributes."""
    for element in root.iterfind("TypeDefinitions/*"):
        body = element if standard == 3 else next(element.iterchildren("*"), None)
        if body is not None and isinstance(body.tag, str):
            yield element.get("name", ""), body


def _type(found: tuple[str, Any]) -> Type:
    name, body = found
    items = tuple(number(item.get("value")) or 0.0 for item in body.iterfind("Item"))
    return Type(name, body.tag.removesuffix("Type"), body.get("unit"), items)


def _units(root: Any) -> Iterator[Unit]:
    for element in root.iterfind("UnitDefinitions/Unit"):
        shown = tuple(found.get("name", "") for found in element.iterfind("DisplayUnit"))
        yield Unit(element.get("name", ""), element.find("BaseUnit") is not None, shown)


def _variables(root: Any, standard: int) -> Iterator[Variable]:
    types = dict(_type_elements(root, standard))
    elements = (e for e in root.iterfind("ModelVariables/*") if isinstance(e.tag, str))
    for index, element in enumerate(elements, 1):
        body = element if standard == 3 else next((c for c in element.iterchildren() if c.tag in TYPES), element)
        yield _variable(standard, index, element, body, types.get(body.get("declaredType")))


def _variable(standard: int, index: int, element: Any, body: Any, declared: Any) -> Variable:
    """Read a variable: its element, the one of its type (in FMI 3.0 the same), its declared type's or None."""

    def own(name: str) -> str | None:
        text: str | None = body.get(name)
        if text is None and declared is not None:
            text = declared.get(name)
        return text

    causality = element.get("causality", "local")
    variability = element.get("variability") or default_variability(standard, body.tag, causality)
    return Variable(
        name=element.get("name", ""),
        reference=_integer(element.get("valueReference")) or 0,
        type=body.tag,
        causality=causality,
        variability=variability,
        initial=element.get("initial") or default_initial(causality, variability),
        start=_start(body),
        minimum=number(own("min")),
        maximum=number(own("max")),
        nominal=number(own("nominal")),
        unit=own("unit"),
        display_unit=body.get("displayUnit"),
        declared=body.get("declaredType"),
        derivative=_integer(body.get("derivative")),
        clocks=element.get("clocks"),
        aliases=tuple(alias.get("name", "") for alias in element.iterfind("Alias")),
        dimensions=tuple((d.get("start") or "", d.get("valueReference") or "") for d in body.iterfind("Dimension")),
        index=index,
        line=element.sourceline or 0,
        given={**body.attrib, **element.attrib},
    )


def _start(body: Any) -> tuple[str, ...] | None:
    """Read start values: lists stand in one attribute, except for texts and bytes in FMI 3.0."""
    elements = body.findall("Start")
    if elements:
        return tuple(element.get("value", "") for element in elements)
    text = body.get("start")
    if text is None:
        return None
    return (text,) if body.tag in ("String", "Binary") or body.find("Dimension") is None else tuple(text.split())


def _unknowns(root: Any, standard: int) -> Iterator[Unknown]:
    name = "index" if standard == 2 else "valueReference"
    path = "ModelStructure/*/Unknown" if standard == 2 else "ModelStructure/*"
    for element in root.iterfind(path):
        if not isinstance(element.tag, str):
            continue
        yield Unknown(
            list=_LISTS.get(element.getparent().tag if standard == 2 else element.tag, ""),
            target=_integer(element.get(name)) or 0,
            dependencies=_numbers(element.get("dependencies")),
            kinds=None if element.get("dependenciesKind") is None else tuple(element.get("dependenciesKind").split()),
            line=element.sourceline or 0,
        )


def _numbers(text: str | None) -> tuple[int, ...] | None:
    return None if text is None else tuple(_integer(word) or 0 for word in text.split())


_LISTS = {
    "Outputs": "Output",
    "Output": "Output",
    "Derivatives": "Derivative",
    "ContinuousStateDerivative": "Derivative",
    "InitialUnknowns": "InitialUnknown",
    "InitialUnknown": "InitialUnknown",
    "ClockedState": "ClockedState",
    "EventIndicator": "EventIndicator",
}
"""Name of a list in FMI 2.0 or element in FMI 3.0 to what its entries are."""
