"""Descriptions as makers write them: grippers at the end, angles with few digits, packages side by side, odd paths."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
import yaml
import yourdfpy

from assur.scenes.urdf.importing import write
from assur.scenes.urdf.reader import read_tree
from tests.scenes.meshes.solids import SOLIDS, binary_stl
from tests.scenes.urdf.made import FAMILIES, Files, J, box, mesh, told, urdf

SCARA = FAMILIES["scara, lift third"][2]
LEVEL = (0.0, 1.0, 0.0)
FIVE = (
    J("revolute", (0, 0, 0.1)),
    J("revolute", (0, 0, 0.05), axis=LEVEL),
    J("revolute", (0.05, 0, 0.2), axis=LEVEL),
    J("revolute", (0.2, 0, 0), axis=LEVEL),
    J("revolute", (0.06, 0, 0), axis=(1, 0, 0)),
    J("fixed", (0.04, 0, 0)),
)


def finger(name: str, parent: str, y: float, more: str = "") -> str:
    shape = f"<collision>{box(0.02, 0.01, 0.02)}</collision>"
    return (
        f'<link name="{name}">{shape}</link><joint name="{name}_slide" type="prismatic"><parent link="{parent}"/>'
        f'<child link="{name}"/><origin xyz="0.03 {y} 0"/><axis xyz="0 1 0"/>'
        f'<limit lower="0" upper="0.02" velocity="1" effort="1"/>{more}</joint>'
    )


MIMIC = '<mimic joint="left_slide" multiplier="-0.5" offset="0.001"/>'
GRIPPER = finger("left", "l6", 0.01) + finger("right", "l6", -0.01, MIMIC)


def test_an_arm_with_a_gripper_is_told_how_to_be_imported_without_it(tmp_path: Path) -> None:
    files = Files(tmp_path).write(urdf(*FIVE, tail=GRIPPER))
    (found,) = told(files, joint_limits=None)
    assert found.startswith("the joints: 6 moving joints (vertical turn, level turn")
    assert found.endswith(
        "without a gripper, up to link l6, it is a five-axis arm; say --tip l6 --hold left_slide=POSITION"
    )
    taken = files.imported(tip="l6", held={"left_slide": 0.01})
    assert (taken.report["family"], taken.report["flange"], taken.report["bodies"]) == ("five_axis_arm", "l6", 2)


def test_a_joint_that_follows_one_that_is_held_is_held_where_another_library_has_it(tmp_path: Path) -> None:
    files = Files(tmp_path).write(urdf(*FIVE, tail=GRIPPER))
    tree = read_tree(files.urdf.read_bytes(), "made.urdf").with_held({"left_slide": 0.013})
    library = yourdfpy.URDF.load(str(files.urdf), load_meshes=False, build_collision_scene_graph=False)
    library.update_cfg({"left_slide": 0.013})
    for name in ("left", "right"):
        joint = tree.joints[f"{name}_slide"]
        assert not joint.moves
        assert np.abs(joint.origin - library.get_transform(name, "l6")).max() <= 1e-12
    (found,) = told(files, tip="l6", held={"right_slide": 0.0})
    assert "hold it with --hold left_slide=POSITION" in found


def test_the_linkage_of_a_palletiser_is_no_gripper(tmp_path: Path) -> None:
    hand = J("revolute", (0.2, 0, 0), axis=LEVEL, more='<mimic joint="a_joint_2" multiplier="-1"/>')
    palletiser = (J("revolute"), *FIVE[1:3], hand, J("prismatic", (0.1, 0, 0), ends=(0.0, 0.1)))
    found = told(Files(tmp_path).write(urdf(*palletiser)))
    assert not any("without a gripper" in each or "--tip" in each for each in found)
    assert any(
        each.startswith("joint a_joint_4: it mimics joint a_joint_2: a linkage, and none of our arms has one")
        for each in found
    )


def test_of_an_arm_of_no_family_neither_limits_nor_meshes_are_asked_for(tmp_path: Path) -> None:
    six = [J("revolute", (0.1, 0.05, 0.1), axis=(0, float(i > 0), float(i == 0)), velocity=0.0) for i in range(6)]
    six[2] = J("continuous", (0.1, 0, 0.1), axis=LEVEL, shape=mesh("package://lost/a.stl"))
    (found,) = told(Files(tmp_path).write(urdf(*six)), joint_limits=None)
    assert "6 moving joints (vertical turn, level turn" in found
    assert found.endswith("a roll about the hand)")


def test_of_an_arm_with_rounded_angles_what_is_missing_is_told_and_not_that_it_is_no_arm(tmp_path: Path) -> None:
    lift = 'type="prismatic"><parent link="l2"/><child link="l3"/><origin xyz="0.25 0.0 0.0" rpy="{} 0.0 0.0"/>'
    assert lift.format("0.0") in SCARA
    files = Files(tmp_path).write(SCARA.replace(lift.format("0.0"), lift.format("3.14159")))
    found = told(files, joint_limits=None)
    assert len(found) == 4
    assert all("no limit.acceleration in the URDF" in each for each in found)
    remarks = files.remarks
    assert any("(3.14159) are read as" in each for each in remarks)
    files.write(SCARA.replace(lift.format("0.0"), lift.format("3.14")))
    first, second = told(files, joint_limits=None)
    assert "0.09125 deg from vertical slide" in first
    assert second == (
        "joint a_joint_3, origin.rpy: 3.14 rad is 0.0913 deg off 180 deg; write 3.141592653589793 if that is meant"
    )


def test_a_likelier_flange_that_is_not_taken_is_said(tmp_path: Path) -> None:
    tcp = '<link name="tcp"/><joint name="mount" type="fixed"><parent link="l4"/><child link="tcp"/>'
    tilted = SCARA.replace("</robot>", tcp + '<origin rpy="3.1415 0 0"/></joint></robot>')
    files = Files(tmp_path).write(tilted)
    found = files.imported()
    assert found.report["flange"] == "l4"
    assert "link tcp is not taken as the flange: link tcp: its z axis is not vertical" in found.report["remarks"]


def test_a_joint_that_follows_none_and_a_position_that_is_none_are_refused(tmp_path: Path) -> None:
    lost = SCARA.replace("</joint></robot>", '<mimic joint="lost"/></joint></robot>')
    assert lost != SCARA
    (found,) = told(Files(tmp_path).write(lost))
    assert found == "joint a_joint_4: it mimics joint 'lost', which is not in the file; name a joint that is there"
    (found,) = told(Files(tmp_path).write(SCARA), held={"a_joint_4": float("nan")})
    assert found == "--hold a_joint_4: nan; a number in rad or m"


def test_a_long_chain_of_links_is_answered_at_once(tmp_path: Path) -> None:
    (found,) = told(Files(tmp_path).write(urdf(*[J("revolute", (0.001, 0, 0))] * 999)))
    assert found.startswith("the joints: 999 moving joints")
    assert "and 991 more) are no family of ours" in found


def with_mesh(name: str) -> str:
    shape = mesh(name, "0.001 0.001 0.001", (0.1, 0.0, 0.0))
    lift = J("prismatic", (0.2, 0, 0), ends=(0, 0.1))
    return urdf(J("revolute", (0, 0, 0.2), shape=shape), J("revolute", (0.3, 0, 0)), lift)


@pytest.mark.parametrize("start", ["file://{}/", "file:///{}/", "{}/"])
def test_an_absolute_path_below_the_package_is_found(start: str, tmp_path: Path) -> None:
    (tmp_path / "Arm.STL").write_bytes(binary_stl(SOLIDS["bracket"]))
    files = Files(tmp_path).write(with_mesh(start.format(tmp_path) + "Arm.STL"))
    assert files.imported().report["bodies"] == 2


def test_a_mesh_that_is_spelled_otherwise_is_named(tmp_path: Path) -> None:
    (tmp_path / "Arm.STL").write_bytes(binary_stl(SOLIDS["bracket"]))
    (found,) = told(Files(tmp_path).write(with_mesh("arm.stl")))
    assert "mesh 'arm.stl' is not there: no file 'arm.stl' below the folder" in found
    assert found.endswith("; the folder has 'Arm.STL', and capitals count")


MACRO = '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:macro name="arm" params="a">{}</xacro:macro></robot>'
CALL = '<robot name="made" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:include filename="$(find {})/arm.xacro"/>'


def packages(folder: Path, macro: str, name: str = "macros") -> Files:
    """A xacro file in one package that includes a macro from another beside it."""
    for package, text in (("cell", "cell.urdf.xacro"), ("macros", "arm.xacro")):
        (folder / package).mkdir()
        (folder / package / "package.xml").write_text(f"<package><name>{package}</name></package>")
        content = macro if package == "macros" else CALL.format(name) + '<xacro:arm a="1"/></robot>'
        (folder / package / text).write_text(content)
    files = Files(folder)
    files.write("", 4)
    object.__setattr__(files, "urdf", folder / "cell" / "cell.urdf.xacro")
    return files


def test_packages_are_found_side_by_side_and_others_are_asked_for(tmp_path: Path) -> None:
    inside = SCARA[SCARA.index("<link") : SCARA.index("</robot>")]
    for name in ("good", "lost", "broken", "uncalled"):
        (tmp_path / name).mkdir()
    files = packages(tmp_path / "good", MACRO.format(inside))
    assert files.imported().report["family"] == "scara"
    lost = packages(tmp_path / "lost", MACRO.format(inside), "elsewhere")
    (found,) = told(lost)
    assert found.startswith("the file: the folder of package 'elsewhere' is not known; say --package elsewhere=FOLDER")
    given = {"elsewhere": tmp_path / "good" / "macros"}
    assert lost.imported(packages=given).report["family"] == "scara"
    (found,) = told(packages(tmp_path / "broken", "  " + '<?xml version="1.0"?>' + MACRO.format(inside)))
    assert "macros/arm.xacro" in found
    alone = packages(tmp_path / "uncalled", MACRO.format(inside))
    object.__setattr__(alone, "urdf", tmp_path / "uncalled" / "macros" / "arm.xacro")
    (found,) = told(alone)
    assert "a xacro file that only defines macros has none: give the file that calls them" in found


@pytest.mark.parametrize("word", ["null", "true", "True", "False", "no", "on", "y", "1e3", "nan", "12"])
def test_names_that_are_words_of_yaml_are_read_back(word: str, tmp_path: Path) -> None:
    shape = f"<collision>{box(0.1, 0.1, 0.1)}</collision>"
    text = SCARA.replace('"made"', f'"{word}"').replace('"a_joint_1"', f'"{word}"').replace('"l1"', f'"{word}"')
    text = text.replace(f'<link name="{word}"></link>', f'<link name="{word}">{shape}</link>')
    text = re.sub(r"a_joint_(\d)", r"j\1", text)
    files = Files(tmp_path).write(text)
    limits = files.limits.read_text().replace("a_joint_1", f'"{word}"')
    files.limits.write_text(re.sub(r"a_joint_(\d)", r"j\1", limits))
    found = files.imported()
    write(found, tmp_path / "robot.yaml")
    read = yaml.safe_load((tmp_path / "robot.yaml").read_text())["scara"]  # as another reader has it
    first = word if word.isalpha() else "j1"
    assert [joint["name"] for joint in read["joints"]] == [first, "j2", "j3", "j4"]
    assert read["name"] == found.name == word.lower()
    assert [body["name"] for body in read["bodies"]["value"]] == [word if word.isalpha() else f"link-{word}"]
    assert read["title"] == f"{word}, imported from made.urdf"


def test_a_name_with_characters_that_cannot_be_printed_is_read_back(tmp_path: Path) -> None:
    name = 'a"\u2028\u0085\u007f\u202eb \U0001f600 \\ä'
    files = Files(tmp_path).write(SCARA.replace('"made"', f"'{name}'"))
    write(files.imported(), tmp_path / "robot.yaml")
    read = yaml.safe_load((tmp_path / "robot.yaml").read_text())["scara"]
    assert read["title"] == f"{name}, imported from made.urdf"
