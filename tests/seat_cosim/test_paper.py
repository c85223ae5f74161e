"""The reproduction of the paper: its numbers, and its report."""

from __future__ import annotations

import re
import shutil
import subprocess
from html import escape
from pathlib import Path

import numpy as np
import pytest

from seat_cosim.paper import experiments, report
from seat_cosim.paper.contents import CONTENTS
from seat_cosim.paper.experiments import findings
from seat_cosim.paper.finding import Finding, Kind, Row
from seat_cosim.paper.published import BUMP_PEAKS, REDUCTIONS, RMS
from seat_cosim.paper.runner import open_runner
from seat_cosim.scenarios import seat_suspension
from tests.helpers.files import read_csv
from tests.helpers.paths import ROOT
from tests.helpers.shell import Shell

FIGURES = [entry for entry in CONTENTS if not entry.key.startswith("table")]


@pytest.fixture(scope="module")
def found(native: Path) -> dict[str, Finding]:
    with open_runner(seat_suspension(native / "fmi2")) as runner:
        assert runner.gammas == {1: -3e-6, 2: -1e-6}
        assert runner.settings == {"alpha": 0.02, "P_2": 400.0, "lambda": 1.2}
        return {finding.key: finding for finding in findings(runner)}


@pytest.fixture(scope="module")
def folder(found: dict[str, Finding], tmp_path_factory: pytest.TempPathFactory) -> Path:
    target = tmp_path_factory.mktemp("report")
    report.write(target, list(found.values()))
    return target


@pytest.fixture(scope="module")
def page(folder: Path) -> str:
    return (folder / "index.html").read_text(encoding="utf-8")


def row(finding: Finding, quantity: str) -> Row:
    (only,) = (each for each in finding.rows if each.quantity == quantity)
    return only


def value(finding: Finding, quantity: str) -> float:
    (only,) = row(finding, quantity).values
    return only


@pytest.mark.parametrize(
    ("key", "quantity", "expected", "within"),
    [
        ("fig05", "Uncontrolled, peak", 3.21, 0.005),
        ("fig05", "Observer 1, peak", 1.39, 0.005),
        ("fig05", "Observer 2, peak", 1.24, 0.005),
        ("fig06", "Observer 1, peak estimate", 204.0, 0.5),
        ("fig06", "Observer 2, peak estimate", 598.0, 0.5),
        ("fig07", "Observer 1, peak force", 250.0, 0.0),
        ("fig07", "Observer 2, peak force", 250.0, 0.0),
        ("fig07", "Observer 1, peak demand", 432.0, 1.0),
        ("fig07", "Observer 2, peak demand", 838.0, 1.0),
        # alpha sqrt(A / (gamma + beta)) of the published parameters
        ("fig18", "Plateau, 5 mm", 75.33, 0.005),
        ("fig18", "Plateau, 10 mm", 75.33, 0.005),
    ],
)
def test_the_ideal_simulation_gives_what_the_equations_give(
    found: dict[str, Finding], key: str, quantity: str, expected: float, within: float
):
    assert value(found[key], quantity) == pytest.approx(expected, abs=within)
    assert row(found[key], quantity).kind is Kind.SIMULATED


def test_observer_2_follows_better_and_fades_sooner(found: dict[str, Finding]):
    after = [value(found["fig05"], f"Observer {number}, RMS after the bump") for number in (1, 2)]
    assert after[1] < 0.5 * after[0]
    errors = [each.values[0] for each in found["fig06"].rows if "RMS error" in each.quantity]
    assert errors[1] < 0.5 * errors[0]


def test_transmissibility_with_observer_1_is_around_0_4_and_below_1(found: dict[str, Finding]):
    low, high = row(found["fig08"], "Observer 1, 1 to 2.5 Hz, ratio of RMS values").values
    assert (low, high) == (pytest.approx(0.37, abs=0.01), pytest.approx(0.52, abs=0.01))
    assert value(found["fig08"], "Observer 1, 1 to 4.5 Hz, largest ratio of RMS values") < 0.7
    fundamental = row(found["fig08"], "Observer 1, 1 to 2.5 Hz, fundamental alone").values
    assert max(fundamental) < 0.4  # less than all that comes through, which friction spreads over harmonics
    assert value(found["fig10"], "Controlled, 1 to 4.5 Hz, largest ratio") < 1.0


def test_passive_against_uncontrolled_is_as_in_the_paper(found: dict[str, Finding]):
    assert value(found["fig10"], "Passive, highest") > value(found["fig10"], "Uncontrolled, highest")
    better, worse = row(found["fig10"], "Passive less uncontrolled, 2.5 to 4.5 Hz").values
    assert better < -0.2
    assert worse < 0.1  # beyond 4 Hz
    assert value(found["fig10"], "Controlled, better than the passive seat up to") >= 4.5


def test_fitted_numbers_agree(found: dict[str, Finding]):
    for name, printed in RMS[55.0].items():
        # fitted to the true acceleration, of which the sensor's low-pass takes up to 1.8 %
        measured = value(found["table2"], f"55 kg, {name}")
        assert 0.98 * printed < measured < 1.001 * printed
    reduction = row(found["table2"], "55 kg, controlled against passive")
    assert reduction.kind is Kind.FITTED
    assert reduction.values[0] == pytest.approx(-46.4, abs=0.1)


