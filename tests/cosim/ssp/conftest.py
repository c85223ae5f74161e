"""Small FMUs for systems as they are found."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.helpers.wild import Var, Wild, par, var_in

GEARS = (
    "<TypeDefinitions><SimpleType name='Gear'><Enumeration><Item name='R' value='1'/><Item name='1' value='2'/>"
    "<Item name='2' value='3'/></Enumeration></SimpleType></TypeDefinitions>"
)
EXPERIMENT = 'startTime="0" stopTime="1" stepSize="0.1"'


@pytest.fixture(scope="session")
def gain(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An FMU with y = k u."""
    gain = Wild([var_in("u"), par("k", start="1"), Var("y")], "m->y[0] = m->k[0] * m->u[0];", experiment=EXPERIMENT)
    return gain.build(tmp_path_factory.mktemp("gain") / "Gain.fmu")


@pytest.fixture(scope="session")
def typed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An FMU with inputs, parameters and outputs of all types; ``seen`` is the sum of the parameters."""
    types = ("Real", "Integer", "Boolean", "Enumeration")
    gear = {"Enumeration": "declaredType='Gear'"}
    start = {"Enumeration": "1", "Boolean": "false"}
    variables = [
        *(var_in(f"in_{t}", t, start.get(t, "0"), more=gear.get(t, "")) for t in types),
        *(par(t, t, start.get(t, "0"), more=gear.get(t, "")) for t in types),
        par("text", "String", ""),
        *(Var(f"out_{t}", t, more=gear.get(t, "")) for t in types),
        Var("seen"),
        Var("early", causality="calculatedParameter", variability="fixed", initial="calculated"),
    ]
    lines = " ".join(f"m->out_{t}[0] = m->{t}[0];" for t in types)
    total = " + ".join(f"m->{t}[0]" for t in types)
    lines += f" m->seen[0] = {total}; m->early[0] = 10 * m->Real[0];"
    wild = Wild(variables, lines, experiment=EXPERIMENT, before=GEARS)
    return wild.build(tmp_path_factory.mktemp("typed") / "Typed.fmu")
