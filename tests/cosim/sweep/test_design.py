"""Designs of experiments: their points, by definitions that the code does not share."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from cosim.errors import SetupError
from cosim.sweep.design import Block, Design, Range, Values, Variable


def variables(**domains: Values | Range) -> dict[str, Variable]:
    return {name: Variable(domain) for name, domain in domains.items()}


def points(*blocks: Block) -> list[dict[str, object]]:
    design = Design(blocks)
    return design.points(range(design.runs))


def test_a_grid_has_all_combinations_and_its_last_variable_varies_fastest():
    found = points(Block(variables(a=Values((1.0, 2.0)), b=Values(("x", "y", "z")), c=Values((True, False)))))
    expected = itertools.product((1.0, 2.0), "xyz", (True, False))
    assert found == [dict(zip("abc", values, strict=True)) for values in expected]


def test_a_list_takes_values_side_by_side():
    assert points(Block(variables(a=Values((1.0, 2.0)), b=Values(("x", "x"))), "list")) == [
        {"a": 1.0, "b": "x"},
        {"a": 2.0, "b": "x"},
    ]


def test_blocks_are_multiplied_and_the_first_varies_slowest():
    first = Block(variables(a=Values((1.0, 2.0))))
    second = Block(variables(b=Values((5, 6)), c=Values(("x", "y"))), "list")
    assert [tuple(point.values()) for point in points(first, second)] == [
        (1.0, 5, "x"), (1.0, 6, "y"), (2.0, 5, "x"), (2.0, 6, "y"),
    ]  # fmt: skip


def test_samples_are_taken_as_they_are():
    samples = ({"a": 1.0, "b": "x"}, {"a": 1.0, "b": "y"})
    domains = variables(a=Values((1.0,)), b=Values(("x", "y")))
    assert points(Block(domains, "samples", samples=samples)) == list(samples)


def test_a_latin_hypercube_has_one_point_in_each_slice_of_each_variable():
    n = 50
    found = points(Block(variables(a=Range(2.0, 3.0), b=Range(0.01, 100.0, "log")), "latin-hypercube", n, seed=3))
    a = np.floor(n * (np.array([point["a"] for point in found]) - 2.0))
    b = np.floor(n * (np.log10([point["b"] for point in found]) + 2.0) / 4.0)
    assert sorted(a) == sorted(b) == list(range(n))


def test_a_sobol_sequence_is_balanced_in_each_half_and_quarter():
    found = points(Block(variables(a=Range(0.0, 1.0), b=Range(0.0, 1.0)), "sobol", 64, seed=5))
    cells = [(math.floor(4 * point["a"]), math.floor(4 * point["b"])) for point in found]
    assert {cells.count(cell) for cell in itertools.product(range(4), repeat=2)} == {4}


def test_whole_numbers_and_items_have_equal_shares():
    domains = variables(seed=Range(1.0, 5.0, integer=True), mode=Values(("a", "b")))
    found = points(Block(domains, "latin-hypercube", 100))
    assert all(type(point["seed"]) is int for point in found)
    assert [[point["seed"] for point in found].count(k) for k in range(1, 6)] == [20] * 5
    assert [[point["mode"] for point in found].count(item) for item in "ab"] == [50, 50]


@pytest.mark.parametrize("kind", ["latin-hypercube", "sobol"])
def test_a_seed_repeats_a_design_and_another_one_changes_it(kind: str):
    first, same, other = (points(Block(variables(a=Range(0.0, 1.0)), kind, 16, seed)) for seed in (1, 1, 2))
    assert first == same != other


def test_a_point_does_not_depend_on_which_others_are_asked_for():
    block = Block(variables(a=Range(0.0, 1.0)), "latin-hypercube", 20)
    assert Design((block,)).point(7) == Design((Block(block.variables, block.design, block.n),)).points(range(20))[7]


@pytest.mark.parametrize(
    ("block", "message"),
    [
        (lambda: Values(()), "values: expected at least one, got none"),
        (lambda: Block(variables(a=Values((1.0, 1.0)))), "a: expected each value once, got 1.0, 1.0"),
        (lambda: Range(2.0, 1.0), "range: expected finite low < high, got 2.0 and 1.0"),
        (lambda: Range(0.0, 1.0, "log"), "range: expected low above 0 for scale log, got 0.0 and 1.0"),
        (lambda: Range(0.5, 2.0, integer=True), "range: expected whole numbers, got 0.5 and 2.0"),
        (lambda: Block(variables(a=Range(0.0, 1.0)), "sobol", 1000), "n: expected a power of two, such as 512 or 1024"),
        (lambda: Block(variables(a=Range(0.0, 1.0)), "sobol"), "n: expected the number of points"),
        (lambda: Block(variables(a=Range(0.0, 1.0))), "a: expected a list of values"),
        (lambda: Block(variables(a=Values((1,))), "gird"), "did you mean grid?"),
        (lambda: Block(variables(a=Values((1,))), n=3), "n: expected with design latin-hypercube or sobol"),
        (lambda: Block(variables(a=Values((1,)), b=Values((1, 2))), "list"), "expected lists of one length, got 1, 2"),
        (
            lambda: Block(variables(a=Values((1,)), b=Values((2,))), "samples", samples=({"a": 1},)),
            "samples, number 1: expected values of a, b, got a",
        ),
        (lambda: Design((Block(variables(a=Values((1,)))),) * 2), "a: expected in one block, got in several"),
    ],
)
def test_a_design_that_makes_no_sense_is_refused(block: object, message: str):
    with pytest.raises(SetupError) as error:
        block()
    assert message in str(error.value)
