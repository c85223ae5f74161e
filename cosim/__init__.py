"""How FMUs run together: a system of components, its sessions, their results. Knows FMUs, no models."""

from cosim.engine.session import Session
from cosim.errors import CosimError, RunError, SetupError
from cosim.manifest import Manifest
from cosim.results.result import Result
from cosim.run_folder import run_to_folder
from cosim.system import System

__all__ = ["CosimError", "Manifest", "Result", "RunError", "Session", "SetupError", "System", "run_to_folder"]
