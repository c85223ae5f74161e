"""Documents of SSP 1.0: they are read back as written, are valid against the schemas, and invalid ones are errors."""

from __future__ import annotations

from pathlib import Path

import fmpy
import pytest
from hypothesis import given
from hypothesis import strategies as st
from lxml import etree

from cosim import SetupError
from cosim.ssp import ssd, ssv
from cosim.ssp.xml import write_document
from cosim.units import Linear, Unit

SCHEMAS = Path(fmpy.__file__).parent / "ssp" / "schema"

LINEAR = ssv.Transformation.of(Linear(0.1, -1e-300))

PARAMETERS = ssv.ParameterSet(
    version="1.0",
    name="all",
    parameters=(
        ssv.Parameter(name="mass", typed_value=ssv.TypedValue(kind="Real", text="70000.0", unit="g")),
        ssv.Parameter(name="count", typed_value=ssv.TypedValue(kind="Integer", text="-3")),
        ssv.Parameter(name="on", typed_value=ssv.TypedValue(kind="Boolean", text="true")),
        ssv.Parameter(name="path", typed_value=ssv.TypedValue(kind="String", text="a <b> & 'c' \u00e9")),
        ssv.Parameter(
            name="profile", typed_value=ssv.TypedValue(kind="Enumeration", text="sine", enumeration="profile")
        ),
    ),
    enumerations=(
        ssv.Enumeration(name="profile", items=(ssv.Item(name="bump", value=1), ssv.Item(name="sine", value=2))),
    ),
    units=(ssv.UnitDefinition.of(Unit("g", (1, 0, 0, 0, 0, 0, 0, 0), 1e-3)),),
)

MAPPING = ssv.ParameterMapping(
    version="1.0",
    entries=(
        ssv.MappingEntry(source="a", target="b", suppress_unit_conversion=True, transformation=LINEAR),
        ssv.MappingEntry(
            source="c",
            target="d",
            transformation=ssv.Transformation(
                kind="BooleanMappingTransformation", entries=(ssv.MapEntry(source="true", target="false"),)
            ),
        ),
    ),
)

_SEAT = ssd.Component(
    name="seat",
    source="resources/SeatPlant.fmu",
    implementation="CoSimulation",
    connectors=(
        ssd.Connector(name="force", kind="input", type=ssd.Type(kind="Real", unit="N")),
        ssd.Connector(name="saturated", kind="output", type=ssd.Type(kind="Boolean")),
        ssd.Connector(name="profile", kind="parameter", type=ssd.Type(kind="Enumeration", enumeration="profile")),
        ssd.Connector(name="plain", kind="calculatedParameter"),
    ),
    bindings=(
        ssd.ParameterBinding(values=PARAMETERS, mapping=ssd.MappingReference(mapping=MAPPING)),
        ssd.ParameterBinding(
            source="p.ssv",
            source_base="component",
            prefix="seat.",
            mapping=ssd.MappingReference(source="m.ssm", source_base="component"),
        ),
    ),
    annotations=(ssd.Annotation(type=ssd.Annotation.OSP, content=ssd.StepSizeHint(value=0.004)),),
)

DESCRIPTION = ssd.SystemStructureDescription(
    version="1.0",
    name="Seat",
    generation_tool="test",
    system=ssd.System(
        name="Seat",
        connectors=(ssd.Connector(name="in", kind="input", type=ssd.Type(kind="Real", unit="N")),),
        bindings=(ssd.ParameterBinding(source="resources/p.ssv"),),
        elements=(
            ssd.System(name="cabin", elements=(_SEAT,)),
            ssd.SignalDictionaryReference(name="bus", dictionary="can"),
            ssd.Component(name="shaker", source="resources/Shaker.fmu"),
        ),
        connections=(
            ssd.Connection(start_connector="in", end_element="cabin", end_connector="in"),
            ssd.Connection(
                start_element="a",
                start_connector="x",
                end_element="b",
                end_connector="y",
                suppress_unit_conversion=True,
                transformation=LINEAR,
            ),
        ),
    ),
    enumerations=PARAMETERS.enumerations,
    units=(ssv.UnitDefinition.of(Unit("degC", (0, 0, 0, 0, 1, 0, 0, 0), 1.0, 273.15)),),
    experiment=ssd.DefaultExperiment(
        start_time=0.0,
        stop_time=3.0,
        annotations=(
            ssd.Annotation(
                type=ssd.Annotation.OSP, content=ssd.OspAlgorithm(fixed_step=ssd.FixedStep(base_step_size=0.1))
            ),
            ssd.Annotation(type=ssd.Annotation.OWN, content=ssd.Exchange(algorithm="jacobi")),
        ),
    ),
)

DOCUMENTS = [
    (DESCRIPTION, ssd.read_description, "SystemStructureDescription"),
    (PARAMETERS, ssv.read_parameter_set, "SystemStructureParameterValues"),
    (MAPPING, ssv.read_parameter_mapping, "SystemStructureParameterMapping"),
]


