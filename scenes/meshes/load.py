"""Bytes of a mesh file into a closed surface. Only this module imports trimesh, and guards against its traps.

A binary STL file is a table of numbers and is read here: trimesh and what it imports take half a second to load.
Traps (`trimesh` 5.2): an STL with NaN vertices comes back as a mesh with 0 faces and no error, so raw triangles are
read (`process=False`) and counted; an empty file comes back as a Scene; exceptions are of any type; strings are
taken for paths or URLs, so it only ever gets bytes, and no resolver; archives are unpacked without bound, so the format
is one of four and must agree with the content; a GLB may declare 200 million zeros that its file does not hold, so
counts are read and bounded before trimesh sees the file; of an OBJ each `usemtl`, also one in a comment, makes a mesh
with all vertices of the file, so that 20,000 take minutes: they are removed, since materials are not used.
"""

from __future__ import annotations

import codecs
import io
import math
import re
import struct
from typing import Any

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.scenes.bounds import MAX_FACES, MAX_MESH_BYTES
from assur.scenes.meshes.glb_contents import MOST_ITEMS, MOST_NODES, check_contents
from assur.scenes.meshes.parts import Parts, at_once
from assur.scenes.meshes.surface import Surface, surface_in_parts
from assur.scenes.text.json_text import parse_json

UNITS_M = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254}
"""Metres in each unit a mesh may be in."""


def load(content: bytes, form: str, unit: str) -> Surface:
    """The surface in an STL, OBJ, PLY or GLB file. Raises `InputError` naming mesh.data, mesh.format or mesh.unit."""
    return at_once(load_in_parts(content, form, unit))


def load_in_parts(content: bytes, form: str, unit: str) -> Parts[Surface]:
    """`load`, which may be interrupted between two parts of the work, and continued."""
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
        metres, pieces = _check_dae(content)
        return metres * np.concatenate(_triangles(content, form, pieces))
    if form == "obj":
        content = _plain_obj(content)
    if form == "glb":
        return np.concatenate(_triangles(content, form, _check_glb(content)))
    stated = CHECKS[form](content)
    if form == "stl" and stated and len(content) == 84 + STL_FACET.itemsize * stated:
        return np.frombuffer(content, STL_FACET, offset=84)["corners"].astype(np.float64)
    triangles = np.concatenate(_triangles(content, form))
    if stated is not None and len(triangles) != stated:
        raise InputError("mesh.data", f"{len(triangles)} triangles that can be read", f"all {stated} of the file")
    return triangles


def _triangles(content: bytes, form: str, pieces: int = 1) -> list[FloatArray]:
    """Arrays (f, 3, 3) in the file's unit, exactly as many triangles as trimesh found in it, of `pieces` meshes at
    least."""
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
    if len(parts) < pieces:
        raise InputError("mesh.data", f"{len(parts)} meshes that can be read", f"all {pieces} of the file")
    return parts


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


STL_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
"""A triangle of a binary STL file, behind the 84 bytes of its header."""


def _check_stl(content: bytes) -> int | None:
    """The number of triangles that the file states."""
    if len(content) >= 84:
        (count,) = struct.unpack_from("<I", content, 80)
        if len(content) == 84 + STL_FACET.itemsize * count:
            _bounded(count, MAX_FACES, "triangles")
            return int(count)
    text = content.lower()
    if text[:5] == b"solid" and b"facet" in text:
        count = text.count(b"endfacet")
        _bounded(count, MAX_FACES, "triangles")
        return count
    if len(content) >= 84:
        found = f"{len(content)} bytes, and a header that states {count} triangles"
        raise InputError("mesh.data", found, "an STL file: text, or 84 + 50 bytes for each triangle and none more")
    raise InputError("mesh.data", "neither length nor words of an STL file", "an STL file, binary or text")


RELATIVE = re.compile(rb"^(?:f|fo) [^\n]*(?<=[ ])-", re.MULTILINE)
"""A face of an OBJ file that counts vertices back from itself."""
CURVED = re.compile(
    rb"^(vp|cstype|deg|bmat|curv2?|surf|scrv|trim|hole|con|bzp|bsp|cdc|cdp|res|call|csh)\s", re.MULTILINE
)
"""Statements of an OBJ file that make curved surfaces, or that read other files or run programs."""


