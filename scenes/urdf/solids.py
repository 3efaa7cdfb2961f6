"""Solids of the file's links as bodies of our document: primitives as they are, meshes by hulls that contain them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.planner.geometry.shapes import Hull
from assur.scenes.robot_facts import SIZES
from assur.scenes.urdf.mesh_files import mesh_triangles
from assur.scenes.urdf.refusals import Unsuitable
from assur.scenes.urdf.tree import Solid

if TYPE_CHECKING:
    from assur.scenes.meshes.surface import Surface

WELD_M = 1e-5
"""Vertices of a mesh that are this near may be one, where it is not closed otherwise."""
SLICES = 8
"""Cylinders in place of one mesh that is revolved, at most."""
AROUND = 48
"""Corners of the circle around a cylinder that is revolved about another axis: it is drawn around the true one."""


@dataclass(frozen=True, slots=True)
class Covering:
    """How meshes are covered: hulls reach this far out of the solid at most, m, if so many are enough; `open_hull`: a
    mesh that is not closed is taken as its convex hull."""

    tight_m: float
    most: int
    open_hull: bool


@dataclass(frozen=True, eq=False)
class Part:
    """A body of our document in the frame of its link: a primitive of the file at a pose, an upright cylinder about an
    axis, or a hull."""

    link: str
    name: str
    source: str
    shape: dict[str, Any]
    pose: FloatArray
    hull: Hull | None = None
    excess_m: float = 0.0


def exact(link: str, name: str, solid: Solid, frame: FloatArray, urdf: Path, more: tuple[Any, Covering]) -> list[Part]:
    """The bodies of a solid on a link of ours that moves as the file's does; `frame` (4, 4): the file's link in ours;
    `more`: folders of packages, and how meshes are covered. Raises `Unsuitable`."""
    packages, covering = more
    if solid.kind != "mesh":
        return [Part(link, name, solid.where, _primitive(solid), frame @ solid.origin)]
    triangles = mesh_triangles(solid, urdf, packages)
    hulls, excess = _hulls(solid.where, triangles @ frame[:3, :3].T + frame[:3, 3], covering)
    several = len(hulls) > 1
    return [
        Part(link, f"{name}-{i + 1}" if several else name, solid.where, {"mesh": {}}, np.eye(4), hull, excess)
        for i, hull in enumerate(hulls)
    ]


def revolved(
    link: str, name: str, solid: Solid, frame: FloatArray, urdf: Path, more: tuple[Any, Covering]
) -> list[Part]:
    """Upright cylinders about the vertical axis of `frame` (the file's link in a frame with its origin on the axis)
    that contain a solid at every angle about it. Raises `Unsuitable`."""
    packages, covering = more
    if solid.kind == "mesh":
        triangles = mesh_triangles(solid, urdf, packages)
        hull = _closed_or_hull(solid.where, triangles, covering)
        if isinstance(hull, Hull):
            triangles = hull.vertices[hull.faces]
    else:
        triangles = _around_primitive(solid)
    moved = triangles @ frame[:3, :3].T + frame[:3, 3]
    found = []
    slices = _slices(moved, covering.tight_m)
    for i, (low, high, radius) in enumerate(slices):
        pose = np.eye(4)
        pose[2, 3] = (low + high) / 2
        shape = {"cylinder": {"radius_m": radius, "height_m": high - low}}
        found.append(Part(link, f"{name}-{i + 1}" if len(slices) > 1 else name, solid.where, shape, pose))
    return found


def _primitive(solid: Solid) -> dict[str, Any]:
    """The shape in our document; a box has one list of sizes, other primitives a number for each."""
    fields = SIZES[solid.kind]
    sizes = [list(solid.sizes)] if len(fields) == 1 and len(solid.sizes) > 1 else solid.sizes
    return {solid.kind: dict(zip(fields, sizes, strict=True))}


def _around_primitive(solid: Solid) -> FloatArray:
    """Triangles (f, 3, 3) whose hull contains a primitive, in its link's frame: for an upright cylinder its radius is
    exceeded by 0.2 % at most."""
    from assur.scenes.meshes.hull import hull_of

    if solid.kind == "box":
        half = np.array(solid.sizes) / 2
        points = half * [[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    else:
        radius = solid.sizes[0] / math.cos(math.pi / AROUND)
        turn = np.arange(AROUND) * math.tau / AROUND
        ring = np.stack([radius * np.cos(turn), radius * np.sin(turn)], axis=1)
        half_height = solid.sizes[-1] / 2 + (solid.sizes[0] if solid.kind == "capsule" else 0.0)
        half_height = solid.sizes[0] if solid.kind == "sphere" else half_height
        points = np.concatenate([np.column_stack([ring, np.full(AROUND, z)]) for z in (-half_height, half_height)])
    hull = hull_of(points @ solid.origin[:3, :3].T + solid.origin[:3, 3])
    return hull.vertices[hull.faces]


def closed(where: str, triangles: FloatArray) -> tuple[Surface, FloatArray]:
    """The closed surface of triangles (f, 3, 3), and the triangles that it does not have exactly. Vertices that are
    almost equal are made one if that closes it. Raises `Unsuitable` for a mesh that stays open."""
    from assur.scenes.meshes.surface import INSIDE_OUT, closed_surface

    try:
        return closed_surface(triangles, 1.0), np.empty((0, 3, 3))
    except InputError as error:
        first = error
    welded = _welded(triangles)
    try:
        return closed_surface(welded, 1.0), triangles
    except InputError as error:
        if not error.field.endswith("data") or not first.field.endswith("data"):
            scale = "; in the URDF's mesh a scale makes metres of another unit (0.001 0.001 0.001 of mm)"
            raise Unsuitable(where, f"the mesh is {first.value}", f"needed is {first.allowed}{scale}") from error
        if INSIDE_OUT in (first.value, error.value):
            what = "the mesh is closed, but its faces point inwards"
            raise Unsuitable(where, what, "flip its faces (the normals) in the program that wrote it") from error
        what = f"the mesh is not closed: {error.value}"
        supply = "close it, put a primitive in its place, or say --open-meshes hull to take its convex hull"
        raise Unsuitable(where, what, supply) from error


def _welded(triangles: FloatArray) -> FloatArray:
    """Triangles with vertices within `WELD_M` of each other at one place; those that become flat are left out."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import KDTree

    vertices, which = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    pairs = KDTree(vertices).query_pairs(WELD_M, output_type="ndarray")
    ones = np.ones(len(pairs), dtype=bool)
    graph = coo_matrix((ones, (pairs[:, 0], pairs[:, 1])), shape=(len(vertices), len(vertices)))
    _, group = connected_components(graph, directed=False)
    _, first = np.unique(group, return_index=True)
    faces = group[which].reshape(-1, 3)
    kept = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    found: FloatArray = vertices[first][faces[kept]]
    return found


def _hulls(where: str, triangles: FloatArray, covering: Covering) -> tuple[list[Hull], float]:
    from assur.scenes.meshes.solid_cover import solid_cover

    found = _closed_or_hull(where, triangles, covering)
    if isinstance(found, Hull):
        return [found], 0.0
    cover = solid_cover(*found, covering.tight_m, covering.most)
    return list(cover.hulls), cover.excess_m


def _closed_or_hull(where: str, triangles: FloatArray, covering: Covering) -> tuple[Surface, FloatArray] | Hull:
    """The surface of triangles (f, 3, 3) if they are closed, and those that it does not have exactly; else their convex
    hull, if that is allowed: without it nothing says what is between them. Raises `Unsuitable`."""
    from assur.scenes.meshes.hull import hull_of

    try:
        return closed(where, triangles)
    except Unsuitable:
        if not covering.open_hull:
            raise
        return hull_of(triangles.reshape(-1, 3))


def _slices(triangles: FloatArray, tight: float) -> list[tuple[float, float, float]]:
    """Cylinders (lowest, highest, radius) about the z axis that contain triangles (f, 3, 3), touching each other."""
    from assur.scenes.meshes.clip import clip

    heights = triangles[:, :, 2]
    low, high = float(heights.min()), float(heights.max())
    count = max(1, min(SLICES * 4, int((high - low) / max(tight, 1e-3))))
    levels = np.linspace(low, high, count + 1)
    found: list[list[float]] = []
    rest = triangles
    for bottom, top in pairwise(levels):
        part, rest = clip(rest, 2, float(top)) if top < high else (rest, rest[:0])
        # a triangle that crosses the level is cut there; the cut's corners belong to both sides
        radius = float(np.hypot(part[..., 0], part[..., 1]).max()) if len(part) else (found[-1][2] if found else 1e-5)
        radius = max(radius * (1 + 1e-9) + 1e-9, 1e-5)
        if found and abs(found[-1][2] - radius) <= 0.5 * tight:
            found[-1][1], found[-1][2] = float(top), max(found[-1][2], radius)
        else:
            found.append([float(bottom), float(top), radius])
    while len(found) > SLICES:
        costs = [abs(a[2] - b[2]) * (b[1] - a[0]) for a, b in pairwise(found)]
        i = int(np.argmin(costs))
        found[i] = [found[i][0], found[i + 1][1], max(found[i][2], found[i + 1][2])]
        del found[i + 1]
    first, last = found[0], found[-1]
    first[0], last[1] = first[0] - 1e-6, last[1] + 1e-6
    return [(bottom, top, radius) for bottom, top, radius in found]
