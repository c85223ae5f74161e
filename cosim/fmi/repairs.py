"""Repairs of descriptions that violate the standard, where the meaning is clear."""

from __future__ import annotations

import io
import zipfile
from typing import BinaryIO

from lxml import etree

from cosim.fmi.xml import parse

DESCRIPTION = "modelDescription.xml"


def repaired(fmu: str | BinaryIO, where: str) -> str | BinaryIO:
    """Read an FMU's description and repair it.

    FMI 2 parameters without a variability become fixed: by the standard they would be continuous, which a parameter
    must not be. pythonfmu writes such parameters.

    Parameters
    ----------
    fmu
        File name, or open file.
    where
        Name of the file, for messages.

    Returns
    -------
    str or BinaryIO
        An archive with the repaired description, or the FMU itself if there is nothing to repair.

    Raises
    ------
    SetupError
        If the description is no XML, or of a kind that is refused, see :mod:`cosim.fmi.xml`.
    """
    with zipfile.ZipFile(fmu) as archive:
        tree = parse(archive.read(DESCRIPTION), where)
    found = [
        variable
        for variable in tree.iterfind("ModelVariables/ScalarVariable")
        if variable.get("causality") in ("parameter", "calculatedParameter") and variable.get("variability") is None
    ]
    if not found:
        return fmu
    for variable in found:
        variable.set("variability", "fixed")
    copy = io.BytesIO()
    with zipfile.ZipFile(copy, "w") as archive:
        archive.writestr(DESCRIPTION, etree.tostring(tree))
    copy.seek(0)
    return copy
