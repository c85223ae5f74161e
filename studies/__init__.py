"""What was tuned and calibrated, and how; run a module with ``python -m studies.NAME`` from the repository."""
