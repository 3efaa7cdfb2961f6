"""Shapes of a document as convex pieces, bodies as they sit in the cell, on a tool or on a link."""

from __future__ import annotations

import difflib
from collections.abc import Sequence

import numpy as np

from assur.planner.errors import InputError
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import AXES, Body, Piece, box, capsule, cylinder, sphere
from assur.planner.model.scene import WORLD, WorldBody
from assur.scenes.faults import DocumentError, Path, as_written, below, dotted, fault
from assur.scenes.reading.frames import placed
from assur.scenes.schema.shapes import AttachedBody, BodyDocument, MeshDocument, PlaceInCell, ShapeDocument
from assur.scenes.schema.task import TargetDocument


def solid(document: object, path: Path, name: str, shape: ShapeDocument) -> Body:
    """The body in its own frame. Raises `DocumentError` at the field below `path` that the solid refuses."""
    if shape.mesh is not None:
        return _mesh(document, (*path, "mesh"), name, shape.mesh)
    return Body(name, (_piece(document, path, shape),))


def _piece(document: object, path: Path, shape: ShapeDocument) -> Piece:
    kind = ""
    try:
        if shape.box is not None:
            kind = "box"
            return Piece(box(*shape.box.size_m))
        if shape.sphere is not None:
            kind = "sphere"
            return Piece(sphere(shape.sphere.radius_m))
        if shape.cylinder is not None:
            kind = "cylinder"
            primitive = cylinder(shape.cylinder.radius_m, shape.cylinder.height_m)
            return Piece(primitive, rotation=AXES[shape.cylinder.axis])
        if shape.capsule is not None:
            kind = "capsule"
            primitive = capsule(shape.capsule.radius_m, shape.capsule.length_m)
            return Piece(primitive, rotation=AXES[shape.capsule.axis])
    except InputError as error:
        raise below(document, (*path, kind), error) from error
    raise fault(document, path, "exactly one of box, sphere, cylinder, capsule, mesh")


def _mesh(document: object, path: Path, name: str, mesh: MeshDocument) -> Body:
    from assur.scenes.meshes import covered

    if mesh.file is not None:
        raise fault(document, (*path, "file"), "an asset's name or inline data: a request never names a file")
    if mesh.data is not None and mesh.format is None:
        raise fault(document, (*path, "format"), "stl, obj, ply or glb, which must be given with data")
    try:
        cover = covered(mesh)
    except InputError as error:
        raise _of_mesh(document, path, mesh, error) from error
    return Body(name, cover.pieces, cover.surface)


def _of_mesh(document: object, path: Path, mesh: MeshDocument, error: InputError) -> DocumentError:
    """The fault at the field as written: what is wrong inside the data of a `file` is the file's."""
    key = error.field.removeprefix("mesh.")
    _, written = as_written(document, path)
    by_file = isinstance(written, dict) and "file" in written
    if key == "unit":
        size = f"in {mesh.unit} this mesh is {error.value}; is the unit right?"
        return fault(document, (*path, key), f"a unit that gives {error.allowed}: {size}")
    if by_file and key in ("data", "format"):
        return fault(document, (*path, "file"), f"{error.allowed}; there is: {error.value}")
    if key == "data":
        return DocumentError(dotted((*path, key)), error.value, error.allowed)
    return fault(document, (*path, key), error.allowed)


def attached(document: object, path: Path, item: AttachedBody, lower_m: float = 0.0) -> Body:
    """A body at its pose in its carrier's frame, `lower_m` lower: its pieces and surface moved there."""
    body = solid(document, (*path, "shape"), item.name, item.shape)
    at = np.array(item.at_m) - [0.0, 0.0, lower_m]
    if item.yaw_rad == 0.0 and body.surface is None:
        return Body(item.name, tuple(Piece(p.shape, at + p.position, p.rotation) for p in body.pieces))
    turn = _turn(item.yaw_rad)
    turned = [p.rotation if item.yaw_rad == 0.0 else turn @ p.rotation for p in body.pieces]
    pieces = tuple(Piece(p.shape, at + turn @ p.position, axes) for p, axes in zip(body.pieces, turned, strict=True))
    surface = body.surface
    if surface is not None:
        vertices = surface[0] @ turn.T + at
        vertices.flags.writeable = False
        surface = (vertices, surface[1])
    return Body(item.name, pieces, surface)


def _turn(yaw: float) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


Places = dict[str, tuple[str, Pose]]
"""Where each body of the cell sits: frame, and pose in it."""


def world_bodies(
    document: object, bodies: Sequence[BodyDocument], frames: Sequence[str], places: Places
) -> list[WorldBody]:
    """The bodies of the surroundings, in order; `places` (which may hold a neighbour's already) is filled with them."""
    found = []
    for i, item in enumerate(bodies):
        path: Path = ("bodies", i)
        if item.name in places:
            raise fault(document, (*path, "name"), "a name that no other body has")
        frame, pose = resolve(document, (*path, "pose"), item.pose, item.pose.yaw_rad, frames, places)
        body = solid(document, (*path, "shape"), item.name, item.shape)
        places[item.name] = (frame, pose)
        found.append(WorldBody(body, frame, pose, item.mass_kg, item.yaw_symmetry))
    return found


def resolve(
    document: object,
    path: Path,
    place: PlaceInCell | TargetDocument,
    yaw: float,
    frames: Sequence[str],
    places: Places,
) -> tuple[str, Pose]:
    """Frame and pose of a place that may be relative to a body (one that was named before)."""
    pose = placed(place.at_m, yaw)
    if place.body is not None:
        if place.body not in places:
            raise fault(document, (*path, "body"), f"a body that is named before: {choices(places, place.body)}")
        frame, carrier = places[place.body]
        return frame, carrier.then(pose)
    frame = WORLD if place.frame is None else place.frame
    if frame not in frames:
        raise fault(document, (*path, "frame"), f"one of {choices(frames, frame)}")
    return frame, pose


MOST_CHOICES = 12


def choices(names: Sequence[str] | Places, given: str) -> str:
    """Names that there are, in words, the first `MOST_CHOICES` of them, and the one that `given` probably means."""
    close = difflib.get_close_matches(given, list(names), n=1)
    meant = f"; did you mean {close[0]}?" if close else ""
    shown = sorted(names)
    more = f" and {len(shown) - MOST_CHOICES} more" if len(shown) > MOST_CHOICES else ""
    return ", ".join(shown[:MOST_CHOICES]) + more + meant if shown else "none is there"
