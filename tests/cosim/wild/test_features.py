"""Features of FMUs that are not everyday: each is supported, or refused in one line that names variable and feature."""

from __future__ import annotations

from pathlib import Path

import pytest

from cosim import RunError, SetupError, System
from cosim.results.result import StepperName
from tests.helpers.files import edited
from tests.helpers.wild import Var, Wild, par, var_in

pytestmark = pytest.mark.builds

H = 0.01
FMI = (2, 3)


def alone(model: Wild, folder: Path, version: int, name: str = "a") -> System:
    system = System()
    system.add(name, model.build(folder / f"{name}.fmu", version))
    return system


# ---- clocks and events -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("interval", "kind"), [("triggered", "triggered clock"), ("constant", "clock"), ("countdown", "clock")]
)
@pytest.mark.parametrize("causality", ["input", "output", "local"])
def test_clocks_are_refused_by_name(tmp_path: Path, interval: str, kind: str, causality: str):
    clock = Var("tick", "Clock", causality, start=None, more=f'intervalVariability="{interval}"')
    fmu = clocked(tmp_path, clock)
    with pytest.raises(SetupError, match=f"tick: expected no clocks, got a {kind} .event mode is not supported"):
        System().add("a", fmu)


def clocked(folder: Path, clock: Var) -> Path:
    """Build an FMU whose description has a clock; it is refused before its library is loaded."""
    plain = Wild([Var("y", start="0"), Var("tick", "Int32", clock.causality, start="0", variability="discrete")])
    fmu = plain.build(folder / "plain.fmu", 3)
    start = f'<Int32 name="tick" valueReference="2" causality="{clock.causality}" variability="discrete" start="0" >'
    element = (
        f'<Clock name="tick" valueReference="2" causality="{clock.causality}" variability="discrete" {clock.more}>'
    )
    return edited(fmu, folder / "clocked.fmu", (f"{start}</Int32>", f"{element}</Clock>"))


@pytest.mark.parametrize("stepper", ["c", "python"])
def test_a_pending_step_says_that_asynchronous_fmus_are_not_supported(tmp_path: Path, stepper: StepperName):
    model = Wild(
        [Var("y", start="0")],
        advance="if (m->run.steps == 3) return PENDING;",
        interface='canRunAsynchronuously="true"',
    )
    result = alone(model, tmp_path, 2).simulate(0.1, H, stepper=stepper)
    assert not result.complete
    assert "a: fmi2DoStep returned pending at t = 0.03 s" in str(result.error)
    assert len(result.time) == 3


# ---- one instance in a process ---------------------------------------------------------------------------------------

ONCE = Wild(
    [Var("y", start=None, initial="calculated"), par("p", start="1")],
    top="static int made;",
    begin="m->run.steps = 0;",
    calculate="m->y[0] = m->p[0];",
    enter='if (__sync_add_and_fetch(&made, 1) > 1) return report(&m->run, ERROR, "a second instance");',
    interface='canBeInstantiatedOnlyOncePerProcess="true"',
)


@pytest.mark.parametrize("version", FMI)
def test_a_second_instance_runs_in_a_process_of_its_own_and_that_is_reported(tmp_path: Path, version: int):
    fmu = ONCE.build(tmp_path / "once.fmu", version)
    system = System()
    for name in ("first", "second", "third"):
        system.add(name, fmu)
    parameters = {"first.p": 1.0, "second.p": 2.0, "third.p": 3.0}
    result = system.simulate(0.1, H, parameters)
    assert [result[f"{name}.y"][-1] for name in system.models] == [1.0, 2.0, 3.0]
    reason = "runs in a process of its own, as its FMU can be instantiated only once in a process"
    assert [w for w in result.warnings if "process" in w] == [f"second: {reason}", f"third: {reason}"]


def test_two_sessions_share_the_one_instance_of_a_process(tmp_path: Path):
    fmu = ONCE.build(tmp_path / "once.fmu", 2)
    systems = []
    for name in ("a", "b"):
        systems.append(System())
        systems[-1].add(name, fmu)
    with systems[0].open() as first, systems[1].open() as second:
        assert not first.run(0.1, H).warnings
        assert any("process of its own" in text for text in second.run(0.1, H).warnings)


# ---- texts, and variables without a value ----------------------------------------------------------------------------

TEXTS = [
    Var("text", "String", start="hello", variability="discrete", initial="exact"),
    var_in("text_in", "String", "x"),
    par("file", "String", "none"),
    Var("y", start=None, initial="calculated"),
]


@pytest.mark.parametrize("version", FMI)
def test_texts_are_not_recorded_and_that_is_reported(tmp_path: Path, version: int):
    system = alone(Wild(TEXTS), tmp_path, version)
    result = system.simulate(0.1, H)
    assert list(result.values) == ["a.y"]
    assert "a.text: not recorded, as its type is String" in result.warnings
    with pytest.raises(SetupError, match=r"a\.text: expected .*String"):
        system.validate(0.1, H, record=["a.text"])


def test_texts_are_not_connected(tmp_path: Path):
    system = alone(Wild(TEXTS), tmp_path, 3)
    system.add("b", tmp_path / "a.fmu")
    with pytest.raises(SetupError, match="a.text -> b.text_in: .*String is not supported in connections"):
        system.connect("a.text", "b.text_in")


@pytest.mark.parametrize("version", FMI)
def test_text_parameters_are_set(tmp_path: Path, version: int):
    model = Wild(TEXTS, calculate='m->y[0] = strcmp(m->file[0], "data.csv") == 0;')
    system = alone(model, tmp_path, version)
    assert system.simulate(H, H, {"a.file": "data.csv"})["a.y"][-1] == 1.0
    assert system.simulate(H, H)["a.y"][-1] == 0.0


