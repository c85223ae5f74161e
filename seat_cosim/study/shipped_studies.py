"""Studies that the package carries, and how a study of the seat suspension is read."""

from __future__ import annotations

from pathlib import Path

from cosim.errors import SetupError, did_you_mean
from cosim.sweep.study import Study
from seat_cosim.study.vocabulary import SeatVocabulary

_FOLDER = Path(__file__).with_name("shipped")

SHIPPED = tuple(sorted(path.stem for path in _FOLDER.glob("*.toml")))
"""Names of the studies."""


def study_file(name_or_file: str | Path) -> Path:
    """Return the file of a study; a bare name without a suffix means one that the package carries.

    Parameters
    ----------
    name_or_file
        Name from :data:`SHIPPED`, or the path of a file.

    Raises
    ------
    SetupError
        If it is a bare name and there is no such study.
    """
    path = Path(name_or_file).expanduser()
    if path.suffix or path != Path(path.name) or path.exists():
        return path
    if path.name not in SHIPPED:
        raise SetupError(
            f"study {path}: expected a file, or one of {', '.join(SHIPPED)}, got none of that name"
            f"{did_you_mean(path.name, SHIPPED)}"
        )
    return _FOLDER / f"{path.name}.toml"


def read(name_or_file: str | Path) -> Study:
    """Read a study of the seat suspension.

    Parameters
    ----------
    name_or_file
        Name from :data:`SHIPPED`, or the path of a file in TOML.

    Returns
    -------
    Study
        The study, with the words of :class:`SeatVocabulary`.

    Raises
    ------
    SetupError
        With all problems found.
    """
    return Study.read(study_file(name_or_file), SeatVocabulary())
