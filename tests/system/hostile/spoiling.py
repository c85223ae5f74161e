"""Valid files, spoiled: bytes anywhere, and XML, JSON, CSV and archives where their structure hurts most."""

from __future__ import annotations

import copy
import io
import json
import struct
import warnings
import zipfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from typing import Any

from hypothesis import strategies as st
from lxml import etree

STRANGE = (
    *(
        "",
        " ",
        "0",
        "-1",
        "1e999",
        "-1e308",
        "nan",
        "inf",
        "-inf",
        "1e-320",
        "0x10",
        "1_000",
        "\u0661\u0662",
        "9" * 5000,
    ),
    *(
        "true",
        "TRUE",
        "null",
        "None",
        "%s%n",
        "a.b",
        ".",
        "..",
        "../../etc/passwd",
        "/etc/passwd",
        "C:\\x",
        "file:///etc",
    ),
    *("http://127.0.0.1:9/x", "a\tb", "\u202e\u00e4", "x" * 300, "x" * 100_000, "&lol;", "<a/>", "{}", "[", '"', "'"),
)
"""Texts that have broken readers before."""

texts = st.one_of(st.sampled_from(STRANGE), st.text(max_size=8))


@st.composite
def spoiled_bytes(draw: st.DrawFn, data: bytes) -> bytes:
    """Draw copies with a few bytes flipped, cut out, put in or repeated."""
    found = bytearray(data)
    for _ in range(draw(st.integers(1, 4))):
        how = draw(st.sampled_from(("flip", "cut", "put", "repeat", "end")))
        begin = draw(st.integers(0, max(0, len(found) - 1)))
        size = draw(st.integers(1, 64))
        if how == "flip" and found:
            found[begin] ^= 1 << draw(st.integers(0, 7))
        elif how == "cut":
            del found[begin : begin + size]
        elif how == "put":
            found[begin:begin] = draw(
                st.one_of(st.binary(max_size=16), st.sampled_from((b"\0", b"\xff", b"\n", b"<", b'"')))
            )
        elif how == "repeat":
            found[begin:begin] = found[begin : begin + size] * draw(st.sampled_from((1, 2, 1000)))
        else:
            del found[begin:]
    return bytes(found)


# ---- XML -------------------------------------------------------------------------------------------------------------

_LAUGHS = "".join(f'<!ENTITY l{i} "{f"&l{i - 1};" * 10 if i else "lol"}">' for i in range(12))
DOCTYPES = (
    f"<!DOCTYPE r [{_LAUGHS}]>",
    '<!DOCTYPE r [<!ENTITY x SYSTEM "file:///etc/passwd">]>',
    '<!DOCTYPE r SYSTEM "http://127.0.0.1:9/x.dtd">',
    '<!DOCTYPE r [<!ENTITY % x SYSTEM "file:///etc/passwd"> %x;]>',
    "<!DOCTYPE r>",
)
"""Entities that grow, that read other files, that ask the network; and a harmless one."""


@st.composite
def spoiled_xml(draw: st.DrawFn, data: bytes) -> bytes:
    """Draw documents with attributes and elements changed, gone, twice or elsewhere; with a type; nested deep."""
    if draw(st.integers(0, 9)) == 0:
        return draw(spoiled_bytes(data))
    root = etree.fromstring(data)
    for _ in range(draw(st.integers(1, 3))):
        elements = [element for element in root.iter() if isinstance(element.tag, str)]
        _spoil_element(draw, draw(st.sampled_from(elements)), elements)
    found = bytes(etree.tostring(root))
    if draw(st.integers(0, 9)) == 0:
        use = draw(st.sampled_from(("&l11;", "&x;", "&#0;", "")))
        document = draw(st.sampled_from(DOCTYPES)).encode() + found
        return document.replace(b'="', b'="' + use.encode(), 3) if draw(st.booleans()) else document
    return found