def test_the_ideal_simulation_reaches_the_papers_reductions(found: dict[str, Finding]):
    for mass, printed in REDUCTIONS.items():
        assert value(found["table2"], f"{mass:g} kg, controlled against passive, ideal prototype") < -printed


def test_70_kg_and_the_bumps_are_marked_as_predicted(found: dict[str, Finding]):
    heavy = [each for each in found["table2"].rows if each.quantity.startswith("70 kg")]
    bumps = [*found["fig11"].rows, *found["fig12"].rows]
    assert {each.kind for each in (*heavy, *bumps)} == {Kind.PREDICTED}
    assert value(found["table2"], "70 kg, controlled against passive") == pytest.approx(-45.0, abs=0.1)
    for key, mass in (("fig11", 55.0), ("fig12", 70.0)):
        assert row(found[key], "Passive, peak").paper == f"{BUMP_PEAKS[mass]['passive']:.2f}"
        assert value(found[key], "Ideal, peak") < value(found[key], "Controlled, peak")
    falls = [value(found[key], "Controlled against passive") for key in ("fig11", "fig12")]
    assert falls == [pytest.approx(-30.7, abs=0.2), pytest.approx(-38.4, abs=0.2)]


def test_the_ranges_of_all_sets_that_fit_stand_beside_the_papers_numbers(found: dict[str, Finding]):
    (reduction,) = (each for each in found["table2"].rows if "sets that fit" in each.quantity)
    assert reduction.paper == f"−{REDUCTIONS[70.0]}"
    assert reduction.values[0] > value(found["table2"], "70 kg, controlled against passive") > reduction.values[1]
    for key, mass in (("fig11", 55.0), ("fig12", 70.0)):
        ranges = [each for each in found[key].rows if "sets that fit" in each.quantity]
        assert [each.paper for each in ranges] == [f"{peak:.2f}" for peak in BUMP_PEAKS[mass].values()]
        for name, each in zip(("Passive", "Controlled"), ranges, strict=True):
            low, high = each.values
            assert low < value(found[key], f"{name}, peak") < high


def test_the_hump_of_the_controlled_seat_is_named(found: dict[str, Finding]):
    hump, slow = (each for each in found["fig15"].rows if each.quantity.startswith("Controlled, highest density"))
    assert hump.values[0] > slow.values[0]
    assert "loop's own mode, at 6.6 Hz" in hump.remark


@pytest.mark.long
def test_another_observer_on_the_rig_is_predicted(native: Path):
    with open_runner(seat_suspension(native / "fmi2"), rig_observer="equal-rate") as runner:
        table = experiments.finding(runner, "table2")
    assert row(table, "55 kg, passive").kind is Kind.FITTED
    assert row(table, "55 kg, controlled").kind is Kind.PREDICTED
    assert row(table, "55 kg, controlled against passive").kind is Kind.PREDICTED
    assert "fitted with Observer 1" in row(table, "55 kg, controlled").remark


def test_anti_windup_halves_what_is_left_of_the_bump(found: dict[str, Finding]):
    for mass, published in ((55, 1.39), (70, 1.17)):
        assert value(found["beyond"], f"Observer 1, {mass} kg, peak") == pytest.approx(published, abs=0.005)
        for what in ("with anti-windup", "recommended gains, anti-windup"):
            assert value(found["beyond"], f"{what}, {mass} kg, peak") < 0.7 * published


def test_friction_turns_within_a_tenth_of_a_millimetre_at_any_amplitude(found: dict[str, Finding]):
    (turned,) = (each for each in found["fig19"].rows)
    assert turned.values[0] == pytest.approx(turned.values[1], rel=0.01)
    assert 0.05 < turned.values[0] < 0.1


def test_every_difference_has_a_remark(found: dict[str, Finding]):
    for finding in found.values():
        for each in finding.rows:
            if each.paper and each.paper != each.ours:
                assert each.remark.endswith("."), f"{finding.key}: {each.quantity}"


def test_table_1_has_the_start_values_and_marks_the_misprint(found: dict[str, Finding]):
    differing = [each.quantity for each in found["table1"].rows if each.paper != each.ours]
    assert differing == ["Largest driver mass m_bmax"]


def test_the_document_has_the_numbers_found(found: dict[str, Finding]):
    text = (ROOT / "docs" / "explanation" / "reproduction.md").read_text(encoding="utf-8")
    for _, rows in report.summary(list(found.values())):
        for entry, each in rows:
            unit = "" if each.unit == "1" else f" {each.unit}"
            assert f"| {entry.number} | {each.quantity} |{unit} | {each.paper} | {each.ours} |\n" in text


def test_every_entry_is_made_by_one_experiment():
    assert [key for keys in experiments.KEYS.values() for key in keys] == [entry.key for entry in CONTENTS]
    assert list(experiments.KEYS) == list(experiments.EXPERIMENTS)


