"""Rows that bound the error of the tool at an instant: hand-made, and compared with positions at the ends of a lag."""

from __future__ import annotations

import math
from itertools import product
from typing import Any

import numpy as np
import pytest
from flint import ctx

from assur.prover import prove as prover
from tests.prover.bundles import Document, agreed, bundle, planned
from tests.prover.test_stated_rows import LITTLE, holds, slide, swinging


def error(far: float, flat: float, up: float, yaw: float, **changes: Any) -> Document:
    where = {"time": 0.0, "phase": 0, "frame": 1, "link": 1, "tool": [0.0] * 4, "target": [0.0] * 4}
    bounds = {"distance": far, "horizontal": flat, "vertical": up, "yaw": yaw}
    return {**where, "off": [0.0] * 3, "arm": 0.0, **bounds, **changes}


def unsure(document: Document, frame: int, amount: float, way: list[float], growth: float = 0.0) -> None:
    document["frames"][frame]["unknown"].append(
        {"direction": way, "amount": amount, "growth": growth, "shared": True},
    )


def still() -> Document:
    """A slide that rests, and a belt that rests; a frame that moves is far away."""
    document = slide()
    document["arms"][0].update(qd=[[0.0], [0.0]])
    document["frames"][1].update(rate=[0.0] * 4, edges=[], acceleration=[])
    return document


def bounds(
    document: Document, far: float, flat: float, up: float, yaw: float, more: float = LITTLE, **changes: Any
) -> None:
    """An error is shown with these bounds, and with none that is smaller. `more`: what bent ways add at most."""
    exact = (far, flat, up, yaw)
    assert holds(document, "errors", error(*(x + more for x in exact), **changes))
    for k in range(4):
        less = [x + (more if j != k else -LITTLE) for j, x in enumerate(exact)]
        if exact[k] > 0.0:
            assert not holds(document, "errors", error(*less, **changes)), k


def test_displacements_and_what_the_point_itself_may_be_off_add_up() -> None:
    document = still()
    bounds(document, 0.0, 0.0, 0.0, 0.0)
    bounds(document, 0.5, 0.3, 0.4, 0.2, off=[0.3, 0.4, 0.2])
    bounds(document, 0.5 + 0.2 * 3.0, 0.3, 0.4, 0.2, off=[0.3, 0.4, 0.2], arm=3.0)
    unsure(document, 1, 0.02, [1.0, 0.0, 0.0])
    unsure(document, 1, 0.01, [0.6, 0.8, 0.0])
    flat = math.hypot(0.026, 0.008)
    bounds(document, flat, flat, 0.0, 0.0)
    unsure(document, 1, 0.003, [0.0, 0.0, 1.0])
    bounds(document, math.hypot(flat, 0.003), flat, 0.003, 0.0)
    unsure(document, 1, 0.05, [])
    bounds(document, math.hypot(flat + 0.05, 0.003), flat + 0.05, 0.003, 0.0)
    # what both are apart as planned counts, too
    away = [-0.006 * 0.026 / flat, -0.006 * 0.008 / flat, 0.001, 9.0]
    side = flat + 0.05 + 0.006
    bounds(document, math.hypot(side, 0.004), side, 0.004, 0.0, target=away)


def test_a_tool_that_shares_a_displacement_is_off_by_the_rest_of_it() -> None:
    document = still()
    document["required"].update(tool_from=1, since=-2.0, late=1.0)
    unsure(document, 1, 0.02, [1.0, 0.0, 0.0], growth=0.01)
    unsure(document, 0, 0.001, [0.0, 1.0, 0.0])
    bounds(document, 0.05, 0.05, 0.0, 0.0)
    for shares, own, other in (([[0.0, 0.0], [1.0, 1.0]], 0.0, 0.0), ([[-1.0, 2.0], [0.25, 0.5]], 0.75, 2.0)):
        document["phases"][0]["shares"] = shares
        flat = math.hypot(0.05 * own, 0.001 * other)
        assert errors_shown(document, error(flat + LITTLE, flat + LITTLE, LITTLE, LITTLE))
        for off in (flat - LITTLE, flat + LITTLE) if flat else ():
            other_one = 2.0 * flat - off
            assert not errors_shown(document, error(off, other_one, LITTLE, LITTLE))
        document["required"]["tool_from"] = 2
        assert not errors_shown(document, error(0.05 - LITTLE, 9.0, 9.0, 9.0))
        document["required"]["tool_from"] = 1


