"""The command line: its commands, and the exit code and message of each error."""

from __future__ import annotations

import logging
import sys
import traceback
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext

import click

from cosim.errors import CosimError, SetupError
from cosim.fmi.interrupts import Ended, deferring_signals
from seat_cosim.cli import streams
from seat_cosim.cli.lazy_group import LazyGroup

_CLI = "seat_cosim.cli"

COMMANDS = {
    "assess": (f"{_CLI}.assess", "assess"),
    "build": (f"{_CLI}.build", "build"),
    "compare": (f"{_CLI}.compare", "compare"),
    "design": (f"{_CLI}.design", "design"),
    "doctor": (f"{_CLI}.doctor", "doctor"),
    "evaluate": (f"{_CLI}.evaluate", "evaluate"),
    "export": (f"{_CLI}.export", "export"),
    "fmus": (f"{_CLI}.export", "fmus"),
    "info": (f"{_CLI}.info", "info"),
    "reproduce": (f"{_CLI}.reproduce", "reproduce"),
    "rerun": (f"{_CLI}.rerun", "rerun"),
    "run": (f"{_CLI}.run", "run"),
    "simulate": (f"{_CLI}.simulate", "simulate"),
    "sweep": (f"{_CLI}.sweep", "sweep"),
    "validate": (f"{_CLI}.validate", "validate_command"),
}
"""Command to its module and function; a module is loaded when its command runs."""


@click.group(
    cls=LazyGroup, modules=COMMANDS, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110}
)
@click.version_option(package_name="seat-cosim")
@click.option(
    "--debug", is_flag=True, help="Show which FMUs are used, and the traceback of an error; goes anywhere on the line."
)
def app(debug: bool) -> None:
    """Active seat suspension as FMI co-simulation components.

    \b
    Examples:
      seat-cosim run bump --driver-mass 70 --observer 1
      seat-cosim simulate SeatSuspension --set shaker.bump.height=0.05
      seat-cosim reproduce
    """


def main() -> None:
    """Run the command line and exit.

    The exit code is 0 after success, 2 for an error found before an FMU was instantiated, 1 for a later one. A signal
    that ends the process ends it when rows are written and folders removed.
    """
    streams.prepare()
    with deferring_signals():
        code = _run()
        code = code if streams.flush() else 1
    sys.exit(code)


def _run() -> int:
    """Run the command line; returns the exit code."""
    arguments = [argument for argument in sys.argv[1:] if argument != "--debug"]
    debug = len(arguments) < len(sys.argv) - 1
    try:
        with _debug_messages() if debug else nullcontext():
            app.main(arguments, standalone_mode=False)
        sys.stdout.flush()
    except BrokenPipeError:
        streams.discard()  # nobody reads: there is nobody to tell
        return 1
    except (CosimError, click.ClickException, click.Abort, KeyboardInterrupt, Ended, OSError) as error:
        code, message = _code_and_message(error)
        if debug:
            traceback.print_exc()
        streams.tell(message)
        return code
    return 0


@contextmanager
def _debug_messages() -> Iterator[None]:
    """Print what this package logs, for example which FMUs were chosen, to standard error."""
    log, handler = logging.getLogger("seat_cosim"), logging.StreamHandler()
    level = log.level
    log.setLevel(logging.DEBUG)
    log.addHandler(handler)
    try:
        yield
    finally:
        log.removeHandler(handler)
        log.setLevel(level)


def _code_and_message(error: BaseException) -> tuple[int, str]:
    """Return the exit code of an error and its message of one line."""
    if isinstance(error, click.exceptions.NoArgsIsHelpError):
        return 2, error.format_message()
    if isinstance(error, click.ClickException):
        code, text = error.exit_code, error.format_message()
    elif isinstance(error, CosimError):
        code, text = 2 if isinstance(error, SetupError) else 1, str(error)
    elif isinstance(error, OSError):
        code, text = 1, f"{error.filename or 'a file'}: expected to read or write it, got: {error.strerror or error}"
    elif isinstance(error, Ended):
        code, text = int(str(error.code)), str(error)
    else:
        code, text = 1, "interrupted"
    return code, f"seat-cosim: error: {' '.join(text.split())}"
