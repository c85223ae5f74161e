"""Reading results, editing FMUs."""

from __future__ import annotations

import csv
import zipfile
from pathlib import Path

import numpy as np


def edited_text(text: str, old: str, new: str) -> str:
    """Replace a part of a text, which must occur."""
    assert old in text, f"expected {old!r} in the text"
    return text.replace(old, new)


def edited(fmu: Path, target: Path, *replacements: tuple[str, str]) -> Path:
    """Copy an FMU with another description."""
    with zipfile.ZipFile(fmu) as archive, zipfile.ZipFile(target, "w") as copy:
        for name in archive.namelist():
            content = archive.read(name)
            if name == "modelDescription.xml":
                text = content.decode()
                for old, new in replacements:
                    text = edited_text(text, old, new)
                content = text.encode()
            copy.writestr(name, content)
    return target


def read_csv(path: Path) -> dict[str, np.ndarray]:
    """Read columns of numbers by name."""
    with path.open(newline="", encoding="utf-8") as stream:
        names, *rows = csv.reader(stream)
    values = np.array([[float(cell) for cell in row] for row in rows]).reshape(len(rows), len(names))
    return dict(zip(names, values.T, strict=True))