def errors_shown(document: Document, row: Document) -> bool:
    """Whether an error is shown of an arm for which no other claim of a correction is, for it is no SCARA."""
    before = ctx.prec, ctx.cap
    ctx.prec, ctx.cap = prover.BITS, prover.TERMS
    try:
        world = prover.World({**document, "errors": [row]})
        world.stated()
    finally:
        ctx.prec, ctx.cap = before
    return not world.failures


def test_a_frame_that_may_be_turned_brings_its_point_elsewhere() -> None:
    document, yaw = still(), 0.02
    there: Any = {"tool": [0.3, 0.4, 0.0, 0.0], "target": [0.3, 0.4, 0.0, 0.0]}
    document["frames"][1]["yaw"] = yaw
    side = 0.5 * yaw + 0.5 * yaw**2 / 2.0
    bounds(document, side, side, 0.0, yaw, **there)
    bounds(document, side + 0.05 + 2.0 * (yaw + 0.1), side + 0.05, 0.0, yaw + 0.1, off=[0.05, 0, 0.1], arm=2.0, **there)
    unsure(document, 1, 0.05, [-0.8, 0.6, 0.0])  # the same way as the turn brings it
    bounds(document, side + 0.05, side + 0.05, 0.0, yaw, **there)


def test_a_start_that_may_be_late_brings_the_point_elsewhere() -> None:
    document = slide()
    document["arms"][0].update(qd=[[0.0], [0.0]])
    document["frames"][1]["pose"] = [0.0, -1.0, 0.0, 0.0]  # at 0 s it is at 0, with 1 m/s along y
    bounds(document, 0.0, 0.0, 0.0, 0.0)
    document["required"]["late"] = 0.3
    bounds(document, 0.3, 0.3, 0.0, 0.0)
    document["frames"][1]["shift"] = [-0.1, 0.5]
    bounds(document, 0.5, 0.5, 0.0, 0.0)
    document["frames"][1]["shift"] = [-0.1, 0.2]
    bounds(document, 0.4, 0.4, 0.0, 0.0)
    # what turns goes along an arc
    document["frames"][1].update(pose=[0.0, 0.0, 0.0, -1.5], rate=[0.0, 0.0, 0.0, 1.5])
    chord, there = 2.0 * 0.5 * math.sin(0.3), {"tool": [0.5, 0.0, 0.0, 0.0], "target": [0.5, 0.0, 0.0, 0.0]}
    bounds(document, chord, chord, 0.0, 0.6, more=4e-5, **there)


def test_an_error_is_claimed_at_a_time_of_its_phase() -> None:
    document = still()
    assert not holds(document, "errors", error(9.0, 9.0, 9.0, 9.0, time=1.0 + 1e-9))
    with pytest.raises(ValueError, match="phase 2 does not exist"):
        agreed({**document, "errors": [error(9.0, 9.0, 9.0, 9.0, phase=2)]})
    with pytest.raises(ValueError, match="link 7 does not exist"):
        agreed({**document, "errors": [error(9.0, 9.0, 9.0, 9.0, link=7)]})
    document["errors"] = [error(9.0, 9.0, 9.0, 9.0), error(5.0, 5.0, 5.0, 11.0)]
    told = agreed(document)[1]
    assert told["times and intervals at which the error of the tool is bounded"] == 2
    assert [told["greatest error, m"], told["greatest turn in an error, rad"]] == [9.0, 11.0]


def not_shown(document: Document, row: Document) -> int:
    """How many errors are not shown; what else is not is left aside."""
    right, told = agreed({**document, "errors": [row]})
    return 0 if right else sum(line.startswith("errors, ") for line in told)


