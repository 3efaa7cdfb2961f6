"""Limits of joints: each number is taken by itself from the file that has it, and what is unclear is refused."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.scenes.urdf.made import CELLARM_LIMITS, FAMILIES, Files, J, cellarm, told, urdf

SCARA = FAMILIES["scara, lift third"][2]


def limited(folder: Path, first: str, text: str = SCARA) -> Files:
    """An arm whose first joint has more in the file of limits."""
    files = Files(folder).write(text)
    files.limits.write_text(files.limits.read_text().replace("a_joint_1: {", f"a_joint_1: {{{first}, "))
    return files


def range_of(files: Files) -> str:
    """The range of the first joint as it is written, with its source."""
    lines = files.imported().text.splitlines()
    return next(line.strip() for line in lines if "range_rad" in line)


@pytest.mark.parametrize("switch", ["", "has_position_limits: true, "])
def test_each_end_of_a_range_is_taken_by_itself(switch: str, tmp_path: Path) -> None:
    upper = range_of(limited(tmp_path, f"{switch}max_position: 1.0"))
    assert upper == (
        "range_rad: {value: [-2.0, 1.0], status: third_party, "
        'source: "made.urdf, joint a_joint_1, limit.lower; joint_limits.yaml, joint_limits.a_joint_1.max_position"}'
    )
    lower = range_of(limited(tmp_path, f"{switch}min_position: -0.5"))
    assert lower == (
        "range_rad: {value: [-0.5, 2.5], status: third_party, "
        'source: "joint_limits.yaml, joint_limits.a_joint_1.min_position; made.urdf, joint a_joint_1, limit.upper"}'
    )
    both = range_of(limited(tmp_path, f"{switch}min_position: -0.5, max_position: 1"))
    assert "[-0.5, 1.0]" in both
    assert 'source: "joint_limits.yaml, joint_limits.a_joint_1.min_position, max_position"' in both


def test_one_end_does_not_give_a_joint_without_end_a_range(tmp_path: Path) -> None:
    endless = SCARA.replace('type="revolute"', 'type="continuous"', 1)
    (found,) = told(limited(tmp_path, "max_position: 1.0", endless))
    assert found.startswith("joint a_joint_1: it turns without end (type continuous)")


def test_an_end_below_the_other_files_end_is_refused(tmp_path: Path) -> None:
    (found,) = told(limited(tmp_path, "max_position: -2.5"))
    assert found.startswith("joint a_joint_1: its range is -2 to -2.5 rad; ")


def test_an_end_that_is_switched_off_and_given_is_refused(tmp_path: Path) -> None:
    (found,) = told(limited(tmp_path, "has_position_limits: false, max_position: 1.0"))
    assert found == (
        "joint a_joint_1: has_position_limits is false in joint_limits.yaml, and max_position is given; give it in "
        "--joint-limits as joint_limits.a_joint_1.max_position, and has_position_limits: true; or remove max_position, "
        "and the URDF's end is taken"
    )
    assert "[-2.0, 2.5]" in range_of(limited(tmp_path, "has_position_limits: false"))


@pytest.mark.parametrize("kind", ["position", "velocity", "jerk"])
@pytest.mark.parametrize("value", ['"false"', "no", "0"])
def test_a_switch_that_is_neither_true_nor_false_is_refused(kind: str, value: str, tmp_path: Path) -> None:
    key = "max_position" if kind == "position" else f"max_{kind}"
    (found,) = told(limited(tmp_path, f"has_{kind}_limits: {value}, {key}: 2"))
    word = value.strip('"')
    assert found == (
        f"joint a_joint_1: has_{kind}_limits is {word!r} in joint_limits.yaml, and neither true nor false; "
        f"write joint_limits.a_joint_1.has_{kind}_limits: true or false"
    )


def swapped(folder: Path, old: str, new: str) -> Files:
    assert old in SCARA
    return Files(folder).write(SCARA.replace(old, new, 1))


@pytest.mark.parametrize("text", ["6_0", "\u0666", "0x6", "6,5", "1e", "", "nan", "inf", "\u00b2", "6\u00a0"])
def test_what_is_a_number_to_python_only_is_refused(text: str, tmp_path: Path) -> None:
    files = swapped(tmp_path, 'velocity="3.0"', f'velocity="{text}"')
    (found,) = told(files)
    assert found.startswith(f"joint a_joint_1, limit.velocity: {text!r} is no finite number")


@pytest.mark.parametrize("text", ["3", " 3. ", "+3.0", "30e-1", ".3E+1"])
def test_every_form_of_a_number_is_read(text: str, tmp_path: Path) -> None:
    files = swapped(tmp_path, 'velocity="3.0"', f'velocity="{text}"')
    assert "velocity_rad_s: {value: 3.0, " in files.imported().text


def soft(folder: Path, attributes: str, more: str = "has_position_limits: true") -> Files:
    joints = [J("revolute", more=f"<safety_controller {attributes}/>"), J("revolute", (0.3, 0, 0))]
    return limited(folder, more, urdf(*joints, J("prismatic", (0.25, 0, 0), ends=(0.01, 0.2))))


def test_soft_limits_narrow_a_range_and_never_widen_it(tmp_path: Path) -> None:
    found = range_of(soft(tmp_path, 'soft_lower_limit="-1" soft_upper_limit="9" k_velocity="1"'))
    assert found.startswith("range_rad: {value: [-1.0, 2.5], ")
    assert found.endswith('"made.urdf, joint a_joint_1, safety_controller.soft_lower_limit, limit.upper"}')
    found = range_of(soft(tmp_path, 'soft_lower_limit="-9" soft_upper_limit="1.5"'))
    assert found.startswith("range_rad: {value: [-2.0, 1.5], ")
    assert "[-2.0, 2.5]" in range_of(soft(tmp_path, 'k_velocity="1"'))
    assert "[-1.0, 2.0]" in range_of(soft(tmp_path, 'soft_lower_limit="-1"', "max_position: 2"))
    (lack,) = told(soft(tmp_path, 'soft_lower_limit="0" soft_upper_limit="0"'))
    assert "its range is 0 to 0 rad" in lack
    (lack,) = told(soft(tmp_path, 'soft_lower_limit="low"'))
    assert lack.startswith("joint a_joint_1, soft_lower_limit: 'low' is no finite number")


def test_axes_that_are_no_unit_vectors_are_told(tmp_path: Path) -> None:
    lift = J("prismatic", (0.25, 0, 0), axis=(0, 0, -2), ends=(0.01, 0.2))
    text = urdf(J("revolute", axis=(0, 0, 0.5)), J("revolute", (0.3, 0, 0)), lift)
    files = Files(tmp_path).write(text)
    found = files.imported()
    assert [remark for remark in found.report["remarks"] if "axes" in remark] == [
        "axes that are not 1 long: a_joint_1 (0.5), a_joint_3 (2); only their directions are taken, so positions are "
        "in rad and m along them, and nothing is scaled"
    ]
    assert "range_m: {value: [0.01, 0.2], " in found.text
    files.write(SCARA)
    assert not any("axes" in remark for remark in files.remarks)


def test_numbers_are_parted_by_plain_spaces_only(tmp_path: Path) -> None:
    (found,) = told(swapped(tmp_path, "0.3 0.0 0.0", "0.3 0.0\u00a00.0"))
    assert found.startswith("joint a_joint_2, origin.xyz: ")
    assert "write 3 numbers with spaces between" in found
    assert range_of(swapped(tmp_path, "0.3 0.0 0.0", " 0.3\t0.0\n0.0 "))


LIFT = '<limit lower="0" upper="0.15" velocity="1" effort="1"/>'
OF_1_2 = LIFT.replace("/>", ' acceleration="14" deceleration="9" jerk="200"/>')


def lines_of(files: Files, joint: str, **more: object) -> dict[str, str]:
    """The value and the source of each limit of a joint of the robot that is imported."""
    text = files.imported(**more).text
    after = text[text.index(f'- name: "{joint}"') :].splitlines()[1:]
    rows = [line.strip() for line in after if "status" in line][:5]
    found = [re.fullmatch(r"(\w+): {value: (.*), status: (\w+), source: \"(.*)\"}", row) for row in rows]
    return {match[1]: f"{match[2]} {match[4]}" for match in found if match is not None}


def only(*keys: str, joint: str = "lift") -> str:
    """A file of limits in which a joint has these keys."""
    given = [line for line in CELLARM_LIMITS.splitlines() if f"  {joint}:" not in line]
    return "\n".join([*given, f"  {joint}: {{{', '.join(keys)}}}", ""])


def test_limits_of_version_1_2_are_taken_the_lower_of_acceleration_and_deceleration(tmp_path: Path) -> None:
    files = cellarm(tmp_path, (LIFT, OF_1_2), version="1.2", limits=only("max_velocity: 0.8"))
    found = lines_of(files, "lift")
    assert found["acceleration_m_s2"] == (
        "9.0 made.urdf, joint lift, limit.deceleration, which is lower than the acceleration"
    )
    assert found["jerk_m_s3"] == "200.0 made.urdf, joint lift, limit.jerk"
    assert found["velocity_m_s"] == "0.8 joint_limits.yaml, joint_limits.lift.max_velocity"
    higher = cellarm(tmp_path, (LIFT, OF_1_2.replace('"9"', '"15"')), version="1.2", limits=only("max_velocity: 1"))
    assert lines_of(higher, "lift")["acceleration_m_s2"] == "14.0 made.urdf, joint lift, limit.acceleration"


def test_without_a_file_of_limits_a_urdf_of_version_1_2_has_all_that_is_needed(tmp_path: Path) -> None:
    files = cellarm(tmp_path)
    text = files.urdf.read_text().replace('effort="1"', 'effort="1" acceleration="10"')
    files.urdf.write_text(text.replace("<robot ", '<robot version="1.2" '))
    found = files.imported(joint_limits=None).text
    assert found.count("limit.acceleration") == 4
    assert found.count("acceleration / 20 ms") == 4


@pytest.mark.parametrize("version", ["", "1.0", "1.1"])
def test_limits_that_a_version_has_not_are_taken_and_reported(version: str, tmp_path: Path) -> None:
    files = cellarm(tmp_path, (LIFT, OF_1_2), version=version)
    assert lines_of(files, "lift")["acceleration_m_s2"].startswith("9.0 made.urdf")
    has_none = f"version {version or '1.0'} has none; read as in version 1.2"
    late = "limit.acceleration, limit.deceleration, limit.jerk"
    assert f"line 18, joint lift: {late}: {has_none}" in files.remarks


@pytest.mark.parametrize("key", ["acceleration", "deceleration", "jerk"])
@pytest.mark.parametrize("value", ["0", "-3"])
def test_a_limit_of_a_urdf_that_is_not_above_0_is_refused(key: str, value: str, tmp_path: Path) -> None:
    limit = LIFT.replace("/>", f' {key}="{value}"/>')
    given = "max_velocity: 1" if key == "acceleration" else "max_acceleration: 12"
    (found,) = told(cellarm(tmp_path, (LIFT, limit), version="1.2", limits=only(given)))
    supply = f"give it in --joint-limits as joint_limits.lift.max_{key} (m/s"
    assert found.startswith(f"joint lift: limit.{key} is {value} in the URDF; {supply}")


def test_version_1_2_requires_both_ends_and_before_it_one_is_0(tmp_path: Path) -> None:
    one = (LIFT, LIFT.replace('lower="0" ', ""))
    (found,) = told(cellarm(tmp_path, one, version="1.2"))
    assert found == ("joint lift, limit.lower: nothing; write lower; version 1.2 requires both ends of the range")
    found = lines_of(cellarm(tmp_path, one, version="1.1"), "lift")["range_m"]
    assert found == "[0.0, 0.15] made.urdf, joint lift, limit (no lower: it is 0 by the format), limit.upper"


def test_ends_of_a_joint_without_end_are_reported(tmp_path: Path) -> None:
    endless = ('name="wrist" type="revolute"', 'name="wrist" type="continuous"')
    limits = only("max_acceleration: 300", "min_position: -3", "max_position: 3", joint="wrist")
    files = cellarm(tmp_path, endless, limits=limits)
    assert lines_of(files, "wrist")["range_rad"].startswith("[-3.0, 3.0] joint_limits.yaml")
    assert files.remarks[0] == (
        "line 20, joint wrist, limit.lower, limit.upper: it turns without end, so what the file states of its range is "
        "not taken"
    )


def test_soft_limits_without_a_limit_are_the_range_and_those_of_a_joint_without_end_are_reported(
    tmp_path: Path,
) -> None:
    soft = '<safety_controller soft_lower_limit="0.03" soft_upper_limit="0.12"/>'
    found = lines_of(cellarm(tmp_path, (LIFT, soft), limits=only("max_acceleration: 9", "max_velocity: 1")), "lift")
    assert found["range_m"] == (
        "[0.03, 0.12] made.urdf, joint lift, safety_controller.soft_lower_limit, safety_controller.soft_upper_limit"
    )
    keys = ("max_acceleration: 300", "min_position: -3", "max_position: 3", "max_velocity: 20")
    endless = ('name="wrist" type="revolute"', 'name="wrist" type="continuous"')
    wrist = '<limit lower="-6.28" upper="6.28" velocity="20" effort="1"/>'
    files = cellarm(tmp_path, endless, (wrist, soft), limits=only(*keys, joint="wrist"))
    assert files.remarks[0].startswith("line 20, joint wrist, safety_controller.soft_lower_limit, safety_controller.")


def controlled(interface: str, more: str = "") -> str:
    head = '<ros2_control name="c" type="system"><joint name="lift">'
    return f"{head}{interface}{more}</joint></ros2_control></robot>"


def command(kind: str, low: str, high: str, more: str = "") -> str:
    params = f'<param name="min">{low}</param>\n<param name="max">{high}</param>'
    return f'<command_interface name="{kind}">{params}{more}</command_interface>'


def test_limits_of_a_controller_narrow_those_of_the_joint(tmp_path: Path) -> None:
    both = command("position", "0.01", "0.3") + command("velocity", "-0.5", "0.7")
    found = lines_of(cellarm(tmp_path, ("</robot>", controlled(both))), "lift")
    assert found["range_m"] == "[0.01, 0.15] made.urdf, joint lift, ros2_control position.min, limit.upper"
    assert found["velocity_m_s"] == "0.5 made.urdf, joint lift, ros2_control velocity.min"
    rates = command("acceleration", "-8", "8") + command("jerk", "-90", "90")
    found = lines_of(cellarm(tmp_path, ("</robot>", controlled(rates)), limits=only("max_velocity: 1")), "lift")
    assert found["acceleration_m_s2"] == "8.0 made.urdf, joint lift, ros2_control acceleration.min"
    assert found["jerk_m_s3"] == "90.0 made.urdf, joint lift, ros2_control jerk.min"


def test_limits_of_a_controller_that_do_not_count_are_reported(tmp_path: Path) -> None:
    off = command("position", "0.01", "0.3", '<limits enable="false"/>') + command("velocity", "0", "0.7")
    files = cellarm(tmp_path, ("</robot>", controlled(off)))
    assert lines_of(files, "lift")["range_m"].startswith("[0.0, 0.15]")
    assert lines_of(files, "lift")["velocity_m_s"].startswith("0.7 ")
    assert files.remarks[:3] == [
        "line 24, ros2_control, joint lift, position.min: 0.01 is not taken, for <limits enable=...> switches it off",
        "line 25, ros2_control, joint lift, position.max: 0.3 is not taken, for <limits enable=...> switches it off",
        "line 25, ros2_control, joint lift, velocity.min: 0 is not taken, for it limits one direction only",
    ]


@pytest.mark.parametrize("value", ["-5", "5"])
def test_a_deceleration_of_the_file_is_taken_whatever_its_sign(value: str, tmp_path: Path) -> None:
    keys = ("max_acceleration: 12", "has_deceleration_limits: true", f"max_deceleration: {value}")
    found = lines_of(cellarm(tmp_path, limits=only(*keys)), "lift")
    assert found["acceleration_m_s2"] == (
        "5.0 joint_limits.yaml, joint_limits.lift.max_deceleration, which is lower than the acceleration"
    )
    assert found["jerk_m_s3"].startswith("250.0 acceleration / 20 ms")
    of_both = cellarm(tmp_path, (LIFT, OF_1_2), version="1.2", limits=only("max_acceleration: 12"))
    assert lines_of(of_both, "lift")["acceleration_m_s2"].startswith("9.0 made.urdf")


def test_soft_limits_of_the_file_narrow_the_range(tmp_path: Path) -> None:
    keys = ("max_acceleration: 12", "soft_lower_limit: 0.02", "soft_upper_limit: 1", "k_position: 10")
    files = cellarm(tmp_path, limits=only("has_soft_limits: true", *keys))
    assert lines_of(files, "lift")["range_m"] == (
        "[0.02, 0.15] joint_limits.yaml, joint_limits.lift.soft_lower_limit; made.urdf, joint lift, limit.upper"
    )
    assert "joint_limits.yaml, line 5, joint lift: k_position is not taken" in files.remarks
    off = cellarm(tmp_path, limits=only("has_soft_limits: false", *keys))
    assert lines_of(off, "lift")["range_m"].startswith("[0.0, 0.15]")
    assert (
        "joint_limits.yaml, line 5, joint lift: soft_lower_limit is switched off by has_soft_limits, and not taken"
    ) in off.remarks


@pytest.mark.parametrize("kind", ["velocity", "acceleration", "deceleration", "jerk"])
def test_what_is_switched_off_is_reported_and_what_is_on_must_be_there(kind: str, tmp_path: Path) -> None:
    files = cellarm(tmp_path, (LIFT, OF_1_2), limits=only(f"has_{kind}_limits: false", f"max_{kind}: 0.5"))
    assert (
        f"joint_limits.yaml, line 5, joint lift: max_{kind} is switched off by has_{kind}_limits, and not taken"
    ) in files.remarks
    (found, *_) = told(cellarm(tmp_path, (LIFT, OF_1_2), limits=only(f"has_{kind}_limits: true")))
    assert f"joint lift: has_{kind}_limits is true in joint_limits.yaml, and max_{kind} is not given" in found
    (found, *_) = told(cellarm(tmp_path, (LIFT, OF_1_2), limits=only(f"max_{kind}: null")))
    assert f"joint lift: max_{kind} is 'None' in joint_limits.yaml, and no number" in found


@pytest.mark.parametrize("key", ["max_acc: 3", "max_accelaration: 3", "min_velocity: -1", "acceleration: 3"])
def test_a_key_that_is_not_known_is_refused(key: str, tmp_path: Path) -> None:
    (found,) = told(cellarm(tmp_path, limits=only("max_acceleration: 12", key)))
    name = key.partition(":")[0]
    assert found.startswith(f"joint lift: {name!r} in joint_limits.yaml, line 5, is not known, and may be a limit; ")
    assert "max_deceleration" in found


def test_keys_that_are_no_limits_of_motion_are_reported(tmp_path: Path) -> None:
    keys = ("has_effort_limits: true", "max_effort: 20", "angle_wraparound: false")
    assert (
        "joint_limits.yaml, line 5, joint lift: has_effort_limits, max_effort, angle_wraparound are not taken"
    ) in cellarm(tmp_path, limits=only("max_acceleration: 12", *keys)).remarks


def test_what_is_beside_the_limits_is_refused_or_reported(tmp_path: Path) -> None:
    nested = "".join(f"    {line}\n" for line in CELLARM_LIMITS.splitlines())
    head = "/**:\n  use_sim_time: false\n  ros__parameters:\n    default_velocity_scaling_factor: 0.1\n"
    remarks = cellarm(tmp_path, limits=head + nested).remarks
    assert remarks[:2] == [
        "joint_limits.yaml, line 2: 'use_sim_time' is not read",
        "joint_limits.yaml, line 4: default_velocity_scaling_factor is not taken: it is no limit of the arm's joints",
    ]
    (found,) = told(cellarm(tmp_path, limits=CELLARM_LIMITS + "joint_limit:\n  lift: {max_velocity: 0.1}\n"))
    assert found == (
        "line 6: 'joint_limit' is not known, and may be limits of joints; put it below joint_limits, or remove it"
    )
    (found,) = told(cellarm(tmp_path, limits=CELLARM_LIMITS + "max_acceleration: 3\n"))
    assert found.startswith("line 6: 'max_acceleration' is not known")
    (found,) = told(cellarm(tmp_path, limits=CELLARM_LIMITS + "left:\n" + nested.replace("    ", "  ", 1)))
    assert found.startswith("the file: 2 mappings joint_limits (line 1, line 7); leave the one of this arm")


def test_joints_that_are_not_the_arm_s_are_reported(tmp_path: Path) -> None:
    hand = (
        '<link name="hand"/><joint name="grip" type="fixed"><parent link="flange"/><child link="hand"/></joint></robot>'
    )
    files = cellarm(tmp_path, ("</robot>", hand), limits=CELLARM_LIMITS + "  grip: {}\n  elbo: {max_velocity: 1}\n")
    assert files.remarks[:2] == [
        "joint_limits.yaml: joints elbo are not in the URDF; they are not used",
        "joint_limits.yaml: joints grip are not the arm's; they are not used",
    ]


def test_a_limit_of_the_file_that_is_wider_than_the_urdf_s_is_reported(tmp_path: Path) -> None:
    keys = ("max_acceleration: 20", "max_velocity: 2", "max_position: 0.2", "min_position: 0.01")
    files = cellarm(tmp_path, (LIFT, OF_1_2), version="1.2", limits=only(*keys))
    head = "joint_limits.yaml, line 5, joint lift:"
    assert [each for each in files.remarks if each.startswith(head)] == [
        f"{head} max_position 0.2 takes the place of the URDF's limit.upper 0.15, which is narrower",
        f"{head} max_velocity 2 takes the place of the URDF's limit.velocity 1, which is narrower",
        f"{head} max_acceleration 20 takes the place of the URDF's limit.acceleration 14, which is narrower",
    ]
