"""Docstrings of the public API: they exist, have a summary, and describe parameters and results in numpydoc's form.

ruff checks the style of docstrings (rules D), and where they have sections also the names of parameters (D417, DOC102).
Neither ruff nor numpydoc's validator can demand sections from a number of arguments on and accept one-line docstrings
below it, so this is checked here. The source is parsed, not imported.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

import pytest

from tests.helpers.paths import ROOT


@dataclass(frozen=True)
class Level:
    """What a package must reach; to be raised, not lowered.

    Attributes
    ----------
    short
        Number of public objects that may have no docstring, or a summary of three words or less.
    unnamed
        Number of docstrings that may not name exactly the arguments of their function.
    parameters
        Minimum share of the functions with arguments that have a section ``Parameters``.
    results
        Minimum share of the functions with such a section and a result that also describe the result.
    """

    short: int
    unnamed: int
    parameters: float
    results: float


LEVELS = {
    "cosim": Level(short=0, unnamed=0, parameters=0.97, results=1.0),
    "cosim.engine": Level(short=5, unnamed=7, parameters=0.68, results=0.56),
    "cosim.fmi": Level(short=4, unnamed=0, parameters=0.85, results=0.94),
    "fmus": Level(short=0, unnamed=0, parameters=0.96, results=1.0),
    "plant_models": Level(short=0, unnamed=0, parameters=0.95, results=1.0),
    "seat_controller_fmu": Level(short=0, unnamed=0, parameters=1.0, results=1.0),
    "seat_blocks": Level(short=0, unnamed=0, parameters=0.9, results=0.9),
    "seat_cosim": Level(short=0, unnamed=0, parameters=0.76, results=0.65),
}
"""Package, without the inner packages that are named as well, to its level."""

EXEMPT = {
    "rule": "the title of a rule of the conformance suite says what it checks",
    "command": "the docstring of a command is its help text, and click describes its options",
    "group": "as for a command",
}
"""Decorators of functions that are not checked, and why."""

LONGEST_SHORT_SUMMARY = 3
"""Words of a summary that is too short."""


@dataclass(frozen=True)
class Documented:
    """A public module, class, function or method.

    Attributes
    ----------
    name
        Its name with that of its module.
    docstring
        Empty where there is none.
    arguments
        Names of the arguments without ``self`` and ``cls``; None for modules and for classes without a constructor.
    has_result
        Whether its annotation says that it returns something.
    """

    name: str
    docstring: str
    arguments: tuple[str, ...] | None = None
    has_result: bool = False

    @property
    def summary(self) -> str:
        return self.docstring.strip().partition("\n")[0]

    def section(self, title: str) -> str | None:
        found = re.search(rf"^{title}\n-+\n(.*?)(?=\n\n\w+\n-+\n|\Z)", self.docstring, re.DOTALL | re.MULTILINE)
        return None if found is None else found[1]

    @property
    def parameters(self) -> list[str] | None:
        """The names in the section ``Parameters``; None where there is no such section."""
        section = self.section("Parameters")
        if section is None:
            return None
        lines = [line.partition(":")[0] for line in section.splitlines() if line and not line.startswith(" ")]
        return [name.strip().lstrip("*\\") for line in lines for name in line.split(",")]

    @property
    def names_its_arguments(self) -> bool:
        """Whether the section ``Parameters`` has exactly the arguments; it may be missing where there is only one."""
        if self.arguments is None:
            return True
        if self.parameters is None:
            return len(self.arguments) < 2
        return sorted(self.parameters) == sorted(self.arguments)

    @property
    def describes_its_result(self) -> bool:
        """Whether a section or the summary says what is returned."""
        return bool(re.match("Returns? |Yields? ", self.docstring) or self.section("Returns") or self.section("Yields"))


def _decorators(node: ast.FunctionDef) -> set[str]:
    """Return the last part of each decorator's name."""
    found = (d.func if isinstance(d, ast.Call) else d for d in node.decorator_list)
    return {d.attr if isinstance(d, ast.Attribute) else d.id for d in found if isinstance(d, ast.Attribute | ast.Name)}


def _is_checked(node: ast.FunctionDef) -> bool:
    return not node.name.startswith("_") and not _decorators(node) & {*EXEMPT, "setter", "overload"}


def _documented(name: str, node: ast.FunctionDef, is_method: bool = False) -> Documented:
    a = node.args
    bound = is_method and "staticmethod" not in _decorators(node)
    every = [*[*a.posonlyargs, *a.args][bound:], *filter(None, [a.vararg]), *a.kwonlyargs, *filter(None, [a.kwarg])]
    has_result = node.returns is not None and ast.unparse(node.returns) not in ("None", "Iterator[None]", "NoReturn")
    return Documented(name, ast.get_docstring(node) or "", tuple(argument.arg for argument in every), has_result)


