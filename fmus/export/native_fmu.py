"""Build of native FMUs: C kernel, glue code of the standard and model description, compiled for any platform."""

from __future__ import annotations

import platform as machine
import re
import subprocess
import tempfile
import zipfile
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from importlib.metadata import distribution
from pathlib import Path

import fmpy

from cosim.fmi.archive import write_archive
from fmus.component import Component, DefaultExperiment
from fmus.export import cross_check, documentation
from fmus.export.c_header import defaults_header, model_header
from fmus.export.compiler import find_compiler
from fmus.export.fmu_file import BuildError, BuildResult, guid_of
from fmus.export.model_description import (
    build_description_xml,
    content_guid,
    model_description,
    terminals_xml,
    to_xml,
)
from fmus.export.sources import kernel_files

_GLUE = Path(__file__).parents[1] / "native"
_FMI_HEADERS = Path(fmpy.__file__).with_name("c-code")

OPTIONS = ("-std=c99", "-O2", "-ffp-contract=off", "-fno-slp-vectorize")
"""Compiler options with an effect on results or speed; without fused operations all platforms give the same results."""

_HOST_OPTIONS = (*OPTIONS[:-1], "-fno-tree-slp-vectorize")
"""The same, in words that gcc and clang know."""

_LINK = ("-fvisibility=hidden", "-shared", "-s", "-g0", "-lm")


@dataclass(frozen=True)
class TargetPlatform:
    """Platform that a binary is compiled for.

    Attributes
    ----------
    name
        Name of its folder in FMI 3.
    fmi2_folder
        Name of its folder in FMI 2; that of FMI 3 if FMI 2 has none.
    target
        Target of zig, with the oldest system that the binary runs on.
    extension
        File extension of a shared library.
    options
        Further compiler options.
    """

    name: str
    fmi2_folder: str
    target: str
    extension: str
    options: tuple[str, ...] = ("-fPIC",)

    def folder(self, fmi_version: str) -> str:
        """Return the name of the folder of binaries in an FMU.

        Parameters
        ----------
        fmi_version
            ``"2.0"`` or ``"3.0"``.

        Returns
        -------
        str
            Name below ``binaries``.
        """
        return self.fmi2_folder if fmi_version == "2.0" else self.name


PLATFORMS = {
    platform.name: platform
    for platform in (
        TargetPlatform("x86_64-linux", "linux64", "x86_64-linux-gnu.2.17", ".so"),
        TargetPlatform("aarch64-linux", "aarch64-linux", "aarch64-linux-gnu.2.17", ".so"),
        TargetPlatform("x86_64-windows", "win64", "x86_64-windows-gnu", ".dll", ()),
        TargetPlatform("x86_64-darwin", "darwin64", "x86_64-macos.10.13", ".dylib"),
        TargetPlatform("aarch64-darwin", "aarch64-darwin", "aarch64-macos.11.0", ".dylib"),
    )
}
"""All platforms, by name."""


@dataclass(frozen=True)
class FmiStandard:
    """A version of FMI.

    Attributes
    ----------
    version
        Version in model descriptions.
    glue
        C file with the functions of the standard.
    headers
        Header files of the standard.
    license_file
        Path of the licence in an FMU.
    """

    version: str
    glue: str
    headers: tuple[str, ...]
    license_file: str


STANDARDS = {
    "fmi2": FmiStandard(
        "2.0",
        "fmi2.c",
        ("fmi2Functions.h", "fmi2FunctionTypes.h", "fmi2TypesPlatform.h"),
        "documentation/license.txt",
    ),
    "fmi3": FmiStandard(
        "3.0",
        "fmi3.c",
        ("fmi3Functions.h", "fmi3FunctionTypes.h", "fmi3PlatformTypes.h"),
        "documentation/licenses/license.txt",
    ),
}
"""Standards of the native flavours."""


def host_platform() -> str:
    """Return the name of the platform of this Python process."""
    architecture = {"amd64": "x86_64", "arm64": "aarch64"}.get(machine.machine().lower(), machine.machine())
    return f"{architecture}-{machine.system().lower()}"


