"""An FMU as files: its archive, and the description in it, read without judging."""

from __future__ import annotations

import zipfile
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path, PurePosixPath
from typing import Any

from lxml import etree

from cosim.conformance.model_description import Description, describe
from cosim.errors import SetupError
from cosim.fmi.archive import check_archive, size_problems
from cosim.fmi.repairs import DESCRIPTION


@dataclass
class Subject:
    """An FMU under examination.

    Attributes
    ----------
    path
        The file.
    """

    path: Path
    _cache: dict[str, Any] = field(default_factory=dict, repr=False)

    @cached_property
    def archive(self) -> zipfile.ZipFile | None:
        """The open archive; None of a file that is none."""
        try:
            return zipfile.ZipFile(self.path)
        except (zipfile.BadZipFile, OSError, ValueError, NotImplementedError):
            return None

    @property
    def members(self) -> list[zipfile.ZipInfo]:
        """All members, folders among them."""
        return self.archive.infolist() if self.archive else []

    @cached_property
    def size_problems(self) -> list[str]:
        """What is wrong with the size of what the archive holds."""
        return list(size_problems(self.archive)) if self.archive else []

    @cached_property
    def files(self) -> dict[PurePosixPath, zipfile.ZipInfo]:
        """Members that are files, by path."""
        return {PurePosixPath(member.filename): member for member in self.members if not member.is_dir()}

    def under(self, folder: str) -> dict[PurePosixPath, zipfile.ZipInfo]:
        """Return the files in a folder, by path relative to it."""
        return {path.relative_to(folder): member for path, member in self.files.items() if path.is_relative_to(folder)}

    def head(self, member: zipfile.ZipInfo, size: int) -> bytes:
        """Read a file's first bytes."""
        assert self.archive is not None
        try:
            with self.archive.open(member) as stream:
                return stream.read(size)
        except Exception:  # damage is another rule's business
            return b""

    @cached_property
    def text(self) -> bytes | None:
        """The description's bytes; None where it is missing, cannot be read, or may have no end."""
        if self.size_problems:
            return None
        try:
            assert self.archive is not None
            return self.archive.read(DESCRIPTION)
        except Exception:
            return None

    @cached_property
    def problem(self) -> str:
        """Why the description cannot be read; empty where it can."""
        if self.text is None:
            return f"expected a readable {DESCRIPTION}, got none"
        try:
            self._cache["tree"] = etree.fromstring(self.text, etree.XMLParser(resolve_entities=False, no_network=True))
        except etree.XMLSyntaxError as error:
            return f"{DESCRIPTION}: expected well-formed XML, got: {error}"
        return ""

    @property
    def tree(self) -> Any:
        """The description's root element; None where it cannot be read."""
        return None if self.problem else self._cache["tree"]

    @cached_property
    def description(self) -> Description | None:
        """The description, read without judging; None of one that cannot be read or of another standard."""
        return None if self.tree is None else describe(self.tree)

    @cached_property
    def unsafe(self) -> str:
        """Why the archive cannot be extracted; empty where it can."""
        if self.archive is None:
            return "it is no archive"
        try:
            check_archive(self.archive, self.path)
        except SetupError as error:
            return str(error)
        return ""

    def extract(self, folder: Path) -> None:
        """Extract the archive.

        Raises
        ------
        SetupError
            If that is not safe, or fails.
        """
        if self.unsafe or self.archive is None:
            raise SetupError(self.unsafe)
        try:
            self.archive.extractall(folder)
        except Exception as error:  # whatever zipfile stumbles over
            raise SetupError(f"{self.path}: expected an archive that can be extracted, got: {error}") from error

    def close(self) -> None:
        """Close the archive."""
        if self.archive:
            self.archive.close()
