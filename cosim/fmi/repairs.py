"""Descriptions as they are found in the wild: what breaks the standard in a way whose meaning is plain is mended."""

from __future__ import annotations

import io
import zipfile
from typing import BinaryIO

from lxml import etree

from cosim.fmi.xml import parse

DESCRIPTION = "modelDescription.xml"


def mended(fmu: str | BinaryIO, where: str) -> str | BinaryIO:
    """Read an FMU's description and mend it.

    Known so far: FMI 2 parameters without a variability (pythonfmu writes them unless told otherwise). By the standard
    they would be continuous, which a parameter must not be; they are taken as fixed.

    Parameters
    ----------
    fmu
        File name, or open file.
    where
        What to call it in messages.

    Returns
    -------
    str or BinaryIO
        An archive with the mended description, or the FMU itself if there is nothing to mend.

    Raises
    ------
    SetupError
        If the description is no XML, or not such as can be trusted, see :mod:`cosim.fmi.xml`.
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
