"""Broken FMUs with one planted fault each: the intended rule finds it, and no other rule finds anything."""

from __future__ import annotations

import io
import stat
import zipfile
from collections.abc import Callable
from pathlib import Path

import fmpy
import pytest

from cosim.conformance.process import RuleRunner
from cosim.conformance.suite import load_rules, validate
from cosim.errors import RunError
from tests.helpers.reference_fmus import ReferenceFmus

FILES_ONLY = [rule.id for rule in load_rules().values() if rule.stage != "behaviour"]
SUFFIX = fmpy.sharedLibraryExtension
Members = dict[str, bytes]


def found_in(path: Path) -> dict[str, list[str]]:
    """Apply the rules on files; rule to messages."""
    found: dict[str, list[str]] = {}
    for finding in validate(path, only=FILES_ONLY).findings:
        found.setdefault(finding.rule, []).append(finding.message)
    return found


def replaced(change: tuple[str, ...]) -> Callable[[str], str]:
    """Return a function that replaces the first text by the second, the third by the fourth, ..., once each."""

    def replace(text: str) -> str:
        for old, new in zip(change[::2], change[1::2], strict=True):
            assert old in text, old
            text = text.replace(old, new, 1)
        return text

    return replace


# ---- descriptions ----------------------------------------------------------------------------------------------------

ONE_MORE = "</ModelVariables>"
TICK = f'<Clock name="tick" valueReference="50" causality="input" intervalVariability="constant" {{}}/>{ONE_MORE}'
EVENTS = ("canHandleVariable", 'hasEventMode="true" canHandleVariable')
L_3 = '<TypeDefinitions><Float64Type name="L" unit="m" relativeQuantity="true"/></TypeDefinitions><LogCategories>'


def scalar(reference: int, attributes: str, start: str = "") -> str:
    """Return a real variable of FMI 2.0, at the end of the variables."""
    variable = f'<ScalarVariable name="c{start}" valueReference="{reference}" {attributes}>'
    value = f'start="{start}"' if start else ""
    return f"{variable}<Real {value}/></ScalarVariable>{ONE_MORE}"


def clock(attributes: str, old: str = "") -> str:
    """Return a clock of FMI 3.0, at the end of the variables; a periodic one of 0.1 s with other attributes."""
    return TICK.format(attributes) if not old else TICK.format('intervalDecimal="0.1"').replace(old, attributes)


