"""A plan as an animated model for any viewer of binary glTF 2.0: what our viewer plays, in that form.

Carriers (links and frames) are nodes side by side, with poses in the world over time; bodies hang below them. glTF goes
from key to key as our tracks do: positions along straight lines, attitudes along the shorter arc, evenly. A body that
changes its carrier has a node below each of them, and is shown by the scale of one of them at a time, which is 1 or 0.
"""

from __future__ import annotations

import json
import struct
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.errors import InputError
from assur.planner.model.phases import phases
from assur.scenes.exports.moving_marks import marks_of
from assur.scenes.schema.view import ShownBody, ShownSeat
from assur.scenes.view.display_meshes import Mesh, displays
from assur.scenes.view.poses import STEP_S, WITHIN_M, Track, drawing_errors
from assur.scenes.view.tracks import Tracks, tracks

if TYPE_CHECKING:
    from assur.scenes.exports.export import Motion

# The container of binary glTF 2.0: a header of 12 bytes, a chunk of JSON, and a chunk of the numbers that it names.

MAGIC, VERSION = 0x46546C67, 2
JSON_CHUNK, BINARY_CHUNK = 0x4E4F534A, 0x004E4942
FLOAT, UINT16, UINT32 = 5126, 5123, 5125
"""Types of the numbers in an accessor."""
VERTICES, INDICES = 34962, 34963
"""What a part of the buffer is for."""
TRIANGLES, LINE_STRIP = 4, 3
"""How vertices make a primitive."""
KINDS = {1: "SCALAR", 3: "VEC3", 4: "VEC4"}
WORD = 4
"""Parts of the buffer, and chunks, begin at multiples of so many bytes."""


class Gltf:
    """A glTF document that grows: lists of its parts, and the bytes that they refer to. Parts are named by their
    numbers, in the order in which they came."""

    def __init__(self) -> None:
        self.lists: dict[str, list[dict[str, Any]]] = {}
        self.binary = bytearray()

    def add(self, kind: str, part: dict[str, Any]) -> int:
        """One more part of a list (`nodes`, `meshes`, ...); its number."""
        found = self.lists.setdefault(kind, [])
        found.append(part)
        return len(found) - 1

    def points(self, vertices: FloatArray) -> int:
        """The accessor of vertices (V, 3), m."""
        return self._accessor(vertices.astype("<f4"), FLOAT, VERTICES, bounds=True)

    def corners(self, faces: IntArray) -> int:
        """The accessor of the corners of triangles (F, 3), numbers of vertices."""
        small = int(faces.max()) < (1 << 16) - 1
        return self._accessor(faces.ravel().astype("<u2" if small else "<u4"), UINT16 if small else UINT32, INDICES)

    def times(self, time: FloatArray) -> int:
        """The accessor of the times of keys (K,), s, which must increase as numbers of 32 bits, too."""
        return self._accessor(time.astype("<f4"), FLOAT, None, bounds=True)

    def values(self, values: FloatArray) -> int:
        """The accessor of what an animation gives at its keys, (K, 3) or (K, 4)."""
        return self._accessor(values.astype("<f4"), FLOAT, None)

    def _accessor(self, array: np.ndarray[Any, Any], kind: int, target: int | None, *, bounds: bool = False) -> int:
        self.binary += b"\0" * (-len(self.binary) % WORD)
        data = array.tobytes()
        view: dict[str, Any] = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data)}
        if target is not None:
            view["target"] = target
        self.binary += data
        width = 1 if array.ndim == 1 else array.shape[1]
        accessor: dict[str, Any] = {
            "bufferView": self.add("bufferViews", view),
            "componentType": kind,
            "count": len(array),
            "type": KINDS[width],
        }
        if bounds:
            rows = array.reshape(len(array), width).astype(np.float64)
            accessor |= {"min": rows.min(0).tolist(), "max": rows.max(0).tolist()}
        return self.add("accessors", accessor)

    def packed(self, asset: dict[str, Any], scene: int = 0) -> bytes:
        """The file: `asset` says who made it; `scene` is the number of the scene that is shown."""
        self.binary += b"\0" * (-len(self.binary) % WORD)
        whole = {"asset": {"version": "2.0", **asset}, "scene": scene, **self.lists}
        whole["buffers"] = [{"byteLength": len(self.binary)}]
        text = json.dumps(whole, allow_nan=False, separators=(",", ":")).encode("ascii")
        text += b" " * (-len(text) % WORD)
        chunks = b"".join(
            struct.pack("<II", len(data), kind) + data
            for data, kind in ((text, JSON_CHUNK), (bytes(self.binary), BINARY_CHUNK))
        )
        return struct.pack("<III", MAGIC, VERSION, 12 + len(chunks)) + chunks


