"""Sets of gains: read, written, handed to the controller."""

from __future__ import annotations

import json
from pathlib import Path
from xml.etree import ElementTree

import pytest

from fmus.variables import variables_of
from seat_controller_fmu.controller import observer_gains
from seat_controller_fmu.design.gains import PRESETS, Gains, load, preset
from seat_controller_fmu.design.setting import GainsError, Setting
from seat_controller_fmu.interface import Parameters
from studies.make_presets import FOLDER, published


@pytest.mark.parametrize("name", PRESETS)
def test_presets_read_back_to_the_same_bits(name: str):
    gains = preset(name)
    assert Gains.from_json(gains.to_json(), name) == gains
    content = json.loads(gains.to_json())
    contract = ["K1", "K2", "L1", "L2", "Q", "c_0", "P_2", "alpha", "lambda", "driver_mass_min", "driver_mass_max"]
    contract += ["observer_gamma", "certified_lambda", "worst_case_lambda", "delay_margin_ms"]
    assert set(contract) <= set(content)


@pytest.mark.parametrize("name", PRESETS)
def test_parameter_sets_are_those_of_the_presets_and_fit_the_fmu(name: str):
    text = (FOLDER / f"{name}.ssv").read_text(encoding="utf-8")
    assert text == preset(name).to_ssv()
    known = {variable.name: variable for variable in variables_of(Parameters)}
    namespace = {"ssv": "http://ssp-standard.org/SSP1/SystemStructureParameterValues"}
    entries = ElementTree.fromstring(text).findall("ssv:Parameters/ssv:Parameter", namespace)
    assert len(entries) == 8
    for entry in entries:
        value = float(entry.find("ssv:Real", namespace).get("value"))
        assert known[entry.get("name")].problem(value) is None


def test_the_published_preset_is_the_fmus_default():
    defaults = Parameters()
    assert preset("published").feedback == published().feedback
    chosen = preset("published").controller(defaults.driver_mass)
    assert observer_gains(chosen) == observer_gains(defaults)
    assert (chosen.K1_deflection, chosen.K2_rate) == (defaults.K1_deflection, defaults.K2_rate)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"K1": None}, "expected numbers"),
        ({"K1": [1.0]}, "expected numbers"),
        ({"L1": 5.0}, "L1: expected an observer gain below 0"),
        ({"driver_mass_min": 90.0}, "expected driver_mass_min < driver_mass_max, got 90.0 kg and 80.0 kg; swap them"),
        ({"alpha": 0.0}, "alpha: expected a finite number above 0, got 0.0"),
        ({"P_2": "much"}, "expected numbers"),
    ],
)
def test_invalid_entries_are_refused_with_the_name_of_the_file(tmp_path: Path, change: dict, message: str):
    content = json.loads(preset("published").to_json()) | change
    path = tmp_path / "mine.json"
    path.write_text(json.dumps(content))
    with pytest.raises(GainsError, match="mine.json") as error:
        load(str(path))
    assert message in str(error.value)


@pytest.mark.parametrize(
    ("text", "message"), [("{", "expected JSON"), ("[]", "got a list"), ("{}", "expected K1, K2, lambda")]
)
def test_other_files_are_refused(tmp_path: Path, text: str, message: str):
    path = tmp_path / "mine.json"
    path.write_text(text)
    with pytest.raises(GainsError, match=message):
        load(str(path))


def test_an_unknown_name_is_refused_with_the_known_ones():
    with pytest.raises(
        GainsError, match="expected one of published, table1-printed, recommended, equal-rate or a file, got best"
    ):
        load("best")


def test_a_setting_reports_all_errors():
    with pytest.raises(GainsError) as error:
        Setting(80.0, 45.0, 1.0, 0.0, 0.02, -1.0, 400.0)
    assert str(error.value).count("expected") == 4
