"""What arms of every family say of themselves, and what is none."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import FrozenInstanceError
from typing import Any

import numpy as np
import pytest

from assur.planner.errors import FaultError, InputError
from assur.planner.geometry.shapes import AXES, Body, Piece, box, capsule, cylinder, sphere
from assur.planner.robots.facts import Limits, RobotBody
from assur.planner.robots.five_axis_arm import FiveAxisArm
from assur.planner.robots.five_bar import QUILL as FIVE_BAR_QUILL
from assur.planner.robots.five_bar import FiveBar
from assur.planner.robots.robot import Robot
from assur.planner.robots.scara import FLANGE, QUILL, Scara
from assur.planner.robots.tilting import ElbowArm, PolarArm
from tests.planner.robots.families import elbow, five_axis, polar, scara
from tests.planner.robots.five_bars import five_bar

UP_OR_BACK = ("up", "down", "back-up", "back-down")
SAID: list[tuple[Robot, str, str, tuple[str, ...], str, int | None]] = [
    (scara(), "base link1 link2 quill flange", "x y z yaw", ("left", "right"), "RRPR", 2),
    (scara(3), "base link1 link2 quill flange", "x y z", ("left", "right"), "RRP", 2),
    (elbow(), "base link1 link2* link3* flange*", "x y z", UP_OR_BACK, "RRR", None),
    (polar(), "base link1 link2* link3* flange*", "x y z", ("front", "back"), "RRP", None),
    (five_axis(), "base link1 link2* link3* link4* flange*", "x y z pitch roll", UP_OR_BACK, "RRRRR", None),
    *(
        (
            five_bar(axes=axes),
            "base proximal-left proximal-right distal-left distal-right quill flange",
            coordinates,
            ("left-left", "left-right", "right-left", "right-right"),
            "RRPR"[:axes],
            2 if axes > 2 else None,
        )
        for axes, coordinates in ((2, "x y"), (3, "x y z"), (4, "x y z yaw"))
    ),
]


@pytest.mark.parametrize(("robot", "links", "coordinates", "modes", "kinds", "lift"), SAID)
def test_a_robot_says_what_it_is_and_cannot_be_changed(
    robot: Robot, links: str, coordinates: str, modes: tuple[str, ...], kinds: str, lift: int | None
) -> None:
    """A star stands for a link that tilts."""
    names = links.split()
    assert robot.links == tuple(name.rstrip("*") for name in names)
    assert robot.tilting == {number for number, name in enumerate(names) if name.endswith("*")}
    assert robot.coordinates == tuple(coordinates.split())
    assert (robot.modes, robot.lift) == (modes, lift)
    assert "".join(joint.kind[0].upper() for joint in robot.joints) == kinds
    with pytest.raises(FrozenInstanceError):
        robot.name = "other"  # type: ignore[misc]


def test_the_cranks_of_a_loop_turn_about_axes_of_the_base() -> None:
    chain = five_bar().chain
    links = list(chain.links)
    links[2] = links[2]._replace(parent=1)
    with pytest.raises(FaultError, match="turn on links 0 and 1"):
        chain._replace(links=tuple(links)).rows(0.0)


def solid(*pieces: Piece) -> Body:
    return Body("solid", pieces)


ROUND = [
    solid(Piece(cylinder(0.02, 0.3))),
    solid(Piece(capsule(0.02, 0.3), np.array([0.0, 0.0, 0.1]))),
    solid(Piece(sphere(0.05), rotation=AXES["x"])),
    solid(Piece(cylinder(0.02, 0.3), rotation=np.diag([1.0, -1.0, -1.0])), Piece(sphere(0.05))),
]
UNROUND = [
    solid(Piece(box(0.1, 0.1, 0.1))),
    solid(Piece(cylinder(0.02, 0.3), np.array([0.001, 0.0, 0.0]))),
    solid(Piece(cylinder(0.02, 0.3), rotation=AXES["x"])),
    solid(Piece(sphere(0.05)), Piece(box(0.1, 0.1, 0.1))),
]


def limits(axes: int, lower: float = -1.0) -> Limits:
    high = np.full(axes, 1.0)
    return Limits(np.full(axes, lower), high, high, high, high)


GOOD: dict[Callable[..., Robot], dict[str, Any]] = {
    Scara: {"l1": 0.3, "l2": 0.2, "axes": 4, "limits": limits(4)},
    ElbowArm: {"height": 0.3, "l1": 0.2, "l2": 0.2, "limits": limits(3)},
    PolarArm: {"height": 0.3, "limits": limits(3, 0.1)},
    FiveAxisArm: {"height": 0.3, "l1": 0.2, "l2": 0.2, "l3": 0.1, "limits": limits(5)},
    FiveBar: {"separation": 0.085, "proximal": (0.2, 0.2), "distal": (0.26, 0.26), "axes": 4, "limits": limits(4)},
}


@pytest.mark.parametrize("body", ROUND)
def test_a_solid_of_revolution_may_ride_on_the_quill(body: Body) -> None:
    assert Scara(name="arm", **GOOD[Scara], bodies=(RobotBody(body, QUILL),)).bodies[0].body is body


@pytest.mark.parametrize("body", UNROUND)
def test_what_turns_visibly_may_not_ride_on_the_quill_but_on_the_flange(body: Body) -> None:
    for family, quill in ((Scara, QUILL), (FiveBar, FIVE_BAR_QUILL)):
        with pytest.raises(InputError, match="solids of revolution"):
            family(name="arm", **GOOD[family], bodies=(RobotBody(body, quill),))
    assert Scara(name="arm", **GOOD[Scara], bodies=(RobotBody(body, FLANGE),)).bodies


@pytest.mark.parametrize("family", GOOD)
def test_an_arm_with_too_few_names_or_limits_or_strange_bodies_is_refused(family: Callable[..., Robot]) -> None:
    good = {"name": "arm", **GOOD[family]}
    links = len(family(**good).links)
    n = len(good["limits"].lower)
    for change, field in (
        ({"limits": limits(n - 1, 0.1)}, "limits"),
        ({"joint_names": ("a", "b")}, "joint_names"),
        ({"joint_names": ("a", *"abcde"[: n - 1])}, "joint_names"),
        ({"bodies": (RobotBody(ROUND[0], links),)}, "bodies solid"),
        ({"bodies": (RobotBody(ROUND[0], -1),)}, "bodies solid"),
        ({"self_pairs": (("base", "hand"),)}, "self_pairs"),
    ):
        with pytest.raises(InputError) as refusal:
            family(**{**good, **change})
        assert field in refusal.value.field, refusal.value


@pytest.mark.parametrize(
    ("family", "change", "field"),
    [
        *((Scara, {name: bad}, name) for name in ("l1", "l2") for bad in (0.0, -1.0, np.nan, np.inf)),
        (Scara, {"axes": 5}, "axes"),
        (Scara, {"axes": 3}, "limits"),
        (ElbowArm, {"l1": -1.0}, "l1"),
        (ElbowArm, {"height": np.nan}, "height"),
        (PolarArm, {"limits": limits(3)}, "limits"),
        *((FiveAxisArm, {"l3": bad}, "l3") for bad in (0.0, -0.1, np.inf, np.nan)),
        (FiveBar, {"axes": 5}, "axes"),
        (FiveBar, {"axes": 3}, "limits"),
        (FiveBar, {"assembly": "inside"}, "assembly"),
        (FiveBar, {"parallel_least": 0.0}, "parallel_least"),
        (FiveBar, {"separation": 2.0}, "separation"),
        (FiveBar, {"separation": np.nan}, "separation"),
        (FiveBar, {"proximal": (0.0, 0.2)}, "l1"),
    ],
)
def test_an_arm_that_is_not_one_is_refused_by_the_name_of_the_field(
    family: Callable[..., Robot], change: dict[str, Any], field: str
) -> None:
    with pytest.raises(InputError) as refusal:
        family(**{"name": "arm", **GOOD[family], **change})
    assert field in refusal.value.field, refusal.value
