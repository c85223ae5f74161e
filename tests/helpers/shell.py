"""A shell for the command line."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from seat_cosim.cli import main as cli


class Shell:
    """Runs commands in a folder that holds the FMUs."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], fmus: Path) -> None:
        self.monkeypatch = monkeypatch
        self.capfd = capfd
        self.fmus = fmus

    def __call__(self, *words: str, fmus: bool = True, figure: bool = False) -> tuple[int, str, str]:
        where = ["--fmus", str(self.fmus)] if fmus and words[:1] in (("run",), ("reproduce",), ("evaluate",)) else []
        drawn = ["--no-figure"] if words[:1] in (("run",), ("simulate",)) and not figure else []  # takes a second
        self.monkeypatch.setattr(sys, "argv", ["seat-cosim", *words, *where, *drawn])
        with pytest.raises(SystemExit) as end:
            cli.main()
        out, err = self.capfd.readouterr()
        return int(end.value.code or 0), out, err
