"""Descriptions of which no robot can be made are refused, with all that is missing and what to supply."""

from __future__ import annotations

from pathlib import Path

import pytest

from assur.scenes.urdf.solids import Covering
from tests.scenes.meshes.solids import CUBE, binary_stl
from tests.scenes.urdf.made import FAMILIES, Files, J, box, mesh, told, urdf

GOOD = FAMILIES["scara, lift third"][2]


def test_everything_that_is_missing_is_told_at_once(tmp_path: Path) -> None:
    text = GOOD.replace('velocity="3.0"', 'velocity="0"', 1).replace('type="revolute"', 'type="continuous"', 1)
    found = told(Files(tmp_path).write(text), joint_limits=None)
    assert found[0] == (
        "joint a_joint_1: it turns without end (type continuous), and our arms have ranges; "
        "give it in --joint-limits as joint_limits.a_joint_1.min_position and max_position (rad)"
    )
    assert found[1] == (
        "joint a_joint_1: limit.velocity is 0 in the URDF; "
        "give it in --joint-limits as joint_limits.a_joint_1.max_velocity (rad/s)"
    )
    accelerations = [each for each in found if "no limit.acceleration in the URDF" in each]
    assert len(found) == 6
    assert len(accelerations) == 4
    assert accelerations[2].endswith("joint_limits.a_joint_3.max_acceleration (m/s2)")


def test_a_file_of_limits_takes_the_place_of_what_the_urdf_has_wrong(tmp_path: Path) -> None:
    text = GOOD.replace('velocity="3.0"', 'velocity="0"', 1).replace('type="revolute"', 'type="continuous"', 1)
    files = Files(tmp_path).write(text)
    files.limits.write_text(
        files.limits.read_text().replace(
            "a_joint_1: {",
            "a_joint_1: {min_position: -1, max_position: 2, max_velocity: 2.5, has_jerk_limits: true, max_jerk: 500, ",
        )
    )
    found = files.imported()
    assert "range_rad: {value: [-1.0, 2.0]" in found.text
    assert "velocity_rad_s: {value: 2.5" in found.text
    assert "jerk_rad_s3: {value: 500.0, status: third_party" in found.text


LEVEL = (0.0, 1.0, 0.0)
MIMIC = '<mimic joint="a_joint_2" multiplier="-1"/>'
TURN = J("revolute")
PALLETISER = (TURN, J("revolute", (0, 0, 0.3), axis=LEVEL), J("revolute", (0, 0, 0.4), axis=LEVEL))


def levelled(more: str) -> str:
    """Four axes whose hand is kept level, perhaps by a linkage."""
    return urdf(*PALLETISER, J("revolute", (0.4, 0, 0), axis=LEVEL, more=more), J("revolute", (0.1, 0, 0)))


LAUGHS = '<!DOCTYPE robot [<!ENTITY a "ha"><!ENTITY b "&a;&a;&a;">]>'


def swapped(old: str, new: str) -> str:
    assert old in GOOD
    return GOOD.replace(old, new, 1)


def colliding(shape: str) -> str:
    return swapped(
        '<link name="l1"></link>', f'<link name="l1"><collision><geometry>{shape}</geometry></collision></link>'
    )


def of_file(name: str) -> str:
    return colliding(f'<mesh filename="{name}"/>')


