"""Small FMUs as they are found in the wild: a test writes down variables and a few lines of C, and gets an FMU.

The lines see the instance as ``m``: variables as arrays by their names (``m->y[0]``), what the host says as ``m->run``.
"""

from __future__ import annotations

import re
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from xml.sax.saxutils import quoteattr

import fmpy
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave

from tests.helpers.faulty import compile_library, library_member
from tests.helpers.paths import SOURCES

C_TYPES = {
    "Real": "double",
    "Float32": "float",
    "Integer": "int",
    **{f"{sign}Int{bits}": f"{sign.lower()}int{bits}_t" for sign in ("", "U") for bits in (8, 16, 32, 64)},
    "String": "Text",
}
INDEPENDENT = '<Float64 name="time" valueReference="0" causality="independent" variability="continuous"/>'
"""The variable that FMI 3 demands."""

LARGEST = 64
"""Room for elements of an array whose size is a parameter."""


@dataclass(frozen=True)
class Var:
    """A variable of a test's FMU.

    Attributes
    ----------
    name, type, causality
        As in the description; a Float64 is called Real in both versions.
    start
        Text of its start value.
    shape
        Sizes, or names of structural parameters.
    depends, initially
        Names of what an output depends on in a step and in initialization mode; None where that is not declared.
    aliases
        Further names (FMI 3).
    more
        Attributes as they stand in the description: of the variable in FMI 3, of its type's element in FMI 2.
    """

    name: str
    type: str = "Real"
    causality: str = "output"
    start: str | None = None
    variability: str | None = None
    initial: str | None = None
    shape: tuple[int | str, ...] = ()
    depends: tuple[str, ...] | None = None
    initially: tuple[str, ...] | None = None
    aliases: tuple[str, ...] = ()
    more: str = ""

    @property
    def c_name(self) -> str:
        """Its name in C."""
        return re.sub(r"\W", "_", self.name)


def var_in(name: str, type_: str = "Real", start: str | None = "0", **more: object) -> Var:
    """Make an input."""
    return Var(name, type_, "input", start, **more)  # type: ignore[arg-type]


def par(name: str, type_: str = "Real", start: str | None = "0", **more: object) -> Var:
    """Make a fixed parameter."""
    return Var(name, type_, "parameter", start, "fixed", **more)  # type: ignore[arg-type]


