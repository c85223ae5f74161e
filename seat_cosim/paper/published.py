"""Numbers of the paper's experiments, as printed: driver's mass in kg, and seat, to the number."""

BUMP_PEAKS = {55.0: {"passive": 2.02, "controlled": 1.32}, 70.0: {"passive": 2.33, "controlled": 1.03}}
"""Peak acceleration of the seat on the bump, in m/s2; section 3.4, Fig. 11 and 12."""

RMS = {55.0: {"passive": 1.061, "uncontrolled": 1.067, "controlled": 0.578}, 70.0: {}}
"""RMS acceleration of the seat (Fig. 13 and 14: "seats' acceleration"), unweighted, in m/s2; Table 2, without 70 kg."""

REDUCTIONS = {55.0: 45.5, 70.0: 49.5}
"""Reduction of the RMS from the passive to the controlled seat, in %; Table 2 and abstract."""
