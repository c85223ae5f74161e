"""SSP documents as texts, as other tools write them: tests put together what they need and load it beside FMUs."""

from __future__ import annotations

import shutil
from pathlib import Path
from xml.sax.saxutils import quoteattr

from cosim import System

NAMESPACES = " ".join(
    f'xmlns:{prefix}="http://ssp-standard.org/SSP1/SystemStructure{name}"'
    for prefix, name in (
        ("ssd", "Description"),
        ("ssc", "Common"),
        ("ssv", "ParameterValues"),
        ("ssm", "ParameterMapping"),
    )
)


def component(name: str, source: str = "Gain.fmu", inside: str = "", attributes: str = "") -> str:
    """Write a component."""
    return f"<ssd:Component name={quoteattr(name)} source={quoteattr(source)} {attributes}>{inside}</ssd:Component>"


def connectors(**kinds: str) -> str:
    """Write connectors: name to kind, or to kind, type and unit with spaces between."""
    return f"<ssd:Connectors>{''.join(connector(name, *kind.split()) for name, kind in kinds.items())}</ssd:Connectors>"


def connector(name: str, kind: str, type_: str = "Real", unit: str | None = None) -> str:
    """Write a connector."""
    declared = "" if unit is None else f" unit={quoteattr(unit)}"
    return f'<ssd:Connector name={quoteattr(name)} kind="{kind}"><ssc:{type_}{declared}/></ssd:Connector>'


def connection(start: tuple[str, str], end: tuple[str, str], inside: str = "", attributes: str = "") -> str:
    """Write a connection; an element without a name is the system."""
    ends = "".join(
        f"{side}Element={quoteattr(element)} {side}Connector={quoteattr(name)} " if element
        else f"{side}Connector={quoteattr(name)} "
        for side, (element, name) in (("start", start), ("end", end))
    )  # fmt: skip
    return f"<ssd:Connection {ends}{attributes}>{inside}</ssd:Connection>"


def value(name: str, given: object, type_: str = "Real", attributes: str = "") -> str:
    """Write a parameter."""
    return (
        f"<ssv:Parameter name={quoteattr(name)}>"
        f"<ssv:{type_} value={quoteattr(str(given))} {attributes}/></ssv:Parameter>"
    )


def parameter_set(*values: str, units: str = "", version: str = "1.0", root: str = "") -> str:
    """Write a set of parameters."""
    more = f"<ssv:Units>{units}</ssv:Units>" if units else ""
    return (
        f'<ssv:ParameterSet version="{version}" name="p" {root}><ssv:Parameters>{"".join(values)}</ssv:Parameters>'
        f"{more}</ssv:ParameterSet>"
    )


def bindings(*values: str, mapping: str = "", units: str = "", attributes: str = "") -> str:
    """Write a binding of parameters, with the entries of a mapping."""
    mapped = f'<ssm:ParameterMapping version="1.0">{mapping}</ssm:ParameterMapping>'
    return (
        f"<ssd:ParameterBindings><ssd:ParameterBinding {attributes}>"
        f"<ssd:ParameterValues>{parameter_set(*values, units=units)}</ssd:ParameterValues>"
        f"{f'<ssd:ParameterMapping>{mapped}</ssd:ParameterMapping>' if mapping else ''}"
        "</ssd:ParameterBinding></ssd:ParameterBindings>"
    )


def system(name: str, *elements: str, inside: str = "", joins: str = "") -> str:
    """Write a system; ``inside`` are its connectors and bindings."""
    held = f"<ssd:Elements>{''.join(elements)}</ssd:Elements>" if elements else ""
    joined = f"<ssd:Connections>{joins}</ssd:Connections>" if joins else ""
    return f"<ssd:System name={quoteattr(name)}>{inside}{held}{joined}</ssd:System>"


def document(
    *elements: str, inside: str = "", joins: str = "", after: str = "", version: str = "1.0", root: str = ""
) -> str:
    """Write a description."""
    return (
        f'<?xml version="1.0"?><ssd:SystemStructureDescription {NAMESPACES} version="{version}" name="test" {root}>'
        f"{system('root', *elements, inside=inside, joins=joins)}{after}</ssd:SystemStructureDescription>"
    )


def load(folder: Path, text: str, *fmus: Path) -> System:
    """Write a description beside copies of FMUs, and load it."""
    for fmu in fmus:
        shutil.copy(fmu, folder / fmu.name)
    path = folder / "it.ssd"
    path.write_text(text)
    return System.load(path)
