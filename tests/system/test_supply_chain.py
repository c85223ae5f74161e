"""Versions of other packages: the locked ones fit what is asked for, and the lowest ones work."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.version import Version

from tests.helpers.paths import ROOT

LOCKED = ROOT / "requirements" / "locked.txt"
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def requirements() -> Iterator[Requirement]:
    """Yield what the project and all its extras ask for, apart from extras of its own."""
    for text in (
        *PROJECT["dependencies"],
        *(word for extra in PROJECT["optional-dependencies"].values() for word in extra),
    ):
        if (found := Requirement(text)).name != PROJECT["name"]:
            yield found


def locked() -> dict[str, str]:
    """Return each locked package and its version."""
    text = LOCKED.read_text(encoding="utf-8")
    return dict(re.findall(r"^([\w.-]+)==(\S+)", text, re.MULTILINE))


@pytest.mark.parametrize("wanted", list(requirements()), ids=str)
def test_the_locked_version_fits(wanted: Requirement):
    assert wanted.specifier.contains(Version(locked()[wanted.name.lower()])), "run: make lock"


def test_every_locked_file_has_a_hash_and_no_address():
    text = LOCKED.read_text(encoding="utf-8")
    for entry in re.split(r"^(?=\S)", text, flags=re.MULTILINE)[1:]:
        assert "--hash=sha256:" in entry, entry
    assert "://" not in text


@pytest.mark.long
@pytest.mark.builds
def test_the_lowest_versions_pass_the_quick_tests(tmp_path: Path):
    """The bounds of pyproject.toml are true: the oldest versions that they allow pass what needs no compiler."""
    pytest.importorskip("uv", reason="uv is not installed")
    place, home = tmp_path / "venv", str(tmp_path)
    python = place / "bin" / "python"
    uv = [sys.executable, "-m", "uv"]
    environment = {**os.environ, "UV_CACHE_DIR": str(tmp_path / "cache"), "OPENBLAS_NUM_THREADS": "1"}
    commands = [
        [*uv, "venv", "--quiet", "--python", sys.executable, str(place)],
        [
            *uv,
            "pip",
            "install",
            "--quiet",
            "--python",
            str(python),
            "--resolution",
            "lowest-direct",
            "--only-binary",
            ":all:",
            "--no-binary",
            PROJECT["name"],
            "-e",
            f"{ROOT}[native,test]",
        ],
        [str(python), "-m", "pytest", "-q", "-p", "no:cacheprovider", "--basetemp", f"{home}/tests", "-m", QUICK],
    ]
    for command in commands:
        done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
        assert done.returncode == 0, f"{done.stdout[-5000:]}\n{done.stderr[-5000:]}"


QUICK = "not builds and not slow and not long"
"""Tests of ``make test-fast``."""
