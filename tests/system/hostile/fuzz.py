"""The properties of this folder as targets, each run in a process of its own: bounded for the tests, or for minutes.

    python -m tests.system.hostile.fuzz --minutes 2                    every target for 2 minutes, a table at the end
    python -m tests.system.hostile.fuzz states/fmi3 --minutes 10       those whose name holds one of the words
    python -m tests.system.hostile.fuzz readers/ssv --seed 123 --cases 500     the same cases again

A find is printed with the seed that leads to it, and kept in results/hostile.
"""

from __future__ import annotations

import argparse
import faulthandler
import json
import os
import secrets
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st
from hypothesis.errors import HypothesisWarning
from hypothesis.stateful import run_state_machine_as_test

from seat_cosim.components import COMPONENTS
from tests.system.hostile import extracted_fmus, file_properties, fmu_properties, guided
from tests.system.hostile.caller import Caller
from tests.system.hostile.extracted_fmus import FLAVOURS, ExtractedFmu

ROOT = Path(__file__).parents[3]

BATCH = 200
"""Cases between two looks at the clock."""

NAMES = [f"{flavour}/{component.name}" for flavour in FLAVOURS for component in COMPONENTS]

TARGETS = (
    *(f"{kind}/{name}" for kind in ("values", "calls", "states") for name in NAMES),
    *(f"{kind}/{name}/sanitized" for kind in ("calls", "states") for name in NAMES if not name.startswith("python")),
    *(f"readers/{name}" for name in (*guided.READERS, "parquet", "mdf4", "recording")),
)
"""What can be run, by name."""

Counted = Callable[[int, int], int]
"""Runs so many cases of a seed and returns how many there were."""


@dataclass(frozen=True)
class Place:
    """Where a target works.

    Attributes
    ----------
    built
        Holds the FMUs of all flavours and the systems of them.
    folder
        Of its own, empty at first.
    """

    built: Path
    folder: Path

    @property
    def notes(self) -> Path:
        """The calls since the last instance was made."""
        return self.folder / "calls"


def _settings(cases: int) -> settings:
    return settings(
        max_examples=cases,
        deadline=None,
        database=None,
        phases=(Phase.explicit, Phase.generate, Phase.shrink),
        suppress_health_check=list(HealthCheck),
        stateful_step_count=30,
        print_blob=False,
    )


# ---- targets ---------------------------------------------------------------------------------------------------------


def _extracted(place: Place, name: str) -> ExtractedFmu:
    flavour, component = name.split("/")[:2]
    found = extracted_fmus.extracted_fmu(place.built / flavour / f"{component}.fmu", flavour, place.folder)
    return extracted_fmus.sanitized(found) if name.endswith("sanitized") else found


def values(place: Place, name: str) -> Counted:
    """Every special value of every parameter and input; the seed does not matter."""
    fmu = _extracted(place, name)
    caller = Caller(fmu.library, place.notes)
    return lambda number, cases: fmu_properties.every_value_is_taken_or_refused(caller, fmu)


def calls(place: Place, name: str) -> Counted:
    """Any order of calls."""
    fmu = _extracted(place, name)
    caller = Caller(fmu.library, place.notes)
    files = []
    for i, data in enumerate(file_properties.recordings()):
        files.append(str(place.folder / f"{i}.csv").encode())
        Path(os.fsdecode(files[-1])).write_bytes(data)
    machine = fmu_properties.life_cycle(caller, fmu, files)

    def run(number: int, cases: int) -> int:
        run_state_machine_as_test(seed(number)(machine), settings=_settings(cases))
        return cases

    return run


def states(place: Place, name: str) -> Counted:
    """States from bytes, those of other FMUs among them."""
    fmu = _extracted(place, name)
    strangers = []
    for other in (f"{flavour}/{fmu.name}" for flavour in FLAVOURS[:2] if flavour != fmu.flavour):
        stranger = _extracted(place, other)
        found = fmu_properties.Checked(Caller(stranger.library, place.notes), stranger)
        strangers += fmu_properties.saved_states(found)
        found.free()
    checked = fmu_properties.Checked(Caller(fmu.library, place.notes), fmu)
    saved = fmu_properties.saved_states(checked)

    def refused_or_harmless(data: bytes) -> None:
        fmu_properties.a_state_is_refused_or_harmless(checked, data)
        checked.reset()

    drawn = fmu_properties.spoiled_states(saved, strangers, fmu.is_native)
    return _property(refused_or_harmless, drawn)


def readers(place: Place, name: str) -> Counted:
    """Spoiled files."""
    (place.folder / "files").mkdir()
    (place.folder / "temporary").mkdir()
    reader = file_properties.readers(place.built, place.folder / "files")[name]
    tempfile.tempdir = str(place.folder / "temporary")
    return _property(
        lambda data: file_properties.reads_or_refuses(reader, data, place.folder / "files") and None, reader.spoiled
    )


def _property(check: Callable[[bytes], None], drawn: st.SearchStrategy[bytes]) -> Counted:
    def run(number: int, cases: int) -> int:
        count = 0

        @seed(number)
        @_settings(cases)
        @given(drawn)
        def holds(data: bytes) -> None:
            nonlocal count
            count += 1
            before = os.fstat(2).st_size
            check(data)
            assert os.fstat(2).st_size == before, "something was printed"

        holds()
        return count

    return run


# ---- in a process of its own -----------------------------------------------------------------------------------------


