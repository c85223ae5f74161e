"""The native FMUs: valid, complete, reproducible, and the same in every flavour, from every compiler."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import zipfile
from importlib.metadata import PackageNotFoundError
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.build import build_platform_binary
from fmpy.fmi1 import FMICallException
from fmpy.util import read_ref_opt_file
from fmpy.validation import validate_fmu
from lxml import etree

from cosim import RunError, System
from cosim.fmi.description import ModelDescription
from cosim.fmi.instance import Experiment
from cosim.fmi.versions import instantiate
from fmus.component import Component
from fmus.export import compiler
from fmus.export import native_fmu as native_build
from fmus.export.fmu_file import BuildError
from fmus.export.native_fmu import PLATFORMS, STANDARDS, build_native_fmu, compile_binary, host_platform, source_files
from fmus.export.sources import kernel_files
from seat_cosim.components import COMPONENTS, EXPERIMENT
from seat_cosim.scenarios import SCENARIOS, control, seat_suspension
from tests.helpers.compare import relative_rms
from tests.helpers.files import read_csv
from tests.helpers.paths import DATA, NATIVE, ROOT
from tests.helpers.reference import Case, bump, open_loop

H = 0.002
SAME = 1e-9
"""Relative difference up to which flavours agree; measured on one machine: none at all."""

SYSTEM = COMPONENTS[:3]
"""Those of the seat suspension: controller, seat, shaker."""

EACH = [(flavour, component) for flavour in NATIVE for component in COMPONENTS]
each = pytest.mark.parametrize(("flavour", "component"), EACH, ids=[f"{f}-{c.name}" for f, c in EACH])
linux = pytest.mark.skipif(sys.platform != "linux", reason="looks at Linux binaries")


def fmu(folder: Path, flavour: str, component: Component) -> Path:
    return folder / flavour / f"{component.name}.fmu"


def largest_relative(found: np.ndarray, expected: np.ndarray) -> float:
    """Largest difference as a share of the largest value."""
    scale = np.abs(expected).max()
    return float(np.abs(found - expected).max() / scale) if scale else float(np.abs(found).max())


# ---- description -----------------------------------------------------------------------------------------------------


@each
def test_fmpy_validate_finds_nothing(native: Path, flavour: str, component: Component):
    assert validate_fmu(str(fmu(native, flavour, component))) == []


@each
def test_description_agrees_with_the_declaration(native: Path, flavour: str, component: Component):
    description = fmpy.read_model_description(str(fmu(native, flavour, component)))
    assert description.fmiVersion == STANDARDS[flavour].version
    assert not description.coSimulation.needsExecutionTool
    assert description.coSimulation.canGetAndSetFMUstate
    assert description.coSimulation.canSerializeFMUstate
    assert float(description.defaultExperiment.stepSize) == H
    assert len(description.modelVariables) == len(component.variables)
    kernels = [path.name for path in kernel_files(component.module) if path.suffix == ".c"]
    compiled = description.buildConfigurations[0].sourceFileSets[0].sourceFiles
    assert sorted(compiled) == sorted([*kernels, f"{flavour}.c", "instance.c", "paths.c"])
    for reference, (found, declared) in enumerate(zip(description.modelVariables, component.variables, strict=True)):
        assert (found.name, found.valueReference) == (declared.name, reference)
        assert (found.causality, found.variability, found.unit, found.description) == (
            declared.causality,
            declared.variability,
            declared.unit,
            declared.description,
        )
        for attribute, value in (("min", declared.minimum), ("max", declared.maximum), ("nominal", declared.nominal)):
            text = getattr(found, attribute)
            if declared.type is float:
                assert (None if text is None else float(text)) == value, f"{attribute} of {found.name}"


def test_the_controller_declares_its_internal_step_size(native: Path):
    sizes = {
        component.name: fmpy.read_model_description(
            str(fmu(native, "fmi3", component))
        ).coSimulation.fixedInternalStepSize
        for component in COMPONENTS
    }
    assert sizes.pop("SeatController") == str(H)
    assert set(sizes.values()) == {None}


def test_terminals_follow_the_schema_and_fit_together(native: Path):
    schema = etree.XMLSchema(file=str(Path(fmpy.__file__).parent / "schema" / "fmi3" / "fmi3TerminalsAndIcons.xsd"))
    plugs: dict[str, list[list[str]]] = {}
    for component in COMPONENTS:
        with zipfile.ZipFile(fmu(native, "fmi3", component)) as archive:
            root = etree.fromstring(archive.read("terminalsAndIcons/terminalsAndIcons.xml"))
        schema.assertValid(root)
        for terminal in root.iter("Terminal"):
            members = terminal.findall("TerminalMemberVariable")
            assert {m.get("variableName") for m in members} <= {v.name for v in component.variables}
            plugs.setdefault(terminal.get("name"), []).append([m.get("memberName") for m in members])
    assert set(plugs) == {"floor", "sensors", "actuator", "reaction", "driver"}
    assert all(len(members) >= 2 and all(each == members[0] for each in members) for members in plugs.values())


def test_build_descriptions_follow_the_schema_and_name_the_compiler_of_their_options(native: Path):
    schema = etree.XMLSchema(file=str(Path(fmpy.__file__).parent / "schema" / "fmi3" / "fmi3BuildDescription.xsd"))
    for component in COMPONENTS:
        with zipfile.ZipFile(fmu(native, "fmi3", component)) as archive:
            root = etree.fromstring(archive.read("sources/buildDescription.xml"))
            names = set(archive.namelist())
        schema.assertValid(root)
        sets = root.findall("BuildConfiguration/SourceFileSet")
        assert sets
        for each_set in sets:
            assert each_set.get("compilerOptions")
            assert each_set.get("compiler") == "gcc"
            files = [file.get("name") for file in each_set.findall("SourceFile")]
            assert files
            assert {f"sources/{name}" for name in files} <= names


@each
def test_an_fmu_carries_its_page_licence_and_sources(native: Path, flavour: str, component: Component):
    with zipfile.ZipFile(fmu(native, flavour, component)) as archive:
        names = set(archive.namelist())
        page = archive.read("documentation/index.html").decode()
        licence = archive.read(STANDARDS[flavour].license_file).decode()
        assert {info.date_time for info in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}
        assert not [name for name in names if str(ROOT).encode() in archive.read(name)]
    assert {f"sources/{name}" for name in source_files(component, STANDARDS[flavour], "")} <= names
    assert licence == (ROOT / "LICENSE").read_text(encoding="utf-8")
    etree.fromstring(page.replace("<!DOCTYPE html>", "").replace('<meta charset="utf-8">', ""))
    for variable in component.variables:
        assert f"<td>{variable.name}</td>" in page


# ---- flavours --------------------------------------------------------------------------------------------------------


def columns(system: System, parameters: dict[str, float | bool | str], stop_time: float = 3.0) -> dict[str, np.ndarray]:
    return dict(system.simulate(stop_time, H, parameters).values)


@pytest.mark.parametrize("parameters", [control(False), control(True), {"controller.observer_gamma": -1e-6}], ids=str)
def test_flavours_agree_on_the_bump(fmus: Path, native: Path, parameters: dict[str, float | bool | str]):
    found = {f: columns(seat_suspension(native / f), parameters) for f in (*NATIVE, "python")}
    assert np.abs(found["python"]["seat.driver_acceleration"]).max() > 1.0
    for flavour in NATIVE:
        for name, expected in found["python"].items():
            assert largest_relative(found[flavour][name], expected) < SAME, (flavour, name)


def random_floor(random: np.random.Generator, names: list[str], stop_time: float) -> np.ndarray:
    """Inputs that are sums of many sines; the floor's velocity and acceleration are its displacement's derivatives."""
    t = H * np.arange(round(stop_time / H) + 1)
    w = 2 * np.pi * random.uniform(0.5, 15.0, 30)
    phase, size = random.uniform(0, 2 * np.pi, 30), random.normal(0.0, 1.0, 30)
    motion = {
        "floor_displacement": 0.02 * np.sin(np.outer(t, w) + phase) @ (size / w),
        "floor_velocity": 0.02 * np.cos(np.outer(t, w) + phase) @ size,
        "floor_acceleration": -0.02 * np.sin(np.outer(t, w) + phase) @ (size * w),
        "force": 200.0 * np.sign(np.sin(9.0 * t)) + random.normal(0.0, 20.0, len(t)),
        "seat_acceleration": random.normal(0.0, 2.0, len(t)),
        "suspension_deflection": 0.03 * np.sin(11.0 * t) + random.normal(0.0, 1e-4, len(t)),
        "seat_force": 300.0 * np.sign(np.sin(13.0 * t)),
    }
    motion |= {"seat_displacement": motion["floor_displacement"], "seat_velocity": motion["floor_velocity"]}
    motion["driver_force"] = 150.0 * np.sin(7.0 * t)
    table = np.zeros(len(t), dtype=[("time", float), *((name, float) for name in names)])
    table["time"] = t
    for name in names:
        table[name] = motion[name]
    return table


@pytest.mark.parametrize("component", COMPONENTS[:2], ids=lambda c: c.name)
def test_flavours_agree_on_random_inputs(fmus: Path, native: Path, component: Component):
    inputs = random_floor(
        np.random.default_rng(7), [v.name for v in component.variables if v.causality == "input"], stop_time=4.0
    )
    found = {
        f: fmpy.simulate_fmu(str(fmu(native, f, component)), stop_time=4.0, output_interval=H, input=inputs)
        for f in (*NATIVE, "python")
    }
    for flavour in NATIVE:
        for name in found["python"].dtype.names:
            expected = found["python"][name].astype(float)
            assert expected.any() or name.endswith("_trusted"), name  # of the mode robust
            assert largest_relative(found[flavour][name].astype(float), expected) < SAME, (flavour, name)


@pytest.mark.parametrize("flavour", NATIVE)
@pytest.mark.parametrize("name", ["bump55_uncontrolled", "bump55_observer1"])
def test_bump_agrees_with_the_golden_data(native: Path, flavour: str, name: str):
    expected = read_csv(DATA / f"{name}.csv")
    found = columns(seat_suspension(native / flavour), {**SCENARIOS["bump"].parameters, **control("observer" in name)})
    assert relative_rms(found["seat.driver_acceleration"], expected["driver_acceleration"]) < 1e-3
    assert relative_rms(found["seat.suspension_deflection"], expected["suspension_deflection"]) < 5e-3


def test_fmi_2_and_fmi_3_run_together(native: Path):
    one = seat_suspension(native / "fmi2")
    mixed = System()
    for name, model in one.models.items():
        mixed.add(name, native / ("fmi3" if name == "seat" else "fmi2") / model.path.name)
    for sink, feed in one.connections.items():
        mixed.connect(str(feed.source), str(sink))
    mixed.order = one.order
    expected = columns(one, control(True), 0.5)
    for name, values in columns(mixed, control(True), 0.5).items():
        assert largest_relative(values, expected[name]) < SAME, name


def test_types_and_units_are_compared_across_versions(native: Path):
    system = System()
    system.add("controller", native / "fmi3" / "SeatController.fmu")
    system.add("seat", native / "fmi2" / "SeatPlant.fmu")
    system.connect("controller.saturated", "seat.force")  # a Boolean is a number, and has no unit
    system.disconnect("seat.force")
    with pytest.raises(Exception, match="expected two units of one dimension, got N.m and N"):
        system.connect("controller.motor_torque", "seat.force")
    system.connect("controller.force", "seat.force")


@each
def test_cross_check_files_are_what_a_host_gets(native: Path, flavour: str, component: Component):
    path = fmu(native, flavour, component)
    beside = {ending: path.with_name(f"{component.name}_{ending}") for ending in ("in.csv", "ref.csv", "ref.opt")}
    settings = read_ref_opt_file(str(beside["ref.opt"]))
    inputs = fmpy.util.read_csv(str(beside["in.csv"])) if beside["in.csv"].exists() else None
    expected = fmpy.util.read_csv(str(beside["ref.csv"]))
    found = fmpy.simulate_fmu(
        str(path), stop_time=settings["StopTime"], output_interval=settings["StepSize"], input=inputs
    )
    assert (inputs is None) == (component.name == "Shaker")
    for name in expected.dtype.names:
        assert largest_relative(found[name].astype(float), expected[name].astype(float)) < SAME, name


# ---- accuracy at any communication step ------------------------------------------------------------------------------

KNOTS = 0.02
"""The prescribed force changes every 20 ms, which all the steps divide."""


def prescribed_force(t: float) -> float:
    return 100.0 * np.sin(9.0 * KNOTS * np.floor(t / KNOTS + 1e-6))


@pytest.mark.parametrize(("mass", "speed"), [(55.0, 1.0), (120.0, 1.5), (45.0, 1.5), (120.0, 0.5)])
def test_the_seat_alone_is_accurate_at_any_communication_step(native: Path, mass: float, speed: float):
    """Bound 1 %; README and docs/reference/accuracy-and-speed.md state what is measured."""
    stop, finest = 1.6, 0.5e-3
    floor = bump(speed=speed)
    times = finest * np.arange(round(stop / finest) + 1)
    exact = open_loop(Case(m_b=mass), floor, prescribed_force, KNOTS, times)
    for step in (0.5e-3, 1e-3, 2e-3, 4e-3, 10e-3):
        t = step * np.arange(round(stop / step) + 1)
        names = ["floor_displacement", "floor_velocity", "floor_acceleration", "force"]
        inputs = np.array(
            [(x, *floor(x), prescribed_force(x)) for x in t.tolist()],
            dtype=[("time", float), *((n, float) for n in names)],
        )
        found = fmpy.simulate_fmu(
            str(native / "fmi2" / "SeatPlant.fmu"),
            stop_time=stop,
            output_interval=step,
            input=inputs,
            start_values={"driver_mass": mass},
        )
        every = round(step / finest)
        errors = [
            relative_rms(found[name][: len(exact[::every])], exact[::every, i])
            for i, name in enumerate(("driver_acceleration", "suspension_deflection"))
        ]
        print(
            f"{mass:g} kg, {speed:g} m/s, {1e3 * step:g} ms: {errors[0]:.2e} acceleration, {errors[1]:.2e} deflection"
        )
        assert max(errors) < 0.01


# ---- behaviour through a host ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("flavour", NATIVE)
def test_a_driver_outside_the_range_is_warned_of_once(native: Path, flavour: str):
    result = seat_suspension(native / flavour).simulate(0.02, H, {"controller.driver_mass": 120.0})
    call = {"fmi2": "fmi2GetReal", "fmi3": "fmi3GetFloat64"}[flavour]  # where outputs are computed
    assert result.warnings == [
        "controller: driver_mass lies outside [driver_mass_min, driver_mass_max]: the gains of the nearer end are used"
        f"; got driver_mass = 120 kg, driver_mass_min = 45 kg, driver_mass_max = 80 kg ({call}, t = 0 s)"
    ]


@pytest.mark.parametrize("flavour", NATIVE)
def test_contradicting_parameters_fail_on_leaving_the_initialisation(native: Path, flavour: str):
    system = seat_suspension(native / flavour)
    with pytest.raises(RunError, match=r"ExitInitializationMode failed .*friction\.gamma = 1 1/m2, friction\.beta"):
        system.simulate(0.02, H, {"seat.friction.gamma": 1.0})
    with pytest.raises(RunError, match="expected a fastest motion below 50000 rad/s"):
        system.simulate(0.02, H, {"seat.cushion_stiffness": 1e13})


@pytest.mark.parametrize("flavour", NATIVE)
def test_a_tuned_mass_takes_effect_at_the_next_sample(native: Path, flavour: str, tmp_path: Path):
    model = ModelDescription.read(native / flavour / "SeatController.fmu")
    model.extract(tmp_path)
    forces = []
    for tuned_before in (True, False):
        instance = instantiate("it", model, tmp_path)
        try:
            instance.enter_initialization(Experiment(0.0, 1.0), {"driver_mass": 75.0} if tuned_before else {})
            instance.exit_initialization()
            instance._set({"driver_mass": 75.0, "suspension_deflection": 0.01, "seat_acceleration": 0.5})
            instance.step(0.0, H)
            get = instance.fmu.getReal if flavour == "fmi2" else instance.fmu.getFloat64
            forces.append(get([model.variables["force"].valueReference])[0])
            with pytest.raises(FMICallException):
                instance._set({"observer_gamma": -1e-6})
            assert (
                "observer_gamma: a fixed parameter may not be set while stepping" in instance.messages.messages[-1].text
            )
        finally:
            instance.free()
    assert forces[0] == forces[1] != 0.0


def test_the_fmus_print_nothing(native: Path, capfd: pytest.CaptureFixture[str]):
    for flavour in NATIVE:
        with pytest.raises(RunError):
            seat_suspension(native / flavour).simulate(0.02, H, {"controller.driver_mass_min": 100.0})
    assert capfd.readouterr() == ("", "")


# ---- build -----------------------------------------------------------------------------------------------------------


def test_builds_are_bit_identical_and_left_alone(native: Path, tmp_path: Path):
    component = COMPONENTS[0]
    for flavour in NATIVE:
        built = build_native_fmu(flavour, component, EXPERIMENT, tmp_path / flavour)
        assert built.fresh
        assert built.path.read_bytes() == fmu(native, flavour, component).read_bytes()
        assert not build_native_fmu(flavour, component, EXPERIMENT, tmp_path / flavour).fresh


def test_the_guid_follows_the_sources_and_the_compiler(native: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    guids = [fmpy.read_model_description(str(native / "fmi2" / "Shaker.fmu")).guid]
    with monkeypatch.context() as patch:
        compiler = native_build.find_compiler()
        patch.setattr(native_build, "find_compiler", lambda: compiler._replace(version="another"))
        guids.append(
            fmpy.read_model_description(str(build_native_fmu("fmi2", COMPONENTS[2], EXPERIMENT, tmp_path).path)).guid
        )
    with monkeypatch.context() as patch:
        sources = native_build.source_files
        patch.setattr(native_build, "source_files", lambda *a: {**sources(*a), "extra.h": b"/* a change */\n"})
        guids.append(
            fmpy.read_model_description(str(build_native_fmu("fmi2", COMPONENTS[2], EXPERIMENT, tmp_path).path)).guid
        )
    assert len(set(guids)) == 3


def test_a_missing_platform_is_built_and_a_failing_compiler_reported(
    native: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    with pytest.raises(BuildError, match="expected a platform among x86_64-linux, .*, got vax"):
        build_native_fmu("fmi2", COMPONENTS[2], EXPERIMENT, tmp_path, ["vax"])
    shutil.copy(fmu(native, "fmi3", COMPONENTS[2]), tmp_path / "Shaker.fmu")
    monkeypatch.setattr(native_build, "compile_binary", lambda *a: b"binary")
    both = build_native_fmu("fmi3", COMPONENTS[2], EXPERIMENT, tmp_path, ["x86_64-linux", "aarch64-darwin"])
    assert both.fresh
    assert native_build.platforms_of(both.path) == {"x86_64-linux", "aarch64-darwin"}
    monkeypatch.undo()
    with pytest.raises(BuildError, match=r"Shaker for x86_64-linux: zig ended with 1: .*error"):
        compile_binary("Shaker", {"shaker.c": b"no C"}, PLATFORMS["x86_64-linux"])


@pytest.mark.long
@linux
def test_without_zig_the_machines_compiler_gives_the_same_results(
    native: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    def missing(package: str) -> str:
        raise PackageNotFoundError(package)

    monkeypatch.setattr(compiler, "version", missing)
    for component in SYSTEM:
        build_native_fmu("fmi2", component, EXPERIMENT, tmp_path)
    guids = {fmpy.read_model_description(str(f / "Shaker.fmu")).guid for f in (tmp_path, native / "fmi2")}
    assert len(guids) == 2
    parameters = {**SCENARIOS["random"].parameters, **control(True)}
    ours, theirs = (seat_suspension(folder).simulate(3.0, H, parameters) for folder in (tmp_path, native / "fmi2"))
    assert np.array_equal(ours.rows, theirs.rows)
    with pytest.raises(BuildError, match="Shaker for x86_64-windows: expected the compiler zig, .* got none; run: pip"):
        build_native_fmu("fmi2", COMPONENTS[2], EXPERIMENT, tmp_path, ["x86_64-windows"])
    monkeypatch.setattr(compiler.shutil, "which", lambda name: None)
    with pytest.raises(BuildError, match="expected a C compiler, got none; run: pip install"):
        build_native_fmu("fmi2", COMPONENTS[2], EXPERIMENT, tmp_path)


def declared_functions(flavour: str) -> set[str]:
    header = source_files(COMPONENTS[0], STANDARDS[flavour], "")[f"{flavour}Functions.h"].decode(errors="replace")
    return set(re.findall(rf"_Export +{flavour}\w+TYPE +({flavour}\w+);", header))


@linux
@each
def test_every_function_of_the_standard_is_exported_and_nothing_else(
    native: Path, flavour: str, component: Component, tmp_path: Path
):
    binary = tmp_path / "it.so"
    with zipfile.ZipFile(fmu(native, flavour, component)) as archive:
        folder = PLATFORMS[host_platform()].folder(STANDARDS[flavour].version)
        binary.write_bytes(archive.read(f"binaries/{folder}/{component.name}.so"))
    symbols = subprocess.run(["nm", "-D", binary], capture_output=True, text=True, check=True).stdout
    exported = set(re.findall(r" [TDBRW] (\w+)", symbols))
    assert len(declared_functions(flavour)) == {"fmi2": 44, "fmi3": 75}[flavour]
    assert exported == declared_functions(flavour)
    needed = {tuple(map(int, v.split("."))) for v in re.findall(r"GLIBC_([\d.]+)", symbols)}
    assert max(needed) <= (2, 17)


@pytest.mark.skipif(shutil.which("cmake") is None, reason="cmake is not installed")
@pytest.mark.parametrize(
    ("flavour", "component"),
    [
        pytest.param(f, c, id=f"{f}-{c.name}", marks=[] if c.name == "SeatController" else [pytest.mark.long])
        for f, c in EACH
    ],
)
def test_fmpy_compiles_the_shipped_sources_to_the_same(
    native: Path, flavour: str, component: Component, tmp_path: Path
):
    folder = tmp_path / "fmu"
    fmpy.extract(str(fmu(native, flavour, component)), str(folder))
    shutil.rmtree(folder / "binaries")
    build_platform_binary(folder)
    inputs = [v.name for v in component.variables if v.causality == "input"]
    found = [
        fmpy.simulate_fmu(
            str(path),
            stop_time=1.0,
            output_interval=H,
            input=random_floor(np.random.default_rng(1), inputs, 1.0) if inputs else None,
        )
        for path in (folder, fmu(native, flavour, component))
    ]
    for name in found[1].dtype.names:
        assert largest_relative(found[0][name].astype(float), found[1][name].astype(float)) < SAME, name


# ---- other platforms -------------------------------------------------------------------------------------------------


def bump_by(command: list[str], platform: str, native: Path, fmus: dict[str, bytes], folder: Path) -> np.ndarray:
    """Run the bump in a host program of that platform; returns the driver's acceleration over time."""
    lines = []
    for component in SYSTEM:
        description = fmpy.read_model_description(str(native / "fmi2" / f"{component.name}.fmu"))
        library = component.name + PLATFORMS[platform].extension
        (folder / library).write_bytes(fmus[component.name])
        lines += [
            f'#define {component.name}_guid "{description.guid}"',
            f'#define {component.name}_library "./{library}"',
        ]
        lines += [f"#define {component.name}_{v.field} {i}" for i, v in enumerate(component.variables)]
    (folder / "ports.h").write_text("\n".join(lines) + "\n", encoding="utf-8")
    for name in STANDARDS["fmi2"].headers:
        shutil.copy(Path(fmpy.__file__).parent / "c-code" / name, folder)
    shutil.copy(ROOT / "tests/native/host.c", folder)
    program = "host.exe" if platform.endswith("windows") else "./host"
    target = PLATFORMS[platform].target
    built = [sys.executable, "-m", "ziglang", "cc", "-target", target, "-std=c99", "-O1", "host.c", "-o", program]
    subprocess.run([*built, *([] if platform.endswith("windows") else ["-ldl"])], cwd=folder, check=True)
    run = subprocess.run([*command, program], cwd=folder, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
    return np.array([float(line) for line in run.stdout.split()])


def binaries(platform: str, native: Path) -> dict[str, bytes]:
    """Compile the FMUs' own sources for a platform."""
    found = {}
    for component in SYSTEM:
        guid = fmpy.read_model_description(str(native / "fmi2" / f"{component.name}.fmu")).guid
        sources = source_files(component, STANDARDS["fmi2"], guid)
        found[component.name] = compile_binary(component.name, sources, PLATFORMS[platform])
    return found


EMULATORS = {
    "x86_64-windows": ("wine", "wine64", "/usr/lib/wine/wine64"),
    "aarch64-linux": ("qemu-aarch64", "qemu-aarch64-static"),
}


@pytest.mark.parametrize(
    "platform",
    [
        host_platform(),
        "aarch64-linux",
        pytest.param("x86_64-windows", marks=pytest.mark.long),  # the compiler builds its C runtime first: minutes
    ],
)
def test_the_bump_is_the_same_in_a_c_host_on_every_platform(platform: str, native: Path, tmp_path: Path):
    command: list[str] = []
    if platform != host_platform():
        emulator = next(filter(None, map(shutil.which, EMULATORS[platform])), None)
        if emulator is None:
            pytest.skip(f"{' or '.join(EMULATORS[platform])} is not installed: {platform} cannot be run here")
        command = [emulator]
        if platform == "aarch64-linux":
            libraries = os.environ.get("QEMU_LD_PREFIX", "/usr/aarch64-linux-gnu")
            if not Path(libraries, "lib").exists():
                pytest.skip("libc6-arm64-cross is not installed: no C library for aarch64-linux")
            command += ["-L", libraries]
    found = bump_by(command, platform, native, binaries(platform, native), tmp_path)
    expected = columns(seat_suspension(native / "fmi2"), control(True))["seat.driver_acceleration"]
    assert largest_relative(found, expected) < SAME


@pytest.fixture(scope="session")
def everywhere(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """FMUs with binaries for all platforms."""
    folder = tmp_path_factory.mktemp("everywhere")
    for flavour in NATIVE:
        for component in COMPONENTS:
            build_native_fmu(flavour, component, EXPERIMENT, folder / flavour, tuple(PLATFORMS))
    return folder


@pytest.mark.long
@each
def test_fmus_for_all_platforms_are_small_and_valid(everywhere: Path, flavour: str, component: Component):
    path = fmu(everywhere, flavour, component)
    print(f"{path.name} {flavour}: {path.stat().st_size / 1024:.0f} kB")
    assert path.stat().st_size < 400_000
    assert validate_fmu(str(path)) == []
    assert native_build.platforms_of(path) == {p.folder(STANDARDS[flavour].version) for p in PLATFORMS.values()}


@pytest.mark.long
def test_builds_for_all_platforms_are_bit_identical(everywhere: Path, tmp_path: Path):
    built = build_native_fmu("fmi3", COMPONENTS[1], EXPERIMENT, tmp_path, tuple(PLATFORMS))
    assert built.path.read_bytes() == fmu(everywhere, "fmi3", COMPONENTS[1]).read_bytes()
