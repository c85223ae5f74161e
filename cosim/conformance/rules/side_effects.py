"""Rules about side effects: what a run changes in the host's process and on its disk."""

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

from cosim.conformance.harness import Harness, file_stats
from cosim.conformance.raw_instance import InstantiationError
from cosim.conformance.rule import NotApplicableError, rule
from cosim.conformance.rules.lifecycle import NEEDS_RUN

_MAX_CYCLES = 60
"""Maximum number of cycles of one measurement; a cycle creates an instance, runs two steps and frees it."""

_MIN_CYCLES = 20
"""Minimum number of cycles of one measurement; fewer are not significant."""

_MEASUREMENTS = 3
"""Number of measurements; the smallest growth counts."""

_DURATION = 0.4
"""How long one measurement may take, in s; slow FMUs get fewer cycles."""

LEAK = 1024
"""Bytes by which memory may grow per cycle; less than a page in four cycles is noise of the allocator."""

_STATM, _DESCRIPTORS = Path("/proc/self/statm"), Path("/proc/self/fd")


@rule(
    "side_effects.output",
    "Nothing is written to standard output or standard error",
    stage="behaviour",
    severity="warning",
    needs=NEEDS_RUN,
)
def output(harness: Harness) -> Iterator[str]:
    with harness.initialized() as instance:
        harness.run(instance)
    if text := harness.captured_output().strip():
        lines = text.splitlines()
        more = f" (and {len(lines) - 1} more lines)" if len(lines) > 1 else ""
        yield f"expected messages through the logger only, printed: {lines[0][:120]}{more}"


@rule(
    "side_effects.files",
    "No files are left in the working folder or changed in the FMU's folder",
    stage="behaviour",
    severity="warning",
    needs=NEEDS_RUN,
)
def files(harness: Harness) -> Iterator[str]:
    working_folder, before = Path.cwd(), file_stats(harness.folder)
    with harness.initialized() as instance:
        harness.run(instance)
    if left := sorted(file_stats(working_folder)):
        yield f"expected an empty working folder afterwards, got {', '.join(left[:3])}"
    after = file_stats(harness.folder)
    if changed := sorted(name for name in before | after if before.get(name) != after.get(name)):
        yield f"expected the FMU's own folder unchanged, got changes in {', '.join(changed[:3])}"


@rule(
    "side_effects.process",
    "Working folder, locale, signals, umask and floating-point modes of the process do not change",
    stage="behaviour",
    severity="warning",
    needs=NEEDS_RUN,
)
def process(harness: Harness) -> Iterator[str]:
    harness.library  # noqa: B018  # what loading changes is not checked
    before = {name: read() for name, read in SETTINGS.items()}
    with harness.initialized() as instance:
        harness.run(instance)
    for name, read in SETTINGS.items():
        if (after := read()) != before[name]:
            yield f"{name}: expected {before[name]} as before, got {after}"


def _signal_handlers() -> str:
    signals = (signal.SIGINT, signal.SIGTERM, signal.SIGFPE, signal.SIGSEGV)
    return ", ".join(str(signal.getsignal(number)) for number in signals)


def _umask() -> str:
    mask = os.umask(0)
    os.umask(mask)
    return f"{mask:03o}"


SETTINGS: dict[str, Callable[[], str]] = {
    "working folder": os.getcwd,
    "locale": lambda: str(locale.setlocale(locale.LC_ALL, None)),
    "signal handlers": _signal_handlers,
    "permissions of new files": _umask,
    "denormal numbers": lambda: "kept" if sys.float_info.min / 2.0 > 0.0 else "flushed to zero",
    "rounding": lambda: "to nearest" if 1.0 + 1e-17 == 1.0 and 1.0 - 1e-17 == 1.0 else "in another direction",
}
"""Name of a setting of the process to the function that reads it."""


def _run_cycle(harness: Harness) -> None:
    """Create an instance, run two steps and free it."""
    with harness.initialized() as instance:
        harness.run(instance, last=2)


def _cycles_per_measurement(harness: Harness) -> int:
    """Run some cycles as a warm-up; return how many fit into a measurement.

    Raises
    ------
    NotApplicableError
        If too few fit, or this operating system does not report the memory of a process.
    """
    if not _STATM.exists():
        raise NotApplicableError(f"this system has no {_STATM.parent} to measure with")
    begin = time.perf_counter()
    for _ in range(_MIN_CYCLES):
        _run_cycle(harness)
        if time.perf_counter() - begin > _DURATION:
            raise NotApplicableError("the FMU is too slow for a measurement")
    return min(_MAX_CYCLES, int(_MIN_CYCLES * _DURATION / (time.perf_counter() - begin)))


@rule(
    "side_effects.memory",
    "Freeing an instance frees its memory",
    clause="2.0 §2.1.5; 3.0 §2.3.1",
    stage="behaviour",
    needs=NEEDS_RUN,
)
def memory(harness: Harness) -> Iterator[str]:
    try:
        cycles = _cycles_per_measurement(harness)
        growth = [_growth(harness, cycles) for _ in range(_MEASUREMENTS)]
    except InstantiationError as error:  # of a tool's licence, for example; the other rules need a few instances only
        number = harness.library.instances
        raise NotApplicableError(f"too few instances for a measurement: instance {number}: {error}") from None
    worst = max(map(min, zip(*growth, strict=True)))  # an allocator grows once, a leak in every measurement
    if worst > LEAK:
        yield f"expected no growth per instance, got {worst / 1024:.1f} KiB each over {_MEASUREMENTS * cycles}"


def _growth(harness: Harness, cycles: int) -> tuple[float, float]:
    """Run cycles; return by how many bytes the memory grew in each: that of the process, that of C's allocator."""
    before = _resident(), _allocated()
    for _ in range(cycles):
        _run_cycle(harness)
    return (_resident() - before[0]) / cycles, (_allocated() - before[1]) / cycles


def _resident() -> int:
    """Return the resident memory of the process in bytes; coarse, as a leak fills free pages first."""
    return int(_STATM.read_text().split()[1]) * os.sysconf("SC_PAGESIZE")


def _allocated() -> int:
    """Return the bytes that C's allocator has allocated, without those of Python's; 0 where it does not report them."""
    with suppress(AttributeError):
        mallinfo = ctypes.CDLL(None).mallinfo2
        mallinfo.restype = _MallInfo
        found = mallinfo()
        return int(found.hblkhd + found.uordblks)  # blocks in pages of their own, blocks in the heap
    return 0


class _MallInfo(ctypes.Structure):
    """The struct ``mallinfo2`` of glibc."""

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
    needs=NEEDS_RUN,
)
def descriptors(harness: Harness) -> Iterator[str]:
    if not _DESCRIPTORS.exists():
        raise NotApplicableError(f"this system has no {_DESCRIPTORS} to count")
    _run_cycle(harness)
    before = len(list(_DESCRIPTORS.iterdir()))
    for _ in range(3):
        _run_cycle(harness)
    if (more := len(list(_DESCRIPTORS.iterdir())) - before) > 0:
        yield f"expected as many open files as before, got {more} more after 3 instances"
