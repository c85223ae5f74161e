"""``python -m cosim``: says where the command line is, which is not part of this package."""

import sys

sys.exit(
    "cosim: expected the command line of the application, got the master; run: seat-cosim, or python -m seat_cosim"
)
