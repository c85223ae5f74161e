"""``python -m seat_cosim``: the same as ``seat-cosim``."""

from seat_cosim.cli.main import main

main()
