"""What pyproject.toml cannot say about the wheel: its platforms, the examples in it, and reproducible bytes."""

from __future__ import annotations

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
        """Write the file WHEEL, and give all files the same permissions, whatever the umask."""
        super().write_wheelfile(wheelfile_base, *arguments, **options)
        for path in Path(self.bdist_dir).rglob("*"):
            path.chmod(0o755 if path.is_dir() else 0o644)


setup(cmdclass={"build_py": BuildPackages, "bdist_wheel": BuildWheel})
