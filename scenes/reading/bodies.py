"""Shapes of a document as convex pieces, bodies as they sit in the cell, on a tool or on a link."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache
from types import MappingProxyType

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError, InputError
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import AXES, ORIGIN, Body, Piece, Primitive, box, capsule, cylinder, sphere
from assur.planner.laws.law import EXACT, Law, PoseUncertainty
from assur.planner.model.deadline import OutOfTimeError
from assur.planner.model.scene import WORLD, WorldBody
from assur.planner.model.step_faults import TAKEN
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
    if shape.box is not None:
        return Body(name, _piece(box, tuple(shape.box.size_m)))
    if shape.sphere is not None:
        return Body(name, _piece(sphere, (shape.sphere.radius_m,)))
    if shape.cylinder is not None:
        sizes = shape.cylinder.radius_m, shape.cylinder.height_m
        return Body(name, _piece(cylinder, sizes, shape.cylinder.axis))
    if shape.capsule is not None:
        return Body(name, _piece(capsule, (shape.capsule.radius_m, shape.capsule.length_m), shape.capsule.axis))
    if shape.mesh is not None:
        with within("shape", "mesh"):
            return _mesh(name, shape.mesh)
    raise FaultError("a shape of no kind passed its model")


MOST_PIECES = 256
"""Primitive solids that are kept: bodies with the same numbers share one, and what the planner made of it."""


@lru_cache(MOST_PIECES)
def _piece(make: Callable[..., Primitive], sizes: tuple[float, ...], axis: str = "z") -> tuple[Piece, ...]:
    """A primitive about the origin, its axis along x, y or z."""
    return (Piece(make(*sizes), ORIGIN, AXES[axis]),)


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
    at = np.array(item.at_m) - [0.0, 0.0, lower_m]
    turn = _turn(item.yaw_rad) if tilt == (0.0, 0.0) else _turn(item.yaw_rad) @ _tilt(*tilt)
    return _moved(solid(item.name, item.shape), at, turn, unturned=item.yaw_rad == 0.0 and tilt == (0.0, 0.0))


def _moved(body: Body, at: FloatArray, turn: FloatArray, *, unturned: bool = False) -> Body:
    """The same body at `at` (3,), turned by the rotation `turn` (3, 3), or not at all."""
    if unturned and body.surface is None:
        return Body(body.name, tuple(Piece(p.shape, at + p.position, p.rotation) for p in body.pieces))
    turned = [p.rotation if unturned else turn @ p.rotation for p in body.pieces]
    pieces = tuple(Piece(p.shape, at + turn @ p.position, axes) for p, axes in zip(body.pieces, turned, strict=True))
    surface = body.surface
    if surface is not None:
        vertices = surface[0] @ turn.T + at
        vertices.flags.writeable = False
        surface = (vertices, surface[1])
    return Body(body.name, pieces, surface)


def _turn(yaw: float) -> FloatArray:
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def _tilt(roll: float, pitch: float) -> FloatArray:
    """R_y(pitch) R_x(roll)."""
    cr, sr, cp, sp = np.cos(roll), np.sin(roll), np.cos(pitch), np.sin(pitch)
    return np.array([[cp, sp * sr, sp * cr], [0.0, cr, -sr], [-sp, cp * sr, cp * cr]])


class Places(dict[str, tuple[str, Pose]]):
    """Where each body of the cell sits: frame, and pose in it. `unread`: bodies and neighbours that have a fault;
    with no text in place of a name that cannot be read, which may be any."""

    def __init__(self, places: Mapping[str, tuple[str, Pose]] = MappingProxyType({})) -> None:
        super().__init__(places)
        self.unread: set[str] = set(places.unread) if isinstance(places, Places) else set()
        self.drifting: set[str] = set(places.drifting) if isinstance(places, Places) else set()
        """Bodies with a time in their pose, in frames whose speed is uncertain."""
        self.gone: set[str] = set(places.gone) if isinstance(places, Places) else set()
        """Parts that were taken away."""

    def hold(self, name: str, *keys: str) -> None:
        """Raises `FollowsError` for the name of a body that has a fault, or that is one of a neighbour's that has, and
        `Refused`, at `keys`, for a part that was taken away."""
        if name in self.gone:
            raise Refused(TAKEN, *keys)
        if name.partition("/")[0] in self.unread or ("" in self.unread and name not in self):
            raise FollowsError

    def steady(self, name: str) -> None:
        """Raises `Refused` at `body` for a body from which no place is known as well as in its frame."""
        if name in self.drifting:
            raise Refused("a body without at_s, or in a frame whose speed is known: how far it is off grows", "body")


Placement = PlaceInCell | TargetDocument | ToolPoseDocument
"""What is given in a frame, or relative to a body."""


AT_ORIGIN = Pose()
UNMOVED = np.zeros(3)
NO_POSE = "no pose: the gripper holds it at the start"


def world_body(
    item: BodyDocument, frames: Frames, places: Places, held: str | None, start_s: float | None
) -> WorldBody:
    """A body of the surroundings; it is added to `places`, which holds those that were named before. `held`: the part
    that the gripper holds at the start, which has no pose. `start_s`: when the plan begins; None: no pose has a time in
    a frame whose speed is uncertain."""
    if item.name in places:
        raise Refused("a name that no other body has", "name")
    if (item.pose is None) != (item.name == held):
        raise Refused(
            NO_POSE if item.name == held else "a pose: only the part that start.holding names has none", "pose"
        )
    frame, pose, at_s = WORLD, AT_ORIGIN, None if item.pose is None else item.pose.at_s
    if item.pose is not None:
        try:
            frame, pose = resolve_at(item.pose, frames, places)
        except Refused as error:
            error.at("pose")
            raise
    body = solid(item.name, item.shape)
    if item.pose is not None and tilts(item.pose):
        # what is relative to this body has its place in the frame of `pose`, which stays upright
        body = _moved(body, UNMOVED, _tilt(item.pose.roll_rad or 0.0, item.pose.pitch_rad or 0.0))
    places[item.name] = (frame, pose)
    within_m = EXACT if item.uncertainty is KNOWN else pose_uncertainty(item.uncertainty)
    if at_s is not None:
        speed_m_s = frames.laws[frame].uncertainty.speed_m_s
        if speed_m_s > 0.0 and start_s is None:
            raise FaultError("a pose with a time needs the start of the plan")
        drift_m = 0.0 if start_s is None else speed_m_s * abs(start_s - at_s)
        if drift_m > 0.0:
            places.drifting.add(item.name)
            within_m = drifted(within_m, drift_m, frames.laws[frame].law)
    return WorldBody(body, frame, pose, item.mass_kg, item.yaw_symmetry, within_m, at_s)


def drifted(within: PoseUncertainty, drift_m: float, law: Law) -> PoseUncertainty:
    """How far a body may be from its pose whose frame, since the time of the pose, may have gone by `drift_m` more or
    less: along its line, or else in every horizontal direction."""
    line = law.line
    level, upright = (1.0, 0.0) if line is None else (math.hypot(line[0], line[1]), abs(float(line[2])))
    return replace(
        within, position_m=within.position_m + drift_m * level, vertical_m=within.vertical_m + drift_m * upright
    )


def tilts(place: PlaceInCell) -> tuple[str, ...]:
    """The keys of a pose by which its body does not stay upright."""
    return tuple(key for key in ("pitch_rad", "roll_rad") if getattr(place, key))


def resolve(place: Placement, yaw: float, frames: Frames, places: Places) -> tuple[str, Pose]:
    """Frame with a law and pose in it, of a place that may be relative to a body (one that was named before)."""
    x, y, z = place.at_m
    pose = Pose(x, y, z, yaw)
    if place.body is None:
        return frames.placed(WORLD if place.frame is None else place.frame, pose)
    places.hold(place.body, "body")
    if place.body not in places:
        raise Refused(f"a body that is named before: {choices(places, place.body)}", "body")
    places.steady(place.body)
    frame, carrier = places[place.body]
    return frame, carrier.then(pose)


def resolve_at(place: PlaceInCell, frames: Frames, places: Places) -> tuple[str, Pose]:
    """As `resolve`, also for a place where something is at a time: the pose is the one that rides with the frame."""
    frame, pose = resolve(place, place.yaw_rad, frames, places)
    if place.at_s is None:
        return frame, pose
    if place.frame is None:
        raise Refused("none: a pose relative to a body, or in no frame, is so at all times", "at_s")
    return frame, frames.riding(frame, pose, place.at_s)


def named(item: TargetDocument | SlotsDocument | PlaceInCell, frames: Frames, places: Places) -> None:
    """Raises `Refused` where a pose is in a frame, or relative to a body, that the cell has not."""
    if item.body is None:
        frames.placed(WORLD if item.frame is None else item.frame, AT_ORIGIN)
        return
    places.hold(item.body, "body")
    if item.body not in places:
        raise Refused(f"the name of a body: {choices(places, item.body)}", "body")
