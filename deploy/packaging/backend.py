"""How the project is built: setuptools, and the two places where the layout of the repository needs more.

The sources of `assur.planner` are in `planner` at the top of the repository, and likewise four other packages. A wheel
and a source archive take them from there. An editable install needs a folder `assur` that holds all of them: it makes
links in `src/assur`, which are not in git. docs/decisions/0014-import-name.md gives the reasons.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from setuptools import build_meta, find_packages
from setuptools.build_meta import (
    build_sdist,
    build_wheel,
    get_requires_for_build_editable,
    get_requires_for_build_sdist,
    get_requires_for_build_wheel,
    prepare_metadata_for_build_editable,
    prepare_metadata_for_build_wheel,
)
from setuptools.command.build_py import build_py

__all__ = [
    "BuildPy",
    "build_editable",
    "build_sdist",
    "build_wheel",
    "get_requires_for_build_editable",
    "get_requires_for_build_sdist",
    "get_requires_for_build_wheel",
    "link",
    "prepare_metadata_for_build_editable",
    "prepare_metadata_for_build_wheel",
]

ROOT = Path(__file__).parents[2]
FOLDERS = ("planner", "scenes", "api", "experiments", "prover")
"""Folder at the top of the repository; its import name is `assur.` and this name."""


class BuildPy(build_py):  # type: ignore[misc] # setuptools has no types for it
    """Takes `assur.planner` and its subpackages from `planner`, and likewise the other folders. No link is read."""

    def finalize_options(self) -> None:
        super().finalize_options()
        for name in FOLDERS:
            self.package_dir[f"assur.{name}"] = name
            self.packages += [f"assur.{name}", *(f"assur.{name}.{inner}" for inner in find_packages(name))]


def build_editable(
    wheel_directory: str, config_settings: Mapping[str, Any] | None = None, metadata_directory: str | None = None
) -> str:
    """The hook of PEP 660: makes the links, and then a wheel that adds `src` to the import path. Returns its name."""
    link(ROOT)
    name: str = build_meta.build_editable(wheel_directory, config_settings, metadata_directory)
    return name


def link(root: Path) -> None:
    """Makes a link in `src/assur` below `root` to each of `FOLDERS`: relative symbolic links, and on Windows junctions,
    which need no rights. A link to another place is replaced. Raises `FileExistsError` if something that is not a link
    has the name of one, and `FileNotFoundError` if a folder is missing."""
    for name in FOLDERS:
        folder, place = root / name, root / "src" / "assur" / name
        if not folder.is_dir():
            raise FileNotFoundError(f"{folder} is missing: this is not a complete source tree")
        if _is_link(place):
            if place.exists() and place.samefile(folder):
                continue
            place.unlink()
        elif place.exists():
            raise FileExistsError(f"{place} is not a link: move it away, a link to {folder} belongs here")
        if sys.platform == "win32":
            import _winapi

            _winapi.CreateJunction(str(folder.resolve()), str(place))
        else:
            place.symlink_to(Path("..", "..", name), target_is_directory=True)


def _is_link(place: Path) -> bool:
    """Whether this is a symbolic link or a junction, dangling ones included."""
    try:
        place.readlink()
    except OSError:  # also where there is nothing
        return False
    return True
