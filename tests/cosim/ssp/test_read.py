"""Systems from SSP files: nested and flat ones give the same results, units are converted, mistakes are errors."""

from __future__ import annotations

import zipfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cosim import SetupError, System
from cosim.engine.network import VariableRef
from cosim.ssp import read_parameters, ssd, ssv
from cosim.ssp.package import DESCRIPTION
from cosim.ssp.xml import write_document
from cosim.units import Linear, Unit
from seat_cosim.scenarios import seat_suspension
from tests.helpers.files import edited

MILLIMETRES = Unit("mm", (0, 1, 0, 0, 0, 0, 0, 0), 1e-3)
GRAMS = Unit("g", (1, 0, 0, 0, 0, 0, 0, 0), 1e-3)
STANDARD_GRAVITY = Unit("gn", (0, 1, -2, 0, 0, 0, 0, 0), 9.80665)
UNITS = tuple(ssv.UnitDefinition.of(unit) for unit in (MILLIMETRES, GRAMS, STANDARD_GRAVITY))

Edit = Callable[[ssd.SystemStructureDescription], ssd.SystemStructureDescription]


@pytest.fixture(scope="module")
def seat_ssp(native: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The seat suspension as it is saved."""
    system = seat_suspension(native / "fmi2")
    system.stop_time = 0.2
    path = tmp_path_factory.mktemp("ssp") / "Seat.ssp"
    assert system.save(path)
    return path


def rewritten(source: Path, target: Path, edit: Edit, **files: bytes) -> Path:
    """Copy an SSP file with another description and further resources; ``__`` of a name is a dot."""
    with zipfile.ZipFile(source) as archive, zipfile.ZipFile(target, "w") as copy:
        for name in archive.namelist():
            content = archive.read(name)
            if name == DESCRIPTION:
                content = write_document(edit(ssd.read_description(content, name)))
            copy.writestr(name, content)
        for name, content in files.items():
            copy.writestr(f"resources/{name.replace('__', '.')}", content)
    return target


def with_system(**changes: object) -> Edit:
    """Change the outermost system; functions get what is there."""

    def edit(description: ssd.SystemStructureDescription) -> ssd.SystemStructureDescription:
        system = description.system
        made = {name: new(getattr(system, name)) if callable(new) else new for name, new in changes.items()}
        return replace(description, system=replace(system, **made), units=(*description.units, *UNITS))

    return edit


def element(name: str, /, **changes: object) -> Callable[[tuple], tuple]:
    """Change one element."""
    return lambda elements: tuple(replace(e, **changes) if e.name == name else e for e in elements)


def values(units: tuple = (), **given: ssv.TypedValue) -> ssv.ParameterSet:
    """Make a set of parameters; ``__`` of a name is a dot."""
    parameters = tuple(ssv.Parameter(name=name.replace("__", "."), typed_value=value) for name, value in given.items())
    return ssv.ParameterSet(version="1.0", name="test", parameters=parameters, units=units)


def real(value: float, unit: str | None = None) -> ssv.TypedValue:
    return ssv.TypedValue(kind="Real", text=repr(value), unit=unit)


def same_trajectory(one: System, other: System, names: dict[str, str] | None = None) -> None:
    """Compare all outputs bit by bit; ``names`` are the components' other names."""
    first, second = one.simulate(0.2, 0.002), other.simulate(0.2, 0.002)
    for name, column in first.values.items():
        component, _, variable = name.partition(".")
        assert np.array_equal(column, second[f"{(names or {}).get(component, component)}.{variable}"]), name
    assert np.abs(first["controller.force"]).max() > 10.0


# ---- there and back --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("flavour", ["fmi2", "fmi3"])
def test_a_saved_system_is_loaded_as_it_was(native: Path, tmp_path: Path, flavour: str):
    system = seat_suspension(native / flavour)
    system.stop_time = 3.0
    assert system.save(tmp_path / "a.ssp")
    loaded = System.load(tmp_path / "a.ssp")
    assert loaded.connections == system.connections
    assert (loaded.name, loaded.order) == ("SeatSuspension", ("controller", "seat", "shaker"))
    assert (loaded.stop_time, loaded.step_size, loaded.algorithm) == (3.0, 0.002, "gauss-seidel")
    assert loaded.ignored == ()
    same_trajectory(system, loaded)


def test_saving_again_gives_the_same_bytes(native: Path, tmp_path: Path):
    system = seat_suspension(native / "fmi2")
    system.disconnect("seat.force")
    system.connect("controller.force", "seat.force", Linear(-0.1, 1e-17))
    system.disconnect("seat.floor_velocity")
    system.connect("shaker.floor_displacement", "seat.floor_velocity", convert_units=False)
    system.parameters = {
        "seat.driver_mass": "70",
        "controller.driver_mass": 70.1,
        "controller.enabled": False,
        "shaker.profile": "sine",
        "shaker.sine.frequency": 1.1,
    }
    system.component_steps = {"controller": 0.004}
    system.step_size = 0.001
    system.algorithm = "jacobi"
    system.save(tmp_path / "a.ssp")
    loaded = System.load(tmp_path / "a.ssp")
    assert loaded.connections == system.connections
    assert loaded.parameters == {**system.parameters, "seat.driver_mass": 70.0}
    assert (loaded.component_steps, loaded.step_size, loaded.algorithm) == ({"controller": 0.004}, 0.001, "jacobi")
    assert loaded.stop_time is None
    assert loaded.save(tmp_path / "b.ssp")
    assert (tmp_path / "a.ssp").read_bytes() == (tmp_path / "b.ssp").read_bytes()
    assert not loaded.save(tmp_path / "b.ssp")


def test_two_fmus_of_one_file_name_are_kept_apart(native: Path, tmp_path: Path):
    system = seat_suspension(native / "fmi2")
    (tmp_path / "other").mkdir()
    system.add("mm", edited(native / "fmi2" / "Shaker.fmu", tmp_path / "other" / "Shaker.fmu", ('"m"', '"mm"')))
    system.add("again", native / "fmi2" / "Shaker.fmu")
    system.save(tmp_path / "a.ssp")
    with zipfile.ZipFile(tmp_path / "a.ssp") as archive:
        names = [name for name in archive.namelist() if name.endswith(".fmu")]
    assert names == [f"resources/{name}.fmu" for name in ("SeatController", "SeatPlant", "Shaker", "mm")]
    models = System.load(tmp_path / "a.ssp").models
    assert models["again"].member == models["shaker"].member == "resources/Shaker.fmu"
    assert models["mm"].unit(models["mm"].variables["floor_displacement"]) == "mm"


def test_an_fmu_in_an_ssp_is_named_by_its_place(seat_ssp: Path):
    system = System.load(seat_ssp)
    assert system.models["seat"].where == seat_ssp / "resources/SeatPlant.fmu"
    with pytest.raises(SetupError, match=r"seat.mass: expected a variable of SeatPlant.fmu, got none"):
        system.check_parameters({"seat.mass": 1.0})


def test_a_description_beside_its_resources_is_loaded(seat_ssp: Path, tmp_path: Path):
    with zipfile.ZipFile(seat_ssp) as archive:
        archive.extractall(tmp_path)
    system = System.load(tmp_path / DESCRIPTION)
    assert system.models["seat"].path == tmp_path / "resources/SeatPlant.fmu"
    same_trajectory(System.load(seat_ssp), system)


# ---- nested systems --------------------------------------------------------------------------------------------------


def nested(description: ssd.SystemStructureDescription) -> ssd.SystemStructureDescription:
    """Put seat and controller into a cabin, the seat into a box in it; the floor arrives in mm and upside down."""
    system = description.system
    seat, controller, shaker = (
        next(e for e in system.elements if e.name == n) for n in ("seat", "controller", "shaker")
    )
    floor = ("floor_displacement", "floor_velocity", "floor_acceleration")
    measured = ("seat_acceleration", "suspension_deflection")

    def linear(factor: float) -> ssv.Transformation | None:
        return ssv.Transformation.of(Linear(factor))

    def into(inner: str, factor: float) -> tuple[ssd.Connection, ...]:
        return tuple(
            ssd.Connection(start_connector=n, end_element=inner, end_connector=n, transformation=linear(factor))
            for n in floor
        )

    upside_down = tuple(
        ssd.Connector(name=n, kind="input", type=ssd.Type(kind="Real", unit="mm") if n == floor[0] else None)
        for n in floor
    )
    sensors = tuple(ssd.Connector(name=n, kind="output") for n in measured)
    force = ssd.Connector(name="force", kind="input")
    box = ssd.System(
        name="box",
        connectors=(*(replace(c, type=None) for c in upside_down), force, *sensors),
        elements=(seat,),
        connections=(
            *into("seat", -1.0),
            ssd.Connection(start_connector="force", end_element="seat", end_connector="force"),
            *(  # the standard leaves open which end is the start
                ssd.Connection(start_connector=n, end_element="seat", end_connector=f"{n}_measured") for n in measured
            ),
        ),
    )
    cabin = ssd.System(
        name="cabin",
        connectors=upside_down,
        elements=(controller, box),
        connections=(
            *into("box", 1.0),
            ssd.Connection(
                start_element="controller", start_connector="force", end_element="box", end_connector="force"
            ),
            *(
                ssd.Connection(start_element="box", start_connector=n, end_element="controller", end_connector=n)
                for n in measured
            ),
        ),
    )
    outside = tuple(
        ssd.Connection(
            start_element="shaker", start_connector=n, end_element="cabin", end_connector=n, transformation=linear(-1.0)
        )
        for n in floor
    )
    top = replace(system, elements=(cabin, shaker), connections=outside)
    return replace(description, system=top, units=(*description.units, *UNITS))


def test_a_nested_system_runs_as_the_flat_one(seat_ssp: Path, tmp_path: Path):
    system = System.load(rewritten(seat_ssp, tmp_path / "nested.ssp", nested))
    assert system.order == ("cabin/controller", "cabin/box/seat", "shaker")
    sources = {str(ref): str(connection.source) for ref, connection in system.connections.items()}
    assert sources["cabin/box/seat.floor_displacement"] == "shaker.floor_displacement"
    assert sources["cabin/controller.seat_acceleration"] == "cabin/box/seat.seat_acceleration_measured"
    same_trajectory(
        System.load(seat_ssp), system, {"seat": "cabin/box/seat", "controller": "cabin/controller", "shaker": "shaker"}
    )
    system.save(tmp_path / "flat.ssp")
    assert System.load(tmp_path / "flat.ssp").connections == system.connections


def test_transformations_are_applied_in_the_order_of_the_path(seat_ssp: Path, tmp_path: Path):
    def linear(*numbers: float) -> ssv.Transformation | None:
        return ssv.Transformation.of(Linear(*numbers))

    edit = with_system(
        elements=lambda old: (
            *old,
            replace(THROUGH, connections=(joined("in", "out", transformation=linear(5.0, 7.0)),)),
        ),
        connections=(
            joined("controller.force", "through.in", transformation=linear(2.0, 3.0)),
            joined("through.out", "seat.force", transformation=linear(11.0, 13.0)),
        ),
    )
    connection = System.load(rewritten(seat_ssp, tmp_path / "a.ssp", edit)).connections[VariableRef("seat", "force")]
    assert connection.transformation(1.0) == 11.0 * (5.0 * (2.0 * 1.0 + 3.0) + 7.0) + 13.0


def test_an_outermost_input_stays_free_and_takes_a_start_value(seat_ssp: Path, tmp_path: Path):
    edit = with_system(
        connectors=(ssd.Connector(name="push", kind="input", type=ssd.Type(kind="Real", unit="N")),),
        connections=lambda old: (
            *(c for c in old if c.end_connector != "force"),
            ssd.Connection(
                start_connector="push",
                end_element="seat",
                end_connector="force",
                transformation=ssv.Transformation.of(Linear(-2.0, 1.0)),
            ),
        ),
        bindings=(ssd.ParameterBinding(values=values(push=real(3.0))),),
    )
    system = System.load(rewritten(seat_ssp, tmp_path / "a.ssp", edit))
    assert VariableRef("seat", "force") not in system.connections
    assert system.parameters == {"seat.force": -5.0}


# ---- units -----------------------------------------------------------------------------------------------------------


def test_connections_convert_units_and_transform_after_that(native: Path, tmp_path: Path):
    mm = edited(
        native / "fmi2" / "Shaker.fmu", tmp_path / "mm.fmu", ('<BaseUnit m="1"/>', '<BaseUnit m="1" factor="0.001"/>')
    )
    g = edited(mm, tmp_path / "g.fmu", ('<BaseUnit m="1" s="-2"/>', '<BaseUnit m="1" s="-2" factor="9.80665"/>'))
    system = System()
    system.add("shaker", g)
    system.add("seat", native / "fmi2" / "SeatPlant.fmu")
    system.connect("shaker.floor_displacement", "seat.floor_displacement")
    system.save(tmp_path / "a.ssp")
    more = with_system(
        connections=(
            ssd.Connection(
                start_element="shaker",
                start_connector="floor_acceleration",
                end_element="seat",
                end_connector="floor_acceleration",
                transformation=ssv.Transformation.of(Linear(2.0, 0.5)),
            ),
            ssd.Connection(
                start_element="shaker",
                start_connector="floor_displacement",
                end_element="seat",
                end_connector="floor_displacement",
            ),
            ssd.Connection(
                start_element="shaker",
                start_connector="floor_velocity",
                end_element="seat",
                end_connector="floor_velocity",
                suppress_unit_conversion=True,
            ),
        )
    )
    loaded = System.load(rewritten(tmp_path / "a.ssp", tmp_path / "b.ssp", more))
    found = {ref.variable: connection.transformation for ref, connection in loaded.connections.items()}
    assert found == {
        "floor_acceleration": Linear(2.0 * 9.80665, 0.5),
        "floor_displacement": Linear(0.001),
        "floor_velocity": Linear(),
    }


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        (real(70.0), 70.0),
        (real(70000.0, "g"), 70.0),
        (real(70.0, "kg"), 70.0),
        (ssv.TypedValue(kind="Integer", text="70"), 70),
    ],
)
def test_a_parameter_is_converted_to_its_variables_unit(
    seat_ssp: Path, tmp_path: Path, given: ssv.TypedValue, expected: float
):
    binding = ssd.ParameterBinding(values=values(UNITS, driver_mass=given))
    edit = with_system(elements=element("seat", bindings=(binding,)))
    assert System.load(rewritten(seat_ssp, tmp_path / "a.ssp", edit)).parameters == {"seat.driver_mass": expected}


