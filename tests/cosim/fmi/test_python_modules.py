"""FMUs of Python scripts share the modules of their process: each must run its own code, whatever its names are."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from collections.abc import Callable
from itertools import count
from pathlib import Path
from types import SimpleNamespace

import pytest

from cosim import System
from cosim.engine import session
from cosim.errors import RunError, SetupError
from cosim.results.result import Result

SCRIPTS = {
    "pythonfmu": """
from pythonfmu import Fmi2Causality, Fmi2Slave, Real

class Model(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.y = 0.0
        self.register_variable(Real("y", causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        self.y = @value
        return True
""",
    "pythonfmu3": """
from pythonfmu3 import CoSimulation, Float64, Fmi3Causality, Fmi3SlaveBase, Fmi3StepResult, Fmi3Variability

class Model(Fmi3SlaveBase, CoSimulation):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.time = self.y = 0.0
        self.register_variable(
            Float64("time", causality=Fmi3Causality.independent, variability=Fmi3Variability.continuous)
        )
        self.register_variable(Float64("y", causality=Fmi3Causality.output))

    def do_step(self, current_time, step_size):
        self.time = current_time + step_size
        self.y = @value
        return Fmi3StepResult()
""",
}
"""Tool to a script whose output ``y`` is @value after a step."""

Make = Callable[..., Path]

_numbers = count()


@pytest.fixture(scope="module")
def workshop(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """An FMU of each tool."""
    found = {}
    for tool, script in SCRIPTS.items():
        folder = tmp_path_factory.mktemp(tool)
        (folder / "model.py").write_text(script.replace("@value", "0.0"))
        command = [sys.executable, "-m", tool, "build", "-f", "model.py", "-d", "."]
        subprocess.run(command, cwd=folder, check=True, capture_output=True)
        found[tool] = folder / "Model.fmu"
    return found


@pytest.fixture
def make(workshop: dict[str, Path], tmp_path: Path) -> Make:
    """Make an FMU of a module's name, a value (an expression), and further files among its resources."""

    def build(module: str, value: str, tool: str = "pythonfmu", top: str = "", **files: str) -> Path:
        path = tmp_path / f"Model{next(_numbers)}.fmu"
        contents = {f"{module}.py": top + SCRIPTS[tool].replace("@value", value), "slavemodule.txt": module}
        contents |= files
        with zipfile.ZipFile(workshop[tool]) as old, zipfile.ZipFile(path, "w") as new:
            for member in old.namelist():
                if member not in ("resources/model.py", "resources/slavemodule.txt"):
                    new.writestr(member, old.read(member))
            for name, text in contents.items():
                new.writestr(f"resources/{name}", text)
        return path

    return build


@pytest.fixture
def module() -> str:
    """Name that no other test uses: a process keeps its modules."""
    return f"model_{next(_numbers)}"


def simulate(*fmus: Path, **options: object) -> Result:
    """Run FMUs as components ``a``, ``b``, ... for two steps."""
    system = System()
    for name, fmu in zip("abc", fmus, strict=False):
        system.add(name, fmu)
    return system.simulate(stop_time=0.2, step_size=0.1, **options)


def last(result: Result) -> list[float]:
    """Return the outputs at the end."""
    return [float(values[-1]) for values in result.values.values()]


def note(component: str, module: str) -> str:
    """Return the note on an FMU that is isolated."""
    return (
        f"{component}: runs in a process of its own, as its Python module {module} is another one than the {module} "
        "of this process"
    )


@pytest.mark.parametrize("tool", SCRIPTS)
def test_two_scripts_of_one_name_run_their_own_code(make: Make, module: str, tool: str):
    found = simulate(make(module, "1.0", tool), make(module, "2.0", tool))
    assert last(found) == [1.0, 2.0]
    assert found.warnings == [note("b", module)]


@pytest.mark.parametrize("tool", SCRIPTS)
def test_two_scripts_of_one_content_share_the_process(make: Make, module: str, tool: str):
    found = simulate(make(module, "1.0", tool), make(module, "1.0", tool))
    assert last(found) == [1.0, 1.0]
    assert found.warnings == []


@pytest.mark.parametrize("tool", SCRIPTS)
def test_systems_one_after_the_other_run_their_own_code(make: Make, module: str, tool: str):
    one, other = make(module, "1.0", tool), make(module, "2.0", tool)
    found = [simulate(fmu) for fmu in (one, other, one, other)]
    assert [last(result) for result in found] == [[1.0], [2.0], [1.0], [2.0]]
    assert [result.warnings for result in found] == [[], [note("a", module)]] * 2


def test_scripts_of_one_name_and_two_tools(make: Make, module: str):
    found = simulate(make(module, "1.0", "pythonfmu"), make(module, "2.0", "pythonfmu3"), make(module, "1.0"))
    assert last(found) == [1.0, 2.0, 1.0]
    assert found.warnings == [note("b", module)]


def test_scripts_of_different_names_share_the_process(make: Make, module: str):
    found = simulate(make(module, "1.0"), make(f"{module}x", "2.0"))
    assert last(found) == [1.0, 2.0]
    assert found.warnings == []


def test_modules_that_scripts_bring_along_may_have_one_name(make: Make, module: str):
    helper, use = f"{module}_helper", f"from {module}_helper import value\n"
    fmus = [make(f"{module}_{i}", "value", top=use, **{f"{helper}.py": f"value = {i}.0\n"}) for i in (1, 2)]
    found = simulate(*fmus)
    assert last(found) == [1.0, 2.0]
    assert found.warnings == [note("b", helper)]


def test_packages_that_scripts_bring_along_may_have_one_name(make: Make, module: str):
    package, use = f"{module}p", f"from {module}p.part import value\n"

    def fmu(script: str, value: int) -> Path:
        files = {f"{package}/__init__.py": "", f"{package}/part.py": f"value = {value}.0\n"}
        return make(script, "value", top=use, **files)

    found = simulate(fmu(f"{module}1", 1), fmu(f"{module}2", 2), fmu(f"{module}3", 1))
    assert last(found) == [1.0, 2.0, 1.0]
    assert found.warnings == [note("b", package)]


def test_data_beside_a_script_belong_to_it(make: Make, module: str):
    read = "float((Path(__file__).parent / 'data.txt').read_text())"
    top = "from pathlib import Path\n"
    found = simulate(*(make(module, read, top=top, **{"data.txt": value}) for value in ("1.0", "2.0")))
    assert last(found) == [1.0, 2.0]
    assert found.warnings == [note("b", module)]


def test_an_fmu_that_is_isolated_by_request_takes_no_names(make: Make, module: str):
    for isolated in ("a", "b"):
        name = f"{module}{isolated}"
        found = simulate(make(name, "1.0"), make(name, "2.0"), isolate={isolated})
        assert last(found) == [1.0, 2.0]
        assert found.warnings == []


def test_a_module_of_the_host_is_not_the_fmus(make: Make, module: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    (tmp_path / f"{module}.py").write_text("class Model: pass\n")
    monkeypatch.syspath_prepend(tmp_path)
    __import__(module)
    found = simulate(make(module, "1.0"))
    assert last(found) == [1.0]
    assert found.warnings == [note("a", module)]


def test_the_same_module_in_the_host_is_the_fmus(
    make: Make, module: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    fmu = make(module, "1.0")
    with zipfile.ZipFile(fmu) as archive:
        (tmp_path / f"{module}.py").write_bytes(archive.read(f"resources/{module}.py"))
    monkeypatch.syspath_prepend(tmp_path)
    __import__(module)
    found = simulate(fmu)
    assert last(found) == [1.0]
    assert found.warnings == []


@pytest.mark.parametrize("module", ["cosim", "sys"])
def test_a_name_that_the_isolated_process_uses_is_refused(make: Make, module: str):
    message = f"a: expected Python modules of names that the isolated process does not use itself, got {module}"
    with pytest.raises(RunError, match=message):
        simulate(make(module, "1.0"))


def test_where_no_fmu_can_be_isolated_it_is_refused(make: Make, module: str, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(session, "os", SimpleNamespace(name="nt"))
    one = make(module, "1.0")
    assert last(simulate(one, one)) == [1.0, 1.0]
    with pytest.raises(SetupError, match=f"b: expected Linux or macOS, .* its Python module {module} is another"):
        simulate(one, make(module, "2.0"))
