"""Limits of joints: each number is taken by itself from the file that has it, and what is unclear is refused."""

from __future__ import annotations

from pathlib import Path

import pytest

from assur.scenes.urdf.importing import Wanted, import_robot
from assur.scenes.urdf.refusals import ImportRefused
from tests.scenes.urdf.made import FAMILIES, Files, J, urdf

SCARA = FAMILIES["scara, lift third"][2]


def limited(folder: Path, first: str, text: str = SCARA) -> Files:
    """An arm whose first joint has more in the file of limits."""
    files = Files(folder).write(text)
    files.limits.write_text(files.limits.read_text().replace("a_joint_1: {", f"a_joint_1: {{{first}, "))
    return files


def range_of(files: Files) -> str:
    """The range of the first joint as it is written, with its source."""
    lines = import_robot(Wanted(files.urdf, files.limits)).text.splitlines()
    return next(line.strip() for line in lines if "range_rad" in line)


def told(files: Files) -> list[str]:
    with pytest.raises(ImportRefused) as caught:
        import_robot(Wanted(files.urdf, files.limits))
    return [str(lack) for lack in caught.value.lacks]


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
    assert "velocity_rad_s: {value: 3.0, " in import_robot(Wanted(files.urdf, files.limits)).text


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
    found = import_robot(Wanted(files.urdf, files.limits))
    assert [remark for remark in found.report["remarks"] if "axes" in remark] == [
        "axes that are not 1 long: a_joint_1 (0.5), a_joint_3 (2); only their directions are taken, so positions are "
        "in rad and m along them, and nothing is scaled"
    ]
    assert "range_m: {value: [0.01, 0.2], " in found.text
    files.write(SCARA)
    assert not any("axes" in remark for remark in import_robot(Wanted(files.urdf, files.limits)).report["remarks"])


def test_numbers_are_parted_by_plain_spaces_only(tmp_path: Path) -> None:
    (found,) = told(swapped(tmp_path, "0.3 0.0 0.0", "0.3 0.0\u00a00.0"))
    assert found.startswith("joint a_joint_2, origin.xyz: ")
    assert "write 3 numbers with spaces between" in found
    assert range_of(swapped(tmp_path, "0.3 0.0 0.0", " 0.3\t0.0\n0.0 "))
