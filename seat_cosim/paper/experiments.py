"""All experiments, in the order of the report."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from seat_cosim.paper.beyond import beyond_the_paper
from seat_cosim.paper.contents import CONTENTS
from seat_cosim.paper.finding import Finding
from seat_cosim.paper.friction import friction_loops
from seat_cosim.paper.rig_bump import rig_bumps
from seat_cosim.paper.rig_ride import rig_rides
from seat_cosim.paper.runner import ExperimentRunner
from seat_cosim.paper.settings import parameters
from seat_cosim.paper.simulation import simulated_bump
from seat_cosim.paper.transmissibility import rig_transmissibility, simulated_transmissibility

EXPERIMENTS: dict[str, Callable[[ExperimentRunner], Iterator[Finding]]] = {
    "parameters": parameters,
    "simulated bump": simulated_bump,
    "simulated transmissibility": simulated_transmissibility,
    "transmissibility on the rig": rig_transmissibility,
    "bumps on the rig": rig_bumps,
    "random rides": rig_rides,
    "friction": friction_loops,
    "beyond the paper": beyond_the_paper,
}
"""Name of an experiment to the function that makes its findings."""


KEYS: dict[str, tuple[str, ...]] = {
    "parameters": ("table1",),
    "simulated bump": ("fig05", "fig06", "fig07"),
    "simulated transmissibility": ("fig08",),
    "transmissibility on the rig": ("fig10",),
    "bumps on the rig": ("fig11", "fig12"),
    "random rides": ("fig13", "fig14", "fig15", "fig16", "table2"),
    "friction": ("fig18", "fig19"),
    "beyond the paper": ("beyond",),
}
"""Name of an experiment to the entries that it makes."""

_EXPERIMENT_OF = {key: name for name, keys in KEYS.items() for key in keys}


def finding(runner: ExperimentRunner, key: str) -> Finding:
    """Run experiments until one makes the finding of an entry; others are skipped where that is possible.

    Parameters
    ----------
    runner
        Runs the seat suspension.
    key
        Key of an entry of :data:`seat_cosim.paper.contents.CONTENTS`.

    Raises
    ------
    KeyError
        If there is no such entry.
    CosimError
        If a run fails.
    """
    runner.progress(_EXPERIMENT_OF[key])
    return next(found for found in EXPERIMENTS[_EXPERIMENT_OF[key]](runner) if found.key == key)


def findings(runner: ExperimentRunner) -> list[Finding]:
    """Run all experiments of the paper.

    Parameters
    ----------
    runner
        Runs the seat suspension.

    Returns
    -------
    list of Finding
        One for each entry of :data:`seat_cosim.paper.contents.CONTENTS`, in that order.

    Raises
    ------
    CosimError
        If a run fails.
    """
    found: dict[str, Finding] = {}
    for name, experiment in EXPERIMENTS.items():
        runner.progress(name)
        found |= {finding.key: finding for finding in experiment(runner)}
    return [found[entry.key] for entry in CONTENTS]
