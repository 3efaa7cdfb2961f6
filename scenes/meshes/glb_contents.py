"""What the JSON of a GLB file may hold: a feature that changes a shape and is not read is refused by its name.

Nodes, meshes, triangles and triangle strips are read. An extension is accepted only if it concerns materials, textures,
lights or labels. Morph targets whose weights are 0, and cameras, change nothing. Source: glTF 2.0, and the list of
extensions of its authors.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from assur.planner.errors import InputError
from assur.scenes.bounds import MAX_FACES

MOST_ITEMS = 4 * MAX_FACES
"""Vertices, indices and the like that one element of a file may declare."""
MOST_NODES = 1_000
"""Nodes of a GLB: each may show the same mesh once more."""
HARMLESS = (
    "KHR_materials_", "KHR_texture_", "KHR_lights_", "EXT_lights_", "EXT_texture_", "MSFT_texture_", "KHR_xmp",
    "MSFT_packing_", "ADOBE_materials_", "NV_materials_", "FB_ngon_encoding", "GODOT_single_root", "EXT_mesh_features",
    "EXT_structural_metadata",
)  # fmt: skip
"""Beginnings of the names of extensions that change no shape."""
TRIANGLES, STRIP, FLOAT = 4, 5, 5126
POSES = ("translation", "rotation", "scale")
LISTS = ("buffers", "images", "accessors", "bufferViews", "nodes", "meshes", "scenes", "skins", "animations")


def check_contents(tree: Any, size: int) -> int:
    """How many sets of triangles the scene shows, each time that it does. Raises `InputError` at mesh.data for a `tree`
    that refers to other files, declares more than the file of `size` bytes holds, or has shapes that are not read."""
    if not isinstance(tree, dict):
        raise InputError("mesh.data", "JSON without fields", "a GLB file")
    lists: dict[str, Any] = {key: tree.get(key, []) for key in LISTS}
    for key, items in lists.items():
        if not (isinstance(items, list) and all(isinstance(item, dict) for item in items)):
            raise InputError("mesh.data", key, "a GLB file")
    if any("uri" in item for key in ("buffers", "images") for item in lists[key]):
        raise InputError("mesh.data", "a reference to another file", "a GLB file that holds all its data")
    _check_extensions(tree)
    if len(lists["nodes"]) > MOST_NODES:
        raise InputError("mesh.data", f"{len(lists['nodes'])} nodes", f"up to {MOST_NODES} nodes")
    for accessor in lists["accessors"]:
        _check_accessor(accessor, size)
    _check_shapes(lists)
    if len(lists["scenes"]) > 1 and "scene" not in tree:
        raise InputError("mesh.data", f"{len(lists['scenes'])} scenes, and none that is the default", "one scene")
    return _shown(lists, tree.get("scene", 0))


def _shown(lists: dict[str, list[dict[str, Any]]], scene: object) -> int:
    """How many primitives a scene shows. Raises `InputError` for nodes that are no tree, and for one with two poses."""
    of_mesh = [len(list(_primitives([mesh]))) for mesh in lists["meshes"]]
    if not lists["scenes"]:
        return 0
    found, waiting = 0, _numbers(_item(lists["scenes"], scene, "scene").get("nodes", []))
    seen = set[int]()
    while waiting:
        number = waiting.pop()
        if number in seen:
            raise InputError(
                "mesh.data", f"node {number} in two places", "each node in one place: copies are nodes of their own"
            )
        seen.add(number)
        node = _item(lists["nodes"], number, "node")
        if "matrix" in node and not node.keys().isdisjoint(POSES):
            raise InputError("mesh.data", f"node {number} with a matrix and {', '.join(POSES)}", "a matrix or these")
        if "mesh" in node:
            found += _item(of_mesh, node["mesh"], "mesh")
        waiting += _numbers(node.get("children", []))
    return found


def _item(items: list[Any], number: object, what: str) -> Any:
    """The item with a number in a list of the file. Raises `InputError`."""
    if isinstance(number, bool) or not isinstance(number, int) or not 0 <= number < len(items):
        raise InputError("mesh.data", f"{what} {number!r:.20}", f"{what} 0 to {len(items) - 1} of the file")
    return items[number]


def _numbers(given: object) -> list[Any]:
    if not isinstance(given, list):
        raise InputError("mesh.data", f"nodes {given!r:.20}", "a list of nodes")
    return list(given)


def _check_extensions(tree: dict[str, Any]) -> None:
    for name in sorted(_extensions(tree)):
        if not name.startswith(HARMLESS):
            allowed = (
                "no extension but those of materials, textures and lights, for it may change the shape: export the "
                "mesh without it, with copies and deformations written out as triangles"
            )
            raise InputError("mesh.data", f"extension {name}", allowed)


def _extensions(tree: dict[str, Any]) -> set[str]:
    """All names of extensions: of both lists, and of every `extensions` in the tree, declared or not."""
    found: set[str] = set()
    for key in ("extensionsUsed", "extensionsRequired"):
        names = tree.get(key, [])
        if not (isinstance(names, list) and all(isinstance(name, str) for name in names)):
            raise InputError("mesh.data", key, "a list of names")
        found.update(names)
    waiting: list[Any] = [tree]
    while waiting:
        value = waiting.pop()
        if isinstance(value, dict):
            own = value.get("extensions")
            found.update(own if isinstance(own, dict) else ())
            waiting.extend(item for key, item in value.items() if key != "extras")
        elif isinstance(value, list):
            waiting.extend(value)
    return found


def _check_accessor(accessor: dict[str, Any], size: int) -> None:
    if "sparse" in accessor or "bufferView" not in accessor:
        raise InputError("mesh.data", "an accessor without data", "accessors with a buffer view")
    count = accessor.get("count")
    if not isinstance(count, int) or isinstance(count, bool):
        raise InputError("mesh.data", "a count that is no number", "a GLB file")
    if count > min(MOST_ITEMS, size):
        most = f"up to {MOST_ITEMS} items, and no more than the file holds"
        raise InputError("mesh.data", f"{count} items declared", most)


def _check_shapes(lists: dict[str, list[dict[str, Any]]]) -> None:
    """Raises `InputError` for skins, animations, morph targets in use, and primitives that are not read."""
    written_out = "triangles where they are, as the mesh is exported without it"
    for key in ("skins", "animations"):
        if lists[key]:
            raise InputError("mesh.data", f"{len(lists[key])} {key}", written_out)
    if any(_deformed(item) for key in ("nodes", "meshes") for item in lists[key]):
        raise InputError("mesh.data", "morph targets with weights", written_out)
    for primitive in _primitives(lists["meshes"]):
        mode = primitive.get("mode", TRIANGLES)
        if mode not in (TRIANGLES, STRIP):
            raise InputError("mesh.data", f"a primitive of mode {mode}", "triangles (4) and triangle strips (5) only")
        attributes = primitive.get("attributes")
        at = attributes.get("POSITION") if isinstance(attributes, dict) else None
        if not (isinstance(at, int) and 0 <= at < len(lists["accessors"])):
            raise InputError("mesh.data", "a primitive without positions", "the accessor of its POSITION")
        kind = lists["accessors"][at].get("componentType")
        if kind != FLOAT:
            raise InputError("mesh.data", f"positions of componentType {kind}", f"32-bit floats ({FLOAT})")


def _deformed(item: dict[str, Any]) -> bool:
    weights = item.get("weights", [])
    return not (isinstance(weights, list) and all(weight == 0 for weight in weights))


def _primitives(meshes: list[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    for mesh in meshes:
        primitives = mesh.get("primitives")
        if not (isinstance(primitives, list) and all(isinstance(each, dict) for each in primitives)):
            raise InputError("mesh.data", "a mesh without primitives", "a GLB file")
        yield from primitives
