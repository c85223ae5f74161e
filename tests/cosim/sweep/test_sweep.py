"""Sweeps on this machine: results in closed form, the same bytes from any workers, failures as rows, resumption."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cosim import System
from cosim.errors import SetupError
from cosim.results.folder_lock import locked_folder
from cosim.sweep.dataset import METADATA, read_columns
from cosim.sweep.design import Block, Range, Values, Variable
from cosim.sweep.loaded import LoadedSystem
from cosim.sweep.plan import Batch, make_plan
from cosim.sweep.pool import Processes, WorkerDied
from cosim.sweep.study import Study
from cosim.sweep.sweep import Progress, estimate, sweep
from tests.helpers.waiting import wait_until

pyarrow_parquet = pytest.importorskip("pyarrow.parquet")
pytestmark = pytest.mark.builds

METRICS = ("final(seat.y)", "mean(cab.y)", "rms(cab.y)", "range(cab.y)")


def grid(**values: tuple[Any, ...]) -> Block:
    return Block({name.replace("__", "."): Variable(Values(each)) for name, each in values.items()})


def study(folder: Path, system: str = "ok", **given: Any) -> Study:
    return Study(**{"name": "s", "system": f"{system}.ssp", "metrics": METRICS, "folder": folder, **given})


def table(study: Study) -> dict[str, list[Any]]:
    """Run all points of a study in this process."""
    plan = make_plan(study)
    with LoadedSystem() as loaded:
        return plan(loaded, Batch(0, study.design.points(range(study.design.runs)))).columns


def test_metrics_series_and_options_have_their_closed_forms(faulty_folder: Path):
    found = table(
        study(
            faulty_folder,
            vary=[grid(cab__u=(1.0, -3.0)), grid(stop_time=(1.0, 2.0), algorithm=("gauss-seidel", "jacobi"))],
            step_size=0.5,
            warm_up=0.5,
            series=["cab.y"],
            series_every=2,
        )
    )
    assert found["error"] == [None] * 8
    for i, (u, stop, algorithm) in enumerate(
        zip(*(found[n] for n in ("cab.u", "stop_time", "algorithm")), strict=True)
    ):
        t = np.arange(0.0, stop + 0.25, 0.5)
        y = 2.0 * u + t  # of the cab at each communication point but the first
        y[0] = 0.0
        lag = 0.5 if algorithm == "jacobi" else 0.0
        assert found["mean(cab.y)"][i] == y[1:].mean()
        assert found["range(cab.y)"][i] == np.ptp(y[1:])
        assert found["rms(cab.y)"][i] == pytest.approx(np.sqrt((y[1:] ** 2).mean()), rel=1e-15)
        assert found["final(seat.y)"][i] == 2.0 * (y[-1] - lag) + stop
        assert found["cab.y"][i].tolist() == y[::2].tolist()
        assert found["time"][i].tolist() == t[::2].tolist()


def test_one_variable_sets_scales_and_adds_several_parameters(faulty_folder: Path):
    variables = {
        "both": Variable(Values((3.0,)), sets=("cab.u", "seat.strikes_at")),
        "share": Variable(Values((0.5, 2.0)), scales=("cab.u",)),
        "more": Variable(Values((0.0, 1.0)), adds=("cab.u", "cab.strikes_at")),
    }
    plan = make_plan(study(faulty_folder, vary=[Block(variables)]))
    shares = [(share, more) for share in (0.5, 2.0) for more in (0.0, 1.0)]
    cases = [plan.case({"both": 3.0, "share": share, "more": more}).options.values for share, more in shares]
    assert [case["cab.u"] for case in cases] == [1.5, 2.5, 6.0, 7.0]
    assert {case["seat.strikes_at"] for case in cases} == {3.0}
    assert [case["cab.strikes_at"] for case in cases] == [0.1, 1.1, 0.1, 1.1]  # from its start value


def test_components_are_varied_and_connected(faulty_folder: Path):
    blocks = [grid(replace__cab=("", "error-step-2.fmu"), cab__u=(1.0,), cab__strikes_at=(0.0, 9.0))]
    built = make_plan(study(faulty_folder, "error", vary=[grid(cab__u=(1.0,))]))
    assert len(built.systems) == 1
    found = table(study(faulty_folder, vary=blocks))
    failed = [error is not None for error in found["error"]]
    assert list(zip(found["replace.cab"], found["cab.strikes_at"], failed, strict=True)) == [
        ("", 0.0, False), ("", 9.0, False), ("error-step-2.fmu", 0.0, True), ("error-step-2.fmu", 9.0, False),
    ]  # fmt: skip


def test_the_table_is_the_same_from_one_process_and_from_two(faulty_folder: Path, tmp_path: Path):
    given = study(
        faulty_folder, vary=[Block({"cab.u": Variable(Range(0.0, 1.0))}, "latin-hypercube", 40)], series=["cab.y"]
    )
    told: list[Progress] = []
    one = sweep(given, tmp_path / "one", processes=1)
    two = sweep(given, tmp_path / "two", processes=2, progress=told.append)
    assert one.path.read_bytes() == two.path.read_bytes()
    columns = two.columns()
    assert columns["run"].tolist() == list(range(40))
    np.testing.assert_allclose(columns["final(seat.y)"], 2.0 * (2.0 * columns["cab.u"] + 1.0) + 1.0, rtol=1e-14)
    assert [each.done for each in told] == sorted(each.done for each in told)
    assert (told[-1].done, told[-1].left) == (40, 0.0)
    assert not (two.folder / "parts").exists()
    assert json.loads((two.folder / "sweep.json").read_text())["complete"] is True
    import pandas as pd

    assert pd.read_parquet(two.path)["run"].tolist() == list(range(40))
    about = json.loads(pyarrow_parquet.read_schema(two.path).metadata[METADATA])
    assert set(about["versions"]) >= {"python", "numpy", "scipy", "fmpy", "seat-cosim"}
    assert len(about["fmus"]) == 1
    assert json.loads(about["study"])["metrics"] == list(METRICS)


def test_failed_runs_are_rows_with_their_reason(faulty_folder: Path, tmp_path: Path):
    given = study(faulty_folder, "error", vary=[grid(seat__strikes_at=(0.0, 9.0, 0.5, 8.0))])
    result = sweep(given, tmp_path / "out")
    assert (result.failed, [index for index, _ in result.failures]) == (2, [0, 2])
    assert all("seat: fmi2DoStep failed at t" in reason for _, reason in result.failures)
    found = result.columns()
    assert np.isnan(found["final(seat.y)"]).tolist() == [True, False, True, False]
    assert found["final(seat.y)"][1] == 3.0


def test_a_run_that_brings_its_process_down_is_a_row(faulty_folder: Path, tmp_path: Path):
    times = tuple(9.0 + i for i in range(7))
    given = study(faulty_folder, "segfault", vary=[grid(seat__strikes_at=(*times, 0.5, *(t + 20 for t in times)))])
    result = sweep(given, tmp_path / "out", processes=2)
    assert result.failures == [(7, "its FMUs brought the process down (signal SIGSEGV)")]
    assert np.isfinite(result.columns()["final(seat.y)"]).sum() == 14


def test_a_dead_worker_is_replaced_and_an_error_comes_through():
    with Processes[str, str](_obey, 1) as workers:
        jobs = ["a", "die", "b"]
        found = [result for _, result in workers.run(lambda: jobs.pop(0) if jobs else None)]
        assert [found[0], found[2]] == ["a", "b"]
        assert isinstance(found[1], WorkerDied)
        assert found[1].how == "exit code 3"
        jobs = ["raise"]
        with pytest.raises(SetupError, match="as asked"):
            list(workers.run(lambda: jobs.pop(0) if jobs else None))


def _obey(loaded: LoadedSystem, job: str) -> str:
    if job == "die":
        os._exit(3)
    if job == "raise":
        raise SetupError("as asked")
    return job


# ---- resumption ------------------------------------------------------------------------------------------------------

SCRIPT = """
import sys
from pathlib import Path
from tests.cosim.sweep.test_sweep import many
from cosim.sweep.sweep import sweep

