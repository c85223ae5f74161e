"""Certificate of the mode robust for the nominal seat: parameters and files of ``seat-cosim design --mode robust``."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from cosim.errors import SetupError, writing_to
from fmus.component import ParameterError
from fmus.variables import VariableDeclaration, variables_of
from seat_controller_fmu.design.robust_loop import LoopCertificate, certify
from seat_controller_fmu.interface import Mode, Parameters
from seat_cosim.nominal_seat import nominal_seat, seated_body

MASSES = (45.0, 55.0, 70.0, 80.0, 100.0, 120.0)
"""Drivers' masses of the certificate, in kg."""


def _value(variable: VariableDeclaration, text: str) -> Any:
    """Convert the text of a value; refuse one that the variable does not accept."""
    if text in variable.items:
        return variable.type(variable.items[text])
    try:
        value = {"true": 1.0, "false": 0.0}[text.lower()] if text.lower() in ("true", "false") else float(text)
    except ValueError:
        expected = f"one of {', '.join(variable.items)}" if variable.items else "a number"
        raise SetupError(f"design: {variable.name}: expected {expected}, got {text}") from None
    if problem := variable.problem(value):
        raise SetupError(f"design: {problem}")
    return variable.type(value)


def robust_parameters(settings: Iterable[str]) -> Parameters:
    """Return parameters of the controller in mode robust.

    Parameters
    ----------
    settings
        ``variable=value`` each, with the FMI names of the controller's parameters.

    Raises
    ------
    SetupError
        If there is no such parameter, or it does not accept the value.
    """
    known = {variable.name: variable for variable in variables_of(Parameters)}
    found: dict[str, Any] = {"mode": Mode.robust}
    for setting in settings:
        name, equals, text = setting.partition("=")
        if not equals or name not in known:
            raise SetupError(f"design: expected PARAMETER=VALUE with a parameter of the controller, got {setting}")
        found[known[name].field] = _value(known[name], text)
    return Parameters(**found)


def certify_robust(settings: Iterable[str]) -> tuple[Parameters, LoopCertificate]:
    """Certify the sampled loop of the mode robust for the nominal seat.

    Parameters
    ----------
    settings
        As of :func:`robust_parameters`.

    Returns
    -------
    parameters : Parameters
        Of the controller; its driver is replaced by each of :data:`MASSES`.
    certificate : LoopCertificate
        Delay margins and worst-case gains.

    Raises
    ------
    SetupError
        If a setting is wrong, or parameters contradict one another.
    """
    parameters = robust_parameters(settings)
    try:
        return parameters, certify(parameters, nominal_seat, MASSES, seated_body)
    except ParameterError as error:
        raise SetupError(str(error)) from error


def write_certificate(parameters: Parameters, certificate: LoopCertificate, folder: Path) -> str:
    """Write the certificate to ``certificate.json``.

    Parameters
    ----------
    parameters
        Of the controller.
    certificate
        What holds for them.
    folder
        Folder of the file; it is made if it does not exist.

    Returns
    -------
    str
        Name of the file.
    """
    content = {"parameters": dataclasses.asdict(parameters), **certificate._asdict()}
    with writing_to(folder):
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "certificate.json").write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")
    return "certificate.json"
