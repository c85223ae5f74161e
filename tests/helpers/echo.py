"""Build the FMU of ``native/echo.c``, which copies inputs to outputs, for the tests of the steppers."""

from __future__ import annotations

import re
from pathlib import Path

from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave

from cosim.fmi.archive import write_archive
from fmus.export.native_fmu import PLATFORMS, compile_binary, host_platform
from tests.helpers.paths import SOURCES

TYPES = {
    2: ("Real", "Integer", "Boolean"),
    3: ("Float64", "Float32", "Boolean", *(f"{sign}Int{bits}" for sign in ("", "U") for bits in (8, 16, 32, 64))),
}
"""Types of the variables ``in.TYPE`` and ``out.TYPE``, by major version of FMI."""

FAULTS = ("none", "setting", "getting", "stepping", "ending", "early", "warning", "not a number", "slow")
"""Values of the parameter ``fault``, from 0; most faults occur in the 51st step."""


def build_echo(version: int, folder: Path) -> Path:
    """Build the FMU for a major version of FMI.

    Parameters
    ----------
    version
        Major version of FMI.
    folder
        Where the FMU is written.

    Returns
    -------
    Path
        The FMU.
    """
    source = (SOURCES / "echo.c").read_text()
    fmpy_class = {2: FMU2Slave, 3: FMU3Slave}[version]
    names = [name for name in dir(fmpy_class) if name.startswith(f"fmi{version}")]
    source = f"#define FMI{version}\n{source}"
    written = re.sub(r"ACCESS\((\w+),", rf"fmi{version}Get\1( fmi{version}Set\1(", source)
    stubs = "".join(f"int {name}(void) {{ return 0; }}\n" for name in names if f"{name}(" not in written)
    platform = PLATFORMS[host_platform()]
    exported = "#pragma GCC visibility push(default)\n" if platform.extension != ".dll" else ""
    binary = compile_binary("Echo", {"echo.c": (exported + source + stubs).encode()}, platform)
    path = folder / f"Echo{version}.fmu"
    contents = {
        "modelDescription.xml": _description(version).encode(),
        f"binaries/{platform.folder(f'{version}.0')}/Echo{platform.extension}": binary,
    }
    write_archive(path, contents)
    return path


def _description(version: int) -> str:
    kinds = TYPES[version]
    whole, real = ("Integer", "Real") if version == 2 else ("Int32", "Float64")
    variables = [
        _variable(version, whole, "fault", 0, "parameter", "fixed", start=True),
        _variable(version, whole, "count", 1, "output", "discrete"),
        _variable(version, real, "reached", 2, "output", "continuous"),
    ]
    for i, kind in enumerate(kinds):
        variability = "continuous" if kind.startswith(("Real", "Float")) else "discrete"
        variables.append(_variable(version, kind, f"in.{kind}", 100 + i, "input", variability, start=True))
        variables.append(_variable(version, kind, f"out.{kind}", 200 + i, "output", variability))
    token = {2: "guid", 3: "instantiationToken"}[version]
    return (
        f'<fmiModelDescription fmiVersion="{version}.0" modelName="Echo" {token}="echo">'
        '<CoSimulation modelIdentifier="Echo" canHandleVariableCommunicationStepSize="true"/>'
        f"<ModelVariables>{''.join(variables)}</ModelVariables><ModelStructure/></fmiModelDescription>"
    )


def _variable(
    version: int, kind: str, name: str, reference: int, causality: str, variability: str, start: bool = False
) -> str:
    text = {"Boolean": "false"}.get(kind, "0")
    begin = f' start="{text}"' if start else ""
    common = f'name="{name}" valueReference="{reference}" causality="{causality}" variability="{variability}"'
    if version == 2:
        return f"<ScalarVariable {common}><{kind}{begin}/></ScalarVariable>"
    return f"<{kind} {common}{begin}/>"
