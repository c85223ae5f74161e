"""The wheel is the product: in an empty folder, without a compiler, it runs everything from what is inside it."""

from __future__ import annotations

import json
import os
import re
import runpy
import shutil
import subprocess
import sys
import zipfile
from importlib.metadata import requires
from pathlib import Path

import pytest

from fmus.export.native_fmu import PLATFORMS, host_platform
from seat_cosim.build import build_all
from tests.helpers.paths import NATIVE, ROOT

PACKAGES = ("benchmarks", "cosim", "examples", "fmus", "plant_models", "seat_blocks", "seat_cosim", "src", "studies")
"""Folders of the clone that are copied; of the others the files alone."""

MADE = shutil.ignore_patterns("fmi2", "fmi3", "python", "built", "*.ssp", "*.egg-info", "__pycache__")
"""What a build makes in them."""


def build_distributions(project: Path, target: Path, umask: int) -> None:
    """Build wheel and source distribution as ``make wheel`` does, under a umask."""
    command = [sys.executable, "-m", "build", "--no-isolation", "--sdist", "--wheel", "--outdir", target, project]
    environment = {**os.environ, "SOURCE_DATE_EPOCH": "315532800"}
    done = subprocess.run(command, env=environment, umask=umask, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.fixture(scope="module")
def distributions(native: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of a wheel with FMUs for this machine, and of a source distribution."""
    folder = tmp_path_factory.mktemp("wheel")
    project = folder / "project"
    for name in PACKAGES:
        shutil.copytree(ROOT / name, project / name, ignore=MADE)
    for path in (path for path in ROOT.iterdir() if path.is_file()):
        shutil.copyfile(path, project / path.name)
    for flavour in NATIVE:
        shutil.copytree(native / flavour, project / "fmus" / "built" / flavour)
    shutil.copytree(
        ROOT / "cosim" / "engine" / "built" / host_platform(),
        project / "cosim" / "engine" / "built" / host_platform(),
    )
    assert not any(
        built.fresh for built in build_all(project / "fmus" / "built", NATIVE) if built.path.suffix == ".fmu"
    )
    build_distributions(project, folder / "dist", 0o022)
    return folder


@pytest.fixture(scope="module")
def installed(distributions: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A fresh environment with the wheel in it; its dependencies are those of this environment."""
    environment = tmp_path_factory.mktemp("environment")
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", environment], check=True)
    (packages,) = environment.glob("lib/python*/site-packages")
    (packages / "dependencies.pth").write_text("\n".join(path for path in sys.path if path.endswith("site-packages")))
    (packages / "ziglang.py").write_text("raise ImportError('a compiler was asked for')\n")
    pip = [sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check", "--python", environment]
    (wheel,) = (distributions / "dist").glob("*.whl")
    subprocess.run([*pip, "install", "--no-deps", "--no-index", wheel], check=True)
    return environment


@pytest.fixture
def alone(installed: Path, tmp_path: Path):
    """Runs words in an empty folder, where no command is found but those of the environment."""

    def run(*words: str) -> str:
        environment = {"PATH": str(installed / "bin"), "HOME": str(tmp_path), "OPENBLAS_NUM_THREADS": "1"}
        command = [installed / "bin" / words[0], *words[1:]]
        done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
        assert done.returncode == 0, f"{words}\n{done.stdout}\n{done.stderr}"
        return done.stdout + done.stderr

    return run


def test_the_tags_are_those_of_the_binaries(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("setuptools.setup", lambda **_: None)
    tags = runpy.run_path(str(ROOT / "setup.py"))["TAGS"]
    assert set(tags) == set(PLATFORMS)
    for name, platform in PLATFORMS.items():
        architecture, system = platform.target.split("-", 1)
        for tag in tags[name]:
            if system.startswith("linux-gnu."):
                assert tag in (f"manylinux_{system.removeprefix('linux-gnu.').replace('.', '_')}_{architecture}",) or (
                    system == "linux-gnu.2.17" and tag == f"manylinux2014_{architecture}"
                )
            elif system.startswith("macos."):
                version = system.removeprefix("macos.").replace(".", "_")
                assert tag == f"macosx_{version}_{architecture.replace('aarch64', 'arm64')}"
            else:
                assert (tag, architecture, system) == ("win_amd64", "x86_64", "windows-gnu")


def test_the_wheel_names_its_platform_and_is_reproducible(distributions: Path, tmp_path: Path):
    wheel, sdist = sorted((distributions / "dist").iterdir(), key=lambda path: path.suffix, reverse=True)
    assert (wheel.suffix, sdist.name[-7:]) == (".whl", ".tar.gz")
    if host_platform() == "x86_64-linux":
        assert wheel.name.endswith("-py3-none-manylinux2014_x86_64.manylinux_2_17_x86_64.whl")
    assert "win_amd64" not in wheel.name
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
        bill = json.loads(archive.read(next(name for name in names if name.endswith("/sboms/seat-cosim.cdx.json"))))
    for flavour in NATIVE:
        assert {f"fmus/built/{flavour}/{name}.fmu" for name in ("Shaker", "SeatPlant", "SeatController")} <= names
    needed = [requirement for requirement in requires("seat-cosim") or [] if "extra ==" not in requirement]
    assert bill["bomFormat"] == "CycloneDX"
    assert {each["name"] for each in bill["components"]} >= {re.split(r"[^\w-]", text)[0] for text in needed}
    assert "FMI headers" in {each["name"] for each in bill["components"]}
    assert "seat_cosim/examples/controllers/pid.py" in names
    stale = distributions / "project" / "build" / "lib" / "cosim" / "stale.py"
    stale.write_text("raise SystemExit\n")
    build_distributions(distributions / "project", tmp_path, 0o077)
    assert (tmp_path / wheel.name).read_bytes() == wheel.read_bytes()
    subprocess.run([sys.executable, "-m", "twine", "check", "--strict", wheel, sdist], check=True)


@pytest.mark.long
def test_a_wheel_without_binaries_is_for_any_platform(distributions: Path, tmp_path: Path):
    sdist = next((distributions / "dist").glob("*.tar.gz"))
    shutil.unpack_archive(sdist, tmp_path)
    (project,) = (path for path in tmp_path.iterdir() if path.is_dir())
    assert not list(project.rglob("*.fmu"))
    build_distributions(project, tmp_path / "dist", 0o022)
    (wheel,) = (tmp_path / "dist").glob("*.whl")
    assert wheel.name.endswith("-py3-none-any.whl")


def test_every_command_runs_from_the_wheel(alone, installed: Path, tmp_path: Path):
    alone("seat-cosim", "run", "bump")
    run = json.loads((tmp_path / "results" / "run" / "bump" / "run.json").read_text())
    assert run["complete"]
    assert Path(run["components"]["seat"]["fmu"]).is_relative_to(installed)
    alone("seat-cosim", "run", "random", "--driver-mass", "100", "--gains", "recommended", "--stop-time", "5")
    alone("seat-cosim", "simulate", "SeatSuspension", "--set", "shaker.bump.height=0.05")
    alone("seat-cosim", "reproduce", "bump")
    short = ("--seeds", "1", "--duration", "5", "--processes", "1")
    assert "80 kg" in alone("seat-cosim", "evaluate", "--classes", "EM3", "--masses", "80", *short)
    alone("seat-cosim", "rerun", "results/run/bump/run.json")
    assert not (tmp_path / "fmus").exists()


def test_what_is_exported_is_used_from_then_on(alone, installed: Path, tmp_path: Path):
    carried = alone("seat-cosim", "--debug", "run", "bump", "--stop-time", "0.1")
    assert f"FMUs: {installed}" in carried
    alone("seat-cosim", "export")
    for name in ("fmi3/Shaker.fmu", "fmi2/SeatPlant_ref.csv", "SeatSuspension-fmi3.ssp", "parameter_sets/ride.ssv"):
        assert (tmp_path / "fmus" / name).is_file()
    for name in ("gains/recommended.json", "examples/foreign/cabin.py"):
        assert (tmp_path / "fmus" / name).is_file()
    assert "FMUs: fmus/fmi2" in alone("seat-cosim", "run", "bump", "--stop-time", "0.1", "--debug", "--output", "b")
    alone("seat-cosim", "validate", "fmus/fmi3/SeatController.fmu")


def test_five_lines_of_python_run_the_bump(alone):
    script = """
from cosim import System
from seat_cosim import fmu, ssp
system = System.load(ssp())
system.replace("seat", fmu("SeatPlant", "fmi3"))
print(f"{abs(system.simulate()['seat.driver_acceleration']).max():.2f}")
"""
    assert alone("python", "-c", script).strip() == "1.39"