DESCRIPTIONS = [
    # rule, model, FMI, text and replacement in pairs, part of the message
    ("description.readable", "stair", 2, ("</fmiModelDescription>", ""), "well-formed XML"),
    ("description.version", "stair", 2, ('fmiVersion="2.0"', 'fmiVersion="1.0"'), "expected 2.0 or 3.0, got 1.0"),
    ("description.schema", "stair", 2, (' modelName="stair"', ""), "modelName"),
    ("description.schema", "stair", 3, ("<LogCategories>", "<LogCategories/><LogCategories>"), "LogCategories"),
    (
        "description.identifier",
        "stair",
        2,
        ("<CoSimulation", '<ModelExchange modelIdentifier="1st-model"/><CoSimulation'),
        "1st-model",
    ),
    ("description.token", "stair", 2, ('guid="{stair}"', 'guid=""'), "guid: expected a unique text"),
    ("description.token", "stair", 3, ('Token="{stair}"', 'Token=" {stair}"'), "no space around it"),
    ("description.capabilities", "stair", 2, ('canGetAndSetFMUstate="true"', ""), "canGetAndSetFMUState"),
    ("description.capabilities", "stair", 3, ('StepSize="0.1"/>', 'StepSize="-1"/>'), "fixedInternalStepSize above 0"),
    ("description.experiment", "stair", 2, ('stopTime="10"', 'stopTime="-1"'), "expected a stopTime after 0, got -1"),
    ("description.experiment", "stair", 3, ('stepSize="0.1"/>\n<M', 'stepSize="INF"/>\n<M'), "finite stepSize"),
    (
        "description.step",
        "dahlquist",
        2,
        ('canHandleVariableCommunicationStepSize="true"', "", ' stepSize="0.1"', ""),
        "expected a stepSize in the DefaultExperiment",
    ),
    ("variables.names-unique", "feedthrough", 2, ('name="real_out"', 'name="real_in"'), "real_in: expected one"),
    ("variables.names-legal", "stair", 2, ('name="counter"', 'name="a&#10;b"'), "without line breaks"),
    (
        "variables.names-legal",
        "stair",
        3,
        (
            ' modelName="stair"',
            ' modelName="stair" variableNamingConvention="structured"',
            '"counter"',
            '"1st counter"',
        ),
        "expected a structured name",
    ),
    ("variables.references", "feedthrough", 3, ('Reference="4"', 'Reference="5"'), "5: expected one variable"),
    ("variables.references", "feedthrough", 2, ('Reference="10"', 'Reference="4"'), "at most one of the aliases"),
    (
        "variables.combinations",
        "dahlquist",
        2,
        ('causality="parameter" variability="fixed"', 'causality="parameter"'),
        "expected a variability that fits parameter, got continuous by default",
    ),
    (
        "variables.combinations",
        "dahlquist",
        2,
        ('causality="input"', 'causality="input" initial="exact"'),
        "no initial of an input in FMI 2.0",
    ),
    (
        "variables.combinations",
        "feedthrough",
        3,
        (
            'valueReference="14" causality="input" variability="discrete"',
            'valueReference="14" causality="input" variability="continuous"',
        ),
        "expected another variability of a Int32",
    ),
    ("variables.start", "feedthrough", 2, ('<Real start="0"/>', "<Real/>"), "expected a start value of a parameter"),
    ("variables.start", "dahlquist", 3, ('derivative="1"', 'derivative="1" start="0"'), "expected no start value"),
    ("variables.bounds", "feedthrough", 2, ('max="4" start="2"', 'max="4" start="5"'), "in [0, 4], got 5"),
    ("variables.bounds", "feedthrough", 3, ('min="0" max="4"', 'min="4" max="0"'), "expected min of at most max"),
    ("variables.bounds", "feedthrough", 2, ('"Option" start="1"', '"Option" start="7"'), "among the items 1, 2"),
    ("variables.types", "feedthrough", 2, ('Type="Option" start', 'Type="Options" start'), "got Options"),
    ("variables.types", "feedthrough", 3, ('<Item name="two" value="2"/>', '<Item name="two" value="1"/>'), "1, 1"),
    ("variables.units", "dahlquist", 2, ('unit="1/s"', 'unit="furlong"'), "got furlong, which does not exist"),
    ("variables.units", "dahlquist", 3, ('unit="m" ', 'unit="m" displayUnit="ell" '), "display unit of m, got ell"),
    (
        "variables.units",
        "dahlquist",
        2,
        (
            "<LogCategories>",
            '<TypeDefinitions><SimpleType name="L"><Real unit="ell"/></SimpleType></TypeDefinitions><LogCategories>',
            'unit="m" start',
            'declaredType="L" displayUnit="mm" start',
        ),
        "type L: expected a unit of UnitDefinitions, got ell",
    ),
    ("variables.units-defined", "dahlquist", 2, ('<BaseUnit s="-1"/>', ""), "unit 1/s: expected a BaseUnit"),
    ("variables.independent", "stair", 3, ('causality="independent"', 'causality="local"'), "one independent variable"),
    (
        "variables.derivatives",
        "dahlquist",
        2,
        ('derivative="2"', 'derivative="9"', '<Unknown index="3" dependencies="2"/>', '<Unknown index="3"/>'),
        "got that of 9",
    ),
    (
        "variables.derivatives",
        "dahlquist",
        3,
        ('derivative="1"', 'derivative="2"', 'Reference="2" dependencies="1"', 'Reference="2"'),
        "got its own",
    ),
    (
        "description.date",
        "stair",
        2,
        ("<fmiModelDescription", '<fmiModelDescription generationDateAndTime="2026-01-31T12:00:00"'),
        "like 2026-01-31T12:00:00Z, got 2026-01-31T12:00:00",
    ),
    (
        "description.date",
        "stair",
        3,
        ("<fmiModelDescription", '<fmiModelDescription generationDateAndTime="2026-01-31T12:00:00+01:00"'),
        "got 2026-01-31T12:00:00+01:00",
    ),
    (
        "description.schema",
        "stair",
        3,
        ("<fmiModelDescription", '<fmiModelDescription generationDateAndTime="yesterday"'),
        "yesterday",
    ),
    (
        "variables.names-unique",
        "dahlquist",
        3,
        ('unit="m" start="1"/>', 'start="1"><Alias name="k"/></Float64>'),
        "k: ",
    ),
    (
        "variables.aliases",
        "dahlquist",
        3,
        ('unit="m" start="1"/>', 'unit="m" start="1"><Alias name="y" displayUnit="ell"/></Float64>'),
        "x (line 13), alias y: expected a display unit of m, got ell",
    ),
    (
        "variables.aliases",
        "dahlquist",
        3,
        ('start="0"/>', 'start="0"><Alias name="y" displayUnit="mm"/></Float64>'),
        "without a unit, got mm",
    ),
    (
        "variables.aliases",
        "dahlquist",
        2,
        ('Reference="2"', 'Reference="1"'),
        "one unit of all aliases, got x (line 13): m",
    ),
    ("variables.aliases", "dahlquist", 2, (ONE_MORE, scalar(1, "")), "c (line 17): none"),
    (
        "variables.aliases",
        "feedthrough",
        2,
        (ONE_MORE, scalar(10, 'initial="approx"', "0")),
        "a start value of one alias",
    ),
    ("variables.aliases", "feedthrough", 2, (ONE_MORE, scalar(11, 'variability="constant"', "0")), "constant or none"),
    (
        "variables.aliases",
        "feedthrough",
        2,
        (
            ONE_MORE,
            scalar(30, 'variability="constant"', "1"),
            ONE_MORE,
            scalar(30, 'variability="constant"', "2"),
        ),
        "one start value of constants, got c1",
    ),
    (
        "variables.relative-quantities",
        "dahlquist",
        2,
        ('<Real start="0"/>', '<Real relativeQuantity="true" start="0"/>'),
        "u (line 16): expected a unit with relativeQuantity, got none",
    ),
    (
        "variables.relative-quantities",
        "dahlquist",
        3,
        ("<LogCategories>", L_3, 'unit="m" start', 'declaredType="L" relativeQuantity="false" start'),
        "expected relativeQuantity true of its type L, got false",
    ),
    ("description.schema", "stair", 3, ("<Int32 ", '<Int32 relativeQuantity="true" '), "relativeQuantity"),
    ("arrays.dimensions", "feedthrough", 3, ('<Dimension start="2"/>', '<Dimension start="0"/>'), "at least 1, got 0"),
    ("arrays.dimensions", "feedthrough", 3, ('<Dimension start="2"/>', "<Dimension/>"), "valueReference, got neither"),
    (
        "arrays.dimensions",
        "feedthrough",
        3,
        ('<Dimension start="2"/>', '<Dimension start="2"/><Dimension start="2" valueReference="38"/>'),
        "pair_out (line 31), dimension 2: expected either start or valueReference, got both",
    ),
    ("arrays.dimensions", "feedthrough", 3, ('n valueReference="38"', 'n valueReference="99"'), "a variable, got 99"),
    ("arrays.dimensions", "feedthrough", 3, ('n valueReference="38"', 'n valueReference="4"'), "got real_tunable"),
    (
        "arrays.dimensions",
        "feedthrough",
        3,
        ("<UInt64", "<UInt32"),
        "expected a size of type UInt64, got size (line 33) of type UInt32",
    ),
    (
        "arrays.dimensions",
        "feedthrough",
        3,
        ('causality="structuralParameter"', 'causality="parameter"'),
        "expected a structural parameter or a constant, got size (line 33), fixed parameter",
    ),
    (
        "arrays.dimensions",
        "feedthrough",
        3,
        ('start="3"/>', 'start="0"/>'),
        "size (line 33) to start at 1 at least, got 0",
    ),
    (
        "arrays.dimensions",
        "feedthrough",
        3,
        ('start="3"/>', 'start="3"><Dimension start="1"/></UInt64>'),
        "expected a structural parameter without dimensions, got 1",
    ),
    (
        "arrays.start",
        "feedthrough",
        3,
        ('start="1 2 3"', 'start="1 2"'),
        "3 start values for 3 elements, or one for all",
    ),
    ("arrays.start", "feedthrough", 3, ('start="3"/>', 'start="4"/>'), "4 start values for 4 elements, or one for all"),
    ("clocks.event-mode", "stair", 3, (ONE_MORE, clock('intervalDecimal="0.1"')), "got tick"),
    (
        "clocks.attributes",
        "stair",
        3,
        (ONE_MORE, clock(""), *EVENTS),
        "intervalCounter of a periodic clock, got neither",
    ),
    (
        "clocks.attributes",
        "stair",
        3,
        (ONE_MORE, clock('intervalDecimal="0"'), *EVENTS),
        "intervalDecimal above 0, got 0",
    ),
    (
        "clocks.attributes",
        "stair",
        3,
        (ONE_MORE, clock('intervalDecimal="0.1" shiftDecimal="-1"'), *EVENTS),
        "shiftDecimal of at least 0, got -1",
    ),
    (
        "clocks.attributes",
        "stair",
        3,
        (ONE_MORE, clock('intervalCounter="1" supportsFraction="true"'), *EVENTS),
        "a resolution with intervalCounter",
    ),
    (
        "clocks.attributes",
        "stair",
        3,
        (ONE_MORE, clock('intervalCounter="1" resolution="10"'), *EVENTS),
        "supportsFraction with intervalCounter",
    ),
    (
        "clocks.attributes",
        "stair",
        3,
        (ONE_MORE, clock('"triggered"', '"constant"'), *EVENTS),
        "expected intervalDecimal of periodic clocks only, got triggered",
    ),
    ("clocks.attributes", "stair", 3, (ONE_MORE, clock('"parameter"', '"input"'), *EVENTS), "input or output or local"),
    (
        "clocks.attributes",
        "stair",
        3,
        (ONE_MORE, clock('"constant" variability="continuous"', '"constant"'), *EVENTS),
        "expected variability discrete or tunable",
    ),
    (
        "clocks.references",
        "feedthrough",
        3,
        ('Reference="12"', 'Reference="12" clocks="10"'),
        "expected clocks of type Clock, got real_in (line 11) of type Float64",
    ),
    ("clocks.references", "feedthrough", 3, ('Reference="12"', 'Reference="12" clocks="99"'), "got value reference 99"),
    (
        "clocks.references",
        "feedthrough",
        3,
        ('Reference="10"', 'Reference="10" clocks="50"', ONE_MORE, clock('intervalDecimal="1"'), *EVENTS),
        "expected a discrete or tunable variable with clocks, got continuous",
    ),
    ("structure.references", "dahlquist", 2, ('dependencies="2"', 'dependencies="77"'), "existing variables, got 77"),
    (
        "structure.references",
        "stair",
        3,
        ('<Output valueReference="30"', '<Output valueReference="30"/><Output valueReference="30"'),
        "got several",
    ),
    (
        "structure.outputs",
        "feedthrough",
        2,
        ('<Unknown index="5" dependencies="4"/>', ""),
        "missing",
    ),
    (
        "structure.initial-unknowns",
        "dahlquist",
        3,
        ('<InitialUnknown valueReference="2" dependencies="1 3"/>', ""),
        "missing",
    ),
    (
        "structure.initial-unknowns",
        "stair",
        2,
        ("</Outputs>", '</Outputs><InitialUnknowns><Unknown index="2"/></InitialUnknowns>'),
        "only what is calculated in the initialization, got counter",
    ),
    (
        "structure.derivatives",
        "dahlquist",
        3,
        (' derivative="1"', "", 'Reference="2" dependencies="1"', 'Reference="2"'),
        "to have the attribute derivative",
    ),
    (
        "structure.dependencies",
        "dahlquist",
        2,
        ('<Unknown index="3" dependencies="2"/>', '<Unknown index="3" dependencies="2 4"/>'),
        "fixed parameter",
    ),
    (
        "structure.dependencies",
        "dahlquist",
        3,
        ('dependencies="1 3"', 'dependencies="1 3" dependenciesKind="dependent"'),
        "expected 2 kinds",
    ),
    (
        "structure.dependencies-told",
        "dahlquist",
        2,
        ('<Unknown index="2" dependencies=""/>', '<Unknown index="2"/>'),
        "without",
    ),
]


