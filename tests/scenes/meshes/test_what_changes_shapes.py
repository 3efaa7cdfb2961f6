"""What a mesh file holds besides plain triangles: read whole, or refused by name. No obstacle becomes smaller in
silence."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from assur.planner.errors import InputError
from assur.scenes.meshes.load import load, triangles_of
from tests.scenes.meshes.solids import CUBE, binary_stl
from tests.scenes.meshes.test_dae import dae
from tests.scenes.meshes.test_load import FILES, _tree, glb, refused


def changed(
    change: dict[str, Any], node: dict[str, Any] | None = None, primitive: dict[str, Any] | None = None
) -> bytes:
    """The cube as GLB with further keys of its root, of the node that shows it, and of its primitive."""
    tree, binary = _tree(FILES["glb"])
    (shown,) = (each for each in tree["nodes"] if "mesh" in each)
    shown.update(node or {})
    tree["meshes"][0]["primitives"][0].update(primitive or {})
    return glb({**tree, **change}, binary)


INSTANCES = {"extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 0}}}}
CHANGES_SHAPES = {
    "EXT_mesh_gpu_instancing": changed({"extensionsUsed": ["EXT_mesh_gpu_instancing"]}, node=INSTANCES),
    "EXT_mesh_gpu_instancing ": changed({}, node=INSTANCES),  # not declared
    "KHR_draco_mesh_compression": changed({}, primitive={"extensions": {"KHR_draco_mesh_compression": {}}}),
    "EXT_meshopt_compression": changed({"extensionsUsed": ["EXT_meshopt_compression"]}),
    "KHR_mesh_quantization": changed({"extensionsRequired": ["KHR_mesh_quantization"]}),
    "KHR_node_visibility": changed({}, node={"extensions": {"KHR_node_visibility": {"visible": False}}}),
    "VENDOR_of_tomorrow": changed({"extensionsRequired": ["VENDOR_of_tomorrow"]}),
    "1 skins": changed({"skins": [{"joints": [0]}]}),
    "1 animations": changed({"animations": [{"channels": [], "samplers": []}]}),
    "morph targets with weights": changed({}, node={"weights": [0.5]}),
    "a primitive of mode 6": changed({}, primitive={"mode": 6}),
    "positions of componentType 5122": changed(
        {"accessors": [{**each, "componentType": 5122} for each in _tree(FILES["glb"])[0]["accessors"]]}
    ),
    "2 scenes": glb({**{k: v for k, v in _tree(FILES["glb"])[0].items() if k != "scene"}, "scenes": [{}, {}]}),
}


@pytest.mark.parametrize("what", CHANGES_SHAPES)
def test_what_changes_the_shape_of_a_glb_and_is_not_read_is_refused_by_name(what: str) -> None:
    assert what.strip() in str(refused(CHANGES_SHAPES[what], "glb").value)


@pytest.mark.parametrize(
    "harmless",
    [
        {"extensionsUsed": ["KHR_materials_unlit", "KHR_texture_transform"]},
        {"extensionsRequired": ["KHR_texture_basisu"]},
        {"extensions": {"KHR_lights_punctual": {"lights": []}}, "extensionsUsed": ["KHR_lights_punctual"]},
        {"extensionsUsed": ["FB_ngon_encoding", "MSFT_packing_normalRoughnessMetallic", "GODOT_single_root"]},
        {"extras": {"extensions": {"EXT_mesh_gpu_instancing": {}}}},
        {"cameras": [{"type": "perspective"}]},
    ],
)
def test_what_changes_no_shape_is_accepted(harmless: dict[str, Any]) -> None:
    assert len(load(changed(harmless), "glb", "mm").faces) == len(CUBE)


def test_morph_targets_without_weights_leave_the_mesh_as_it_is() -> None:
    assert len(load(changed({}, node={"weights": [0, 0.0]}), "glb", "mm").faces) == len(CUBE)


def shown_by(nodes: list[dict[str, Any]], roots: list[int], **change: Any) -> bytes:
    """The cube as GLB, shown by other nodes."""
    return changed({"nodes": nodes, "scene": 0, "scenes": [{"nodes": roots}], **change})


CUBE_AT: dict[str, Any] = {"mesh": 0, "translation": [500.0, 0.0, 0.0]}
NODES = {
    "node 2 in two places": shown_by([{"children": [2]}, {**CUBE_AT, "mesh": 0, "children": [2]}, {"mesh": 0}], [0, 1]),
    "node 1 in two places": shown_by([{"children": [1, 1]}, {"mesh": 0}], [0]),
    "node 0 in two places": shown_by([{"mesh": 0, "children": [0]}], [0]),
    "node 0 with a matrix and": shown_by([{**CUBE_AT, "matrix": np.eye(4).ravel().tolist()}], [0]),
    "1 meshes that can be read": shown_by([{**CUBE_AT, "camera": 0}, {"mesh": 0}], [0, 1], cameras=[{}]),
    "node 7": shown_by([{"mesh": 0, "children": [7]}], [0]),
    "mesh True": shown_by([{"mesh": True}], [0]),
    "scene 3": shown_by([{"mesh": 0}], [0], scene=3),
    "nodes 5": shown_by([{"mesh": 0, "children": 5}], [0]),
}


@pytest.mark.parametrize("what", NODES)
def test_each_mesh_that_a_scene_of_a_glb_shows_is_read(what: str) -> None:
    assert str(refused(NODES[what], "glb").value).startswith(what)


def test_a_mesh_that_is_shown_twice_is_read_twice() -> None:
    content = shown_by([{"children": [1, 2]}, CUBE_AT, {"mesh": 0}, {"mesh": 0, "scale": [9, 9, 9]}], [0])
    assert len(triangles_of(content, "glb")) == 2 * len(CUBE)  # the last node is not in the scene


TETRAHEDRON = b"v 0 0 0\nv 100 0 0\nv 0 100 0\nv 0 0 100\n"


@pytest.mark.parametrize(
    "faces",
    [
        b"f 1 3 2\n  f 1 2 4\n\tf 1 4 3\nf 2 3 4\n",
        b"f\t1 3 2\nf 1 2 4\nf\t1\t4\t3\nf 2 3 4 # the last\n",
        b"f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 \\\r\n3 4\n",
        b"f -4 -2 -3\nf 1 2 4\nl 1 2\nf 1 4 3\nf 2 3 4\n",
    ],
)
def test_every_face_of_an_obj_is_read_however_it_is_written(faces: bytes) -> None:
    assert len(load(TETRAHEDRON + faces, "obj", "mm").faces) == 4


def test_negative_indices_of_an_obj_count_back_from_their_face() -> None:
    vertices = TETRAHEDRON.decode()
    back = "f -4/-1 -2/-1 -3/-1\nf -4//-1 -3//-1 -1//-1\nf -4 -1 -2\nf -3 -2 -1\n"
    beyond = vertices.replace("v ", "v 5")  # all of it from x = 50 on
    content = f"vt 0 0\nvn 0 0 1\n{vertices}{back}{beyond}{back}".encode()
    plain = (vertices + beyond + FACES.decode() + FACES.decode().translate(str.maketrans("1234", "5678"))).encode()
    np.testing.assert_array_equal(triangles_of(content, "obj"), triangles_of(plain, "obj"))
    assert "index -5" in str(refused(f"{vertices}f -5 -2 -1\n".encode(), "obj").value)
    assert "index -0" in str(refused(f"{vertices}f -0 -2 -1\n".encode(), "obj").value)
    assert "index -4" in str(refused(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf -4 -2 -1\nv 0 0 1\n", "obj").value)


def test_a_mark_of_utf_8_hides_no_vertex_of_an_obj() -> None:
    content = b"\xef\xbb\xbf" + TETRAHEDRON + FACES
    np.testing.assert_array_equal(triangles_of(content, "obj"), triangles_of(TETRAHEDRON + FACES, "obj"))


FACES = b"f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"


@pytest.mark.parametrize(
    ("line", "found"),
    [
        (b"cstype bezier\n", "the statement cstype"),
        (b" surf 0 1 0 1 1 2 3\n", "the statement surf"),
        (b"curv 0 1 1 2\n", "the statement curv"),
        (b"call other.obj\n", "the statement call"),
        (b"fo 1 2 3\n", "4 triangles that can be read"),
    ],
)
def test_what_an_obj_holds_besides_faces_is_refused_by_name(line: bytes, found: str) -> None:
    assert str(refused(TETRAHEDRON + FACES + line, "obj").value) == found


def test_an_stl_is_read_to_its_last_byte() -> None:
    stl = binary_stl(CUBE)
    stated = f"a header that states {len(CUBE)} triangles"
    for content in (stl + b"\0\0", stl + stl, stl[:-50]):
        assert str(refused(content, "stl").value) == f"{len(content)} bytes, and {stated}"
    text = FILES["stl_ascii"]
    assert len(load(text.upper(), "stl", "mm").faces) == len(CUBE)
    moved = b"\n".join(
        b"vertex " + b" ".join(b"%g" % (float(each) + 500) for each in line.split()[1:]) if b"vertex" in line else line
        for line in text.splitlines()
    )
    assert len(load(text + b"\n" + moved, "stl", "mm").faces) == 2 * len(CUBE)  # two solids in one file
    refused(text[: text.rindex(b"outer")] + b"\nendfacet\nendsolid\n", "stl")


HEADER = (
    b"ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    b"element face 4\nproperty list uchar int vertex_indices\n"
)
POINTS = b"0 0 0\n100 0 0\n0 100 0\n0 0 100\n"
TRIANGLES = b"3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"


def test_a_ply_is_read_whole_or_refused() -> None:
    assert len(load(HEADER + b"end_header\n" + POINTS + TRIANGLES, "ply", "mm").faces) == 4
    camera = HEADER + b"element camera 1\nproperty float view_px\nend_header\n" + POINTS + TRIANGLES + b"0\n"
    assert len(load(camera, "ply", "mm").faces) == 4
    strips = b"element tristrips 1\nproperty list int int vertex_indices\n"
    found = refused(HEADER + strips + b"end_header\n" + POINTS + TRIANGLES + b"4 0 1 2 3\n", "ply")
    assert found.value == "an element tristrips"
    cut = refused(HEADER + b"end_header\n" + POINTS + TRIANGLES[:16], "ply")
    assert (cut.value, cut.allowed) == ("6 lines of elements", "8 lines, as the header states")
    other = b"element face 4\nproperty list uchar int vertex_indices\n"
    twice = refused(HEADER + other + b"end_header\n" + POINTS + TRIANGLES + TRIANGLES, "ply")
    assert (twice.value, twice.allowed) == ("two elements face", "each element once")


def refused_dae(content: bytes) -> object:
    with pytest.raises(InputError) as caught:
        triangles_of(content, "dae")
    return caught.value.value


def test_a_dae_is_read_whole_or_refused() -> None:
    again = dae().replace(
        b'<instance_geometry url="#g"/>',
        b'<instance_geometry url="#g"/><node><translate>500 0 0</translate><instance_geometry url="#g"/></node>',
    )
    assert triangles_of(again, "dae").shape == (8, 3, 3)
    inches = triangles_of(dae(unit='<unit name="inch" meter="0.0254"/>'), "dae")
    assert np.allclose(inches.reshape(-1, 3).max(0), 2.54)
    for what, found in (
        (b'<instance_controller url="#c"/>', "the element instance_controller"),
        (b'<instance_geometry url="#not-there"/>', "1 meshes that can be read"),
    ):
        with pytest.raises(InputError) as caught:
            triangles_of(
                dae().replace(b'<instance_geometry url="#g"/>', b'<instance_geometry url="#g"/>' + what), "dae"
            )
        assert caught.value.value == found
    skewed = dae().replace(b"<node><instance", b"<node><skew>45 0 1 0 1 0 0</skew><instance")
    assert refused_dae(skewed) == "the element skew"
    for word in ("nan", "-inf", "1e999", "1.#QNAN"):
        assert refused_dae(dae().replace(b'count="12">0', f'count="12">{word}'.encode())) == f"the coordinate {word}"
    with pytest.raises(InputError, match="the element linestrips"):
        triangles_of(dae().replace(b"</mesh>", b"<linestrips/></mesh>"), "dae")


def test_a_flat_mesh_and_an_open_one_are_not_called_inside_out() -> None:
    assert "open edges" in str(refused(binary_stl(CUBE[1:, ::-1]), "stl").value)
    sheet = np.concatenate([CUBE[:2], CUBE[:2, ::-1]])
    assert "a volume of" in str(refused(binary_stl(sheet), "stl").value)
