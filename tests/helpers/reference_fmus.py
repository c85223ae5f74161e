"""FMUs like the public reference models, compiled from ``native/reference_fmu.c``, conforming or with one fault.

The library is compiled once for each version of FMI. A fault is selected by writing its name into the library's bytes.
"""

from __future__ import annotations

import zipfile
from collections.abc import Callable
from pathlib import Path

import fmpy

from tests.helpers.faulty import compile_library, library_member
from tests.helpers.paths import SOURCES

SOURCE = SOURCES / "reference_fmu.c"
MARKER = b"FAULT="
MODELS = ("dahlquist", "feedthrough", "stair")

_DAHLQUIST = (
    # name, reference, type in FMI 3, type in FMI 2, attributes of the variable, of its type
    ("x", 1, "Float64", "Real", 'causality="output" initial="exact"', 'unit="m" start="1"'),
    ("der(x)", 2, "Float64", "Real", "", 'unit="m/s" derivative="@1"'),
    ("k", 3, "Float64", "Real", 'causality="parameter" variability="fixed"', 'unit="1/s" start="1"'),
    ("u", 10, "Float64", "Real", 'causality="input"', 'start="0"'),
)

_FEEDTHROUGH = (
    ("real_tunable", 4, "Float64", "Real", 'causality="parameter" variability="tunable"', 'start="0"'),
    ("real_bounded", 5, "Float64", "Real", 'causality="parameter" variability="fixed"', 'min="0" max="4" start="2"'),
    ("real_in", 10, "Float64", "Real", 'causality="input"', 'start="0"'),
    ("real_out", 11, "Float64", "Real", 'causality="output"', 'min="-1000" max="1000"'),
    ("real_discrete_in", 12, "Float64", "Real", 'causality="input" variability="discrete"', 'start="0"'),
    ("real_discrete_out", 13, "Float64", "Real", 'causality="output" variability="discrete"', ""),
    ("whole_in", 14, "Int32", "Integer", 'causality="input" variability="discrete"', 'start="0"'),
    ("whole_out", 15, "Int32", "Integer", 'causality="output" variability="discrete"', ""),
    ("truth_in", 18, "Boolean", "Boolean", 'causality="input" variability="discrete"', 'start="false"'),
    ("truth_out", 19, "Boolean", "Boolean", 'causality="output" variability="discrete"', ""),
    ("choice_in", 20, "Enumeration", "Enumeration", 'causality="input" variability="discrete"', '%Option start="1"'),
    ("choice_out", 21, "Enumeration", "Enumeration", 'causality="output" variability="discrete"', "%Option"),
)

_TEXT_2 = (("text", 32, "", "String", 'causality="parameter" variability="fixed"', 'start="Set me!"'),)

_OF_SIZE = '<Dimension valueReference="38"/>'

_MORE_3 = (
    ("float_in", 22, "Float32", "", 'causality="input"', 'start="0"'),
    ("float_out", 23, "Float32", "", 'causality="output"', ""),
    ("small_in", 24, "UInt8", "", 'causality="input" variability="discrete"', 'start="0"'),
    ("small_out", 25, "UInt8", "", 'causality="output" variability="discrete"', ""),
    ("large_in", 26, "Int64", "", 'causality="input" variability="discrete"', 'start="0"'),
    ("large_out", 27, "Int64", "", 'causality="output" variability="discrete"', ""),
    ("text_in", 32, "String", "", 'causality="input"', '<Start value="Set me!"/>'),
    ("text_out", 33, "String", "", 'causality="output"', ""),
    ("bytes_in", 34, "Binary", "", 'causality="input"', '<Start value="666f6f"/>'),
    ("bytes_out", 35, "Binary", "", 'causality="output"', ""),
    ("pair_out", 36, "Float64", "", 'causality="output"', '<Dimension start="2"/>'),
    ("gains", 37, "Float64", "", 'causality="parameter" variability="fixed" start="1 2 3"', _OF_SIZE),
    ("size", 38, "UInt64", "", 'causality="structuralParameter" variability="fixed"', 'start="3"'),
)

_STAIR = (
    ("counter", 30, "Int32", "Integer", 'causality="output" variability="discrete" initial="exact"', 'start="1"'),
)

_UNITS = """<UnitDefinitions>
  <Unit name="m"><BaseUnit m="1"/><DisplayUnit name="mm" factor="1000"/></Unit>
  <Unit name="m/s"><BaseUnit m="1" s="-1"/></Unit>
  <Unit name="1/s"><BaseUnit s="-1"/></Unit>
</UnitDefinitions>"""

_TYPES = {
    2: '<TypeDefinitions><SimpleType name="Option"><Enumeration>{}</Enumeration></SimpleType></TypeDefinitions>',
    3: '<TypeDefinitions><EnumerationType name="Option">{}</EnumerationType></TypeDefinitions>',
}
_ITEMS = '<Item name="one" value="1"/><Item name="two" value="2"/>'
_STATE = {2: "state", 3: "State"}


