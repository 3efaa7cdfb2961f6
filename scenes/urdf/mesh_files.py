"""Mesh files that a URDF names, found below their package's folder or the URDF's own, and nowhere else."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.scenes.bounds import MAX_MESH_BYTES
from assur.scenes.faults import DocumentError
from assur.scenes.files import FORMATS, below
from assur.scenes.urdf.refusals import Unsuitable
from assur.scenes.urdf.tree import Solid

ENDINGS = {**FORMATS, ".dae": "dae"}
PACKAGE = "package://"


def mesh_triangles(solid: Solid, urdf: Path, packages: dict[str, Path]) -> FloatArray:
    """The triangles (f, 3, 3) of a mesh in its link's frame, m, as the file has them. Raises `Unsuitable`."""
    from assur.scenes.meshes.load import triangles_of

    path = mesh_path(solid, urdf, packages)
    content = path.read_bytes()
    try:
        triangles = triangles_of(content, ENDINGS[path.suffix.lower()])
    except InputError as error:
        what = f"mesh {path.name}: {str(error.value)[:60]}"
        raise Unsuitable(solid.where, what, f"needed is {error.allowed}") from error
    if not np.isfinite(triangles).all():
        raise Unsuitable(solid.where, f"mesh {path.name}: a vertex that is not finite", "finite vertices")
    scaled = triangles * np.array(solid.scale)
    if np.prod(solid.scale) < 0.0:  # mirrored: faces would look inwards
        scaled = scaled[:, ::-1]
    found: FloatArray = scaled @ solid.origin[:3, :3].T + solid.origin[:3, 3]
    return found


def mesh_path(solid: Solid, urdf: Path, packages: dict[str, Path]) -> Path:
    """The mesh file that a URDF names. Raises `Unsuitable` unless it is a regular file, no link, below the folder of
    its package, or, for a name without package, below that of the URDF's."""
    name = solid.file
    endings = ", ".join(ENDINGS)
    if Path(name).suffix.lower() not in ENDINGS:
        raise Unsuitable(solid.where, f"mesh {name!r}", f"a mesh in a file that ends in {endings}")
    if name.startswith(PACKAGE):
        package, _, inside = name.removeprefix(PACKAGE).partition("/")
        folder = packages.get(package) or package_above(package, urdf)
        if folder is None:
            what = f"mesh {name!r}: the folder of package {package!r} is not known"
            raise Unsuitable(solid.where, what, f"say --package {package}=FOLDER")
    elif "://" in name or Path(name).is_absolute():
        # file:////a/b, as xacro makes of file:///$(find a)/b, is /a/b: two slashes at the front are another root
        plain = name.removeprefix("file://")
        path = Path(os.path.normpath("/" + plain.lstrip("/") if plain.startswith("/") else plain))
        known = [each.resolve() for each in (*packages.values(), _root(urdf))]
        found = next((each for each in known if path.is_absolute() and path.is_relative_to(each)), None)
        if found is None:
            supply = "a name relative to the URDF's folder, or package://NAME/... with --package NAME=FOLDER"
            raise Unsuitable(solid.where, f"mesh {name!r} is a path of somebody's machine", supply)
        folder, inside = found, str(path.relative_to(found))
    else:
        start = urdf.resolve().parent
        folder = next((each.resolve() for each in packages.values() if start.is_relative_to(each.resolve())), None)
        folder = folder or _root(urdf)
        inside = os.path.relpath(os.path.normpath(start / name), folder)
    try:
        return below(folder, inside, "mesh", ENDINGS, MAX_MESH_BYTES)
    except DocumentError as error:
        path = Path(os.path.normpath(folder / inside))
        if path.is_relative_to(folder) and not os.path.lexists(path):
            alike = _spelled_otherwise(path)
            what = f"mesh {name!r} is not there: no file {inside!r} below the folder {folder.name!r}"
            supply = f"say --package NAME=FOLDER if it is elsewhere{alike}"
        else:
            what = f"mesh {name!r} leaves the folder {folder.name!r}, is a link or no file, or is too large"
            supply = f"a regular file, no link, of up to {MAX_MESH_BYTES} bytes below that folder"
        raise Unsuitable(solid.where, what, supply) from error


def _spelled_otherwise(path: Path) -> str:
    """A hint at a file whose name differs by capitals only."""
    if not path.parent.is_dir():
        return ""
    alike = [each.name for each in path.parent.iterdir() if each.name.lower() == path.name.lower()]
    return f"; the folder has {alike[0]!r}, and capitals count" if alike else ""


def package_above(package: str, urdf: Path) -> Path | None:
    """The folder of a package around a URDF: one of that name above it, or beside one above it."""
    for folder in urdf.resolve().parents[:8]:
        if folder.name == package:
            return folder
        if package and (folder / package / "package.xml").is_file():
            return folder / package
    return None


def _root(urdf: Path) -> Path:
    """The folder below which names without a package must lead: that of the package around the URDF, else its own."""
    folders = urdf.resolve().parents
    return next((folder for folder in folders[:8] if (folder / "package.xml").is_file()), folders[0])
