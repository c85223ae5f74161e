"""What an FMU says about itself, read before anything of it is loaded."""

from __future__ import annotations

import io
import math
import zipfile
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import BinaryIO

import fmpy
from fmpy.model_description import ModelDescription as FmpyDescription
from fmpy.model_description import ModelVariable

from cosim.errors import SetupError, did_you_mean
from cosim.fmi.archive import is_file, leaves, open_archive
from cosim.fmi.repairs import DESCRIPTION, repaired
from cosim.units import Unit

Value = float | bool | str
"""A parameter's value as a user gives it: enumerations by item name or number."""


KINDS = {
    **dict.fromkeys(("Real", "Float32", "Float64"), "Real"),
    **dict.fromkeys(("Integer", *(f"{sign}Int{bits}" for sign in ("", "U") for bits in (8, 16, 32, 64))), "Integer"),
    **{kind: kind for kind in ("Enumeration", "Boolean", "String", "Binary", "Clock")},
}
"""Type of a variable, in FMI 2 or 3, to the kind of its values."""

NUMERIC = ("Real", "Integer", "Enumeration", "Boolean")
"""Kinds of values that fit into a table of numbers."""


@dataclass(frozen=True)
class ModelDescription:
    """An FMU for co-simulation as its description tells.

    Attributes
    ----------
    path
        The ``.fmu`` file, or the archive that holds it.
    description
        fmpy's reading of its ``modelDescription.xml``.
    variables
        By name, in the description's order.
    member
        Its name in the archive; None for a file of its own.
    """

    path: Path
    description: FmpyDescription
    variables: dict[str, ModelVariable]
    member: str | None = None

    @classmethod
    def read(cls, path: str | Path, member: str | None = None) -> ModelDescription:
        """Read an FMU's description.

        Parameters
        ----------
        path
            The ``.fmu`` file, or an archive (an ``.ssp`` file) that holds it.
        member
            Its name in the archive.

        Raises
        ------
        SetupError
            If there is no such file, it is no FMU, or not one of FMI 2.0 or 3.0 for co-simulation.
        """
        file, path = Path(path), _inside(Path(path), member)
        if not is_file(file):
            raise SetupError(f"{path}: expected an FMU, got no such file")
        try:
            opened = _opened(file, member)
            open_archive(opened, path).close()
            description = fmpy.read_model_description(repaired(opened, str(path / DESCRIPTION)), validate=False)
            platforms = fmpy.supported_platforms(opened)
            model = cls(file, description, {variable.name: variable for variable in description.modelVariables}, member)
            model._check_numbers()
        except SetupError:
            raise
        except zipfile.BadZipFile:
            raise SetupError(f"{path}: expected an FMU (a zip archive), got another kind of file") from None
        except KeyError as error:
            missing = "an FMU" if member and member in str(error) else "a modelDescription.xml"
            raise SetupError(f"{path}: expected {missing} in the archive, got none") from None
        except Exception as error:  # whatever fmpy stumbles over in a foreign file
            raise SetupError(f"{path}: expected a readable modelDescription.xml, got: {error}") from error
        if description.fmiMajorVersion not in (2, 3) or description.coSimulation is None:
            kind = "co-simulation" if description.coSimulation is not None else "no co-simulation"
            raise SetupError(
                f"{path}: expected FMI 2.0 or 3.0 for co-simulation, got FMI {description.fmiVersion}, {kind}"
            )
        if leaves(identifier := str(description.coSimulation.modelIdentifier)) or "/" in identifier:
            raise SetupError(f"{path}: expected a modelIdentifier that names a file, got {identifier!r}")
        if fmpy.platform not in platforms:
            raise SetupError(f"{path}: expected a binary for {fmpy.platform}, got {', '.join(platforms) or 'none'}")
        return model

    def _check_numbers(self) -> None:
        """Convert each number of the description that is asked for later: one that is none is an error now.

        Raises
        ------
        ValueError
            With the variable, if it is one of a variable.
        """
        assert self.defined_units is not None
        experiment = self.description.defaultExperiment
        float(experiment.stepSize if experiment is not None and experiment.stepSize else 0.0)
        for variable in self.variables.values():
            try:
                _check_variable(self, variable)
            except (AttributeError, KeyError, TypeError, ValueError) as error:
                raise ValueError(f"{variable.name}: {error}") from None

    @property
    def where(self) -> Path:
        """The FMU as messages call it."""
        return _inside(self.path, self.member)

    def content(self) -> bytes:
        """Read the whole FMU."""
        opened = self.open()
        return Path(opened).read_bytes() if isinstance(opened, str) else opened.read()

    def open(self) -> str | BinaryIO:
        """Return what fmpy and zipfile open: the file's name, or the archive's member."""
        return _opened(self.path, self.member)

    def extract(self, folder: Path) -> None:
        """Extract the FMU into a folder.

        Parameters
        ----------
        folder
            It exists.

        Raises
        ------
        SetupError
            If the archive is damaged or holds what it should not; then nothing is extracted.
        """
        try:
            with open_archive(self.open(), self.where) as archive:
                archive.extractall(folder)
        except SetupError:
            raise
        except Exception as error:  # zip errors, unknown compression, a full disk
            raise SetupError(f"{self.where}: expected an archive that can be extracted, got: {error}") from error

    @property
    def outputs(self) -> list[ModelVariable]:
        """Outputs that are numbers or Booleans, in order."""
        return [v for v in self.variables.values() if v.causality == "output" and KINDS[v.type] in NUMERIC]

    def variable(self, component: str, name: str) -> ModelVariable:
        """Look up a variable.

        Raises
        ------
        SetupError
            If there is none of that name, with the nearest names.
        """
        if name not in self.variables:
            raise SetupError(
                f"{component}.{name}: expected a variable of {self.where.name}, got none"
                + did_you_mean(name, self.variables)
            )
        return self.variables[name]

    def is_discrete(self, name: str) -> bool:
        """Whether a variable changes at instants only."""
        return bool(self.variables[name].variability != "continuous")

    def unit(self, variable: ModelVariable) -> str | None:
        """Return the name of a variable's unit, its type's unit where it has none of its own."""
        return variable.unit or (variable.declaredType.unit if variable.declaredType else None)

    @property
    def defined_units(self) -> list[Unit]:
        """All units that the FMU defines."""
        definitions = [(unit, unit.baseUnit) for unit in self.description.unitDefinitions if unit.baseUnit is not None]
        return [
            Unit(unit.name, (b.kg, b.m, b.s, b.A, b.K, b.mol, b.cd, b.rad), b.factor, b.offset)
            for unit, b in definitions
        ]

    def defined_unit(self, variable: ModelVariable) -> Unit | None:
        """Return a variable's unit by its definition, or None where there is none."""
        return next((unit for unit in self.defined_units if unit.name == self.unit(variable)), None)

    def bound(self, variable: ModelVariable, which: str) -> float | None:
        """Return a variable's ``min`` or ``max``, its type's where it has none of its own."""
        text = getattr(variable, which) or (getattr(variable.declaredType, which) if variable.declaredType else None)
        return None if text is None else float(text)

    @cached_property
    def bounds(self) -> dict[str, tuple[float | None, float | None]]:
        """``min`` and ``max`` of all variables by name."""
        return {name: (self.bound(v, "min"), self.bound(v, "max")) for name, v in self.variables.items()}

    def value(self, component: str, name: str, given: Value) -> float | str:
        """Check a value for a variable and convert it to what the FMU takes.

        Parameters
        ----------
        component, name
            Whose variable; for the message.
        given
            Number, Boolean, or text as from a command line; an enumeration's item by name or number.

        Returns
        -------
        float or str
            Booleans as 0.0 or 1.0, enumerations as their number.

        Raises
        ------
        SetupError
            If there is no such variable, it may not be set, or the value does not fit it.
        """
        variable = self.variable(component, name)
        where = f"{component}.{name}"
        settable = variable.causality in ("parameter", "input") or (
            variable.causality == "local"
            and variable.initial in ("exact", "approx")
            and variable.variability != "constant"
        )
        if not settable:
            raise SetupError(f"{where}: expected a parameter or an input, got a {variable.causality}")
        if variable.type == "String":
            return str(given)
        number = _number(variable, where, given)
        low, high = self.bounds[name]
        if not math.isfinite(number):
            raise SetupError(f"{where}: expected a finite number, got {given}")
        if (low is not None and number < low) or (high is not None and number > high):
            unit = f" {self.unit(variable)}" if self.unit(variable) else ""
            bounds = f"[{'-inf' if low is None else f'{low:g}'}, {'inf' if high is None else f'{high:g}'}]"
            raise SetupError(f"{where}: expected a value in {bounds}{unit}, got {given}")
        return number


