"""Arms of every family come out of a URDF with the flange where an independent library puts it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Pose
from assur.scenes.catalogue import load_robot
from assur.scenes.conventions import converted
from assur.scenes.reading.arms import OVER, BuiltArm
from assur.scenes.urdf.importing import ImportedRobot, write
from assur.scenes.urdf.refusals import ImportRefused
from assur.scenes.urdf.tree import turned
from tests.scenes.urdf.made import FAMILIES, RIGHT, Files, J, flange_by_library, urdf
from tests.scenes.urdf.random_arms import ARMS

STATES = 1000


def imported(files: Files, **more: object) -> tuple[ImportedRobot, BuiltArm]:
    """The robot that is imported, written and read again."""
    found = files.imported(**more)
    return found, write(found, files.folder / "robot.yaml").built()


def at_random(found: ImportedRobot, arm: BuiltArm) -> FloatArray:
    """Positions (STATES, n) in the file's count, within the ranges of the robot that was written."""
    rng = np.random.default_rng(7)
    ends = [np.array([arm.limits.lower, arm.limits.upper])]
    own = [joint.place if joint.place is not None else i for i, joint in enumerate(arm.conventions)]
    low, high = np.sort(
        [[joint.sign * (ends[0][k, own[i]] - joint.zero) for i, joint in enumerate(arm.conventions)] for k in (0, 1)],
        axis=0,
    )
    return rng.uniform(low, high, (STATES, len(low)))


def off(
    found: ImportedRobot, arm: BuiltArm, file: Path, reader: Callable[..., FloatArray] = flange_by_library
) -> tuple[float, float]:
    """How far the flange is from another reader's at random states: m, rad."""
    q = at_random(found, arm)
    names = [joint["urdf"] for joint in found.report["joints"]]
    theirs = reader(file, found.report["base"], found.report["flange"], names, q)
    robot = arm.robot(Pose(), arm.limits)
    positions, rotations = robot.placements(converted(q, arm.conventions))
    roll, pitch, yaw = np.radians(found.report["flange_turn_deg"] or [0.0, 0.0, 0.0])
    turn = turned("z", yaw) @ turned("y", pitch) @ turned("x", roll)
    ours = rotations[:, -1] @ (turn @ OVER if arm.z_down else turn)
    angle = 2 * np.arcsin(np.linalg.norm(theirs[:, :3, :3] - ours, axis=(1, 2)) / np.sqrt(8))
    return float(np.linalg.norm(theirs[:, :3, 3] - positions[:, -1], axis=1).max()), float(angle.max())


@pytest.mark.parametrize("name", FAMILIES)
def test_the_flange_is_where_another_library_puts_it(name: str, tmp_path: Path) -> None:
    family, order, text = FAMILIES[name]
    files = Files(tmp_path).write(text)
    found, arm = imported(files)
    assert found.report["family"] == family
    assert found.report["axis_order"] == (order or None)
    metres, radians = off(found, arm, files.urdf)
    assert metres <= 1e-6
    # roll, pitch and yaw of a turned flange are reported with six digits after the point
    assert radians <= 1e-6 if found.report["flange_turn_deg"] is None else radians <= 1e-6 + 3e-8
    assert found.report["apart_m"] <= 1e-9


@pytest.mark.parametrize("name", ARMS)
def test_axes_at_random_in_frames_at_random_are_found(name: str, tmp_path: Path) -> None:
    files = Files(tmp_path).write(ARMS[name])
    found, arm = imported(files)
    family, _, order = name.split(",", maxsplit=1)[0].partition(" ")
    if family == "scara":
        assert found.report["axis_order"].startswith(order)
    assert found.report["family"][:4] == name[:4]
    metres, radians = off(found, arm, files.urdf)
    assert metres <= 1e-6
    assert radians <= 1e-6 + 3e-8


