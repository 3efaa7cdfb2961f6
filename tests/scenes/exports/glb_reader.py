"""Binary glTF 2.0 as its specification says, as far as our files use it: the container, accessors, samplers, nodes."""

from __future__ import annotations

import json
import struct
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation, Slerp

Array = NDArray[np.float64]
TYPES = {5126: "<f4", 5125: "<u4", 5123: "<u2"}
WIDTHS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}


@dataclass(frozen=True)
class Glb:
    """A file that was taken apart: the JSON and the bytes."""

    document: dict[str, Any]
    binary: bytes

    @classmethod
    def of(cls, data: bytes) -> Glb:
        magic, version, length = struct.unpack_from("<4sII", data)
        assert (magic, version, length) == (b"glTF", 2, len(data))
        size, kind = struct.unpack_from("<I4s", data, 12)
        assert (kind, size % 4) == (b"JSON", 0)
        rest, kind = struct.unpack_from("<I4s", data, 20 + size)
        assert (kind, rest % 4, 28 + size + rest) == (b"BIN\0", 0, len(data))
        document = json.loads(data[20 : 20 + size])
        assert document["buffers"] == [{"byteLength": rest}]
        return cls(document, data[28 + size :])

    def array(self, number: int) -> Array:
        """The numbers of an accessor, (count, width)."""
        accessor = self.document["accessors"][number]
        view, width = self.document["bufferViews"][accessor["bufferView"]], WIDTHS[accessor["type"]]
        kind = np.dtype(TYPES[accessor["componentType"]])
        assert accessor["count"] * width * kind.itemsize == view["byteLength"]
        found = np.frombuffer(self.binary, kind, accessor["count"] * width, view["byteOffset"])
        return found.astype(np.float64).reshape(-1, width)

    @cached_property
    def parents(self) -> dict[int, int]:
        """The node above each node."""
        nodes = self.document["nodes"]
        return {child: k for k, node in enumerate(nodes) for child in node.get("children", ())}

    @cached_property
    def samplers(self) -> dict[tuple[int, str], tuple[Array, Array, str]]:
        """What is animated: times, values and the interpolation, by node and property."""
        (animation,) = self.document["animations"]
        found = {}
        for channel in animation["channels"]:
            sampler, target = animation["samplers"][channel["sampler"]], channel["target"]
            times = self.array(sampler["input"])[:, 0]
            assert (np.diff(times) > 0.0).all()
            key = target["node"], target["path"]
            assert key not in found
            found[key] = times, self.array(sampler["output"]), sampler["interpolation"]
        return found

    def _at(self, node: int, path: str, t: Array, otherwise: list[float]) -> Array:
        """A property of a node at times t (T,)."""
        if (node, path) not in self.samplers:
            own = self.document["nodes"][node].get(path, otherwise)
            return np.repeat(np.array([own], dtype=np.float64), len(t), 0)
        times, values, how = self.samplers[node, path]
        if how == "STEP":
            return values[np.clip(np.searchsorted(times, t, side="right") - 1, 0, None)]
        assert how == "LINEAR"
        inside = np.clip(t, times[0], times[-1])
        if path == "rotation":
            return np.asarray(Slerp(times, Rotation.from_quat(values))(inside).as_quat())
        return np.stack([np.interp(inside, times, column) for column in values.T], -1)

    def placed(self, node: int, t: Array) -> Array:
        """The matrices (T, 4, 4) of a node in the scene at times t (T,)."""
        made = np.repeat(np.eye(4)[None], len(t), 0)
        scale = self._at(node, "scale", t, [1.0, 1.0, 1.0])
        turn = Rotation.from_quat(self._at(node, "rotation", t, [0.0, 0.0, 0.0, 1.0])).as_matrix()
        made[:, :3, :3], made[:, :3, 3] = turn * scale[:, None], self._at(node, "translation", t, [0.0, 0.0, 0.0])
        if node in self.parents:
            return np.asarray(self.placed(self.parents[node], t) @ made)
        (scene,) = self.document["scenes"]
        assert node in scene["nodes"]
        return made

    def named(self, name: str) -> list[int]:
        """The numbers of the nodes of a name."""
        return [k for k, node in enumerate(self.document["nodes"]) if node["name"] == name]

    def vertices(self, node: int) -> Array:
        """The vertices (V, 3) of the mesh of a node, in its own axes."""
        (primitive,) = self.document["meshes"][self.document["nodes"][node]["mesh"]]["primitives"]
        return self.array(primitive["attributes"]["POSITION"])

    def triangles(self) -> int:
        """All triangles of all meshes."""
        every = [each for mesh in self.document["meshes"] for each in mesh["primitives"] if each["mode"] == 4]
        shared = {each["indices"] for each in every}
        return sum(self.document["accessors"][number]["count"] // 3 for number in shared)


Z_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
"""Takes points of glTF, y up, to points of the cell, z up."""


def in_cell(placed: Array) -> tuple[Array, Array]:
    """Positions (T, 3) and matrices (T, 3, 3) in the cell of matrices (T, 4, 4) of the scene."""
    return placed[:, :3, 3] @ Z_UP.T, np.einsum("ij,tjk->tik", Z_UP, placed[:, :3, :3])
