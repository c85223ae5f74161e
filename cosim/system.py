"""A system of FMUs that can be run: the package's main class."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Self

from cosim.engine.editing import edit
from cosim.engine.run_options import RunOptions, takes_run_options
from cosim.engine.session import Session
from cosim.engine.structure import Structure
from cosim.errors import reading, writing_to
from cosim.fmi.archive import write_archive
from cosim.fmi.isolated import TIME_LIMIT
from cosim.results.result import Result
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

    def __repr__(self) -> str:
        components = ", ".join(self.models) or "no components"
        return f"<System {self.name}: {components}; {len(self.connections)} connections>"

    @classmethod
    def load(cls, path: str | Path) -> Self:
        """Read a system from an ``.ssp`` file, or an ``.ssd`` file beside its resources; see :func:`cosim.ssp.load`.

        Parameters
        ----------
        path
            The file.

        Returns
        -------
        System
            The system, without any component loaded.

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
            False where the same file existed already; it is not written again.

        Raises
        ------
        SetupError
            If it cannot be written.
        """
        contents = package_contents(self)
        with writing_to(Path(path).parent):
            return write_archive(Path(path), contents)

    @takes_run_options
    def validate(self, options: RunOptions) -> None:
        """Check all that can be checked before an FMU is loaded.

        Parameters
        ----------
        options
            Given as keyword arguments: the fields of :class:`cosim.engine.run_options.RunOptions`.

        Raises
        ------
        SetupError
            With all problems found.
        """
        options.check(self)

    def replace(self, name: str, fmu: str | Path, connections: Mapping[str, str] | None = None) -> None:
        """Put another FMU in a component's place; where that is not possible, the system stays as it was.

        Connections whose names and units fit the replacement stay; those to inputs it does not have are removed.

        Parameters
        ----------
        name
            The component; the replacement takes its name.
        fmu
            The replacement's ``.fmu`` file.
        connections
            Input of the system, as ``component.variable``, to the output that feeds it from now on: the replacement's
            by its bare name, any by ``component.variable``; ``"0.001*z"`` and ``"-1*z+0.5"`` transform, double quotes
            protect a name.

        Raises
        ------
        SetupError
            If something does not fit, or an input has lost its connection.

        Examples
        --------
        >>> system.replace("shaker", "cab.fmu", {"seat.floor_displacement": "0.001*z"})     # doctest: +SKIP
        """
        new = [f'{text}="{sink}"' for sink, text in (connections or {}).items()]
        edit(self, {name: fmu}, (), new, bare_names_of=name)

    def open(self, isolate: Iterable[str] = (), time_limit: float = TIME_LIMIT, capture_stdout: bool = True) -> Session:
        """Load all FMUs, for one run or many; use it in a ``with`` statement.

        Parameters
        ----------
        isolate, time_limit, capture_stdout
            As of :class:`cosim.engine.session.Session`.

        Returns
        -------
        Session
            Loads the FMUs when it is entered, and frees them when it is left.

        Raises
        ------
        SetupError
            If a component to isolate does not exist or the time limit is out of range.
        """
        return Session(self, isolate, time_limit, capture_stdout)

    @takes_run_options
    def simulate(self, options: RunOptions) -> Result:
        """Load, run once, free.

        Parameters
        ----------
        options
            Given as keyword arguments: the fields of :class:`cosim.engine.run_options.RunOptions`.

        Returns
        -------
        Result
            An incomplete one, with its ``error``, if an FMU failed or the user interrupted after the first step.

        Raises
        ------
        SetupError
            If something is wrong that can be seen before an FMU is loaded.
        RunError
            If an FMU failed during loading or initialization.
        """
        checked = options.check(self)
        with self.open(options.isolate, options.time_limit, options.capture_stdout) as session:
            return session.execute(options, checked)
