"""Orders of exchange: proposed from what is sampled and what is continuous, and the delays that come of them."""

from __future__ import annotations

from itertools import permutations

import pytest

from cosim import System
from cosim.engine.step_order import Edge, delay, propose

LOOP = [
    Edge("shaker", "seat", sampled=False),
    Edge("controller", "seat", sampled=True),
    Edge("seat", "controller", sampled=False),
]


@pytest.mark.parametrize("names", list(permutations(["shaker", "seat", "controller"])))
def test_a_sampler_goes_first_and_what_is_continuous_after_those_it_feeds(names):
    order, broken = propose(names, LOOP)
    assert order == ("controller", "seat", "shaker")
    assert broken == []
    assert [delay(edge, order, jacobi=False) for edge in LOOP] == [0, 0, 0]


def test_every_other_order_shifts_a_value_in_time():
    for order in permutations(["shaker", "seat", "controller"]):
        delays = [delay(edge, order, jacobi=False) for edge in LOOP]
        assert (delays == [0, 0, 0]) == (order == ("controller", "seat", "shaker"))


def test_an_exchange_of_all_at_once_delays_what_is_sampled():
    assert [delay(edge, ("shaker", "seat", "controller"), jacobi=True) for edge in LOOP] == [0, 1, 0]


def test_a_loop_that_has_no_order_is_broken_at_one_place():
    order, broken = propose(["a", "b"], [Edge("a", "b", False), Edge("b", "a", False)])
    assert order == ("a", "b")
    assert broken == [Edge("a", "b", False)]
    assert delay(broken[0], order, jacobi=False) == -1


def test_a_component_that_feeds_itself_waits_for_nobody():
    assert propose(["a", "b"], [Edge("a", "a", False), Edge("b", "a", True)]) == (("b", "a"), [])


def test_the_suspension_gets_its_order_from_its_connections(system: System):
    unordered = System()
    for name in ("shaker", "seat", "controller"):
        unordered.add(name, system.models[name].path)
    for sink, feed in system.connections.items():
        unordered.connect(str(feed.source), str(sink))
    assert unordered.order == system.order == ("controller", "seat", "shaker")