BAD: dict[str, tuple[str, str]] = {
    "entities": (LAUGHS + GOOD.replace("made", "&b;"), "remove <!DOCTYPE"),
    "no xml": (GOOD[:-9], "well-formed XML is needed"),
    "another kind of document": ("<sdf/>", "the outermost element must be <robot>"),
    "deep": ("<robot name='a'>" + "<b>" * 200 + "</b>" * 200 + "</robot>", "nested up to 64 deep"),
    "nothing": ("<robot name='a'/>", "0 links"),
    "not a number": (swapped('lower="-2.0"', 'lower="nan"'), "is no finite number"),
    "too large a number": (swapped("0.3 0.0 0.0", "1e300 0 0"), "is no finite number"),
    "two numbers": (swapped("0.3 0.0 0.0", "0.3 0"), "write 3 numbers"),
    "no axis": (swapped('<axis xyz="0.0 0.0 1.0"/>', '<axis xyz="0 0 0"/>'), "a direction that is not 0 0 0"),
    "a parent that is not there": (swapped('parent link="l1"', 'parent link="lost"'), "name a link that is there"),
    "two roots": (swapped('<link name="l0"></link>', '<link name="l0"/><link name="other"/>'), "2 roots: l0, other"),
    "two parents": (swapped('child link="l3"', 'child link="l2"'), "it is the child of 2 joints"),
    "a loop": (swapped('parent link="l0"', 'parent link="l4"'), "loop of joints"),
    "two limits": (
        swapped("<limit", '<limit lower="0" upper="1" velocity="1"/><limit'),
        "limit: more than one of them",
    ),
    "a name twice": (swapped('name="a_joint_2"', 'name="a_joint_1"'), "a second one"),
    "a link twice": (swapped('link name="l2"', 'link name="l1"'), "a name of its own"),
    "an unknown type": (swapped('type="revolute"', 'type="screw"'), "one of revolute, continuous"),
    "an unknown shape": (colliding("<cone/>"), "one of box, sphere"),
    "floating": (swapped('type="revolute"', 'type="floating"'), "begin below it with --base LINK"),
    "an empty range": (swapped('lower="-2.0" upper="2.5"', 'lower="0" upper="0"'), "the first below the second"),
    "a linkage": (levelled(MIMIC), "it mimics joint a_joint_2"),
    "a palletiser without a linkage": (levelled(""), "its axis passes the pitch axis at 100 mm"),
    "a palletiser of four axes": (
        urdf(*PALLETISER, J("revolute", (0.4, 0, 0))),
        "this is a palletiser with four axes, and no SCARA",
    ),
    "six axes": (
        urdf(*[J("revolute", (0.1, 0, 0.1), axis=(0, float(i > 0), float(i == 0))) for i in range(6)]),
        "6 moving joints",
    ),
    "a shoulder off the base axis": (
        urdf(
            TURN,
            J("revolute", (0.03, 0, 0.3), axis=LEVEL),
            J("revolute", (0.2, 0, 0), axis=LEVEL),
            J("fixed", (0.2, 0, 0)),
        ),
        "its axis passes the axis of joint a_joint_1 at 30 mm",
    ),
    "a base that lies": (urdf(J("fixed", rpy=(1.0, 0, 0)), *[J("revolute", (0.1, 0, 0))] * 3), "off the vertical"),
    "links in one line": (swapped("0.3 0.0 0.0", "0 0 0"), "link 1 has no length"),
    "a mesh of no package": (of_file("package://lost/a.stl"), "say --package lost=FOLDER"),
    "a mesh of somebody's machine": (of_file("file:///etc/a.stl"), "is a path of somebody's machine"),
    "a mesh that leaves the folder": (of_file("../../a.stl"), "leaves the folder"),
    "a file that is no mesh": (of_file("/etc/passwd"), "a mesh in a file that ends in"),
}


@pytest.mark.parametrize("name", BAD)
def test_a_description_that_is_unsuitable_is_refused_with_what_would_be_right(name: str, tmp_path: Path) -> None:
    text, words = BAD[name]
    found = told(Files(tmp_path).write(text))
    assert any(words in each for each in found), found
    assert all("; " in each for each in found)


def with_mesh(file: str) -> str:
    shape = mesh(file, "0.001 0.001 0.001", (0.1, 0.0, 0.0))
    lift = J("prismatic", (0.2, 0, 0), ends=(0, 0.1))
    return urdf(J("revolute", (0, 0, 0.2), shape=shape), J("revolute", (0.3, 0, 0)), lift)


def test_a_mesh_that_is_not_closed_is_refused_or_taken_as_its_hull(tmp_path: Path) -> None:
    (tmp_path / "open.stl").write_bytes(binary_stl(CUBE[:-1]))
    files = Files(tmp_path).write(with_mesh("open.stl"))
    (found,) = told(files)
    assert found.startswith("link l1, collision: the mesh is not closed: ")
    assert "say --open-meshes hull to take its convex hull" in found
    taken = files.imported(covering=Covering(0.01, 8, open_hull=True))
    assert [cover["hulls"] for cover in taken.report["covers"]] == [1]