CLEAN = [
    # model, FMI, text and replacement in pairs
    ("stair", 2, ("<fmiModelDescription", '<fmiModelDescription generationDateAndTime="2026-01-31T12:00:00Z"')),
    ("dahlquist", 3, ('unit="m" start="1"/>', 'unit="m" start="1"><Alias name="y" displayUnit="mm"/></Float64>')),
    ("dahlquist", 3, ('start="0"/>', 'start="0"><Alias name="y"/><Alias name="z"/></Float64>')),
    ("feedthrough", 2, (ONE_MORE, scalar(11, ""))),
    ("feedthrough", 2, (ONE_MORE, scalar(10, ""))),
    ("feedthrough", 2, (ONE_MORE, scalar(14, ""))),  # a reference of an integer
    ("dahlquist", 2, ('unit="m" start', 'unit="m" relativeQuantity="true" start')),
    ("dahlquist", 3, ("<LogCategories>", L_3, 'unit="m" start', 'declaredType="L" start')),
    ("feedthrough", 3, ('start="1 2 3"', 'start="1"')),
    ("feedthrough", 3, ('<Dimension start="2"/>', '<Dimension start="1"/><Dimension valueReference="38"/>')),
    ("feedthrough", 3, ('causality="structuralParameter" variability="fixed"', 'variability="constant"')),
    ("stair", 3, (ONE_MORE, clock('intervalDecimal="0.1" shiftDecimal="0.5"'), *EVENTS)),
    ("stair", 3, (ONE_MORE, clock('intervalCounter="1" resolution="10" supportsFraction="true"'), *EVENTS)),
    ("stair", 3, (ONE_MORE, clock('"triggered"', '"constant" intervalDecimal="0.1"'), *EVENTS)),
    (
        "feedthrough",
        3,
        ('Reference="12"', 'Reference="12" clocks="50"', ONE_MORE, clock('intervalDecimal="1"'), *EVENTS),
    ),
    # FMI 3.0, unlike 2.0: derivatives and outputs may depend on parameters
    ("dahlquist", 3, ('Reference="2" dependencies="1"', 'Reference="2" dependencies="1 3"')),
    (
        "feedthrough",
        3,
        ('<Output valueReference="11" dependencies="10"', '<Output valueReference="11" dependencies="10 5"'),
    ),
    # lists as XML schema has them
    (
        "dahlquist",
        2,
        ('dependencies="2 4"', 'dependencies="  2 &#10; 4&#9;" dependenciesKind=" dependent   dependent "'),
    ),
    ("dahlquist", 3, ('dependencies="1 3"', 'dependencies="\n1   3 "')),
    ("dahlquist", 2, ('dependencies=""', 'dependencies="  "')),
    ("dahlquist", 3, ('dependencies=""', 'dependencies=" &#9; "')),
]


