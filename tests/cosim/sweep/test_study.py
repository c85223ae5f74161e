"""Studies are read strictly: each wrong key is one line that says where, what was expected, what was got."""

from __future__ import annotations

import re
from pathlib import Path
from typing import ClassVar

import pytest

from cosim.errors import SetupError
from cosim.sweep.design import Block, Range, Values, Variable
from cosim.sweep.study import Study
from cosim.sweep.vocabulary import Vocabulary

HEAD = 'name = "study"\nsystem = "system.ssp"\nmetrics = ["rms(cab.y)"]\n'


class Words(Vocabulary):
    words: ClassVar = {"driver_mass": "kg", "mode": ""}
    figures = ("pareto",)


def parse(text: str) -> Study:
    return Study.parse(HEAD + text, "s.toml", vocabulary=Words())


def problems(text: str) -> list[str]:
    with pytest.raises(SetupError) as error:
        parse(text)
    return list(error.value.problems)


def test_a_file_says_the_same_as_a_script():
    text = """
stop_time = 3
mode = "robust"
algorithm = "jacobi"
[parameters]
"cab.u" = 1.5
[series]
signals = ["cab.y"]
every = 10
[[vary]]
variables.driver_mass = [55.0, 80.0]
[[vary]]
design = "sobol"
n = 8
seed = 4
[vary.variables]
"cab.strikes_at" = { low = 1.0, high = 2.0 }
lag = { low = 1e-3, high = 1e-1, scale = "log", scales = ["a.x", "b.x"], unit = "s" }
number = { low = 1, high = 9, integer = true, sets = ["a.n"] }
"""
    lag = Variable(Range(1e-3, 1e-1, "log"), scales=("a.x", "b.x"), unit="s")
    number = Variable(Range(1.0, 9.0, integer=True), sets=("a.n",))
    script = Study(
        "study", "system.ssp", stop_time=3.0, words={"mode": "robust"}, algorithm="jacobi", parameters={"cab.u": 1.5},
        metrics=["rms(cab.y)"], series=["cab.y"], series_every=10, vocabulary=Words(),
        vary=[
            Block({"driver_mass": Variable(Values((55.0, 80.0)))}),
            Block({"cab.strikes_at": Variable(Range(1.0, 2.0)), "lag": lag, "number": number}, "sobol", 8, 4),
        ],
    )  # fmt: skip
    found = parse(text)
    assert found == script
    assert found.as_json() == script.as_json()
    assert found.hash() == script.hash() != script.hash("another FMU")


def test_a_comment_does_not_change_what_a_study_says():
    assert parse("# why\n").hash() == parse("").hash() != parse('question = "?"\n').hash()


def test_evenly_spaced_values():
    text = "[[vary]]\n[vary.variables]\n'a.x' = { linspace = [0, 1, 5] }\n'a.y' = { logspace = [1, 1000, 4] }"
    domains = [each.domain.values for each in parse(text).design.variables.values()]
    assert domains[0] == (0.0, 0.25, 0.5, 0.75, 1.0)
    assert domains[1] == pytest.approx((1.0, 10.0, 100.0, 1000.0), rel=1e-15)


def test_samples_bring_their_variables_and_tables_say_what_they_set():
    text = """
[[vary]]
design = "samples"
samples = [{ a = 1.0, mode = "robust" }, { a = 1.0, mode = "published" }]
variables.a = { sets = ["cab.u", "first.u"] }
"""
    design = parse(text).design
    assert design.variables["a"].sets == ("cab.u", "first.u")
    assert design.points([0, 1]) == [{"a": 1.0, "mode": "robust"}, {"a": 1.0, "mode": "published"}]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("stop_tme = 3.0", "expected keys among name, .*, got stop_tme .did you mean stop_time"),
        ('stop_time = "3"', "s.toml: stop_time: expected a number, got '3'"),
        ("stop_time = true", "s.toml: stop_time: expected a number, got true"),
        ("stop_time = -1.0", "s.toml: stop_time: expected a finite time above 0 s, got -1 s"),
        ("warm_up = nan", "s.toml: warm_up: expected a finite time from 0 s, got nan s"),
        ("connect = [1]", r"s.toml: connect: expected a list of values, each a text, got \[1\]"),
        ("[parameters]\na.x = [1]", "s.toml: parameters: expected a table of values, a a number, a text"),
        ('algorithm = "jacoby"', r"one of gauss-seidel, jacobi \(did you mean jacobi\?\), got 'jacoby'"),
        ('figure = "pareta"', r"figure: expected one of pareto, got pareta \(did you mean pareto\?\)"),
        ("driver_mass = 1979-05-27", "s.toml: driver_mass: expected a number, a text, true or false"),
        ("[series]\nevery = 2", "s.toml: series: expected a key signals, got none"),
        ("[series]\nsignals = ['a.y']\nevery = 0", "series, every: expected a whole number from 1, got 0"),
        ("[[vary]]\ndesgin = 'grid'\nvariables.a = [1]", "vary, block 1: expected keys among .* got desgin .did you"),
        ("[[vary]]", "vary, block 1: expected a key variables, got none"),
        ("[[vary]]\nvariables.a = 3", "vary, block 1: a: expected a list of values or a table, got 3"),
        ("[[vary]]\nvariables.a = []", "vary, block 1: a: values: expected at least one, got none"),
        ("[[vary]]\nvariables.a = {}", "a: expected one of the keys values, linspace, logspace, low, got none"),
        ("[[vary]]\nvariables.a = { values = [1], low = 1, high = 2 }", "expected one of the keys .*, got values, low"),
        ("[[vary]]\nvariables.a = { low = 1 }", "expected both low and high, got low alone"),
        ("[[vary]]\nvariables.a = { values = [1], scale = 'log' }", "expected scale and integer with low and high"),
        ("[[vary]]\nvariables.a = { linspace = [0, 1, 1] }", r"linspace: expected \[first, last, how many\], 2 or"),
        ("[[vary]]\nvariables.a = { linspace = [0, 1] }", "linspace: expected a list of 3 values, got"),
        ("[[vary]]\ndesign = 'samples'", "expected samples, a list of tables, for design samples, got none"),
        ("[[vary]]\nsamples = [{ a = 1 }]", "samples: expected with design samples, got design grid"),
        (
            "[[vary]]\nvariables.a = [1]\n[[vary]]\nvariables.a = [2]",
            "a: expected in one block, got in several",
        ),
        ("x = ", "s.toml: expected TOML, got: Invalid value"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(text: str, expected: str):
    found = problems(text)
    assert len(found) == 1
    assert re.search(expected, found[0]), found[0]


def test_all_problems_are_reported_together():
    assert len(problems("stop_time = 'x'\nwarm = 1\n[[vary]]\nvariables.a = []\n[[vary]]\nvariables.b = 1")) == 4


def test_a_study_needs_a_name_that_is_no_path():
    with pytest.raises(SetupError, match="name: expected a name of a folder, got a/b"):
        Study("a/b", "system.ssp")
    with pytest.raises(SetupError, match="expected a key name, got none; .*expected a key system, got none"):
        Study.parse("")


def test_no_study_is_no_study(tmp_path: Path):
    with pytest.raises(SetupError, match="expected a study in TOML, got: No such file"):
        Study.read(tmp_path / "none.toml")
    (tmp_path / "binary.toml").write_bytes(b"\xff\xfe")
    with pytest.raises(SetupError, match="expected a study in TOML, got: no text in UTF-8"):
        Study.read(tmp_path / "binary.toml")
