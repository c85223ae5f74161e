"""FMUs with one fault each, compiled from ``native/faulty.c``."""

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

FAULTS, CALLS = (
    re.sub(r"\s", "", found).split(",") for found in re.findall(r"enum \{([^}]*)\};", SOURCE.read_text())[:2]
)
"""Faults, and calls in which they occur, in the order of the enumerations of the C file."""

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


def compile_library(source: Path, library: Path, *options: str) -> None:
    """Compile an FMU's library with gcc where it is installed, which starts faster, else with zig.

    Parameters
    ----------
    source
        The C file.
    library
        The library that is written.
    *options
        Further options of the compiler.
    """
    compiler = ["gcc"] if which("gcc") else [sys.executable, "-m", "ziglang", "cc"]
    common = ["-std=gnu11", "-O1", "-g0", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC", f"-I{HEADERS}"]
    subprocess.run([*compiler, *common, *options, source, "-o", library, "-lm"], check=True)


def library_member(name: str, fmi: int) -> str:
    """Return the path of a library for this platform in an FMU.

    Parameters
    ----------
    name
        Model identifier.
    fmi
        Major version of FMI.
    """
    platform = fmpy.platform if fmi == 2 else fmpy.platform_tuple
    return f"binaries/{platform}/{name}{fmpy.sharedLibraryExtension}"


def faulty_fmu(folder: Path, fault: str = "ok", call: str = "step", fmi: int = 2) -> Path:
    """Build an FMU with one fault, unless it exists already.

    Parameters
    ----------
    folder
        Where the FMUs are written.
    fault
        One of :data:`FAULTS`.
    call
        Call in which the fault occurs, one of :data:`CALLS`; in steps, from the time of the parameter ``strikes_at``
        on.
    fmi
        Major version of FMI.

    Returns
    -------
    Path
        The FMU.
    """
    path = folder / f"{fault}-{call}-{fmi}.fmu"
    if path.exists():
        return path
    library = path.with_suffix(fmpy.sharedLibraryExtension)
    compile_library(SOURCE, library, f"-DFMI={fmi}", f"-DWHAT={FAULTS.index(fault)}", f"-DWHERE={CALLS.index(call)}")
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", DESCRIPTIONS[fmi])
        archive.write(library, library_member("faulty", fmi))
    return path
