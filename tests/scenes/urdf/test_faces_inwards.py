"""A mesh of a link that is closed and inside out: reported as such, not as open."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.scenes.meshes.solids import SOLIDS, binary_stl
from tests.scenes.urdf.made import Files
from tests.scenes.urdf.test_solids_of_links import MESH, arms

NOISE = np.random.default_rng(5).uniform(-1e-3, 1e-3, SOLIDS["star"].shape)


@pytest.mark.parametrize("name", ["rrpr, link 1", "rrpr, link 3"])
@pytest.mark.parametrize("noise", [0.0, 1.0])
def test_a_mesh_that_is_inside_out_is_not_called_open(name: str, noise: float, tmp_path: Path) -> None:
    """Also of a link that is taken as cylinders, and where vertices have to be made one first."""
    files = Files(tmp_path).write(arms(MESH)[name][0])
    (tmp_path / "star.stl").write_bytes(binary_stl((SOLIDS["star"] + noise * NOISE)[:, ::-1]))
    with pytest.raises(Exception, match=r"the mesh is closed, but its faces point inwards.*flip its faces") as caught:
        files.imported()
    assert "not closed" not in str(caught.value)


def test_an_open_mesh_is_still_called_open(tmp_path: Path) -> None:
    files = Files(tmp_path).write(arms(MESH)["rrpr, link 1"][0])
    (tmp_path / "star.stl").write_bytes(binary_stl(SOLIDS["star"][1:, ::-1]))
    with pytest.raises(Exception, match="the mesh is not closed"):
        files.imported()