def description(model: str, fmi: int) -> str:
    """Return a model's description; dependencies are indices in FMI 2.0 and value references in FMI 3.0."""
    rows = {"dahlquist": _DAHLQUIST, "feedthrough": _FEEDTHROUGH, "stair": _STAIR}[model]
    rows += {2: _TEXT_2, 3: _MORE_3}[fmi] if model == "feedthrough" else ()
    place = {name: i if fmi == 2 else reference for i, (name, reference, *_) in enumerate(rows, 2)}
    capabilities = f'canHandleVariableCommunicationStepSize="true" canGetAndSetFMU{_STATE[fmi]}="true"'
    capabilities += f' canSerializeFMU{_STATE[fmi]}="true"' + (' fixedInternalStepSize="0.1"' if fmi == 3 else "")
    token = f'{"guid" if fmi == 2 else "instantiationToken"}="{{{model}}}"'
    parts = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<fmiModelDescription fmiVersion="{fmi}.0" modelName="{model}" {token}>',
        f'<CoSimulation modelIdentifier="reference" {capabilities}/>',
        _UNITS if model == "dahlquist" else "",
        _TYPES[fmi].format(_ITEMS) if model == "feedthrough" else "",
        '<LogCategories><Category name="logStatusError"/></LogCategories>',
        '<DefaultExperiment startTime="0" stopTime="10" stepSize="0.1"/>',
        "<ModelVariables>",
        _variable(fmi, "time", 0, "Float64", "Real", 'causality="independent" variability="continuous"', ""),
        *(_variable(fmi, *row[:5], _with_references(row[5], place)) for row in rows),
        "</ModelVariables>",
        *_structure(fmi, rows, place),
        "</fmiModelDescription>",
    ]
    return "\n".join(part for part in parts if part) + "\n"


def _with_references(text: str, place: dict[str, int]) -> str:
    return text.replace("@1", str(place.get("x", 0))).replace("%Option", 'declaredType="Option"')


def _variable(fmi: int, name: str, reference: int, kind3: str, kind2: str, outer: str, inner: str) -> str:
    if fmi == 2:
        return (
            f'  <ScalarVariable name="{name}" valueReference="{reference}" {outer}><{kind2} {inner}/></ScalarVariable>'
        )
    if inner.startswith("<"):
        return f'  <{kind3} name="{name}" valueReference="{reference}" {outer}>{inner}</{kind3}>'
    return f'  <{kind3} name="{name}" valueReference="{reference}" {outer} {inner}/>'


def _structure(fmi: int, rows: tuple[tuple[str, int, str, str, str, str], ...], place: dict[str, int]) -> list[str]:
    """Return the model structure: outputs and their dependencies, derivatives, initial unknowns."""
    names = [row[0] for row in rows]
    found: dict[str, list[str]] = {"Output": [], "Derivative": [], "InitialUnknown": []}
    key = "index" if fmi == 2 else "valueReference"
    for name, _, _, _, outer, inner in rows:
        source = name.replace("_out", "_in") if name.replace("_out", "_in") in names else "real_in"
        depends = f' dependencies="{place[source]}"' if "_out" in name else ' dependencies=""'
        if "output" in outer:
            found["Output"].append(f'{key}="{place[name]}"{depends}')
            if "exact" not in outer:
                found["InitialUnknown"].append(f'{key}="{place[name]}"{depends}')
        if "derivative" in inner:
            found["Derivative"].append(f'{key}="{place[name]}" dependencies="{place["x"]}"')
            found["InitialUnknown"].append(f'{key}="{place[name]}" dependencies="{place["x"]} {place["k"]}"')
    if fmi == 3:
        elements = {"Derivative": "ContinuousStateDerivative"}
        listed = [f"<{elements.get(what, what)} {each}/>" for what, entries in found.items() for each in entries]
    else:
        listed = [
            f"<{what}s>{''.join(f'<Unknown {each}/>' for each in entries)}</{what}s>"
            for what, entries in found.items()
            if entries
        ]
    return ["<ModelStructure>", *listed, "</ModelStructure>"]


class ReferenceFmus:
    """Builds reference FMUs in a folder; compiles each library once.

    Parameters
    ----------
    folder
        Where the files are written.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def library(self, fmi: int) -> bytes:
        """Return the bytes of the library for a major version of FMI."""
        path = self.folder / f"reference{fmi}{fmpy.sharedLibraryExtension}"
        if not path.exists():
            compile_library(SOURCE, path, f"-DFMI={fmi}")
        return path.read_bytes()

    def make(
        self,
        model: str = "dahlquist",
        fmi: int = 2,
        fault: str = "none",
        xml: Callable[[str], str] = lambda text: text,
        binary: Callable[[bytes], bytes] = lambda content: content,
        archive: Callable[[dict[str, bytes]], dict[str, bytes]] = lambda members: members,
    ) -> Path:
        """Build an FMU.

        Parameters
        ----------
        model
            One of :data:`MODELS`.
        fmi
            Major version of FMI.
        fault
            Name of the library's fault.
        xml, binary, archive
            Functions that change the description, the library and the archive's members.

        Returns
        -------
        Path
            The FMU.
        """
        library = self.library(fmi)
        at = library.index(MARKER) + len(MARKER)
        library = library[:at] + fault.encode().ljust(20) + library[at + 20 :]
        members = archive(
            {
                "modelDescription.xml": xml(description(model, fmi)).encode(),
                library_member("reference", fmi): binary(library),
            }
        )
        path = self.folder / f"{model}{fmi}-{len(list(self.folder.iterdir()))}.fmu"
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
            for name, content in members.items():
                file.writestr(name, content)
        return path
