"""Descriptions as they are found in the wild: what breaks the standard in a way whose meaning is plain is mended."""

from __future__ import annotations

import io
import zipfile
from typing import BinaryIO

from lxml import etree

DESCRIPTION = "modelDescription.xml"


def mended(fmu: str | BinaryIO) -> str | BinaryIO:
    """Read an FMU's description and mend it.

    Known so far: FMI 2 parameters without a variability (pythonfmu writes them unless told otherwise). By the standard
    they would be continuous, which a parameter must not be; they are taken as fixed.

    Parameters
    ----------
    fmu
        File name, or open file.

    Returns
    -------
    str or BinaryIO
        An archive with the mended description, or the FMU itself if there is nothing to mend.
    """
    parser = etree.XMLParser(resolve_entities=False, no_network=True)
    with zipfile.ZipFile(fmu) as archive, archive.open(DESCRIPTION) as stream:
        tree = etree.parse(stream, parser)
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