COLOURS = {
    "robot": "#c3ccd6",
    "tool": "#5b6876",
    "part": "#f0913a",
    "body": "#8fa3b7",
    "neighbour": "#a592cc",
    "mark": "#14804a",
    "path": "#1f6feb",
}
"""As sRGB; of a brightness that is seen on light and on dark backgrounds."""
ROUGH = 0.75
UPRIGHT = (-(0.5**0.5), 0.0, 0.0, 0.5**0.5)
"""The turn by which our z, which is up, becomes the y of glTF, which is up there."""
FINER = 3
"""How often the steps between evaluated poses are halved, if interpolated poses are too far off."""


@dataclass(frozen=True, eq=False)
class Model:
    """A file, the farthest that a point in it is from where it is, m, the keys, and how its meshes differ."""

    data: bytes
    off_m: float
    keys: int
    triangles: int
    reduced: tuple[tuple[str, float], ...]


@dataclass(eq=False)
class _Making:
    """A document that is being made, and what several of its parts share."""

    shown: Tracks
    gltf: Gltf = field(default_factory=Gltf)
    channels: list[dict[str, Any]] = field(default_factory=list)
    samplers: list[dict[str, Any]] = field(default_factory=list)
    materials: dict[str, int] = field(default_factory=dict)

    def material(self, kind: str) -> int:
        """The number of the material of a kind of body."""
        if kind not in self.materials:
            colour = [*(_linear(COLOURS[kind][k : k + 2]) for k in (1, 3, 5)), 1.0]
            rough = {"baseColorFactor": colour, "metallicFactor": 0.0, "roughnessFactor": ROUGH}
            made: dict[str, Any] = {"name": kind, "pbrMetallicRoughness": rough, "doubleSided": True}
            if kind == "path":  # a line has no side that light could fall on
                made["emissiveFactor"] = colour[:3]
            self.materials[kind] = self.gltf.add("materials", made)
        return self.materials[kind]

    def keyed(self, node: int, path: str, times: int, values: int, how: str) -> None:
        """One more channel of the animation: what a node has at which times."""
        self.samplers.append({"input": times, "output": values, "interpolation": how})
        self.channels.append({"sampler": len(self.samplers) - 1, "target": {"node": node, "path": path}})


def model_of(motion: Motion) -> Model:
    """The model of a proved motion. Raises `InputError` if poses cannot be drawn within 0.1 mm at every time."""
    shown, drawn, off = _near_enough(motion)
    if not off <= WITHIN_M:
        allowed = f"csv: the motion is too long or too fast for poses within {1e3 * WITHIN_M:g} mm"
        raise InputError("format", "glb", allowed)
    making, meshes = _Making(shown), displays(shown.meshes)
    gltf, below = making.gltf, [list[int]() for _ in shown.carriers]
    _shapes(making, [display.mesh for display in meshes], below)
    for number, mesh in marks_of(shown).items():
        name = f"marks of {shown.carriers[number].name}"
        node = {"name": name, "mesh": _mesh(making, name, _geometry(making, mesh), "mark")}
        below[number].append(gltf.add("nodes", node))
    top = [_carrier(making, track, children) for track, children in zip(drawn, below, strict=True)]
    top += _path(making)
    root = gltf.add("nodes", {"name": "cell", "rotation": UPRIGHT, "children": top})
    gltf.add("animations", {"name": "plan", "channels": making.channels, "samplers": making.samplers})
    facts = motion.facts
    kept = {key: facts[key] for key in ("start_s", "duration_s", "request_digest", "certificate_digest")}
    gltf.add("scenes", {"name": "cell", "nodes": [root], "extras": {**kept, "unit": "m"}})
    return Model(
        data=gltf.packed({"generator": "assur"}),
        off_m=off,
        keys=sum(len(track.time) for track in drawn),
        triangles=sum(len(display.mesh.faces) for display in meshes),
        reduced=tuple(
            (body["name"], meshes[body["mesh"]].off_m) for body in shown.bodies if meshes[body["mesh"]].reduced
        ),
    )


def statement(model: Model) -> list[str]:
    """What a model says of itself, in short lines."""
    lines = [
        "PICTURE OF THE MOTION, FOR VIEWERS: a controller cannot run it. Units m, y up.",
        f"{model.keys} keys; at every time every point of a body is within {1e3 * model.off_m:.3f} mm of where it is",
        f"{model.triangles} triangles, {len(model.data)} bytes",
    ]
    for name, off in model.reduced:
        lines.append(f"{name} is drawn with fewer triangles; its corners are off by up to {1e3 * off:.1f} mm")
    return lines


def _near_enough(motion: Motion) -> tuple[Tracks, tuple[Track, ...], float]:
    """The tracks of a motion, its carriers in numbers of 32 bits, and by how much these are off, m. Keys are added
    until that is little, if it can be had."""
    scene, plan, step = motion.cell.scene, motion.plan, STEP_S
    of_plan = phases(scene, plan.legs, plan.arrivals)
    for _ in range(FINER + 1):
        shown = tracks(scene, plan.trajectory, of_plan, plan.arrivals, step_s=step)
        drawn = tuple(track.in_single_precision(shown.start) for track in shown.carriers)
        off = float(drawing_errors(scene, plan.trajectory, drawn, shown.start, shown.end, step).max())
        if off <= WITHIN_M:
            break
        step /= 2.0
    return shown, drawn, off


