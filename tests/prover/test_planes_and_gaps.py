"""Planes, which are rows for all that stands behind them, and second distances, which count if nothing is unknown."""

from __future__ import annotations

import math
from typing import Any

import pytest

from tests.prover.bundles import Document, agreed, bundle
from tests.prover.test_guards import ball, body, row, sliding
from tests.prover.test_stated_rows import LITTLE


def plane(**changes: Any) -> Document:
    return {**row(0, -1, 0, -1), **changes}


def test_a_plane_is_a_row_for_each_body_that_stands_behind_it() -> None:
    walls = [body("near", ball(0.9)), body("far", ball(2.0), ball(3.0))]
    right, told = agreed(sliding(*walls, rows=[plane()], speed=2.0, least=0.075 - LITTLE))
    assert right
    assert [told["planes among the rows"], told["rows that show it"]] == [1, 2]
    right, told = agreed(sliding(*walls, rows=[plane()], speed=2.0, least=0.075 + LITTLE))
    # the plane itself is not wrong: it does not show the nearer one
    assert (right, len(told)) == (False, 2)
    assert told[0] == "ball and near in MOVE from 0 s: no row for a part of it"
    assert agreed(sliding(*walls, rows=[plane(), row(0, 1)], speed=2.0, least=0.07))[1]["rows that show it"] == 3


def test_a_body_that_may_be_elsewhere_is_behind_a_plane_with_that() -> None:
    document = sliding(body("wall", ball(0.9)), rows=[plane()], speed=2.0, least=0.07)
    for off, right in ((0.0049, True), (0.0051, False)):
        document["phases"][0]["unknown"] = [[0.0, 0.0], [off, 0.0]]
        assert agreed(document)[0] is right


def test_a_plane_is_no_row_for_what_moves_or_another_body() -> None:
    document = sliding(body("part", ball(2.0)), rows=[plane()])
    assert agreed(document)[0]
    document["seats"][1]["frame"] = 1
    assert not agreed(document)[0]
    document["seats"][1]["frame"], document["rows"][0]["bodies"] = 0, [1, -1]
    assert not agreed(document)[0]
    document["rows"] = [plane(normal=[-1.0, 0.0, 0.0])]
    assert not agreed(document)[0]
    wrong: dict[str, Document] = {"pieces.1": {"pieces": [0, 0]}, "s1": {"s1": 0.5}, "s0": {"s0": -0.5}}
    for where, changes in wrong.items():
        with pytest.raises(ValueError, match=f"^rows.0.{where}: "):
            agreed({**document, "rows": [plane(**changes)]})


def test_planes_and_rows_cover_a_phase_together() -> None:
    wall = body("wall", ball(2.0))
    assert agreed(sliding(wall, rows=[plane(t1=0.5), {**row(0, 1), "t0": 0.5}]))[0]
    assert not agreed(sliding(wall, rows=[plane(t1=0.5), {**row(0, 1), "t0": 0.5 + LITTLE}]))[0]
    # a plane of one piece of the first body leaves the others uncovered
    document = sliding(wall, rows=[plane()])
    document["bodies"][0]["pieces"].append(ball(0.1))
    assert not agreed(document)[0]
    document["rows"].append(plane(pieces=[1, -1]))
    assert agreed(document)[0]


def test_planes_take_the_place_of_the_rows_of_a_plan() -> None:
    document = bundle("demo")
    stands = [not (f["edges"] or f["waves"] or f["arm"] >= 0) for f in document["frames"]]
    begins = [phase["t0"] for phase in document["phases"]]

    def replaced(own: Document) -> Document:
        p = max(k for k, t0 in enumerate(begins) if t0 <= own["t0"])
        b = own["bodies"][1]
        seat, pieces = document["seats"][document["phases"][p]["seats"][b]], document["bodies"][b]["pieces"]
        box = (len(pieces) == 1 and not pieces[0]["disc"] and not pieces[0]["vertices"]) or own["pieces"][1] < 0
        if seat["link"] >= 0 or not stands[seat["frame"]] or not box or own["s0"] or own["s1"]:
            return own
        return {**own, "bodies": [own["bodies"][0], -1], "pieces": [own["pieces"][0], -1]}

    before = agreed(document)[1]
    document["rows"] = [replaced(own) for own in document["rows"]]
    right, told = agreed(document)
    assert right
    assert told["planes among the rows"] > 50
    assert told["rows that show it"] >= before["rows that show it"]
    walls = [own for own in document["rows"] if own["bodies"][1] < 0]
    document["rows"] = [own for own in document["rows"] if own["bodies"][1] >= 0]
    assert not agreed(document)[0]
    for own in walls:
        own["normal"] = [-x for x in own["normal"]]
    document["rows"] += walls
    assert not agreed(document)[0]


