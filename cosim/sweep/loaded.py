"""The loaded system of a worker: its FMUs are extracted and instantiated once, and reset for each further run."""

from __future__ import annotations

from contextlib import ExitStack

from cosim.engine.session import Session
from cosim.system import System


class LoadedSystem:
    """The system that a worker ran last, with its FMUs loaded; a context manager.

    It holds one at a time: an FMU that allows one instance in a process runs in the process, whatever ran before.
    """

    def __init__(self) -> None:
        self._stack = ExitStack()
        self._system: System | None = None
        self._session: Session | None = None

    def __enter__(self) -> LoadedSystem:
        return self

    def __exit__(self, *exception: object) -> None:
        self.free()

    def session(self, system: System) -> Session:
        """Return a session of a system; that of the last call where it was the same object.

        Parameters
        ----------
        system
            The system; it must not have changed since the last call.

        Raises
        ------
        CosimError
            If it cannot be loaded.
        """
        if self._session is None or self._system is not system:
            self.free()
            self._session = self._stack.enter_context(system.open())
            self._system = system
        return self._session

    def free(self) -> None:
        """Free the FMUs; the next run loads them again."""
        self._system = self._session = None
        self._stack.close()