# ---- parameters ------------------------------------------------------------------------------------------------------


def test_the_last_and_outermost_binding_wins(seat_ssp: Path, tmp_path: Path):
    inner = (
        ssd.ParameterBinding(values=values(driver_mass=real(50.0), seat_mass=real(20.0), suspension_damping=real(1.0))),
        ssd.ParameterBinding(values=values(driver_mass=real(51.0))),
    )
    outer = (
        ssd.ParameterBinding(values=values(seat__driver_mass=real(60.0)), prefix=""),
        ssd.ParameterBinding(values=values(driver_mass=real(61.0), seat_mass=real(21.0)), prefix="seat."),
    )
    edit = with_system(elements=element("seat", bindings=inner), bindings=outer)
    assert System.load(rewritten(seat_ssp, tmp_path / "a.ssp", edit)).parameters == {
        "seat.driver_mass": 61.0,
        "seat.seat_mass": 21.0,
        "seat.suspension_damping": 1.0,
    }


def test_hierarchical_names_reach_into_nested_systems(seat_ssp: Path, tmp_path: Path):
    def edit(description: ssd.SystemStructureDescription) -> ssd.SystemStructureDescription:
        made = nested(description)
        given = values(**{"cabin__box__seat__driver_mass": real(70.0), "cabin__controller__K1__rate": real(-80.0)})
        return replace(made, system=replace(made.system, bindings=(ssd.ParameterBinding(values=given),)))

    assert System.load(rewritten(seat_ssp, tmp_path / "a.ssp", edit)).parameters == {
        "cabin/box/seat.driver_mass": 70.0,
        "cabin/controller.K1.rate": -80.0,
    }