def _plain_obj(content: bytes) -> bytes:
    """An OBJ file as trimesh reads all of it: no mark of UTF-8, no blanks before a statement, one blank behind its
    name, lines put together that end in a backslash, no comments and no materials, indices that count from 1."""
    content = re.sub(rb"[ \t]*\\\r?\n", b" ", content.removeprefix(codecs.BOM_UTF8)).replace(b"\t", b" ")
    content = re.sub(rb"^ +|#.*$", b"", content, flags=re.MULTILINE).replace(b"usemtl ", b"# ")
    return _counted_from_one(content) if RELATIVE.search(content) else content


def _counted_from_one(content: bytes) -> bytes:
    """An OBJ file whose faces name vertices by their place in the file. A negative index counts back from the last
    vertex before its face; trimesh would count from the last one of the file. Indices of textures and normals are left
    out. Raises `InputError` for one that counts back too far."""
    before, lines = 0, []
    for line in content.splitlines():
        if line.startswith(b"v "):
            before += 1
        elif RELATIVE.match(line):
            corners = [corner.partition(b"/")[0] for corner in line.split()[1:]]
            line = b"f " + b" ".join(_from_one(corner, before) for corner in corners)
        lines.append(line)
    return b"\n".join(lines)


def _from_one(index: bytes, before: int) -> bytes:
    if not index.startswith(b"-") or not index[1:].isdigit():
        return index
    if not 1 <= int(index[1:19]) <= before:
        raise InputError("mesh.data", f"index {index[:20].decode()}", f"the {before} vertices before its face")
    return b"%d" % (before + 1 - int(index[1:]))


def _check_obj(content: bytes) -> int | None:
    """The number of triangles in the faces."""
    if b"\0" in content or not re.search(rb"^v\s", content, re.MULTILINE):
        raise InputError("mesh.data", "no vertices in text", "an OBJ file")
    curved = CURVED.search(content)
    if curved is not None:
        allowed = "faces only (v and f): export the surfaces as triangles"
        raise InputError("mesh.data", f"the statement {curved[1].decode()}", allowed)
    faces = re.findall(rb"^(?:f|fo)\s(.*)$", content, re.MULTILINE)
    _bounded(len(faces), MAX_FACES, "faces")
    return sum(max(len(face.split()) - 2, 0) for face in faces)


PLY_ELEMENTS = (b"vertex", b"face", b"edge", b"material", b"camera")
"""Elements of a PLY file that are read, or that bear no surface."""


def _check_ply(content: bytes) -> int | None:
    end = content.find(b"end_header", 0, 65536)
    if content[:4] not in (b"ply\n", b"ply\r") or end < 0:
        raise InputError("mesh.data", "no header of a PLY file", "a PLY file")
    total, seen = 0, set[bytes]()
    for name, count in re.findall(rb"^element\s+(\S+)\s+(\S+)", content[:end], re.MULTILINE):
        if name in seen:
            raise InputError("mesh.data", f"two elements {name.decode('ascii', 'replace')}", "each element once")
        seen.add(name)
        if name not in PLY_ELEMENTS:
            shown = f"an element {name.decode('ascii', 'replace')}"
            raise InputError("mesh.data", shown, "elements vertex and face: export the surface as faces")
        if not (count.isdigit() and len(count) <= 12):
            raise InputError("mesh.data", "a count that is no number", "a PLY file")
        _bounded(int(count), MOST_ITEMS, "items")
        total += int(count)
    if re.search(rb"^format\s+ascii\s", content[:end], re.MULTILINE):
        lines = sum(1 for line in content[end:].splitlines()[1:] if line.strip())
        if lines != total:
            raise InputError("mesh.data", f"{lines} lines of elements", f"{total} lines, as the header states")
    return None