def source_files(component: Component, standard: FmiStandard, token: str) -> dict[str, bytes]:
    """Return all source files of an FMU; the ``.c`` files are compiled, the others included.

    Parameters
    ----------
    component
        Component of the FMU.
    standard
        Standard of the glue code.
    token
        GUID or instantiation token.

    Returns
    -------
    dict
        File name to content.
    """
    glue = [_GLUE / name for name in (standard.glue, "instance.c", "instance.h", "paths.c", "paths.h", "component.h")]
    headers = [_FMI_HEADERS / name for name in standard.headers]
    files = {path.name: path.read_bytes() for path in (*kernel_files(component.module), *glue, *headers)}
    generated = {"model.h": model_header(component, token), "defaults.h": defaults_header(component)}
    return {**files, **{name: text.encode() for name, text in generated.items()}}


def _license() -> bytes:
    """Return the licence from the repository or the installed package."""
    here = Path(__file__).parents[2] / "LICENSE"
    text = here.read_text("utf-8") if here.exists() else distribution("seat-cosim").read_text("licenses/LICENSE")
    if not text:
        raise BuildError("native FMUs: expected the project's LICENSE, got no such file")
    return text.encode()


def fmu_files(
    component: Component, experiment: DefaultExperiment, standard: FmiStandard, token: str
) -> dict[str, bytes]:
    """Return all files of an FMU except its binaries.

    Parameters
    ----------
    component
        Component of the FMU.
    experiment
        Default experiment.
    standard
        Standard of the FMU.
    token
        GUID or instantiation token.

    Returns
    -------
    dict
        Name in the archive to content.
    """
    sources = source_files(component, standard, token)
    description = model_description(
        component,
        experiment,
        token,
        needs_execution_tool=False,
        fmi_version=standard.version,
        source_files=sorted(name for name in sources if name.endswith(".c")),
    )
    files = {f"sources/{name}": content for name, content in sources.items()}
    files["modelDescription.xml"] = to_xml(description)
    files["documentation/index.html"] = documentation.page(component, experiment).encode()
    files[standard.license_file] = _license()
    files |= {f"resources/{name}": content for name, content in component.resources().items()}
    if standard.version == "3.0":
        files["sources/buildDescription.xml"] = build_description_xml(description, " ".join(OPTIONS[1:3]))
        files["terminalsAndIcons/terminalsAndIcons.xml"] = terminals_xml(component, standard.version)
    return files


def compile_binary(name: str, sources: dict[str, bytes], platform: TargetPlatform) -> bytes:
    """Compile a shared library.

    Parameters
    ----------
    name
        Name of the library, without extension.
    sources
        Source files, content by name, see :func:`source_files`.
    platform
        Platform to compile for.

    Returns
    -------
    bytes
        Content of the shared library.

    Raises
    ------
    BuildError
        If the compiler fails; with its output.
    """
    compiler = find_compiler()
    if not compiler.takes_target and platform.name != host_platform():
        raise BuildError(
            f"{name} for {platform.name}: expected the compiler zig, as it is not this machine's, got none; "
            'run: pip install "seat-cosim[native]"'
        )
    target = ("-target", platform.target, *OPTIONS) if compiler.takes_target else _HOST_OPTIONS
    with tempfile.TemporaryDirectory(prefix="seat-cosim-") as temporary:
        folder = Path(temporary)
        for file, content in sources.items():
            (folder / file).write_bytes(content)
        library = name + platform.extension
        command = [*compiler.command, *target, *_LINK]
        command += [*platform.options, f"-ffile-prefix-map={folder}=.", "-I", "."]
        command += [f"-Wl,-install_name,@rpath/{library}"] if platform.extension == ".dylib" else []
        command += [*sorted(file for file in sources if file.endswith(".c")), "-o", library, "-lm"]
        run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        if run.returncode or not (folder / library).exists():
            raise BuildError(
                f"{name} for {platform.name}: {compiler.name} ended with {run.returncode}: {run.stderr.strip()[-500:]}"
            )
        return (folder / library).read_bytes()


