"""The front door: a structure of FMUs that can be run."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Self, Unpack

from cosim.engine.editing import edit, parse_source
from cosim.engine.schedule import decimations
from cosim.engine.session import Options, Session, check_choices, check_isolation
from cosim.engine.structure import Algorithm, Structure
from cosim.errors import SetupError, reading, writing_to
from cosim.fmi.archive import write_archive
from cosim.fmi.description import Value
from cosim.fmi.isolated import TIME_LIMIT
from cosim.results.result import Result, StepperName
from cosim.ssp import load, package_contents


class System(Structure):
    """FMUs and their connections, ready to run.

    Examples
    --------
    >>> system = System()                                                       # doctest: +SKIP
    >>> system.add("shaker", "fmus/python/Shaker.fmu")                          # doctest: +SKIP
    >>> system.add("seat", "fmus/python/SeatPlant.fmu")                         # doctest: +SKIP
    >>> system.connect("shaker.floor_displacement", "seat.floor_displacement")  # doctest: +SKIP
    >>> result = system.simulate(stop_time=3.0, step_size=0.002)                # doctest: +SKIP
    >>> system.save("system.ssp")                                               # doctest: +SKIP
    >>> same = System.load("system.ssp")                                        # doctest: +SKIP
    """

    @classmethod
    def load(cls, path: str | Path) -> Self:
        """Read a system from an ``.ssp`` file, or an ``.ssd`` file beside its resources; see :func:`cosim.ssp.load`.

        Raises
        ------
        SetupError
            With all problems found.
        """
        system = cls()
        with reading(Path(path)):
            load(path, system)
        return system

    def save(self, path: str | Path) -> bool:
        """Write the system with its FMUs as an ``.ssp`` file; the same system gives the same bytes.

        Parameters
        ----------
        path
            The file; its folder is made where it does not exist.

        Returns
        -------
        bool
            False where the same file stood there already; it is left alone.

        Raises
        ------
        SetupError
            If it cannot be written.
        """
        contents = package_contents(self)
        with writing_to(Path(path).parent):
            return write_archive(Path(path), contents)

    def validate(
        self,
        stop_time: float | None = None,
        step_size: float | None = None,
        parameters: Mapping[str, Value] | None = None,
        record: Iterable[str] | None = None,
        algorithm: Algorithm | None = None,
        record_every: int = 1,
        loop: StepperName | None = None,
        isolate: Iterable[str] = (),
        time_limit: float = TIME_LIMIT,
    ) -> None:
        """Check all that can be checked before an FMU is loaded; parameters as of :meth:`open` and a session's run.

        Raises
        ------
        SetupError
            With all problems found.
        """
        problems: list[str] = []
        for check in (
            lambda: decimations(self.component_steps, list(self.models), self.clock(stop_time, step_size)),
            lambda: self.check(parameters or {}),
            lambda: self.recorded(record),
            lambda: check_choices(algorithm, record_every, loop),
            lambda: check_isolation(self, isolate, time_limit),
        ):
            try:
                check()
            except SetupError as error:
                problems += error.problems
        if problems:
            raise SetupError(*problems)

    def replace(self, name: str, fmu: str | Path, connections: Mapping[str, str] | None = None) -> None:
        """Put another FMU in a component's place, all of it or nothing.

        Connections whose names and units fit the newcomer stay; those to inputs it does not have are dropped.

        Parameters
        ----------
        name
            The component; the newcomer takes its name.
        fmu
            The newcomer's ``.fmu`` file.
        connections
            Input of the system, as ``component.variable``, to the output that feeds it from now on: the newcomer's by
            its bare name, any by ``component.variable``; ``"0.001*z"`` and ``"-1*z+0.5"`` transform.

        Raises
        ------
        SetupError
            If something does not fit, or an input that was fed before is left without.

        Examples
        --------
        >>> system.replace("shaker", "cab.fmu", {"seat.floor_displacement": "0.001*z"})     # doctest: +SKIP
        """
        new = []
        for sink, text in (connections or {}).items():
            output, transformation = parse_source(text)
            complete = output.partition(".")[0] in self.models
            new.append((output if complete else f"{name}.{output}", transformation, sink))
        edit(self, {name: fmu}, (), new)

    def open(self, isolate: Iterable[str] = (), time_limit: float = TIME_LIMIT, divert_stdout: bool = True) -> Session:
        """Load all FMUs, for one run or many; use it in a ``with`` statement.

        Parameters are those of :class:`cosim.engine.session.Session`: ``isolate`` names components whose FMUs run in
        processes of their own, each call of them limited to ``time_limit`` s; what FMUs print becomes warnings, unless
        ``divert_stdout`` is false.
        """
        return Session(self, isolate, time_limit, divert_stdout)

    def simulate(
        self,
        stop_time: float | None = None,
        step_size: float | None = None,
        parameters: Mapping[str, Value] | None = None,
        record: Iterable[str] | None = None,
        progress: Callable[[float], None] | None = None,
        *,
        isolate: Iterable[str] = (),
        time_limit: float = TIME_LIMIT,
        divert_stdout: bool = True,
        **options: Unpack[Options],
    ) -> Result:
        """Load, run once, free; see :meth:`open` and :meth:`cosim.engine.session.Session.run`."""
        record, isolate = None if record is None else list(record), set(isolate)
        choices = options.get("algorithm"), options.get("record_every", 1), options.get("loop")
        self.validate(stop_time, step_size, parameters, record, *choices, isolate, time_limit)
        with self.open(isolate, time_limit, divert_stdout) as session:
            return session.run(stop_time, step_size, parameters, record, progress, **options)
