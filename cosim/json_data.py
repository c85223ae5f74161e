"""Write dataclasses as JSON and read them back; the type hints are the schema, and all problems are reported."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import MISSING, asdict, fields, is_dataclass
from types import NoneType, UnionType
from typing import Any, Literal, TypeVar, get_args, get_origin, get_type_hints

from cosim.errors import SetupError, did_you_mean

T = TypeVar("T")
"""The dataclass that is read."""

_TYPE_NAMES = {float: "a number", int: "a whole number", str: "a text", bool: "true or false", NoneType: "null"}


def dump(data: Any) -> str:
    """Return a dataclass as JSON, with its fields in order.

    Parameters
    ----------
    data
        A dataclass as of :func:`load`.

    Returns
    -------
    str
        Equal data give equal text, and numbers read back to the same bits.
    """
    return json.dumps(asdict(data), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def load(kind: type[T], text: str, where: str) -> T:
    """Read a dataclass from JSON.

    Parameters
    ----------
    kind
        A dataclass whose fields are plain values, ``Literal``, lists, dicts of names, unions of these, or such
        dataclasses.
    text
        The JSON text.
    where
        Name of the file in messages.

    Returns
    -------
    T
        An instance of ``kind``.

    Raises
    ------
    SetupError
        With all problems: invalid JSON, missing and unknown keys, values of wrong types.
    """
    try:
        data = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise SetupError(f"{where}: expected JSON, got: {error}") from None
    problems: list[str] = []
    found = _parse(kind, data, where, problems)
    if problems:
        raise SetupError(*problems)
    return found  # type: ignore[no-any-return]


def _parse(hint: Any, data: Any, where: str, problems: list[str]) -> Any:
    """Convert a JSON value to the type of a hint; append a problem if it has another type."""
    if is_dataclass(hint) and isinstance(data, dict):
        return _parse_fields(hint, data, where, problems)
    origin, arguments = get_origin(hint), get_args(hint)
    if origin is list and isinstance(data, list):
        return [_parse(arguments[0], item, f"{where}[{i}]", problems) for i, item in enumerate(data)]
    if origin is dict and isinstance(data, dict):
        return {key: _parse(arguments[1], item, f"{where}: {key}", problems) for key, item in data.items()}
    if origin is Literal and data in arguments:
        return data
    for choice in arguments if origin is UnionType else [hint]:
        if type(data) is choice:
            return data
        if choice is float and type(data) is int and abs(data) < 2**1023:  # above, it is no float
            return float(data)
    problems.append(f"{where}: expected {_expected(hint)}, got {_shortened(data)}")
    return None


def _parse_fields(kind: Any, data: dict[str, Any], where: str, problems: list[str]) -> Any:
    """Convert an object to a dataclass; None if keys or values are wrong."""
    hints = get_type_hints(kind)
    needed = [f.name for f in fields(kind) if f.default is MISSING and f.default_factory is MISSING]
    before = len(problems)
    problems += [f"{where}: expected a key {name}, got none" for name in needed if name not in data]
    problems += [f"{where}: unknown key {name}{did_you_mean(name, hints)}" for name in data if name not in hints]
    values = {name: _parse(hints[name], data[name], f"{where}: {name}", problems) for name in hints if name in data}
    return kind(**values) if len(problems) == before else None


def _expected(hint: Any) -> str:
    """Return the name of a hint's type in JSON."""
    origin, arguments = get_origin(hint), get_args(hint)
    if origin is UnionType:
        return " or ".join(map(_expected, arguments))
    if origin is Literal:
        return _listed(arguments)
    return _TYPE_NAMES.get(hint) or ("a list" if origin is list else "an object")


def _listed(choices: Sequence[Any]) -> str:
    return f"one of {', '.join(map(str, choices))}" if len(choices) > 1 else str(choices[0])


def _shortened(data: Any) -> str:
    """Return a JSON value as text, shortened where it is long."""
    try:
        text = json.dumps(data, ensure_ascii=False)
    except RecursionError:  # nested almost too deep to be read
        return "too deep a nesting"
    return text if len(text) <= 40 else f"{text[:40]}…"
