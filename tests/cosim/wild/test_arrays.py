"""Arrays of FMI 3: outputs, inputs and parameters by element or whole, structural parameters, both loops, isolated."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from cosim import RunError, SetupError, System
from cosim.engine.run_options import RunOptions
from cosim.rerun import rerun
from cosim.results.result import Result, StepperName
from cosim.run_folder import run_to_folder
from cosim.units import Linear
from tests.helpers.files import edited
from tests.helpers.hosts import HOSTS
from tests.helpers.wild import C_TYPES, Var, Wild, par, var_in

pytestmark = pytest.mark.builds

H = 0.01
INTEGERS = [name for name in C_TYPES if "Int" in name and name != "Integer"]
NUMBERS = ["Real", "Float32", *INTEGERS, "Boolean"]

SOURCE = Wild(
    [
        Var("before", start="0"),
        Var("y", shape=(3,), start="0"),
        Var("between", start="0"),
        Var("A", shape=(2, 2), start="0"),
        Var("after", start="0"),
    ],
    calculate="""
        m->before[0] = 1 + m->run.time; m->between[0] = 2 + m->run.time; m->after[0] = 3 + m->run.time;
        for (int i = 0; i < 3; ++i) m->y[i] = 10 * (i + 1) + m->run.time;
        for (int i = 0; i < 4; ++i) m->A[i] = 100 * (i + 1) + m->run.time;
    """,
)

SUM = Wild(
    [var_in("u", shape=(3,), start="7"), var_in("s"), Var("total", start="0"), Var("first", start="0")],
    calculate="m->total[0] = m->u[0] + 2 * m->u[1] + 4 * m->u[2] + 1000 * m->s[0]; m->first[0] = m->u[0];",
)

STATE_SPACE = Wild(
    [
        *(
            Var(name, "UInt64", "structuralParameter", start, "fixed")
            for name, start in (("m", "3"), ("n", "2"), ("r", "3"))
        ),
        *(
            par(name, shape=shape, start="0")
            for name, shape in (("A", ("n", "n")), ("B", ("n", "m")), ("C", ("r", "n")), ("D", ("r", "m")))
        ),
        par("x0", shape=("n",), start="0"),
        var_in("u", shape=("m",), start="0"),
        Var("x", causality="local", shape=("n",), start="0"),
        Var("y", shape=("r",), initial="calculated", start=None),
    ],
    top="#define N(q) ((int)m->q[0])",
    enter="for (int i = 0; i < N(n); ++i) m->x[i] = m->x0[i];",
    calculate="""
        for (int i = 0; i < N(r); ++i) {
            m->y[i] = 0;
            for (int k = 0; k < N(n); ++k) m->y[i] += m->C[i * N(n) + k] * m->x[k];
            for (int k = 0; k < N(m); ++k) m->y[i] += m->D[i * N(m) + k] * m->u[k];
        }
    """,
    advance="""
        double d[64];
        for (int i = 0; i < N(n); ++i) {
            d[i] = 0;
            for (int k = 0; k < N(n); ++k) d[i] += m->A[i * N(n) + k] * m->x[k];
            for (int k = 0; k < N(m); ++k) d[i] += m->B[i * N(m) + k] * m->u[k];
        }
        for (int i = 0; i < N(n); ++i) m->x[i] += h * d[i];
    """,
)
"""x' = A x + B u by Euler's method, y = C x + D u, with sizes m, n, r, as the StateSpace of the Reference-FMUs."""


@pytest.fixture(scope="module")
def wild(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("arrays")
    models = {"source": SOURCE, "sum": SUM, "state_space": STATE_SPACE}
    return {name: model.build(folder / f"{name}.fmu", 3) for name, model in models.items()}


def make(fmus: dict[str, Path], *names: str) -> System:
    system = System()
    for name in names:
        system.add(name, fmus[name])
    return system


def run(system: System, host: tuple[StepperName, bool], **options: object) -> Result:
    stepper, isolated = host
    isolate = list(system.models) if isolated else []
    return system.simulate(0.05, H, stepper=stepper, isolate=isolate, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize("host", HOSTS)
def test_elements_are_recorded_by_rows_and_neighbours_keep_their_values(
    wild: dict[str, Path], host: tuple[StepperName, bool]
):
    result = run(make(wild, "source"), host)
    assert list(result.values) == [
        f"source.{n}"
        for n in ("before", "y[1]", "y[2]", "y[3]", "between", "A[1,1]", "A[1,2]", "A[2,1]", "A[2,2]", "after")
    ]
    for name, offset in (("before", 1), ("y[2]", 20), ("between", 2), ("A[1,2]", 200), ("A[2,1]", 300), ("after", 3)):
        np.testing.assert_allclose(result[f"source.{name}"], offset + result.time, rtol=1e-14)


@pytest.mark.parametrize("host", HOSTS)
def test_whole_arrays_and_elements_are_connected(wild: dict[str, Path], host: tuple[StepperName, bool]):
    system = make(wild, "source", "sum")
    system.connect("source.y", "sum.u")
    system.connect("source.A[2,1]", "sum.s", Linear(0.5))
    system.order = ["source", "sum"]
    result = run(system, host)
    t = result.time
    expected = (10 + t) + 2 * (20 + t) + 4 * (30 + t) + 500 * (300 + t)
    np.testing.assert_allclose(result["sum.total"], expected, rtol=1e-14)


@pytest.mark.parametrize("host", HOSTS)
def test_elements_without_a_connection_keep_their_start_values_and_are_reported(
    wild: dict[str, Path], host: tuple[StepperName, bool]
):
    system = make(wild, "source", "sum")
    system.connect("source.A[1,2]", "sum.u[2]")
    system.order = ["source", "sum"]
    result = run(system, host, parameters={"sum.u[3]": 5.0})
    np.testing.assert_allclose(result["sum.total"], 7 + 2 * (200 + result.time) + 4 * 5, rtol=1e-14)
    assert "sum.u[1]: not connected and not set, unlike other elements of the array" in result.warnings
    assert not any("u[3]" in text for text in result.warnings)


@pytest.mark.parametrize(
    ("connections", "problem"),
    [
        ([("source.y", "sum.s")], r"expected the shape of the input, a scalar, got 3"),
        ([("source.before", "sum.u")], r"expected the shape of the input, 3, got a scalar"),
        ([("source.A", "sum.u")], r"expected the shape of the input, 3, got 2 x 2"),
        ([("source.y[4]", "sum.s")], r"source.y\[4\]: expected an element of y, which has 3 elements"),
        ([("source.A[2]", "sum.s")], r"source.A\[2\]: expected an element of A, which has 2 x 2 elements"),
        ([("source.y", "sum.u"), ("source.before", "sum.u[2]")], r"sum.u.*free|fed|feeds"),
        ([("source.before", "sum.u[2]"), ("source.y", "sum.u")], r"sum.u.*free|fed|feeds"),
    ],
)
def test_shapes_that_differ_are_refused(wild: dict[str, Path], connections: list[tuple[str, str]], problem: str):
    system = make(wild, "source", "sum")
    *before, last = connections
    for source, sink in before:
        system.connect(source, sink)
    with pytest.raises(SetupError, match=problem):
        system.connect(*last)


MATRICES = {"A": [[0.0, 1.0], [-4.0, -0.5]], "B": [[1.0, 0.0, 0.5], [0.0, 2.0, 0.0]],
            "C": [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0]], "D": [[0.0] * 3, [0.0, 0.1, 0.0], [0.0] * 3]}  # fmt: skip


def golden(matrices: dict[str, object], x: list[float], u: list[float], steps: int) -> np.ndarray:
    A, B, C, D = (np.array(matrices[name], dtype=float) for name in "ABCD")
    state, rows = np.array(x), []
    for _ in range(steps + 1):
        rows.append(C @ state + D @ np.array(u))
        state = state + H * (A @ state + B @ np.array(u))
    return np.array(rows)


def as_text(matrix: list[list[float]]) -> str:
    return "; ".join(" ".join(map(str, row)) for row in matrix)


def by_element(name: str, matrix: list[list[float]]) -> dict[str, float]:
    return {f"{name}[{i},{k}]": v for i, row in enumerate(matrix, 1) for k, v in enumerate(row, 1)}


@pytest.mark.parametrize("host", HOSTS)
@pytest.mark.parametrize("form", ["nested", "flat", "text", "by element"])
def test_a_state_space_has_the_values_of_its_equations(
    wild: dict[str, Path], host: tuple[StepperName, bool], form: str
):
    given: dict[str, object] = {"x0": [1.0, -1.0], "u": [0.3, 0.2, -0.1]}
    for name, matrix in MATRICES.items():
        if form == "by element":
            given |= by_element(name, matrix)
        else:
            flat = [v for row in matrix for v in row]
            given[name] = {"nested": matrix, "flat": flat, "text": as_text(matrix)}[form]
    result = run(make(wild, "state_space"), host, parameters={f"state_space.{k}": v for k, v in given.items()})
    found = np.column_stack([result[f"state_space.y[{i}]"] for i in (1, 2, 3)])
    np.testing.assert_allclose(found, golden(MATRICES, [1.0, -1.0], [0.3, 0.2, -0.1], 5), rtol=1e-13)


@pytest.mark.parametrize("host", HOSTS)
def test_structural_parameters_change_the_sizes(wild: dict[str, Path], host: tuple[StepperName, bool]):
    sizes = {"m": 1, "n": 4, "r": 2}
    rng = np.random.default_rng(1)
    matrices = {name: rng.normal(size=shape).tolist() for name, shape in
                {"A": (4, 4), "B": (4, 1), "C": (2, 4), "D": (2, 1)}.items()}  # fmt: skip
    given = {**sizes, **matrices, "x0": [1.0, 2.0, 3.0, 4.0], "u": [0.5]}
    system = make(wild, "state_space")
    with system.open(isolate=list(system.models) if host[1] else []) as session:
        for _ in range(2):  # a second run of a session changes sizes back and forth
            result = session.run(0.05, H, {f"state_space.{k}": v for k, v in given.items()}, stepper=host[0])
            assert list(result.values) == ["state_space.y[1]", "state_space.y[2]"]
            found = np.column_stack(list(result.values.values()))
            np.testing.assert_allclose(found, golden(matrices, [1.0, 2.0, 3.0, 4.0], [0.5], 5), rtol=1e-13)
            assert len(session.run(0.05, H, stepper=host[0]).values) == 3


@pytest.mark.parametrize(
    ("parameter", "value", "problem"),
    [
        ("A", [1.0, 2.0], "expected 2 x 2 values, got 2"),
        ("A", [[1.0, 2.0, 3.0, 4.0]], "expected 2 x 2 values, got 1 x 4"),
        ("A", [[1.0, 2.0], [3.0]], "expected 2 x 2 values, got rows of different lengths"),
        ("A", "1 2 3", "expected 2 x 2 values, got 3"),
        ("A[3,1]", 1.0, "expected an element of A, which has 2 x 2 elements"),
        ("A[1,1]", "much", "expected a number, got much"),
        ("A[1,1]", [1.0, 2.0], "expected 1 values, got 2"),
        ("n", 2.5, "expected a whole number, got 2.5"),
        ("n", -1, "n: expected .*got -1"),
        ("n", 10**9, "expected at most 1000000 elements of all variables together"),
        ("n", [1, 2], "expected one value, got"),
        ("y", [1.0, 2.0, 3.0], "expected a parameter or an input, got an output"),
    ],
)
def test_values_that_do_not_fit_are_refused(wild: dict[str, Path], parameter: str, value: object, problem: str):
    with pytest.raises(SetupError, match=problem) as error:
        make(wild, "state_space").validate(0.05, H, {f"state_space.{parameter}": value})
    assert "state_space" in str(error.value)


@pytest.mark.parametrize("host", HOSTS)
def test_arrays_of_all_types_pass_through(tmp_path: Path, host: tuple[StepperName, bool]):
    """A source of each type feeds a feedthrough of the same type; largest values stay exact."""
    variables, lines, starts = [], [], {}
    for type_ in NUMBERS:
        low = type_.lower()
        variables += [var_in(f"{low}_in", type_, shape=(2, 2), start=None if type_ == "Boolean" else "0")]
        variables += [Var(f"{low}_out", type_, shape=(2, 2), variability=None if "oat" in low or low == "real"
                          else "discrete")]  # fmt: skip
        lines.append(f"for (int i = 0; i < 4; ++i) m->{low}_out[i] = m->{low}_in[i];")
        starts[low] = values_of(type_)
    model = Wild(variables, calculate=" ".join(lines))
    fmu = model.build(tmp_path / "feed.fmu", 3)
    system = System()
    system.add("first", fmu)
    system.add("second", fmu)
    for low in starts:
        system.connect(f"first.{low}_out", f"second.{low}_in")
    result = run(system, host, parameters={f"first.{low}_in": values for low, values in starts.items()})
    for low, values in starts.items():
        found = [result[f"second.{low}_out[{i},{k}]"][-1] for i in (1, 2) for k in (1, 2)]
        assert found == [float(v) for v in values], low


def values_of(type_: str) -> list[float]:
    """Return four values of a type, its smallest and largest among them as far as a double has them."""
    if type_ in ("Real", "Float32"):
        return [-1.5, 0.25, 3.0, 65536.0]
    if type_ == "Boolean":
        return [True, False, False, True]
    bits = min(int(type_.removeprefix("U").removeprefix("Int")), 53)
    return [0, 2**bits - 1, 1, 2] if type_.startswith("U") else [-(2 ** (bits - 1)), 2 ** (bits - 1) - 1, 0, -1]


def test_elements_of_arrays_are_in_all_files_and_a_rerun_repeats_them(wild: dict[str, Path], tmp_path: Path):
    pytest.importorskip("pyarrow")
    pytest.importorskip("asammdf")
    system = make(wild, "state_space")
    parameters = {f"state_space.{k}": v for k, v in {**MATRICES, "x0": [1.0, -1.0], "u": [0.3, 0.2, -0.1]}.items()}
    options = RunOptions(0.05, H, parameters, formats=["parquet", "mdf4"])
    result = run_to_folder(system, tmp_path / "run", options)
    for suffix in (".csv", ".parquet", ".mf4"):
        read = Result.read(tmp_path / "run" / f"result{suffix}")
        assert list(read.values) == list(result.values)
        assert all((read[name] == result[name]).all() for name in result.values)
    given = json.loads((tmp_path / "run" / "run.json").read_text())["parameters"]
    assert given["state_space.A[2,1]"] == -4.0
    rerun(tmp_path / "run" / "run.json", tmp_path / "again", lambda time, stop_time: None)
    assert (tmp_path / "again" / "result.csv").read_bytes() == (tmp_path / "run" / "result.csv").read_bytes()


def test_an_output_larger_than_the_host_believes_is_an_error_not_a_crash(tmp_path: Path):
    """The description says three elements, the FMU has ten: each host passes the number of values."""
    fmu = Wild([Var("y", shape=(10,), start="0")]).build(tmp_path / "ten.fmu", 3)
    believing = edited(fmu, tmp_path / "believing.fmu", ('<Dimension start="10"/>', '<Dimension start="3"/>'))
    system = System()
    system.add("a", believing)
    with pytest.raises(RunError, match=r"a: fmi3GetFloat64 failed .*wrong reference 1 or number of values 3"):
        system.simulate(0.05, H)
