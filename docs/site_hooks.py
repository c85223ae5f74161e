"""Hooks of mkdocs: pages of files in the repository's root, links to files outside ``docs``, roles in docstrings.

Pages link to each other and to files of the repository by relative paths, which work in the repository as well. In the
site, a link to a file outside ``docs`` leads to the page that is made of it, see :data:`ROOT_PAGES`, or to the file in
the repository. A path that does not exist stays, so that a strict build fails.
"""

from __future__ import annotations

import posixpath
import re
from pathlib import Path
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT_PAGES = {
    "CHANGELOG.md": "reference/changelog.md",
    "CONTRIBUTING.md": "how-to/contributing.md",
    "NOMENCLATURE.md": "reference/nomenclature.md",
    "REFERENCES.md": "reference/references.md",
    "SECURITY.md": "reference/security.md",
}
"""File in the repository's root to the page that is made of it."""

_SOURCES = {page: name for name, page in ROOT_PAGES.items()}
_LINK = re.compile(r"(!?\[[^\]]*\]\()([^)\s#]+)(#[^)\s]*)?\)")
_CODE = re.compile(r"(^```.*?^```$|`[^`\n]+`)", re.MULTILINE | re.DOTALL)
_ROLE = re.compile(r":(?:attr|class|data|exc|func|meth|mod|obj):<code>~?([^<]+)</code>")


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages that are made of files in the repository's root."""
    root = Path(config.config_file_path).parent
    for name, page in ROOT_PAGES.items():
        files.append(File.generated(config, page, content=(root / name).read_text(encoding="utf-8")))
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Change links that lead out of ``docs``; code stays as it is."""
    root = Path(config.config_file_path).parent
    here = page.file.src_uri
    source = _SOURCES.get(here, f"docs/{here}")

    def redirected(match: re.Match[str]) -> str:
        text, target, anchor = match[1], match[2], match[3] or ""
        if "://" in target or target.startswith("mailto:"):
            return match[0]
        path = posixpath.normpath(posixpath.join(posixpath.dirname(source), target))
        inside = ROOT_PAGES.get(path, path.removeprefix("docs/"))
        if inside != path:
            return f"{text}{posixpath.relpath(inside, posixpath.dirname(here) or '.')}{anchor})"
        if path.startswith("..") or not (root / path).exists():
            return match[0]
        kind = "tree" if (root / path).is_dir() else "blob"
        return f"{text}{config.extra['repository']}/{kind}/main/{path}{anchor})"

    parts = _CODE.split(markdown)
    parts[::2] = [_LINK.sub(redirected, part) for part in parts[::2]]
    return "".join(parts)


def on_page_content(html: str, **_: Any) -> str:
    """Replace roles of docstrings such as ``:func:`` by a link, or by code where no page has the name."""
    return _ROLE.sub(r'<autoref identifier="\1" optional><code>\1</code></autoref>', html)
