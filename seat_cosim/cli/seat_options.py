"""What commands about the seat suspension have in common: which FMUs, which driver, which gains and observer."""

from __future__ import annotations

from pathlib import Path

import click

from cosim.errors import SetupError
from cosim.fmi.values import Value
from fmus import FLAVOURS
from seat_cosim.scenarios import observer

fmus_option = click.option(
    "--fmus",
    "fmus_folder",
    type=click.Path(path_type=Path),
    default=Path("fmus"),
    show_default=True,
    help="Folder of the built FMUs; each flavour has its subfolder.",
)
flavour_option = click.option(
    "--flavour", type=click.Choice(FLAVOURS), default=FLAVOURS[0], show_default=True, help="Which FMUs to use."
)
mass_option = click.option(
    "--driver-mass", type=float, metavar="KG", help="The driver's mass, for seat and controller alike [default: 55]."
)
gains_option = click.option(
    "--gains", metavar="NAME|FILE", help="A preset (published, table1-printed, recommended) or a gains.json."
)
observer_option = click.option(
    "--observer", "number", type=click.Choice(["1", "2"]), help="The paper's Observer 1 or 2 [default: 1]."
)
control_option = click.option(
    "--control",
    "switch",
    type=click.Choice(["on", "off", "passive"]),
    help="Controller on or off; passive: off, in the well-tuned passive seat [default: on].",
)


def observer_of(number: int) -> dict[str, Value]:
    """Read the word of ``--observer``."""
    from seat_controller_fmu.parameters import OBSERVERS

    return observer(OBSERVERS[number].value)


def gains_of(name_or_file: str) -> dict[str, Value]:
    """Read the word of ``--gains``."""
    from seat_controller_fmu.design.gains import load
    from seat_controller_fmu.design.setting import GainsError

    try:
        return {f"controller.{name}": value for name, value in load(name_or_file).parameters().items()}
    except GainsError as error:
        raise SetupError(str(error)) from error
