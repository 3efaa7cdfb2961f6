"""COLLADA files, which descriptions of robots name: their unit is applied, and what could harm is refused."""

from __future__ import annotations

import numpy as np
import pytest

from assur.planner.errors import InputError
from assur.scenes.meshes.load import load, triangles_of

HEAD = '<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">'
POINTS = "0 0 0 100 0 0 0 100 0 0 0 100"


def dae(
    unit: str = '<unit name="millimeter" meter="0.001"/>', faces: str = "0 2 1 0 1 3 0 3 2 1 2 3", head: str = HEAD
) -> bytes:
    """A tetrahedron with edges of 100 along the axes."""
    return f"""{head}<asset>{unit}<up_axis>Y_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="s"><float_array id="a" count="12">{POINTS}</float_array><technique_common>
<accessor source="#a" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
<triangles count="{len(faces.split()) // 3}"><input semantic="VERTEX" source="#v" offset="0"/><p>{faces}</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="w"><node><instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes>
<scene><instance_visual_scene url="#w"/></scene></COLLADA>""".encode()


def test_a_collada_file_is_read_in_its_unit() -> None:
    found = triangles_of(dae(), "dae")
    assert found.shape == (4, 3, 3)
    assert np.allclose(found.reshape(-1, 3).max(0), [0.1, 0.1, 0.1])
    assert np.allclose(triangles_of(dae(unit=""), "dae").reshape(-1, 3).max(0), [100, 100, 100])


@pytest.mark.parametrize(
    ("content", "value"),
    [
        (b"<COLLADA", "ParseError"),
        (b'<!DOCTYPE a [<!ENTITY b "c">]>' + dae(), "DTDForbidden"),
        (dae(unit='<unit meter="0"/>'), "no length"),
        (dae(unit='<unit meter="x"/>'), "no length"),
        (dae().replace(b"<instance_geometry", b'<instance_node url="#n"/><instance_geometry'), "instance_node"),
    ],
)
def test_a_collada_file_that_is_not_right_is_refused(content: bytes, value: str) -> None:
    with pytest.raises(InputError) as caught:
        triangles_of(content, "dae")
    assert value in str(caught.value.value)


def test_a_document_does_not_name_collada() -> None:
    with pytest.raises(InputError, match=r"mesh\.format"):
        load(dae(), "dae", "m")
