"""Types of variables in FMI 2.0 and 3.0, for the master and for the conformance suite."""

from __future__ import annotations

KINDS = {
    **dict.fromkeys(("Real", "Float32", "Float64"), "Real"),
    **dict.fromkeys(("Integer", *(f"{sign}Int{bits}" for sign in ("", "U") for bits in (8, 16, 32, 64))), "Integer"),
    **{kind: kind for kind in ("Enumeration", "Boolean", "String", "Binary", "Clock")},
}
"""Type of a variable, in FMI 2 or 3, to the kind of its values."""

NUMERIC = ("Real", "Integer", "Enumeration", "Boolean")
"""Kinds of values that fit into a table of numbers."""

FLOATS = tuple(name for name, kind in KINDS.items() if kind == "Real")
"""Types of floating-point numbers."""

INTEGERS = tuple(name for name, kind in KINDS.items() if kind == "Integer")
"""Types of integers, without enumerations."""
