"""Versions of SSP: documents of 2.0 that need nothing but what 1.0 has are read, all else is refused by name.

Both versions have the same namespaces. What 2.0 added to 1.0 is listed here; metadata and signatures have no influence
on results and are ignored, as annotations are.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from lxml import etree

from cosim.errors import SetupError

_COMMON = "{http://ssp-standard.org/SSP1/SystemStructureCommon}"
_DESCRIPTION = "{http://ssp-standard.org/SSP1/SystemStructureDescription}"
_VALUES = "{http://ssp-standard.org/SSP1/SystemStructureParameterValues}"

_IGNORED = tuple(_COMMON + name for name in ("MetaData", "Signature"))

_TYPES = ("Float64", "Float32", *(f"{sign}Int{bits}" for bits in (8, 16, 32, 64) for sign in ("", "U")))
"""Types of FMI 3, beside those of 1.0."""

_NEW_ELEMENTS = {
    **{_COMMON + name: f"the type {name}" for name in (*_TYPES, "Clock")},
    **{_VALUES + name: f"the type {name}" for name in _TYPES},
    _COMMON + "Dimension": "an array (Dimension)",
    _DESCRIPTION + "Clock": "a clocked connector (Clock)",
    _VALUES + "Value": "a list of values (Value)",
}
"""Element to its feature in messages."""

_NEW_ATTRIBUTES = {"startIndices": "Connection", "endIndices": "Connection"}

_NEW_VALUES = {
    ("Connector", "kind"): ("structuralParameter", "constant", "local", "unspecified"),
    ("Component", "implementation"): ("ScheduledExecution",),
}
"""Element and attribute to the values that are new."""

_GEOMETRY = ("systemInnerX", "systemInnerY")


def check_version(document: Any) -> None:
    """Check the version of a document, on its own or inside another one, and make one of 2.0 a document of 1.0.

    Parameters
    ----------
    document
        Its root element.

    Raises
    ------
    SetupError
        If the version is neither, or the document needs features of 2.0; names each of them.
    """
    version = document.get("version") or "none"
    if version.startswith("1."):
        return
    name = etree.QName(document).localname
    if version != "2.0":
        raise SetupError(f"<{name}>: expected version 1.0 or 2.0, got {version}")
    if features := list(dict.fromkeys(_features(document))):
        raise SetupError(
            *(f"line {line}: expected features of SSP 1.0 only, got {feature} of SSP 2.0" for line, feature in features)
        )
    for element in list(document.iter(*_IGNORED)):
        element.getparent().remove(element)
    for element in document.iter():
        for attribute in _GEOMETRY:
            element.attrib.pop(attribute, None)
    document.set("version", "1.0")


def _features(document: Any) -> Iterator[tuple[int, str]]:
    """Yield line and name of each feature that 1.0 does not have."""
    for element in document.iter():
        tag = etree.QName(element).localname
        if element.tag in _NEW_ELEMENTS:
            yield element.sourceline, _NEW_ELEMENTS[element.tag]
        for attribute, value in element.items():
            if _NEW_ATTRIBUTES.get(attribute) == tag or value in _NEW_VALUES.get((tag, attribute), ()):
                yield element.sourceline, f"{attribute}={value!r}"
        if element.tag == _DESCRIPTION + "Component" and element.get("source") is None:
            yield element.sourceline, f"the component {element.get('name')} without a source"