@pytest.mark.parametrize(("model", "fmi", "change"), CLEAN)
def test_no_fault_in_the_description(reference_fmus: ReferenceFmus, model: str, fmi: int, change: tuple[str, ...]):
    assert found_in(reference_fmus.make(model, fmi, xml=replaced(change))) == {}


@pytest.mark.parametrize(("rule", "model", "fmi", "change", "message"), DESCRIPTIONS)
def test_fault_in_the_description(
    reference_fmus: ReferenceFmus, rule: str, model: str, fmi: int, change: tuple[str, ...], message: str
):
    found = found_in(reference_fmus.make(model, fmi, xml=replaced(change)))
    assert list(found) == [rule], found
    assert message in found[rule][0]


def test_an_fmu_for_model_exchange_only_is_one_error(reference_fmus: ReferenceFmus):
    change = ("<CoSimulation", "<ModelExchange", ' canHandleVariableCommunicationStepSize="true"', "")
    found = validate(reference_fmus.make("stair", 2, xml=replaced(change)))
    assert [finding.message for finding in found.findings] == ["expected an element CoSimulation, got ModelExchange"]
    assert found.outcomes["lifecycle.sequence"].not_applicable == "the FMU is not for co-simulation"


# ---- archives --------------------------------------------------------------------------------------------------------


