"""Search for the seeds of the Shaker whose motion conforms to its class: the seeds of seat_cosim/evaluation/inputs.py.

python -m studies.conforming_inputs                    all classes, seeds 1 to 4000: some ten minutes of CPU
python -m studies.conforming_inputs --classes EM1,EM7 --last 300

A seed conforms if over 180 s, after 10 s, the RMS in the class's band is within 5 % of the standard's and each line of
the spectrum within 10 % of its peak, both at 0.25 Hz and at 0.5 Hz (where no seed does, at 0.25 Hz alone). The search
of a class ends when enough seeds are found. They are printed in the order of their larger deviation.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from cosim import System
from cosim.engine.session import Session
from seat_cosim.evaluation.inputs import INPUTS, RESOLUTION, InputConformity, conformity
from seat_cosim.evaluation.protocol import Protocol
from studies.tune_baselines import ROOT

FLOOR = "shaker.floor_acceleration"
STEP_SIZE = 0.002
COARSE = 0.5
"""Second resolution in Hz at which a seed must conform: the widest that laboratories use."""
ENOUGH = 6
"""Number of seeds after which the search of a class ends."""


class Found(NamedTuple):
    """A seed and its deviations at :data:`RESOLUTION` and :data:`COARSE`."""

    seed: int
    fine: InputConformity
    coarse: InputConformity

    @property
    def share(self) -> float:
        """Largest deviation as a share of what is allowed."""
        return max(self.fine.share, self.coarse.share)


def shaker(fmus: Path) -> System:
    """Return a system of the Shaker alone."""
    system = System()
    system.add("shaker", fmus / "Shaker.fmu")
    system.step_size = STEP_SIZE
    return system


def motion(session: Session, name: str, seed: int, protocol: Protocol, resolution: float) -> InputConformity:
    """Run the Shaker and compare its motion with a class."""
    parameters = {"shaker.profile": "random", "shaker.random.class": name, "shaker.random.seed": seed}
    result = session.run(protocol.stop_time, parameters=parameters, record=[FLOOR])
    found = conformity(name, result[FLOOR], 1.0 / STEP_SIZE, protocol.warm_up, resolution)
    assert found is not None
    return found


def search(session: Session, name: str, protocol: Protocol, last: int) -> Iterator[Found]:
    """Yield the seeds that conform at :data:`RESOLUTION`."""
    for seed in range(1, last + 1):
        fine = motion(session, name, seed, protocol, RESOLUTION)
        if fine.share <= 1.0:
            yield Found(seed, fine, motion(session, name, seed, protocol, COARSE))


def main() -> None:
    """Search and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--classes", default=",".join(INPUTS), help="names with commas between")
    parser.add_argument("--last", type=int, default=4000, help="last seed that is tried")
    arguments = parser.parse_args()
    with shaker(ROOT / "fmus" / "fmi2").open() as session:
        for name in arguments.classes.split(","):
            found: list[Found] = []
            for each in search(session, name, Protocol(), arguments.last):
                found.append(each)
                if sum(one.share <= 1.0 for one in found) == ENOUGH:
                    break
            both = [each for each in found if each.share <= 1.0]
            tried = found[-1].seed if len(both) == ENOUGH else arguments.last
            print(f"{name}: {len(found)} of seeds 1 to {tried} conform, {len(both)} at {COARSE:g} Hz too", flush=True)
            best = sorted(both, key=lambda one: one.share) or sorted(found, key=lambda one: one.fine.share)
            for each in best[:ENOUGH]:
                rms, fine, coarse = each.fine.rms_error, each.fine.psd_error, each.coarse.psd_error
                print(
                    f"  seed {each.seed}: RMS {rms:+.1%}, PSD {fine:+.1%}, at {COARSE:g} Hz {coarse:+.1%}", flush=True
                )


if __name__ == "__main__":
    main()
