"""Mesh files: read exactly, or refused; the hazards T1 to T8 of the mesh library each have their guard tried."""

from __future__ import annotations

import base64
import io
import json
import struct
from typing import Any

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.scenes.bounds import LARGEST_MESH_M, MAX_FACES, SMALLEST_MESH_M
from assur.scenes.meshes import covered
from assur.scenes.meshes import load as loading
from assur.scenes.meshes.assets import asset, asset_names
from assur.scenes.meshes.load import load
from assur.scenes.meshes.surface import closed_surface, volume_of
from assur.scenes.schema.shapes import MeshDocument
from tests.scenes.meshes.solids import CUBE, SOLIDS, binary_stl, surface


def exported(corners: FloatArray, form: str) -> bytes:
    """The file that trimesh writes of these triangles."""
    vertices, faces = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    mesh: Any = trimesh.Trimesh(vertices, faces.reshape(-1, 3), process=False)
    content = mesh.export(file_type=form)
    return content if isinstance(content, bytes) else bytes(content, "ascii")


@pytest.mark.parametrize("form", ["stl", "stl_ascii", "obj", "ply", "glb"])
@pytest.mark.parametrize("name", sorted(SOLIDS))
def test_each_format_gives_the_same_solid(form: str, name: str) -> None:
    wanted = surface(SOLIDS[name])
    found = load(exported(SOLIDS[name], form), form[:3], "mm")
    assert len(found.faces) == len(wanted.faces)
    assert len(found.vertices) == len(wanted.vertices)
    assert volume_of(found.corners) == pytest.approx(volume_of(wanted.corners), rel=1e-5)
    np.testing.assert_allclose(np.sort(found.corners.sum((1, 2))), np.sort(wanted.corners.sum((1, 2))), atol=1e-6)


def test_a_binary_stl_file_is_read_as_the_library_reads_it() -> None:
    facets = np.random.default_rng(1).bytes(50 * 200).replace(b"\x7f", b"\0").replace(b"\xff", b"\0")
    content = b"solid facet".ljust(80) + struct.pack("<I", 200) + facets
    read: Any = trimesh.load(io.BytesIO(content), file_type="stl", process=False)
    found = loading.triangles_of(content, "stl")
    assert np.isfinite(found).all()
    assert np.array_equal(found, read.vertices[read.faces])


@pytest.mark.parametrize(("unit", "metres"), [("m", 1.0), ("cm", 0.01), ("mm", 0.001), ("in", 0.0254)])
def test_the_unit_scales(unit: str, metres: float) -> None:
    content = binary_stl(CUBE * (1e-3 if unit == "m" else 0.1))
    found = load(content, "stl", unit)
    side = (0.1 if unit == "m" else 10.0) * metres
    np.testing.assert_allclose(np.ptp(found.vertices, axis=0), side, rtol=1e-6)


def refused(content: bytes, form: str, unit: str = "mm") -> InputError:
    with pytest.raises(InputError) as caught:
        load(content, form, unit)
    assert caught.value.field.startswith("mesh.")
    return caught.value


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_t1_vertices_that_are_not_finite_are_refused(bad: float) -> None:
    corners = CUBE.copy()
    corners[3, 1, 2] = bad
    assert "finite" in refused(binary_stl(corners), "stl").allowed


@pytest.mark.parametrize("content", [b"", b"\0" * 84, b"solid x\nendsolid x\n", b"solid x\nfacet\nendsolid"])
def test_t1_files_without_triangles_are_refused(content: bytes) -> None:
    refused(content, "stl")


def test_t1_a_few_good_triangles_among_bad_ones_do_not_make_a_mesh() -> None:
    broken = np.concatenate([CUBE, np.full((1, 3, 3), np.nan)])
    refused(binary_stl(broken), "stl")


@pytest.mark.parametrize("form", ["stl", "obj", "ply", "glb"])
def test_t2_archives_are_refused_whatever_they_call_themselves(form: str) -> None:
    for head in (b"PK\x03\x04", b"\x1f\x8b\x08", b"BZh9", b"7z\xbc\xaf"):
        refused(head + bytes(400), form)


@pytest.mark.parametrize("form", ["zip", "3mf", "dae", "off", "urdf", "", "STL"])
def test_t2_other_formats_are_refused(form: str) -> None:
    assert refused(binary_stl(CUBE), form).field == "mesh.format"


@given(st.binary(max_size=200), st.sampled_from(["stl", "obj", "ply", "glb"]))
def test_t3_any_bytes_are_refused_with_an_input_error(content: bytes, form: str) -> None:
    refused(content, form)


