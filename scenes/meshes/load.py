"""Bytes of a mesh file into a closed surface. The only importer of trimesh, and what it must be guarded against.

Traps (`trimesh` 5.2): an STL with NaN vertices comes back as a mesh with 0 faces and no error, so raw triangles are
asked for (`process=False`) and counted; an empty file comes back as a Scene; exceptions are of any type; strings are
taken for paths or URLs, so it only ever gets bytes, and no resolver; archives are unpacked without bound, so the format
is one of four and must agree with the content; a GLB may declare 200 million zeros that its file does not hold, so
counts are read and bounded before trimesh sees the file; of an OBJ each `usemtl`, also one in a comment, makes a mesh
with all vertices of the file, so that 20,000 take minutes: they are taken out, for nothing is asked of materials.
"""

from __future__ import annotations

import io
import re
import struct
from typing import Any

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.scenes.bounds import MAX_FACES, MAX_MESH_BYTES
from assur.scenes.meshes.parts import Parts, at_once
from assur.scenes.meshes.surface import Surface, surface_in_parts
from assur.scenes.text.json_text import parse_json

UNITS_M = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254}
"""Metres in each unit a mesh may be in."""
MOST_ITEMS = 4 * MAX_FACES
"""Vertices, indices and the like that one element of a file may declare."""
MOST_NODES = 1_000
"""Nodes of a GLB: each may show the same mesh once more."""


def load(content: bytes, form: str, unit: str) -> Surface:
    """The surface in an STL, OBJ, PLY or GLB file. Raises `InputError` naming mesh.data, mesh.format or mesh.unit."""
    return at_once(load_in_parts(content, form, unit))


def load_in_parts(content: bytes, form: str, unit: str) -> Parts[Surface]:
    """`load`, which may be left, and gone on with, between two parts of the work."""
    if unit not in UNITS_M:
        raise InputError("mesh.unit", unit, f"one of {', '.join(UNITS_M)}")
    if form not in CHECKS:
        raise InputError("mesh.format", form, f"one of {', '.join(CHECKS)}")
    triangles = triangles_of(content, form)
    yield
    return (yield from surface_in_parts(triangles, UNITS_M[unit]))


def triangles_of(content: bytes, form: str) -> FloatArray:
    """The triangles (f, 3, 3) in a file, in its unit, open or closed; also of COLLADA files (`dae`, with the extra of
    that name), in m. Raises `InputError` naming mesh.data or mesh.format."""
    if form not in (*CHECKS, "dae"):
        raise InputError("mesh.format", form, f"one of {', '.join(CHECKS)}")
    if not 0 < len(content) <= MAX_MESH_BYTES:
        raise InputError("mesh.data", f"{len(content)} bytes", f"1 to {MAX_MESH_BYTES} bytes")
    if form == "dae":
        return _check_dae(content) * _triangles(content, form)
    CHECKS[form](content)
    return _triangles(content.replace(b"usemtl ", b"# ") if form == "obj" else content, form)


def _triangles(content: bytes, form: str) -> FloatArray:
    """(f, 3, 3) in the file's unit, exactly as many triangles as trimesh found in it."""
    import trimesh

    try:
        with np.errstate(all="ignore"):
            loaded = trimesh.load(io.BytesIO(content), file_type=form, process=False, skip_materials=True)
            parts = list(_parts(loaded, trimesh))
    except InputError:
        raise
    except Exception as error:  # trimesh raises whatever its parsers run into (T3)
        raise InputError("mesh.data", type(error).__name__, f"a readable {form} file") from error
    if not parts:
        raise InputError("mesh.data", "no triangles", f"a {form} file with triangles")
    return np.concatenate(parts)


def _parts(loaded: Any, trimesh: Any) -> list[FloatArray]:
    if type(loaded) is trimesh.Trimesh:
        return [_corners(loaded, np.eye(4))]
    if type(loaded) is not trimesh.Scene:
        raise InputError("mesh.data", type(loaded).__name__, "triangles")
    found, total = [], 0
    for node in loaded.graph.nodes_geometry:
        matrix, name = loaded.graph[node]
        mesh = loaded.geometry[name]
        if type(mesh) is not trimesh.Trimesh:
            raise InputError("mesh.data", type(mesh).__name__, "triangles only")
        total += len(mesh.faces)
        if total > MAX_FACES:
            raise InputError("mesh.data", f"{total} triangles or more", f"up to {MAX_FACES} triangles")
        found.append(_corners(mesh, np.asarray(matrix, dtype=np.float64)))
    return found


def _corners(mesh: Any, matrix: FloatArray) -> FloatArray:
    vertices = np.array(mesh.vertices, dtype=np.float64).reshape(-1, 3)
    faces = np.array(mesh.faces, dtype=np.int64).reshape(-1, 3)
    if len(faces) and not (faces.min() >= 0 and faces.max() < len(vertices)):
        raise InputError("mesh.data", f"index {faces.max()}", f"indices below {len(vertices)}")
    if not np.array_equal(matrix, np.eye(4)):
        vertices = vertices @ matrix[:3, :3].T + matrix[:3, 3]
        if np.linalg.det(matrix[:3, :3]) < 0:  # a mirrored node turns its faces inside out
            faces = faces[:, ::-1]
    corners: FloatArray = vertices[faces]
    return corners


