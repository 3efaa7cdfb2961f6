"""Turns as quaternions, of version 1.1: links and solids are where a second reader of the specification puts them."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest

from assur.scenes.urdf.chain import chain_to
from assur.scenes.urdf.reader import read_tree
from tests.scenes.urdf.made import (
    FAMILIES,
    FORE_AT,
    LIFT_AT,
    RIGHT,
    Files,
    cellarm,
    flange_by_library,
    told,
    with_quaternions,
)
from tests.scenes.urdf.random_arms import ARMS
from tests.scenes.urdf.second_reader import link_in, shapes
from tests.scenes.urdf.test_recognised_families import imported, off
from tests.scenes.urdf.test_solids_of_links import BOX, ORIGIN, SHAPE, arms, furthest

SOME = [*FAMILIES, *list(ARMS)[::3]]


def text_of(name: str) -> str:
    return FAMILIES[name][2] if name in FAMILIES else ARMS[name]


@pytest.mark.parametrize("name", SOME)
def test_links_are_where_the_second_reader_puts_them_in_either_form(name: str, tmp_path: Path) -> None:
    for text in (text_of(name), with_quaternions(text_of(name))):
        files = Files(tmp_path).write(text)
        tree = read_tree(files.urdf.read_bytes(), "made.urdf")
        chain, lacks = chain_to(tree, "l0", list(tree.links)[-1])
        assert chain is not None
        assert lacks == []
        q = np.random.default_rng(1).uniform(-3.0, 3.0, (20, len(chain.joints)))
        places, names = chain.places(q), [joint.name for joint in chain.joints]
        for link in tree.links:
            assert np.abs(places[link] - link_in(files.urdf, "l0", link, names, q)).max() <= 1e-9


@pytest.mark.parametrize("name", list(FAMILIES))
def test_the_two_readers_of_the_tests_agree_where_there_is_no_quaternion(name: str, tmp_path: Path) -> None:
    files = Files(tmp_path).write(text_of(name))
    tree = read_tree(files.urdf.read_bytes(), "made.urdf")
    names = [joint.name for joint in tree.joints.values() if joint.moves]
    q = np.random.default_rng(2).uniform(-3.0, 3.0, (5, len(names)))
    tip = list(tree.links)[-1]
    theirs = flange_by_library(files.urdf, "l0", tip, names, q)
    assert np.abs(link_in(files.urdf, "l0", tip, names, q) - theirs).max() <= 1e-9


@pytest.mark.parametrize("name", ["scara, tool frame down", "elbow arm, level axes by turned frames", *list(ARMS)[::7]])
def test_the_flange_of_the_robot_is_where_the_second_reader_puts_it(name: str, tmp_path: Path) -> None:
    files = Files(tmp_path).write(with_quaternions(text_of(name)))
    found, arm = imported(files)
    metres, radians = off(found, arm, files.urdf, link_in)
    assert metres <= 1e-6
    assert radians <= 1e-6 + 3e-8


@pytest.mark.parametrize("name", ["rrpr, link 0", "rrpr, link 2", "rrpr, link 4", "prrr, link 1", "five axes, link 3"])
def test_a_solid_that_is_turned_by_a_quaternion_is_in_the_bodies_of_its_link(name: str, tmp_path: Path) -> None:
    text, link = arms(SHAPE)[name]
    files = Files(tmp_path).write(with_quaternions(text))
    assert "rpy=" not in files.urdf.read_text()
    found = files.imported()
    (shape,) = shapes(files.urdf)
    assert shape.link == link
    corners = BOX @ shape.pose[:3, :3].T + shape.pose[:3, 3]
    assert np.abs(shape.pose[:3, 3] - ORIGIN[0]).max() == 0.0
    assert furthest(files, found, link, corners, link, link_in) <= 1e-9


SOLID = (FORE_AT, f'{FORE_AT} quat_xyzw="0 0 0.70710678118654757 0.70710678118654757"')
SOLID_RPY = (FORE_AT, f'{FORE_AT} rpy="0 0 {RIGHT!r}"')
UP = ('<axis xyz="0 0 -1"/>', '<axis xyz="0 0 1"/>')
JOINT = (LIFT_AT, f'{LIFT_AT} quat_xyzw="1 0 0 0"')
JOINT_RPY = (LIFT_AT, f'{LIFT_AT} rpy="{math.pi!r} 0 0"')


def without_digest(text: str) -> str:
    return re.sub(r"sha256 [0-9a-f]+", "", text)


@pytest.mark.parametrize(
    ("quaternion", "rpy"), [((SOLID,), (SOLID_RPY,)), ((JOINT, UP), (JOINT_RPY, UP))], ids=["solid", "joint"]
)
def test_a_right_angle_as_a_quaternion_makes_the_robot_that_rpy_makes(
    quaternion: tuple[tuple[str, str], ...], rpy: tuple[tuple[str, str], ...], tmp_path: Path
) -> None:
    files = cellarm(tmp_path, *quaternion, version="1.1")
    one = files.imported()
    files = cellarm(tmp_path, *rpy)
    other = files.imported()
    files = cellarm(tmp_path, *(change for change in rpy if change == UP))
    neither = files.imported()
    assert without_digest(one.text) == without_digest(other.text) != without_digest(neither.text)


BOTH = f'{FORE_AT} rpy="0 0 0" quat_xyzw="0 0 1 0"'
WRONG = {
    "both": (BOTH, "1.1", "link fore, collision, origin: both rpy and quat_xyzw; leave the one that counts"),
    "zero": (f'{FORE_AT} quat_xyzw="0 0 0 0"', "1.1", "'0 0 0 0', which is 0 long"),
    "not 1 long": (f'{FORE_AT} quat_xyzw="0 0 1 1"', "1.2", "which is 1.41421 long"),
    "three numbers": (f'{FORE_AT} quat_xyzw="0 0 1"', "1.1", "write 4 numbers"),
    "not a number": (f'{FORE_AT} quat_xyzw="0 0 nan 1"', "1.1", "is no finite number"),
    "version 1.0": (f'{FORE_AT} quat_xyzw="0 0 1 0"', "1.0", 'write version="1.1" in <robot>, or the turn as rpy'),
    "no version": (f'{FORE_AT} quat_xyzw="0 0 1 0"', "", "which version 1.0 does not have"),
    "misspelt": (f'{FORE_AT} quat_xyz="0 0 1 0"', "1.1", "attribute quat_xyz='0 0 1 0' is not known"),
    "another order": (f'{FORE_AT} quat_wxyz="0 0 1 0"', "1.1", "attribute quat_wxyz='0 0 1 0' is not known"),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_quaternion_that_is_none_is_refused(name: str, tmp_path: Path) -> None:
    at, version, words = WRONG[name]
    (found,) = told(cellarm(tmp_path, (FORE_AT, at), version=version))
    assert words in found
    (found,) = told(cellarm(tmp_path, (LIFT_AT, at.replace(FORE_AT, LIFT_AT)), version=version))
    assert words.replace("link fore, collision", "joint lift") in found


def test_a_quaternion_of_few_digits_is_a_direction_and_that_is_reported(tmp_path: Path) -> None:
    files = cellarm(tmp_path, (FORE_AT, f'{FORE_AT} quat_xyzw="0 0 0.7071 0.7071"'), version="1.1")
    found = files.imported()
    assert "yaw_rad: 1.5707963267948966" in found.text
    assert found.report["remarks"][0].startswith(
        "line 5, link fore, collision, origin.quat_xyzw: it is 0.99999 long; the quaternion of its direction is taken"
    )


def test_a_quaternion_that_is_nearly_a_right_angle_is_read_as_rpy_is(tmp_path: Path) -> None:
    files = cellarm(tmp_path, (LIFT_AT, f'{LIFT_AT} quat_xyzw="1 0 0.00002 0"'), UP, version="1.1")
    remarks = files.remarks
    assert any(each.startswith("angles written with few digits (1 0 0.00002 0) are read as") for each in remarks)
    files = cellarm(tmp_path, (LIFT_AT, f'{LIFT_AT} quat_xyzw="1 0 0.002 0"'), UP, version="1.1")
    assert any("deg from vertical slide" in each for each in told(files))


def test_a_quaternion_of_what_is_only_seen_has_no_effect(tmp_path: Path) -> None:
    seen = '<visual><origin quat_xyzw="0 0 0 0" rpy="x"/><geometry><box size="1 1 1"/></geometry></visual>'
    files = cellarm(tmp_path, ('<link name="fore">', f'<link name="fore">{seen}'))
    found = files.imported()
    assert "visual (1, first in line 5)" in found.report["unused"]
    plain = cellarm(tmp_path)
    assert without_digest(found.text) == without_digest(plain.imported().text)
