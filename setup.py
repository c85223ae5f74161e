"""What pyproject.toml cannot say about the wheel: platforms, examples, bill of materials, reproducible bytes."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

from setuptools import setup
from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.command.build_py import build_py

HERE = Path(__file__).parent

TAGS = {
    "x86_64-linux": ("manylinux_2_17_x86_64", "manylinux2014_x86_64"),
    "aarch64-linux": ("manylinux_2_17_aarch64", "manylinux2014_aarch64"),
    "x86_64-windows": ("win_amd64",),
    "x86_64-darwin": ("macosx_10_13_x86_64",),
    "aarch64-darwin": ("macosx_11_0_arm64",),
}
"""Platform of binaries (see fmus.export.native_fmu.PLATFORMS) to the tags of systems that load them."""


FOREIGN = (
    ("FMI headers", "3.0", "BSD-2-Clause", "in the sources of FMUs of FMI 3.0"),
    ("FMI headers", "2.0.1", "BSD-2-Clause", "in the sources of FMUs of FMI 2.0"),
    ("mingw-w64 runtime", "of ziglang", "ZPL-2.1", "linked into binaries for Windows"),
)
"""What the wheel holds of others: name, version, licence, and where."""


def bill_of_materials(name: str, version: str, requirements: list[str]) -> str:
    """Write a CycloneDX document of the wheel: what it holds of others, and the packages that it needs (PEP 770)."""
    own = f"pkg:pypi/{name}@{version}"
    foreign = [
        {
            "type": "library",
            "bom-ref": f"{title} {edition}",
            "name": title,
            "version": edition,
            "description": where,
            "licenses": [{"license": {"id": licence}}],
        }
        for title, edition, licence, where in FOREIGN
    ]
    needed = [
        {"type": "library", "bom-ref": requirement, "name": re.split(r"[^\w.-]", requirement)[0], "scope": "required"}
        for requirement in requirements
    ]
    document = {
        "bomFormat": "CycloneDX",
        "specVersion": "1.6",
        "version": 1,
        "metadata": {
            "component": {"type": "library", "bom-ref": own, "name": name, "version": version, "purl": own},
        },
        "components": [*foreign, *needed],
        "dependencies": [{"ref": own, "dependsOn": [each["bom-ref"] for each in (*foreign, *needed)]}],
    }
    return json.dumps(document, indent=1) + "\n"


class BuildPackages(build_py):
    """Builds packages from nothing, so that no file of an earlier build stays, and adds the examples."""

    def run(self) -> None:
        """Copy all files."""
        if not self.editable_mode:
            shutil.rmtree(self.build_lib, ignore_errors=True)
        super().run()
        if not self.editable_mode:
            target = Path(self.build_lib, "seat_cosim", "examples")
            shutil.copytree(HERE / "examples", target, ignore=shutil.ignore_patterns("__pycache__", "*.fmu"))


class BuildWheel(bdist_wheel):
    """Builds a wheel whose tag names the platforms of the binaries in it: no more, and no version of Python."""

    def get_tag(self) -> tuple[str, str, str]:
        """Return the tags of interpreter, ABI and platforms; ``any`` for a wheel without binaries."""
        libraries = (HERE / "cosim" / "engine" / "built").glob("*/stepper.*")
        carried = {path.parent.name for path in libraries} if (HERE / "fmus" / "built").is_dir() else set()
        tags = [tag for platform, platform_tags in TAGS.items() if platform in carried for tag in platform_tags]
        return "py3", "none", ".".join(sorted(tags)) or "any"

    def write_wheelfile(self, wheelfile_base: str, *arguments: object, **options: object) -> None:
        """Write WHEEL and the bill of materials, and give all files the same permissions, whatever the umask."""
        super().write_wheelfile(wheelfile_base, *arguments, **options)
        about = self.distribution
        bill = Path(wheelfile_base, "sboms", f"{about.get_name()}.cdx.json")
        bill.parent.mkdir()
        bill.write_text(
            bill_of_materials(about.get_name(), about.get_version(), list(about.install_requires)), encoding="utf-8"
        )
        for path in Path(self.bdist_dir).rglob("*"):
            path.chmod(0o755 if path.is_dir() else 0o644)


setup(cmdclass={"build_py": BuildPackages, "bdist_wheel": BuildWheel})
