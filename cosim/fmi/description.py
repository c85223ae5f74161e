"""Read and check an FMU's model description without loading its library."""

from __future__ import annotations

import io
import math
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import BinaryIO

import fmpy
from fmpy.model_description import ModelDescription as FmpyDescription
from fmpy.model_description import ModelVariable

from cosim.errors import SetupError, did_you_mean, with_article
from cosim.fmi.archive import is_file, is_unsafe_path, open_archive
from cosim.fmi.budgets import DocumentBudget
from cosim.fmi.elements import Elements, array_name, find_elements, owner, shape_of, sizes_problems
from cosim.fmi.repairs import DESCRIPTION, repaired
from cosim.fmi.unsupported import unsupported
from cosim.fmi.values import Checked, Scalar, Value, array_of, number, starts
from cosim.fmi.variable_types import KINDS, NUMERIC
from cosim.units import Unit


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
        Its name in the archive; None for a file of its own.
    sampled
        Whether its discrete outputs are values at the begin of a step, see :meth:`is_sampled`.
    relative
        Name of each variable that says whether it is a difference to what it says, see :meth:`is_relative`.
    """

    path: Path
    description: FmpyDescription
    variables: dict[str, ModelVariable]
    member: str | None = None
    sampled: bool = False
    relative: Mapping[str, bool] = field(default_factory=dict)

    @classmethod
    def read(
        cls, path: str | Path, member: str | None = None, budget: DocumentBudget | None = None
    ) -> ModelDescription:
        """Read and check an FMU's model description.

        Parameters
        ----------
        path
            The ``.fmu`` file, or an archive (an ``.ssp`` file) that holds it.
        member
            The FMU's name in the archive, if ``path`` is one.
        budget
            For all documents of a system; where None, one for the file.

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
            with open_archive(opened, path, _size_on_disk(file, member)) as checked:
                size = checked.getinfo(DESCRIPTION).file_size
            (budget or DocumentBudget(file.stat().st_size)).spend(str(path / DESCRIPTION), size)
            archive, sampled, relative = repaired(opened, str(path / DESCRIPTION))
            description = fmpy.read_model_description(archive, validate=False)
            platforms = fmpy.supported_platforms(opened)
            variables = {variable.name: variable for variable in description.modelVariables}
            _mark_aliases(description)
            model = cls(file, description, variables, member, sampled, relative)
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
        if problems := unsupported(description):
            raise SetupError(*(f"{path}: {problem}" for problem in problems))
        if fmpy.platform not in platforms:
            raise SetupError(f"{path}: expected a binary for {fmpy.platform}, got {', '.join(platforms) or 'none'}")
        return model

    def _check_numbers(self) -> None:
        """Convert all numbers that are used later, so that an invalid one is an error now; names the variable."""
        assert self.defined_units is not None
        for attribute in ("startTime", "stopTime", "stepSize", "tolerance"):
            self._experiment(attribute)
        if problems := sizes_problems(self.variables.values(), self.sizes()):
            raise ValueError("; ".join(problems))
        assert self.structural is not None
        for variable in self.variables.values():
            try:
                _check_variable(self, variable)
            except (AttributeError, KeyError, TypeError, ValueError) as error:
                raise ValueError(f"{variable.name}: {error}") from None

    def _experiment(self, attribute: str) -> float | None:
        experiment = self.description.defaultExperiment
        text = getattr(experiment, attribute) if experiment is not None else None
        return float(text) if text not in (None, "") else None

    @property
    def default_start_time(self) -> float | None:
        """Start time of the default experiment, in s."""
        return self._experiment("startTime")

    @property
    def default_stop_time(self) -> float | None:
        """Stop time of the default experiment, in s."""
        return self._experiment("stopTime")

    @property
    def default_step_size(self) -> float | None:
        """Step size of the default experiment, in s; None where it is 0."""
        return self._experiment("stepSize") or None

    @property
    def default_tolerance(self) -> float | None:
        """Tolerance of the default experiment."""
        return self._experiment("tolerance")

    @property
    def fixed_step_size(self) -> float | None:
        """Step size in s of an FMU that cannot handle other step sizes; None where it can, or has none."""
        interface = self.description.coSimulation
        if interface.canHandleVariableCommunicationStepSize:
            return None
        internal = interface.fixedInternalStepSize
        return self.default_step_size or (float(internal) if internal else None)

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
            with open_archive(self.open(), self.where, _size_on_disk(self.path, self.member)) as archive:
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

    def variable_of(self, component: str, name: str) -> ModelVariable:
        """Look up a variable by its name, or an array by the name of an element, whatever the sizes are.

        Parameters
        ----------
        component
            Name of the component in messages.
        name
            Of a variable or an element.

        Returns
        -------
        ModelVariable
            The variable; for an alias, that of the alias.

        Raises
        ------
        SetupError
            If there is no such variable; the message suggests similar names.
        """
        array = self.variables.get(array_name(name))
        if name not in self.variables and array is not None and array.dimensions:
            return array
        return self.variable(component, name)

    def has(self, name: str) -> bool:
        """Whether a name is that of a variable, or of an element of an array of any size."""
        return name in self.variables or array_name(name) in self.variables

    def is_sampled(self, name: str) -> bool:
        """Whether an output is computed from the inputs at the begin of a step and held.

        By FMI, a value that is read after doStep(t, h) is the value at t + h. An FMU whose description has the
        annotation :data:`cosim.fmi.repairs.SAMPLED` says that its discrete outputs are values at t.

        Parameters
        ----------
        name
            Name of an output.

        Returns
        -------
        bool
            Whether its values belong to the begin of the step.
        """
        return self.sampled and self.variables[name].variability != "continuous"

    def is_relative(self, variable: ModelVariable) -> bool:
        """Whether a variable is a difference of two quantities, so that units convert it without an offset.

        Parameters
        ----------
        variable
            A variable of this FMU.

        Returns
        -------
        bool
            As it says itself; else as its declared type says.
        """
        declared = variable.declaredType is not None and bool(variable.declaredType.relativeQuantity)
        return self.relative.get(owner(variable), declared)

    def unit(self, variable: ModelVariable) -> str | None:
        """Return the name of a variable's unit, its type's unit where it has none of its own.

        Parameters
        ----------
        variable
            A variable of this FMU.

        Returns
        -------
        str or None
            None where neither has one.
        """
        return variable.unit or (variable.declaredType.unit if variable.declaredType else None) or None

    @cached_property
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
        return self._units_by_name.get(self.unit(variable) or "")

    @cached_property
    def _units_by_name(self) -> dict[str, Unit]:
        return {unit.name: unit for unit in reversed(self.defined_units)}

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

    # ---- elements ----------------------------------------------------------------------------------------------------

    def sizes(self, structural: Mapping[str, float] = MappingProxyType({})) -> dict[int, int]:
        """Return the sizes that dimensions refer to: values of structural parameters and of constants.

        Parameters
        ----------
        structural
            Values that differ from the start values, by name.

        Returns
        -------
        dict
            Value reference to value.
        """
        if not structural:
            return self._start_sizes
        return {
            reference: int(structural.get(name, self._start_sizes[reference])) for reference, name in self._size_names
        }

    @cached_property
    def _size_names(self) -> list[tuple[int, str]]:
        """Value reference and name of each variable that a dimension refers to."""
        referred = {d.valueReference for v in self.variables.values() for d in v.dimensions} - {None}
        return [(v.valueReference, v.name) for v in self.variables.values() if v.valueReference in referred]

    @cached_property
    def _start_sizes(self) -> dict[int, int]:
        return {reference: int(self.variables[name].start or 0) for reference, name in self._size_names}

    @cached_property
    def structural(self) -> dict[str, float]:
        """Names of the structural parameters, each with its start value."""
        found = (v for v in self.variables.values() if v.causality == "structuralParameter")
        return {variable.name: float(variable.start or 0) for variable in found}

    def structural_value(self, component: str, name: str, given: Value) -> float:
        """Check the value of a structural parameter.

        Parameters
        ----------
        component
            Name of the component in messages.
        name
            Name of the structural parameter.
        given
            The value as a user gives it.

        Returns
        -------
        float
            The value; a whole number.

        Raises
        ------
        SetupError
            If it does not fit.
        """
        found = self.value(component, Elements(name, (0,), (), name), given)
        assert isinstance(found, float)
        return found

    def elements(self, component: str, name: str, sizes: Mapping[int, int] = MappingProxyType({})) -> Elements:
        """Find the elements of a name, see :func:`cosim.fmi.elements.find_elements`.

        Parameters
        ----------
        component
            The component's name, for the message.
        name
            Of a variable or an element.
        sizes
            From :meth:`sizes`.

        Returns
        -------
        Elements
            The elements of the variable, or the one of the name.

        Raises
        ------
        SetupError
            If there is no such variable or element, with similar names.
        """
        found = find_elements(name, self.variables, sizes)
        if found is None:
            array = self.variables.get(array_name(name))
            if array is not None and array.dimensions:
                shape = " x ".join(map(str, shape_of(array, sizes)))
                raise SetupError(f"{component}.{name}: expected an element of {array.name}, which has {shape} elements")
            self.variable(component, name)
        assert found is not None
        return found

    # ---- values ------------------------------------------------------------------------------------------------------

    def value(self, component: str, elements: Elements, given: Value) -> Checked:
        """Check a value for a variable, or for elements of it, and convert it to what the FMU takes.

        Parameters
        ----------
        component
            The component's name, for messages.
        elements
            From :meth:`elements`.
        given
            What the user gave.

        Returns
        -------
        float, str or tuple of float
            The value as the FMU takes it; a tuple for elements of an array.

        Raises
        ------
        SetupError
            If the variable may not be set, or the value does not fit it.
        """
        variable = self.variables[elements.variable]
        where = f"{component}.{elements.alias if elements.is_whole else elements.names[0]}"
        settable = variable.causality in ("parameter", "structuralParameter", "input") or (
            variable.causality in ("local", "output")
            and variable.initial in ("exact", "approx")
            and variable.variability != "constant"
        )
        if not settable:
            raise SetupError(f"{where}: expected a parameter or an input, got {with_article(variable.causality)}")
        kind = KINDS[variable.type]
        if kind not in NUMERIC and (kind != "String" or elements.shape):
            what = f"array of type {variable.type}" if elements.shape else f"value of type {variable.type}"
            raise SetupError(f"{where}: expected a type that can be set, got {what}, which is not supported")
        if kind == "String":
            return str(given)
        if not elements.shape:
            if not isinstance(given, float | int | bool | str):
                raise SetupError(f"{where}: expected one value, got {given}")
            return self._checked(variable, where, given)
        shape = elements.shape if elements.is_whole else (1,)
        values = array_of(where, shape, given)
        return tuple(
            self._checked(variable, f"{component}.{name}", value)
            for name, value in zip(elements.names, values, strict=True)
        )

    def whole_array(
        self, component: str, name: str, given: Mapping[int, float], sizes: Mapping[int, int]
    ) -> tuple[float, ...]:
        """Complete the values of an array by the start values.

        Parameters
        ----------
        component, name
            The component's name, for messages, and the array's.
        given
            Place in the flattened array to value.
        sizes
            From :meth:`sizes`.

        Returns
        -------
        tuple of float
            The values of all elements, by rows.

        Raises
        ------
        SetupError
            If elements are missing that have no start values.
        """
        elements = self.elements(component, name, sizes)
        start = starts(self.variables[elements.variable], len(elements.places))
        missing = [own for place, own in zip(elements.places, elements.names, strict=True) if place not in given]
        if start is None and missing:
            raise SetupError(
                f"{component}.{name}: expected values of all {len(elements.places)} elements, as the description has "
                f"none for its size, got none of {missing[0]}"
            )
        return tuple(given[place] if start is None else given.get(place, start[place]) for place in elements.places)

    def _checked(self, variable: ModelVariable, where: str, given: Scalar) -> float:
        """Check one number against type and bounds."""
        found = number(variable, where, given)
        low, high = self.bounds[variable.name]
        if not math.isfinite(found):
            raise SetupError(f"{where}: expected a finite number, got {given}")
        if (low is not None and found < low) or (high is not None and found > high):
            unit = f" {self.unit(variable)}" if self.unit(variable) else ""
            bounds = f"[{'-inf' if low is None else f'{low:g}'}, {'inf' if high is None else f'{high:g}'}]"
            raise SetupError(f"{where}: expected a value in {bounds}{unit}, got {given}")
        return found


def _mark_aliases(description: FmpyDescription) -> None:
    """Mark inputs of FMI 2 that share a value reference as aliases of the first of them, as fmpy does for FMI 3."""
    if description.fmiMajorVersion == 2:
        owners: dict[tuple[str, int], ModelVariable] = {}
        for variable in description.modelVariables:
            if variable.causality == "input":
                owner = owners.setdefault((variable.type, variable.valueReference), variable)
                variable.alias = owner if owner is not variable else None


def _inside(path: Path, member: str | None) -> Path:
    return path if member is None else path / member


def _opened(path: Path, member: str | None) -> str | BinaryIO:
    if member is None:
        return str(path)
    with open_archive(path, path) as archive:
        return io.BytesIO(archive.read(member))


def _size_on_disk(path: Path, member: str | None) -> int | None:
    """Return what an FMU takes in the archive that holds it, in bytes; None where it is a file of its own."""
    if member is None:
        return None
    with zipfile.ZipFile(path) as archive:
        return archive.getinfo(member).compress_size


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