if __name__ == "__main__":
    folder, out, scheduler = sys.argv[1:]
    sweep(many(Path(folder)), out, processes=1, scheduler=scheduler or None)
"""


def many(folder: Path) -> Study:
    """A study that takes some seconds."""
    return study(folder, stop_time=20.0, step_size=0.0001, vary=[grid(cab__u=tuple(float(u) for u in range(60)))])


def kill_client(folder: Path, out: Path, script: Path, scheduler: str = "") -> int:
    """Run :func:`many` in a process, and kill it after some batches; returns how many runs these have."""
    script.write_text(SCRIPT)
    path = os.pathsep.join(filter(None, sys.path))
    command = [sys.executable, str(script), str(folder), str(out), scheduler]
    with subprocess.Popen(command, env={**os.environ, "PYTHONPATH": path}) as process:
        wait_until(lambda: process.poll() is not None or len(list((out / "parts").glob("*.parquet"))) >= 2)
        process.send_signal(signal.SIGKILL)
        process.wait()
    assert process.returncode == -signal.SIGKILL
    names = [path.stem.split("-") for path in (out / "parts").glob("*.parquet")]
    return sum(int(last) - int(first) + 1 for first, last in names)


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_a_killed_sweep_goes_on_where_it_was(faulty_folder: Path, tmp_path: Path):
    finished = kill_client(faulty_folder, tmp_path / "out", tmp_path / "script.py")
    (tmp_path / "out" / "parts" / "000000050-000000059.tmp").write_bytes(b"half of a part")
    result = sweep(many(faulty_folder), tmp_path / "out", processes=2)
    assert 2 <= finished < 60
    assert result.resumed == finished
    whole = sweep(many(faulty_folder), tmp_path / "whole", processes=2)
    assert result.path.read_bytes() == whole.path.read_bytes()
    again = sweep(many(faulty_folder), tmp_path / "out")
    assert (again.resumed, again.runs) == (60, 60)


def test_a_folder_of_another_sweep_is_refused(faulty_folder: Path, tmp_path: Path):
    first = study(faulty_folder, vary=[grid(cab__u=(1.0, 2.0))])
    sweep(first, tmp_path / "out")
    other = replace(first, warm_up=0.1)
    with pytest.raises(SetupError, match="expected no sweep, or one of the same study, got another study; --force"):
        sweep(other, tmp_path / "out")
    assert sweep(other, tmp_path / "out", force=True).resumed == 0
    with locked_folder(tmp_path / "held"), pytest.raises(SetupError, match="expected a folder that no other run"):
        _in_thread(lambda: sweep(first, tmp_path / "held"))
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "run.json").write_text("{}")
    with pytest.raises(SetupError, match="expected a new folder, or that of a sweep, got one with run.json"):
        sweep(first, tmp_path / "full")


def _in_thread(call: Callable[[], object]) -> None:
    """Call in another thread, to which a lock of this one is another run's."""
    from concurrent.futures import ThreadPoolExecutor

    with ThreadPoolExecutor(1) as pool:
        pool.submit(call).result()


