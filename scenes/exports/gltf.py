"""The container of binary glTF 2.0: a header of 12 bytes, a chunk of JSON, and a chunk of the numbers that it names."""

from __future__ import annotations

import json
import struct
from typing import Any

import numpy as np

from assur.planner.arrays import FloatArray, IntArray

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
