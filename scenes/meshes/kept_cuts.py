"""The cuts of a cover as a file, and back: data from outside, which is checked before it is used.

The file says where a mesh is cut, not which hulls come of it: these are made anew of the mesh itself, each is checked
to hold its points, and together they hold the mesh whatever the cuts are (M1). So no file can uncover anything. The
digest of the hulls shows that it is the cover which would be computed here, and not another one.
"""

from __future__ import annotations

import hashlib
import json
from functools import cache
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from assur.planner.errors import FaultError
from assur.planner.geometry.shapes import Hull
from assur.scenes.meshes.cover import MAX_PIECES, Cover, Cuts, cover_by
from assur.scenes.meshes.parts import Parts
from assur.scenes.meshes.surface import Surface

FORM = "assur-cover/1"
"""Mark of the file."""


class KeptCutsError(Exception):
    """A file of cuts that cannot be used, and why. `other`: it is whole, and of another version."""

    def __init__(self, why: str, *, other: bool = False) -> None:
        super().__init__(why)
        self.other = other


class _Kept(BaseModel):
    """The file, as `Cuts` has it, with the digest of the hulls that come of it."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)
    form: Literal["assur-cover/1"]
    version: str
    mesh: str
    convex: bool
    planes: Annotated[tuple[tuple[int, Literal[0, 1, 2], float], ...], Field(max_length=MAX_PIECES - 1)]
    groups: tuple[tuple[int, ...], ...]
    excess_m: Annotated[float, Field(ge=0.0)]
    hulls: str


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
        kept = _Kept.model_validate_json(content, strict=True)
    except ValidationError as error:
        raise KeptCutsError("no file of cuts") from error
    if kept.mesh != mesh:
        raise KeptCutsError("another mesh")
    if kept.version != version():
        raise KeptCutsError("another version", other=True)
    cover = yield from cover_by(surface, _cuts(kept))
    if hulls_digest(cover) != kept.hulls:
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


def _cuts(kept: _Kept) -> Cuts:
    if kept.convex and kept.planes:
        raise KeptCutsError("too many cuts")
    cells = {0}
    for i, (number, _, _) in enumerate(kept.planes):
        if number not in cells:
            raise KeptCutsError("a cut of no cell")
        cells = (cells - {number}) | {2 * i + 1, 2 * i + 2}
    if sorted(x for group in kept.groups for x in group) != sorted(cells):
        raise KeptCutsError("groups of other cells")
    return Cuts(kept.convex, kept.planes, kept.groups, kept.excess_m)
