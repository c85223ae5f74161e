"""XML that may come from anywhere."""

from __future__ import annotations

from typing import Any

from lxml import etree

from cosim.errors import SetupError


def parse(data: bytes, where: str, **options: bool) -> Any:
    """Parse XML: no network, no document type, no entities, no huge trees.

    Parameters
    ----------
    data
        The document.
    where
        What to call it in messages.
    options
        Further ones of lxml's parser.

    Returns
    -------
    lxml element
        The root.

    Raises
    ------
    SetupError
        If it is none of that kind.
    """
    parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False, huge_tree=False, **options)
    try:
        root = etree.fromstring(data, parser)
    except (etree.XMLSyntaxError, ValueError, LookupError) as error:
        raise SetupError(f"{where}: expected XML, got: {error}") from None
    if root.getroottree().docinfo.doctype:
        raise SetupError(f"{where}: expected XML without a document type, got one")
    return root
