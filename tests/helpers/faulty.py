"""Faulty FMUs: small, whole, real ones, compiled from ``native/faulty.c`` with the fault a test asks for."""

from __future__ import annotations

import re
import subprocess
import sys
import zipfile
from pathlib import Path
from shutil import which

import fmpy

from tests.helpers.paths import SOURCES

SOURCE = SOURCES / "faulty.c"
HEADERS = Path(fmpy.__file__).parent / "c-code"

WHATS, WHERES = (
    re.sub(r"\s", "", found).split(",") for found in re.findall(r"enum \{([^}]*)\};", SOURCE.read_text())[:2]
)
"""Faults, and calls in which they strike, as the C file counts them."""

DESCRIPTIONS = {
    2: """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="Faulty" guid="{faulty}">
  <CoSimulation modelIdentifier="faulty" canHandleVariableCommunicationStepSize="true"/>
  <ModelVariables>
    <ScalarVariable name="time" valueReference="0" causality="independent"><Real/></ScalarVariable>
    <ScalarVariable name="u" valueReference="1" causality="input"><Real start="0"/></ScalarVariable>
    <ScalarVariable name="y" valueReference="2" causality="output"><Real/></ScalarVariable>
    <ScalarVariable name="strikes_at" valueReference="3" causality="parameter" variability="fixed">
      <Real start="0.1"/>
    </ScalarVariable>
  </ModelVariables>
  <ModelStructure>
    <Outputs><Unknown index="3"/></Outputs>
    <InitialUnknowns><Unknown index="3"/></InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>
""",
    3: """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="Faulty" instantiationToken="{faulty}">
  <CoSimulation modelIdentifier="faulty" canHandleVariableCommunicationStepSize="true"/>
  <ModelVariables>
    <Float64 name="time" valueReference="0" causality="independent" variability="continuous"/>
    <Float64 name="u" valueReference="1" causality="input" start="0"/>
    <Float64 name="y" valueReference="2" causality="output"/>
    <Float64 name="strikes_at" valueReference="3" causality="parameter" variability="fixed" start="0.1"/>
  </ModelVariables>
  <ModelStructure><Output valueReference="2"/><InitialUnknown valueReference="2"/></ModelStructure>
</fmiModelDescription>
""",
}


def compiler() -> list[str]:
    """The system's compiler where there is one, as it starts faster, else zig."""
    return ["gcc"] if which("gcc") else [sys.executable, "-m", "ziglang", "cc"]


def faulty_fmu(folder: Path, what: str = "ok", where: str = "step", fmi: int = 2) -> Path:
    """Build an FMU that fails in one way; once only.

    Parameters
    ----------
    folder
        Where FMUs are kept.
    what
        Fault, one of :data:`WHATS`.
    where
        Call in which it strikes, one of :data:`WHERES`; those of stepping from the time ``strikes_at`` on.
    fmi
        Version of FMI.
    """
    path = folder / f"{what}-{where}-{fmi}.fmu"
    if path.exists():
        return path
    library = path.with_suffix(fmpy.sharedLibraryExtension)
    fault = [f"-DFMI={fmi}", f"-DWHAT={WHATS.index(what)}", f"-DWHERE={WHERES.index(where)}"]
    options = ["-std=gnu11", "-O1", "-g0", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC", f"-I{HEADERS}"]
    subprocess.run([*compiler(), *options, *fault, SOURCE, "-o", library, "-lm"], check=True)
    platform = fmpy.platform if fmi == 2 else fmpy.platform_tuple
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", DESCRIPTIONS[fmi])
        archive.write(library, f"binaries/{platform}/faulty{fmpy.sharedLibraryExtension}")
    return path
