"""An FMU as files: its archive and its model description, read leniently."""

from __future__ import annotations

import zipfile
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path, PurePosixPath
from typing import Any

from lxml import etree

from cosim.conformance.model_description import RawDescription, read_raw_description
from cosim.errors import SetupError
from cosim.fmi.archive import check_archive, size_problems
from cosim.fmi.repairs import DESCRIPTION
from cosim.fmi.xml import safe_parser


@dataclass
class FmuArchive:
    """The files of an FMU that is validated.

    Attributes
    ----------
    path
        The ``.fmu`` file.
    """

    path: Path

    @cached_property
    def zip_file(self) -> zipfile.ZipFile | None:
        """The open archive; None where the file is not a zip archive."""
        try:
            return zipfile.ZipFile(self.path)
        except (zipfile.BadZipFile, OSError, ValueError, NotImplementedError):
            return None

    @property
    def members(self) -> list[zipfile.ZipInfo]:
        """All members, including folders."""
        return self.zip_file.infolist() if self.zip_file else []

    @cached_property
    def size_problems(self) -> list[str]:
        """Problems with the extracted size of the archive."""
        return list(size_problems(self.zip_file)) if self.zip_file else []

    @cached_property
    def files(self) -> dict[PurePosixPath, zipfile.ZipInfo]:
        """Path to member, for the members that are files."""
        return {PurePosixPath(member.filename): member for member in self.members if not member.is_dir()}

    def files_under(self, folder: str) -> dict[PurePosixPath, zipfile.ZipInfo]:
        """Return the files in a folder of the archive.

        Parameters
        ----------
        folder
            Path of the folder.

        Returns
        -------
        dict
            Path relative to the folder, to member.
        """
        return {path.relative_to(folder): member for path, member in self.files.items() if path.is_relative_to(folder)}

    def first_bytes(self, member: zipfile.ZipInfo, size: int) -> bytes:
        """Read the beginning of a file.

        Parameters
        ----------
        member
            The file.
        size
            How many bytes to read at most.

        Returns
        -------
        bytes
            Empty for a damaged member, which the rule ``archive.readable`` reports.
        """
        assert self.zip_file is not None
        try:
            with self.zip_file.open(member) as stream:
                return stream.read(size)
        except Exception:  # zipfile raises exceptions of many types for damaged archives
            return b""

    @cached_property
    def description_bytes(self) -> bytes | None:
        """Content of the model description; None where it cannot be read or the archive is too large."""
        if self.size_problems:
            return None
        try:
            assert self.zip_file is not None
            return self.zip_file.read(DESCRIPTION)
        except Exception:  # zipfile raises exceptions of many types for damaged archives
            return None

    @cached_property
    def _parsed(self) -> tuple[Any, str]:
        """Root element of the description or None, and why it cannot be read."""
        if self.description_bytes is None:
            return None, f"expected a readable {DESCRIPTION}, got none"
        try:
            return etree.fromstring(self.description_bytes, safe_parser()), ""
        except etree.XMLSyntaxError as error:
            return None, f"{DESCRIPTION}: expected well-formed XML, got: {error}"

    @property
    def description_problem(self) -> str:
        """Why the model description cannot be read; empty where it can."""
        return self._parsed[1]

    @property
    def description_root(self) -> Any:
        """Root element of the model description; None where it cannot be read."""
        return self._parsed[0]

    @cached_property
    def description(self) -> RawDescription | None:
        """The model description; None where it cannot be read or is not of FMI 2.0 or 3.0."""
        return None if self.description_root is None else read_raw_description(self.description_root)

    @cached_property
    def extraction_problem(self) -> str:
        """Why the archive cannot be extracted safely; empty where it can."""
        if self.zip_file is None:
            return "it is no archive"
        try:
            check_archive(self.zip_file, self.path)
        except SetupError as error:
            return str(error)
        return ""

    def extract(self, folder: Path) -> None:
        """Extract the archive into a folder.

        Parameters
        ----------
        folder
            An existing folder.

        Raises
        ------
        SetupError
            If the archive is unsafe or damaged.
        """
        if self.extraction_problem or self.zip_file is None:
            raise SetupError(self.extraction_problem)
        try:
            self.zip_file.extractall(folder)
        except Exception as error:  # zipfile raises exceptions of many types for damaged archives
            raise SetupError(f"{self.path}: expected an archive that can be extracted, got: {error}") from error

    def close(self) -> None:
        """Close the archive, if it was opened."""
        if self.zip_file:
            self.zip_file.close()