def _inside(path: Path, member: str | None) -> Path:
    return path if member is None else path / member


def _opened(path: Path, member: str | None) -> str | BinaryIO:
    if member is None:
        return str(path)
    with open_archive(path, path) as archive:
        return io.BytesIO(archive.read(member))


def _check_variable(model: ModelDescription, variable: ModelVariable) -> None:
    """Convert what a variable's attributes say; raises whatever that raises."""
    kind = KINDS[variable.type]
    if kind in NUMERIC:
        low, high = (model.bound(variable, which) for which in ("min", "max"))
        if not all(bound is None or not math.isnan(bound) for bound in (low, high)):
            raise ValueError(f"expected bounds that are numbers, got {low} and {high}")
    if kind == "Enumeration":
        items = [(item.name, int(item.value)) for item in variable.declaredType.items]
        if not items or not all(name for name, _ in items):
            raise ValueError("expected an enumeration of named items")
    if not 0 <= int(variable.valueReference) < 2**32:
        raise ValueError(f"expected a value reference below 2^32, got {variable.valueReference}")


def _number(variable: ModelVariable, where: str, given: Value) -> float:
    """Convert a value to a number as the variable's type asks."""
    if type(given) in (float, int) and KINDS[variable.type] == "Real":
        try:
            return float(given)
        except OverflowError:
            return math.inf  # or the other, which is not finite either
    text = str(given).strip()
    if variable.type == "Boolean":
        truths = {"true": 1.0, "1": 1.0, "1.0": 1.0, "false": 0.0, "0": 0.0, "0.0": 0.0}
        if text.lower() not in truths:
            raise SetupError(f"{where}: expected true or false, got {given}")
        return truths[text.lower()]
    items = {i.name: float(i.value) for i in variable.declaredType.items} if variable.type == "Enumeration" else {}
    if text in items:
        return items[text]
    expected = f"one of {', '.join(items)}" if items else "a number"
    try:
        number = float(text)
    except ValueError:
        raise SetupError(f"{where}: expected {expected}, got {given}") from None
    if (items and number not in items.values()) or (KINDS[variable.type] == "Integer" and not number.is_integer()):
        raise SetupError(f"{where}: expected {expected if items else 'a whole number'}, got {given}")
    return number
