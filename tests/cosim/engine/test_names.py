"""Names in texts of users: an exact name wins over the grammar, double quotes protect a name."""

from __future__ import annotations

import pytest

from cosim import SetupError
from cosim.engine.names import parse_source, split_assignment, split_connection, unquoted
from cosim.units import IDENTITY, Linear

KNOWN = {"cab.z", "cab.z-1", "2*cab.z", "cab.a=b", "seat.x=y", "cab.der(z,2)", 'q"x.y', '"q".y'}


def is_known(name: str) -> bool:
    return name in KNOWN


@pytest.mark.parametrize(
    ("text", "output", "transformation"),
    [
        ("cab.z", "cab.z", IDENTITY),
        ("0.001*cab.z", "cab.z", Linear(0.001)),
        ("-1 * cab.body.z + 0.5", "cab.body.z", Linear(-1.0, 0.5)),
        ("1e-3*e", "e", Linear(0.001)),
        ("cab.z-.5e2", "cab.z", Linear(1.0, -50.0)),
        ("cab.der(z,2)", "cab.der(z,2)", IDENTITY),
        ("cab.z-1", "cab.z-1", IDENTITY),
        ("2*cab.z", "2*cab.z", IDENTITY),
        (' "cab.z-2" ', "cab.z-2", IDENTITY),
        ('3 * "cab.z-1" - 4', "cab.z-1", Linear(3.0, -4.0)),
        ('"3*x"', "3*x", IDENTITY),
        ("2*cab.z-1", "cab.z-1", Linear(2.0)),
        ("2*cab.z - 2", "cab.z", Linear(2.0, -2.0)),
        ("4*2*cab.z", "2*cab.z", Linear(4.0)),
        ('5*q"x.y-1', 'q"x.y', Linear(5.0, -1.0)),
        ('5*"q".y', '"q".y', Linear(5.0)),
    ],
)
def test_sources_with_transformations(text: str, output: str, transformation: Linear):
    assert parse_source(text, is_known) == (output, transformation)


@pytest.mark.parametrize("text", [" ", '"', '""', '2*"cab.z', '"cab.z" cab.z'])
def test_sources_without_a_name_are_refused(text: str):
    with pytest.raises(SetupError, match=r"expected COMPONENT.OUTPUT, or FACTOR\*COMPONENT.OUTPUT\+OFFSET"):
        parse_source(text, is_known)


@pytest.mark.parametrize(
    ("text", "split"),
    [
        ("cab.z=1", ("cab.z", "1")),
        ("cab.q=a=b", ("cab.q", "a=b")),
        ("cab.a=b=3", ("cab.a=b", "3")),
        ('"cab.q=r" = 3', ("cab.q=r", "3")),
        ("cab.z=", ("cab.z", "")),
        ('"q".y="a"', ('"q".y', '"a"')),
        ("nothing", ("", "")),
    ],
)
def test_assignments(text: str, split: tuple[str, str]):
    assert split_assignment(text, is_known) == split


@pytest.mark.parametrize(
    ("text", "split"),
    [
        ("cab.z=seat.f", ("cab.z", "seat.f")),
        ("cab.a=b=seat.f", ("cab.a=b", "seat.f")),
        ("cab.a=b=seat.x=y", ("cab.a=b", "seat.x=y")),
        ('2*"cab.a=b"="seat.q=r"', ('2*"cab.a=b"', "seat.q=r")),
        ("cab.z", ("", "")),
    ],
)
def test_connections(text: str, split: tuple[str, str]):
    assert split_connection(text, is_known) == split


def test_quotes_are_removed_in_pairs():
    assert [unquoted(text) for text in (' "a b" ', '"a', "a")] == ["a b", '"a', "a"]