def _spoil_element(draw: st.DrawFn, element: Any, elements: Sequence[Any]) -> None:
    how = draw(
        st.sampled_from(("value", "value", "value", "less", "more", "gone", "twice", "moved", "tag", "deep", "text"))
    )
    names = sorted(element.attrib)
    parent = element.getparent()
    if how == "value" and names:
        value = draw(texts)
        with suppress(ValueError):  # of a text that XML cannot hold
            element.set(draw(st.sampled_from(names)), value)
    elif how == "less" and names:
        del element.attrib[draw(st.sampled_from(names))]
    elif how == "more":
        element.set(draw(st.sampled_from(("min", "max", "start", "unit", "name", "value", "declaredType"))), "1")
    elif how == "gone" and parent is not None:
        parent.remove(element)
    elif how == "twice" and parent is not None:
        parent.append(copy.deepcopy(element))
    elif how == "moved":
        draw(st.sampled_from(elements)).append(copy.deepcopy(element))
    elif how == "tag":
        element.tag = draw(st.sampled_from([e.tag for e in elements] + ["Real", "Integer", "Clock", "Binary", "x"]))
    elif how == "deep":
        for _ in range(draw(st.sampled_from((3, 200, 5000)))):
            element = etree.SubElement(element, element.tag)
    elif how == "text":
        element.text = "text"


# ---- JSON ------------------------------------------------------------------------------------------------------------

_VALUES = st.one_of(
    st.sampled_from(
        (None, True, False, 0, -1, 10**400, 1e308, float("nan"), float("inf"), [], {}, [[]], "\ud800", "a\0b")
    ),
    texts,
    st.sampled_from((100, 950, 980, 990, 100_000)).map(lambda depth: _Nested(depth)),
)


class _Nested(str):
    """Stands for a list nested deep, which cannot be made of lists."""

    __slots__ = ()

    def __new__(cls, depth: int) -> _Nested:
        return super().__new__(cls, f"nested {depth}")


@st.composite
def spoiled_json(draw: st.DrawFn, data: bytes) -> bytes:
    """Draw documents with values of other types, keys gone or new, nested deep."""
    if draw(st.integers(0, 9)) == 0:
        return draw(spoiled_bytes(data))
    document = json.loads(data)
    for _ in range(draw(st.integers(1, 3))):
        places = [*_places(document)]
        container, key = draw(st.sampled_from(places))
        how = draw(st.sampled_from(("value", "value", "value", "gone", "new")))
        if how == "gone":
            container.pop(key)
        elif how == "new" and isinstance(container, dict):
            container[draw(st.text(max_size=5))] = copy.deepcopy(draw(_VALUES))
        else:
            container[key] = copy.deepcopy(draw(_VALUES))
        if not document:
            break
    text = json.dumps(document)
    for depth in (100, 950, 980, 990, 100_000):
        text = text.replace(f'"nested {depth}"', "[" * depth + "]" * depth)
    return text.encode()


def _places(document: Any) -> Iterator[tuple[Any, Any]]:
    keys = document if isinstance(document, dict) else range(len(document)) if isinstance(document, list) else ()
    for key in keys:
        yield document, key
        yield from _places(document[key])


# ---- CSV -------------------------------------------------------------------------------------------------------------

_CELLS = (
    *STRANGE[:24],
    "1e400",
    "-0",
    "+.5e-3",
    "1.",
    ".",
    "e5",
    "1e",
    "1,5",
    "0.1 ",
    "#1",
    "1#",
    '"1"',
    '"',
    "1e-310",
    "\0",
)


