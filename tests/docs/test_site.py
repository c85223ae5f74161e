"""The documentation site builds strictly and fetches nothing; every link, path and name of code leads somewhere."""

from __future__ import annotations

import importlib
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest

from tests.helpers.paths import ROOT

PAGES = [*sorted((ROOT / "docs").rglob("*.md")), *sorted(ROOT.glob("*.md")), *sorted((ROOT / "examples").rglob("*.md"))]

CODE = re.compile(r"(?<!`)`([^`\n]+)`(?!`)")
PATH = re.compile(
    r"(?:benchmarks|cosim|docs|examples|fmus|plant_models|seat_blocks|seat_cosim|src|studies|tests)/[\w./-]+"
)
NAME = re.compile(r"(?:cosim|fmus|plant_models|seat_blocks|seat_controller_fmu|seat_cosim)(?:\.[A-Za-z]\w*)+")
BUILT = re.compile(r"fmus/(?:fmi2|fmi3|python|built|SeatSuspension|\*)|docs/(?:tutorial|how-to|reference|explanation)$")
"""Paths of files that a build makes, and folders."""

OTHERS = ("plant_models/mount/", "plant_models/parameter_sets/NAME.ssv", "tests/plant_models/mount/")
"""Paths of examples."""


class Page(HTMLParser):
    """What a page of the site loads, links to, and offers as anchors."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.loads: list[str] = []
        self.links: list[str] = []
        self.anchors: set[str] = set()
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = {name: value or "" for name, value in attrs}
        self.anchors.update(filter(None, (given.get("id"), given.get("name"))))
        if tag == "a" and "href" in given:
            self.links.append(given["href"])
        elif tag == "link" and given.get("rel") != "canonical":
            self.loads.append(given["href"])
        elif "src" in given:
            self.loads.append(given["src"])


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> dict[Path, Page]:
    """The pages of the site, by path, built strictly."""
    folder = tmp_path_factory.mktemp("site").resolve()
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(folder)]
    environment = {**os.environ, "NO_MKDOCS_2_WARNING": "1"}
    built = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert (built.returncode, built.stdout + built.stderr) == (0, "")
    return {path: Page(path) for path in folder.rglob("*.html")}


def test_nothing_is_fetched_from_elsewhere(site: dict[Path, Page]):
    loads = {url for page in site.values() for url in page.loads}
    assert len(site) > 50
    assert not [url for url in loads if urlsplit(url).netloc]


def test_every_link_of_the_site_leads_somewhere(site: dict[Path, Page]):
    lost = []
    for path, page in site.items():
        for link in [*page.links, *page.loads]:
            url = urlsplit(link)
            if url.scheme or url.netloc or path.name == "404.html":
                continue
            target = (path.parent / unquote(url.path)).resolve() if url.path else path
            if not target.exists() or (
                url.fragment and target in site and unquote(url.fragment) not in {*site[target].anchors, "__top"}
            ):
                lost.append(f"{path.name}: {link}")
    assert not lost


def named(pattern: re.Pattern[str]) -> Iterator[tuple[Path, str]]:
    """Yield what pages name as code."""
    for page in PAGES:
        if page.name in ("CHANGELOG.md", "README.md"):
            continue
        for code in CODE.findall(re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)):
            if pattern.fullmatch(code):
                yield page, code


def test_every_path_that_a_page_names_is_there():
    found = list(named(PATH))
    assert len(found) > 60
    for page, path in found:
        if not BUILT.match(path) and path not in OTHERS:
            assert (ROOT / path).exists(), f"{page.relative_to(ROOT)}: {path}"


def test_every_name_of_code_that_a_page_names_is_there():
    found = {name: page for page, name in named(NAME)}
    assert len(found) > 15
    for name, page in found.items():
        parts = name.split(".")
        for cut in range(len(parts), 0, -1):
            try:
                thing = importlib.import_module(".".join(parts[:cut]))
            except ModuleNotFoundError:
                continue
            for part in parts[cut:]:
                assert hasattr(thing, part), f"{page.relative_to(ROOT)}: {name}"
                thing = getattr(thing, part)
            break
        else:
            raise AssertionError(f"{page.relative_to(ROOT)}: {name}")