def test_other_fmus_are_another_sweep(faulty_folder: Path, tmp_path: Path):
    ok = study(faulty_folder, vary=[grid(cab__u=(1.0,))])
    moved = tmp_path / "ok.ssp"
    moved.write_bytes((faulty_folder / "ok.ssp").read_bytes())
    assert make_plan(ok).fingerprint == make_plan(replace(ok, folder=tmp_path)).fingerprint
    moved.write_bytes((faulty_folder / "error.ssp").read_bytes())
    assert make_plan(ok).fingerprint != make_plan(replace(ok, folder=tmp_path)).fingerprint


# ---- what is refused before a run ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"vary": [grid(cab__v=(1.0,))]}, "vary cab.v: cab.v: expected a variable of"),
        ({"vary": [grid(cap__u=(1.0,))]}, "cap.u: expected a parameter as component.variable, with a component among"),
        ({"vary": [grid(mass=(1.0,))]}, "of stop_time, step_size, algorithm, replace.cab, replace.seat, got mass"),
        ({"vary": [grid(cab__u=("x", 1.0))]}, "vary cab.u = x: cab.u: expected a number, got x"),
        ({"vary": [grid(algorithm=("jacoby",))]}, "algorithm: expected gauss-seidel or jacobi, got jacoby"),
        ({"parameters": {"cab.w": 1.0}}, "cab.w: expected a variable of"),
        ({"metrics": ["rms(cab.z)"]}, "cab.z"),
        ({"metrics": ["sum(cab.y)"]}, "metric sum(cab.y): expected a function among rms, peak, mean, min, max"),
        ({"metrics": ["a_w"]}, "metric a_w: expected a function such as rms(A.x), got a_w"),
        ({"metrics": []}, "metrics: expected at least one, or a series, got none"),
        ({"series": ["cab.z"]}, "cab.z"),
        ({"vary": [grid(replace__cab=("none.fmu",))]}, "none.fmu"),
        ({"vary": [Block({"run": Variable(Values((1.0,)), sets=("cab.u",))})]}, "run: expected one column"),
    ],
)  # fmt: skip
def test_what_does_not_fit_the_system_is_found_before_a_run(faulty_folder: Path, given: dict[str, Any], message: str):
    with pytest.raises(SetupError) as error:
        make_plan(study(faulty_folder, **given))
    assert message in str(error.value)
    assert len(error.value.problems) == 1


def test_an_estimate_measures_runs_over_the_whole_design(faulty_folder: Path):
    found = estimate(study(faulty_folder, "error", vary=[grid(seat__strikes_at=(9.0, *(0.01 * i for i in range(8))))]))
    assert (found.runs, found.measured) == (9, 8)
    assert found.failures
    assert 0.0 <= found.metrics < found.seconds
    assert found.total(1) - found.loading == pytest.approx(9 * found.seconds)
    assert found.total(3) - found.loading == pytest.approx(3 * found.seconds)


def test_a_table_is_read_back(faulty_folder: Path, tmp_path: Path):
    found = sweep(study(faulty_folder, vary=[grid(cab__u=(1.0, 2.0))]), tmp_path / "out")
    assert read_columns(found.path, ["cab.u"])["cab.u"].tolist() == [1.0, 2.0]
    with pytest.raises(SetupError, match="expected the table of a sweep"):
        read_columns(tmp_path / "none.parquet")


def test_a_system_of_one_run(faulty_folder: Path):
    system = System.load(faulty_folder / "ok.ssp")
    expected = system.simulate()["seat.y"][-1]
    assert table(study(faulty_folder))["final(seat.y)"] == [expected]