def _with(name: str, content: bytes = b"x") -> Callable[[Members], Members]:
    return lambda members: members | {name: content}


def _moved(old: str, new: str) -> Callable[[Members], Members]:
    return lambda members: {name.replace(old, new): content for name, content in members.items()}


def _library(change: Callable[[bytes], bytes]) -> Callable[[Members], Members]:
    return lambda members: {n: change(c) if n.endswith(SUFFIX) else c for n, c in members.items()}


def _without_binaries(members: Members) -> Members:
    return {name: content for name, content in members.items() if not name.startswith("binaries")}


def _other_machine(library: bytes) -> bytes:
    """Change the machine in the library's ELF header to SPARC."""
    return library[:18] + b"\x02\x00" + library[20:]


BUILD = b"""<fmiBuildDescription fmiVersion="3.0"><BuildConfiguration modelIdentifier="reference"><SourceFileSet>
<SourceFile name="gone.c"/></SourceFileSet></BuildConfiguration></fmiBuildDescription>"""

PE = b"MZ" + bytes(58) + (64).to_bytes(4, "little") + b"PE\0\0\x64\x86" + bytes(100)
"""Headers of a DLL for x86_64."""

ARCHIVES = [
    ("archive.paths", 2, _with("resources/../../evil.txt"), "inside the archive"),
    ("archive.paths", 2, _with("/etc/evil"), "inside the archive"),
    ("archive.paths", 3, _with("resources\\table.csv"), "forward slashes"),
    ("archive.duplicates", 2, _with("resources/Table.csv"), "more than capitals"),
    ("archive.description", 2, _moved("modelDescr", "resources/modelDescr"), "got resources/modelDescr"),
    ("archive.stray", 2, _with("notes.txt"), "got an unknown entry"),
    ("archive.stray", 3, _with("model.png"), "got an unknown entry"),
    ("archive.stray", 2, _with("resources/.DS_Store"), "got one of an operating system or an editor"),
    ("archive.implementation", 2, _without_binaries, "binaries or sources, got none"),
    ("archive.platforms", 3, _moved(fmpy.platform_tuple, fmpy.platform), "got one of FMI 2.0"),
    ("archive.platforms", 2, _moved(f"/{fmpy.platform}/", f"/{fmpy.platform_tuple}/"), "got a name of FMI 3.0"),
    ("archive.binaries", 2, _moved(f"reference{SUFFIX}", f"Reference{SUFFIX}"), f"expected reference{SUFFIX}"),
    ("archive.binaries", 2, _with("binaries/win64/Reference.dll", PE), "expected reference.dll, got Reference.dll"),
    ("archive.binaries", 3, _with("binaries/x86_64-windows/other.dll", PE), "expected reference.dll, got other.dll"),
    ("archive.machine", 2, _with("binaries/win64/reference.dll", PE.replace(b"\x64\x86", b"\x4c\x01")), "got PE x86"),
    ("archive.machine", 2, _library(_other_machine), "expected a library for ELF"),
    ("archive.machine", 3, _library(lambda _: b"MZ" + bytes(100)), "got another kind of file"),
    ("archive.sources", 3, _with("sources/model.c"), "expected a buildDescription.xml"),
    ("archive.sources", 3, _with("sources/buildDescription.xml", BUILD), "got gone.c, which does not exist"),
    ("archive.documentation", 2, _with("documentation/main.html"), "expected an index.html"),
    ("archive.documentation", 3, _with("documentation/licenses/MIT"), "expected license.txt"),
]


@pytest.mark.parametrize(("rule", "fmi", "change", "message"), ARCHIVES)
def test_fault_in_the_archive(
    reference_fmus: ReferenceFmus, rule: str, fmi: int, change: Callable[[Members], Members], message: str
):
    first = {"resources/table.csv": b"x"}
    found = found_in(reference_fmus.make("stair", fmi, archive=lambda members: change(first | members)))
    assert list(found) == [rule], found
    assert message in found[rule][0]


def test_sources_may_be_listed_in_any_notation(reference_fmus: ReferenceFmus):
    files = '<SourceFiles><File name="./gc/pool.c"/></SourceFiles></CoSimulation>'
    change = ('canSerializeFMUstate="true"/>', f'canSerializeFMUstate="true">{files}')
    assert found_in(reference_fmus.make("stair", xml=replaced(change), archive=_with("sources/gc/pool.c"))) == {}
    assert list(found_in(reference_fmus.make("stair", xml=replaced(change), archive=_with("sources/pool.c")))) == [
        "archive.sources"
    ]


@pytest.mark.parametrize(("name", "severity"), [("REFERENCE.dll", "warning"), ("other.dll", "error")])
def test_windows_finds_a_library_by_any_capitals(reference_fmus: ReferenceFmus, name: str, severity: str):
    found = validate(reference_fmus.make("stair", archive=_with(f"binaries/win64/{name}", PE)), only=FILES_ONLY)
    assert [(f.rule, f.severity) for f in found.findings] == [("archive.binaries", severity)]
    linux = reference_fmus.make("stair", archive=_moved(f"reference{SUFFIX}", f"Reference{SUFFIX}"))
    assert [f.severity for f in validate(linux, only=FILES_ONLY).findings] == ["error"]


