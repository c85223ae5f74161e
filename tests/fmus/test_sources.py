"""Which C files belong to a component."""

from __future__ import annotations

from pathlib import Path

import pytest

from fmus.export import sources
from fmus.export.c_header import defaults_header, model_header
from seat_blocks.passive_seat import PASSIVE_SEAT
from seat_cosim.components import COMPONENTS


def test_no_kernel_has_two_files_of_one_name():
    for component in COMPONENTS:
        names = [path.name for path in sources.kernel_files(component.module)]
        assert len(names) == len(set(names))
    assert {"controller.c", "seat.c", "interface.h", "seat_interface.h", "active_seat.c"} <= {
        path.name for path in sources.kernel_files("seat_blocks.active_seat")
    }


def test_two_files_of_one_name_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    modules = {}
    for package in ("one", "other"):
        (tmp_path / package).mkdir()
        for suffix in (".py", ".h"):
            (tmp_path / package / f"law{suffix}").touch()
        modules[f"{package}/law.py"] = tmp_path / package / "law.py"
    monkeypatch.setattr(sources, "source_files", lambda *_: modules)
    with pytest.raises(ValueError, match=r"expected one file of each name, got .*one/law\.h and .*other/law\.h"):
        sources.kernel_files("some.module")
    (tmp_path / "other" / "law.h").rename(tmp_path / "other" / "other_law.h")
    assert [path.name for path in sources.kernel_files("some.module")] == ["law.h", "other_law.h"]


def test_parameters_that_are_left_out_keep_their_values_in_c():
    header = model_header(PASSIVE_SEAT, "{}")
    assert "parameters.seat.driver_mass = values[" in header
    assert "parameters.seat.actuator_delay = 0.0;" in header
    assert "parameters.seat.sensor_seed = 1;" in header
    assert ".seat.suspension_damping = (real)736.0" in defaults_header(PASSIVE_SEAT)
    assert ".seat.sensor_seed = 1" in defaults_header(PASSIVE_SEAT)