@pytest.mark.parametrize("version", FMI)
def test_an_input_without_a_start_value_says_so(tmp_path: Path, version: int):
    result = alone(Wild([var_in("u", start=None), Var("y", start="0")]), tmp_path, version).simulate(H, H)
    assert "a.u: not connected and not set, and has no start value in its description" in result.warnings


# ---- names -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("version", FMI)
@pytest.mark.parametrize("kinds", [("Real", "Real"), ("Real", "Boolean")])
def test_two_variables_of_one_name_are_refused(tmp_path: Path, version: int, kinds: tuple[str, str]):
    variables = [Var("y", kinds[0], start="0"), Var("z", kinds[1], start="0")]
    fmu = edited(Wild(variables).build(tmp_path / "a.fmu", version), tmp_path / "b.fmu", ('name="z"', 'name="y"'))
    with pytest.raises(SetupError, match="y: expected one variable of this name, got 2"):
        System().add("a", fmu)


def aliased(folder: Path, version: int) -> Path:
    """Build an FMU whose input u has the alias w, and whose output y has the alias v."""
    if version == 3:
        variables = [var_in("u", aliases=("w",)), Var("y", start=None, initial="calculated", aliases=("v",))]
        return Wild(variables, calculate="m->y[0] = 2 * m->u[0];").build(folder / "alias.fmu", 3)
    variables = [var_in("u"), var_in("w"), Var("y", start=None, initial="calculated"),
                 Var("v", start=None, initial="calculated")]  # fmt: skip
    fmu = Wild(variables, calculate="m->y[0] = 2 * m->u[0];").build(folder / "plain.fmu", 2)
    same = [('name="w" valueReference="2"', 'name="w" valueReference="1"'),
            ('name="v" valueReference="4"', 'name="v" valueReference="3"')]  # fmt: skip
    return edited(fmu, folder / "alias.fmu", *same)


@pytest.mark.parametrize("version", FMI)
@pytest.mark.parametrize(("output", "input_"), [("y", "u"), ("v", "u"), ("y", "w"), ("v", "w")])
def test_an_alias_is_the_same_variable(tmp_path: Path, version: int, output: str, input_: str):
    system = System()
    for name in ("a", "b"):
        system.add(name, aliased(tmp_path, version))
    system.connect(f"a.{output}", f"b.{input_}")
    system.order = ["a", "b"]
    result = system.simulate(H, H, {f"a.{input_}": 3.0})
    assert result["b.y"][-1] == 12.0
    assert not [w for w in result.warnings if "not connected" in w]
    with pytest.raises(SetupError, match="free input, got one that"):
        system.connect("b.y", f"b.{'u' if input_ == 'w' else 'w'}")
    with pytest.raises(SetupError, match="free input, got one that"):
        system.validate(H, H, {f"b.{'u' if input_ == 'w' else 'w'}": 1.0})


# ---- messages --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("version", FMI)
@pytest.mark.parametrize("stepper", ["c", "python"])
def test_a_warning_outlives_thousands_of_infos(tmp_path: Path, version: int, stepper: StepperName):
    model = Wild(
        [Var("y", start="0")],
        advance="""
            if (m->run.steps == 0) report(&m->run, WARNING, "table extrapolated");
            for (int i = 0; i < 100; ++i) report(&m->run, OK, "info %ld %d", m->run.steps, i);
        """,
    )
    result = alone(model, tmp_path, version).simulate(1.0, H, stepper=stepper)
    assert [w for w in result.warnings if "extrapolated" in w]


@pytest.mark.parametrize("version", FMI)
def test_the_reason_of_a_failure_outlives_infos_that_follow(tmp_path: Path, version: int):
    model = Wild(
        [Var("y", start="0")],
        advance="""
            if (m->run.steps == 5) {
                report(&m->run, ERROR, "the tyre burst");
                for (int i = 0; i < 3000; ++i) report(&m->run, OK, "info %d", i);
                return ERROR;
            }
        """,
    )
    result = alone(model, tmp_path, version).simulate(1.0, H)
    assert "the tyre burst" in str(result.error)


@pytest.mark.parametrize("version", FMI)
def test_different_warnings_are_kept_up_to_a_number_and_the_others_counted(tmp_path: Path, version: int):
    model = Wild([Var("y", start="0")], advance='report(&m->run, WARNING, "warning %ld", m->run.steps);')
    result = alone(model, tmp_path, version).simulate(15.0, H)
    assert sum("warning " in text for text in result.warnings) >= 1000
    assert any("500 more" in text or "500 further" in text for text in result.warnings), result.warnings[-1]


def test_an_empty_message_and_an_unknown_environment_lose_nothing(tmp_path: Path, capfd: pytest.CaptureFixture[str]):
    model = Wild(
        [Var("y", start="0")],
        advance="""
            if (m->run.steps == 0) m->run.log(m->run.environment, (Status)OK, NULL, NULL);
            if (m->run.steps == 1) m->run.log((void *)0x1234, (Status)WARNING, "log", "from nowhere");
            if (m->run.steps == 2) m->run.log(m->run.environment, (Status)WARNING, "log", NULL);
        """,
    )
    result = alone(model, tmp_path, 3).simulate(0.1, H)
    assert result.complete
    assert any("from nowhere" in text for text in result.warnings)
    assert capfd.readouterr().err == ""


def test_a_failure_at_the_start_names_its_reason(tmp_path: Path):
    model = Wild([Var("y", start="0")], enter='return report(&m->run, ERROR, "no licence");')
    for version in FMI:
        with pytest.raises(RunError, match="no licence"):
            alone(model, tmp_path, version).simulate(0.1, H)
