"""Links above `--base` and on other branches: what stands still with the base is of it, and what does not is told."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Pose
from assur.scenes.urdf.chain import chain_to
from assur.scenes.urdf.importing import ImportedRobot, write
from assur.scenes.urdf.reader import read_tree
from assur.scenes.urdf.refusals import ImportRefused
from tests.scenes.urdf.made import FAMILIES, Files, box, flange_by_library

SCARA = FAMILIES["scara, lift third"][2]
TURNED = 'xyz="0.1 -0.2 0.3" rpy="0.2 -0.3 0.7"'
LIMIT = '<axis xyz="1 0 0"/><limit lower="0" upper="1" velocity="1" effort="1"/>'


def link(name: str) -> str:
    shape = box(0.1, 0.2, 0.3, (0.01, 0.02, 0.03), (0.1, 0.2, 0.3))
    return f'<link name="{name}"><collision>{shape}</collision></link>'


def joint(kind: str, parent: str, child: str) -> str:
    ends = f'<parent link="{parent}"/><child link="{child}"/>'
    limit = "" if kind == "fixed" else LIMIT
    return f'<joint name="to_{child}" type="{kind}">{ends}<origin {TURNED}/>{limit}</joint>'


def around(mount: str = "fixed") -> str:
    """The arm on a pedestal on the floor, with a tower beside it, and a gate that moves on the tower."""
    links = "".join(link(name) for name in ("floor", "pedestal", "tower", "gate", "bar"))
    joints = [joint("fixed", "floor", "pedestal"), joint(mount, "pedestal", "l0"), joint("fixed", "floor", "tower")]
    joints += [joint("prismatic", "tower", "gate"), joint("fixed", "gate", "bar")]
    return SCARA.replace("</robot>", links + "".join(joints) + "</robot>")


def imported(files: Files, **more: object) -> ImportedRobot:
    return files.imported(base="l0", **more)


def bodies(found: ImportedRobot, files: Files) -> dict[str, str]:
    """The bodies of the robot that is written, and the links on which they are."""
    arm = write(found, files.folder / "robot.yaml").built()
    robot = arm.robot(Pose(), arm.limits)
    return {rider.body.name: robot.links[rider.link] for rider in robot.bodies}


def test_what_fixed_joints_hold_to_the_base_is_of_it_and_the_rest_is_told(tmp_path: Path) -> None:
    files = Files(tmp_path).write(around())
    found = imported(files)
    assert bodies(found, files) == dict.fromkeys(("floor", "pedestal", "tower"), "base")
    remarks = found.report["remarks"]
    assert "link l0 has the collision shapes of floor, pedestal, tower, which fixed joints hold to it" in remarks
    assert (
        "LEFT OUT with their collision shapes: gate, bar; no fixed joint holds them to link l0, and nothing is kept "
        "clear of them: give them as bodies of the request"
    ) in remarks


def test_what_a_held_joint_holds_to_the_base_is_of_it(tmp_path: Path) -> None:
    files = Files(tmp_path).write(around())
    found = imported(files, held={"to_gate": 0.4})
    assert bodies(found, files) == dict.fromkeys(("floor", "pedestal", "tower", "gate", "bar"), "base")
    assert not any("LEFT OUT" in remark for remark in found.report["remarks"])


def test_of_an_arm_that_floats_nothing_above_it_is_taken_and_every_link_is_told(tmp_path: Path) -> None:
    files = Files(tmp_path).write(around("floating"))
    found = imported(files)
    assert bodies(found, files) == {}
    (told,) = [remark for remark in found.report["remarks"] if "LEFT OUT" in remark]
    assert "floor, pedestal, tower, gate, bar;" in told


def test_links_beside_the_base_are_where_another_library_puts_them(tmp_path: Path) -> None:
    files = Files(tmp_path).write(around())
    chain, lacks = chain_to(read_tree(files.urdf.read_bytes(), "made.urdf"), "l0", "l4")
    assert chain is not None
    assert lacks == []
    assert set(chain.beside) == {"floor", "pedestal", "tower"}
    places = chain.places(np.zeros((3, 4)))
    for name, pose in chain.beside.items():
        theirs: FloatArray = flange_by_library(files.urdf, "l0", name, [], np.zeros((1, 0)))[0]
        assert np.abs(pose - theirs).max() <= 1e-12
        assert np.abs(places[name] - theirs).max() <= 1e-12


def test_a_shape_beside_the_base_that_cannot_be_covered_is_refused(tmp_path: Path) -> None:
    lost = (
        '<link name="floor"><collision><geometry><mesh filename="package://lost/a.stl"/></geometry></collision></link>'
    )
    files = Files(tmp_path).write(around().replace(link("floor"), lost))
    with pytest.raises(ImportRefused) as caught:
        imported(files)
    assert "say --package lost=FOLDER" in str(caught.value)