def test_a_systems_parameter_reaches_all_it_is_connected_to(seat_ssp: Path, tmp_path: Path):
    edit = with_system(
        connectors=(ssd.Connector(name="driver", kind="parameter", type=ssd.Type(kind="Real", unit="g")),),
        connections=lambda old: (
            *old,
            *(
                ssd.Connection(start_connector="driver", end_element=name, end_connector="driver_mass")
                for name in ("seat", "controller")
            ),
        ),
        bindings=(ssd.ParameterBinding(values=values(driver=real(70000.0))),),
    )
    system = System.load(rewritten(seat_ssp, tmp_path / "a.ssp", edit))
    assert system.parameters == {"seat.driver_mass": 70.0, "controller.driver_mass": 70.0}
    assert len(system.connections) == 6


def test_a_mapping_renames_and_transforms_after_the_conversion(seat_ssp: Path, tmp_path: Path):
    swap = ssv.Transformation(
        kind="BooleanMappingTransformation", entries=(ssv.MapEntry(source="true", target="false"),)
    )
    mapping = ssv.ParameterMapping(
        version="1.0",
        entries=(
            ssv.MappingEntry(
                source="m", target="seat.driver_mass", transformation=ssv.Transformation.of(Linear(1, 5.0))
            ),
            ssv.MappingEntry(source="m", target="seat.seat_mass", suppress_unit_conversion=True),
            ssv.MappingEntry(source="off", target="controller.enabled", transformation=swap),
        ),
    )
    given = values(
        UNITS,
        m=real(65.0, "g"),
        off=ssv.TypedValue(kind="Boolean", text="1"),
        shaker__profile=ssv.TypedValue(kind="Enumeration", text="sine"),
    )
    edit = with_system(
        bindings=(
            ssd.ParameterBinding(source="resources/p.ssv", mapping=ssd.MappingReference(source="resources/m%20m.ssm")),
        )
    )
    files = {"p__ssv": write_document(given), "m m__ssm": write_document(mapping)}
    assert System.load(rewritten(seat_ssp, tmp_path / "a.ssp", edit, **files)).parameters == {
        "seat.driver_mass": 0.065 + 5.0,
        "seat.seat_mass": 65.0,
        "controller.enabled": False,
    }


