"""Files that the package carries: FMUs, systems of them, cross-check files, parameter sets, gains, examples.

Freshly built FMUs win: those of ``fmus`` in the working directory, then those of a clone, then those of the wheel.
"""

from __future__ import annotations

import logging
import shutil
from collections.abc import Iterator
from importlib import resources
from pathlib import Path

from cosim.errors import SetupError, did_you_mean, writing_to
from plant_models import parameter_sets

BUILT_FOLDER = Path("fmus")
"""Folder of freshly built FMUs, from the working directory; each flavour has the subfolder of its name."""

DEFAULT_FLAVOUR = "fmi2"
"""The first of :data:`fmus.FLAVOURS`."""

_LOG = logging.getLogger(__name__)


def package_folders() -> tuple[Path, ...]:
    """Return the folders that may hold FMUs: that of a clone, that of a wheel.

    They lie beside this package. To import ``fmus`` for its path would find the folder of this name in the working
    directory, where the project is installed as editable.
    """
    package = Path(str(resources.files("seat_cosim"))).parent / "fmus"
    return package, package / "built"


def _roots() -> tuple[Path, ...]:
    return (BUILT_FOLDER, *package_folders())


def fmu_folder(flavour: str = DEFAULT_FLAVOUR, given: Path | None = None) -> Path:
    """Return the folder of the FMUs of a flavour.

    Parameters
    ----------
    flavour
        Name from :data:`fmus.FLAVOURS`.
    given
        Folder that has a subfolder for the flavour; where None, the first that has FMUs among ``fmus``, the clone and
        the wheel, and ``fmus`` where none has.
    """
    roots = _roots() if given is None else (given,)
    found = next((root for root in roots if any((root / flavour).glob("*.fmu"))), roots[0]) / flavour
    _LOG.debug("FMUs: %s", found)
    return found


def fmu(name: str, flavour: str = DEFAULT_FLAVOUR) -> Path:
    """Return the path of an FMU of this project.

    Parameters
    ----------
    name
        ``SeatController``, ``SeatPlant``, ``Shaker``, ``TruckCab``, ``SeatedDriver``, ``ActiveSeat``, ``PassiveSeat``
        or ``SemiActiveSeat``.
    flavour
        Name from :data:`fmus.FLAVOURS`.

    Raises
    ------
    SetupError
        If there is no such FMU.

    Examples
    --------
    >>> fmu("SeatPlant", "fmi3").name                                           # doctest: +SKIP
    'SeatPlant.fmu'
    """
    path = fmu_folder(flavour) / f"{name}.fmu"
    if path.is_file():
        return path
    names = sorted(each.stem for each in path.parent.glob("*.fmu"))
    has = f"one of {', '.join(names)}" if names else f"FMUs in {path.parent} (run: seat-cosim build)"
    raise SetupError(f"FMU {name}, {flavour}: expected {has}, got no such file{did_you_mean(name, names)}")


def ssp(name: str = "SeatSuspension") -> Path:
    """Return the path of a system of this project's FMUs.

    Parameters
    ----------
    name
        ``SeatSuspension``, of FMUs for FMI 2.0, or ``SeatSuspension-fmi3``.

    Raises
    ------
    SetupError
        If there is no such system.

    Examples
    --------
    >>> from cosim import System
    >>> System.load(ssp()).simulate()["seat.driver_acceleration"].max()         # doctest: +SKIP
    """
    found = next((path for root in _roots() if (path := root / f"{name}.ssp").is_file()), None)
    if found is not None:
        _LOG.debug("system: %s", found)
        return found
    names = sorted({path.stem for root in _roots() for path in root.glob("*.ssp")})
    has = f"one of {', '.join(names)}" if names else f"a system in {BUILT_FOLDER} (run: seat-cosim build)"
    raise SetupError(f"system {name}: expected {has}, got no such file{did_you_mean(name, names)}")


def system_file(name_or_file: Path) -> Path:
    """Return a user's system file; a bare name without a suffix means a system of this project.

    Parameters
    ----------
    name_or_file
        ``SeatSuspension``, or the path of a file.

    Raises
    ------
    SetupError
        If it is a bare name and there is no such system.
    """
    path = name_or_file.expanduser()
    is_name = path == Path(path.name) and not path.suffix and not path.exists()
    return ssp(path.name) if is_name else path


def examples() -> Path:
    """Return the folder of the examples: that of the wheel, or that of a clone."""
    package = Path(str(resources.files("seat_cosim")))
    return next((folder for folder in (package / "examples", package.parent / "examples") if folder.is_dir()), package)


def _carried_files() -> Iterator[tuple[Path, Path]]:
    """Yield each file that can be exported, and its path in the target folder."""
    from seat_controller_fmu.design.gains import FOLDER, PRESETS

    clone, wheel = package_folders()
    root = wheel if any(wheel.glob("*/*.fmu")) and not any(clone.glob("fmi*/*.fmu")) else clone
    fmus = [path for flavour in ("fmi2", "fmi3") for path in (root / flavour).glob("*") if path.is_file()]
    if not fmus:
        raise SetupError(f"{wheel}: expected the FMUs of a wheel, got none; build them: seat-cosim build")
    yield from ((path, Path(path.parent.name, path.name)) for path in (*sorted(fmus),))
    yield from ((path, Path(path.name)) for path in sorted(root.glob("*.ssp")))
    for name in parameter_sets.NAMES:
        yield parameter_sets.path(name), Path("parameter_sets", f"{name}.ssv")
    for name in PRESETS:
        for suffix in (".json", ".ssv"):
            yield FOLDER / f"{name}{suffix}", Path("gains", f"{name}{suffix}")
    folder = examples()
    for path in sorted(folder.rglob("*")):
        if path.suffix in (".py", ".md", ".csv") and path.name != "__init__.py":
            yield path, Path("examples", path.relative_to(folder))


def export(folder: Path, *, force: bool = False) -> Iterator[Path]:
    """Copy FMUs, cross-check files, systems, parameter sets, gains and examples to a folder.

    Parameters
    ----------
    folder
        Target folder; FMUs go to the subfolder of their flavour.
    force
        Whether to replace files that differ.

    Yields
    ------
    Path
        Each file when it is copied.

    Raises
    ------
    SetupError
        If the package has no FMUs, a file there differs, or the folder cannot be written to.
    """
    files = [(source, folder / name) for source, name in _carried_files()]
    with writing_to(folder):
        others = [new for old, new in files if new.is_file() and new.read_bytes() != old.read_bytes()]
        if others and not force:
            more = f" and {len(others) - 1} more" if len(others) > 1 else ""
            raise SetupError(f"{others[0]}{more}: expected no other file of this name, got one; --force replaces it")
        for source, target in files:
            target.parent.mkdir(parents=True, exist_ok=True)
            if source.resolve() != target.resolve():
                shutil.copyfile(source, target)
            yield target
