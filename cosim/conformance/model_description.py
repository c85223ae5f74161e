"""Read a model description of FMI 2.0 or 3.0 leniently: the attributes as written, and the standard's defaults.

Nothing is judged here, and an invalid description raises no exception: a text that is not a number is read as NaN, a
reference to a missing variable stays a reference. The rules judge what was read.

The master reads the same file by :mod:`cosim.fmi.description`, which wraps fmpy's reader. Both share the XML parser
(:func:`cosim.fmi.xml.safe_parser`), the name of the file, and the tables of types (:mod:`cosim.fmi.variable_types`).
The rest is separate on purpose:

- fmpy's reader raises an exception at the first invalid number, missing variable, undeclared type or illegal
  combination of causality and variability. The suite must go on, because it has to report all problems of such files at
  once.
- fmpy's reader fills in defaults and drops attributes that it does not know. The rules need to know which attributes
  are written, and where.
- The master repairs descriptions whose meaning is clear (:mod:`cosim.fmi.repairs`). The suite must see the file as it
  is.
- The rule ``fmpy_check.fmpy`` is an independent check of the suite. The defaults of variability and initial and the
  inheritance of bounds from declared types must therefore not come from fmpy.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, fields
from operator import attrgetter
from sys import intern
from typing import Any

from cosim.fmi.variable_types import FLOATS, KINDS

_PARAMETERS = ("parameter", "calculatedParameter", "structuralParameter")


@dataclass(frozen=True)
class RawAlias:
    """A further name of a variable (FMI 3.0).

    Attributes
    ----------
    name
        The name.
    display_unit
        Its display unit; None where it has none of its own.
    """

    name: str
    display_unit: str | None


@dataclass(frozen=True, slots=True)
class RawVariable:
    """A variable as its element declares it; absent attributes are None unless the standard defines a default.

    Attributes
    ----------
    name, causality, variability, initial, unit, display_unit
        The attributes of these names, with the standard's defaults.
    reference
        Value reference; -1 if it is not an integer.
    type
        Name of the type's element: ``Real``, ``Float64``, ...
    start
        Start values as text, one for each element of an array; None where there is no start value.
    minimum, maximum, nominal
        The variable's or its declared type's; None where neither has one, NaN for a text that is not a number.
    declared_type
        Name of the declared type.
    derivative
        The variable that this one is the derivative of: index in FMI 2.0, value reference in FMI 3.0.
    clocks
        Value references of the clocks of a clocked variable (FMI 3.0).
    aliases
        The aliases (FMI 3.0).
    dimensions
        ``start`` and ``valueReference`` of each dimension as text, empty where absent (FMI 3.0).
    index
        Position in the list of variables, from 1.
    line
        Line in the file, from 1.
    attributes
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
    declared_type: str | None
    derivative: int | None
    clocks: tuple[int, ...] | None
    aliases: tuple[RawAlias, ...]
    dimensions: tuple[tuple[str, str], ...]
    index: int
    line: int
    attributes: dict[str, str]

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle all fields at once: faster than by name, and there may be 100,000 variables."""
        return RawVariable, _FIELDS(self)

    @property
    def names(self) -> tuple[str, ...]:
        """Its name and those of its aliases."""
        return (self.name, *(alias.name for alias in self.aliases))

    def __str__(self) -> str:
        return f"{self.name} (line {self.line})"


_FIELDS = attrgetter(*(each.name for each in fields(RawVariable)))


@dataclass(frozen=True)
class Unknown:
    """An entry of the model structure.

    Attributes
    ----------
    list
        Kind of the entry: ``Output``, ``Derivative``, ``InitialUnknown``, ``ClockedState`` or ``EventIndicator``.
    reference
        The variable: index in FMI 2.0, value reference in FMI 3.0.
    dependencies
        References of the variables that it depends on; None where they are not declared.
    kinds
        Kinds of the dependencies; None where they are not declared.
    line
        Line in the file, from 1.
    """

    list: str
    reference: int
    dependencies: tuple[int, ...] | None
    kinds: tuple[str, ...] | None
    line: int


@dataclass(frozen=True)
class DeclaredType:
    """A type of ``TypeDefinitions``.

    Attributes
    ----------
    name
        Its name.
    type
        Its base type: ``Real``, ``Float64``, ...
    unit
        Name of its unit.
    items
        Values of the items of an enumeration.
    attributes
        The attributes as written, without defaults.
    """

    name: str
    type: str
    unit: str | None
    items: tuple[float, ...]
    attributes: dict[str, str]


@dataclass(frozen=True)
class DeclaredUnit:
    """A unit of ``UnitDefinitions``.

    Attributes
    ----------
    name
        Its name.
    has_base_unit
        Whether it is defined in base units.
    display_units
        Names of its display units.
    """

    name: str
    has_base_unit: bool
    display_units: tuple[str, ...]


@dataclass(frozen=True)
class RawDescription:
    """A model description as it is written.

    Attributes
    ----------
    fmi_major
        Major version of FMI, 2 or 3.
    attributes
        Attributes of the root element.
    interfaces
        Name of each interface (``ModelExchange``, ``CoSimulation``, ``ScheduledExecution``) to its attributes.
    default_experiment
        Attributes of the default experiment; empty where there is none.
    variables
        All variables, in order.
    unknowns
        All entries of the model structure, in order.
    types, units
        Declared types and units, in order.
    categories
        Names of the log categories.
    source_files
        Names of the source files (FMI 2.0).
    by_reference
        Index (FMI 2.0) or value reference (FMI 3.0) to the first variable with it.
    """

    fmi_major: int
    attributes: dict[str, str]
    interfaces: dict[str, dict[str, str]]
    default_experiment: dict[str, str]
    variables: tuple[RawVariable, ...]
    unknowns: tuple[Unknown, ...]
    types: tuple[DeclaredType, ...]
    units: tuple[DeclaredUnit, ...]
    categories: tuple[str, ...]
    source_files: tuple[str, ...]
    by_reference: dict[int, RawVariable] = field(repr=False)

    @property
    def co_simulation(self) -> dict[str, str]:
        """Attributes of the co-simulation interface; empty where there is no such interface."""
        return self.interfaces.get("CoSimulation", {})

    @property
    def model_identifier(self) -> str:
        """Model identifier for co-simulation; empty where it is missing."""
        return self.co_simulation.get("modelIdentifier", "")

    @property
    def token(self) -> str:
        """The GUID (FMI 2.0) or instantiation token (FMI 3.0); empty where it is missing."""
        return self.attributes.get("guid" if self.fmi_major == 2 else "instantiationToken", "")

    def has_capability(self, capability: str) -> bool:
        """Return whether a capability of co-simulation is declared.

        Parameters
        ----------
        capability
            Its name in FMI 3.0; those of FMI 2.0 differ in capitals only.
        """
        found = {name.lower(): value for name, value in self.co_simulation.items()}
        return is_true(found.get(capability.lower()))

    def variable(self, reference: int | None) -> RawVariable | None:
        """Look up a variable by an index (FMI 2.0) or a value reference (FMI 3.0); None where there is none.

        Parameters
        ----------
        reference
            Index, from 1, or value reference; None for no reference.

        Returns
        -------
        RawVariable or None
            The first variable with that reference.
        """
        return None if reference is None else self.by_reference.get(reference)

    def attribute(self, variable: RawVariable, name: str) -> str | None:
        """Return an attribute of a variable as written, that of its declared type where it has none of its own.

        Parameters
        ----------
        variable
            The variable.
        name
            Name of the attribute.
        """
        if name in variable.attributes or variable.declared_type is None:
            return variable.attributes.get(name)
        declared = next((t for t in self.types if t.name == variable.declared_type), None)
        return None if declared is None else declared.attributes.get(name)

    def shape(self, variable: RawVariable) -> tuple[int, ...] | None:
        """Return the sizes of a variable's dimensions by the start values of the description.

        Parameters
        ----------
        variable
            A scalar or an array.

        Returns
        -------
        tuple of int or None
            Empty for a scalar; None where a size is not a positive integer.
        """
        sizes = [self._size(*dimension) for dimension in variable.dimensions]
        return None if any(size < 1 for size in sizes) else tuple(sizes)

    def _size(self, start: str, reference: str) -> int:
        """Return the size of a dimension; below 1 where there is none."""
        if not start:
            referred = self.variable(_parse_integer(reference or None))
            start = referred.start[0] if referred is not None and referred.start else ""
        return _parse_integer(start) or 0


def is_true(text: str | None) -> bool:
    """Return whether the text of a Boolean attribute means true.

    Parameters
    ----------
    text
        Value of the attribute; None where it is absent.
    """
    return text in ("true", "1")


def parse_number(text: str | None) -> float | None:
    """Convert a text to a number; NaN where it is not a number, None for None.

    Parameters
    ----------
    text
        Value of an attribute; None where it is absent.

    Returns
    -------
    float or None
        In the unit of the attribute.
    """
    if text is None:
        return None
    try:
        return float(text)
    except ValueError:
        return math.nan


def _parse_integer(text: str | None) -> int | None:
    """Convert a text to an integer; -1 where it is not an integer, None for None."""
    try:
        return None if text is None else int(text)
    except ValueError:
        return -1


def default_variability(fmi_major: int, type_name: str, causality: str) -> str:
    """Return the standard's default variability of a variable.

    Parameters
    ----------
    fmi_major
        Major version of FMI.
    type_name
        The variable's type.
    causality
        The variable's causality.
    """
    if fmi_major == 2:
        return "continuous"
    if causality in _PARAMETERS:
        return "fixed"
    return "continuous" if type_name in FLOATS else "discrete"


def default_initial(causality: str, variability: str) -> str | None:
    """Return the standard's default of ``initial``.

    Parameters
    ----------
    causality, variability
        Those of the variable.

    Returns
    -------
    str or None
        None for the independent variable, which has no such attribute.
    """
    if causality in ("parameter", "structuralParameter", "input"):
        return "exact"
    if causality == "independent":
        return None
    return "exact" if variability == "constant" else "calculated"


def read_raw_description(root: Any) -> RawDescription | None:
    """Read a model description.

    Parameters
    ----------
    root
        The root element, from lxml.

    Returns
    -------
    RawDescription or None
        None for versions other than FMI 2.0 and 3.x.
    """
    version = root.get("fmiVersion", "")
    fmi_major = 2 if version == "2.0" else 3 if version.startswith("3.") else 0
    if not fmi_major:
        return None
    variables = tuple(_variables(root, fmi_major))
    interfaces = ("ModelExchange", "CoSimulation", "ScheduledExecution")
    experiment = root.find("DefaultExperiment")
    return RawDescription(
        fmi_major=fmi_major,
        attributes=dict(root.attrib),
        interfaces={name: dict(found.attrib) for name in interfaces if (found := root.find(name)) is not None},
        default_experiment={} if experiment is None else dict(experiment.attrib),
        variables=variables,
        unknowns=tuple(_unknowns(root, fmi_major)),
        types=tuple(_declared_type(name, body) for name, body in _type_elements(root, fmi_major)),
        units=tuple(_declared_units(root)),
        categories=tuple(c.get("name", "") for c in root.iterfind("LogCategories/Category")),
        source_files=tuple(f.get("name", "") for f in root.iterfind("CoSimulation/SourceFiles/File")),
        by_reference={(v.index if fmi_major == 2 else v.reference): v for v in reversed(variables)},
    )


def _type_elements(root: Any, fmi_major: int) -> Iterator[tuple[str, Any]]:
    """Yield the name of each declared type and the element with its attributes."""
    for element in root.iterfind("TypeDefinitions/*"):
        body = element if fmi_major == 3 else next(element.iterchildren("*"), None)
        if body is not None and isinstance(body.tag, str):
            yield element.get("name", ""), body


def _declared_type(name: str, body: Any) -> DeclaredType:
    items = tuple(parse_number(item.get("value")) or 0.0 for item in body.iterfind("Item"))
    return DeclaredType(name, body.tag.removesuffix("Type"), body.get("unit"), items, dict(body.attrib))


def _declared_units(root: Any) -> Iterator[DeclaredUnit]:
    for element in root.iterfind("UnitDefinitions/Unit"):
        display_units = tuple(found.get("name", "") for found in element.iterfind("DisplayUnit"))
        yield DeclaredUnit(element.get("name", ""), element.find("BaseUnit") is not None, display_units)


def _variables(root: Any, fmi_major: int) -> Iterator[RawVariable]:
    types = dict(_type_elements(root, fmi_major))
    elements = (e for e in root.iterfind("ModelVariables/*") if isinstance(e.tag, str))
    for index, element in enumerate(elements, 1):
        body = element if fmi_major == 3 else next((c for c in element.iterchildren() if c.tag in KINDS), element)
        yield _variable(fmi_major, index, element, body, types.get(body.get("declaredType")))


def _variable(fmi_major: int, index: int, element: Any, body: Any, type_element: Any) -> RawVariable:
    """Read a variable from its element, its type's (in FMI 3.0 the same one) and its declared type's or None."""

    def inherited(name: str) -> str | None:
        text: str | None = body.get(name)
        if text is None and type_element is not None:
            text = type_element.get(name)
        return None if text is None else intern(text)

    causality = intern(element.get("causality", "local"))
    variability = intern(element.get("variability") or default_variability(fmi_major, body.tag, causality))
    return RawVariable(
        name=intern(element.get("name", "")),
        reference=_parse_integer(element.get("valueReference")) or 0,
        type=intern(body.tag),
        causality=causality,
        variability=variability,
        initial=element.get("initial") or default_initial(causality, variability),
        start=_start(body),
        minimum=parse_number(inherited("min")),
        maximum=parse_number(inherited("max")),
        nominal=parse_number(inherited("nominal")),
        unit=inherited("unit"),
        display_unit=body.get("displayUnit"),
        declared_type=body.get("declaredType"),
        derivative=_parse_integer(body.get("derivative")),
        clocks=_parse_integers(element.get("clocks")),
        aliases=tuple(RawAlias(a.get("name", ""), a.get("displayUnit")) for a in element.iterfind("Alias")),
        dimensions=tuple((d.get("start") or "", d.get("valueReference") or "") for d in body.iterfind("Dimension")),
        index=index,
        line=element.sourceline or 0,
        attributes={intern(name): intern(text) for name, text in (*body.attrib.items(), *element.attrib.items())},
    )


def _start(body: Any) -> tuple[str, ...] | None:
    """Read start values: a list in one attribute, or elements ``Start`` for strings and binaries of FMI 3.0."""
    elements = body.findall("Start")
    if elements:
        return tuple(element.get("value", "") for element in elements)
    text = body.get("start")
    if text is None:
        return None
    return (text,) if body.tag in ("String", "Binary") or body.find("Dimension") is None else tuple(text.split())


def _unknowns(root: Any, fmi_major: int) -> Iterator[Unknown]:
    name = "index" if fmi_major == 2 else "valueReference"
    path = "ModelStructure/*/Unknown" if fmi_major == 2 else "ModelStructure/*"
    for element in root.iterfind(path):
        if not isinstance(element.tag, str):
            continue
        yield Unknown(
            list=_LISTS.get(element.getparent().tag if fmi_major == 2 else element.tag, ""),
            reference=_parse_integer(element.get(name)) or 0,
            dependencies=_parse_integers(element.get("dependencies")),
            kinds=None if element.get("dependenciesKind") is None else tuple(element.get("dependenciesKind").split()),
            line=element.sourceline or 0,
        )


def _parse_integers(text: str | None) -> tuple[int, ...] | None:
    return None if text is None else tuple(_parse_integer(word) or 0 for word in text.split())


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
"""Name of a list in FMI 2.0 or element in FMI 3.0 to :attr:`Unknown.list`."""
