"""Read and write dataclasses as XML; each field declares the attribute or element that holds its value.

One reader and one writer serve all classes, so that reading is the inverse of writing. Elements without a field are
ignored. A document is validated against the schema before it is read, so that a misspelt element is an error.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import MISSING, dataclass, field, fields
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any, ClassVar, NamedTuple, Protocol, TypeVar

from lxml import etree

from cosim.errors import SetupError, prefixed
from cosim.fmi.budgets import MAX_CONNECTIONS, MAX_UNITS, check_count
from cosim.fmi.xml import parse
from cosim.ssp.versions import check_version

NAMESPACES = {
    "ssd": "http://ssp-standard.org/SSP1/SystemStructureDescription",
    "ssc": "http://ssp-standard.org/SSP1/SystemStructureCommon",
    "ssv": "http://ssp-standard.org/SSP1/SystemStructureParameterValues",
    "ssm": "http://ssp-standard.org/SSP1/SystemStructureParameterMapping",
    "osp": "http://opensimulationplatform.com/SSP/OSPAnnotations",
    "exchange": "urn:seat-cosim:exchange",
}
"""Prefix in written documents to namespace; some readers recognize elements by prefix only."""

_SCHEMAS = {
    "ssd:SystemStructureDescription": "SystemStructureDescription",
    "ssv:ParameterSet": "SystemStructureParameterValues",
    "ssm:ParameterMapping": "SystemStructureParameterMapping",
}
"""Root element of a document, on its own or inside another one, to the name of its schema."""


_OPTIONAL_LISTS = (
    *(
        f"ssd:{name}"
        for name in (
            "Annotations",
            "Connections",
            "Connectors",
            "Elements",
            "Enumerations",
            "GraphicalElements",
            "ParameterBindings",
            "SignalDictionaries",
            "Units",
        )
    ),
    *(f"ssv:{name}" for name in ("Annotations", "Enumerations", "Units")),
)
"""Elements that only hold others and may be absent."""


class Document(Protocol):
    """A dataclass that describes a whole document."""

    ROOT: ClassVar[str]
    """Root element as ``prefix:name``."""


D = TypeVar("D", bound=Document)
"""The dataclass that is read."""


def _qualified(name: str) -> str:
    """Convert ``prefix:name`` to lxml's ``{namespace}name``."""
    prefix, _, local = name.partition(":")
    return f"{{{NAMESPACES[prefix]}}}{local}"


class Codec(NamedTuple):
    """Conversion between a value and the text of an attribute.

    Attributes
    ----------
    expected
        Name of the type in messages.
    read
        Converts a text to the value; raises KeyError or ValueError for an invalid text.
    write
        Converts a value to the text.
    """

    expected: str
    read: Callable[[str], Any]
    write: Callable[[Any], str]


def _read_boolean(text: str) -> bool:
    return {"true": True, "1": True, "false": False, "0": False}[text.strip()]


TEXT = Codec("a text", str, str)
REAL = Codec("a number", float, lambda value: repr(float(value)))
INTEGER = Codec("a whole number", int, str)
BOOLEAN = Codec("true or false", _read_boolean, lambda value: "true" if value else "false")


# ---- declarations of fields -----------------------------------------------------------------------------------------


class _MalformedError(Exception):
    """A problem of an element that no schema checks; the message begins with its line."""

    def __init__(self, element: Any, problem: str) -> None:
        super().__init__(f"line {element.sourceline}: {problem}")


class _Tag:
    """The name of the element itself, without its namespace."""

    def read(self, element: Any) -> str:
        return str(etree.QName(element).localname)

    def write(self, element: Any, value: str) -> None:
        """Do nothing: the element was created with that name."""


@dataclass(frozen=True)
class _Attribute:
    name: str
    codec: Codec
    default: Any
    always: bool

    def read(self, element: Any) -> Any:
        text = element.get(self.name)
        if not text and self.default is not MISSING:  # empty is absent
            return self.default
        where = f"{etree.QName(element).localname} {self.name}: expected {self.codec.expected}"
        if text is None:
            raise _MalformedError(element, f"{where}, got none")
        try:
            return self.codec.read(text)
        except (KeyError, ValueError):
            raise _MalformedError(element, f"{where}, got {text!r}") from None

    def write(self, element: Any, value: Any) -> None:
        if self.always or self.default is MISSING or value != self.default:
            element.set(self.name, self.codec.write(value))


@dataclass(frozen=True)
class _Children:
    types: Mapping[str, type]
    container: str | None
    single: bool

    def read(self, element: Any) -> Any:
        if self.container is not None:
            element = element.find(_qualified(self.container))
        types = {_qualified(name): cls for name, cls in self.types.items()}
        found = [] if element is None else [_read(types[child.tag], child) for child in element if child.tag in types]
        if self.single:
            return found[0] if found else None
        return tuple(found)

    def write(self, element: Any, value: Any) -> None:
        values = value if not self.single else () if value is None else (value,)
        if self.container is not None and values:
            element = etree.SubElement(element, _qualified(self.container))
        for item in values:
            _write(item, etree.SubElement(element, _qualified(self._name(item))))

    def _name(self, item: Any) -> str:
        names = [name for name, cls in self.types.items() if cls is type(item)]
        return names[0] if len(names) == 1 else next(n for n in names if n.partition(":")[2] == item.kind)


def tag() -> Any:
    """Declare a field ``kind`` that holds the name of the element, for a class that describes several elements."""
    return field(metadata={"part": _Tag()})


