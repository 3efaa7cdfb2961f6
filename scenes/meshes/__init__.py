"""Meshes: read, checked, and covered by convex hulls. trimesh and scipy come with the first of them."""

from __future__ import annotations

import base64
import binascii
import hashlib
from functools import lru_cache
from typing import TYPE_CHECKING

from assur.planner.errors import FaultError, InputError
from assur.scenes.bounds import MAX_MESH_BYTES
from assur.scenes.meshes.assets import asset
from assur.scenes.schema.shapes import MeshDocument

if TYPE_CHECKING:
    from assur.scenes.meshes.cover import Cover

KEPT = 32
"""Covers that are kept, by the content of their files: a cell shows few different meshes, often."""


def covered(mesh: MeshDocument) -> Cover:
    """The cover of a mesh by its asset's name or its inline bytes; the same content is read and covered once.

    Raises `InputError` naming mesh.asset, mesh.data, mesh.format or mesh.unit.
    """
    if mesh.asset is not None:
        return _cover(asset(mesh.asset), "stl", mesh.unit)
    if mesh.data is None or mesh.format is None:
        raise FaultError("a mesh without content passed its model")
    try:
        content = base64.b64decode(mesh.data, validate=True)
    except (binascii.Error, ValueError):
        raise InputError("mesh.data", mesh.data[:40], "base64") from None
    if len(content) > MAX_MESH_BYTES:
        raise InputError("mesh.data", f"{len(content)} bytes", f"up to {MAX_MESH_BYTES} bytes")
    return _cover(content, mesh.format, mesh.unit)


class _Content:
    """A file's bytes, equal to another's when their SHA-256 are; the bytes themselves are not kept by the cache."""

    def __init__(self, content: bytes) -> None:
        self.content: bytes | None = content
        self.digest = hashlib.sha256(content).digest()

    def __hash__(self) -> int:
        return hash(self.digest)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Content) and self.digest == other.digest


def _cover(content: bytes, form: str, unit: str) -> Cover:
    return _cover_of(_Content(content), form, unit)


@lru_cache(maxsize=KEPT)
def _cover_of(content: _Content, form: str, unit: str) -> Cover:
    from assur.scenes.meshes.cover import cover
    from assur.scenes.meshes.load import load

    if content.content is None:
        raise FaultError("a mesh's bytes were dropped before it was read")
    surface = load(content.content, form, unit)
    content.content = None
    return cover(surface)
