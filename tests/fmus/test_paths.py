"""How the native FMUs make paths of what hosts and users give them."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.helpers.paths import ROOT


@pytest.fixture(scope="module")
def paths(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    if shutil.which("gcc") is None:
        pytest.skip("gcc is not installed")
    built = tmp_path_factory.mktemp("paths") / "paths.so"
    source = str(ROOT / "fmus/native/paths.c")
    subprocess.run(["gcc", "-std=c99", "-shared", "-fPIC", source, "-o", str(built)], check=True)
    return ctypes.CDLL(str(built))


def resources(paths: ctypes.CDLL, location: str | None, size: int = 100) -> str:
    folder = ctypes.create_string_buffer(b"?" * size, size)
    paths.path_of_resources(None if location is None else location.encode(), folder, ctypes.c_size_t(size))
    return folder.value.decode()


@pytest.mark.parametrize(
    ("location", "folder"),
    [
        ("file:///tmp/fmu/resources", "/tmp/fmu/resources"),
        ("file:/tmp/fmu/resources", "/tmp/fmu/resources"),
        ("file://localhost/tmp/r", "/tmp/r"),
        ("file:///tmp/with%20space/%C3%BC/100%25", "/tmp/with space/ü/100%"),
        ("file:///tmp/%zz%4", "/tmp/%zz%4"),
        ("file:///tmp/%00end", "/tmp/%00end"),
        ("file:///C:/FMUs/r", "C:/FMUs/r"),
        ("file:/C:/FMUs/r", "C:/FMUs/r"),
        ("file:///C|/FMUs/r", "C:/FMUs/r"),
        ("file:///C%3A/FMUs/r", "C:/FMUs/r"),
        ("file://server/share/r", "//server/share/r"),
        ("/tmp/100%20/r/", "/tmp/100%20/r/"),
        (r"C:\FMUs\r", r"C:\FMUs\r"),
        ("", ""),
        (None, ""),
        ("file:", ""),
        ("file:///" + "x" * 100, ""),
    ],
)
def test_resources_are_found(paths: ctypes.CDLL, location: str | None, folder: str):
    assert resources(paths, location) == folder


@pytest.mark.parametrize(
    ("folder", "name", "path"),
    [
        ("/r", "a.csv", "/r/a.csv"),
        ("/r/", "b/a.csv", "/r/b/a.csv"),
        ("C:\\r\\", "a.csv", "C:\\r\\a.csv"),
        ("/r", "/a.csv", "/a.csv"),
        ("/r", "\\a.csv", "\\a.csv"),
        ("/r", "D:/a.csv", "D:/a.csv"),
        ("", "a.csv", "a.csv"),
        ("/r", "", "/r/"),
        ("/r", "x" * 100, ""),
    ],
)
def test_names_are_relative_to_the_resources(paths: ctypes.CDLL, folder: str, name: str, path: str):
    found = ctypes.create_string_buffer(100)
    paths.path_in_folder(folder.encode(), name.encode(), found, ctypes.c_size_t(100))
    assert found.value.decode() == path


def test_a_uri_of_pathlib_gives_the_path(paths: ctypes.CDLL, tmp_path: Path):
    folder = tmp_path / "a b#c%d [ü]"
    assert resources(paths, folder.as_uri(), 1024) == str(folder)
