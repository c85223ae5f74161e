"""Build of FMUs in all flavours; an FMU with unchanged content is not built again."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from importlib.metadata import version
from pathlib import Path

from cosim.fmi.archive import read_archive, write_archive
from fmus import FLAVOURS
from fmus.component import Component, DefaultExperiment
from fmus.export.fmu_file import BuildError, BuildResult, guid_of
from fmus.export.model_description import content_guid, model_description, to_xml
from fmus.export.native_fmu import PLATFORMS, STANDARDS, build_library, build_native_fmu, host_platform
from fmus.export.sources import source_files

__all__ = [
    "FLAVOURS",
    "PLATFORMS",
    "BuildError",
    "BuildResult",
    "build",
    "build_library",
    "build_python_fmu",
    "host_platform",
    "source_files",
]

_MAIN_SCRIPT = Path(__file__).parents[1] / "pythonfmu" / "main_script.py"


def _attribute(component: Component) -> str:
    """Return the name of a component in its module."""
    module = sys.modules[component.module]
    return next(name for name, value in vars(module).items() if value is component)


def build_python_fmu(component: Component, experiment: DefaultExperiment, folder: Path) -> BuildResult:
    """Build a component as a pythonfmu FMU, unless the folder has one of the same content.

    Parameters
    ----------
    component
        Component to build.
    experiment
        Default experiment of the model description.
    folder
        Folder for ``<name>.fmu``; created if it does not exist.

    Returns
    -------
    BuildResult
        Path of the FMU and whether it was built.

    Raises
    ------
    BuildError
        If pythonfmu's builder fails.
    """
    sources = source_files(component.module, "fmus.pythonfmu.component_slave")
    script = _MAIN_SCRIPT.read_bytes()
    guid = content_guid(
        to_xml(model_description(component, experiment, "", needs_execution_tool=True)),
        version("pythonfmu").encode(),
        script,
        *(part for name, path in sources.items() for part in (name.encode(), path.read_bytes())),
    )
    target = folder / f"{component.name}.fmu"
    if guid_of(target) == guid:
        return BuildResult(target, fresh=False)
    with tempfile.TemporaryDirectory(prefix="seat-cosim-") as temporary:
        stage = Path(temporary)
        main = stage / f"{component.name}_{guid.strip('{}').replace('-', '')}.py"  # see main_script.py
        main.write_bytes(script)
        for name, path in sources.items():
            (stage / "model" / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, stage / "model" / name)
        identity = {
            "guid": guid,
            "module": component.module,
            "attribute": _attribute(component),
            "experiment": experiment._asdict(),
        }
        (stage / "component.json").write_text(json.dumps(identity, indent=2) + "\n", encoding="utf-8")
        command = [sys.executable, "-m", "pythonfmu", "build", "--file", str(main), "--dest", str(stage / "built")]
        command += ["--handle-state", "--serialize-state"]  # the builder overwrites these capabilities
        command += [str(stage / "model"), str(stage / "component.json")]
        for name, content in component.resources().items():
            (stage / name).write_bytes(content)
            command.append(str(stage / name))
        run = subprocess.run(command, capture_output=True, text=True, check=False)
        built = stage / "built" / f"{component.name}.fmu"
        if run.returncode or not built.exists():
            raise BuildError(f"{component.name}: pythonfmu ended with {run.returncode}: {run.stderr.strip()[-500:]}")
        write_archive(target, read_archive(built))
    return BuildResult(target, fresh=True)


def build(
    components: Iterable[Component],
    experiment: DefaultExperiment,
    folder: Path,
    flavours: Sequence[str] = FLAVOURS,
    platforms: Sequence[str] = (),
) -> Iterator[BuildResult]:
    """Build components in the given flavours, one after the other.

    Parameters
    ----------
    components
        Components to build.
    experiment
        Default experiment of the model descriptions.
    folder
        Folder for the FMUs; each flavour has the subfolder of its name.
    flavours
        Names from :data:`FLAVOURS`.
    platforms
        Platforms of native FMUs, names from :data:`fmus.export.native_fmu.PLATFORMS`; the host's if empty.

    Yields
    ------
    BuildResult
        Result of each FMU when it is complete.

    Raises
    ------
    BuildError
        If a compiler or builder is missing or fails, or a platform is unknown.
    """
    for flavour in flavours:
        for component in components:
            if flavour in STANDARDS:
                yield build_native_fmu(flavour, component, experiment, folder / flavour, platforms)
            else:
                yield build_python_fmu(component, experiment, folder / flavour)
