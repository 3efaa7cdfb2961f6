"""What trimesh makes of bad mesh files without a word: the reasons for the guards in `assur.scenes.meshes`."""

from __future__ import annotations

import io
import struct
from typing import Any

import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray

from assur.planner.errors import InputError
from assur.scenes.meshes.load import load
from tests.hazards.known import mended_since

LAST_SEEN = "5.2.0"
"""The release of trimesh in which everything here was reproduced."""


def _stl(triangles: NDArray[np.float64]) -> bytes:
    """A binary STL of triangles (f, 3, 3)."""
    records = (struct.pack("<12fH", 0.0, 0.0, 1.0, *corners.ravel(), 0) for corners in triangles)
    return b"\0" * 80 + struct.pack("<I", len(triangles)) + b"".join(records)


def _faces(content: bytes) -> int:
    """How many triangles trimesh finds."""
    with np.errstate(invalid="ignore"):
        loaded: Any = trimesh.load(io.BytesIO(content), file_type="stl")
    return len(loaded.faces)


def _cube() -> NDArray[np.float64]:
    """The 12 triangles of a cube with an edge of 0.1."""
    cube = trimesh.creation.box((0.1, 0.1, 0.1))
    corners: NDArray[np.float64] = np.asarray(cube.vertices, dtype=np.float64)[np.asarray(cube.faces)]
    return corners


def test_an_obstacle_with_a_corner_that_is_not_a_number_vanishes_in_trimesh_and_is_bad_input_for_us() -> None:
    assert len(load(_stl(_cube()), "stl", "m").faces) == 12
    for value in (np.nan, np.inf):
        every = np.full((4, 3, 3), value)
        assert _faces(_stl(every)) == 0 or mended_since("trimesh", LAST_SEEN)
        one = _cube()
        one[5, 1, 2] = value
        for triangles in (every, one):
            with pytest.raises(InputError):
                load(_stl(triangles), "stl", "m")


def test_an_empty_file_is_a_scene_for_trimesh_and_bad_input_for_us() -> None:
    assert not isinstance(trimesh.load(io.BytesIO(_stl(np.zeros((0, 3, 3)))), file_type="stl"), trimesh.Trimesh) or (
        mended_since("trimesh", LAST_SEEN)
    )
    for content in (b"", _stl(np.zeros((0, 3, 3))), _stl(np.zeros((4, 3, 3)))):
        with pytest.raises(InputError):
            load(content, "stl", "m")


def test_a_surface_with_a_hole_is_a_mesh_for_trimesh_and_bad_input_for_us() -> None:
    open_cube = _stl(_cube()[:-1])
    assert _faces(open_cube) == 11
    with pytest.raises(InputError):
        load(open_cube, "stl", "m")


def test_an_archive_is_unpacked_by_trimesh_and_bad_input_for_us() -> None:
    assert "zip" in trimesh.available_formats()
    for form in ("zip", "3mf", "dae", "off", "STL", "x.stl", ""):
        with pytest.raises(InputError, match=r"mesh\.format"):
            load(b"PK\3\4" + b"\0" * 100, form, "m")
    for form in ("stl", "obj", "ply", "glb"):
        with pytest.raises(InputError):
            load(b"PK\3\4" + b"\0" * 100, form, "m")


def test_a_header_that_promises_more_than_the_file_holds_is_bad_input_before_anything_is_allocated() -> None:
    ply = (
        b"ply\nformat binary_little_endian 1.0\nelement vertex 1000000000\nproperty float x\nproperty float y\n"
        b"property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n" + b"\0" * 60
    )
    stl = b"\0" * 80 + struct.pack("<I", 4_000_000_000) + b"\0" * 50
    for content, form in ((ply, "ply"), (stl, "stl")):
        with pytest.raises(InputError):
            load(content, form, "m")
