"""``python -m seat_cosim`` and ``seat-cosim``: the command line, loaded so that Ctrl-C ends it at once."""

from __future__ import annotations

from seat_cosim.cli.loading import leaving_at_once


def main() -> None:
    """Load the command line, run it and exit; see :func:`seat_cosim.cli.main.main`."""
    with leaving_at_once():
        from seat_cosim.cli.main import main as run
    run()


if __name__ == "__main__":
    main()