class Source:
    """Parsed modules, whose public objects are listed.

    Parameters
    ----------
    modules
        Name of each module to its source text.
    """

    def __init__(self, modules: dict[str, str]) -> None:
        self._modules = {name: ast.parse(text) for name, text in modules.items()}
        nodes = (node for tree in self._modules.values() for node in tree.body)
        self._classes = {node.name: node for node in nodes if isinstance(node, ast.ClassDef)}

    def objects(self) -> Iterator[Documented]:
        for name, tree in self._modules.items():
            yield Documented(name, ast.get_docstring(tree) or "")
            for node in tree.body:
                if isinstance(node, ast.FunctionDef) and _is_checked(node):
                    yield _documented(f"{name}.{node.name}", node)
                elif isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                    yield from self._class(f"{name}.{node.name}", node)

    def _class(self, name: str, node: ast.ClassDef) -> Iterator[Documented]:
        methods = [child for child in node.body if isinstance(child, ast.FunctionDef)]
        constructor = next((_documented(name, method, True) for method in methods if method.name == "__init__"), None)
        yield Documented(name, ast.get_docstring(node) or "", constructor and constructor.arguments)
        for method in methods:
            if _is_checked(method) and (ast.get_docstring(method) or not self._is_inherited(method.name, node)):
                yield _documented(f"{name}.{method.name}", method, is_method=True)

    def _is_inherited(self, method: str, node: ast.ClassDef) -> bool:
        """Return whether a base class has a docstring of a method."""
        names = {base.id for base in node.bases if isinstance(base, ast.Name)}
        bases = [self._classes[name] for name in names & set(self._classes)]
        own = [child for base in bases for child in base.body if isinstance(child, ast.FunctionDef)]
        has_docstring = any(child.name == method and ast.get_docstring(child) for child in own)
        return has_docstring or any(self._is_inherited(method, base) for base in bases)


@cache
def documented(package: str) -> list[Documented]:
    """List the public objects of a package, without those of inner packages that have a level of their own."""
    top = package.partition(".")[0]
    folder = ROOT / top if (ROOT / top).exists() else ROOT / "src" / top
    modules = {
        ".".join(path.relative_to(folder.parent).with_suffix("").parts).removesuffix(".__init__"): path.read_text(
            "utf-8"
        )
        for path in sorted(folder.rglob("*.py"))
    }
    found = Source(modules).objects()
    return [
        each for each in found if max((p for p in LEVELS if f"{each.name}.".startswith(f"{p}.")), key=len) == package
    ]


def share(part: list[Documented], whole: list[Documented], what: str) -> float:
    """Return how many of some objects are in a part, and print it with those that are not."""
    missing = [each.name for each in whole if each not in part]
    print(*missing, f"{len(part)} of {len(whole)} functions {what}", sep="\n")
    return len(part) / len(whole)


@pytest.mark.parametrize("package", LEVELS)
def test_public_objects_have_a_summary(package: str):
    found = [each for each in documented(package) if len(each.summary.split()) <= LONGEST_SHORT_SUMMARY]
    print(*(f"{each.name}: {each.summary!r}" for each in found), sep="\n")
    assert len(found) <= LEVELS[package].short


@pytest.mark.parametrize("package", LEVELS)
def test_sections_name_the_arguments(package: str):
    found = [each for each in documented(package) if not each.names_its_arguments]
    print(*(f"{each.name}: arguments {each.arguments}, section {each.parameters}" for each in found), sep="\n")
    assert len(found) <= LEVELS[package].unnamed


@pytest.mark.parametrize("package", LEVELS)
def test_most_functions_describe_parameters_and_results(package: str):
    functions = [each for each in documented(package) if each.arguments]
    described = [each for each in functions if each.parameters is not None]
    assert share(described, functions, "with arguments describe them") >= LEVELS[package].parameters
    returning = [each for each in described if each.has_result]
    complete = [each for each in returning if each.describes_its_result]
    assert share(complete, returning, "with a result describe it") >= LEVELS[package].results


SAMPLE = '''
"""Short."""

def plain(a, b):
    """Add the first to the second."""

def wrong(a, *b, c=1) -> int:
    """Add all of the numbers.

    Parameters
    ----------
    a, *b
        The numbers.
    d : int
        Another one.
    """

class Base:
    """Base of some classes.

    Parameters
    ----------
    a
        The only argument.
    """

    def __init__(self, a): ...

    def method(self, a):
        """Do something with a number."""

class Derived(Base):
    """A class that inherits docstrings."""

    def method(self, a): ...

    def other(self, a): ...

    @rule("an id")
    def exempt(self, a): ...
'''


def test_faults_are_found():
    found = {each.name.removeprefix("sample"): each for each in Source({"sample": SAMPLE}).objects()}
    assert list(found) == ["", ".plain", ".wrong", ".Base", ".Base.method", ".Derived", ".Derived.other"]
    assert [name for name, each in found.items() if not each.names_its_arguments] == [".plain", ".wrong"]
    assert (found[".wrong"].arguments, found[".wrong"].parameters) == (("a", "b", "c"), ["a", "b", "d"])
    assert found[".wrong"].has_result
    assert not found[".wrong"].describes_its_result
    assert [name for name, each in found.items() if len(each.summary.split()) < 4] == ["", ".Derived.other"]
