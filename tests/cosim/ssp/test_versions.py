"""Documents of SSP 2.0: read where they need nothing but what SSP 1.0 has, else refused with each feature's name."""

from __future__ import annotations

from pathlib import Path

import pytest

from cosim import SetupError
from cosim.ssp import ssd
from tests.helpers.ssd_text import (
    NAMESPACES,
    bindings,
    component,
    connection,
    connector,
    connectors,
    document,
    load,
    parameter_set,
    value,
)

pytestmark = pytest.mark.builds

ELEMENTS = (component("a", inside=connectors(y="output") + bindings(value("k", 2.0))), component("b"))
JOIN = connection(("a", "y"), ("b", "u"))
METADATA = '<ssc:MetaData kind="general" type="text/plain"><ssc:Content>x<a/></ssc:Content></ssc:MetaData>'
SIGNATURE = '<ssc:Signature role="authenticity" type="x/y"><ssc:Content/></ssc:Signature>'
EXPERIMENT = '<ssd:DefaultExperiment startTime="1" stopTime="3"/>'


def test_a_document_of_2_0_with_the_content_of_1_0_is_read(gain: Path, tmp_path: Path):
    old = document(*ELEMENTS, joins=JOIN, after=EXPERIMENT)
    for new in (
        old.replace('version="1.0" name', 'version="2.0" name'),
        document(*ELEMENTS, joins=JOIN, after=EXPERIMENT + METADATA + SIGNATURE, version="2.0"),
        old.replace('version="1.0" name="test"', 'version="2.0" name="test"').replace(
            "</ssd:Component>", f"{METADATA}</ssd:Component>"
        ),
    ):
        loaded, expected = load(tmp_path, new, gain), load(tmp_path, old, gain)
        assert (loaded.parameters, loaded.connections) == (expected.parameters, expected.connections)
        assert (loaded.start_time, loaded.stop_time) == (1.0, 3.0)


def test_inner_and_other_documents_have_versions_of_their_own(gain: Path, tmp_path: Path):
    inner = document(*ELEMENTS).replace('<ssv:ParameterSet version="1.0"', '<ssv:ParameterSet version="2.0"')
    assert load(tmp_path, inner, gain).parameters == {"a.k": 2.0}
    (tmp_path / "p.ssv").write_text(parameter_set(value("k", 4.0), root=NAMESPACES, version="2.0"))
    bound = '<ssd:ParameterBindings><ssd:ParameterBinding source="p.ssv"/></ssd:ParameterBindings>'
    assert load(tmp_path, document(component("a", inside=bound)), gain).parameters == {"a.k": 4.0}
    (tmp_path / "p.ssv").write_text(parameter_set(value("k", 4, "Float64"), root=NAMESPACES, version="2.0"))
    with pytest.raises(SetupError, match=r"p.ssv: line 1: expected features of SSP 1.0 only, got the type Float64 of"):
        load(tmp_path, document(component("a", inside=bound)), gain)


def with_connector(inside: str, kind: str = "output") -> str:
    return component("a", inside=f'<ssd:Connectors><ssd:Connector name="y" kind="{kind}">{inside}</ssd:Connector>'
                                 "</ssd:Connectors>")  # fmt: skip


FEATURES = {
    "the type Float64": with_connector("<ssc:Float64/>"),
    "the type UInt8": with_connector("<ssc:UInt8/>"),
    "the type Clock": with_connector("<ssc:Clock/>"),
    "the type Int32": component("a", inside=bindings(value("k", 4, "Int32"))),
    r"an array \(Dimension\)": with_connector('<ssc:Real/><ssc:Dimension size="3"/>'),
    r"a clocked connector \(Clock\)": with_connector('<ssc:Real/><ssd:Clock name="c"/>'),
    "kind='structuralParameter'": with_connector("<ssc:Integer/>", "structuralParameter"),
    "kind='local'": with_connector("<ssc:Real/>", "local"),
    "implementation='ScheduledExecution'": component("a", attributes='implementation="ScheduledExecution"'),
    "the component a without a source": component("a").replace('source="Gain.fmu"', ""),
}


@pytest.mark.parametrize("feature", FEATURES)
def test_features_of_2_0_are_refused_by_name(gain: Path, tmp_path: Path, feature: str):
    with pytest.raises(SetupError, match=f"expected features of SSP 1.0 only, got {feature} of SSP 2.0") as error:
        load(tmp_path, document(FEATURES[feature], version="2.0"), gain)
    assert len(error.value.problems) == 1
    with pytest.raises(SetupError, match="valid against the schema of SSP 1.0"):
        load(tmp_path, document(FEATURES[feature]), gain)


def test_all_features_are_named_at_once(gain: Path, tmp_path: Path):
    joins = connection(("a", "y"), ("b", "u"), attributes='startIndices="1" endIndices="2"')
    elements = (FEATURES["the type Float64"], component("b", inside=bindings(value("k", 1, "Float32"))))
    with pytest.raises(SetupError) as error:
        load(tmp_path, document(*elements, joins=joins, version="2.0"), gain)
    found = {problem.partition("got ")[2].removesuffix(" of SSP 2.0") for problem in error.value.problems}
    assert found == {"the type Float64", "the type Float32", "startIndices='1'", "endIndices='2'"}


@pytest.mark.parametrize("version", ["2.1", "3.0", "Draft20180219", "10", "0.9"])
def test_other_versions_are_refused(version: str):
    with pytest.raises(
        SetupError, match=f"here: <SystemStructureDescription>: expected version 1.0 or 2.0, got {version}"
    ):
        ssd.read_description(document(version=version).encode(), "here")


def test_what_is_wrong_in_1_0_is_wrong_in_2_0(gain: Path, tmp_path: Path):
    inside = f"<ssd:Connectors>{connector('y', 'knob')}</ssd:Connectors>"
    with pytest.raises(SetupError, match="valid against the schema of SSP 1.0, got line 1: .*knob"):
        load(tmp_path, document(component("a", inside=inside), version="2.0"), gain)
