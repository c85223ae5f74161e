"""The blocks as systems: one on the shaker, beside its parts."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from cosim import System

Block = Callable[[str, str], System]
"""Flavour and name of a block to a system of it, as ``seat``, on the shaker."""


@pytest.fixture
def block(native: Path) -> Block:
    def on_shaker(flavour: str, name: str) -> System:
        system = System()
        system.add("shaker", native / flavour / "Shaker.fmu")
        system.add("seat", native / flavour / f"{name}.fmu")
        for signal in ("floor_displacement", "floor_velocity", "floor_acceleration"):
            system.connect(f"shaker.{signal}", f"seat.{signal}")
        system.order = ("seat", "shaker")
        return system

    return on_shaker
