"""Arrays of FMI 3 in SSP files: elements as connectors and parameters, whole arrays connected, sizes by parameters."""

from __future__ import annotations

from pathlib import Path

import pytest

from cosim import SetupError, System
from cosim.ssp import read_parameters
from cosim.ssp.write import parameter_set as written_set
from tests.helpers.ssd_text import bindings, component, connection, connectors, document, load, system, value
from tests.helpers.wild import Var, Wild, par, var_in

pytestmark = pytest.mark.builds

SUM = (
    "for (int i = 0; i < 4; ++i) m->y[i] = m->K[i] * m->u[i]; "
    "for (size_t i = 0; i < (size_t)m->n[0]; ++i) m->z[i] = m->v[i] + m->w[i];"
)


@pytest.fixture(scope="module")
def arrays(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An FMU with matrices of 2 x 2, y = K * u element by element, and vectors of n, z = v + w."""
    variables = [
        Var("n", "UInt64", "structuralParameter", "2", "fixed"),
        var_in("u", shape=(2, 2)), par("K", start="1 2 3 4", shape=(2, 2)), Var("y", shape=(2, 2)),
        var_in("v", shape=("n",)), par("w", start="0", shape=("n",)), Var("z", shape=("n",)),
        var_in("x"), Var("x[1]"),
    ]  # fmt: skip
    fmu = Wild(variables, f"{SUM} m->x_1_[0] = 10 * m->x[0];", experiment='stopTime="1" stepSize="0.1"')
    return fmu.build(tmp_path_factory.mktemp("arrays") / "Arrays.fmu", 3)


def part(name: str, inside: str = "") -> str:
    return component(name, "Arrays.fmu", inside)


def last(loaded: System, *names: str) -> list[float]:
    result = loaded.simulate()
    return [result[name][-1] for name in names]


def test_elements_are_connectors_and_parameters(arrays: Path, tmp_path: Path):
    inside = connectors(**{"y[2,1]": "output Real", "u[1,2]": "input Real", "z[2]": "output Real"})
    given = bindings(value("K[2,1]", 5.0), value("u[2,1]", 3.0), value("w[2]", 7.0))
    elements = (part("a", inside + given), part("b", bindings(value("u[1,1]", 11.0))))
    joins = connection(("a", "y[2,1]"), ("b", "u[1,2]")) + connection(("a", "z[2]"), ("b", "v[1]"))
    loaded = load(tmp_path, document(*elements, joins=joins), arrays)
    assert loaded.parameters == {"a.K[2,1]": 5.0, "a.u[2,1]": 3.0, "a.w[2]": 7.0, "b.u[1,1]": 11.0}
    names = ("a.y[1,1]", "a.y[2,1]", "b.y[1,1]", "b.y[1,2]", "b.y[2,2]", "b.z[1]")
    expected = [0.0, 15.0, 11.0, 30.0, 0.0, 7.0]
    assert last(loaded, *names) == expected
    assert last(loaded, "b.y[1,2]") == [30.0]
    loaded.save(tmp_path / "again.ssp")
    again = System.load(tmp_path / "again.ssp")
    assert (again.connections, again.parameters) == (loaded.connections, loaded.parameters)
    assert last(again, *names) == expected
    again.save(tmp_path / "more.ssp")
    assert (tmp_path / "more.ssp").read_bytes() == (tmp_path / "again.ssp").read_bytes()


def test_whole_arrays_are_connected_through_systems(arrays: Path, tmp_path: Path):
    inner = system("s", part("b"), inside=connectors(u="input Real", y="output Real"),
                   joins=connection(("", "u"), ("b", "u")) + connection(("b", "y"), ("", "y")))  # fmt: skip
    first = part("a", bindings(*(value(f"u[{i},{j}]", 1.0) for i in (1, 2) for j in (1, 2))))
    joins = connection(("a", "y"), ("s", "u"), '<ssc:LinearTransformation factor="2"/>')
    joins += connection(("s", "y"), ("c", "u"))
    loaded = load(tmp_path, document(first, inner, part("c"), joins=joins), arrays)
    names = [f"c.y[{i},{j}]" for i in (1, 2) for j in (1, 2)]
    assert last(loaded, *names) == [2.0 * k**3 for k in (1, 2, 3, 4)]
    loaded.save(tmp_path / "again.ssp")
    again = System.load(tmp_path / "again.ssp")
    assert again.connections == loaded.connections
    assert last(again, *names) == [2.0 * k**3 for k in (1, 2, 3, 4)]


def test_parameters_of_the_file_give_the_sizes(arrays: Path, tmp_path: Path):
    sized = bindings(value("w[3]", 5.0), value("n", 3, "Integer"))
    joins = connection(("a", "z[3]"), ("b", "v[3]"))
    loaded = load(tmp_path, document(part("a", sized), part("b", sized), joins=joins), arrays)
    assert loaded.parameters == {"a.n": 3, "b.n": 3, "a.w[3]": 5.0, "b.w[3]": 5.0}
    assert last(loaded, "b.z[3]") == [10.0]
    loaded.save(tmp_path / "again.ssp")
    assert last(System.load(tmp_path / "again.ssp"), "b.z[3]") == [10.0]
    whole = connection(("a", "z"), ("b", "v"))
    assert last(load(tmp_path, document(part("a", sized), part("b", sized), joins=whole), arrays), "b.z[3]") == [10.0]
    with pytest.raises(SetupError, match="connection a.z -> b.v: expected the shape of the input, 2, got 3"):
        load(tmp_path, document(part("a", sized), part("b"), joins=whole), arrays)


def test_whole_arrays_given_in_python_are_written_by_element(arrays: Path, tmp_path: Path):
    made = System()
    made.add("a", arrays)
    made.parameters = {"a.n": 3, "a.K": [[1.0, 2.0], [3.0, 4.5]], "a.w": [0.1, 0.2, 0.3], "a.u": 2.0 * 1, "a.v[3]": 1.0}
    made.parameters["a.u"] = [[2.0, 2.0], [2.0, 2.0]]
    expected = last(made, "a.y[2,2]", "a.z[3]")
    assert expected == [9.0, 1.3]
    made.save(tmp_path / "it.ssp")
    loaded = System.load(tmp_path / "it.ssp")
    assert loaded.parameters["a.K[2,2]"] == 4.5
    assert last(loaded, "a.y[2,2]", "a.z[3]") == expected


def test_parameter_files_of_a_run_hold_arrays_by_element(arrays: Path, tmp_path: Path):
    made = System()
    made.add("a", arrays)
    given = {"a.w": [1.0, 2.0, 3.0], "a.K[1,2]": 7.0, "a.n": 3}
    (tmp_path / "p.ssv").write_bytes(written_set(made, "p", given))
    found = read_parameters(tmp_path / "p.ssv", made)
    assert found == {"a.w[1]": 1.0, "a.w[2]": 2.0, "a.w[3]": 3.0, "a.K[1,2]": 7.0, "a.n": 3}
    result = made.simulate(parameters=found)
    assert result["a.z[3]"][-1] == 3.0


def test_the_exact_name_of_a_scalar_wins(arrays: Path, tmp_path: Path):
    joins = connection(("a", "x[1]"), ("b", "x"))
    loaded = load(tmp_path, document(part("a", bindings(value("x", 2.0))), part("b"), joins=joins), arrays)
    assert last(loaded, "b.x[1]") == [200.0]


WRONG = {
    "an element that is not there": (
        document(part("a"), part("b"), joins=connection(("a", "y[3,1]"), ("b", "u[1,1]"))),
        r"a.y\[3,1\]: expected an element of y, which has 2 x 2 elements",
    ),
    "a parameter of an element that is not there": (
        document(part("a", bindings(value("K[5]", 1.0)))),
        r"parameter K\[5\]: a.K\[5\]: expected an element of K, which has 2 x 2 elements",
    ),
    "one value for many elements": (
        document(part("a", bindings(value("K", 1.0)))),
        "parameter K: a.K: expected 2 x 2 values, got 1",
    ),
    "shapes": (
        document(part("a"), part("b"), joins=connection(("a", "y"), ("b", "v"))),
        "expected the shape of the input, 2, got 2 x 2",
    ),
    "an element fed twice": (
        document(
            part("a"), part("b"), joins=connection(("a", "y"), ("b", "u")) + connection(("a", "z[1]"), ("b", "u[1,1]"))
        ),
        "expected a free input, got one that a.y feeds",
    ),
    "an element's kind": (
        document(part("a", connectors(**{"y[1,1]": "input Real"}))),
        r"connector a.y\[1,1\]: expected the FMU's kind output, got input",
    ),
    "an element of a scalar": (
        document(part("a"), part("b"), joins=connection(("a", "x[1]"), ("b", "x[2]"))),
        r"b.x\[2\]: expected a variable of Arrays.fmu, got none",
    ),
}


@pytest.mark.parametrize("case", WRONG)
def test_what_does_not_fit_an_array_is_refused(arrays: Path, tmp_path: Path, case: str):
    text, problem = WRONG[case]
    with pytest.raises(SetupError, match=problem):
        load(tmp_path, text, arrays)


def test_names_of_elements_that_an_fmu_does_not_have_are_ignored(arrays: Path, tmp_path: Path):
    loaded = load(tmp_path, document(part("a", bindings(value("x[7]", 1.0), value("q[1]", 1.0)))), arrays)
    assert (loaded.parameters, len(loaded.ignored)) == ({}, 2)
