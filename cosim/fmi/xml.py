"""Parse XML from untrusted files."""

from __future__ import annotations

from typing import Any

from lxml import etree

from cosim.errors import SetupError


def safe_parser(**options: bool) -> etree.XMLParser:
    """Create a parser without network access, external document types, expanded entities and huge trees.

    Parameters
    ----------
    **options
        Further options of :class:`lxml.etree.XMLParser`.

    Returns
    -------
    lxml.etree.XMLParser
        A new parser.
    """
    return etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False, huge_tree=False, **options)


def parse(data: bytes, where: str, **options: bool) -> Any:
    """Parse an XML document and reject document types.

    Parameters
    ----------
    data
        The document.
    where
        Name of the document in messages.
    **options
        Further options of :class:`lxml.etree.XMLParser`.

    Returns
    -------
    lxml element
        The root.

    Raises
    ------
    SetupError
        If the data are not well-formed XML, or declare a document type.
    """
    try:
        root = etree.fromstring(data, safe_parser(**options))
    except (etree.XMLSyntaxError, ValueError, LookupError) as error:
        raise SetupError(f"{where}: expected XML, got: {error}") from None
    if root.getroottree().docinfo.doctype:
        raise SetupError(f"{where}: expected XML without a document type, got one")
    return root