def attribute(name: str, codec: Codec = TEXT, default: Any = MISSING, always: bool = False) -> Any:
    """Declare a field that is an attribute.

    Parameters
    ----------
    name
        Name of the attribute.
    codec
        Conversion of its value.
    default
        Value where the attribute is absent or empty. Without it, the attribute is required.
    always
        Whether the default is written, too.

    Returns
    -------
    dataclass field
        The declaration.
    """
    return field(metadata={"part": _Attribute(name, codec, default, always)}, default=default)


def child(types: Mapping[str, type], container: str | None = None) -> Any:
    """Declare a field that is a child element, or None.

    Parameters
    ----------
    types
        Element as ``prefix:name`` to the dataclass that describes it.
    container
        The element between parent and child, if any.

    Returns
    -------
    dataclass field
        The declaration.
    """
    return field(metadata={"part": _Children(types, container, single=True)}, default=None)


def children(types: Mapping[str, type], container: str | None = None) -> Any:
    """Declare a field that is a tuple of child elements.

    Parameters
    ----------
    types
        Element as ``prefix:name`` to the dataclass that describes it.
    container
        The element between parent and children, if any.

    Returns
    -------
    dataclass field
        The declaration.
    """
    return field(metadata={"part": _Children(types, container, single=False)}, default=())


def _read(cls: type, element: Any) -> Any:
    return cls(**{f.name: f.metadata["part"].read(element) for f in fields(cls)})


def _write(value: Any, element: Any) -> None:
    for f in fields(value):
        f.metadata["part"].write(element, getattr(value, f.name))


# ---- documents -------------------------------------------------------------------------------------------------------


def _schema_file(name: str) -> str:
    """Return the file of a schema of the standard, which fmpy includes."""
    spec = find_spec("fmpy")
    assert spec is not None
    assert spec.origin is not None
    return str(Path(spec.origin).parent / "ssp" / "schema" / f"{name}.xsd")


@cache
def _schema(name: str) -> Any:
    return etree.XMLSchema(file=_schema_file(name))


@cache
def _required_attributes() -> frozenset[str]:
    """Return the names of all attributes that some element requires."""
    found: set[str] = set()
    for name in (*_SCHEMAS.values(), "SystemStructureCommon"):
        required = etree.parse(_schema_file(name)).xpath("//*[local-name()='attribute'][@use='required']/@name")
        found |= set(map(str, required))
    return frozenset(found)


def _remove_empty(root: Any) -> None:
    """Remove attributes and lists that are empty, as some tools write what is absent.

    An empty attribute whose name is required elsewhere is valid; where it is optional, it is read as absent. An
    enumeration without its required name is taken for one with an empty name: the FMU describes it.
    """
    required = _required_attributes()
    for element in root.iter(etree.Element):
        for name, value in element.items():
            if not value and name not in required:
                del element.attrib[name]
    for element in root.iter(_qualified("ssc:Enumeration")):
        if element.get("name") is None and not len(element):
            element.set("name", "")
    lists = [element for element in root.iter(*map(_qualified, _OPTIONAL_LISTS)) if not len(element)]
    for element in lists:
        element.getparent().remove(element)


def _schema_problem(root: Any) -> str | None:
    """Return the first violation of the schemas by a document and those inside it; None if they are valid."""
    for name, schema in _SCHEMAS.items():
        for element in root.iter(_qualified(name)):
            if not _schema(schema).validate(element):
                error = _schema(schema).error_log[0]
                text = str(error.message)
                for namespace in NAMESPACES.values():
                    text = text.replace(f"{{{namespace}}}", "")
                return f"line {error.line}: {text}"
    return None


def read_document(cls: type[D], data: bytes, where: str) -> D:
    """Read and validate a document.

    Parameters
    ----------
    cls
        The dataclass that describes the document.
    data
        Its bytes.
    where
        Name of the document in messages.

    Returns
    -------
    D
        An instance of ``cls``.

    Raises
    ------
    SetupError
        If the data are not well-formed XML, or the document is of another kind or version, or violates the schema.
    """
    root = parse(data, where, remove_comments=True, remove_pis=True)
    if root.tag != _qualified(cls.ROOT):
        name, namespace = etree.QName(root).localname, etree.QName(root).namespace
        same = f" of the namespace {namespace}" if name == cls.ROOT.partition(":")[2] else ""
        raise SetupError(f"{where}: expected <{cls.ROOT}> of SSP 1.0 or 2.0, got <{name}>{same}")
    for tag, most in (("Connection", MAX_CONNECTIONS), ("Unit", MAX_UNITS)):
        check_count(where, f"elements {tag}", sum(1 for _ in root.iter(f"{{*}}{tag}")), most)
    _remove_empty(root)
    for element in root.iter(*map(_qualified, _SCHEMAS)):
        with prefixed(where):
            check_version(element)
    if problem := _schema_problem(root):
        raise SetupError(f"{where}: expected a document that is valid against the schema of SSP 1.0, got {problem}")
    try:
        document: D = _read(cls, root)
    except _MalformedError as error:
        raise SetupError(f"{where}: {error}") from None
    return document


def write_document(document: Document) -> bytes:
    """Return a document as UTF-8 encoded XML; the same content gives the same bytes.

    Parameters
    ----------
    document
        An instance of a dataclass that describes a document.
    """
    root = etree.Element(_qualified(document.ROOT), nsmap=NAMESPACES)
    _write(document, root)
    etree.cleanup_namespaces(root)
    etree.indent(root)
    return bytes(etree.tostring(root, encoding="utf-8", xml_declaration=True, pretty_print=True))
