"""Rows: a value read after a step from t by h is that of t + h, as fmpy records it, unless an FMU says otherwise."""

from __future__ import annotations

from pathlib import Path

import fmpy
import numpy as np
import pytest

from cosim import System
from cosim.fmi.description import ModelDescription
from cosim.fmi.repairs import SAMPLED
from cosim.results.result import StepperName
from tests.helpers.hosts import HOSTS, LOOPS
from tests.helpers.wild import Var, Wild, var_in

pytestmark = pytest.mark.builds

H = 0.1
STOP = 2.0

COUNTER = Wild(
    [Var("count", "Integer", start="0", variability="discrete", initial="exact")],
    advance="m->count[0] = (int)floor((time + h) + 1e-9);",
)
"""Counts the seconds: 1 from t = 1 s on."""

SAMPLER = Wild(
    [
        Var("held", start="0", variability="discrete", initial="exact"),
        Var("position", start="3", variability="discrete", initial="exact"),
        var_in("u", start="1"),
    ],
    advance="m->position[0] = 3 + time + h; if (fmod(time + h + 1e-9, 0.5) < 1e-6) m->held[0] = m->position[0];",
)
"""Samples its position every 0.5 s; the position itself is declared discrete, too."""

CONTINUOUS = Wild(
    [Var("x", start="1", initial="exact"), Var("y", depends=("u",), initial="calculated"), var_in("u", start="2")],
    calculate="m->y[0] = 10 * m->x[0] + m->u[0];",
    advance="m->x[0] *= exp(-h);",
)

MODELS = {"counter": COUNTER, "sampler": SAMPLER, "continuous": CONTINUOUS}


def build(name: str, version: int, folder: Path) -> Path:
    model = MODELS[name]
    if version == 3 and name == "counter":
        model = Wild([Var("count", "Int32", start="0", variability="discrete", initial="exact")], advance=model.advance)
    return model.build(folder / f"{name}{version}.fmu", version)


@pytest.fixture(scope="module")
def wild(tmp_path_factory: pytest.TempPathFactory) -> dict[tuple[str, int], Path]:
    return {
        (name, version): build(name, version, tmp_path_factory.mktemp(f"{name}{version}"))
        for name in MODELS
        for version in (2, 3)
    }


def outputs_of(fmu: Path) -> list[str]:
    return [variable.name for variable in ModelDescription.read(fmu).outputs]


def fmpy_rows(fmu: Path) -> dict[str, np.ndarray]:
    result = fmpy.simulate_fmu(
        str(fmu), stop_time=STOP, step_size=H, output_interval=H, output=outputs_of(fmu), fmi_type="CoSimulation"
    )
    return {name: np.asarray(result[name], dtype=float) for name in result.dtype.names}


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize(("stepper", "isolate"), HOSTS)
def test_rows_alone_are_those_of_fmpy(
    wild: dict[tuple[str, int], Path], name: str, version: int, stepper: StepperName, isolate: bool
):
    fmu = wild[name, version]
    system = System()
    system.add("a", fmu)
    result = system.simulate(STOP, H, stepper=stepper, isolate=["a"] if isolate else [])
    expected = fmpy_rows(fmu)
    np.testing.assert_allclose(result.time, expected["time"], atol=1e-12)
    for output in outputs_of(fmu):
        np.testing.assert_allclose(result[f"a.{output}"], expected[output], rtol=1e-13, err_msg=output)


@pytest.mark.parametrize("stepper", LOOPS)
@pytest.mark.parametrize("algorithm", ["gauss-seidel", "jacobi"])
def test_rows_in_a_system_are_those_of_fmpy(wild: dict[tuple[str, int], Path], stepper: StepperName, algorithm: str):
    """Unconnected, in one system of both versions: nothing depends on the neighbours or on the order."""
    system = System()
    for (name, version), fmu in wild.items():
        system.add(f"{name}{version}", fmu)
    result = system.simulate(STOP, H, stepper=stepper, algorithm=algorithm)
    for (name, version), fmu in wild.items():
        expected = fmpy_rows(fmu)
        for output in outputs_of(fmu):
            np.testing.assert_allclose(result[f"{name}{version}.{output}"], expected[output], rtol=1e-13)


def test_the_counter_turns_at_full_seconds(wild: dict[tuple[str, int], Path]):
    system = System()
    system.add("a", wild["counter", 2])
    result = system.simulate(STOP, H)
    np.testing.assert_array_equal(result["a.count"], np.floor(result.time + 1e-9))


@pytest.mark.parametrize("stepper", LOOPS)
def test_a_discrete_output_is_fed_on_with_the_time_it_belongs_to(
    wild: dict[tuple[str, int], Path], stepper: StepperName
):
    """In the order source, sink the sink's step gets the value of the step's end; in the other that of its begin."""
    for order, late in ((["s", "k"], 0), (["k", "s"], 1)):
        system = System()
        system.add("s", wild["sampler", 2])
        system.add("k", wild["continuous", 3])
        system.connect("s.position", "k.u")
        system.order = order
        result = system.simulate(STOP, H, stepper=stepper)
        position, shown = result["s.position"], result["k.y"] - 10 * result["k.x"]
        np.testing.assert_allclose(shown[1:], position[1 - late : len(position) - late], atol=1e-12)


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("stepper", LOOPS)
def test_an_fmu_that_says_that_its_outputs_are_samples_is_recorded_at_their_times(
    tmp_path: Path, version: int, stepper: StepperName
):
    """The vendor annotation: discrete outputs after a step from t are those of the sample at t."""
    annotation = {
        2: f'<VendorAnnotations><Tool name="{SAMPLED}"/></VendorAnnotations>',
        3: f'<Annotations><Annotation type="{SAMPLED}"/></Annotations>',
    }[version]
    discrete = Var("sample", start="-1", variability="discrete", initial="exact")
    plain = Var("end", start="0", initial="exact")
    model = Wild([discrete, plain], advance="m->sample[0] = time; m->end[0] = time + h;")
    fmus = {
        "says": Wild(model.variables, advance=model.advance, **{"before" if version == 2 else "after": annotation}),
        "does_not": model,
    }
    system = System()
    for name, each in fmus.items():
        (tmp_path / name).mkdir()
        system.add(name, each.build(tmp_path / name / f"{name}.fmu", version))
    result = system.simulate(STOP, H, stepper=stepper)
    np.testing.assert_allclose(result["says.sample"][:-1], result.time[:-1], atol=1e-12)
    np.testing.assert_allclose(result["does_not.sample"][1:], result.time[:-1], atol=1e-12)
    assert result["does_not.sample"][0] == -1.0
    for name in fmus:
        np.testing.assert_allclose(result[f"{name}.end"], result.time, atol=1e-12)


@pytest.mark.parametrize("flavour", ["fmi2", "fmi3"])
def test_our_own_sampled_fmus_say_so(native: Path, flavour: str):
    """The controller samples; the seat and the shaker are continuous and say nothing."""
    sampled = {name: ModelDescription.read(native / flavour / f"{name}.fmu").sampled
               for name in ("SeatController", "SeatPlant", "Shaker")}  # fmt: skip
    assert sampled["SeatController"]
    controller = ModelDescription.read(native / flavour / "SeatController.fmu")
    assert controller.is_sampled("force")
    plant = ModelDescription.read(native / flavour / "SeatPlant.fmu")
    assert not plant.is_sampled("driver_acceleration")
