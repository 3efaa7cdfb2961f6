"""Shapes and bodies of a request."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from assur.scenes import bounds
from assur.scenes.schema.model import (
    KNOWN,
    ORIGIN,
    WHOLE,
    Angle,
    Document,
    Group,
    Instant,
    Mass,
    Name,
    Point,
    PoseUncertaintyDocument,
    Reference,
    Size,
)

Axis = Literal["x", "y", "z"]
MeshFormat = Literal["stl", "obj", "ply", "glb"]
MeshUnit = Literal["m", "mm", "cm", "in"]


class BoxDocument(Document):
    """A box by its full edge lengths, centred."""

    size_m: Annotated[list[Size], Field(min_length=3, max_length=3)]


class SphereDocument(Document):
    """A ball, centred."""

    radius_m: Size


class CylinderDocument(Document):
    """A cylinder by its radius and full height, centred, along one of its body's axes."""

    radius_m: Size
    height_m: Size
    axis: Axis = "z"


class CapsuleDocument(Document):
    """A capsule by its radius and the distance between the centres of its caps, centred, along an axis."""

    radius_m: Size
    length_m: Size
    axis: Axis = "z"


class MeshDocument(Document):
    """A closed surface: a shipped asset by name, a file's bytes in base64 with its format, or the SHA-256 of a file
    that was uploaded (`PUT /v1/meshes/{sha256}`) with its format. The unit is mandatory. The loader of scenario files
    puts the bytes in the place of a `file`."""

    exactly_one: ClassVar[tuple[Group, ...]] = (("asset", "data", "file", "sha256"),)

    asset: Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9_-]{0,63}$")] | None = None
    data: Annotated[str, Field(max_length=bounds.MAX_MESH_TEXT)] | None = None
    file: Annotated[str, Field(min_length=1, max_length=255)] | None = None
    sha256: Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")] | None = None
    format: MeshFormat | None = None
    unit: MeshUnit


class ShapeDocument(Document):
    """One solid."""

    exactly_one: ClassVar[tuple[Group, ...]] = (("box", "sphere", "cylinder", "capsule", "mesh"),)

    box: BoxDocument | None = None
    sphere: SphereDocument | None = None
    cylinder: CylinderDocument | None = None
    capsule: CapsuleDocument | None = None
    mesh: MeshDocument | None = None


class PlaceInCell(Document):
    """A pose that is constant in a frame, or in whatever frame another body sits in, relative to that body.

    The shape is turned by the roll about x, then by the pitch about y, then by the yaw about z, the axes of the frame.
    With `at_s` the pose is in the frame as the request writes it, and the body is there at that time of the clock.
    """

    at_most_one: ClassVar[tuple[Group, ...]] = (("frame", "body"),)

    frame: Reference | None = None
    body: Reference | None = None
    at_m: Point = ORIGIN
    yaw_rad: Angle = 0.0
    pitch_rad: Angle | None = None
    roll_rad: Angle | None = None
    at_s: Instant | None = None


class BodyDocument(Document):
    """A body of the surroundings."""

    name: Name
    shape: ShapeDocument
    pose: PlaceInCell | None = None
    mass_kg: Mass | None = None
    yaw_symmetry: Annotated[int, Field(ge=0, le=360), WHOLE] = 1
    uncertainty: PoseUncertaintyDocument = KNOWN


Side = Literal["proximal-left", "distal-left", "proximal-right", "distal-right"]
LinkName = Literal["base", "link1", "link2", "link3", "link4", "quill", "flange", Side]
"""Links of any family. Whether an arm has a link is checked where the arm is built."""


class AttachedBody(Document):
    """A body at a pose in the flange's frame (of a tool)."""

    name: Name
    shape: ShapeDocument
    at_m: Point = ORIGIN
    yaw_rad: Angle = 0.0


class LinkBody(AttachedBody):
    """A body of an inline robot, on one of its links. It is turned by the roll about x, then by the pitch about y, then
    by the yaw about z, the axes of the link: R_z(yaw) R_y(pitch) R_x(roll)."""

    link: LinkName
    roll_rad: Angle | None = None
    pitch_rad: Angle | None = None
