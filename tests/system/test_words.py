"""Names and messages have the field's words: none of the private words that this project once had.

Identifiers are split at underscores and capitals, so that ``mended`` is found in ``is_mended`` and not in
``recommended``. The changelog, which says what the old names were, is exempt.
"""

from __future__ import annotations

import re
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.helpers.paths import ROOT

WORDS = (
    "complaint", "crank", "hygiene", "journal", "lab", "listening", "manners", "mend", "mended", "mending", "newcomer",
    "opinion", "reckons", "wondering",
)  # fmt: skip
"""Words that no identifier and no text has."""

PHRASES = (
    "is told", "are told", "is_told", "are_told", "passed over", "start anew", "nobody listens", "what comes of it",
)  # fmt: skip

EXEMPT = {
    "CHANGELOG.md",  # says what the old names were
    "REFERENCES.md",  # titles of journals
    "tests/system/test_words.py",
}

NAMES = ("structure.dependencies-told", "HVLab")
"""Ids of validate rules that users have in their scripts, and names of others' works."""

SUFFIXES = (".py", ".c", ".h", ".md", ".jinja", ".toml", ".yml")


def files() -> list[Path]:
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=False)
    if listed.returncode:
        pytest.skip("no git checkout")
    return [ROOT / name for name in listed.stdout.split() if name.endswith(SUFFIXES) and name not in EXEMPT]


def words(text: str) -> Iterator[str]:
    """Split a text into words, and its identifiers into theirs, in lower case."""
    for word in re.findall(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])", text):
        yield word.lower()


def test_identifiers_are_split():
    assert list(words("is_mended MessageLog XMLParser recommended")) == [
        "is", "mended", "message", "log", "xml", "parser", "recommended",
    ]  # fmt: skip


def test_no_file_has_a_word_of_the_old_vocabulary():
    found = []
    likely = re.compile("|".join((*WORDS, *PHRASES)), re.IGNORECASE)  # splitting every line takes seconds
    for path in files():
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            if not likely.search(line):
                continue
            for name in NAMES:
                line = line.replace(name, "")
            old = [word for word in WORDS if word in set(words(line))] + [p for p in PHRASES if p in line.lower()]
            if old:
                found.append(f"{path.relative_to(ROOT)}:{number}: {', '.join(old)}: {line.strip()[:100]}")
    assert not found, "\n".join(found)
