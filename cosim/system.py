"""The front door: a structure of FMUs that can be run."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

from cosim.errors import SetupError
from cosim.isolated import TIME_LIMIT
from cosim.model import Value
from cosim.results import Result
from cosim.session import Session
from cosim.structure import Structure


class System(Structure):
    """FMUs and their connections, ready to run.

    Examples
    --------
    >>> system = System()                                                       # doctest: +SKIP
    >>> system.add("shaker", "fmus/python/Shaker.fmu")                          # doctest: +SKIP
    >>> system.add("seat", "fmus/python/SeatPlant.fmu")                         # doctest: +SKIP
    >>> system.connect("shaker.floor_displacement", "seat.floor_displacement")  # doctest: +SKIP
    >>> result = system.simulate(stop_time=3.0, step_size=0.002)                # doctest: +SKIP
    """

    def validate(
        self,
        stop_time: float | None = None,
        step_size: float | None = None,
        parameters: Mapping[str, Value] | None = None,
        record: Iterable[str] | None = None,
    ) -> None:
        """Check all that can be checked before an FMU is loaded.

        Raises
        ------
        SetupError
            With all problems found.
        """
        problems: list[str] = []
        for check in (
            lambda: self.clock(stop_time, step_size),
            lambda: self.check(parameters or {}),
            lambda: self.recorded(record),
        ):
            try:
                check()
            except SetupError as error:
                problems += error.problems
        if problems:
            raise SetupError(*problems)

    def open(self, isolate: Iterable[str] = (), time_limit: float = TIME_LIMIT, divert_stdout: bool = True) -> Session:
        """Load all FMUs, for one run or many; use it in a ``with`` statement.

        Parameters are those of :class:`cosim.session.Session`: ``isolate`` names components whose FMUs run in processes
        of their own, each call of them limited to ``time_limit`` s; what FMUs print becomes warnings, unless
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
        isolate: Iterable[str] = (),
        time_limit: float = TIME_LIMIT,
        divert_stdout: bool = True,
    ) -> Result:
        """Load, run once, free; see :meth:`open` and :meth:`cosim.session.Session.run`."""
        self.validate(stop_time, step_size, parameters, record)
        with self.open(isolate, time_limit, divert_stdout) as session:
            return session.run(stop_time, step_size, parameters, record, progress)