@dataclass(frozen=True)
class Wild:
    """An FMU.

    Attributes
    ----------
    variables
        In order; value references count from 1.
    calculate, advance, enter, assigned, begin
        Lines of C: before each get, in a step from ``time`` by ``h``, on entering initialization mode, after each set,
        at instantiation and reset. They may ``return report(&m->run, ERROR, "why")``.
    interface, experiment
        Attributes of ``CoSimulation`` and of ``DefaultExperiment``.
    before
        Elements before the variables: units, types.
    after
        Elements after the model structure.
    top
        C before all functions.
    """

    variables: Sequence[Var]
    calculate: str = ""
    advance: str = ""
    enter: str = ""
    assigned: str = ""
    begin: str = ""
    interface: str = 'canHandleVariableCommunicationStepSize="true"'
    experiment: str = ""
    before: str = ""
    after: str = ""
    top: str = ""
    tool: str = "wild"
    token: str = "{wild}"
    extra: dict[str, bytes] = field(default_factory=dict)

    def build(self, path: Path, version: int = 2) -> Path:
        """Write the FMU for a major version of FMI."""
        members = {
            "modelDescription.xml": self.description(version).encode(),
            library_member("wild", version): self._compile(version, path.parent),
            **self.extra,
        }
        with zipfile.ZipFile(path, "w") as archive:
            for name, content in members.items():
                archive.writestr(name, content)
        return path

    # ---- C -----------------------------------------------------------------------------------------------------------

    def _compile(self, version: int, folder: Path) -> bytes:
        (folder / "model.h").write_text(self._header(version))
        library = folder / f"wild{fmpy.sharedLibraryExtension}"
        stubs = str(_stubs(version, folder))
        compile_library(SOURCES / "wild.c", library, "-O0", "-w", f"-DFMI={version}", f"-I{folder}", stubs)
        return library.read_bytes()

    def _header(self, version: int) -> str:
        names = {v.name: v.c_name for v in self.variables}
        lines = ["struct Model { Run run;"]
        for v in self.variables:
            capacity = LARGEST if any(isinstance(n, str) for n in v.shape) else _product(v.shape)
            lines.append(f"  {self._c_type(v, version)} {v.c_name}[{capacity}];")
        lines.append("};")
        lines.append(self.top)
        for v in self.variables:
            sizes = [str(n) if isinstance(n, int) else f"(size_t)m->{names[n]}[0]" for n in v.shape]
            lines.append(f"static size_t count_{v.c_name}(const Model *m) {{ return {' * '.join(sizes) or '1'}; }}")
        lines.append("static const Variable variables[] = {")
        for i, v in enumerate(self.variables, 1):
            lines.append(f"  {{{i}, {self._access(v, version)}, offsetof(Model, {v.c_name}), count_{v.c_name}}},")
        lines.append("};")
        lines.append(f"static void start(Model *m) {{ {self._starts()} {self.begin} }}")
        lines.append(f"static Status calculate(Model *m) {{ {self.calculate} return F(OK); }}")
        lines.append(f"static Status assigned(Model *m) {{ {self.assigned} return F(OK); }}")
        lines.append(f"static Status enter(Model *m) {{ {self.enter} return F(OK); }}")
        lines.append(f"static Status advance(Model *m, double time, double h) {{ {self.advance} return F(OK); }}")
        return "\n".join(lines) + "\n"

    @staticmethod
    def _access(v: Var, version: int) -> str:
        return {"Enumeration": "Integer" if version == 2 else "Int64"}.get(v.type, v.type)

    def _c_type(self, v: Var, version: int) -> str:
        access = self._access(v, version)
        return {"Boolean": "int" if version == 2 else "bool"}.get(access) or C_TYPES[access]

    def _starts(self) -> str:
        lines = []
        for v in self.variables:
            if v.start is not None and v.type == "String":
                lines.append(f'm->{v.c_name}[0] = "{v.start}";')
            elif v.start is not None:
                words = v.start.split()
                lines += [f"m->{v.c_name}[{i}] = {word};" for i, word in enumerate(words)]
                if len(words) == 1 and v.shape:
                    lines.append(f"for (int i = 1; i < sizeof m->{v.c_name} / sizeof *m->{v.c_name}; ++i) "
                                 f"m->{v.c_name}[i] = {words[0]};")  # fmt: skip
            elif v.type == "String":
                lines.append(f'm->{v.c_name}[0] = "";')
        return " ".join(lines)

    # ---- XML ---------------------------------------------------------------------------------------------------------

    def description(self, version: int) -> str:
        """Write the ``modelDescription.xml``."""
        token = {2: "guid", 3: "instantiationToken"}[version]
        experiment = f"<DefaultExperiment {self.experiment}/>" if self.experiment else ""
        return "\n".join((
            '<?xml version="1.0" encoding="UTF-8"?>',
            f'<fmiModelDescription fmiVersion="{version}.0" modelName="wild" {token}="{self.token}" '
            f'generationTool="{self.tool}">',
            f'<CoSimulation modelIdentifier="wild" {self.interface}/>{self.before}{experiment}',
            "<ModelVariables>",
            INDEPENDENT if version == 3 else "",
            *(self._variable(v, i, version) for i, v in enumerate(self.variables, 1)),
            f"</ModelVariables><ModelStructure>{self._structure(version)}</ModelStructure>{self.after}",
            "</fmiModelDescription>",
        ))  # fmt: skip

    def _variable(self, v: Var, reference: int, version: int) -> str:
        common = f'name={quoteattr(v.name)} valueReference="{reference}" causality="{v.causality}"'
        for key in ("variability", "initial"):
            if getattr(v, key) is not None:
                common += f' {key}="{getattr(v, key)}"'
        start = f" start={quoteattr(v.start)}" if v.start is not None else ""
        if version == 2:
            return f"<ScalarVariable {common}><{v.type}{start} {v.more}/></ScalarVariable>"
        names = {other.name: i for i, other in enumerate(self.variables, 1)}
        inner = "".join(
            f'<Dimension start="{n}"/>' if isinstance(n, int) else f'<Dimension valueReference="{names[n]}"/>'
            for n in v.shape
        )
        if v.type == "String" and v.start is not None:
            inner, start = f"{inner}<Start value={quoteattr(v.start)}/>", ""
        inner += "".join(f"<Alias name={quoteattr(alias)}/>" for alias in v.aliases)
        kind = {"Real": "Float64"}.get(v.type, v.type)
        return f"<{kind} {common}{start} {v.more}>{inner}</{kind}>"

    def _structure(self, version: int) -> str:
        places = {v.name: i for i, v in enumerate(self.variables, 1)}
        key = {2: "index", 3: "valueReference"}[version]

        def unknown(name: str, depends: tuple[str, ...] | None) -> str:
            listed = "" if depends is None else f' dependencies="{" ".join(str(places[d]) for d in depends)}"'
            return f'{key}="{places[name]}"{listed}'

        outputs = [v for v in self.variables if v.causality == "output"]
        steps = [unknown(v.name, v.depends) for v in outputs]
        initially = [unknown(v.name, v.initially) for v in outputs if v.initial != "exact"]
        if version == 3:
            return "".join([*(f"<Output {each}/>" for each in steps), *(f"<InitialUnknown {e}/>" for e in initially)])
        parts = (("Outputs", steps), ("InitialUnknowns", initially))
        return "".join(
            f"<{name}>{''.join(f'<Unknown {each}/>' for each in found)}</{name}>" for name, found in parts if found
        )


def _product(shape: Sequence[int | str]) -> int:
    found = 1
    for size in shape:
        found *= int(size)
    return max(found, 1)


@cache
def _stub_source(version: int) -> str:
    slave = {2: FMU2Slave, 3: FMU3Slave}[version]
    written = set(re.findall(rf"\bfmi{version}\w+(?=\()", (SOURCES / "wild.c").read_text()))
    written |= {f"fmi{version}{direction}{name}" for direction in ("Get", "Set") for name in _accesses(version)}
    names = {name for name in dir(slave) if name.startswith(f"fmi{version}")} - written
    return "".join(f"int {name}(void) {{ return 0; }}\n" for name in sorted(names))


def _accesses(version: int) -> list[str]:
    reals = ["Real"] if version == 2 else ["Float64"]
    return [*reals, *C_TYPES, "Boolean"]


def _stubs(version: int, folder: Path) -> Path:
    """Write the functions that the frame lacks and fmpy looks for."""
    path = folder / f"stubs{version}.c"
    path.write_text(_stub_source(version))
    return path
