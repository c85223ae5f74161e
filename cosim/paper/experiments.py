"""All experiments, in the order of the report."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from cosim.paper.beyond import beyond_the_paper
from cosim.paper.bumps import rig_bumps
from cosim.paper.contents import CONTENTS
from cosim.paper.finding import Finding
from cosim.paper.friction import friction_loops
from cosim.paper.lab import Lab
from cosim.paper.ride import rig_rides
from cosim.paper.settings import parameters
from cosim.paper.simulation import simulated_bump
from cosim.paper.transmissibility import rig_transmissibility, simulated_transmissibility

EXPERIMENTS: dict[str, Callable[[Lab], Iterator[Finding]]] = {
    "parameters": parameters,
    "simulated bump": simulated_bump,
    "simulated transmissibility": simulated_transmissibility,
    "transmissibility on the rig": rig_transmissibility,
    "bumps on the rig": rig_bumps,
    "random rides": rig_rides,
    "friction": friction_loops,
    "beyond the paper": beyond_the_paper,
}
"""What is run, by name."""


def findings(lab: Lab) -> list[Finding]:
    """Make them all: one for each entry of :data:`cosim.paper.contents.CONTENTS`, in that order."""
    found: dict[str, Finding] = {}
    for name, experiment in EXPERIMENTS.items():
        lab.progress(name)
        found |= {finding.key: finding for finding in experiment(lab)}
    return [found[entry.key] for entry in CONTENTS]