def test_the_report_has_all_figures_and_tables(page: str, folder: Path):
    for entry in CONTENTS:
        assert f'<section id="{entry.key}">' in page
        assert f"{entry.number}: {entry.title}" in page
        assert (folder / f"{entry.key}.csv").is_file()
    for number in ("3.21", "1.39", "1.24", "204", "598", "75.3", "1.061", "1.067", "0.578", "2.02", "1.03"):
        assert number in page
    for entry in FIGURES:
        assert (folder / f"{entry.key}.png").read_bytes().startswith(b"\x89PNG")
        assert (folder / f"{entry.key}.svg").read_text(encoding="utf-8").startswith("<?xml")
    assert len(list(folder.iterdir())) == 1 + len(CONTENTS) + 2 * len(FIGURES)


def test_the_page_needs_no_other_file(page: str):
    assert not re.findall(r"https?:|<script|<link|@import|url\(", page)
    assert len(re.findall(r'<img src="data:image/svg\+xml;base64,', page)) == len(FIGURES) == page.count("<img")


def test_csv_files_hold_the_curves(folder: Path, found: dict[str, Finding]):
    table = read_csv(folder / "fig05.csv")
    name = "Driver acceleration (m/s²), Uncontrolled"
    assert list(table)[:2] == ["Time (s)", name]
    assert np.array_equal(table[name], found["fig05"].panels[0].curves[0].values)
    for entry in FIGURES:
        curves = sum(len(panel.curves) for panel in found[entry.key].panels)
        drawn = [column for column in read_csv(folder / f"{entry.key}.csv") if ", " in column]
        assert len(drawn) >= min(curves, 2)


@pytest.mark.long  # all experiments a second time
def test_reproduce_alone_writes_the_same_report(shell: Shell, folder: Path, tmp_path: Path):
    code, out, err = shell("reproduce")
    assert (code, err) == (0, "")
    made = tmp_path / "results" / "report"
    assert [path.name for path in made.iterdir() if path.read_bytes() != (folder / path.name).read_bytes()] == []
    assert len(list(made.iterdir())) == len(list(folder.iterdir()))
    for text in ("fitted", "predicted", "simulated", "0.37 to 0.52", "3.21", "page results/report/index.html"):
        assert text in out


def test_a_driver_is_refused_where_the_paper_has_its_own(shell: Shell, tmp_path: Path):
    code, _, err = shell("reproduce", "--driver-mass", "80")
    assert code == 2
    assert err == (
        "seat-cosim: error: --driver-mass 80: expected with bump only; the paper's drivers weigh 55 and 70 kg\n"
    )
    assert not list(tmp_path.rglob("results"))


# ---- in a browser ----------------------------------------------------------------------------------------------------

CHROMIUM = shutil.which("chromium")
PROBE = """<script>
let failed = 0;
window.addEventListener("error", () => { failed += 1; }, true);
window.addEventListener("load", () => {
  const pictures = [...document.images].filter((image) => image.naturalWidth > 0 && image.clientWidth > 100);
  const wide = document.documentElement.scrollWidth;
  const shown = document.documentElement.clientWidth;
  parent.document.title = `wide ${wide} of ${shown}, pictures ${pictures.length}, failed ${failed}`;
});
</script>"""


def show(page: str, width: int, folder: Path) -> tuple[int, int, int, int]:
    """Show a page in a frame, as a browser's own window does not get as narrow as a phone.

    Returns the page's width, the frame's, and the numbers of pictures that are shown and that are not.
    """
    inside = page.replace("<head>", f"<head>{PROBE}", 1)
    frame = f'<iframe style="border: 0" width="{width}" height="800" srcdoc="{escape(inside)}"></iframe>'
    (folder / "frame.html").write_text(f"<!doctype html><meta charset=utf-8><title></title>{frame}", encoding="utf-8")
    command = [CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-sync"]
    command += ["--disable-background-networking", "--disable-component-update", f"--user-data-dir={folder / 'user'}"]
    command += ["--hide-scrollbars", "--window-size=1400,1000", "--dump-dom", (folder / "frame.html").as_uri()]
    shown = subprocess.run(command, capture_output=True, text=True, check=True, timeout=120).stdout
    title = re.search(r"<title>(.*?)</title>", shown)[1]
    wide, window, pictures, failed = map(int, re.findall(r"\d+", title))
    return wide, window, pictures, failed


@pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")
@pytest.mark.parametrize("width", [390, 1280])
def test_a_browser_shows_all_figures_within_the_width(page: str, width: int, tmp_path: Path):
    assert show(page, width, tmp_path) == (width, width, len(FIGURES), 0)


@pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")
def test_a_page_too_wide_and_a_broken_figure_are_detected(page: str, tmp_path: Path):
    spoiled = page.replace("</h1>", '</h1><p style="width: 450px">wide</p>', 1).replace("base64,", "base64,!", 1)
    wide, window, pictures, failed = show(spoiled, 390, tmp_path)
    assert wide > window
    assert (pictures, failed) == (len(FIGURES) - 1, 1)