def _check_stl(content: bytes) -> None:
    if len(content) >= 84:
        (count,) = struct.unpack_from("<I", content, 80)
        if len(content) == 84 + 50 * count:
            _bounded(count, MAX_FACES, "triangles")
            return
    if content[:5].lower() == b"solid" and b"facet" in content:
        _bounded(content.count(b"endfacet"), MAX_FACES, "triangles")
        return
    raise InputError("mesh.data", "neither length nor words of an STL file", "an STL file, binary or text")


def _check_obj(content: bytes) -> None:
    if b"\0" in content or not re.search(rb"^v\s", content, re.MULTILINE):
        raise InputError("mesh.data", "no vertices in text", "an OBJ file")
    _bounded(len(re.findall(rb"^f\s", content, re.MULTILINE)), MAX_FACES, "faces")


def _check_ply(content: bytes) -> None:
    end = content.find(b"end_header", 0, 65536)
    if content[:4] not in (b"ply\n", b"ply\r") or end < 0:
        raise InputError("mesh.data", "no header of a PLY file", "a PLY file")
    for count in re.findall(rb"^element\s+\S+\s+(\S+)", content[:end], re.MULTILINE):
        if not (count.isdigit() and len(count) <= 12):
            raise InputError("mesh.data", "a count that is no number", "a PLY file")
        _bounded(int(count), MOST_ITEMS, "items")


def _check_glb(content: bytes) -> None:
    """Header, sizes and counts of a GLB: nothing outside the file, nothing declared that it does not hold."""
    if len(content) < 20 or content[:4] != b"glTF":
        raise InputError("mesh.data", "no header of a GLB file", "a GLB file")
    version, total, length, kind = struct.unpack_from("<IIII", content, 4)
    if not (version == 2 and total == len(content) and 20 + length <= total and kind == 0x4E4F534A):
        raise InputError("mesh.data", "a GLB header that disagrees with its file", "a GLB file, version 2")
    try:
        tree = parse_json(content[20 : 20 + length])
    except InputError as error:
        raise InputError("mesh.data", f"JSON: {error.allowed} is missing", "a GLB file") from None
    if not isinstance(tree, dict):
        raise InputError("mesh.data", "JSON without fields", "a GLB file")
    if tree.get("extensionsRequired"):
        raise InputError("mesh.data", "required extensions", "a GLB file without extensions")
    lists = {key: tree.get(key, []) for key in ("buffers", "images", "accessors", "bufferViews", "nodes")}
    for key, items in lists.items():
        if not (isinstance(items, list) and all(isinstance(item, dict) for item in items)):
            raise InputError("mesh.data", key, "a GLB file")
    if any("uri" in item for key in ("buffers", "images") for item in lists[key]):
        raise InputError("mesh.data", "a reference to another file", "a GLB file that holds all its data")
    _bounded(len(lists["nodes"]), MOST_NODES, "nodes")
    for accessor in lists["accessors"]:
        if "sparse" in accessor or "bufferView" not in accessor:
            raise InputError("mesh.data", "an accessor without data", "accessors with a buffer view")
        count = accessor.get("count")
        if not isinstance(count, int) or isinstance(count, bool):
            raise InputError("mesh.data", "a count that is no number", "a GLB file")
        _bounded(count, MOST_ITEMS, "items")
        if count > len(content):
            raise InputError("mesh.data", f"{count} items declared", "no more than the file holds")


def _check_dae(content: bytes) -> float:
    """Metres in the unit of a COLLADA file. Its up axis is not applied, as robot viewers do not apply it."""
    from importlib.util import find_spec

    from defusedxml import DefusedXmlException
    from defusedxml.ElementTree import fromstring

    if find_spec("collada") is None:
        allowed = "a mesh as STL, OBJ, PLY or GLB, or an installation with the extra `dae`"
        raise InputError("mesh.format", "dae, and no library for it", allowed)
    try:
        root = fromstring(content, forbid_dtd=True)
    except (DefusedXmlException, SyntaxError, ValueError, LookupError) as error:
        raise InputError("mesh.data", type(error).__name__, "a readable dae file") from error
    space = "{*}"
    _bounded(len(root.findall(f".//{space}node")), MOST_NODES, "nodes")
    _bounded(
        sum(len(p.text or "") for p in root.iter() if p.tag.endswith("}p")), MAX_MESH_BYTES, "characters of indices"
    )
    if root.find(f".//{space}instance_node") is not None:
        raise InputError("mesh.data", "instances of nodes", "a dae file without instance_node")
    unit = root.find(f"{space}asset/{space}unit")
    try:
        metres = 1.0 if unit is None else float(unit.get("meter", "1"))
    except ValueError:
        metres = float("nan")
    if not 1e-6 <= metres <= 1e3:
        raise InputError("mesh.data", "a unit that is no length", "a unit in m")
    return metres


def _bounded(count: int, most: int, what: str) -> None:
    if count > most:
        raise InputError("mesh.data", f"{count} {what}", f"up to {most} {what}")


CHECKS = {"stl": _check_stl, "obj": _check_obj, "ply": _check_ply, "glb": _check_glb}
"""Format → what is looked at before trimesh is."""
