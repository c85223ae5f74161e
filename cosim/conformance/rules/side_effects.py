"""Rules about manners: what an FMU leaves behind in the process and on the disk of its host."""

from __future__ import annotations

import ctypes
import locale
import os
import signal
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

from cosim.conformance.harness import Bench, entries
from cosim.conformance.rule import NotApplicableError, rule
from cosim.conformance.rules.lifecycle import RUNS

_CYCLES = 60
"""How many lives make a measurement."""

_BATCHES = 3
"""How many measurements are made; the smallest growth counts."""

_PATIENCE = 0.4
"""How long a measurement may take, in s; FMUs that are slow to make live fewer lives."""

_FEWEST = 20
"""Fewer lives than this say nothing."""

LEAK = 1024
"""Bytes a life may leave behind: less than a page in four lives is noise of the allocator."""

_STATM, _DESCRIPTORS = Path("/proc/self/statm"), Path("/proc/self/fd")


@rule(
    "side_effects.output",
    "Nothing is written to standard output or standard error",
    stage="behaviour",
    severity="warning",
    needs=RUNS,
)
def output(bench: Bench) -> Iterator[str]:
    with bench.started() as slave:
        bench.run(slave)
    if text := bench.printed().strip():
        lines = text.splitlines()
        more = f" (and {len(lines) - 1} more lines)" if len(lines) > 1 else ""
        yield f"expected messages through the logger alone, printed: {lines[0][:120]}{more}"


@rule(
    "side_effects.files",
    "No files are left in the working folder, none changed where the FMU was extracted",
    stage="behaviour",
    severity="warning",
    needs=RUNS,
)
def files(bench: Bench) -> Iterator[str]:
    here, before = Path.cwd(), entries(bench.folder)
    with bench.started() as slave:
        bench.run(slave)
    if left := sorted(entries(here)):
        yield f"expected an empty working folder afterwards, got {', '.join(left[:3])}"
    after = entries(bench.folder)
    if changed := sorted(name for name in before | after if before.get(name) != after.get(name)):
        yield f"expected the FMU's own folder unchanged, got changes in {', '.join(changed[:3])}"


@rule(
    "side_effects.process",
    "Working folder, locale, signals, environment and arithmetic of the process stay as they are",
    stage="behaviour",
    severity="warning",
    needs=RUNS,
)
def process(bench: Bench) -> Iterator[str]:
    bench.library  # noqa: B018  # loading it is not running it
    before = {name: look() for name, look in SETTINGS.items()}
    with bench.started() as slave:
        bench.run(slave)
    for name, look in SETTINGS.items():
        if (after := look()) != before[name]:
            yield f"{name}: expected {before[name]} as before, got {after}"


def _handlers() -> str:
    found = (signal.SIGINT, signal.SIGTERM, signal.SIGFPE, signal.SIGSEGV)
    return ", ".join(str(signal.getsignal(number)) for number in found)


def _umask() -> str:
    mask = os.umask(0)
    os.umask(mask)
    return f"{mask:03o}"


SETTINGS: dict[str, Callable[[], str]] = {
    "working folder": os.getcwd,
    "locale": lambda: str(locale.setlocale(locale.LC_ALL, None)),
    "signal handlers": _handlers,
    "permissions of new files": _umask,
    "denormal numbers": lambda: "kept" if sys.float_info.min / 2.0 > 0.0 else "flushed to zero",
    "rounding": lambda: "to nearest" if 1.0 + 1e-17 == 1.0 and 1.0 - 1e-17 == 1.0 else "in another direction",
}
"""What belongs to the process and how to look at it."""


def _live(bench: Bench) -> None:
    """Make an instance, run it a little, and free it."""
    with bench.started() as slave:
        bench.run(slave, last=2)


def _lives(bench: Bench) -> int:
    """Live a few lives to get used to it, and return how many fit into a measurement.

    Raises
    ------
    NotApplicableError
        If too few do, or this system does not tell what there is to measure.
    """
    if not _STATM.exists():
        raise NotApplicableError(f"this system has no {_STATM.parent} to measure with")
    begin = time.perf_counter()
    for _ in range(_FEWEST):
        _live(bench)
        if time.perf_counter() - begin > _PATIENCE:
            raise NotApplicableError("the FMU takes too long to live many lives")
    return min(_CYCLES, int(_FEWEST * _PATIENCE / (time.perf_counter() - begin)))


@rule(
    "side_effects.memory",
    "Freeing an instance frees its memory",
    clause="2.0 §2.1.5; 3.0 §2.3.1",
    stage="behaviour",
    needs=RUNS,
)
def memory(bench: Bench) -> Iterator[str]:
    cycles = _lives(bench)
    grown = []
    for _ in range(_BATCHES):  # an allocator grows once, a leak always
        before = _resident(), _allocated()
        for _ in range(cycles):
            _live(bench)
        grown.append(((_resident() - before[0]) / cycles, (_allocated() - before[1]) / cycles))
    worst = max(map(min, zip(*grown, strict=True)))
    if worst > LEAK:
        yield f"expected no growth from life to life, got {worst / 1024:.1f} KiB each over {_BATCHES * cycles}"


def _resident() -> int:
    """Return the size of the process in memory: coarse, as a leak first fills what was free."""
    return int(_STATM.read_text().split()[1]) * os.sysconf("SC_PAGESIZE")


def _allocated() -> int:
    """Return what C's allocator has given out; 0 where it does not tell. What Python keeps is not in it."""
    with suppress(AttributeError):
        mallinfo = ctypes.CDLL(None).mallinfo2
        mallinfo.restype = _MallInfo
        found = mallinfo()
        return int(found.hblkhd + found.uordblks)  # blocks in pages of their own, blocks in the heap
    return 0


class _MallInfo(ctypes.Structure):
    """What glibc tells of its allocator."""

    _fields_ = tuple(
        (name, ctypes.c_size_t)
        for name in (
            "arena",
            "ordblks",
            "smblks",
            "hblks",
            "hblkhd",
            "usmblks",
            "fsmblks",
            "uordblks",
            "fordblks",
            "keepcost",
        )
    )


@rule(
    "side_effects.descriptors",
    "Freeing an instance closes its files",
    clause="2.0 §2.1.5; 3.0 §2.3.1",
    stage="behaviour",
    needs=RUNS,
)
def descriptors(bench: Bench) -> Iterator[str]:
    if not _DESCRIPTORS.exists():
        raise NotApplicableError(f"this system has no {_DESCRIPTORS} to count")
    _live(bench)
    before = len(list(_DESCRIPTORS.iterdir()))
    for _ in range(3):
        _live(bench)
    if (more := len(list(_DESCRIPTORS.iterdir())) - before) > 0:
        yield f"expected as many open files as before, got {more} more after 3 lives"
