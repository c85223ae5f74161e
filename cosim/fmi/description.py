"""Read and check an FMU's model description without loading its library."""

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
from cosim.fmi.archive import is_file, is_unsafe_path, open_archive
from cosim.fmi.repairs import DESCRIPTION, repaired
from cosim.fmi.variable_types import KINDS, NUMERIC
from cosim.units import Unit

Value = float | bool | str
"""A parameter's value as a user gives it; enumerations by item name or number."""


@dataclass(frozen=True)
class ModelDescription:
    """The model description of an FMU for co-simulation.

    Attributes
    ----------
    path
        The ``.fmu`` file, or the archive that holds it.
    description
        The ``modelDescription.xml`` as fmpy reads it.
    variables
        Name to variable, in the order of the description.
    member
        The FMU's name in the archive ``path``; None where ``path`` is the FMU itself.
    """

    path: Path
    description: FmpyDescription
    variables: dict[str, ModelVariable]
    member: str | None = None

    @classmethod
    def read(cls, path: str | Path, member: str | None = None) -> ModelDescription:
        """Read and check an FMU's model description.

        Parameters
        ----------
        path
            The ``.fmu`` file, or an archive (an ``.ssp`` file) that holds it.
        member
            The FMU's name in the archive, if ``path`` is one.

        Returns
        -------
        ModelDescription
            The description, checked.

        Raises
        ------
        SetupError
            If the file does not exist, is not an FMU, has no readable model description, is not of FMI 2.0 or 3.0 for
            co-simulation, or has no binary for this platform.
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
        except Exception as error:  # fmpy raises exceptions of many types for invalid files
            raise SetupError(f"{path}: expected a readable modelDescription.xml, got: {error}") from error
        if description.fmiMajorVersion not in (2, 3) or description.coSimulation is None:
            kind = "co-simulation" if description.coSimulation is not None else "no co-simulation"
            raise SetupError(
                f"{path}: expected FMI 2.0 or 3.0 for co-simulation, got FMI {description.fmiVersion}, {kind}"
            )
        if is_unsafe_path(identifier := str(description.coSimulation.modelIdentifier)) or "/" in identifier:
            raise SetupError(f"{path}: expected a modelIdentifier that names a file, got {identifier!r}")
        if fmpy.platform not in platforms:
            raise SetupError(f"{path}: expected a binary for {fmpy.platform}, got {', '.join(platforms) or 'none'}")
        return model

    def _check_numbers(self) -> None:
        """Convert all numbers that are used later, so that an invalid one is an error now; names the variable."""
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
        """Name of the FMU in messages: its path, inside the archive where it is a member."""
        return _inside(self.path, self.member)

    def content(self) -> bytes:
        """Read the bytes of the FMU."""
        opened = self.open()
        return Path(opened).read_bytes() if isinstance(opened, str) else opened.read()

    def open(self) -> str | BinaryIO:
        """Return what fmpy and zipfile accept: the file's name, or the archive's member as an open file."""
        return _opened(self.path, self.member)

    def extract(self, folder: Path) -> None:
        """Extract the FMU into a folder.

        Parameters
        ----------
        folder
            An existing folder.

        Raises
        ------
        SetupError
            If the archive is unsafe, which is checked before anything is extracted, or damaged.
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
        """Outputs with numeric or Boolean values, in the order of the description."""
        return [v for v in self.variables.values() if v.causality == "output" and KINDS[v.type] in NUMERIC]

    def variable(self, component: str, name: str) -> ModelVariable:
        """Look up a variable.

        Parameters
        ----------
        component
            Name of the component in messages.
        name
            Name of the variable.

        Returns
        -------
        ModelVariable
            The variable as fmpy reads it.

        Raises
        ------
        SetupError
            If there is no such variable; the message suggests similar names.
        """
        if name not in self.variables:
            raise SetupError(
                f"{component}.{name}: expected a variable of {self.where.name}, got none"
                + did_you_mean(name, self.variables)
            )
        return self.variables[name]

    def is_discrete(self, name: str) -> bool:
        """Return whether the variable of that name changes at discrete instants only."""
        return bool(self.variables[name].variability != "continuous")

    def unit(self, variable: ModelVariable) -> str | None:
        """Return the name of a variable's unit, or of its declared type's unit; None where neither has one.

        Parameters
        ----------
        variable
            A variable of this FMU.
        """
        return variable.unit or (variable.declaredType.unit if variable.declaredType else None)

    @property
    def defined_units(self) -> list[Unit]:
        """All units that the FMU defines in base units."""
        units = [unit for unit in self.description.unitDefinitions if unit.baseUnit is not None]
        return [Unit.from_base_unit(unit.name, unit.baseUnit) for unit in units]

    def defined_unit(self, variable: ModelVariable) -> Unit | None:
        """Return the definition of a variable's unit; None where it has no unit or the unit has no definition.

        Parameters
        ----------
        variable
            A variable of this FMU.
        """
        return next((unit for unit in self.defined_units if unit.name == self.unit(variable)), None)

    def bound(self, variable: ModelVariable, which: str) -> float | None:
        """Return a bound of a variable, or of its declared type.

        Parameters
        ----------
        variable
            The variable.
        which
            ``"min"`` or ``"max"``.

        Returns
        -------
        float or None
            In the variable's unit; None where neither has the bound.

        Raises
        ------
        ValueError
            If the bound is not a number.
        """
        text = getattr(variable, which) or (getattr(variable.declaredType, which) if variable.declaredType else None)
        return None if text is None else float(text)

    @cached_property
    def bounds(self) -> dict[str, tuple[float | None, float | None]]:
        """Name of each variable to its ``min`` and ``max``."""
        return {name: (self.bound(v, "min"), self.bound(v, "max")) for name, v in self.variables.items()}

    def value(self, component: str, name: str, given: Value) -> float | str:
        """Check a value for a variable and convert it to a number or a text.

        Parameters
        ----------
        component
            Name of the component in messages.
        name
            Name of the variable.
        given
            A number, a Boolean, or a text as from a command line; an enumeration's item by name or number.

        Returns
        -------
        float or str
            Booleans as 0.0 or 1.0, enumerations as their item's number.

        Raises
        ------
        SetupError
            If there is no such variable, it must not be set, or the value is of a wrong type or out of range.
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
    """Convert a variable's attributes; raises an exception if one is invalid."""
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
    """Convert a value to a number of the variable's type."""
    if type(given) in (float, int) and KINDS[variable.type] == "Real":
        try:
            return float(given)
        except OverflowError:
            return math.inf  # the sign does not matter: the caller rejects both infinities
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