def nearest(least: float, *rows: Document) -> Document:
    """A ball that comes as near a wall as 0.075 m."""
    document = sliding(body("wall", ball(0.9)), rows=[row(0, 1)], speed=2.0)
    document["required"]["nearest"], document["gap_rows"] = least, list(rows)
    return document


SLAB = {**ball(2.0, 0.0), "edges": [[0.4, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.2]]}
BALLS = ball(2.0), {**ball(2.0), "centre": [2.0, 1.0, 0.0]}


@pytest.mark.parametrize(
    ("pieces", "number", "gap", "reach"),
    [((SLAB,), 0, 1.5, math.hypot(2.4, 0.5)), ((SLAB,), -1, 1.5, math.hypot(2.4, 0.5)),
     (BALLS, -1, 1.8, math.hypot(2.0, 1.0) + 0.1)],
    ids=["corner of a box", "box of a box", "box of two balls"],
)  # fmt: skip
def test_what_turns_with_its_frame_is_nearer_by_the_way_of_its_farthest_point(
    pieces: tuple[Document, ...], number: int, gap: float, reach: float
) -> None:
    for least, right in ((gap - 0.1 * reach - LITTLE, True), (gap - 0.1 * reach + LITTLE, False)):
        document = sliding(body("wall", *pieces), rows=[row(0, 1, 0, number)], least=least)
        document["frames"][0].update(yaw=0.1)
        assert agreed(document)[0] is right


def test_a_second_distance_is_kept_if_nothing_is_unknown() -> None:
    for least, right in ((0.075 - LITTLE, True), (0.075 + LITTLE, False)):
        document = nearest(least, row(0, 1))
        assert agreed(document)[0] is right
        document["required"]["lag"] = [0.01]
        document["phases"][0]["unknown"] = [[0.01, 0.01], [0.02, 0.0]]
        document["frames"][0].update(yaw=0.001, unknown=[
            {"direction": [1.0, 0.0, 0.0], "amount": 0.01, "growth": 0.001, "shared": False}
        ])  # fmt: skip
        assert agreed(document)[0] is right
    right, told = agreed(nearest(0.07, row(0, 1)))
    assert told["second distances of the robot's bodies and of parts that were put down, m"] == [0.07, "not claimed"]
    assert told["pairs that keep a second distance, counted in each phase, and rows that show it"] == [1, 1]


def test_rows_of_a_second_distance_cover_every_pair_that_may_not_touch() -> None:
    assert not agreed(nearest(0.07))[0]
    assert not agreed(nearest(0.07, {**row(0, 1), "t1": 0.9}))[0]
    assert agreed(nearest(-1.0))[0]
    document = nearest(0.07)
    document["phases"][0]["contacts"] = [{"bodies": [0, 1], "depth": 0.0}]
    assert agreed(document)[0]
    # no distance is so large: there must be no pair
    assert not agreed(nearest(1e300, row(0, 1)))[0]
    document["required"]["nearest"] = 1e300
    assert agreed(document)[0]
    with pytest.raises(ValueError, match=r"gap_rows\.0\.bodies\.1"):
        agreed(nearest(0.07, plane()))


def test_a_part_that_was_put_down_has_a_second_distance_of_its_own() -> None:
    document = sliding(body("part", ball(0.5)), body("post", ball(0.5)), rows=[row(0, 1), row(0, 2)])
    document["seats"][1].update(frame=1, pose=[0.0, 1.0, 0.0, 0.0])  # on the belt, from y = 1 to y = 2 m before
    document["phases"][0]["put_down"] = [{"body": 1, "supports": []}]
    document["rows"].append(row(1, 2, normal=(0.0, -1.0, 0.0)))
    document["required"].update(nearest=0.2)
    gaps = [row(0, 1), row(0, 2)]
    assert agreed({**document, "gap_rows": gaps})[0]
    for placed, right in ((1.8 - LITTLE, True), (1.8 + LITTLE, False), (1e300, False)):
        document["required"]["placed"] = placed
        assert agreed({**document, "gap_rows": [*gaps, row(1, 2, normal=(0.0, -1.0, 0.0))]})[0] is right
    assert not agreed({**document, "gap_rows": gaps})[0]