@given(
    st.sampled_from(["stl", "stl_ascii", "obj", "ply", "glb"]),
    st.integers(0, 10_000),
    st.binary(min_size=1, max_size=4),
)
def test_t3_a_file_with_some_bytes_changed_is_read_or_refused(form: str, place: int, patch: bytes) -> None:
    content = bytearray(FILES[form])
    place %= len(content)
    content[place : place + len(patch)] = patch
    try:
        found = load(bytes(content), form[:3], "mm")
    except InputError:
        return
    assert volume_of(found.corners) > 0


@given(st.sampled_from(["stl", "stl_ascii", "obj", "ply", "glb"]), st.floats(0.0, 0.999))
def test_t3_a_file_that_is_cut_short_is_never_a_smaller_obstacle(form: str, share: float) -> None:
    content = FILES[form][: int(len(FILES[form]) * share)]
    try:
        found = load(content, form[:3], "mm")
    except InputError:
        return
    assert len(found.faces) == len(CUBE)


FILES = {form: exported(CUBE, form) for form in ("stl", "stl_ascii", "obj", "ply", "glb")}


def glb(tree: Any, binary: bytes = b"") -> bytes:
    """A GLB file of this JSON and binary chunk."""
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    body = struct.pack("<II", len(text), 0x4E4F534A) + text
    if binary:
        body += struct.pack("<II", len(binary), 0x004E4942) + binary
    return struct.pack("<III", 0x46546C67, 2, 12 + len(body)) + body


def _tree(content: bytes) -> tuple[Any, bytes]:
    (length,) = struct.unpack_from("<I", content, 12)
    return json.loads(content[20 : 20 + length]), content[28 + length :]


@pytest.mark.parametrize("place", ["buffers", "images"])
def test_t4_references_out_of_the_file_are_refused(place: str) -> None:
    tree, binary = _tree(FILES["glb"])
    tree.setdefault(place, [{}])[0]["uri"] = "../secret.bin"
    assert "reference" in str(refused(glb(tree, binary), "glb").value)


def test_t4_a_material_library_is_not_looked_for() -> None:
    content = b"mtllib /etc/passwd\nusemtl x\n" + FILES["obj"]
    assert len(load(content, "obj", "mm").faces) == len(CUBE)


def test_t5_trimesh_is_given_bytes_only_and_nothing_to_resolve_names_with(monkeypatch: pytest.MonkeyPatch) -> None:
    given_to: list[Any] = []
    real = trimesh.load

    def spy(source: Any, **options: Any) -> Any:
        given_to.append((source, options))
        return real(source, **options)

    monkeypatch.setattr(trimesh, "load", spy)
    load(FILES["obj"], "obj", "mm")
    ((source, options),) = given_to
    assert type(source) is io.BytesIO
    assert options == {"file_type": "obj", "process": False, "skip_materials": True}


def test_t6_indices_out_of_range_are_refused() -> None:
    refused(b"v 0 0 0\nv 100 0 0\nv 0 100 0\nv 0 0 100\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 99\n", "obj")
    header = b"ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    faces = b"element face 4\nproperty list uchar int vertex_indices\nend_header\n"
    points = b"0 0 0\n100 0 0\n0 100 0\n0 0 100\n"
    assert len(load(header + faces + points + b"3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n", "ply", "mm").faces) == 4
    refused(header + faces + points + b"3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 9\n", "ply")
    refused(header + faces + points + b"3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 -1\n", "ply")


@pytest.mark.parametrize("count", [4_000_000_000, 3, 13])
def test_t6_a_header_that_lies_about_its_length_is_refused(count: int) -> None:
    refused(b"\0" * 80 + struct.pack("<I", count) + FILES["stl"][84:], "stl")


def test_t6_declared_counts_are_bounded_before_the_file_is_parsed(monkeypatch: pytest.MonkeyPatch) -> None:
    def never(content: bytes, form: str) -> Any:
        raise AssertionError("parsed")

    monkeypatch.setattr(loading, "_triangles", never)
    ply = b"ply\nformat binary_little_endian 1.0\nelement vertex 1000000000\nproperty float x\nend_header\n"
    refused(ply + bytes(100), "ply")
    refused(ply.replace(b"1000000000", b"-7"), "ply")
    tree, binary = _tree(FILES["glb"])
    for spoilt in (
        {"accessors": [{"componentType": 5126, "count": 200_000_000, "type": "VEC3"}]},
        {"accessors": [{"bufferView": 0, "componentType": 5126, "count": 200_000_000, "type": "VEC3"}]},
        {"accessors": [{"bufferView": 0, "count": 4, "sparse": {}}]},
        {"accessors": [{"bufferView": 0, "count": "4"}]},
        {"nodes": [{"mesh": 0}] * 5_000},
        {"nodes": 7},
        {"extensionsRequired": ["KHR_draco_mesh_compression"]},
    ):
        refused(glb({**tree, **spoilt}, binary), "glb")
    refused(glb([1]), "glb")
    refused(b"\0" * 80 + struct.pack("<I", MAX_FACES + 1) + bytes(50 * (MAX_FACES + 1)), "stl")


