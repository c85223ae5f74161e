"""Initial values: along the declared dependencies; loops are iterated, solved, or an error."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from cosim import RunError, System
from cosim.results.result import Result
from tests.helpers.wild import Var, Wild, par, var_in

pytestmark = pytest.mark.builds

H = 0.01
FMI = (2, 3)


def affine(factor: str, offset: str, depends: tuple[str, ...] | None = ("u",)) -> Wild:
    """Make y = factor * u + offset, whose input starts at 4."""
    output = Var("y", initial="calculated", depends=depends, initially=depends)
    return Wild([output, var_in("u", start="4")], calculate=f"m->y[0] = ({factor}) * m->u[0] + ({offset});")


def system_of(tmp_path: Path, models: dict[str, Wild], connections: dict[str, str], version: int) -> System:
    system = System()
    for name, model in models.items():
        (tmp_path / name).mkdir(exist_ok=True)
        system.add(name, model.build(tmp_path / name / f"{name}.fmu", version))
    for source, sink in connections.items():
        system.connect(source, sink)
    return system


def start_values(system: System, **options: object) -> dict[str, float]:
    result: Result = system.simulate(H, H, **options)  # type: ignore[arg-type]
    assert result.error is None, result.error
    return {name: float(values[0]) for name, values in result.values.items()}


@pytest.mark.parametrize("version", FMI)
@pytest.mark.parametrize("isolate", [False, True])
def test_an_input_keeps_its_start_value_until_its_source_is_known(tmp_path: Path, version: int, isolate: bool):
    """The FMU divides by its input whenever it changes: a zero that nobody gave would be an error."""
    divides = Wild(
        [Var("y", depends=("u",), initially=("u",), initial="calculated"), var_in("u", start="4")],
        calculate='if (m->u[0] == 0) return report(&m->run, ERROR, "division by zero"); m->y[0] = 1 / m->u[0];',
        assigned='if (m->u[0] == 0) return report(&m->run, ERROR, "division by zero");',
    )
    source = Wild([Var("v", start="8", initial="exact"), par("p")])
    for order in (["d", "s"], ["s", "d"]):
        system = system_of(tmp_path, {"d": divides, "s": source}, {"s.v": "d.u"}, version)
        system.order = order
        found = start_values(system, isolate=order if isolate else [])
        assert found == {"s.v": 8.0, "d.y": 0.125}


@pytest.mark.parametrize("version", FMI)
@pytest.mark.parametrize("count", [3, 9])
def test_a_chain_is_right_in_any_order(tmp_path: Path, version: int, count: int):
    """Each component adds 2: 6, 8, 10, ... after the first one, whatever the order of steps."""
    names = [f"c{i}" for i in range(count)]
    models = {name: affine("1", "2") for name in names}
    connections = {f"{a}.y": f"{b}.u" for a, b in pairwise(names)}
    for order in (names, names[::-1], names[1::2] + names[::2]):
        system = system_of(tmp_path, models, connections, version)
        system.order = order
        assert start_values(system) == {f"{name}.y": 6.0 + 2 * i for i, name in enumerate(names)}


@pytest.mark.parametrize("version", FMI)
def test_ping_pong_without_a_loop_settles(tmp_path: Path, version: int):
    """Two components with two channels each: values go to and fro between them, and no loop is declared."""
    channels = []
    for i in (1, 2):
        channels += [Var(f"y{i}", depends=(f"u{i}",), initially=(f"u{i}",), initial="calculated"), var_in(f"u{i}")]
    model = Wild(channels, calculate="m->y1[0] = m->u1[0] + 1; m->y2[0] = m->u2[0] + 2;")
    connections = {"a.y1": "b.u1", "b.y1": "a.u2", "a.y2": "b.u2"}
    system = system_of(tmp_path, {"a": model, "b": model}, connections, version)
    assert start_values(system) == {"a.y1": 1.0, "b.y1": 2.0, "a.y2": 4.0, "b.y2": 6.0}


@pytest.mark.parametrize("version", FMI)
def test_undeclared_dependencies_count_as_all(tmp_path: Path, version: int):
    models = {name: affine("1", "2", None) for name in "abcd"}
    system = system_of(tmp_path, models, {"a.y": "b.u", "b.y": "c.u", "c.y": "d.u"}, version)
    system.order = ["d", "b", "c", "a"]
    assert start_values(system) == {"a.y": 6.0, "b.y": 8.0, "c.y": 10.0, "d.y": 12.0}


@pytest.mark.parametrize(
    ("factors", "offsets", "solution"),
    [
        (("0.5", "0.5"), ("1", "1"), (2.0, 2.0)),  # contracts
        (("2", "1"), ("1", "0"), (-1.0, -1.0)),  # diverges as a fixed point: case 18
        (("-3", "2"), ("7", "0"), (1.0, 2.0)),  # oscillates and grows
        (("1", "-1"), ("1", "0"), (0.5, -0.5)),  # a cycle of period four
    ],
)
@pytest.mark.parametrize("version", FMI)
def test_linear_loops_are_solved(
    tmp_path: Path, version: int, factors: tuple[str, str], offsets: tuple[str, str], solution: tuple[float, float]
):
    models = {name: affine(f, o) for name, f, o in zip("ab", factors, offsets, strict=True)}
    system = system_of(tmp_path, models, {"a.y": "b.u", "b.y": "a.u"}, version)
    found = start_values(system)
    np.testing.assert_allclose([found["a.y"], found["b.y"]], solution, atol=1e-9)
    assert any("algebraic loop" in note for note in system.notes())


def test_a_loop_that_is_not_linear_is_solved(tmp_path: Path):
    """y = cos(u), z = 3 y: the fixed point of 3 cos is repulsive, and Newton's method finds one."""
    output = Var("y", depends=("u",), initially=("u",), initial="calculated")
    cosine = Wild([output, var_in("u", start="1")], calculate="m->y[0] = cos(m->u[0]);")
    system = system_of(tmp_path, {"a": cosine, "b": affine("3", "0")}, {"a.y": "b.u", "b.y": "a.u"}, 2)
    found = start_values(system)
    assert found["a.y"] == pytest.approx(np.cos(found["b.y"]), abs=1e-8)
    assert found["b.y"] == pytest.approx(3 * found["a.y"], abs=1e-8)


