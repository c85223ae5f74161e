"""Reading of a description's XML: repairs where the standard is violated and the meaning is clear, and annotations."""

from __future__ import annotations

import io
import zipfile
from typing import Any, BinaryIO, NamedTuple

from lxml import etree

from cosim.fmi.budgets import MAX_UNITS, MAX_VARIABLES, check_count
from cosim.fmi.xml import parse

DESCRIPTION = "modelDescription.xml"
"""Name of the model description in an FMU."""

SAMPLED = "io.github.seat-cosim.sampled"
"""Vendor annotation of an FMU whose discrete outputs are values at the begin of a step: tool name in FMI 2, annotation
type in FMI 3."""

_LISTS = ("dependencies", "dependenciesKind", "clocks")
"""Attributes that are lists, whose items XML schema separates by any white space; fmpy by a single space."""

_BEFORE_THE_ANNOTATION = "seat-cosim 0.1."
"""Generation tools whose FMUs are sampled and do not say so."""


class RepairedDescription(NamedTuple):
    """What is read of a description before fmpy reads it.

    Attributes
    ----------
    archive
        An archive with the repaired description, or the FMU itself if there is nothing to repair.
    sampled
        Whether the FMU's discrete outputs are values at the begin of a step.
    relative
        Name of each variable with an attribute ``relativeQuantity`` to its value: fmpy 0.3.32 misses it.
    """

    archive: str | BinaryIO
    sampled: bool
    relative: dict[str, bool]


def repaired(fmu: str | BinaryIO, where: str) -> RepairedDescription:
    """Read an FMU's description and repair it.

    FMI 2.0 parameters without a variability become fixed. By the standard's default they are continuous, which is not
    allowed for parameters. pythonfmu writes such parameters. The white space in lists is normalized for fmpy's reader.

    Parameters
    ----------
    fmu
        The FMU, as a file name or an open file.
    where
        Name of the model description in messages.

    Returns
    -------
    RepairedDescription
        The description, repaired where that is necessary.

    Raises
    ------
    SetupError
        If the description is not well-formed XML or declares a document type, see :func:`cosim.fmi.xml.parse`; if it
        has too many variables or units.
    """
    with zipfile.ZipFile(fmu) as archive:
        tree = parse(archive.read(DESCRIPTION), where)
    variables, units = tree.find("ModelVariables"), tree.find("UnitDefinitions")
    check_count(where, "variables", 0 if variables is None else len(variables), MAX_VARIABLES)
    check_count(where, "units", 0 if units is None else len(units), MAX_UNITS)
    changes = [normalize_lists(tree), _fix_parameters(tree)]
    return RepairedDescription(archive_of(tree) if any(changes) else fmu, _is_sampled(tree), _relative(tree))


def normalize_lists(tree: Any) -> bool:
    """Separate the items of list attributes by single spaces, as XML schema normalizes them.

    Parameters
    ----------
    tree
        Root of a model description, from lxml; changed in place.

    Returns
    -------
    bool
        Whether anything was changed.
    """
    changed = False
    for element in tree.iter("*"):
        for name in _LISTS:
            text = element.get(name)
            if text is not None and (normalized := " ".join(text.split())) != text:
                element.set(name, normalized)
                changed = True
    return changed


def archive_of(tree: Any) -> BinaryIO:
    """Return an archive that holds a model description only.

    Parameters
    ----------
    tree
        Root of the model description, from lxml.
    """
    copy = io.BytesIO()
    with zipfile.ZipFile(copy, "w") as archive:
        archive.writestr(DESCRIPTION, etree.tostring(tree))
    copy.seek(0)
    return copy


def _fix_parameters(tree: Any) -> bool:
    """Make parameters of FMI 2.0 without a variability fixed; return whether there are any."""
    found = [
        variable
        for variable in tree.iterfind("ModelVariables/ScalarVariable")
        if variable.get("causality") in ("parameter", "calculatedParameter") and variable.get("variability") is None
    ]
    for variable in found:
        variable.set("variability", "fixed")
    return bool(found)


def _is_sampled(tree: Any) -> bool:
    tools = [tool.get("name") for tool in tree.iterfind("VendorAnnotations/Tool")]
    annotations = [annotation.get("type") for annotation in tree.iterfind("Annotations/Annotation")]
    return SAMPLED in (*tools, *annotations) or str(tree.get("generationTool")).startswith(_BEFORE_THE_ANNOTATION)


def _relative(tree: Any) -> dict[str, bool]:
    found = {}
    for element in tree.iterfind("ModelVariables//*[@relativeQuantity]"):
        variable = element.getparent() if element.getparent().tag == "ScalarVariable" else element
        found[str(variable.get("name"))] = element.get("relativeQuantity").strip() in ("true", "1")
    return found
