"""Sets of gains with the inputs of their design: reading, checks, writing, conversion to parameters."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields, replace
from math import isfinite
from pathlib import Path
from typing import Any

from seat_controller_fmu.design.setting import GainsError, Pair, Setting
from seat_controller_fmu.interface import Parameters

Matrix = tuple[Pair, Pair]

PRESETS = ("published", "table1-printed", "recommended", "equal-rate")
"""Names of the sets in this package."""

FOLDER = Path(__file__).with_name("presets")
"""Folder of their files."""


@dataclass(frozen=True)
class Gains:
    """State feedback and observer gains with the inputs and results of their design.

    Attributes
    ----------
    K1, K2
        [deflection, rate] at M_min and M_max, in N/m and N.s/m.
    setting
        Setting of the design.
    lambda_
        H-infinity level of (28) of the design.
    Q
        Matrix Q of (30), None if unknown.
    objective
        Name and numbers of the objective; ``{"name": "given"}`` if the gains were not designed here.
    figures
        Results of the certificate, see :mod:`seat_controller_fmu.design.certificate`.
    """

    K1: Pair
    K2: Pair
    setting: Setting
    lambda_: float
    Q: Matrix | None = None
    objective: Mapping[str, Any] = field(default_factory=lambda: {"name": "given"})
    figures: Mapping[str, Any] = field(default_factory=dict)

    @property
    def feedback(self) -> tuple[Pair, Pair]:
        """Gains K_1 and K_2 of the state feedback."""
        return self.K1, self.K2

    def parameters(self) -> dict[str, float]:
        """Return the parameters of the controller FMU with these gains, by variable name."""
        s = self.setting
        values = {
            "driver_mass_min": s.driver_mass_min,
            "driver_mass_max": s.driver_mass_max,
            "L1": s.L1,
            "L2": s.L2,
            "K1.deflection": self.K1[0],
            "K1.rate": self.K1[1],
            "K2.deflection": self.K2[0],
            "K2.rate": self.K2[1],
        }
        return values

    def controller(self, driver_mass: float) -> Parameters:
        """Return the parameters of the controller with these gains.

        Parameters
        ----------
        driver_mass
            In kg.

        Returns
        -------
        seat_controller_fmu.interface.Parameters
            With default values of the other parameters.
        """
        values = {name.replace(".", "_"): value for name, value in self.parameters().items()}
        return replace(Parameters(), driver_mass=driver_mass, **values)  # type: ignore[arg-type]

    def to_json(self) -> str:
        """Return the set as JSON; numbers are read back to the same bits."""
        s = asdict(self.setting)
        content = {
            "K1": self.K1,
            "K2": self.K2,
            "L1": s.pop("L1"),
            "L2": s.pop("L2"),
            "Q": self.Q,
            "lambda": self.lambda_,
            **s,
            "objective": dict(self.objective),
            **self.figures,
        }
        return json.dumps(content, indent=2) + "\n"

    @classmethod
    def from_json(cls, text: str, where: str) -> Gains:
        """Read a set from JSON.

        Parameters
        ----------
        text
            JSON text from :meth:`to_json`.
        where
            Name of the file, for messages.

        Returns
        -------
        Gains
            The set.

        Raises
        ------
        GainsError
            If an entry is missing, is no number, or is out of its range.
        """
        try:
            content = json.loads(text)
        except (ValueError, RecursionError) as error:
            raise GainsError(f"{where}: expected JSON, got: {error}") from error
        if not isinstance(content, dict):
            raise GainsError(f"{where}: expected a JSON object, got a {type(content).__name__}")
        content = dict(content)
        required = ["K1", "K2", "lambda", *(f.name for f in fields(Setting) if f.name != "observer_gamma")]
        missing = [name for name in required if name not in content]
        if missing:
            raise GainsError(f"{where}: expected {', '.join(missing)}, got none")
        try:
            gamma = content.pop("observer_gamma", None)
            setting = Setting(
                **{f.name: float(content.pop(f.name)) for f in fields(Setting) if f.name != "observer_gamma"},
                observer_gamma=None if gamma is None else float(gamma),
            )
            Q = content.pop("Q", None)
            return cls(
                K1=_pair(content.pop("K1")),
                K2=_pair(content.pop("K2")),
                setting=setting,
                lambda_=float(content.pop("lambda")),
                Q=None if Q is None else (_pair(Q[0]), _pair(Q[1])),
                objective=dict(content.pop("objective", {"name": "given"})),
                figures=content,
            )
        except GainsError as error:
            raise GainsError(f"{where}: {error}") from error
        except (TypeError, ValueError, LookupError, OverflowError) as error:
            raise GainsError(f"{where}: expected numbers, got: {error}") from error

    def to_ssv(self) -> str:
        """Return the gains as an SSP 1.0 parameter set (SSV) for the SeatController FMU."""
        lines = [
            f'    <ssv:Parameter name="{name}"><ssv:Real value="{value!r}"/></ssv:Parameter>'
            for name, value in self.parameters().items()
        ]
        return "\n".join(
            [
                '<?xml version="1.0" encoding="UTF-8"?>',
                '<ssv:ParameterSet xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues" '
                'version="1.0" name="gains">',
                "  <ssv:Parameters>",
                *lines,
                "  </ssv:Parameters>",
                "</ssv:ParameterSet>",
                "",
            ]
        )


def _pair(values: Any) -> Pair:
    first, second = map(float, values)
    if not (isfinite(first) and isfinite(second)):
        raise GainsError(f"expected two finite numbers, got {first} and {second}")
    return first, second


def preset(name: str) -> Gains:
    """Read a set in this package.

    Parameters
    ----------
    name
        One of :data:`PRESETS`.

    Returns
    -------
    Gains
        The set.

    Examples
    --------
    >>> preset("published").K1
    (4573.0, -90.0)
    """
    return Gains.from_json((FOLDER / f"{name}.json").read_text(encoding="utf-8"), name)


def load(name_or_file: str) -> Gains:
    """Read a preset or a file.

    Parameters
    ----------
    name_or_file
        One of :data:`PRESETS`, or the path of a JSON file.

    Returns
    -------
    Gains
        The set.

    Raises
    ------
    GainsError
        If it is neither, or cannot be read.
    """
    if name_or_file in PRESETS:
        return preset(name_or_file)
    path = Path(name_or_file)
    try:
        text = path.read_text(encoding="utf-8", errors="replace")
    except (OSError, ValueError):  # ValueError: the name cannot be a path
        raise GainsError(f"gains: expected one of {', '.join(PRESETS)} or a file, got {name_or_file}") from None
    return Gains.from_json(text, str(path))