def test_parameters_may_lie_inside_the_fmu(native: Path, tmp_path: Path):
    fmu = tmp_path / "SeatPlant.fmu"
    fmu.write_bytes((native / "fmi2" / "SeatPlant.fmu").read_bytes())
    with zipfile.ZipFile(fmu, "a") as archive:
        archive.writestr("resources/p.ssv", write_document(values(driver_mass=real(70.0))))
    system = System()
    system.add("seat", fmu)
    system.save(tmp_path / "a.ssp")
    binding = ssd.ParameterBinding(source="resources/p.ssv", source_base="component")
    edit = with_system(elements=element("seat", bindings=(binding,)))
    assert System.load(rewritten(tmp_path / "a.ssp", tmp_path / "b.ssp", edit)).parameters == {"seat.driver_mass": 70.0}


def test_unknown_names_and_start_values_of_connected_inputs_are_ignored(seat_ssp: Path, tmp_path: Path):
    given = values(seat__weight=real(1.0), rig__x=real(1.0), seat__force=real(9.0))
    edit = with_system(bindings=(ssd.ParameterBinding(values=given),))
    system = System.load(rewritten(seat_ssp, tmp_path / "a.ssp", edit))
    assert system.parameters == {}
    where = f"{tmp_path / 'a.ssp' / DESCRIPTION}: parameter"
    assert system.ignored == (
        f"{where} seat.weight: ignored, as there is no seat.weight in the system",
        f"{where} rig.x: ignored, as there is no rig.x in the system",
    )