def _linear(channel: str) -> float:
    """A channel of a colour, two hexadecimal digits of sRGB, as the amount of light that glTF asks for."""
    value = int(channel, 16) / 255.0
    light: float = value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4
    return light


def _geometry(making: _Making, mesh: Mesh) -> tuple[int, int]:
    """Accessors of vertices and of corners. Without normals a viewer shades each face by itself."""
    return making.gltf.points(mesh.vertices), making.gltf.corners(mesh.faces)


def _mesh(making: _Making, name: str, geometry: tuple[int, int], kind: str) -> int:
    vertices, corners = geometry
    primitive = {
        "attributes": {"POSITION": vertices},
        "indices": corners,
        "material": making.material(kind),
        "mode": TRIANGLES,
    }
    return making.gltf.add("meshes", {"name": name, "primitives": [primitive]})


def _shapes(making: _Making, meshes: list[Mesh], below: list[list[int]]) -> None:
    """The nodes of all bodies, each below the carriers that it sits on; bodies of one shape share their numbers."""
    shapes = [_geometry(making, mesh) for mesh in meshes]
    known = dict[tuple[int, str], int]()
    for body in making.shown.bodies:
        mesh, kind = body["mesh"], body["kind"]
        if (mesh, kind) not in known:
            known[mesh, kind] = _mesh(making, f"{kind} {mesh}", shapes[mesh], kind)
        for seat, since, until in _stays(body):
            node: dict[str, Any] = {"name": body["name"], "mesh": known[mesh, kind], **_placed(seat)}
            number = making.gltf.add("nodes", node)
            below[seat["carrier"]].append(number)
            _visible(making, node, number, since, until)


def _stays(body: ShownBody) -> list[tuple[ShownSeat, float, float]]:
    """Each seat of a body with the times since the start from which and until which it is taken, s; seats that last no
    time as numbers of 32 bits are left out."""
    begins = [float(np.float32(max(seat["from_s"], 0.0))) for seat in body["seats"]]
    gone_s = body["gone_s"]
    ends = [*begins[1:], float("inf") if gone_s is None else float(np.float32(gone_s))]
    return [each for each in zip(body["seats"], begins, ends, strict=True) if each[1] < each[2]]


def _visible(making: _Making, node: dict[str, Any], number: int, since: float, until: float) -> None:
    """Scales a node to nothing while its seat is not taken."""
    if since <= 0.0 and until == float("inf"):
        return
    keys = [(0.0, since <= 0.0)] + [(since, True)] * (since > 0.0) + [(until, False)] * (until < float("inf"))
    times = making.gltf.times(np.array([time for time, _ in keys]))
    values = making.gltf.values(np.array([[float(there)] * 3 for _, there in keys]))
    making.keyed(number, "scale", times, values, "STEP")
    if since > 0.0:
        node["scale"] = [0.0, 0.0, 0.0]


def _placed(seat: ShownSeat) -> dict[str, Any]:
    """Translation and rotation of a node, where they are not those that it has anyway."""
    found: dict[str, Any] = {}
    if any(seat["at_m"]):
        found["translation"] = seat["at_m"]
    yaw = seat["yaw_rad"]
    if yaw:
        found["rotation"] = [0.0, 0.0, float(np.sin(yaw / 2.0)), float(np.cos(yaw / 2.0))]
    return found


def _carrier(making: _Making, track: Track, children: list[int]) -> int:
    """The node of a link or a frame, with its pose over time."""
    gltf = making.gltf
    node: dict[str, Any] = {
        "name": track.name,
        "translation": track.position[0].tolist(),
        "rotation": track.rotation[0].tolist(),
    }
    if children:
        node["children"] = children
    number = gltf.add("nodes", node)
    if len(track.time) > 1:
        times = gltf.times(track.time)
        for path, values in (("translation", track.position), ("rotation", track.rotation)):
            if (values != values[0]).any():
                making.keyed(number, path, times, gltf.values(values), "LINEAR")
    return number


def _path(making: _Making) -> list[int]:
    """The node of the tool point's way, if it goes anywhere."""
    way = making.shown.tool_path
    if len(way) < 2:
        return []
    primitive = {
        "attributes": {"POSITION": making.gltf.points(way)},
        "material": making.material("path"),
        "mode": LINE_STRIP,
    }
    mesh = making.gltf.add("meshes", {"name": "path of the tool point", "primitives": [primitive]})
    return [making.gltf.add("nodes", {"name": "path of the tool point", "mesh": mesh})]
