"""Whether two commits give the same results, bit for bit: ``python -m benchmarks.compare_commits OLD [NEW]``.

Checks out both commits, installs and builds each in an environment of its own, runs the same commands in both and
compares what they leave: every CSV and Parquet file byte by byte, text that is printed, and whether the new commit
reruns each ``run.json`` of the old one, with the old one's FMUs, to the same bytes. A checkout that exists in the
folder of ``--work`` is used again. Exit code 1 where anything differs.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

RUNS = {
    "bump": "run bump",
    "bump-70-observer2": "run bump --driver-mass 70 --observer 2",
    "bump-recommended": "run bump --driver-mass 110 --gains recommended",
    "bump-fmi3": "run bump --flavour fmi3",
    "bump-python": "run bump --flavour python",
    "sine-off": "run sine --set shaker.sine.frequency=2 --control off",
    "sweep": "run sweep",
    "random": "run random --set shaker.random.class=EM5 --set shaker.random.seed=7 --format parquet",
    "file": "run file",
    "passive": "run random --parameters ride --parameters load --control passive",
    "prototype": "run random --parameters ride --parameters load --parameters prototype",
    "stops": "run bump --set seat.end_stop.travel=0.03 --set seat.end_stop.stiffness=20000",
    "isolated": "run bump --isolate controller",
    "jacobi": "simulate fmus/SeatSuspension.ssp --algorithm jacobi",
    "mixed": "simulate fmus/SeatSuspension.ssp --replace seat=fmus/fmi3/SeatPlant.fmu",
    "ssp-fmi3": "simulate fmus/SeatSuspension-fmi3.ssp --record-every 5",
    "slow-controller": "simulate fmus/SeatSuspension.ssp --component-step controller=0.004 --stop-time 2",
}
"""Name of a run to its command; each leaves a run.json."""

OTHERS = {
    "reproduce": "reproduce",
    "reproduce-bump": "reproduce bump --driver-mass 70",
    "evaluate": "evaluate --classes EM1,EM6 --masses 55,100 --seeds 1,2,3 --duration 20",
    "design": "design --gains recommended",
}
"""Name to further commands; what they leave and print is compared."""

PRINTED = ("design",)
"""Commands of which the printed text is compared as well."""


def checkout(commit: str, work: Path) -> Path:
    """Check out a commit into a folder of its own, install it and build its FMUs.

    Parameters
    ----------
    commit
        Any name of it.
    work
        Where the checkouts lie.

    Returns
    -------
    Path
        The checkout.
    """
    name = subprocess.run(["git", "rev-parse", commit], capture_output=True, text=True, check=True).stdout.strip()
    folder = work / name[:12]
    if not folder.exists():
        subprocess.run(["git", "clone", "--quiet", ".", str(folder)], check=True)
        subprocess.run(["git", "checkout", "--quiet", name], cwd=folder, check=True)
    subprocess.run(["make", "--silent", ".venv/installed-test"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    command(folder, "build")
    return folder


def command(folder: Path, words: str, *more: str) -> str:
    """Run ``seat-cosim`` in a checkout; returns what it prints.

    Raises
    ------
    SystemExit
        If it fails.
    """
    program = [str(folder / ".venv/bin/seat-cosim"), *words.split(), *more]
    done = subprocess.run(program, cwd=folder, capture_output=True, text=True, check=False, env=dict(os.environ))
    if done.returncode:
        raise SystemExit(f"{folder}: {' '.join(program)} ended with {done.returncode}: {done.stderr.strip()[-500:]}")
    return done.stdout


def results(folder: Path) -> Iterator[tuple[str, str]]:
    """Yield each table below a folder and the hash of its bytes."""
    for path in sorted([*folder.rglob("*.csv"), *folder.rglob("*.parquet")]):
        yield path.relative_to(folder).as_posix(), hashlib.sha256(path.read_bytes()).hexdigest()


def run_all(folder: Path, output: Path) -> dict[str, str]:
    """Run all commands in a checkout; returns the printed texts that count."""
    printed = {}
    for name, words in {**RUNS, **OTHERS}.items():
        target = [] if name in PRINTED else ["--output", str(output / name)]
        text = command(folder, words, *target)
        if name in PRINTED:
            printed[name] = text
    return printed


def main() -> None:
    """Compare two commits and print a line for each result."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("old")
    parser.add_argument("new", nargs="?", default="HEAD")
    parser.add_argument("--work", type=Path, default=Path(tempfile.gettempdir()) / "compare-commits")
    arguments = parser.parse_args()
    arguments.work.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as temporary:
        folders = {name: checkout(getattr(arguments, name), arguments.work) for name in ("old", "new")}
        printed = {name: run_all(folder, Path(temporary, name)) for name, folder in folders.items()}
        found = {name: dict(results(Path(temporary, name))) for name in folders}
        different = 0
        for name in sorted(set(found["old"]) | set(found["new"])):
            same = found["old"].get(name) == found["new"].get(name)
            different += not same
            print(f"{'same bytes' if same else 'DIFFERENT '}  {name}  {found['new'].get(name, 'missing')[:12]}")
        for name in PRINTED:
            same = printed["old"][name] == printed["new"][name]
            different += not same
            print(f"{'same text ' if same else 'DIFFERENT '}  {name}")
        for name in RUNS:
            manifest = Path(temporary, "old", name, "run.json")
            program = [str(folders["new"] / ".venv/bin/seat-cosim"), "rerun", str(manifest)]
            done = subprocess.run(program, cwd=folders["old"], capture_output=True, text=True, check=False)
            different += done.returncode != 0
            said = done.stderr.strip().splitlines()[-1:] if done.returncode else ["same bytes"]
            print(f"{'rerun      ' if not done.returncode else 'RERUN FAILS'} {name}: {said[0] if said else ''}")
    total = len(set(found["old"]) | set(found["new"])) + len(PRINTED) + len(RUNS)
    print(f"{total - different} of {total} the same")
    sys.exit(1 if different else 0)


if __name__ == "__main__":
    main()
