"""What loads when: the package and the command line's help load neither numpy nor fmpy; each way to start works."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import click
import pytest

import cosim
import fmus
from seat_cosim.carried import DEFAULT_FLAVOUR
from seat_cosim.cli import main
from seat_cosim.cli.lazy_group import LazyGroup

SLOW = {"numpy", "scipy", "fmpy", "matplotlib", "rich", "lxml"}


def python(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, *words], capture_output=True, text=True, check=False)


@pytest.mark.parametrize("script", ["import cosim", "import seat_cosim", "import seat_cosim.cli.main"])
def test_nothing_slow_is_loaded_before_it_is_used(script: str):
    found = python("-c", f"{script}\nimport sys\nprint(*sorted({SLOW!r} & set(sys.modules)))")
    assert (found.returncode, found.stdout.strip()) == (0, "")


def test_a_folder_of_fmus_where_the_user_stands_shadows_nothing(tmp_path: Path):
    (tmp_path / "fmus").mkdir()
    script = "import seat_cosim; from seat_cosim.carried import package_folders; print(package_folders()[0])"
    found = subprocess.run([sys.executable, "-c", script], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (found.returncode, found.stdout.strip()) == (0, str(Path(fmus.__file__).parent)), found.stderr
    assert fmus.FLAVOURS[0] == DEFAULT_FLAVOUR


def test_every_command_is_there_and_listed_with_its_help():
    context = click.Context(main.app)
    group = main.app
    assert isinstance(group, LazyGroup)
    listed = group.get_help(context)
    for name in group.list_commands(context):
        command = group.get_command(context, name)
        assert command is not None
        assert command.name == name
        first = command.get_short_help_str(200).split()[:3]
        assert " ".join(first) in " ".join(listed.split())
    assert group.get_command(context, "jump") is None


def test_the_command_line_runs_as_a_module():
    found = python("-m", "seat_cosim", "--version")
    assert (found.returncode, found.stdout.strip().split()[-1]) == (0, cosim.__version__)


def test_the_master_says_where_the_command_line_is():
    found = python("-m", "cosim")
    assert (found.returncode, found.stdout) == (1, "")
    assert found.stderr.count("\n") == 1
    assert "python -m seat_cosim" in found.stderr


def test_public_names_are_those_that_are_listed():
    for name in cosim.__all__:
        assert getattr(cosim, name).__name__ == name
        assert name in dir(cosim)
    with pytest.raises(AttributeError, match="module 'cosim' has no attribute 'Sytsem'"):
        cosim.Sytsem  # noqa: B018


def test_this_folder_holds_no_compiled_list():
    """The list of commands is read from sources: they are where it looks."""
    for module, function in main.COMMANDS.values():
        source = Path(main.__file__).with_name(f"{module.rpartition('.')[2]}.py")
        assert f"def {function}(" in source.read_text(encoding="utf-8")