def _check_glb(content: bytes) -> int:
    """Header and contents of a GLB: nothing outside the file, nothing declared that it does not hold, and no shape that
    is not read. How many sets of triangles it shows."""
    if len(content) < 20 or content[:4] != b"glTF":
        raise InputError("mesh.data", "no header of a GLB file", "a GLB file")
    version, total, length, kind = struct.unpack_from("<IIII", content, 4)
    if not (version == 2 and total == len(content) and 20 + length <= total and kind == 0x4E4F534A):
        raise InputError("mesh.data", "a GLB header that disagrees with its file", "a GLB file, version 2")
    try:
        tree = parse_json(content[20 : 20 + length])
    except InputError as error:
        raise InputError("mesh.data", f"JSON: {error.allowed} is missing", "a GLB file") from None
    return check_contents(tree, len(content))


NOT_READ = ("instance_node", "instance_controller", "linestrips", "ph", "convex_mesh", "spline", "brep", "skew")
"""Elements of a COLLADA file whose shapes are not read, or with which a mesh is left out."""
SURFACES = ("triangles", "tristrips", "trifans", "polylist", "polygons")


def _check_dae(content: bytes) -> tuple[float, int]:
    """Metres in the unit of a COLLADA file, and how many meshes its scene shows at least. Its up axis is not applied,
    as robot viewers do not apply it."""
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
    _bounded(sum(len(p.text or "") for p in root.iter() if _named(p, "p")), MAX_MESH_BYTES, "characters of indices")
    for name in NOT_READ:
        if root.find(f".//{space}{name}") is not None:
            raise InputError(
                "mesh.data", f"the element {name}", f"a dae file without {name}, of triangles and polygons"
            )
    for mesh in root.iterfind(f"{space}library_geometries/{space}geometry/{space}mesh"):
        _check_places(mesh, space)
    unit = root.find(f"{space}asset/{space}unit")
    try:
        metres = 1.0 if unit is None else float(unit.get("meter", "1"))
    except ValueError:
        metres = float("nan")
    if not 1e-6 <= metres <= 1e3:
        raise InputError("mesh.data", "a unit that is no length", "a unit in m")
    return metres, _shown(root, space)


def _check_places(mesh: Any, space: str) -> None:
    """Raises `InputError` unless all coordinates of vertices are finite numbers: the library reads NaN as 0."""
    inputs = mesh.iterfind(f"{space}vertices/{space}input")
    sources = {each.get("source") for each in inputs if each.get("semantic") == "POSITION"}
    for source in mesh.iterfind(f"{space}source"):
        array = source.find(f"{space}float_array") if f"#{source.get('id')}" in sources else None
        for word in [] if array is None else (array.text or "").split():
            try:
                finite = math.isfinite(float(word))
            except ValueError:
                finite = False
            if not finite:
                raise InputError("mesh.data", f"the coordinate {word[:20]}", "finite numbers")


def _shown(root: Any, space: str) -> int:
    """How many sets of triangles or polygons the scene of a COLLADA file shows, each time that it does."""
    sets = {
        f"#{geometry.get('id')}": sum(
            each.get("count") != "0" for name in SURFACES for each in geometry.iterfind(f"{space}mesh/{space}{name}")
        )
        for geometry in root.iterfind(f"{space}library_geometries/{space}geometry")
    }
    scene = root.find(f"{space}scene/{space}instance_visual_scene")
    url = "" if scene is None else scene.get("url", "")
    of_scene = f"{space}library_visual_scenes/{space}visual_scene"
    shown = [each for each in root.iterfind(of_scene) if f"#{each.get('id')}" == url]
    return sum(
        sets.get(each.get("url", ""), 1) for one in shown for each in one.iter() if _named(each, "instance_geometry")
    )


def _named(element: Any, name: str) -> bool:
    return isinstance(element.tag, str) and element.tag.endswith(f"}}{name}")


def _bounded(count: int, most: int, what: str) -> None:
    if count > most:
        raise InputError("mesh.data", f"{count} {what}", f"up to {most} {what}")


CHECKS = {"stl": _check_stl, "obj": _check_obj, "ply": _check_ply, "glb": _check_glb}
"""Format → what is checked before trimesh reads the file; gives the number of triangles, where the file states it."""
