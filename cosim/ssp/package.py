"""Files of a system structure: an ``.ssp`` archive, or an ``.ssd`` file and its folder."""

from __future__ import annotations

import io
import zipfile
import zlib
from contextlib import suppress
from pathlib import Path
from posixpath import normpath
from urllib.parse import unquote, urlsplit

from cosim.errors import SetupError
from cosim.fmi.archive import is_file, is_unsafe_path, open_archive
from cosim.fmi.budgets import DocumentBudget
from cosim.fmi.description import ModelDescription

DESCRIPTION = "SystemStructure.ssd"
"""Name of the description in an archive."""

_DAMAGED = (zipfile.BadZipFile, zlib.error, RuntimeError, NotImplementedError, OSError, EOFError)
"""Exceptions of :mod:`zipfile` for archives that are damaged, encrypted, or compressed by an unknown method."""


def read_file(path: Path, expected: str) -> bytes:
    """Read a file that the user named.

    Parameters
    ----------
    path
        The file.
    expected
        What the file should be, in messages.

    Returns
    -------
    bytes
        The content of the file.

    Raises
    ------
    SetupError
        If the file cannot be read.
    """
    try:
        return path.read_bytes()
    except OSError as error:
        got = "no such file" if isinstance(error, FileNotFoundError) else error.strerror
        raise SetupError(f"{path}: expected {expected}, got {got}") from None


class Package:
    """The files of a system structure, read in place.

    Parameters
    ----------
    path
        The ``.ssp`` archive or the ``.ssd`` file.

    Attributes
    ----------
    where
        Name of the description in messages.

    Raises
    ------
    SetupError
        If there is no such file, or it is not an archive that can be extracted safely.
    """

    def __init__(self, path: str | Path) -> None:
        self._path = Path(path)
        self._members: frozenset[str] | None = None
        self._models: dict[str, ModelDescription] = {}
        self._budget: DocumentBudget | None = None
        if self._path.suffix.lower() == ".ssd":
            self.where = self._path
            return
        if not is_file(self._path):
            raise SetupError(f"{self._path}: expected a system structure (.ssp or .ssd), got no such file")
        try:
            with open_archive(self._path, self._path) as archive:
                self._members = frozenset(archive.namelist())
            self._budget = DocumentBudget(self._path.stat().st_size)
        except _DAMAGED:
            raise SetupError(f"{self._path}: expected an .ssp file (a zip archive), got another kind of file") from None
        self.where = self._path / DESCRIPTION

    def description(self) -> bytes:
        """Read the description of the system.

        Raises
        ------
        SetupError
            If there is none, or it cannot be read.
        """
        if self._members is None:
            return read_file(self._path, "a system structure")
        return self._member(DESCRIPTION)

    def read(self, uri: str) -> bytes:
        """Read a resource of the package.

        Parameters
        ----------
        uri
            URI of the resource, relative to the description.

        Returns
        -------
        bytes
            The content of the resource.

        Raises
        ------
        SetupError
            If the URI does not refer to a file in the package, or the file cannot be read.
        """
        name = self._name(uri)
        if self._members is None:
            return read_file(self._path.parent / name, f"a file, as {self.where.name} says")
        return self._member(name)

    def model(self, uri: str) -> ModelDescription:
        """Read the model description of an FMU.

        Parameters
        ----------
        uri
            URI of the FMU, relative to the description.

        Returns
        -------
        ModelDescription
            The description of the FMU.

        Raises
        ------
        SetupError
            If the URI does not refer to a file in the package, or the file is not an FMU that can be used.
        """
        name = self._name(uri)
        if name not in self._models:
            self._models[name] = self._read_model(name)
        return self._models[name]

    def _read_model(self, name: str) -> ModelDescription:
        if self._members is None:
            return ModelDescription.read(self._path.parent / name)
        self._check(name)
        try:
            return ModelDescription.read(self._path, name, self._budget)
        except _DAMAGED as error:
            raise SetupError(f"{self._path / name}: expected an archive that can be read, got: {error}") from None

    def read_in(self, archive: str, uri: str) -> tuple[bytes, str]:
        """Read a file inside a resource that is an archive.

        Parameters
        ----------
        archive
            URI of the archive, relative to the description.
        uri
            URI of the file, relative to the root of the archive.

        Returns
        -------
        tuple
            Content of the file, and its name in messages.

        Raises
        ------
        SetupError
            If a URI does not refer to a file, or it cannot be read.
        """
        name = self._name(uri)
        where = self.locate(archive) / name
        try:
            with open_archive(io.BytesIO(self.read(archive)), self.locate(archive)) as opened:
                self._spend(str(where), opened.getinfo(name).file_size)
                return opened.read(name), str(where)
        except KeyError:
            raise SetupError(f"{where}: expected a file in the archive, got none of that name") from None
        except _DAMAGED as error:
            raise SetupError(f"{where}: expected a file that can be read, got: {error}") from None

    def locate(self, uri: str) -> Path:
        """Return the name of a resource in messages.

        Parameters
        ----------
        uri
            URI of the resource, relative to the description.

        Raises
        ------
        SetupError
            If the URI does not refer to a file in the package.
        """
        return self.where.parent / self._name(uri)

    def _name(self, uri: str) -> str:
        """Return the path of the file to which a URI refers, relative to the package's folder, which it must not leave.

        The URI may be relative, or one of the scheme ``file`` without or with the path of the folder.
        """
        parts = urlsplit(uri)
        path = unquote(parts.path)
        if parts.scheme == "file" and path.startswith("/"):
            path = self._below_the_folder(path)
        name = normpath(path) if path else ""
        local = parts.scheme in ("", "file") and parts.netloc in ("", "localhost")
        if not local or parts.query or parts.fragment or name in ("", ".") or is_unsafe_path(name):
            raise SetupError(f"{self.where}: expected a source in the folder of the description, got {uri!r}")
        return name

    def _below_the_folder(self, path: str) -> str:
        """Return an absolute path relative to the folder of the description, absolute where it is not inside."""
        folder = Path(self.where.parent).absolute()
        with suppress(ValueError):
            return Path(normpath(path)).relative_to(normpath(folder)).as_posix() if self._members is None else path
        return path

    def _spend(self, where: str, size: int) -> None:
        if self._budget is not None:
            self._budget.spend(where, size)

    def _member(self, name: str) -> bytes:
        self._check(name)
        try:
            with zipfile.ZipFile(self._path) as archive:
                if not name.lower().endswith(".fmu"):  # those are no documents
                    self._spend(str(self._path / name), archive.getinfo(name).file_size)
                return archive.read(name)
        except _DAMAGED as error:
            raise SetupError(f"{self._path / name}: expected a file that can be read, got: {error}") from None

    def _check(self, name: str) -> None:
        if self._members is not None and name not in self._members:
            raise SetupError(f"{self._path / name}: expected a file in the archive, got none of that name")