def platforms_of(path: Path) -> set[str]:
    """Return the names of the folders of binaries in an FMU.

    Parameters
    ----------
    path
        Path of the FMU.

    Returns
    -------
    set of str
        Names of folders below ``binaries``.
    """
    with zipfile.ZipFile(path) as archive:
        return set(re.findall(r"^binaries/([^/]+)/", "\n".join(archive.namelist()), re.MULTILINE))


def build_native_fmu(
    flavour: str, component: Component, experiment: DefaultExperiment, folder: Path, platforms: Sequence[str] = ()
) -> BuildResult:
    """Build a component as a native FMU, unless the folder has one of the same content with these platforms.

    Parameters
    ----------
    flavour
        ``"fmi2"`` or ``"fmi3"``.
    component
        Component to build.
    experiment
        Default experiment of the model description.
    folder
        Folder for ``<name>.fmu`` and its cross-check files; created if it does not exist.
    platforms
        Names from :data:`PLATFORMS`; the host's if empty.

    Returns
    -------
    BuildResult
        Path of the FMU and whether it was built.

    Raises
    ------
    BuildError
        If the compiler is missing or fails, or a platform is unknown.
    """
    standard = STANDARDS[flavour]
    chosen = [_platform(name) for name in platforms or (host_platform(),)]
    parts = fmu_files(component, experiment, standard, "")
    options = " ".join((*OPTIONS, *_LINK)).encode()
    contents = (part for name, content in sorted(parts.items()) for part in (name.encode(), content))
    token = content_guid(find_compiler().version.encode(), options, *contents)
    target = folder / f"{component.name}.fmu"
    required = {platform.folder(standard.version) for platform in chosen}
    fresh = guid_of(target) != token or not required <= platforms_of(target)
    if fresh:
        files = fmu_files(component, experiment, standard, token)
        sources = source_files(component, standard, token)
        with ThreadPoolExecutor(2) as pool:
            binaries = list(pool.map(lambda platform: compile_binary(component.name, sources, platform), chosen))
        for platform, binary in zip(chosen, binaries, strict=True):
            path = f"binaries/{platform.folder(standard.version)}/{component.name}{platform.extension}"
            files[path] = binary
        write_archive(target, files)
        cross_check.write(component, experiment.step_size, folder)
    return BuildResult(target, fresh)


def build_library(
    name: str, sources: dict[str, bytes], mark: bytes, folder: Path, platforms: Sequence[str] = ()
) -> Iterator[BuildResult]:
    """Build a shared library that is no FMU, unless the folder has one of the same sources.

    Parameters
    ----------
    name
        Name of the library, without extension.
    sources
        Source files, content by name.
    mark
        Bytes that a library of these sources contains, and no other.
    folder
        Folder for the library; each platform has the subfolder of its name.
    platforms
        Names from :data:`PLATFORMS`; the host's if empty.

    Yields
    ------
    BuildResult
        Result of each library when it is complete.

    Raises
    ------
    BuildError
        If the compiler is missing or fails, or a platform is unknown.
    """
    for platform in [_platform(name) for name in platforms or (host_platform(),)]:
        target = folder / platform.name / f"{name}{platform.extension}"
        fresh = not target.is_file() or mark not in target.read_bytes()
        if fresh:
            binary = compile_binary(name, sources, platform)
            target.parent.mkdir(parents=True, exist_ok=True)
            unfinished = target.with_suffix(".tmp")
            unfinished.write_bytes(binary)
            unfinished.replace(target)
        yield BuildResult(target, fresh)


def _platform(name: str) -> TargetPlatform:
    if name not in PLATFORMS:
        raise BuildError(f"native FMUs: expected a platform among {', '.join(PLATFORMS)}, got {name}")
    return PLATFORMS[name]