def test_a_parameter_file_is_read_for_a_run(seat_ssp: Path, tmp_path: Path):
    system = System.load(seat_ssp)
    path = tmp_path / "p.ssv"
    path.write_bytes(
        write_document(
            values(
                UNITS,
                shaker__bump__height=real(50.0, "mm"),
                shaker__profile=ssv.TypedValue(kind="Enumeration", text="sine"),
                controller__anti_windup=ssv.TypedValue(kind="Boolean", text="true"),
            )
        )
    )
    found = read_parameters(path, system)
    assert found == {"shaker.bump.height": 0.05, "shaker.profile": "sine", "controller.anti_windup": True}
    system.check_parameters(found)
    path.write_bytes(
        write_document(
            values(
                UNITS,
                seat__driver_mass=real(50.0, "mm"),
                seat__seat_mass=real(50.0, "lump"),
                seat__mass=real(1.0),
                plain=real(1.0),
                shaker__bump__height=ssv.TypedValue(kind="String", text="0.05"),
            )
        )
    )
    with pytest.raises(SetupError) as error:
        read_parameters(path, system)
    assert (
        error.value.problems
        == (
            f"{path}: seat.driver_mass: expected two units of one dimension, got mm and kg",
            f"{path}: seat.seat_mass: expected a unit that is defined or known by its name, got lump",
            f"{path}: seat.mass: expected a variable of SeatPlant.fmu, got none"
            " (did you mean seat_mass or driver_mass?)",
            f"{path}: plain: expected COMPONENT.VARIABLE",
            f"{path}: shaker.bump.height: expected a value of type Real, got String",
        )
        or "seat.mass" in error.value.problems[2]
    )
    with pytest.raises(SetupError, match=r"none.ssv: expected a parameter set \(.ssv\), got no such file"):
        read_parameters(tmp_path / "none.ssv", system)


