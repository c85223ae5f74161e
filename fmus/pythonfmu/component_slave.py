"""The pythonfmu slave of a component.

pythonfmu's registry of variables has no units, bounds, dependencies or enumerations, and its accessors raise if a host
passes a wrong argument, which is fatal to the host. So the slave uses the declaration of the component for every call.
Setters never raise: a refused value is logged, the old value stays, and the next step is discarded.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from operator import attrgetter
from pathlib import Path
from typing import Any, ClassVar
from xml.etree import ElementTree

from pythonfmu import Fmi2Slave
from pythonfmu.enums import Fmi2Status

from fmus.component import (
    MAX_STEP_SIZE,
    MAX_TIME,
    TIME_TOLERANCE,
    Component,
    DefaultExperiment,
    ParameterError,
    pack_state,
    state_fields,
    unpack_state,
)
from fmus.variables import VariableDeclaration, record_of

_PHASES = ("instantiated", "initializing", "stepping", "terminated")


class ComponentSlave(Fmi2Slave):
    """An FMI 2.0 co-simulation slave of a component; subclasses set the attributes.

    The value reference of a variable is its position in ``component.variables``.

    Attributes
    ----------
    component
        The component.
    content_guid
        GUID of the FMU.
    experiment
        Stop time and step size of the default experiment, in s, by name.
    """

    component: ClassVar[Component]
    content_guid: ClassVar[str]
    experiment: ClassVar[dict[str, float]]

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.modelName = self.component.name
        self.guid = self.content_guid
        self._variables = self.component.variables
        self._values: list[Any] = [0.0 if v.start is None else v.start for v in self._variables]
        self._references = {causality: self._references_of(causality) for causality in ("input", "output", "parameter")}
        self._output_values = attrgetter(*(self._variables[i].field for i in self._references["output"]))
        self._phase = "instantiated"
        self._time = 0.0
        self._stop_time = math.inf
        self._state: Any = None
        self._coefficients: Any = None
        self._outputs_due = True
        self._faults: dict[str, str] = {}
        self._warned: list[str] = []

    def _references_of(self, causality: str) -> list[int]:
        return [i for i, v in enumerate(self._variables) if v.causality == causality]

    def _values_of(self, causality: str, values: Sequence[Any]) -> list[Any]:
        """Return the values of the variables of a causality, from those of all."""
        return [values[i] for i in self._references[causality]]

    def _set_outputs(self, values: Sequence[Any]) -> None:
        for reference, value in zip(self._references["output"], values, strict=True):
            self._values[reference] = value

    # ---- description -------------------------------------------------------------------------------------------------

    def to_xml(self, model_options: dict[str, str] | None = None) -> ElementTree.Element:
        """Return the model description of the component; called by pythonfmu's builder only.

        Parameters
        ----------
        model_options
            Not used.

        Returns
        -------
        xml.etree.ElementTree.Element
            Root of the ``modelDescription.xml``.
        """
        from fmus.export.model_description import model_description, to_xml

        description = model_description(
            self.component, DefaultExperiment(**self.experiment), self.content_guid, needs_execution_tool=True
        )
        root = ElementTree.fromstring(to_xml(description))
        for element in root.iter():  # the builder indents it
            element.text = element.tail = None
        return root

    # ---- messages ----------------------------------------------------------------------------------------------------

    def log(self, msg: str, status: Fmi2Status = Fmi2Status.ok, *args: Any, **kwargs: Any) -> None:
        """Log a message; a host reads it as a printf format, so percent signs are doubled.

        Parameters
        ----------
        msg
            Text of the message.
        status
            Status that is passed to the host.
        *args, **kwargs
            Passed to pythonfmu.
        """
        super().log(msg.replace("%", "%%"), status, *args, **kwargs)

    def _fault(self, name: str, problem: str) -> None:
        """Log an error; the next step is discarded for it. A legal value of the same name removes it."""
        self._faults[name] = problem
        self.log(problem, Fmi2Status.error)

    def _refuse_step(self, time: float, reason: str) -> bool:
        self.log(f"step at t = {time} s refused: {reason}", Fmi2Status.discard)
        return False

    # ---- values ------------------------------------------------------------------------------------------------------

    def _variable(self, reference: int, kinds: tuple[type, ...]) -> VariableDeclaration | None:
        """Look up a variable of one of the types; log and return None where there is none."""
        if not 0 <= reference < len(self._variables):
            self._fault(f"#{reference}", f"expected a value reference below {len(self._variables)}, got {reference}")
            return None
        variable = self._variables[reference]
        if not issubclass(variable.type, kinds) or (variable.type is bool and bool not in kinds):
            self._fault(
                variable.name,
                f"{variable.name}: expected the access of a {variable.type.__name__}, got {kinds[0].__name__}",
            )
            return None
        return variable

    def _is_settable(self, variable: VariableDeclaration) -> bool:
        if variable.causality == "input" or variable.variability == "tunable":
            return self._phase != "terminated"
        return variable.variability == "fixed" and self._phase in ("instantiated", "initializing")

    def _set(self, references: Sequence[int], values: Sequence[Any], kinds: tuple[type, ...]) -> None:
        for reference, value in zip(references, values, strict=True):
            variable = self._variable(reference, kinds)
            if variable is None:
                continue
            if not self._is_settable(variable):
                what = f"{variable.variability} {variable.causality}"
                self._fault(variable.name, f"{variable.name}: a {what} may not be set while {self._phase}, got {value}")
            elif problem := variable.problem(value):
                self._fault(variable.name, problem)
            else:
                self._values[reference] = value
                self._faults.pop(variable.name, None)
                self._outputs_due = True
                if variable.causality == "parameter":
                    self._coefficients = None

    def _get(self, references: Sequence[int], kinds: tuple[type, ...], missing: Any) -> list[Any]:
        if self._outputs_due and self._phase in ("instantiated", "initializing"):
            self._initialize()  # errors are reported at the end of the initialisation: until then values may change
        values = []
        for reference in references:
            variable = self._variable(reference, kinds)
            values.append(missing if variable is None else self._values[reference])
        return values

    def set_real(self, vrs: Sequence[int], values: Sequence[float]) -> None:
        """Set the values of real variables.

        Parameters
        ----------
        vrs
            Value references.
        values
            One value for each reference, in the unit of the variable.
        """
        self._set(vrs, values, (float,))

    def set_integer(self, vrs: Sequence[int], values: Sequence[int]) -> None:
        """Set integers and enumerations.

        Parameters
        ----------
        vrs
            Value references.
        values
            One value for each reference, in the unit of the variable.
        """
        self._set(vrs, values, (int,))

    def set_boolean(self, vrs: Sequence[int], values: Sequence[bool]) -> None:
        """Set the values of Boolean variables.

        Parameters
        ----------
        vrs
            Value references.
        values
            One value for each reference, in the unit of the variable.
        """
        self._set(vrs, values, (bool,))

    def set_string(self, vrs: Sequence[int], values: Sequence[str]) -> None:
        """Set the values of string variables.

        Parameters
        ----------
        vrs
            Value references.
        values
            One value for each reference, in the unit of the variable.
        """
        self._set(vrs, values, (str,))

    def get_real(self, vrs: Sequence[int]) -> list[float]:
        """Return the values of real variables.

        Parameters
        ----------
        vrs
            Value references.

        Returns
        -------
        list
            One value for each reference, NaN for a reference of no such variable.
        """
        return self._get(vrs, (float,), math.nan)

    def get_integer(self, vrs: Sequence[int]) -> list[int]:
        """Get integers and enumerations.

        Parameters
        ----------
        vrs
            Value references.

        Returns
        -------
        list
            One value for each reference, 0 for a reference of no such variable.
        """
        return [int(value) for value in self._get(vrs, (int,), 0)]

    def get_boolean(self, vrs: Sequence[int]) -> list[bool]:
        """Return the values of Boolean variables.

        Parameters
        ----------
        vrs
            Value references.

        Returns
        -------
        list
            One value for each reference, False for a reference of no such variable.
        """
        return self._get(vrs, (bool,), False)

    def get_string(self, vrs: Sequence[int]) -> list[str]:
        """Return the values of string variables.

        Parameters
        ----------
        vrs
            Value references.

        Returns
        -------
        list
            One value for each reference, an empty text for a reference of no such variable.
        """
        return self._get(vrs, (str,), "")

    # ---- life cycle --------------------------------------------------------------------------------------------------

    def setup_experiment(
        self, start_time: float, stop_time: float | None = None, tolerance: float | None = None
    ) -> None:
        """Set start and stop time.

        Parameters
        ----------
        start_time
            In s.
        stop_time
            In s; None for no limit.
        tolerance
            Not used.
        """
        if self._phase != "instantiated":
            self._change_phase("instantiated", "instantiated")
            return
        self._stop_time = math.inf if stop_time is None else stop_time
        if abs(start_time) <= MAX_TIME:
            self._time = self._values[0] = start_time
            self._outputs_due = True
        else:
            self._fault("time", f"start time: expected at most {MAX_TIME:g} s either way, got {start_time} s")

    def enter_initialization_mode(self) -> None:
        """Enter the initialization mode of FMI."""
        self._change_phase("instantiated", "initializing")

    def exit_initialization_mode(self) -> None:
        """Prepare the parameters, compute the initial outputs and leave the initialisation; stay in it on an error."""
        if self._phase == "initializing" and (problem := self._initialize()):
            self._fault("initialization", problem)
        else:
            self._change_phase("initializing", "stepping")

    def terminate(self) -> None:
        """End the run; the outputs keep their values."""
        self._change_phase("stepping", "terminated")

    def _change_phase(self, before: str, after: str) -> None:
        """Change the phase, if the present one is ``before``."""
        if self._phase == before:
            self._phase = after
        else:
            self._fault("call", f"expected a call while {before}, got one while {self._phase}")

    def _prepare(self) -> str | None:
        """Derive the coefficients of the present parameters; return what is wrong with them, or None."""
        if self._coefficients is not None:
            return None
        parameters = self._parameters(self._values)
        try:
            self._coefficients = self.component.prepare(parameters)
        except ParameterError as error:
            return str(error)
        except (ArithmeticError, ValueError) as error:
            return f"expected parameters that can be calculated with, got {type(error).__name__}: {error}"
        for text in self.component.warnings(parameters):
            if text not in self._warned:
                self._warned.append(text)
                self.log(text, Fmi2Status.warning)
        return None

    def _parameters(self, values: Sequence[Any]) -> Any:
        paths = (self._variables[reference].field for reference in self._references["parameter"])
        resolved = map(self._resolve_path, self._values_of("parameter", values))
        return record_of(self.component.parameters, dict(zip(paths, resolved, strict=True)))

    def _resolve_path(self, value: Any) -> Any:
        """Return the whole path of a file, which is relative to the resources of the FMU; other values stay."""
        return str(Path(self.resources, value)) if isinstance(value, str) else value

    def _inputs(self) -> Any:
        return self.component.inputs(*self._values_of("input", self._values))

    def _initialize(self) -> str | None:
        """Compute state and outputs at the start; return what prevents it, or None."""
        if problem := self._prepare():
            return problem
        try:
            state, outputs = self.component.initialize(self._inputs(), self._coefficients, self._time)
        except (ArithmeticError, ValueError) as error:
            return f"{type(error).__name__}: {error}"
        values = self._output_values(outputs)
        if problem := self._not_finite(values):
            return problem
        self._state = state
        self._set_outputs(values)
        self._outputs_due = False
        return None

    def _not_finite(self, outputs: Sequence[float]) -> str | None:
        """Return which output is not a finite number, or None."""
        for variable, value in zip(self._values_of("output", self._variables), outputs, strict=True):
            if not math.isfinite(value):
                return f"{variable.name}: expected a finite number, got {value} at t = {self._time} s"
        return None

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Take a communication step.

        Parameters
        ----------
        current_time
            Begin of the step, in s; must be the time that the run has reached.
        step_size
            In s.

        Returns
        -------
        bool
            False (discard) if the step was refused; then nothing has changed.
        """
        if self._phase != "stepping":
            reason = (
                self._initialize() if self._phase == "initializing" else None
            )  # the initialisation cannot report it
            expected = f"expected a call after initialisation, got one while {self._phase}"
            return self._refuse_step(current_time, "; ".join(filter(None, (expected, reason))))
        if self._faults:
            reasons = "; ".join(self._faults.values())
            self._faults.clear()
            return self._refuse_step(current_time, reasons)
        if not abs(current_time - self._time) <= TIME_TOLERANCE * max(1.0, abs(self._time)):
            return self._refuse_step(current_time, f"expected the time {self._time} s, got {current_time} s")
        if not 0.0 < step_size <= MAX_STEP_SIZE:
            expected = f"expected a step size above 0 and up to {MAX_STEP_SIZE:g} s"
            return self._refuse_step(current_time, f"{expected}, got {step_size} s")
        if current_time + step_size > self._stop_time + TIME_TOLERANCE * max(1.0, abs(self._stop_time)):
            expected = f"expected a step to the stop time {self._stop_time} s at most"
            return self._refuse_step(current_time, f"{expected}, got one to {current_time + step_size} s")
        if not abs(current_time + step_size) <= MAX_TIME:
            expected = f"expected a step that ends within {MAX_TIME:g} s either way"
            return self._refuse_step(current_time, f"{expected}, got {step_size} s")
        if problem := self._prepare():
            return self._refuse_step(current_time, problem)
        try:
            state, outputs = self.component.advance(
                self._state, self._inputs(), self._coefficients, current_time, step_size
            )
            values = self._output_values(outputs)
        except (ArithmeticError, ValueError) as error:  # where C functions return NaN
            return self._refuse_step(current_time, f"{type(error).__name__}: {error}")
        if problem := self._not_finite(values):
            return self._refuse_step(current_time, problem)
        self._state = state
        self._set_outputs(values)
        self._time = self._values[0] = current_time + step_size
        return True

    # ---- state -------------------------------------------------------------------------------------------------------

    def _get_fmu_state(self) -> dict[str, Any]:
        return {
            "guid": self.content_guid,
            "phase": self._phase,
            "time": self._time,
            "values": [v if isinstance(v, bool | str) else float(v) for v in self._values],
            "state": None if self._state is None else pack_state(self._state),
            "outputs_due": self._outputs_due,
            "faults": dict(self._faults),
            "warned": list(self._warned),
        }

    def _set_fmu_state(self, state: dict[str, Any]) -> None:
        if state.get("guid") != self.content_guid:
            got = str(state.get("guid"))[:100]
            self._fault("state", f"state: expected one of {self.modelName} {self.content_guid}, got {got}")
            return
        if not self._is_reachable(state):
            self._fault("state", f"state: expected one of {self.modelName}, got what no instance can have")
            return
        self._phase = state["phase"]
        self._time = state["time"]
        self._values = [v.type(x) for v, x in zip(self._variables, state["values"], strict=True)]
        self._state = None if state["state"] is None else unpack_state(self.component.state, state["state"])
        self._outputs_due = state["outputs_due"]
        self._faults = dict(state["faults"])
        self._warned = list(state["warned"])
        self._coefficients = None

    def _is_reachable(self, state: dict[str, Any]) -> bool:
        """Whether an instance can reach a state; a state from bytes may have any content."""
        try:
            values = [v.type(x) for v, x in zip(self._variables, state["values"], strict=True)]
            known = not any(
                v.problem(x) for v, x in zip(self._variables, values, strict=True) if v.causality != "output"
            )
            calculated = all(math.isfinite(x) for x in self._values_of("output", values))
            time, texts = float(state["time"]), [*state["faults"].values(), *state["faults"], *state["warned"]]
            plain = isinstance(state["outputs_due"], bool) and all(isinstance(text, str) for text in texts)
            return bool(
                known
                and calculated
                and plain
                and abs(time) <= MAX_TIME
                and time == values[0]
                and state["phase"] in _PHASES
                and (state["state"] is not None or state["phase"] in _PHASES[:2])
                and (state["state"] is None or self._is_valid_state(state["state"], values, time, state["phase"]))
            )
        except (ArithmeticError, AttributeError, KeyError, TypeError, ValueError):
            return False

    def _is_valid_state(self, numbers: list[float], values: list[Any], time: float, phase: str) -> bool:
        """Whether numbers are a state of the model at a time in s with these values.

        Before the first step it may be a state of another time: the initialisation replaces it.
        """
        count = sum(field.length or 1 for field in state_fields(self.component.state))
        if len(numbers) != count or not all(math.isfinite(number) for number in numbers):
            return False
        state = unpack_state(self.component.state, numbers)
        is_valid = phase != "stepping" or self.component.is_valid_state(state, self._parameters(values), time)
        return pack_state(state) == numbers and is_valid

    @staticmethod
    def _fmu_state_from_bytes(state: bytes) -> dict[str, Any]:
        try:
            content = json.loads(state.decode("utf-8"))
        except (ValueError, RecursionError):
            content = None
        return content if isinstance(content, dict) else {"guid": "a byte string that is no state"}