def test_every_number_has_its_status_and_source(tmp_path: Path) -> None:
    found, _ = imported(Files(tmp_path).write(FAMILIES["scara, lift third"][2]), status="vendor")
    listed = load_robot(tmp_path / "robot.yaml").listed()
    assert listed["l1"]["status"] == "vendor"
    assert listed["l1"]["source"] == "made.urdf, joint origins from link l0 to link l4"
    first = listed["joints"][0]
    assert first["velocity"]["source"] == "made.urdf, joint a_joint_1, limit.velocity"
    assert first["acceleration"]["source"] == "joint_limits.yaml, joint_limits.a_joint_1.max_acceleration"
    assert (first["jerk"]["status"], first["jerk"]["value"]) == ("estimated", 1000.0)
    assert [joint["urdf"] for joint in found.report["joints"]] == [f"a_joint_{i}" for i in range(1, 5)]
    assert not any("without a status" in each for each in listed["assumptions"])


def test_angles_with_few_digits_are_the_right_angles_that_they_mean_and_that_is_said(tmp_path: Path) -> None:
    text = FAMILIES["elbow arm, level axes by turned frames"][2].replace(repr(RIGHT), "1.5708")
    files = Files(tmp_path).write(text)
    found, arm = imported(files)
    (remark,) = (each for each in found.report["remarks"] if each.startswith("angles written"))
    metres, radians = off(found, arm, files.urdf)
    assert 1e-7 < metres < 1e-5
    assert radians < 1e-5
    assert "(1.5708) are read as the right angles that they mean" in remark
    said = float(remark.split("is up to ")[1].split(" um")[0])
    assert said == pytest.approx(1e6 * metres, rel=0.05)


def test_an_angle_that_is_no_right_angle_is_not_taken_for_one(tmp_path: Path) -> None:
    text = FAMILIES["elbow arm, level axes by turned frames"][2].replace(repr(RIGHT), "1.57")
    with pytest.raises(ImportRefused, match=r"0\.0456\d* deg from level turn"):
        imported(Files(tmp_path).write(text))


def test_a_joint_that_is_held_is_as_good_as_fixed(tmp_path: Path) -> None:
    _, _, text = FAMILIES["scara, lift third"]
    finger = '<link name="finger"/><joint name="grip" type="prismatic"><parent link="l4"/><child link="finger"/>'
    finger += '<axis xyz="1 0 0"/><limit lower="0" upper="0.02" velocity="1" effort="1"/></joint></robot>'
    files = Files(tmp_path).write(text.replace("</robot>", finger))
    with pytest.raises(ImportRefused, match="--hold grip=POSITION"):
        imported(files, tip="l4")
    found, _ = imported(files, tip="l4", held={"grip": 0.01})
    assert found.report["flange"] == "l4"


def test_the_flange_that_is_off_the_axis_of_the_wrist_is_not_taken_where_another_is_on_it(tmp_path: Path) -> None:
    _, _, text = FAMILIES["scara, lift third"]
    camera = '<link name="camera"/><joint name="mount" type="fixed"><parent link="l4"/><child link="camera"/>'
    camera += '<origin xyz="0.05 0 0"/></joint></robot>'
    files = Files(tmp_path).write(text.replace("</robot>", camera))
    found, _ = imported(files)
    assert found.report["flange"] == "l4"
    with pytest.raises(ImportRefused, match="50 mm off the axis of joint a_joint_4"):
        imported(files, tip="camera")


def test_a_chain_that_only_looks_like_a_scara_is_found_by_comparing_flanges(tmp_path: Path) -> None:
    # a tilt of 0.05 µrad passes as vertical, and 50 m further on it is more than a micrometre
    tilted = urdf(
        J("revolute", axis=(5e-8, 0, 1)),
        J("revolute", (25, 0, 0), axis=(5e-8, 0, 1)),
        J("prismatic", (25, 0, 0), ends=(0.0, 0.2)),
        J("revolute"),
    )
    with pytest.raises(ImportRefused, match="um and"):
        imported(Files(tmp_path).write(tilted))
