"""Names of variables in texts of users: an exact name wins over any grammar, and double quotes protect a name.

FMI allows any characters in names, also those that assignments and transformations are written with.
"""

from __future__ import annotations

import re
from collections.abc import Callable

from cosim.errors import SetupError
from cosim.units import IDENTITY, Linear

_NUMBER = r"(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_FACTOR = re.compile(rf"(?P<factor>[-+]?{_NUMBER})\s*\*\s*(?P<rest>.+)", re.DOTALL)
_OFFSET = re.compile(rf'(?:"(?P<quoted>[^"]+)"|(?P<output>.+?))(?P<offset>\s*[-+]\s*{_NUMBER})?', re.DOTALL)


def unquoted(text: str) -> str:
    """Remove the double quotes around a name."""
    text = text.strip()
    return text[1:-1] if len(text) > 2 and text.startswith('"') and text.endswith('"') else text


def split_assignment(text: str, is_name: Callable[[str], bool]) -> tuple[str, str]:
    """Split an assignment ``NAME=VALUE`` at an equals sign.

    Parameters
    ----------
    text
        The assignment.
    is_name
        Whether there is something of a name.

    Returns
    -------
    name, value : str
        At the last equals sign before which stands the name of something, else at the one that follows quotes, else at
        the first; both empty where there is none.

    Examples
    --------
    >>> split_assignment("a.x=y=2", {"a.x=y"}.__contains__)
    ('a.x=y', '2')
    >>> split_assignment('"a.x=y" = 2', lambda name: False)
    ('a.x=y', '2')
    """
    splits = [(text[: m.start()].strip(), text[m.end() :].strip()) for m in re.finditer("=", text)]
    if named := [split for split in splits if is_name(split[0])]:
        return named[-1]
    if quoted := re.fullmatch(r'\s*"(?P<name>[^"]+)"\s*=(?P<value>.*)', text, re.DOTALL):
        return quoted["name"], quoted["value"].strip()
    return splits[0] if splits else ("", "")


def split_connection(text: str, is_name: Callable[[str], bool]) -> tuple[str, str]:
    """Split a connection ``OUTPUT=INPUT`` at an equals sign.

    Parameters
    ----------
    text
        Output, with its transformation, and input.
    is_name
        Whether there is a variable of a name.

    Returns
    -------
    source, sink : str
        At the first equals sign after which stands the name of something, else at the one before quotes, else at the
        last; both empty where there is none.
    """
    splits = [(text[: m.start()].strip(), text[m.end() :].strip()) for m in re.finditer("=", text)]
    if named := [split for split in splits if is_name(split[1])]:
        return named[0]
    if quoted := re.fullmatch(r'(?P<source>.*)=\s*"(?P<sink>[^"]+)"\s*', text, re.DOTALL):
        return quoted["source"].strip(), quoted["sink"]
    return splits[-1] if splits else ("", "")


def parse_source(text: str, is_name: Callable[[str], bool]) -> tuple[str, Linear]:
    """Split an output and the transformation of its values: ``cab.z``, ``0.001*cab.z``, ``-1*"cab.z-1" + 0.5``.

    Parameters
    ----------
    text
        The output, with or without a transformation.
    is_name
        Whether there is an output of a name: such a text holds no transformation, or a factor only.

    Returns
    -------
    output : str
        Without the transformation.
    transformation : Linear
        The identity where the text holds none.

    Raises
    ------
    SetupError
        If the text is neither.
    """
    text = text.strip()
    if is_name(text):
        return text, IDENTITY
    factored = _FACTOR.fullmatch(text)
    factor, rest = (factored["factor"], factored["rest"]) if factored else ("1", text)
    if is_name(rest):
        return rest, Linear(float(factor))
    found = _OFFSET.fullmatch(rest)
    name = (found["quoted"] or found["output"].strip()) if found else ""
    if found is None or not name or ('"' in name and not is_name(name)):
        raise SetupError(f"{text!r}: expected COMPONENT.OUTPUT, or FACTOR*COMPONENT.OUTPUT+OFFSET")
    return name, Linear(float(factor), float((found["offset"] or "0").replace(" ", "")))
