"""Where things lie in the repository."""

from __future__ import annotations

from pathlib import Path

ROOT = Path(__file__).parents[2]
DATA = ROOT / "tests" / "data"
SOURCES = ROOT / "tests" / "native"
"""Programs and FMUs in C."""

NATIVE = ("fmi2", "fmi3")
"""Native flavours."""
