"""What was measured; run a module with ``python -m benchmarks.NAME`` from the repository."""