def work(targets: Sequence[str], place: Place, number: int, cases: int | None, until: float) -> None:
    """Run targets one after the other and say as JSON how many cases there were, to what was standard output.

    All that the code under test prints goes to standard error, which is a file.
    """
    ours = os.dup(1)
    os.dup2(2, 1)
    faulthandler.register(signal.SIGALRM, chain=True)  # says where a call hangs
    warnings.simplefilter("ignore", HypothesisWarning)
    warnings.simplefilter("always", UserWarning)
    before = os.fstat(2).st_size
    total, start = 0, time.process_time()
    for target in targets:
        kind, _, name = target.partition("/")
        own = Place(place.built, place.folder / target)
        own.folder.mkdir(parents=True)
        run = globals()[kind](own, name)
        while True:
            total += run(number, cases or BATCH)
            assert os.fstat(2).st_size == before, f"{target}: something was printed"
            if cases is not None or time.monotonic() > until or kind == "values":
                break
            number += 1
    os.write(ours, json.dumps({"cases": total, "seconds": time.process_time() - start}).encode())
    os._exit(0)  # a foreign library may crash on a regular end, which is not our question


@dataclass(frozen=True)
class Outcome:
    """What became of a target.

    Attributes
    ----------
    found
        What was printed if something was found, else None.
    """

    cases: int
    seconds: float
    found: str | None = None


def play(targets: Sequence[str], built: Path, number: int, cases: int | None = None, seconds: float = 0.0) -> Outcome:
    """Run targets in a process of their own.

    Parameters
    ----------
    targets
        Of :data:`TARGETS`; all of them with sanitizers, or none.
    built
        Holds the FMUs of all flavours and the systems of them.
    number
        The seed; further batches take those that follow.
    cases
        How many; None for as many as there is time for.
    seconds
        That time.
    """
    folder = Path(tempfile.mkdtemp(prefix="hostile-"))
    words = [*targets, "--work", str(folder), "--built", str(built), "--seed", str(number)]
    words += ["--minutes", str(seconds / 60.0)] if cases is None else ["--cases", str(cases)]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    environment |= extracted_fmus.sanitizers() if targets[0].endswith("sanitized") else {}
    try:
        with (folder / "printed").open("wb") as printed:
            run = subprocess.run(
                [sys.executable, __file__, *words], stdout=subprocess.PIPE, stderr=printed, env=environment, check=False
            )
        if run.returncode == 0:
            report = json.loads(run.stdout)
            return Outcome(report["cases"], report["seconds"])
        said = (folder / "printed").read_text(errors="replace")[-20_000:]
        *_, latest = sorted((Place(built, folder / target) for target in targets), key=_age)
        last = latest.notes.read_text(errors="replace")[-5_000:] if latest.notes.is_file() else ""
        which = latest.folder.relative_to(folder)
        return Outcome(0, 0.0, f"{which}, seed {number}: ended with {run.returncode}\n{said}\nlast calls:\n{last}")
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _age(place: Place) -> int:
    """When a target began, for the order; 0 if it did not."""
    return place.folder.stat().st_ctime_ns if place.folder.is_dir() else 0


# ---- for minutes -----------------------------------------------------------------------------------------------------


def _rounds(target: str, built: Path, number: int, cases: int | None, seconds: float) -> Iterator[Outcome]:
    """Run a target until its time is over, anew after each find."""
    until = time.monotonic() + seconds
    while True:
        left = until - time.monotonic()
        if target in guided.TARGETS:
            outcome = _guided(target, built, number, left)
        else:
            outcome = play([target], built, number, cases, left)
        yield outcome
        number += 1_000_000
        if cases is not None or outcome.found is None or time.monotonic() > until:
            return


def _guided(target: str, built: Path, number: int, seconds: float) -> Outcome:
    begin = os.times()
    found = guided.play(target, built, number, seconds)
    end = os.times()
    spent = end.children_user + end.children_system - begin.children_user - begin.children_system
    return Outcome(found.cases, spent, found.found)


def main() -> None:
    """Run targets one after the other; print a table; end with 1 if anything was found."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("words", nargs="*", help="of targets' names [default: all]")
    parser.add_argument("--minutes", type=float, default=1.0, help="for each target")
    parser.add_argument("--cases", type=int, help="so many, whatever the time")
    parser.add_argument("--seed", type=int, default=None, help="[default: a random one]")
    parser.add_argument("--built", type=Path, default=ROOT / "fmus", help="folder of the FMUs")
    parser.add_argument("--work", type=Path, help=argparse.SUPPRESS)
    given_: Any = parser.parse_args()
    number = secrets.randbelow(10**6) if given_.seed is None else given_.seed
    if given_.work:
        until = time.monotonic() + 60.0 * given_.minutes
        work(given_.words, Place(given_.built, given_.work), number, given_.cases, until)
    chosen = [
        name for name in (*TARGETS, *guided.TARGETS) if not given_.words or any(word in name for word in given_.words)
    ]
    finds = 0
    print(f"seed {number}\n{'target':36} {'cases':>9} {'seconds':>8} {'finds':>6}", flush=True)
    for target in chosen:
        if target in guided.TARGETS and (tool := guided.missing(target)):
            print(f"{target:36} not run: expected {tool}, got none", flush=True)
            continue
        outcomes = [*_rounds(target, given_.built.absolute(), number, given_.cases, 60.0 * given_.minutes)]
        found = [outcome.found for outcome in outcomes if outcome.found is not None]
        finds += len(found)
        cases, seconds = sum(o.cases for o in outcomes), sum(o.seconds for o in outcomes)
        print(f"{target:36} {cases:9d} {seconds:8.1f} {len(found):6d}", flush=True)
        for i, text in enumerate(found):
            kept = ROOT / "results" / "hostile" / f"{target.replace('/', '-')}-{number}-{i}.txt"
            kept.parent.mkdir(parents=True, exist_ok=True)
            kept.write_text(text)
            print(f"  {kept}: {text.splitlines()[0]}", flush=True)
    sys.exit(1 if finds else 0)


if __name__ == "__main__":
    main()
