"""Numbers that no arm has are warned about, with what they are in the other unit; real arms give no warning."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.scenes.meshes.solids import CUBE, binary_stl
from tests.scenes.urdf.made import CELLARM_LIMITS, FAMILIES, FORE_AT, Files, cellarm, told
from tests.scenes.urdf.random_arms import ARMS

ELBOW = 'lower="-2.5" upper="2.5" velocity="9"'
LIFT = 'lower="0" upper="0.15" velocity="1"'
BASE = '<geometry><cylinder radius="0.06" length="0.2"/></geometry>'
FORE = '<box size="0.3 0.1 0.06"/>'


def warnings_of(files: Files) -> list[str]:
    warnings: list[str] = files.imported().report["warnings"]
    return warnings


@pytest.mark.parametrize("name", [*FAMILIES, *ARMS])
def test_plausible_arms_give_no_warning(name: str, tmp_path: Path) -> None:
    text = FAMILIES[name][2] if name in FAMILIES else ARMS[name]
    assert warnings_of(Files(tmp_path).write(text)) == []


def test_the_fastest_arms_that_are_sold_and_small_parts_give_no_warning(tmp_path: Path) -> None:
    fast = CELLARM_LIMITS.replace("300", "1200").replace(": 12}", ": 60}")
    wrist = ('lower="-6.28" upper="6.28" velocity="20"', 'lower="-12.6" upper="12.6" velocity="52"')
    sensor = (
        '<link name="carriage"/>',
        f'<link name="carriage"><collision>{FORE.join(("<geometry>", "</geometry>"))}'
        '</collision><collision><geometry><sphere radius="0.001"/></geometry></collision></link>',
    )
    assert warnings_of(cellarm(tmp_path, wrist, sensor, (LIFT, LIFT.replace('"1"', '"3"')), limits=fast)) == []


def test_a_mesh_that_is_scaled_twice_is_warned_about(tmp_path: Path) -> None:
    (tmp_path / "pedestal.stl").write_bytes(binary_stl(CUBE * 0.012))  # 1.2 m
    shape = '<geometry><mesh filename="pedestal.stl" scale="{0} {0} {0}"/></geometry>'
    assert warnings_of(cellarm(tmp_path, (BASE, shape.format("0.001")))) == [
        "link base: its collision shapes are 1.2 mm large, and the rest of the arm 330 mm; with 1000 times the scale "
        "they are 1200 mm"
    ]
    assert warnings_of(cellarm(tmp_path, (BASE, shape.format("1")))) == []


def test_a_shape_in_mm_is_warned_about(tmp_path: Path) -> None:
    assert warnings_of(cellarm(tmp_path, (FORE, '<box size="45 20 20"/>'))) == [
        "link fore: its collision shapes are 4.5e+04 mm large, and the rest of the arm 300 mm; with 0.001 times the "
        "scale they are 45 mm"
    ]


def test_an_odd_shape_of_no_other_unit_is_warned_about_without_one(tmp_path: Path) -> None:
    (found,) = warnings_of(cellarm(tmp_path, (FORE, '<sphere radius="0.000001"/>')))
    assert found == "link fore: its collision shapes are 0.002 mm large, and the rest of the arm 300 mm"


def test_degrees_in_place_of_radians_are_warned_about(tmp_path: Path) -> None:
    assert warnings_of(cellarm(tmp_path, (ELBOW, 'lower="-145" upper="145" velocity="600"'))) == [
        "joint elbow: its range is -145 to 145 rad, 46.2 turns; if these are deg, it is -2.53073 to 2.53073 rad "
        "(made.urdf, joint elbow, limit.lower, limit.upper)",
        "joint elbow: its velocity is 600 rad/s; if these are deg/s, it is 10.472 rad/s "
        "(made.urdf, joint elbow, limit.velocity)",
    ]
    limits = CELLARM_LIMITS.replace(": 90}", ": 6000}")
    assert warnings_of(cellarm(tmp_path, limits=limits)) == [
        "joint elbow: its acceleration is 6000 rad/s2; if these are deg/s2, it is 104.72 rad/s2 "
        "(joint_limits.yaml, joint_limits.elbow.max_acceleration)"
    ]


def test_degrees_of_an_origin_are_warned_about(tmp_path: Path) -> None:
    assert warnings_of(cellarm(tmp_path, (FORE_AT, f'{FORE_AT} rpy="0 0 90"'))) == [
        "line 5, link fore, collision, origin.rpy: 0 0 90 is more than a turn; if these are deg, it is 0 0 1.5708 rad"
    ]
    assert warnings_of(cellarm(tmp_path, (FORE_AT, f'{FORE_AT} rpy="0 0 -6.283185307179586"'))) == []


def test_angles_that_are_converted_twice_are_warned_about(tmp_path: Path) -> None:
    assert warnings_of(cellarm(tmp_path, (ELBOW, 'lower="-0.0436" upper="0.0436" velocity="0.0157"'))) == [
        "joint elbow: its range is -0.0436 to 0.0436 rad, 0.0139 turns; if these were converted twice, it is -2.4981 "
        "to 2.4981 rad (made.urdf, joint elbow, limit.lower, limit.upper)",
        "joint elbow: its velocity is 0.0157 rad/s; if it was converted twice, it is 0.899544 rad/s "
        "(made.urdf, joint elbow, limit.velocity)",
    ]


def test_millimetres_of_a_lift_are_warned_about(tmp_path: Path) -> None:
    assert warnings_of(cellarm(tmp_path, (LIFT, 'lower="0" upper="150" velocity="1000"'))) == [
        "joint lift: its range is 0 to 150 m; if these are mm, it is 0 to 0.15 m "
        "(made.urdf, joint lift, limit.lower, limit.upper)",
        "joint lift: its velocity is 1000 m/s; if these are mm/s, it is 1 m/s (made.urdf, joint lift, limit.velocity)",
    ]


def test_an_arm_in_mm_is_warned_about(tmp_path: Path) -> None:
    found = warnings_of(cellarm(tmp_path, ('xyz="0.3 0 0"', 'xyz="30 0 0"'), ('xyz="0.2 0 0"', 'xyz="20 0 0"')))
    way = "the way along the joint origins from link base to link flange is"
    assert found == [f"{way} 50.2 m; if these are mm, it is 0.0502 m"]
    assert told(cellarm(tmp_path, ('xyz="0.3 0 0"', 'xyz="300 0 0"'))) == [
        "scara.l1_m.value: 300.0; allowed is at most 50; a URDF has lengths in m: write mm times 0.001"
    ]
    tiny = (('xyz="0.3 0 0"', 'xyz="0.0003 0 0"'), ('xyz="0.2 0 0"', 'xyz="0.0002 0 0"'), ('xyz="0 0 0.2"', ""))
    found = warnings_of(cellarm(tmp_path, *tiny))
    assert found == [f"{way} 0.0005 m; if it was converted twice, it is 0.5 m"]
