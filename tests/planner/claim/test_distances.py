"""Rows that state how near bodies are: the checker evaluates the points that the search for them found."""

from __future__ import annotations

import numpy as np
import pytest

from assur.planner.checker.claim.verdict import check_claim
from assur.planner.checker.verdict import Code
from assur.planner.claim import columns as c
from assur.planner.claim.distances import WITHIN_M
from assur.planner.claim.filling import claim_of, with_plan
from assur.planner.collision.nearest import nearest_at, pairs_of_pieces
from assur.planner.geometry.shapes import box, cylinder
from assur.planner.model.claims import Claims
from assur.planner.model.outcome import Leg, LegKind, Nearest, Plan
from assur.planner.model.phases import Phase
from assur.planner.trajectory import Trajectory
from tests.planner.cells import Shape, block, cell, go, stands
from tests.planner.checker.hand_made import no_rows

AT_M = 0.303792952090583
"""Where the post stands so that a direction of the search is level: its turn cancels that of the direction."""


@pytest.mark.parametrize("shape", [box(0.06, 0.06, 0.06), block(0.06, 0.06, 0.06)])
@pytest.mark.parametrize("off", [0.0, 1e-9, -1e-9, 1e-8, -1e-8, 1e-7, 1e-4, 0.1])
def test_the_checker_evaluates_the_points_that_the_search_found(shape: Shape, off: float) -> None:
    """Along a level direction both ends of an upright edge are equally far but for rounding. Its middle counts: for the
    search, too, which took one end, while the checker took the middle."""
    bodies = stands("block", shape, 0.0, 0.0, 0.2, 0.3), stands("post", cylinder(0.0125, 0.42), AT_M + off, 0.1, 0.25)
    scene = cell(go(0.35, 0.1), bodies=bodies)
    q = np.tile(scene.start.q, (2, 1))
    path = Trajectory(np.array([0.0, 1.0]), q, 0.0 * q, 0.0 * q)
    whole = Phase(path.start, path.end, LegKind.MOVE, 0)
    plan = Plan(path, (Leg(LegKind.MOVE, 0, path.start, path.end),), (), no_rows())
    base = claim_of(scene)
    arrangement = base.prover.of(whole)
    pieces = pairs_of_pieces(arrangement, [(arrangement.number["block"], arrangement.number["post"])])
    gap, _ = nearest_at(base.prover, arrangement, scene.start.q, 0.0, pieces)
    stated = Claims(pairs=(Nearest(gap, 0.0, ("block", "post"), whole.kind, gap),))
    (row,), claim = base.distances(plan, (whole,)).stated(stated), with_plan(base, plan, (whole,))
    for less, shown in ((0.0, True), (WITHIN_M - 1e-5, True), (WITHIN_M + 1e-6, False)):
        own = c.table("distances", [row])
        own[0, c.DISTANCE_MOST] -= less
        codes = [finding.code for finding in check_claim(claim._replace(distances=own)).findings]
        assert (Code.DISTANCE not in codes) == shown
