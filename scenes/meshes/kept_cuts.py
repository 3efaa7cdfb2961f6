"""The cuts of a cover as a file, and back: data from outside, which is checked before it is used.

The file says where a mesh is cut, not which hulls come of it: these are made anew of the mesh itself, each is checked
to hold its points, and together they hold the mesh whatever the cuts are (M1). So no file can uncover anything. That it
is the cover which would be found here, too, and not another one, is told by the digest of the hulls.
"""

from __future__ import annotations

import hashlib
import json
import math
from functools import cache
from pathlib import Path
from typing import Any

from assur.planner.errors import FaultError, InputError
from assur.planner.geometry.shapes import Hull
from assur.scenes.meshes.cover import MAX_PIECES, Cover, Cuts, cover_by
from assur.scenes.meshes.parts import Parts
from assur.scenes.meshes.surface import Surface
from assur.scenes.text.json_text import parse_json

FORM = "assur-cover/1"
"""Mark of the file."""
KEYS = {"form", "version", "mesh", "convex", "planes", "groups", "excess_m", "hulls"}


class KeptCutsError(Exception):
    """A file of cuts that cannot be used, and why. `other`: it is whole, and of another version."""

    def __init__(self, why: str, *, other: bool = False) -> None:
        super().__init__(why)
        self.other = other


@cache
def version() -> str:
    """Mark of the way in which covers are found here: of this code and of the libraries that compute."""
    import numpy as np
    import scipy

    found = hashlib.sha256(f"{np.__version__} {scipy.__version__}".encode())
    for path in sorted(Path(__file__).parent.glob("*.py")):
        found.update(path.read_bytes())
    return found.hexdigest()[:16]


def written(mesh: str, cuts: Cuts, cover: Cover) -> bytes:
    """The file of the cuts of a mesh, which is named by its digest, format and unit."""
    document = {
        "form": FORM,
        "version": version(),
        "mesh": mesh,
        "convex": cuts.convex,
        "planes": [list(plane) for plane in cuts.planes],
        "groups": [list(group) for group in cuts.groups],
        "excess_m": cuts.excess_m,
        "hulls": hulls_digest(cover),
    }
    return json.dumps(document, allow_nan=False).encode("ascii")


def cover_from(content: bytes, mesh: str, surface: Surface) -> Parts[Cover]:
    """The cover of a surface with the cuts in a file. Raises `KeptCutsError` for a file that is torn, of another mesh,
    or does not give the hulls that it was made with."""
    try:
        document = parse_json(content)
    except InputError as error:
        raise KeptCutsError("no JSON") from error
    if not (isinstance(document, dict) and document.keys() == KEYS and document["form"] == FORM):
        raise KeptCutsError("other fields")
    if document["mesh"] != mesh:
        raise KeptCutsError("another mesh")
    if document["version"] != version():
        raise KeptCutsError("another version", other=True)
    cover = yield from cover_by(surface, _cuts(document))
    if hulls_digest(cover) != document["hulls"]:
        raise KeptCutsError("other hulls")
    return cover


def hulls_digest(cover: Cover) -> str:
    """SHA-256 of the corners and faces of a cover."""
    found = hashlib.sha256()
    for piece in cover.pieces:
        if not isinstance(piece.shape, Hull):
            raise FaultError("a cover has a piece that is no hull")
        for array in (piece.shape.vertices, piece.shape.faces):
            found.update(repr(array.shape).encode() + array.tobytes())
    return found.hexdigest()


def _cuts(document: dict[str, Any]) -> Cuts:
    convex, planes, groups, excess = (document[key] for key in ("convex", "planes", "groups", "excess_m"))
    if not (isinstance(convex, bool) and isinstance(planes, list) and isinstance(groups, list)):
        raise KeptCutsError("fields of other types")
    if not (len(planes) < MAX_PIECES and (not convex or planes == [])):
        raise KeptCutsError("too many cuts")
    if not (type(excess) in (int, float) and math.isfinite(excess) and excess >= 0):
        raise KeptCutsError("an excess that is no length")
    cells = {0}
    for i, plane in enumerate(planes):
        if not (isinstance(plane, list) and len(plane) == 3 and all(type(x) is int for x in plane[:2])):
            raise KeptCutsError("a cut that is none")
        number, axis, at = plane
        if not (number in cells and axis in (0, 1, 2) and type(at) in (int, float) and math.isfinite(at)):
            raise KeptCutsError("a cut of no cell")
        cells = (cells - {number}) | {2 * i + 1, 2 * i + 2}
    if not all(isinstance(group, list) and all(type(x) is int for x in group) for group in groups):
        raise KeptCutsError("a group that is none")
    if sorted(x for group in groups for x in group) != sorted(cells):
        raise KeptCutsError("groups of other cells")
    return Cuts(
        convex,
        tuple((number, axis, float(at)) for number, axis, at in planes),
        tuple(tuple(group) for group in groups),
        float(excess),
    )