def test_a_loop_with_a_chain_behind_it_is_right(tmp_path: Path):
    models = {"a": affine("2", "1"), "b": affine("1", "0"), "c": affine("10", "0"), "d": affine("1", "1")}
    system = system_of(tmp_path, models, {"a.y": "b.u", "b.y": "a.u", "d.y": "c.u"}, 2)
    system.disconnect("c.u")
    system.connect("b.y", "c.u")
    found = start_values(system)
    assert found == pytest.approx({"a.y": -1.0, "b.y": -1.0, "c.y": -10.0, "d.y": 5.0}, abs=1e-8)


@pytest.mark.parametrize("version", FMI)
@pytest.mark.parametrize("isolate", [False, True])
def test_a_loop_without_a_solution_is_an_error_that_names_it(tmp_path: Path, version: int, isolate: bool):
    system = system_of(tmp_path, {"a": affine("1", "1"), "b": affine("1", "0")}, {"a.y": "b.u", "b.y": "a.u"}, version)
    with pytest.raises(RunError) as error:
        system.simulate(H, H, isolate=["a", "b"] if isolate else [])
    assert str(error.value) == (
        "initial exchange: expected the loop b.u -> b.y -> a.u -> a.y -> b.u to settle, "
        "got a.y = 103 and then 104, b.y = 103 and then 104"
    )


def test_a_loop_of_booleans_that_flips_is_an_error(tmp_path: Path):
    """Nothing to solve for: a Boolean that negates itself."""
    output = Var("y", "Boolean", depends=("u",), initially=("u",), variability="discrete", initial="calculated")
    negates = Wild([output, var_in("u", "Boolean", "0")], calculate="m->y[0] = !m->u[0];")
    keeps = Wild([output, var_in("u", "Boolean", "0")], calculate="m->y[0] = m->u[0];")
    system = system_of(tmp_path, {"a": negates, "b": keeps}, {"a.y": "b.u", "b.y": "a.u"}, 2)
    with pytest.raises(RunError, match=r"initial exchange: .*a\.y = . and then .") as error:
        system.simulate(H, H)
    assert "b.y" in str(error.value)


@pytest.mark.parametrize("version", FMI)
def test_an_algebraic_loop_is_reported_and_a_delayed_one_is_not(tmp_path: Path, version: int):
    state = Wild(
        [Var("y", start="1", depends=(), initial="exact"), var_in("u", start="0")], advance="m->y[0] += h * m->u[0];"
    )
    direct = system_of(
        tmp_path, {"a": affine("0.5", "1"), "b": affine("0.5", "0")}, {"a.y": "b.u", "b.y": "a.u"}, version
    )
    assert [n for n in direct.notes() if n.startswith("algebraic loop")]
    delayed = system_of(tmp_path, {"a": affine("0.5", "1"), "s": state}, {"a.y": "s.u", "s.y": "a.u"}, version)
    assert not [n for n in delayed.notes() if n.startswith("algebraic loop")]


@pytest.mark.parametrize("version", FMI)
def test_a_stored_run_starts_again_from_the_same_values(tmp_path: Path, version: int):
    """A second run of a session does not start from the values of the first."""
    system = system_of(tmp_path, {"a": affine("2", "1"), "b": affine("1", "0")}, {"a.y": "b.u", "b.y": "a.u"}, version)
    with system.open() as session:
        first, second = (session.run(H, H) for _ in range(2))
    assert all((first[name] == second[name]).all() for name in first.values)
