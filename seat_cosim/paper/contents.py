"""Figures and tables that are reproduced, and what goes beyond the paper: number, title, and the paper's claim."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Entry:
    """A figure or table of the report.

    Attributes
    ----------
    key
        Name of its files, without suffix.
    number
        Number as printed in the paper.
    title
        Short title; not the paper's.
    claim
        What the paper claims about it.
    in_paper
        Whether the paper has it.
    """

    key: str
    number: str
    title: str
    claim: str
    in_paper: bool = True


CONTENTS = [
    Entry(
        "table1",
        "Table 1",
        "Parameters of the simulation",
        "The plant, the limits and the design's numbers.",
    ),
    Entry(
        "fig05",
        "Fig. 5",
        "Bump: acceleration of the driver",
        "Uncontrolled, a big peak of about 4 m/s²; both observers lower it, and with Observer 2 it fades sooner.",
    ),
    Entry(
        "fig06",
        "Fig. 6",
        "Bump: disturbance and its estimates",
        "Observer 2 follows the disturbance better, but has the bigger peak because the actuator saturates.",
    ),
    Entry(
        "fig07",
        "Fig. 7",
        "Bump: saturated control force",
        "The force stops at the limit of 250 N.",
    ),
    Entry(
        "fig08",
        "Fig. 8",
        "Simulated transmissibility",
        "With Observer 1 the transmissibility of the acceleration stays around 0.4 at low frequency.",
    ),
    Entry(
        "fig10",
        "Fig. 10",
        "Transmissibility on the rig, 55 kg",
        "The controlled seat isolates at low frequency, as far as 4.5 Hz. The uncontrolled seat holds the resonance "
        "down better than the passive one, which is a little better from 2.5 to 4.5 Hz.",
    ),
    Entry(
        "fig11",
        "Fig. 11",
        "Bump on the rig, 55 kg",
        "The peak falls from 2.02 m/s² (passive) to 1.32 m/s² (controlled).",
    ),
    Entry(
        "fig12",
        "Fig. 12",
        "Bump on the rig, 70 kg",
        "The peak falls from 2.33 m/s² (passive) to 1.03 m/s² (controlled).",
    ),
    Entry(
        "fig13",
        "Fig. 13",
        "Random ride on the rig, 55 kg",
        "The uncontrolled seat peaks at about 6 m/s², as friction cannot hold its resonance; the passive seat can, but "
        "shakes more elsewhere; the controlled seat stays low throughout. (The caption says 50 kg, text and Table 2 "
        "say 55.)",
    ),
    Entry(
        "fig14",
        "Fig. 14",
        "Random ride on the rig, 70 kg",
        "As Fig. 13, with the heavier driver.",
    ),
    Entry(
        "fig15",
        "Fig. 15",
        "Spectra of the random ride, 55 kg",
        "The passive and the uncontrolled seat have a big peak around 2 Hz and little above; the controlled seat is "
        "low at all frequencies.",
    ),
    Entry(
        "fig16",
        "Fig. 16",
        "Spectra of the random ride, 70 kg",
        "As Fig. 15, with the heavier driver.",
    ),
    Entry(
        "table2",
        "Table 2",
        "RMS acceleration in the random ride",
        "Control lowers the RMS acceleration, against the passive seat, by 45.5 % (55 kg) and 49.5 % (70 kg).",
    ),
    Entry(
        "fig18",
        "Fig. 18",
        "Friction loops, 5 and 10 mm at 0.5 Hz",
        "In the testing machine, friction follows the direction of motion and saturates around 80 N.",
    ),
    Entry(
        "fig19",
        "Fig. 19",
        "The friction model at a reversal",
        "The model (35)-(36) with the identified parameters describes the measured friction.",
    ),
    Entry(
        "beyond",
        "Beyond the paper",
        "Bump with controllers that the paper does not have",
        "Its observer takes saturation for a part of the disturbance; it leaves a better anti-windup, and drivers "
        "whose mass is not known well, to further work.",
        in_paper=False,
    ),
]
"""Entries in the order of the report."""

ON_RIG = ("fig10", "fig11", "fig12", "fig13", "fig14", "fig15", "fig16", "table2")
"""Keys of the experiments with the prototype."""