# ---- errors ----------------------------------------------------------------------------------------------------------


def joined(start: str, end: str, **more: object) -> ssd.Connection:
    """Connect ``element.connector`` to another; without a dot, it is the system's."""
    (start_element, _, start_connector), (end_element, _, end_connector) = start.rpartition("."), end.rpartition(".")
    return ssd.Connection(
        start_element=start_element or None,
        start_connector=start_connector,
        end_element=end_element or None,
        end_connector=end_connector,
        **more,
    )


def only(*connections: ssd.Connection, **more: object) -> Edit:
    return with_system(connections=connections, **more)


def bound(name: str = "driver_mass", given: ssv.TypedValue | None = None, **more: object) -> Edit:
    binding = ssd.ParameterBinding(values=values(UNITS, **{name: given or real(70.0)}), **more)
    return with_system(elements=element("seat", bindings=(binding,)))


def connector(name: str, kind: str, of: str, unit: str | None = None) -> Edit:
    made = ssd.Connector(name=name, kind=kind, type=ssd.Type(kind=of, unit=unit))
    return with_system(elements=element("seat", connectors=(made,)), connections=())


BINARY = ssv.Transformation(kind="BooleanMappingTransformation", entries=(ssv.MapEntry(source="1", target="0"),))
BUS = ssd.SignalDictionaryReference(name="bus", dictionary="can")
THROUGH = ssd.System(
    name="through",
    connectors=(ssd.Connector(name="in", kind="input"), ssd.Connector(name="out", kind="output")),
    connections=(joined("in", "out"),),
)
INSIDE = ssd.ParameterBinding(source="p.ssv", source_base="component")
PLAIN = ssd.Connector(name="plain", kind="input")

