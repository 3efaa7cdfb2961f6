"""Warnings: what is probably not meant is told, with the number, and what is usual is not. Each body is posed once."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import pytest

from assur.planner.collision.fcl_entry import PlacedShape
from assur.planner.collision.proof import Prover
from assur.planner.feasibility.hits import AtStart
from assur.planner.feasibility.input_warnings import (
    DROP_M,
    FLOAT_M,
    GRIP_M,
    MOST_OVERLAPS,
    MOUNT_M,
    OVERLAP_M,
    smallest_extent,
    unusual_arrivals,
    unusual_bodies,
    unusual_places,
)
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import Body, Piece, Primitive, box, capsule, cylinder
from assur.planner.laws import turntable
from assur.planner.laws.law import PoseUncertainty
from assur.planner.model.input_warning import InputWarning, WarningKind
from assur.planner.model.outcome import Planned
from assur.planner.model.scene import Holding, Pick, Place, Scene, Tool
from assur.planner.model.task import Tolerance
from assur.planner.pipeline import plan
from assur.planner.report.notes import warned
from tests.planner.cells import (
    BARE,
    Around,
    belt_and_dial,
    block,
    cell,
    frame,
    go,
    mesh_box,
    solid,
    stands,
    table_to_table,
)

CUP_M = 0.015
"""Radius of the cup."""


def odd(scene: Scene) -> tuple[InputWarning, ...]:
    """The warnings about where bodies are."""
    at = AtStart(scene, Prover(scene))
    return unusual_bodies(scene, at) + unusual_places(scene, at)


def with_part(scene: Scene, **changes: Any) -> Scene:
    """The scene with another part."""
    return replace(scene, bodies=tuple(replace(b, **changes) if b.name == "part" else b for b in scene.bodies))


def lifted(by: float, scene: Scene | None = None) -> Scene:
    """`table_to_table`, with the part so far above its table, or so deep in it."""
    scene = scene or table_to_table()
    pose = scene.index["part"].pose
    return with_part(scene, pose=replace(pose, z=pose.z + by))


def placed(by: float, **changes: Any) -> Scene:
    """`table_to_table`, with the part put down so far above the right table."""
    scene = table_to_table()
    pick, place = scene.task
    assert isinstance(place, Place)
    pose = place.to.pose
    there = replace(place.to, pose=replace(pose, z=pose.z + by))
    return replace(scene, task=(pick, replace(place, to=there, **changes)))


def gripped(beside: float, up: float = 0.0, **changes: Any) -> Scene:
    """`table_to_table`, with the tool point so far beside the part, or above it."""
    scene = table_to_table(**changes)
    pick, place = scene.task
    assert isinstance(pick, Pick)
    grasp = replace(pick.grasp, x=pick.grasp.x + beside, z=pick.grasp.z + up)
    return replace(scene, task=(replace(pick, grasp=grasp), place))


def mounted(overlap: float) -> Scene:
    """A tool whose upper end is so far above the flange, where the quill ends."""
    cup = solid("cup", cylinder(CUP_M, 0.1), 0.0, 0.0, overlap - 0.05)
    return cell(go(0.35, -0.2), tool=Tool(Pose(z=-0.06), (cup,)))


def without(scene: Scene, name: str) -> Scene:
    return replace(scene, bodies=tuple(body for body in scene.bodies if body.name != name))


def more(scene: Scene, *bodies: Around) -> Scene:
    return replace(scene, bodies=(*scene.bodies, *bodies))


def supported(scene: Scene, *names: str) -> Scene:
    """The pick names what its part rests on."""
    pick = scene.task[0]
    assert isinstance(pick, Pick)
    return replace(scene, task=(replace(pick, contact_with=names), *scene.task[1:]))


def held(scene: Scene) -> Scene:
    """The part is in the gripper at the start."""
    start = replace(scene.start, holding=Holding("part", Pose(z=0.01)))
    return replace(scene, start=start, task=scene.task[1:])


def beside_a_block(air: float) -> Scene:
    """A floating part beside a block that is lower. Circles about both overlap; between both sides is so much air."""
    pillar = stands("block", box(0.1, 0.1, 0.03), 0.25 + 0.03 + 0.05 + air, 0.30, 0.042)
    scene = without(lifted(0.02), "right-table")
    return more(with_part(scene, pose=replace(scene.index["part"].pose, yaw=0.0)), pillar)


TRAY = mesh_box("tray", 0.2, 0.2, 0.04)
"""A hollow box, 40 mm high; its floor is 2 mm thick."""


def over_a_tray(z: float) -> Scene:
    """The part in a tray, its middle at a height."""
    scene = without(table_to_table(), "left-table")
    return with_part(more(scene, Around(TRAY, "world", Pose(0.25, 0.30, 0.02))), pose=Pose(0.25, 0.30, z))


def into_a_tray(z: float) -> Scene:
    """The part is put down in a tray in place of the table, so much above its floor."""
    tray = Around(TRAY, "world", Pose(0.35, -0.25, 0.02))
    return more(without(placed(z - 0.04 + 0.002), "right-table"), tray)


def stacked(by: float) -> Scene:
    """A second part is put down on the first one, or so much above it."""
    scene = table_to_table()
    pick, place = scene.task
    assert isinstance(pick, Pick)
    assert isinstance(place, Place)
    first = scene.index["part"]
    second = replace(first, body=replace(first.body, name="second"), pose=Pose(0.25, 0.22, 0.05))
    above = replace(place.to, pose=replace(place.to.pose, z=place.to.pose.z + 0.02 + by))
    again = (replace(pick, name="pick-2", part="second"), replace(place, name="place-2", part="second", to=above))
    return replace(more(scene, second), task=(pick, place, *again))


def among_what_moves() -> Scene:
    """A part is put down in the air, in a cell in which a frame moves."""
    scene = placed(0.05)
    dial = frame("dial", turntable(Pose(-0.5, 0.0, 0.0), 1.0))
    scene = replace(scene, frames={**scene.frames, "dial": dial})
    return more(scene, Around(solid("plate", cylinder(0.05, 0.01)), "dial", Pose()))


class Case(NamedTuple):
    """A scene, the warning about it, its bodies, its number (None: any), and some of its words."""

    scene: Scene
    kind: WarningKind
    bodies: tuple[str, str]
    amount_m: float | None = None
    words: str = ""


PART_ON_LEFT, PART_ON_RIGHT = ("part", "left-table"), ("part", "right-table")
IN_AIR, OFF_PART, FLOATS = WarningKind.RELEASED_IN_AIR, WarningKind.TOOL_OFF_PART, WarningKind.PART_FLOATS
SHORT = Tool(Pose(z=-0.06), (solid("cup", cylinder(CUP_M, 0.02), 0.0, 0.0, -0.01),))
"""A tool whose body ends above its point."""
TOLD: dict[str, Case] = {
    **{f"a part {1e3 * by:g} mm above its table": Case(
        lifted(by), FLOATS, PART_ON_LEFT, by, f"part is {1e3 * by:.3g} mm above left-table")
       for by in (0.0002, 0.003, 0.0099)},
    "a part just above a block": Case(beside_a_block(-0.001), FLOATS, ("part", "block"), 0.003),
    "a part above the floor of a tray, below the rim": Case(over_a_tray(0.016), FLOATS, ("part", "tray"), 0.004),
    **{f"a part released {1e3 * by:g} mm above a table": Case(
        placed(by), IN_AIR, PART_ON_RIGHT, by, f"part is released {1e3 * by:.3g} mm above right-table")
       for by in (DROP_M + 0.0005, 0.01, 0.1)},
    "a part released beside a long beam that is higher than the table": Case(
        more(placed(0.02), stands("beam", box(2.0, 0.05, 0.05), 0.35, -0.45, 0.025)), IN_AIR, PART_ON_RIGHT, 0.02),
    "a part released above another one": Case(stacked(0.01), IN_AIR, ("second", "part"), 0.01),
    **{f"a tool that grips {1e3 * beside:g} mm beside its part, {1e3 * up:g} mm above": Case(
        gripped(beside, up), OFF_PART, ("cup", "part"), None, "no body of the tool touches part where it is picked")
       for beside, up in ((0.0, GRIP_M + 0.002), (0.03 + CUP_M + GRIP_M + 0.002, 0.0), (0.0, 0.2))},
    "a tool that ends above its point": Case(
        gripped(0.0, tool=SHORT), OFF_PART, ("cup", "part"), None, "away; check grasp and tcp"),
    "a tool whose point has the other sign": Case(
        gripped(0.0, tool=Tool(Pose(z=0.06), SHORT.bodies)), OFF_PART, ("cup", "part"), None,
        "check grasp and tcp: tcp is at z 60 mm, and all bodies of the tool are on the other side of the flange"),
    **{f"a part {1e3 * by:g} mm deep in its table": Case(
        lifted(-by), WarningKind.BODIES_OVERLAP, ("left-table", "part"), None,
        "left-table and part overlap by more than 1 mm where they are at the start")
       for by in (OVERLAP_M + 0.0005, 0.01)},
    **{f"a tool {1e3 * by:g} mm deep in the quill": Case(
        mounted(by), WarningKind.TOOL_IN_ARM, ("cup", "quill"), None,
        "overlaps quill of the arm by more than 30 mm along")
       for by in (MOUNT_M + 0.001, 0.1)},
}  # fmt: skip
USUAL: dict[str, Scene] = {
    **{f"a part {1e3 * by:g} mm above a table": lifted(by) for by in (0.0, 5e-5, -5e-5, FLOAT_M + 0.001, 0.1)},
    "a part that nearly overlaps": lifted(0.0002 - OVERLAP_M),
    "a floating part whose support is named": supported(lifted(0.003), "left-table"),
    "a floating part in the gripper": held(lifted(0.003)),
    "a part that floats beside a block": beside_a_block(0.001),
    "a part on the floor of a tray": over_a_tray(0.01202),
    **{f"a part put down at {1e3 * by:g} mm": placed(by) for by in (0.0, DROP_M - 0.0005, -5e-5)},
    "a part released above a support that is named": placed(0.05, contact_with=("right-table",)),
    "a part released above nothing": without(placed(0.05), "right-table"),
    "a part put down in a tray": into_a_tray(0.0),
    "a part released in a tray, with nothing that is wholly below it": into_a_tray(0.005),
    "a part put down on another one": stacked(0.0),
    "a part put down on a dial": belt_and_dial(),
    "a part released among what moves": among_what_moves(),
    **{f"a grip {1e3 * beside:g} mm beside, {1e3 * up:g} mm above": gripped(beside, up)
       for beside, up in ((0.0, 0.0), (0.0, GRIP_M - 0.002), (0.0, -0.005), (0.03, 0.0))},
    "a tool without bodies": gripped(0.0, 0.2, tool=BARE),
    "fixtures made of shapes that overlap": more(
        table_to_table(), stands("post", box(0.05, 0.05, 0.2), 0.35, -0.25, -0.07)),
    "a tool that begins at the flange": mounted(0.0),
    "a tool that is mounted": mounted(MOUNT_M - 0.001),
}  # fmt: skip


@pytest.mark.parametrize("name", TOLD)
def test_what_is_probably_not_meant_is_told_with_its_number(name: str) -> None:
    case = TOLD[name]
    (warning,) = odd(case.scene)
    assert (warning.kind, warning.bodies) == (case.kind, case.bodies)
    assert case.amount_m is None or warning.amount_m == pytest.approx(
        case.amount_m, abs=2e-4 if "tray" in name else 1e-6
    )
    assert case.words in warned(warning)


@pytest.mark.parametrize("name", USUAL)
def test_what_is_usual_is_not_told(name: str) -> None:
    assert odd(USUAL[name]) == ()


def test_a_tool_in_a_link_from_which_nothing_keeps_it_apart_is_told() -> None:
    """A camera 300 mm beside the flange, as high as link 2: inside it where the elbow is, beside it where not."""
    scene = mounted(0.0)
    link = next(each for each in scene.robot.bodies if scene.robot.links[each.link] == "link2")
    prover = Prover(scene)
    flange, arm = (prover.carriers(scene.start.q, 0.0)[scene.robot.links.index(name)] for name in ("flange", "link2"))
    local = flange[3:].reshape(3, 3).T @ (arm[:3] - flange[:3])
    height = float(local[2]) + sum(link.body.heights) / 2
    assert scene.robot.self_pairs == ()
    for beside, wrong in ((0.0, True), (1.0, False)):
        camera = solid("camera", box(0.03, 0.03, 0.03), float(local[0]), float(local[1]) + beside, height)
        told = odd(replace(scene, tool=replace(scene.tool, bodies=(camera,))))
        assert [each.bodies for each in told] == [("camera", link.body.name)] * wrong
        if wrong:
            assert told[0].amount_m == 0.0


def test_warnings_refuse_nothing_and_are_in_both_answers() -> None:
    far = lifted(0.003)
    far = replace(far, task=(*far.task[:1], go(2.0, 0.0)))
    for scene, kind, answer in (
        (mounted(0.05), WarningKind.TOOL_IN_ARM, "Planned"),
        (placed(0.01), IN_AIR, "Planned"),
        (far, FLOATS, "NotPlanned"),
    ):
        told = plan(scene)
        assert [each.kind for each in told.warnings] == [kind]
        assert type(told).__name__ == answer
        assert np.isfinite([each.amount_m for each in told.warnings]).all()


def lying(by_m: float, tolerance: Tolerance | None = None) -> Scene:
    """`table_to_table` with a part of 60 mm x 30 mm that may lie so far beside its place."""
    scene = with_part(table_to_table(shape=box(0.06, 0.03, 0.02)), uncertainty=PoseUncertainty(position_m=by_m))
    pick = scene.task[0]
    assert isinstance(pick, Pick)
    return replace(scene, task=(pick if tolerance is None else replace(pick, tolerance=tolerance),))


def test_a_pick_that_may_miss_its_part_is_told_with_step_and_cause() -> None:
    """From half of its smallest horizontal extent on."""
    told = plan(lying(0.0152))
    assert isinstance(told, Planned)
    (warning,) = told.warnings
    assert (warning.kind, warning.bodies) == (WarningKind.MAY_MISS, ("cup", "part"))
    assert warning.amount_m == pytest.approx(0.0152, abs=1e-5)
    expected = "the tool may miss part by 15.2 mm, mainly due to: part; state tolerance_mm for step pick"
    assert warned(warning) == f"{expected} to have it refused"
    for scene in (lying(0.0148), lying(0.0152, Tolerance(0.02))):
        told = plan(scene)
        assert isinstance(told, Planned)
        assert told.warnings == ()
    turned = lying(0.0152, Tolerance(yaw_rad=1.0))
    told = plan(turned)
    assert isinstance(told, Planned)
    assert [each.kind for each in unusual_arrivals(turned, told.plan.arrivals)] == [WarningKind.MAY_MISS]


@pytest.mark.parametrize(
    ("shape", "extent"),
    [
        (box(0.06, 0.03, 0.02), 0.03),
        (cylinder(0.02, 0.1), 0.04),
        (capsule(0.01, 0.1), 0.02),
        (block(0.05, 0.08, 1), 0.05),
    ],
)
def test_the_smallest_extent_is_that_of_the_shape_whatever_its_place(shape: Primitive, extent: float) -> None:
    assert smallest_extent(Body("one", (Piece(shape, np.array([1.0, -2.0, 3.0])),))) == pytest.approx(extent)
    c, s = math.cos(0.3), math.sin(0.3)
    turned = Piece(shape, np.zeros(3), np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]))
    assert extent - 1e-12 <= smallest_extent(Body("one", (turned,))) <= 1.02 * extent


MANY = 40


def heap(apart: float = 0.0) -> Scene:
    """`table_to_table`, with many boxes where its part is, each so much further along y, m."""
    scene = table_to_table()
    part = scene.index["part"]
    around = [stands(f"box-{i}", box(0.03, 0.03, 0.03)) for i in range(MANY)]
    places = [replace(part.pose, y=part.pose.y + (i + 1) * apart) for i in range(MANY)]
    return more(scene, *(replace(each, frame=part.frame, pose=at) for each, at in zip(around, places, strict=True)))


@pytest.fixture
def posed(monkeypatch: pytest.MonkeyPatch) -> Counter[str]:
    """How often each body was posed."""
    count, own = Counter[str](), Prover.posed

    def counted(*asked: Any) -> list[PlacedShape]:
        made = own(*asked)
        count.update({each.name for each in made})
        return made

    monkeypatch.setattr(Prover, "posed", counted)
    return count


def test_each_body_is_posed_once_in_each_of_its_places_for_all_warnings(posed: Counter[str]) -> None:
    scene = heap(apart=2e-3)
    odd(scene)
    counts = {name: count for name, count in posed.items() if name in scene.index}
    assert counts.pop("part") == 2  # where it is picked, and where it is put down
    assert set(counts.values()) == {1}


@pytest.mark.parametrize(("apart", "overlaps"), [(0.2, 0), (0.0, MOST_OVERLAPS)])
def test_bodies_that_cannot_touch_and_those_beyond_the_most_that_are_told_are_not_posed(
    apart: float, overlaps: int, posed: Counter[str]
) -> None:
    scene = heap(apart)
    warnings = unusual_places(scene, AtStart(scene, Prover(scene)))
    found = [each.bodies for each in warnings if each.kind is WarningKind.BODIES_OVERLAP]
    assert found == [("part", f"box-{i}") for i in range(overlaps)]
    assert len([name for name in posed if name.startswith("box-")]) == overlaps
