"""Shapes of a document as convex pieces, bodies as they sit in the cell, on a tool or on a link."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from assur.planner.errors import FaultError, InputError
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import AXES, ORIGIN, Body, Piece, box, capsule, cylinder, sphere
from assur.planner.laws.law import EXACT
from assur.planner.model.deadline import OutOfTimeError
from assur.planner.model.scene import WORLD, WorldBody
from assur.scenes.faults import DocumentError, FollowsError, Refused, as_written, choices, dotted, fault, within
from assur.scenes.reading.frames import Frames, pose_uncertainty
from assur.scenes.schema.cell_file import SlotsDocument
from assur.scenes.schema.model import KNOWN
from assur.scenes.schema.robots import ToolPoseDocument
from assur.scenes.schema.shapes import AttachedBody, BodyDocument, LinkBody, MeshDocument, PlaceInCell, ShapeDocument
from assur.scenes.schema.task import TargetDocument


def solid(name: str, shape: ShapeDocument) -> Body:
    """The body in its own frame. Raises `Refused` at the field of a mesh that it refuses; the model of a document has
    refused whatever else is no solid."""
    axis = "z"
    if shape.box is not None:
        primitive = box(*shape.box.size_m)
    elif shape.sphere is not None:
        primitive = sphere(shape.sphere.radius_m)
    elif shape.cylinder is not None:
        primitive, axis = cylinder(shape.cylinder.radius_m, shape.cylinder.height_m), shape.cylinder.axis
    elif shape.capsule is not None:
        primitive, axis = capsule(shape.capsule.radius_m, shape.capsule.length_m), shape.capsule.axis
    elif shape.mesh is not None:
        with within("shape", "mesh"):
            return _mesh(name, shape.mesh)
    else:
        raise FaultError("a shape of no kind passed its model")
    return Body(name, (Piece(primitive, ORIGIN, AXES[axis]),))


def _mesh(name: str, mesh: MeshDocument) -> Body:
    from assur.scenes.meshes import covered

    if mesh.file is not None:
        raise Refused("an asset's name or inline data: a request never names a file", "file")
    if mesh.data is not None and mesh.format is None:
        raise Refused("stl, obj, ply or glb, which must be given with data", "format")
    if mesh.sha256 is not None and mesh.format is None:
        raise Refused("stl, obj, ply or glb, which must be given with sha256", "format")
    try:
        cover = covered(mesh)
    except OutOfTimeError as late:
        raise OutOfTimeError(f'the mesh of "{name}" {late}') from late
    except InputError as error:
        raise MeshRefused(mesh.unit, error) from error
    return Body(name, cover.pieces, cover.surface)


class MeshRefused(Refused):
    """A mesh that is refused. What is wrong inside the data of a `file` is the file's fault."""

    def __init__(self, unit: str, error: InputError) -> None:
        key = error.field.removeprefix("mesh.")
        size = f"a unit that gives {error.allowed}: in {unit} this mesh is {error.value}; is the unit right?"
        super().__init__(size if key == "unit" else error.allowed, key)
        self._error = error

    def one(self, document: object) -> DocumentError:
        """The fault at the field as it was written."""
        *above, key = self.path
        _, mesh = as_written(document, above)
        if isinstance(mesh, dict) and "file" in mesh and key in ("data", "format"):
            return fault(document, (*above, "file"), f"{self._error.allowed}; there is: {self._error.value}")
        if key == "data":  # the fault is reported, not the whole content
            return DocumentError(dotted(self.path), self._error.value, self._error.allowed)
        return super().one(document)


def attached(item: AttachedBody, lower_m: float = 0.0) -> Body:
    """A body at its pose in its carrier's frame, `lower_m` lower: its pieces and surface moved there."""
    tilt = (item.roll_rad or 0.0, item.pitch_rad or 0.0) if isinstance(item, LinkBody) else (0.0, 0.0)
    body = solid(item.name, item.shape)
    at = np.array(item.at_m) - [0.0, 0.0, lower_m]
    unturned = item.yaw_rad == 0.0 and tilt == (0.0, 0.0)
    if unturned and body.surface is None:
        return Body(item.name, tuple(Piece(p.shape, at + p.position, p.rotation) for p in body.pieces))
    turn = _turn(item.yaw_rad) if tilt == (0.0, 0.0) else _turn(item.yaw_rad) @ _tilt(*tilt)
    turned = [p.rotation if unturned else turn @ p.rotation for p in body.pieces]
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


def _tilt(roll: float, pitch: float) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """R_y(pitch) R_x(roll)."""
    cr, sr, cp, sp = np.cos(roll), np.sin(roll), np.cos(pitch), np.sin(pitch)
    return np.array([[cp, sp * sr, sp * cr], [0.0, cr, -sr], [-sp, cp * sr, cp * cr]])


class Places(dict[str, tuple[str, Pose]]):
    """Where each body of the cell sits: frame, and pose in it. `unread`: bodies and neighbours that have a fault."""

    def __init__(self, places: Mapping[str, tuple[str, Pose]] = MappingProxyType({})) -> None:
        super().__init__(places)
        self.unread: set[str] = set(places.unread) if isinstance(places, Places) else set()

    def hold(self, name: str) -> None:
        """Raises `FollowsError` for the name of a body that has a fault, or that is one of a neighbour's that has."""
        if name.partition("/")[0] in self.unread:
            raise FollowsError


Placement = PlaceInCell | TargetDocument | ToolPoseDocument
"""What is given in a frame, or relative to a body."""


AT_ORIGIN = Pose()
NO_POSE = "no pose: the gripper holds it at the start"


def world_body(item: BodyDocument, frames: Frames, places: Places, held: str | None) -> WorldBody:
    """A body of the surroundings; it is added to `places`, which holds those that were named before. `held`: the part
    that the gripper holds at the start, which has no pose."""
    if item.name in places:
        raise Refused("a name that no other body has", "name")
    if (item.pose is None) != (item.name == held):
        raise Refused(
            NO_POSE if item.name == held else "a pose: only the part that start.holding names has none", "pose"
        )
    frame, pose = WORLD, AT_ORIGIN
    if item.pose is not None:
        try:
            frame, pose = resolve(item.pose, item.pose.yaw_rad, frames, places)
        except Refused as error:
            error.at("pose")
            raise
    body = solid(item.name, item.shape)
    places[item.name] = (frame, pose)
    within_m = EXACT if item.uncertainty is KNOWN else pose_uncertainty(item.uncertainty)
    return WorldBody(body, frame, pose, item.mass_kg, item.yaw_symmetry, within_m)


def resolve(place: Placement, yaw: float, frames: Frames, places: Places) -> tuple[str, Pose]:
    """Frame with a law and pose in it, of a place that may be relative to a body (one that was named before)."""
    x, y, z = place.at_m
    pose = Pose(x, y, z, yaw)
    if place.body is None:
        return frames.placed(WORLD if place.frame is None else place.frame, pose)
    places.hold(place.body)
    if place.body not in places:
        raise Refused(f"a body that is named before: {choices(places, place.body)}", "body")
    frame, carrier = places[place.body]
    return frame, carrier.then(pose)


def named(item: TargetDocument | SlotsDocument, frames: Frames, places: Places) -> None:
    """Raises `Refused` where a pose is in a frame, or relative to a body, that the cell has not."""
    if item.body is None:
        frames.placed(WORLD if item.frame is None else item.frame, AT_ORIGIN)
        return
    places.hold(item.body)
    if item.body not in places:
        raise Refused(f"the name of a body: {choices(places, item.body)}", "body")