WRONG = {
    "missing fmu": (
        with_system(elements=element("seat", source="resources/Chair.fmu")),
        "resources/Chair.fmu: expected a file in the archive, got none of that name",
    ),
    "no fmu": (
        with_system(elements=element("seat", source="resources/text.txt")),
        "resources/text.txt: expected an FMU .a zip archive., got another kind of file",
    ),
    "outside": (
        with_system(elements=element("seat", source="../SeatPlant.fmu")),
        "expected a source in the folder of the description, got '../SeatPlant.fmu'",
    ),
    "absolute": (
        with_system(elements=element("seat", source="/SeatPlant.fmu")),
        "expected a source in the folder of the description, got '/SeatPlant.fmu'",
    ),
    "elsewhere": (
        with_system(elements=element("seat", source="https://example.org/SeatPlant.fmu")),
        "expected a source in the folder of the description, got 'https://example.org/SeatPlant.fmu'",
    ),
    "in the document": (with_system(elements=element("seat", source="#seat")), "got '#seat'"),
    "nested package": (
        with_system(elements=element("seat", type="application/x-ssp-package")),
        "component seat: expected type application/x-fmu-sharedlibrary, got application/x-ssp-package",
    ),
    "model exchange": (
        with_system(elements=element("seat", implementation="ModelExchange")),
        "component seat: expected a co-simulation, got ModelExchange",
    ),
    "one name twice": (
        with_system(elements=element("seat", name="shaker"), connections=()),
        "element shaker: expected a new name, got one that is there already",
    ),
    "connector of no variable": (
        connector("force_", "input", "Real"),
        r"seat.force_: expected a variable of SeatPlant.fmu, got none \(did you mean force",
    ),
    "connector's kind": (
        connector("force", "output", "Real"),
        "connector seat.force: expected the FMU's kind input, got output",
    ),
    "connector's type": (
        connector("force", "input", "Boolean"),
        "connector seat.force: expected the FMU's type Real, got Boolean",
    ),
    "connector's unit": (
        connector("floor_displacement", "input", "Real", "mm"),
        "connector seat.floor_displacement: expected the FMU's unit m, got mm of another definition",
    ),
    "unknown element": (
        only(joined("shake.floor_velocity", "seat.floor_velocity")),
        r"connection shake.floor_velocity -> seat.floor_velocity: expected an element of the system, got shake \(did",
    ),
    "unknown variable": (
        only(joined("shaker.floor_velocty", "seat.floor_velocity")),
        "shaker.floor_velocty: expected a variable of Shaker.fmu, got none",
    ),
    "unknown connector": (only(joined("floor", "seat.floor_velocity")), "floor: expected a connector of the system"),
    "two outputs": (
        only(joined("shaker.floor_velocity", "seat.seat_acceleration")),
        "expected a source and a sink, got output and output",
    ),
    "an outermost input to an output": (
        only(joined("plain", "shaker.floor_velocity"), connectors=(PLAIN,)),
        "expected a source and a sink, got input and output",
    ),
    "a parameter to an output": (
        only(joined("plain", "seat.seat_acceleration"), connectors=(ssd.Connector(name="plain", kind="parameter"),)),
        "expected a source and a sink, got parameter and output",
    ),
    "fed twice": (
        only(joined("controller.force", "seat.force"), joined("seat.force", "controller.force_demand")),
        "controller.force_demand: expected a free seat.force, got one that controller.force feeds",
    ),
    "dimensions": (
        only(joined("shaker.floor_velocity", "seat.force")),
        "connection shaker.floor_velocity -> seat.force: expected two units of one dimension, got m/s and N",
    ),
    "table in a connection": (
        only(joined("controller.force", "seat.force", transformation=BINARY)),
        "expected a LinearTransformation, got a BooleanMappingTransformation",
    ),
    "signal dictionary": (
        only(joined("bus.x", "seat.force"), elements=lambda old: (*old, BUS)),
        "connection bus.x -> seat.force: expected components and systems, got the signal dictionary bus",
    ),
    "loop without a component": (
        only(
            joined("through.out", "other.in"),
            joined("other.out", "through.in"),
            elements=lambda old: (*old, THROUGH, replace(THROUGH, name="other")),
            bindings=(ssd.ParameterBinding(values=values(through__in=real(1.0))),),
        ),
        "expected a path from a component, got a loop of systems' connectors",
    ),
    "parameter of another dimension": (
        bound(given=real(70.0, "mm")),
        "parameter driver_mass: expected two units of one dimension, got mm and kg",
    ),
    "parameter in an unknown unit": (
        bound(given=real(70.0, "lump")),
        "parameter driver_mass: expected a unit that is defined or known by its name, got lump",
    ),
    "parameter out of range": (
        bound(given=real(-1.0)),
        r"parameter driver_mass: seat.driver_mass: expected a value in \[1e-09, inf\] kg, got -1.0",
    ),
    "parameter that is none": (
        bound("seat_acceleration"),
        "seat.seat_acceleration: expected a parameter or an input, got an output",
    ),
    "a system's output": (
        with_system(
            connectors=(ssd.Connector(name="out", kind="output"),),
            bindings=(ssd.ParameterBinding(values=values(out=real(1.0))),),
        ),
        "parameter out: expected a parameter or an input, got the system's output out",
    ),
    "binary parameter": (
        bound(given=ssv.TypedValue(kind="Binary", text="00")),
        "parameter driver_mass: expected a number, Boolean or text, got Binary",
    ),
    "text for a number": (
        bound(given=ssv.TypedValue(kind="String", text="70")),
        "seat.driver_mass: expected a value of type Real, got String",
    ),
    "parameters of another type": (
        bound(type="text/csv"),
        "expected type .*parameter-set, got text/csv",
    ),
    "missing parameters": (
        with_system(bindings=(ssd.ParameterBinding(source="resources/none.ssv"),)),
        "resources/none.ssv: expected a file in the archive, got none of that name",
    ),
    "broken parameters": (
        with_system(bindings=(ssd.ParameterBinding(source="resources/text.txt"),)),
        "resources/text.txt: expected XML, got",
    ),
    "parameters missing inside the FMU": (
        with_system(
            elements=element("seat", bindings=(ssd.ParameterBinding(source="p.ssv", source_base="component"),))
        ),
        "resources/SeatPlant.fmu/p.ssv: expected a file in the archive, got none of that name",
    ),
    "parameters inside a system": (
        with_system(bindings=(INSIDE,)),
        "expected sourceBase SSD for a system, got component",
    ),
    "algorithm": (
        lambda description: replace(
            description,
            experiment=ssd.DefaultExperiment(
                annotations=(ssd.Annotation(type=ssd.Annotation.OWN, content=ssd.Exchange(algorithm="magic")),)
            ),
        ),
        "exchange: expected one of gauss-seidel, jacobi, got magic",
    ),
}


@pytest.mark.parametrize("case", WRONG)
def test_a_wrong_system_is_one_error(seat_ssp: Path, tmp_path: Path, case: str):
    edit, problem = WRONG[case]
    path = rewritten(seat_ssp, tmp_path / "Wrong.ssp", edit, text__txt=b"hello")
    with pytest.raises(SetupError, match=problem) as error:
        System.load(path)
    assert len(error.value.problems) == 1
    assert str(error.value).startswith(str(path))


