"""Repair model descriptions that violate the standard where their meaning is clear."""

from __future__ import annotations

import io
import zipfile
from typing import BinaryIO

from lxml import etree

from cosim.fmi.xml import parse

DESCRIPTION = "modelDescription.xml"
"""Name of the model description in an FMU."""


def repaired(fmu: str | BinaryIO, where: str) -> str | BinaryIO:
    """Read an FMU's model description and repair it.

    FMI 2.0 parameters without a variability become fixed. By the standard's default they are continuous, which is not
    allowed for parameters. pythonfmu writes such parameters.

    Parameters
    ----------
    fmu
        The FMU, as a file name or an open file.
    where
        Name of the model description in messages.

    Returns
    -------
    str or BinaryIO
        An archive that holds the repaired description only, or ``fmu`` itself if there is nothing to repair.

    Raises
    ------
    SetupError
        If the description is not well-formed XML or declares a document type, see :func:`cosim.fmi.xml.parse`.
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