def test_a_library_found_by_other_capitals_is_for_its_machine(reference_fmus: ReferenceFmus):
    wrong = _with("binaries/win64/REFERENCE.dll", b"MZ" + bytes(100))
    found = validate(reference_fmus.make("stair", archive=wrong), only=FILES_ONLY)
    assert [(f.rule, f.severity) for f in found.findings] == [
        ("archive.binaries", "warning"),
        ("archive.machine", "error"),
    ]


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("binaries", [True, False])
def test_missing_sources_matter_without_binaries_only(reference_fmus: ReferenceFmus, fmi: int, binaries: bool):
    def archive(members: Members) -> Members:
        kept = members if binaries else _without_binaries(members)
        return kept | {"sources/other.c": b"", **({"sources/buildDescription.xml": BUILD} if fmi == 3 else {})}

    files = '<SourceFiles><File name="gone.c"/></SourceFiles></CoSimulation>'
    state = 'canSerializeFMUstate="true"'
    xml = replaced((f"{state}/>", f"{state}>{files}")) if fmi == 2 else replaced(())
    found = validate(reference_fmus.make("stair", fmi, xml=xml, archive=archive), only=FILES_ONLY).findings
    assert [(f.rule, f.severity) for f in found] == [("archive.sources", "warning" if binaries else "error")]


def rewritten(path: Path, change: Callable[[zipfile.ZipFile, zipfile.ZipFile], None]) -> Path:
    """Rewrite an archive with a change that needs access to its members."""
    content = path.read_bytes()
    with zipfile.ZipFile(io.BytesIO(content)) as old, zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as new:
        for member in old.infolist():
            new.writestr(member, old.read(member))
        change(old, new)
    return path


def test_a_duplicate_member(reference_fmus: ReferenceFmus):
    def change(old: zipfile.ZipFile, new: zipfile.ZipFile) -> None:
        with pytest.warns(UserWarning, match="Duplicate"):
            new.writestr("modelDescription.xml", old.read("modelDescription.xml"))

    assert found_in(rewritten(reference_fmus.make("stair"), change)) == {
        "archive.duplicates": ["member modelDescription.xml: expected it once, got it 2 times"]
    }


def test_a_link(reference_fmus: ReferenceFmus):
    def change(old: zipfile.ZipFile, new: zipfile.ZipFile) -> None:
        link = zipfile.ZipInfo("resources/password")
        link.external_attr = (stat.S_IFLNK | 0o777) << 16
        new.writestr(link, "/etc/passwd")

    assert found_in(rewritten(reference_fmus.make("stair"), change)) == {
        "archive.kinds": ["member resources/password: expected a file or folder, got a link or a device"]
    }


def test_another_compression(reference_fmus: ReferenceFmus):
    def change(old: zipfile.ZipFile, new: zipfile.ZipFile) -> None:
        new.writestr("resources/table.csv", b"x" * 100, zipfile.ZIP_BZIP2)

    found = found_in(rewritten(reference_fmus.make("stair"), change))
    assert list(found) == ["archive.compression"]


def test_a_bomb(reference_fmus: ReferenceFmus):
    def change(old: zipfile.ZipFile, new: zipfile.ZipFile) -> None:
        with new.open("resources/zeros", "w", force_zip64=True) as stream:
            for _ in range(101):
                stream.write(bytes(2**20))

    found = found_in(rewritten(reference_fmus.make("stair"), change))
    assert list(found) == ["archive.size"]
    assert "resources/zeros" in found["archive.size"][0]


def test_damage(reference_fmus: ReferenceFmus):
    path = reference_fmus.make("stair", archive=_with("resources/table.csv", b"0123456789" * 10))
    with zipfile.ZipFile(path) as archive:
        at = archive.getinfo("resources/table.csv").header_offset + 50
    content = bytearray(path.read_bytes())
    content[at] ^= 0xFF
    path.write_bytes(content)
    assert list(found_in(path)) == ["archive.readable"]


def test_a_file_that_is_not_an_archive(reference_fmus: ReferenceFmus):
    path = reference_fmus.folder / "text.fmu"
    path.write_text("an FMU")
    found = validate(path)
    assert [finding.rule for finding in found.findings] == ["archive.readable"]


# ---- behaviour -------------------------------------------------------------------------------------------------------

