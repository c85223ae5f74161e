"""How FMUs run together: a system of components, its sessions, their results. Knows FMUs, no models."""

from cosim.errors import CosimError, RunError, SetupError
from cosim.results import Result
from cosim.session import Session
from cosim.system import System

__all__ = ["CosimError", "Result", "RunError", "Session", "SetupError", "System"]