@st.composite
def spoiled_csv(draw: st.DrawFn, data: bytes) -> bytes:
    """Draw tables with cells, lines and separators that do not fit."""
    if draw(st.integers(0, 5)) == 0:
        return draw(spoiled_bytes(data))
    lines = [line.split(",") for line in data.decode().splitlines()]
    for _ in range(draw(st.integers(1, 4))):
        how = draw(
            st.sampled_from(
                ("cell", "cell", "cell", "row", "less", "more", "blank", "swap", "head", "few", "long", "small")
            )
        )
        row = draw(st.integers(0, len(lines) - 1)) if lines else 0
        if not lines:
            break
        if how == "cell" and lines[row]:
            lines[row][draw(st.integers(0, len(lines[row]) - 1))] = draw(st.sampled_from(_CELLS))
        elif how == "row":
            del lines[row]
        elif how == "less":
            lines[row] = lines[row][:-1]
        elif how == "more":
            lines[row] = [*lines[row], "1"]
        elif how == "blank":
            lines.insert(row, [draw(st.sampled_from(("", " ", "\t", "#", "\r")))])
        elif how == "swap":
            lines[row], lines[-1] = lines[-1], lines[row]
        elif how == "head":
            lines[0] = draw(
                st.lists(st.sampled_from(("time", "acceleration", "displacement", "x", '"time"', "")), max_size=4)
            )
        elif how == "small":
            exponent = draw(st.sampled_from(("e-2", "e-6", "e-9", "e-160", "e-306", "e-318", "e9", "e300")))
            lines = [[cell + exponent if i == 0 else cell for i, cell in enumerate(line)] for line in lines]
            lines[0] = data.decode().splitlines()[0].split(",")
        elif how == "few":
            del lines[draw(st.integers(1, 12)) :]
        else:
            lines[row] = [cell + " " * 1000 for cell in lines[row]]
    end = draw(st.sampled_from((*["\n"] * 6, "\r\n", "\r\n", "\r")))
    return end.join(map(",".join, lines)).encode(errors="replace") + draw(
        st.sampled_from((*[b""] * 6, b"\n", b"\n\n", b"\0"))
    )


# ---- archives --------------------------------------------------------------------------------------------------------

NAMES = (
    *(
        "../out",
        "/abs",
        "a/../../out",
        "C:/x",
        "a\\b",
        "x\0y",
        "",
        ".",
        "./",
        "a/",
        "\u00e4\u202e",
        "CON",
        "x" * 300,
        "a//b",
    ),
    *("modelDescription.xml", "modelDescription.xml/x", "resources", "binaries/linux64", "SystemStructure.ssd/x"),
)


@st.composite
def spoiled_archives(
    draw: st.DrawFn, data: bytes, spoilers: Mapping[str, Callable[[bytes], st.SearchStrategy[bytes]]]
) -> bytes:
    """Draw archives that lead outside, are bombs, hold links, the same name twice, or are damaged.

    Parameters
    ----------
    spoilers
        Name of a member to what spoils it.
    """
    how = draw(st.sampled_from(("member", "member", "member", "bytes", "names", "flags", "bomb", "comment", "sizes")))
    if how == "bytes":
        return draw(spoiled_bytes(data))
    found = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(data)) as archive, zipfile.ZipFile(found, "w") as copy_:
        members = {name: archive.read(name) for name in archive.namelist()}
        for name, content in members.items():
            if how == "member" and name in spoilers:
                content = draw(spoilers[name](content))
            copy_.writestr(name, content)
        if how == "names":
            _add(draw, copy_)
        if how == "bomb":
            copy_.writestr("bomb", bytes(draw(st.sampled_from((10**5, 10**8)))), zipfile.ZIP_DEFLATED)
        if how == "comment":
            copy_.comment = draw(st.binary(max_size=50))
    spoiled = bytearray(found.getvalue())
    if how in ("flags", "sizes"):
        _spoil_directory(draw, spoiled, how)
    return bytes(spoiled)


def _add(draw: st.DrawFn, archive: zipfile.ZipFile) -> None:
    """Add members with names or kinds that no archive should hold."""
    for _ in range(draw(st.integers(1, 2))):
        member = zipfile.ZipInfo(draw(st.sampled_from(NAMES)))
        member.external_attr = draw(st.sampled_from((0, 0o100644, 0o120777, 0o010644, 0o020644, 0o040755))) << 16
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            archive.writestr(member, b"/etc/passwd")


def _spoil_directory(draw: st.DrawFn, data: bytearray, how: str) -> None:
    """Change a field of a record in the table of contents."""
    starts = [i for i in range(len(data) - 46) if data[i : i + 4] == b"PK\x01\x02"]
    place = draw(st.sampled_from(starts))
    if how == "flags":
        at, size = draw(st.sampled_from(((8, 2), (10, 2), (6, 2), (34, 2), (38, 4))))
    else:
        at, size = draw(st.sampled_from(((16, 4), (20, 4), (24, 4), (28, 2), (30, 2), (42, 4))))
    number = draw(st.one_of(st.sampled_from((0, 1, 8, 12, 14, 99, 0xFFFF, 0xFFFFFFFF)), st.integers(0, 2**32 - 1)))
    data[place + at : place + at + size] = struct.pack("<I", number)[:size]