def test_t7_sizes_that_only_a_wrong_unit_explains_are_refused() -> None:
    for scale, unit in ((1.0, "m"), (1e-5, "mm")):
        error = refused(binary_stl(CUBE * scale), "stl", unit)
        assert error.field == "mesh.unit"
    for extent in (SMALLEST_MESH_M, LARGEST_MESH_M):
        closed_surface(CUBE / 100.0, extent * 0.999 if extent > 1 else extent * 1.001)
        with pytest.raises(InputError):
            closed_surface(CUBE / 100.0, extent * 1.001 if extent > 1 else extent * 0.999)
    far = binary_stl(CUBE + np.array([1e6, 0.0, 0.0]))
    assert refused(far, "stl").field == "mesh.unit"


def test_t8_what_is_not_watertight_is_refused() -> None:
    assert "closed" in refused(binary_stl(CUBE[1:]), "stl").allowed
    one_turned = CUBE.copy()
    one_turned[0] = one_turned[0][::-1]
    assert "closed" in refused(binary_stl(one_turned), "stl").allowed
    shifted = CUBE.copy()
    shifted[0, 0, 0] += 0.01
    assert "closed" in refused(binary_stl(shifted), "stl").allowed


def test_t8_a_surface_inside_out_is_refused() -> None:
    assert "outwards" in refused(binary_stl(CUBE[:, ::-1]), "stl").allowed
    sheet = np.concatenate([CUBE[:2], CUBE[:2, ::-1]])
    assert "volume" in str(refused(binary_stl(sheet), "stl").value)


def test_a_scene_of_several_nodes_is_put_together_where_they_stand() -> None:
    scene: Any = trimesh.Scene()
    cube = trimesh.creation.box((10, 10, 10))
    for x, sign in ((0.0, 1.0), (30.0, 1.0), (60.0, -1.0)):
        place = np.diag([sign, 1.0, 1.0, 1.0])
        place[0, 3] = x
        scene.add_geometry(cube, transform=place)
    found = load(scene.export(file_type="glb"), "glb", "mm")
    assert len(found.faces) == 36
    np.testing.assert_allclose(np.ptp(found.vertices, axis=0), [0.07, 0.01, 0.01], atol=1e-9)
    assert volume_of(found.corners) == pytest.approx(3e-6, rel=1e-6)


def test_a_mesh_that_is_shown_often_is_counted_as_often_as_it_is_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(loading, "MAX_FACES", 30)
    scene: Any = trimesh.Scene()
    cube = trimesh.creation.box((10, 10, 10))
    for x in (0.0, 20.0, 40.0):
        place = np.eye(4)
        place[0, 3] = x
        scene.add_geometry(cube, transform=place)
    assert "30 triangles" in refused(scene.export(file_type="glb"), "glb").allowed


def test_points_without_faces_are_no_mesh() -> None:
    library: Any = trimesh
    refused(library.PointCloud(CUBE.reshape(-1, 3)).export(file_type="ply"), "ply")
    refused(b"v 0 0 0\nv 1 0 0\nv 0 1 0\n", "obj")


def test_a_unit_that_is_none_is_refused() -> None:
    assert refused(binary_stl(CUBE), "stl", "ft").field == "mesh.unit"


def test_the_assets_are_what_their_maker_makes() -> None:
    from assur.scenes.assets.make_assets import ASSETS, stl

    assert asset_names() == tuple(sorted(ASSETS))
    for name, make in ASSETS.items():
        assert asset(name) == stl(make()), f"{name}: run python -m assur.scenes.assets.make_assets"
        found = load(asset(name), "stl", "mm")
        middle = (found.vertices.max(0) + found.vertices.min(0)) / 2
        np.testing.assert_allclose(middle, 0.0, atol=1e-9)
    np.testing.assert_allclose(
        np.ptp(load(asset("bracket"), "stl", "mm").vertices, axis=0), [0.06, 0.04, 0.02], atol=1e-8
    )
    with pytest.raises(InputError):
        asset("../assets/bracket")


def test_inline_bytes_are_read_and_equal_content_is_covered_once() -> None:
    data = base64.b64encode(binary_stl(SOLIDS["tray"])).decode()
    one = covered(MeshDocument(data=data, format="stl", unit="mm"))
    other = covered(MeshDocument(data=data, format="stl", unit="mm"))
    assert one is other
    assert covered(MeshDocument(data=data, format="stl", unit="cm")) is not one