BEHAVIOUR = [
    # rule, model, FMI, fault built into the library, part of the message
    ("binary.version", "dahlquist", 2, "version", "fmi2GetVersion: expected 2.0, got 1.0"),
    ("binary.version", "dahlquist", 3, "version", "fmi3GetVersion: expected 3.0, got 2.0"),
    ("lifecycle.token", "dahlquist", 2, "token", "expected no instance with {dahlquist}0"),
    ("lifecycle.sequence", "dahlquist", 2, "crash", "ended by signal 6 (SIGABRT)"),
    ("lifecycle.sequence", "dahlquist", 3, "exit", "ended with exit code 3"),
    (
        "lifecycle.sequence",
        "dahlquist",
        3,
        "error",
        "t = 1.3 s, step 0.1 s: expected ok, got error (FMU message: step: some",
    ),
    ("lifecycle.free-null", "dahlquist", 2, "free_null", "ended by signal"),
    ("lifecycle.terminated", "dahlquist", 2, "terminated", "after Terminate: x: expected"),
    ("lifecycle.reset", "dahlquist", 3, "reset", "after Reset: at t = 0.1 s: x: expected"),
    ("lifecycle.instances", "dahlquist", 2, "shared", "beside another instance: at t = 0.1 s: x"),
    ("lifecycle.logging", "dahlquist", 3, "logging", "fmi3SetDebugLogging: expected ok, got error"),
    ("lifecycle.call-order", "dahlquist", 2, "order", "a step before the initialization: expected an error, got ok"),
    ("lifecycle.call-order", "dahlquist", 3, "order_crash", "ended by signal"),
    ("lifecycle.fixed", "dahlquist", 2, "fixed", "the FMU accepted k"),
    ("arrays.access", "feedthrough", 3, "array_order", "read together with other variables: gains: expected [1.0, 2.0"),
    ("arrays.access", "feedthrough", 3, "array_first", "expected [0.0, 1.0, 2.0] as written, got [0.0, 2.0, 3.0]"),
    ("arrays.access", "feedthrough", 3, "array_past", "was written: real_bounded: expected 2.0, got 3.0"),
    ("steps.inputs", "dahlquist", 2, "input", "u (line 16): expected ("),
    ("steps.deterministic", "dahlquist", 3, "random", "in a second run: at t = 0.1 s: x"),
    ("steps.time", "dahlquist", 2, "time", "expected time (line 12) to be 0.1 s, got 0.05 s"),
    ("steps.variable", "dahlquist", 2, "fixed_step", "step 0.05 s: expected ok, got error"),
    ("steps.backward", "dahlquist", 3, "backward", "step of -0.1 s: expected an error, got ok"),
    ("steps.stop-time", "dahlquist", 2, "stop", "from the stop time 0.3 s on: expected an error, got ok"),
    ("steps.bounds", "feedthrough", 2, "bounds", "expected values in [-1000, 1000], got 1000000.0"),
    ("steps.finite", "feedthrough", 3, "nan", "real_out"),
    ("steps.constant", "dahlquist", 2, "constant", "at t = 0.1 s: expected 1.0 as before, got 1.5"),
    ("steps.limits", "feedthrough", 2, "clamps", "expected 9 to be rejected or accepted unchanged, got 4.0 instead"),
    ("state.continues", "dahlquist", 3, "state", "after setting the state: x"),
    ("state.serialises", "dahlquist", 2, "serialise", "in a new instance: at t = 1.1 s: x"),
    ("state.free", "dahlquist", 3, "state_free", "expected the pointer to be null"),
    ("side_effects.output", "dahlquist", 2, "stdout", "printed: hello"),
    ("side_effects.output", "dahlquist", 3, "stderr", "printed: hello"),
    ("side_effects.files", "dahlquist", 2, "file", "got left.txt"),
    ("side_effects.files", "dahlquist", 3, "resource", "left.txt"),
    ("side_effects.process", "dahlquist", 2, "chdir", "working folder"),
    ("side_effects.process", "dahlquist", 3, "denormals", "flushed to zero"),
    ("side_effects.memory", "dahlquist", 2, "memory", "KiB each"),
    ("side_effects.descriptors", "dahlquist", 2, "descriptor", "got 3 more"),
]


@pytest.mark.parametrize(("rule", "model", "fmi", "fault", "message"), BEHAVIOUR)
def test_fault_in_the_library(
    reference_fmus: ReferenceFmus, runner: RuleRunner, rule: str, model: str, fmi: int, fault: str, message: str
):
    skip = {"side_effects.memory"} - {rule}  # the slowest rule; other tests apply it to conforming FMUs
    findings = validate(reference_fmus.make(model, fmi, fault), runner=runner, skip=skip).findings
    assert {finding.rule for finding in findings} == {rule}, findings
    assert message in findings[0].message


def test_a_hang_is_a_finding(reference_fmus: ReferenceFmus, runner: RuleRunner):
    found = validate(reference_fmus.make("dahlquist", 2, "hang"), runner=runner, time_limit=0.5)
    assert [(f.rule, f.message) for f in found.findings] == [
        (
            "lifecycle.sequence",
            "expected an end within 0.5 s, got none: the FMU hangs, or is slow and needs a longer --time-limit",
        )
    ]
    assert found.outcomes["lifecycle.reset"].not_applicable == "see lifecycle.sequence"


ONCE = replaced(("<CoSimulation", '<CoSimulation canBeInstantiatedOnlyOncePerProcess="true"'))


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize(
    ("fault", "severity", "message"),
    [
        ("none", "warning", "expected no second instance"),
        ("once_crash", "error", "ended by signal 6 (SIGABRT)"),
        ("once_reset", "error", "after a second instance was requested: at t = 0.2 s: x: expected"),
    ],
)
def test_an_fmu_of_one_instance(
    reference_fmus: ReferenceFmus, runner: RuleRunner, fmi: int, fault: str, severity: str, message: str
):
    found = validate(reference_fmus.make(fmi=fmi, fault=fault, xml=ONCE), runner=runner, skip=["side_effects.memory"])
    assert [(f.rule, f.severity) for f in found.findings] == [("lifecycle.once", severity)]
    assert message in found.findings[0].message


