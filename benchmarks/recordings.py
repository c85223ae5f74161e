"""Time and memory to read a million rows of two channels from files of data loggers.

    python -m benchmarks.recordings

Each file is read in a fresh process: wall time of the reading alone, and the largest memory of the process with all its
packages. The bounds are those that the project keeps.
"""

from __future__ import annotations

import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from cosim.recordings import ChannelRequest, read_recording

ROWS, RATE = 1_000_000, 1000.0
SECONDS, MEGABYTES = 10.0, 1000.0
"""Bounds of time and memory."""


def samples() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return times in s and two accelerations in m/s2."""
    t = np.arange(ROWS) / RATE
    noise = np.random.default_rng(0).standard_normal((2, ROWS))
    return t, np.sin(20.0 * t) + 0.5 * noise[0], 0.5 * np.sin(20.0 * t - 0.3) + 0.3 * noise[1]


def comma(value: float) -> str:
    """Write a number with a decimal comma."""
    return f"{value:.5f}".replace(".", ",")


def clock(t: float) -> str:
    """Write the time of day of a ride that begins at 23:50."""
    t = (t + 85_800.0) % 86_400.0
    return f"{int(t // 3600):02d}:{int(t % 3600 // 60):02d}:{t % 60:06.3f}"


def write(folder: Path) -> None:
    """Write the files."""
    import asammdf
    import pyarrow
    import pyarrow.parquet
    import scipy.io

    t, floor, seat = samples()
    rows = list(zip(t.tolist(), floor.tolist(), seat.tolist(), strict=True))
    with (folder / "commas.csv").open("w") as file:
        file.write("time [s],floor [m/s2],seat [m/s2]\n")
        file.writelines(f"{a:.3f},{b:.5f},{c:.5f}\n" for a, b, c in rows)
    with (folder / "decimal-commas.csv").open("w", encoding="utf-16") as file:
        file.write("time [ms];floor [g];seat [g]\n")
        file.writelines(f"{1000.0 * a:.0f};{comma(b)};{comma(c)}\n" for a, b, c in rows)
    with (folder / "times-of-day.txt").open("w") as file:
        file.write("time\tfloor [m/s2]\tseat [m/s2]\n")
        file.writelines(f"{clock(a)}\t{b:.5f}\t{c:.5f}\n" for a, b, c in rows)
    with (folder / "dates.csv").open("w") as file:
        file.write("time;floor [m/s2];seat [m/s2]\n")
        file.writelines(f"{1 + int(a >= 600.0):02d}.03.2024 {clock(a)};{b:.5f};{c:.5f}\n" for a, b, c in rows)
    signals = [asammdf.Signal(values, t, name=name, unit="m/s2") for name, values in (("floor", floor), ("seat", seat))]
    with asammdf.MDF(version="4.10") as mdf:
        mdf.append(signals, common_timebase=True)
        mdf.save(folder / "ride.mf4")
    scipy.io.savemat(folder / "ride.mat", {"time": t, "floor": floor, "seat": seat})
    pyarrow.parquet.write_table(pyarrow.table({"time": t, "floor": floor, "seat": seat}), folder / "ride.parquet")


def measure(path: Path) -> None:
    """Read one file; print seconds and MB."""
    begin = time.perf_counter()
    found = read_recording(path, {key: ChannelRequest(key, f"--{key}") for key in ("floor", "seat")})
    seconds = time.perf_counter() - begin
    assert found.parts[0].size == ROWS
    print(seconds, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0)


def main() -> None:
    """Print the table; exit with 1 if a bound is exceeded."""
    if len(sys.argv) > 1:
        path = Path(sys.argv[1])
        return write(path) if path.is_dir() else measure(path)
    exceeded = False
    with tempfile.TemporaryDirectory() as name:
        command = [sys.executable, "-m", "benchmarks.recordings"]
        subprocess.run([*command, name], check=True)  # this process stays small: children count its memory as theirs
        for path in sorted(Path(name).iterdir()):
            done = subprocess.run([*command, str(path)], capture_output=True, text=True, check=True)
            seconds, megabytes = map(float, done.stdout.split())
            exceeded = exceeded or seconds > SECONDS or megabytes > MEGABYTES
            size = path.stat().st_size / 1e6
            print(f"{path.name:20} {size:4.0f} MB file   {seconds:5.1f} s   {megabytes:4.0f} MB")
    print(f"bounds {SECONDS:g} s, {MEGABYTES:g} MB: {'exceeded' if exceeded else 'kept'}")
    sys.exit(int(exceeded))


if __name__ == "__main__":
    main()
