"""Studies: tuning, calibration and comparisons; run a module with ``python -m studies.NAME`` from the repository."""
