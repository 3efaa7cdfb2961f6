"""What a URDF, an SRDF or a file of limits holds and nobody reads is refused, or reported with its line."""

from __future__ import annotations

from pathlib import Path

import pytest

from assur.scenes.urdf.importing import ImportedRobot
from tests.scenes.urdf.made import FORE_AT, LIFT_AT, cellarm, told

LINK = '<link name="carriage"/>'
LIFT = '<limit lower="0" upper="0.15" velocity="1" effort="1"/>'
END = "</robot>"
FORE = f'<collision><origin {FORE_AT}/><geometry><box size="0.3 0.1 0.06"/></geometry></collision>'


def body(found: ImportedRobot) -> str:
    """The robot's file without its head, which has the digest of the URDF."""
    return found.text[found.text.index("  l1_m") :]


PLACE = '<link name="carriage">{}</link>'
XACRO = '<x:if xmlns:x="http://www.ros.org/wiki/xacro" value="1"/>'
DRAKE = 'xmlns:drake="http://drake.mit.edu" drake:acceleration="1" effort'
TWO = f"<origin {FORE_AT}/>"
LOW = '<joint name="lift"><command_interface name="position"><param name="max">low</param></command_interface></joint>'
SIMULATED = "<collision><geometry><box/></geometry></collision>"
REFUSED: dict[str, tuple[str, str, str]] = {
    "an attribute that is misspelt": (
        FORE_AT,
        f'{FORE_AT} rpyy="0 0 1"',
        "line 5, link fore, collision, origin: attribute rpyy='0 0 1' is not known, and may change joints",
    ),
    "an attribute with a capital": (FORE_AT, f'{FORE_AT} RPY="0 0 1"', "attribute RPY='0 0 1' is not known"),
    "an attribute of another reader": (
        LIFT,
        LIFT.replace("effort", DRAKE),
        "line 18, joint lift, limit: attribute drake.mit.edu:acceleration='1' is not known",
    ),
    "a unit": ('name="cellarm"', 'name="cellarm" units="mm"', "line 2, robot: attribute units='mm' is not known"),
    "an element with a capital": (LINK, f'{LINK}<Link name="arm"/>', "element <Link>, which holds link is not known"),
    "an element of a loop": (
        END,
        f'<loop_joint name="a"><link1 link="base"/></loop_joint>{END}',
        "element <loop_joint>, which holds joint is not known",
    ),
    "an element that has a pose": (
        END,
        f'<tool><at xyz="0 0 1"/></tool>{END}',
        "line 24, tool: element <tool>, which holds the attribute xyz is not known",
    ),
    "an element of a joint": (LIFT, f'{LIFT}<screw pitch="2"/>', "joint lift, screw: element <screw> is not known"),
    "an element of a link": (LINK, PLACE.format('<offset z="1"/>'), "element <offset> is not known"),
    "an origin of a link": (LINK, PLACE.format('<origin xyz="0 0 1"/>'), "element <origin> is not known"),
    "an element of a shape": (FORE_AT + "/>", FORE_AT + '/><scale by="2"/>', "element <scale> is not known"),
    "text in place of an attribute": (
        f"<origin {LIFT_AT}/>",
        "<origin>0.2 0 0</origin>",
        "text '0.2 0 0' is not known",
    ),
    "two origins of a joint": (f"<origin {LIFT_AT}/>", f"<origin {LIFT_AT}/><origin/>", "lift, origin: more than one"),
    "two origins of a shape": (TWO, f"<origin/>{TWO}", "fore, collision, origin: more than one of them; leave the one"),
    "two geometries": (FORE_AT + "/>", FORE_AT + "/><geometry/>", "link fore, collision, geometry: more than one"),
    "two limits": (LIFT, LIFT + LIFT, "joint lift, limit: more than one of them"),
    "a macro": (
        LINK,
        XACRO + LINK,
        "line 6, xacro:if: <xacro:if> is a macro that is not expanded; give the file to import as .xacro",
    ),
    "a macro without a namespace": (LINK, f'<include filename="arm.xacro"/>{LINK}', "<include> is a macro that is not"),
    "an expression in a number": (
        LIFT,
        LIFT.replace('"0.15"', '"${15 / 100}"'),
        "line 18, joint lift, limit: upper='${15 / 100}' is an expression that is not expanded",
    ),
    "an expression in a path": (
        '<box size="0.3 0.1 0.06"/>',
        '<mesh filename="file://$(find arm)/fore.stl"/>',
        "link fore, collision, geometry, mesh: filename='file://$(find arm)/fore.stl' is an expression",
    ),
    "a joint of a simulator": (
        END,
        f'<gazebo>\n<joint name="x" type="revolute"><parent>a</parent></joint></gazebo>{END}',
        "line 25, gazebo: <joint> adds to the robot what is no link or joint of the URDF",
    ),
    "a shape of a simulator": (
        END,
        f'<gazebo reference="fore">{SIMULATED}</gazebo>{END}',
        "<geometry> adds to the robot",
    ),
    "a limit of a controller that is no number": (
        END,
        f"<ros2_control>{LOW}</ros2_control>{END}",
        "line 24, ros2_control, joint lift, position.max: 'low' is no finite number",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_may_change_the_robot_is_refused(name: str, tmp_path: Path) -> None:
    old, new, words = REFUSED[name]
    (found,) = told(cellarm(tmp_path, (old, new), version="1.2"))
    assert words in found


def test_an_expression_in_every_name_is_refused_and_nothing_else_is_told(tmp_path: Path) -> None:
    files = cellarm(tmp_path)
    files.urdf.write_text(files.urdf.read_text().replace('"carriage"', '"${prefix}carriage"'))
    found = told(files)
    assert len(found) == 3
    assert all("is an expression that is not expanded" in each for each in found)


@pytest.mark.parametrize("version", ["2.0", "1.3", "1", "", "1.0.0", "1.0~pre6"])
def test_a_version_that_is_not_known_is_refused(version: str, tmp_path: Path) -> None:
    (found,) = told(cellarm(tmp_path, ('name="cellarm"', f'name="cellarm" version="{version}"')))
    assert found.startswith(
        f"line 2, robot, version: version {version!r}, which may mean other than what is read here; "
    )
    assert "versions 1.0, 1.1, 1.2 are known" in found


@pytest.mark.parametrize("version", ["", "1.0", "1.1", "1.2"])
def test_what_no_plan_depends_on_is_listed_and_changes_nothing(version: str, tmp_path: Path) -> None:
    plain = cellarm(tmp_path).imported()
    more = """
    <material name="grey"><color rgba="0.5 0.5 0.5 1"/></material>
    <transmission name="t"><joint name="lift"><hardwareInterface>position</hardwareInterface></joint></transmission>
    <gazebo reference="fore"><mu1>0.2</mu1><selfCollide>true</selfCollide></gazebo>
    <gazebo><plugin name="p" filename="p.so"><joint>lift</joint><link>fore</link></plugin></gazebo>
    <gazebo><joint name="world" type="fixed"><parent>world</parent><child>base</child></joint></gazebo>
    <sensor name="s"><parent link="fore"/><origin xyz="0 0 1"/></sensor>
    <ros2_control name="c"><joint name="lift"><state_interface name="position"/></joint></ros2_control>
    </robot>"""
    inertial = '<inertial><origin xyz="1 2 3"/><mass value="1"/></inertial>'
    visual = '<visual name="v"><geometry><mesh filename="lost.dae"/></geometry><material name="grey"/></visual>'
    joint = '<calibration rising="0"/><dynamics damping="1"/><safety_controller k_velocity="1" k_position="3"/>'
    files = cellarm(
        tmp_path,
        (LINK, '<link name="carriage" type="x"/>'),
        (FORE, FORE.replace("<collision>", f'{inertial}{visual}<!-- a comment --><collision name="c" group="g">')),
        (LIFT, LIFT + joint),
        (END, more),
        version=version,
    )
    found = files.imported()
    assert body(found) == body(plain)
    assert found.report["remarks"] == plain.report["remarks"]
    assert found.report["unused"] == [
        "material (1, first in line 25)",
        "transmission (1, first in line 26)",
        "gazebo (3, first in line 27)",
        "sensor (1, first in line 30)",
        "ros2_control but for the limits of its command interfaces (1, first in line 31)",
        "inertial (1, first in line 5)",
        "visual (1, first in line 5)",
        "link.type (1, first in line 6)",
        "calibration (1, first in line 18)",
        "dynamics (1, first in line 18)",
        "collision.group (1, first in line 5)",
        "limit.effort (4, first in line 10)",
        "safety_controller.k_velocity (1, first in line 18)",
        "safety_controller.k_position (1, first in line 18)",
    ]


def test_what_is_of_another_format_is_reported_with_its_line(tmp_path: Path) -> None:
    schema = 'xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xsi:schemaLocation="urdf.xsd" name="cellarm"'
    files = cellarm(
        tmp_path,
        ('name="cellarm"', schema),
        (END, '<group name="arm">\n<member of="it"/></group></robot>'),
        (LIFT, f"{LIFT} # 150 mm, measured"),
    )
    remarks = files.remarks
    assert remarks[:3] == [
        "line 2, robot: attribute XMLSchema-instance:schemaLocation is of another format; it is not read",
        "line 24: element <group> is not of a URDF; it is not read",
        "line 16, joint lift: text '# 150 mm, measured' is not read",
    ]


def test_what_the_format_says_where_the_file_is_silent_is_reported(tmp_path: Path) -> None:
    files = cellarm(tmp_path, ('<origin xyz="0 0 0.2"/><axis xyz="0 0 1"/>', '<origin xyz="0 0 0.2"/>'))
    found = told(files)
    assert found[0].startswith("joint shoulder: its axis is 90 deg off the vertical")
    mount = '<link name="stop"/><joint name="stopper" type="revolute"><parent link="base"/><child link="stop"/>'
    files = cellarm(tmp_path, (END, f'{mount}<limit upper="1" velocity="1" effort="1"/></joint></robot>'))
    remarks = files.imported(held={"stopper": 0.0}).report["remarks"]
    assert "line 24, joint stopper: no <axis>: it is 1 0 0 by the format" in remarks


def test_a_capsule_of_version_1_0_is_taken_and_reported(tmp_path: Path) -> None:
    shape = ('<box size="0.3 0.1 0.06"/>', '<capsule radius="0.04" length="0.2"/>')
    found = cellarm(tmp_path, shape).imported()
    assert "{capsule: {radius_m: 0.04, length_m: 0.2}}" in found.text
    assert found.report["remarks"][0] == (
        "line 5, link fore, collision: a capsule: version 1.0 has none; read as in version 1.1"
    )
    later = cellarm(tmp_path, shape, version="1.1").imported()
    assert body(later) == body(found)
    assert not any("capsule" in remark for remark in later.report["remarks"])
    (lack,) = told(cellarm(tmp_path, (shape[0], '<capsule radius="0.04" length="0.2" height="1"/>'), version="1.1"))
    assert "attribute height='1' is not known" in lack


SRDF = '<robot name="cellarm">\n<disable_collisions link1="base" link2="upper" reason="Adjacent"/>{}</robot>'


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ('<enable_collisions link1="base" link2="uper"/>', "line 2, enable_collisions: link 'uper' is not in the URDF"),
        ('<disable_default_collisions link="uper"/>', "link 'uper' is not in the URDF"),
        ('\n<enable_collision link1="base" link2="upper"/>', "line 3: element <enable_collision> is not of an SRDF"),
    ],
)
def test_what_is_not_known_of_an_srdf_is_refused(more: str, words: str, tmp_path: Path) -> None:
    srdf = tmp_path / "a.srdf"
    srdf.write_text(SRDF.format(more))
    (found,) = told(cellarm(tmp_path), srdf=srdf)
    assert words in found
    srdf.write_text(SRDF.format('<group name="arm"/><passive_joint name="lift"/>'))
    assert cellarm(tmp_path).imported(srdf=srdf).report["family"] == "scara"