def test_all_problems_are_reported_at_once(seat_ssp: Path, tmp_path: Path):
    wrong = (joined("nobody.x", "seat.force"), joined("shaker.y", "seat.floor_velocity"))
    edit = only(*wrong, elements=element("controller", source="resources/none.fmu"))
    with pytest.raises(SetupError) as error:
        System.load(rewritten(seat_ssp, tmp_path / "a.ssp", edit))
    assert len(error.value.problems) == 3


def test_invalid_packages_are_errors(seat_ssp: Path, tmp_path: Path):
    with pytest.raises(SetupError, match=r"none.ssp: expected a system structure .*, got no such file"):
        System.load(tmp_path / "none.ssp")
    with pytest.raises(SetupError, match=r"none.ssd: expected a system structure, got no such file"):
        System.load(tmp_path / "none.ssd")
    (tmp_path / "text.ssp").write_text("hello")
    with pytest.raises(SetupError, match=r"text.ssp: expected an .ssp file .*, got another kind of file"):
        System.load(tmp_path / "text.ssp")
    cut = tmp_path / "cut.ssp"
    cut.write_bytes(seat_ssp.read_bytes()[:-100])
    with pytest.raises(SetupError, match="got another kind of file"):
        System.load(cut)
    with zipfile.ZipFile(tmp_path / "empty.ssp", "w") as archive:
        archive.writestr("readme.txt", "nothing")
    with pytest.raises(SetupError, match=r"empty.ssp/SystemStructure.ssd: expected a file in the archive, got none"):
        System.load(tmp_path / "empty.ssp")


@pytest.mark.parametrize("name", ["../out.txt", "/out.txt", "a/../../out.txt", "c:/out.txt", "..\\out.txt"])
def test_an_archive_with_a_path_that_leaves_it_is_refused(seat_ssp: Path, tmp_path: Path, name: str):
    path = tmp_path / "bad.ssp"
    path.write_bytes(seat_ssp.read_bytes())
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr(name, "out")
    with pytest.raises(SetupError, match=r"bad.ssp: member .*: expected a relative path"):
        System.load(path)


def test_a_damaged_member_is_named(seat_ssp: Path, tmp_path: Path):
    content = bytearray(seat_ssp.read_bytes())
    with zipfile.ZipFile(seat_ssp) as archive:
        place = archive.getinfo("resources/SeatPlant.fmu").header_offset
    content[place + 5000 : place + 5100] = bytes(100)
    (tmp_path / "bad.ssp").write_bytes(content)
    with pytest.raises(SetupError, match=r"bad.ssp/resources/SeatPlant.fmu: expected an? .*") as error:
        System.load(tmp_path / "bad.ssp")
    assert len(error.value.problems) == 1


def test_a_system_that_cannot_be_written_is_an_error(seat_ssp: Path, tmp_path: Path):
    (tmp_path / "file").write_text("a file")
    with pytest.raises(SetupError, match="file: expected a folder to write to, got"):
        System.load(seat_ssp).save(tmp_path / "file" / "a.ssp")


def test_the_step_size_of_other_tools_is_read(seat_ssp: Path, tmp_path: Path):
    def edit(description: ssd.SystemStructureDescription) -> ssd.SystemStructureDescription:
        fixed = ssd.OspAlgorithm(fixed_step=ssd.FixedStep(base_step_size=0.001))
        annotations = (ssd.Annotation(type="of.others"), ssd.Annotation(type=ssd.Annotation.OSP, content=fixed))
        return replace(description, experiment=ssd.DefaultExperiment(stop_time=2.0, annotations=annotations))

    system = System.load(rewritten(seat_ssp, tmp_path / "a.ssp", edit))
    assert (system.step_size, system.stop_time) == (0.001, 2.0)


def test_an_experiment_may_start_later(seat_ssp: Path, tmp_path: Path):
    def edit(description: ssd.SystemStructureDescription) -> ssd.SystemStructureDescription:
        return replace(description, experiment=ssd.DefaultExperiment(start_time=1.0, stop_time=2.0))

    system = System.load(rewritten(seat_ssp, tmp_path / "a.ssp", edit))
    assert (system.start_time, system.stop_time) == (1.0, 2.0)
