"""A time that is not shown as a whole is divided where pieces of the motion meet, then in halves."""

from __future__ import annotations

import numpy as np
import pytest

from assur.planner.checker.claim.motion import make_curves
from assur.planner.checker.claim.tool import middle
from assur.planner.checker.claim.verdict import check_claim, prepare
from assur.planner.checker.verdict import Code
from assur.planner.claim import columns as c
from assur.planner.claim.filling import claim_of, with_plan
from assur.planner.legs.tool_motion import tool_peak
from assur.planner.model.outcome import Leg, LegKind, Plan
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Scene
from assur.planner.trajectory import Trajectory
from tests.planner.cells import cell, go
from tests.planner.checker.hand_made import no_rows

LONG_S, SHORT_S, SLOW = 65.0, 1e-5, 1e-5
"""s, s, and rad/s²."""


def slow_motion() -> tuple[Scene, Trajectory]:
    """The first joint accelerates for long, then the second one for longer, with two short pieces between both."""
    scene = cell(go(0.35, 0.1), q=(-0.5, 0.4, 0.2, 0.0))
    time = np.cumsum([0.0, LONG_S, SHORT_S, SHORT_S, 2.0 * LONG_S])
    qdd = SLOW * np.array([[1.0, 0, 0, 0], [1.0, 0, 0, 0], [0.5, 0.5, 0, 0], [0, 1.0, 0, 0], [0, 1.0, 0, 0]])
    q, qd = np.tile(scene.start.q, (5, 1)), np.zeros((5, 4))
    for i, h in enumerate(np.diff(time).tolist()):
        qd[i + 1] = qd[i] + 0.5 * h * (qdd[i] + qdd[i + 1])
        q[i + 1] = q[i] + h * qd[i] + h * h * (2.0 * qdd[i] + qdd[i + 1]) / 6.0
    return scene, Trajectory(time, q, qd, qdd)


def claim_with(scene: Scene, path: Trajectory, most: float) -> c.Claim:
    """A claim that the tool accelerates no harder than `most` all along."""
    plan = Plan(path, (Leg(LegKind.MOVE, 0, path.start, path.end),), (), no_rows())
    claim = with_plan(claim_of(scene), plan, (Phase(path.start, path.end, LegKind.MOVE, 0),))
    link = len(scene.robot.links) - 1
    return claim._replace(rates=c.table("rates", [(path.start, path.end, link, 0.0, 0.0, 0.0, -1, 2, 0.0, most)]))


@pytest.mark.parametrize(("share", "accepted"), [(1.01, True), (0.99, False)])
def test_a_short_piece_between_long_ones_is_reached(share: float, accepted: bool) -> None:
    """After 23 halvings parts of 195 s are longer than 20 µs, and the short pieces themselves must be divided."""
    scene, path = slow_motion()
    size, when = tool_peak(scene, path, path.start, path.end)
    assert LONG_S <= when <= LONG_S + SHORT_S
    codes = [finding.code for finding in check_claim(claim_with(scene, path, share * size)).findings]
    assert (Code.RATE not in codes) == accepted


def test_times_are_divided_at_knots_with_as_many_pieces_on_either_side() -> None:
    scene, _ = slow_motion()
    time = np.array([0.0, 1.0, 1.5, 1.5 + SHORT_S, 8.0, 9.0])
    q = np.tile(scene.start.q, (len(time), 1))
    claim = claim_with(scene, Trajectory(time, q, 0.0 * q, 0.0 * q), 1.0)
    geometry, scratch = prepare(claim)
    assert make_curves(claim, geometry, scratch)
    found = [middle(geometry, t0, t1) for t0, t1 in ((0.0, 9.0), (0.0, 1.5), (0.25, 1.25), (0.25, 1.0), (1.5, 9.0))]
    assert found == [1.5, 1.0, 1.0, 0.625, 1.5 + SHORT_S]
    assert middle(geometry, 8.0, 9.0) == 8.5