def test_more_terms_than_signs_are_combined_of_count_in_every_direction() -> None:
    document = still()
    for k in range(14):
        unsure(document, 1, 0.01, [math.cos(k), math.sin(k), 0.5])
    worst = 14 * 0.01
    row = error(math.hypot(worst, worst / 2) + LITTLE, worst + LITTLE, worst / 2 + LITTLE, LITTLE)
    assert not_shown(document, row) == 0
    assert not_shown(document, {**row, "vertical": worst / 2 - LITTLE}) == 1


def test_joints_that_lag_move_the_tool_along_a_bent_way() -> None:
    document = swinging()
    document["required"]["lag"] = [0.01, 0.02]
    there = {"link": 2, "frame": 0, "tool": [1.0, 0.0, 0.0, 0.0], "target": [2.0, 0.0, 0.0, 0.0]}
    bent = 6e-4  # of second order
    assert not_shown(document, error(0.04 + bent, 0.04 + bent, LITTLE, 0.03 + LITTLE, **there)) == 0
    assert not_shown(document, error(0.04 - 1e-5, 0.04 + bent, LITTLE, 0.03 + LITTLE, **there)) == 1
    assert not_shown(document, error(0.04 + bent, 0.04 - 1e-5, LITTLE, 0.03 + LITTLE, **there)) == 1
    assert not_shown(document, error(0.04 + bent, 0.04 + bent, LITTLE, 0.03 - LITTLE, **there)) == 1


@pytest.mark.parametrize(("name", "lag"), [("demo", 2e-3), ("five-bar", 2e-3), ("rv-m1", 2e-3)])
def test_an_error_is_no_less_than_that_of_joints_at_the_ends_of_their_lag(name: str, lag: float) -> None:
    document, (scene, plan) = bundle(name), planned(name)
    point = document["points"][0]
    frame, t = document["frames"][point["frame"]], point["t0"]
    frame.update(unknown=[], yaw=0.0, shift=[0.0, 0.0])
    document["required"].update(lag=[lag] * len(document["required"]["lag"]), late=0.0)
    phase = next(k for k, each in enumerate(document["phases"]) if each["t0"] <= t <= each["t1"])
    for each in document["frames"]:
        each["unknown"] = []
    q, n, local = plan.trajectory.evaluate(np.array([t]))[0], len(document["required"]["lag"]), point["tool"][:3]
    signs = np.array(list(product((-1.0, 0.0, 1.0), repeat=n)))
    # links of a bundle are those of the robot, but for links that no body is on
    places, turns = scene.robot.placements(np.vstack([q, q + lag * signs]))
    link = point["link"] if point["link"] < places.shape[1] else -1
    there = places[:, link] + turns[:, link] @ np.array(local)
    off = there[1:] - there[0]
    flat, up = np.hypot(off[:, 0], off[:, 1]).max(), np.abs(off[:, 2]).max()
    ways = turns[:, link, :2, 0]
    cross = ways[0, 0] * ways[1:, 1] - ways[0, 1] * ways[1:, 0]
    upright = document["arms"][0]["links"][point["link"]]["pitch"] is None
    yaw = float(np.abs(np.arctan2(cross, ways[1:] @ ways[0])).max()) if upright else 0.0
    far = float(np.linalg.norm(off, axis=1).max())
    where = {
        "time": t,
        "phase": phase,
        "arm": 0.0,
        "off": [0.0] * 3,
        **{k: point[k] for k in ("frame", "link", "tool")},
    }
    exact = {"distance": far, "horizontal": float(flat), "vertical": float(up), "yaw": yaw}
    row = {**where, "target": point["target"], **{key: 1.02 * x + 1e-6 for key, x in exact.items()}}
    assert not_shown(document, row) == 0
    for key, x in exact.items():
        if x > 1e-6:
            assert not_shown(document, {**row, key: 0.999 * x - 1e-6}) == 1, key
