"""Numbers of the paper's experiments, as printed; keys are the driver's mass in kg, then the seat."""

BUMP_PEAKS = {55.0: {"passive": 2.02, "controlled": 1.32}, 70.0: {"passive": 2.33, "controlled": 1.03}}
"""m/s2, of the seat; section 3.4, Fig. 11 and 12."""

RMS = {55.0: {"passive": 1.061, "uncontrolled": 1.067, "controlled": 0.578}, 70.0: {}}
"""m/s2, of the seat (Fig. 13 and 14 show "seats' acceleration"), not weighted; Table 2, which has no row for 70 kg."""

REDUCTIONS = {55.0: 45.5, 70.0: 49.5}
"""%, of the RMS from passive to controlled; Table 2 and abstract."""
