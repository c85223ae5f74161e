"""Dataclasses as JSON, and back with every problem said: their type hints are the only description of the file."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import MISSING, asdict, fields, is_dataclass
from types import NoneType, UnionType
from typing import Any, Literal, TypeVar, get_args, get_origin, get_type_hints

from cosim.errors import SetupError, did_you_mean

T = TypeVar("T")

_WORDS = {float: "a number", int: "a whole number", str: "a text", bool: "true or false", NoneType: "null"}


def dump(data: Any) -> str:
    """Write a dataclass as JSON, fields in their order; equal data give equal bytes, and numbers read back exactly."""
    return json.dumps(asdict(data), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def load(kind: type[T], text: str, where: str) -> T:
    """Read a dataclass from JSON.

    Parameters
    ----------
    kind
        A dataclass of plain values, ``Literal``, lists, dicts by name, unions of these, and further such dataclasses.
    text
        What :func:`dump` wrote.
    where
        Name of the file, for messages.

    Raises
    ------
    SetupError
        With all problems: no JSON, missing and unknown keys, values of another type.
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
    """Convert a JSON value to what a type hint asks for; what does not fit is added to the problems."""
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
    problems.append(f"{where}: expected {_expected(hint)}, got {_shown(data)}")
    return None


def _parse_fields(kind: Any, data: dict[str, Any], where: str, problems: list[str]) -> Any:
    """Convert an object to a dataclass; None if keys or values do not fit."""
    hints = get_type_hints(kind)
    needed = [f.name for f in fields(kind) if f.default is MISSING and f.default_factory is MISSING]
    before = len(problems)
    problems += [f"{where}: expected a key {name}, got none" for name in needed if name not in data]
    problems += [f"{where}: unknown key {name}{did_you_mean(name, hints)}" for name in data if name not in hints]
    values = {name: _parse(hints[name], data[name], f"{where}: {name}", problems) for name in hints if name in data}
    return kind(**values) if len(problems) == before else None


def _expected(hint: Any) -> str:
    """Say what a type hint asks for."""
    origin, arguments = get_origin(hint), get_args(hint)
    if origin is UnionType:
        return " or ".join(map(_expected, arguments))
    if origin is Literal:
        return _listed(arguments)
    return _WORDS.get(hint) or ("a list" if origin is list else "an object")


def _listed(choices: Sequence[Any]) -> str:
    return f"one of {', '.join(map(str, choices))}" if len(choices) > 1 else str(choices[0])


def _shown(data: Any) -> str:
    """Show a JSON value, a long one by its beginning."""
    try:
        text = json.dumps(data, ensure_ascii=False)
    except RecursionError:  # nested a little less deep than can be read
        return "too deep a nesting"
    return text if len(text) <= 40 else f"{text[:40]}…"
