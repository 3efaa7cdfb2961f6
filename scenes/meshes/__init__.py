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
from assur.scenes.meshes.covers import Covers, Key
from assur.scenes.meshes.folder import MeshFolder
from assur.scenes.schema.shapes import MeshDocument

if TYPE_CHECKING:
    from assur.scenes.meshes.cover import Cover

_FOLDER: dict[str, MeshFolder | None] = {"of this process": None}


def use_folder(folder: MeshFolder | None) -> None:
    """From now on this process searches meshes by digest, and cuts of covers, in `folder` (None: nowhere)."""
    _FOLDER["of this process"] = folder
    process_covers().folder = folder


@lru_cache(maxsize=1)
def process_covers() -> Covers:
    """The covers of this process; clearing this cache forgets them."""
    return Covers(folder=_FOLDER["of this process"])


def covered(mesh: MeshDocument) -> Cover:
    """The cover of a mesh by its asset's name, its inline bytes, or the digest of a file in the folder of this process;
    the same content is read and covered once.

    Raises `InputError` naming mesh.asset, mesh.data, mesh.sha256, mesh.format or mesh.unit, and `OutOfTimeError` where
    the deadline in force passed before the cover was finished.
    """
    if mesh.asset is not None:
        return process_covers().cover(Key(_asset_digest(mesh.asset), "stl", mesh.unit), asset(mesh.asset))
    if mesh.format is None:
        raise FaultError("a mesh without a format passed its model")
    if mesh.sha256 is not None:
        key = Key(mesh.sha256, mesh.format, mesh.unit)
        return process_covers().known(key) or process_covers().cover(key, _uploaded(mesh.sha256))
    if mesh.data is None:
        raise FaultError("a mesh without content passed its model")
    try:
        content = base64.b64decode(mesh.data, validate=True)
    except (binascii.Error, ValueError):
        raise InputError("mesh.data", mesh.data[:40], "base64") from None
    if len(content) > MAX_MESH_BYTES:
        raise InputError("mesh.data", f"{len(content)} bytes", f"up to {MAX_MESH_BYTES} bytes")
    return process_covers().cover(Key(hashlib.sha256(content).hexdigest(), mesh.format, mesh.unit), content)


def _uploaded(digest: str) -> bytes:
    folder = process_covers().folder
    if folder is None:
        allowed = "a mesh as data, asset or file: meshes by digest need a folder, which ASSUR_MESH_FOLDER names"
        raise InputError("mesh.sha256", digest, allowed)
    content = folder.content(digest)
    if content is None:
        allowed = f"the SHA-256 of a mesh that is known here: send its file with PUT /v1/meshes/{digest} first"
        raise InputError("mesh.sha256", digest, allowed)
    return content


@lru_cache(maxsize=16)
def _asset_digest(name: str) -> str:
    return hashlib.sha256(asset(name)).hexdigest()