def test_a_mesh_in_another_unit_is_refused_with_the_scale_that_is_missing(tmp_path: Path) -> None:
    (tmp_path / "a.stl").write_bytes(binary_stl(CUBE))
    (found,) = told(Files(tmp_path).write(with_mesh("a.stl").replace("0.001 0.001 0.001", "1 1 1")))
    assert "the mesh is 100 m large" in found
    assert "0.001 0.001 0.001 of mm" in found


def test_a_link_with_a_wrong_shape_is_told_once(tmp_path: Path) -> None:
    (found,) = told(Files(tmp_path).write(with_mesh("a.stl").replace("0.001 0.001 0.001", "nan 1 1")))
    assert found == "link l1, collision, mesh.scale: 'nan' is no finite number in metres or radians; write a number"


def test_names_that_are_too_long_are_refused(tmp_path: Path) -> None:
    for old in ("a_joint_1", "l4"):
        (found, *_) = told(Files(tmp_path).write(GOOD.replace(f'"{old}"', f'"{"y" * 5000}"')))
        assert "a name of 5000 characters; names of up to 200 characters are read" in found
        assert len(found) < 200
    files = Files(tmp_path).write(GOOD.replace('"made"', f'"{"y" * 5000}"'))
    assert len(files.imported().name) == 64


def test_a_number_that_our_form_does_not_take_is_told_at_its_joint(tmp_path: Path) -> None:
    files = Files(tmp_path).write(GOOD)
    files.limits.write_text(files.limits.read_text().replace("20.0", "1.0e+300", 1))
    (found,) = told(files)
    assert found == "joint a_joint_1, acceleration_rad_s2: 1e+300; allowed is at most 1000000"


def test_a_package_whose_folder_is_not_there_is_refused(tmp_path: Path) -> None:
    (found,) = told(Files(tmp_path).write(GOOD), packages={"a": tmp_path / "nowhere"})
    assert found.startswith("--package a: no folder ")


def test_a_link_in_place_of_a_mesh_is_not_followed(tmp_path: Path) -> None:
    inside = tmp_path / "robot"
    inside.mkdir()
    (tmp_path / "out.stl").write_bytes(binary_stl(CUBE))
    (inside / "a.stl").symlink_to(tmp_path / "out.stl")
    (found,) = told(Files(inside).write(with_mesh("a.stl")))
    assert "no link" in found


def test_an_srdf_of_another_robot_is_refused(tmp_path: Path) -> None:
    srdf = tmp_path / "a.srdf"
    srdf.write_text('<robot name="x"><disable_collisions link1="l0" link2="gripper"/></robot>')
    (found,) = told(Files(tmp_path).write(GOOD), srdf=srdf)
    assert "link 'gripper' is not in the URDF" in found


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("joints: {}\n", "no mapping joint_limits"),
        ("joint_limits: &a {}\n", "no anchors"),
        ("joint_limits:\n  a_joint_1: {max_acceleration: fast}\n", "'fast' in joint_limits.yaml, and no number"),
        ("joint_limits:\n  a_joint_1: {max_acceleration: -3}\n", "max_acceleration is -3"),
        ("joint_limits:\n  a_joint_1: {has_acceleration_limits: false, max_acceleration: 3}\n", "no limit.acc"),
    ],
)
def test_a_file_of_limits_that_is_not_right_is_refused(text: str, words: str, tmp_path: Path) -> None:
    files = Files(tmp_path).write(GOOD)
    files.limits.write_text(text)
    assert any(words in each for each in told(files))


def test_links_and_joints_that_options_name_must_be_there(tmp_path: Path) -> None:
    files = Files(tmp_path).write(GOOD)
    assert "no link of this name; one of l0, l1" in told(files, tip="flange")[0]
    assert "no joint of this name" in told(files, held={"x": 0.0})[0]
    assert "it does not hang on link l2" in told(files, base="l2", tip="l1")[0]


def test_a_body_is_used(tmp_path: Path) -> None:
    good = urdf(*[J("revolute", (0.2, 0, 0), shape=box(0.1, 0.1, 0.1))] * 2, J("prismatic", (0.2, 0, 0), ends=(0, 0.1)))
    files = Files(tmp_path).write(good)
    assert files.imported().report["bodies"] == 2