@pytest.mark.parametrize("fmi", [2, 3])
def test_an_fmu_of_one_instance_that_refuses_a_second_one(reference_fmus: ReferenceFmus, runner: RuleRunner, fmi: int):
    found = validate(reference_fmus.make(fmi=fmi, fault="once", xml=ONCE), runner=runner)
    assert found.findings == []
    assert found.outcomes["lifecycle.once"].verdict == "passed"
    assert "only once" in found.outcomes["lifecycle.instances"].not_applicable


@pytest.mark.parametrize("fmi", [2, 3])
def test_an_fmu_that_refuses_instances_without_saying_so(reference_fmus: ReferenceFmus, runner: RuleRunner, fmi: int):
    found = validate(reference_fmus.make(fmi=fmi, fault="once"), runner=runner)
    assert [f.rule for f in found.findings] == ["lifecycle.instances"]
    assert found.findings[0].message.endswith("got none (FMU message: no licence)")


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_licence_for_some_instances_is_no_leak(reference_fmus: ReferenceFmus, runner: RuleRunner, fmi: int):
    found = validate(reference_fmus.make(fmi=fmi, fault="licence"), runner=runner)
    assert found.findings == []
    reason = found.outcomes["side_effects.memory"].not_applicable
    assert reason.startswith("too few instances for a measurement: instance 51: expected an instance with")
    assert reason.endswith("(FMU message: no licence)")


def test_the_end_of_the_server_is_an_error(reference_fmus: ReferenceFmus):
    path = reference_fmus.make()
    with RuleRunner() as own:
        validate(path, runner=own, only=["binary.loads"])
        own._server.end(grace=0.0)
        with pytest.raises(RunError, match="binary.loads: expected a result, but the process that runs FMUs has ended"):
            validate(path, runner=own, only=["binary.loads"])


def test_a_missing_function(reference_fmus: ReferenceFmus, runner: RuleRunner):
    path = reference_fmus.make(binary=lambda library: library.replace(b"fmi2CancelStep\0", b"xmi2CancelStep\0"))
    found = validate(path, runner=runner).findings
    assert [(f.rule, "none of fmi2CancelStep" in f.message) for f in found] == [("binary.symbols", True)]


def test_a_missing_library(reference_fmus: ReferenceFmus, runner: RuleRunner):
    path = reference_fmus.make(fmi=3, binary=lambda library: library.replace(b"libc.so.6\0", b"libq.so.6\0"))
    found = validate(path, runner=runner).findings
    assert [(f.rule, "libq.so.6" in f.message) for f in found] == [("binary.loads", True)]


@pytest.mark.parametrize("fmi", [2, 3])
def test_another_token_in_the_description_than_in_the_library(
    reference_fmus: ReferenceFmus, runner: RuleRunner, fmi: int
):
    path = reference_fmus.make(fmi=fmi, xml=lambda text: text.replace("{dahlquist}", "{dahlquish}"))
    found = validate(path, runner=runner).findings
    assert [f.rule for f in found] == ["lifecycle.instantiate"]
    assert "{dahlquish}, got none" in found[0].message


def test_an_fmu_that_needs_a_missing_tool_fails(reference_fmus: ReferenceFmus, runner: RuleRunner):
    change = replaced(("{dahlquist}", "{dahlquish}", "<CoSimulation", '<CoSimulation needsExecutionTool="true"'))
    found = validate(reference_fmus.make(xml=change), runner=runner).findings
    assert [f.rule for f in found] == ["lifecycle.instantiate"]
    assert found[0].message.endswith("the FMU needs another tool, which may be missing here")


@pytest.mark.parametrize(
    ("model", "fmi", "old", "new", "message"),
    [
        ("dahlquist", 2, 'start="1"/>', 'start="1.5"/>', "x (line 13): expected start value 1.5, got 1.0"),
        ("feedthrough", 2, 'start="Set me!"', 'start="Set it!"', "expected start value Set it!, got Set me!"),
        ("feedthrough", 3, 'value="666f6f"', 'value="666f6e"', "expected start value fon, got foo"),
        ("feedthrough", 3, '"Option" start="1"', '"Option" start="2"', "expected start value 2, got 1"),
        ("feedthrough", 2, 'start="false"', 'start="true"', "expected start value 1, got 0"),
    ],
)
def test_other_start_values_in_the_description_than_in_the_library(
    reference_fmus: ReferenceFmus, runner: RuleRunner, model: str, fmi: int, old: str, new: str, message: str
):
    path = reference_fmus.make(model, fmi, xml=replaced((old, new)))
    found = validate(path, runner=runner, only=["lifecycle.start-values"]).findings
    assert [f.rule for f in found] == ["lifecycle.start-values"]
    assert message in found[0].message


def test_every_rule_finds_a_planted_fault():
    planted = {case[0] for cases in (DESCRIPTIONS, ARCHIVES, BEHAVIOUR) for case in cases}
    planted |= {"archive.readable", "archive.kinds", "archive.compression", "archive.size", "description.interface"}
    planted |= {"binary.loads", "binary.symbols", "lifecycle.instantiate", "lifecycle.start-values", "lifecycle.once"}
    assert set(load_rules()) - planted == {"fmpy_check.fmpy"}  # no fault is known that only fmpy finds