@pytest.mark.parametrize(("document", "read", "schema"), DOCUMENTS)
def test_documents_are_read_back_and_valid_against_the_schema(document, read, schema: str):
    data = write_document(document)
    assert read(data, "here") == document
    assert write_document(read(data, "here")) == data
    etree.XMLSchema(file=str(SCHEMAS / f"{schema}.xsd")).assertValid(etree.fromstring(data))


@given(st.floats(allow_nan=False, allow_infinity=False), st.floats(allow_nan=False, allow_infinity=False))
def test_floats_are_read_back_to_the_same_bits(factor: float, offset: float):
    entry = ssv.MappingEntry(source="a", target="b", transformation=ssv.Transformation.of(Linear(factor, offset)))
    mapping = ssv.ParameterMapping(version="1.0", entries=(entry,))
    assert ssv.read_parameter_mapping(write_document(mapping), "here") == mapping


def test_values_have_their_type():
    values = {p.name: p.typed_value.value for p in PARAMETERS.parameters}
    assert values == {"mass": 70000.0, "count": -3, "on": True, "path": "a <b> & 'c' \u00e9", "profile": "sine"}


def test_elements_of_other_tools_are_ignored():
    data = write_document(DESCRIPTION).decode()
    foreign = data.replace(
        '<ssd:Connection startConnector="in" endElement="cabin" endConnector="in"/>',
        '<ssd:Connection startConnector="in" endElement="cabin" endConnector="in">'
        '<ssd:ConnectionGeometry pointsX="1 2" pointsY="3 4"/></ssd:Connection>',
    ).replace(
        "</ssd:Connectors>", '</ssd:Connectors><ssd:ElementGeometry x1="0" y1="0" x2="1" y2="1"/><!-- drawn -->', 1
    )
    assert foreign.count("Geometry") == 2
    assert ssd.read_description(foreign.encode(), "here") == DESCRIPTION


TEXT = write_document(DESCRIPTION).decode()
BOMB = '<!DOCTYPE a [<!ENTITY b "bbbb"><!ENTITY c "&b;&b;">]>'


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("", "expected XML, got"),
        ("PK\x03\x04", "expected XML, got"),
        ("<ssd", "expected XML, got"),
        (TEXT.replace("?>", "?>" + BOMB, 1), "expected XML without a document type, got one"),
        (
            TEXT.replace("?>", '?><!DOCTYPE a SYSTEM "http://localhost:9/a.dtd">', 1),
            "expected XML without a document type, got one",
        ),
        ("<a>" * 100_000, "expected XML, got"),
        ("<a/>", "expected <ssd:SystemStructureDescription> of SSP 1.0 or 2.0, got <a>"),
        (
            TEXT.replace("SSP1/SystemStructureDescription", "SSP9/X"),
            "got <SystemStructureDescription> of the namespace http://ssp-standard.org/SSP9/X",
        ),
        (TEXT.replace('version="1.0"', 'version="3.0"', 1), "expected version 1.0 or 2.0, got 3.0"),
        (
            TEXT.replace("<ssd:DefaultExperiment", "<ssd:Experiment").replace("</ssd:DefaultE", "</ssd:E"),
            "line .*Experiment",
        ),
        (TEXT.replace('endConnector="in"', ""), "line [0-9]+: .*attribute 'endConnector' is required but missing"),
        (TEXT.replace("ssc:LinearTransformation", "ssd:LinearTransformation"), "line [0-9]+: .*LinearTransformation"),
        (TEXT.replace('kind="parameter"', 'kind="knob"'), "line [0-9]+: .*knob"),
        (TEXT.replace('value="70000.0"', 'value="heavy"'), "line [0-9]+: .*heavy"),
        (
            TEXT.replace('baseStepSize="0.1"', 'baseStepSize="fast"'),
            "line [0-9]+: FixedStepAlgorithm baseStepSize: expected",
        ),
        (TEXT.replace(' baseStepSize="0.1"', ""), "baseStepSize: expected a number, got none"),
    ],
)
def test_invalid_documents_are_errors(text: str, problem: str):
    with pytest.raises(SetupError, match=f"^here: .*{problem}") as error:
        ssd.read_description(text.encode(), "here")
    assert len(error.value.problems) == 1


def test_another_kind_of_document_is_an_error():
    with pytest.raises(SetupError, match="here: expected <ssv:ParameterSet> of SSP 1.0 or 2.0, got <ParameterMapping>"):
        ssv.read_parameter_set(write_document(MAPPING), "here")


def test_an_entity_is_not_expanded_from_a_file(tmp_path: Path):
    (tmp_path / "secret").write_text("secret")
    text = TEXT.replace("?>", f'?><!DOCTYPE a [<!ENTITY x SYSTEM "file://{tmp_path}/secret">]>', 1)
    with pytest.raises(SetupError, match="without a document type") as error:
        ssd.read_description(text.replace('name="Seat"', 'name="Seat"', 1).encode(), "here")
    assert "secret" not in str(error.value).replace(str(tmp_path), "")
