"""Faults made on purpose in what claims state of arrivals and legs: guides, errors, sums, outer ends and arches."""

from __future__ import annotations

from typing import Any

import numpy as np

from assur.planner.checker.verdict import Code
from assur.planner.claim import columns as c
from assur.planner.claim.columns import Claim
from tests.planner.checker.statement.cases import Case
from tests.planner.checker.statement.faults import Fault, drop, plus, put, times

WAYS, TILTS, FLOW = "demo, straight ways", "rv-m1, straight way", "dense-flow, more uncertain"
T = Code


def outer_ends(case: Case) -> Any:
    """The rows of points that state how high the tool is at an instant."""
    return (case.claim.points[:, c.POINT_HEIGHT] >= 0.0) & (case.claim.points[:, c.POINT_T0] == case.claim.points[:, 1])


def sums(case: Case, order: int, *, lasting: bool) -> Any:
    """The rows of sums of an order, at instants or over intervals."""
    rows = case.claim.sums
    return (rows[:, c.SUM_ORDER] == order) & ((rows[:, c.SUM_T1] > rows[:, c.SUM_T0]) == lasting)


def one_chord(case: Case, first: int, last: int) -> Claim:
    """The claim in which one chord is stated in place of some that follow each other."""
    rows = case.claim.guides
    row = rows[first].copy()
    row[[c.GUIDE_T1, c.GUIDE_SHARE + 1]] = rows[last - 1, [c.GUIDE_T1, c.GUIDE_SHARE + 1]]
    row[c.GUIDE_TO : c.GUIDE_SHARE] = rows[last - 1, c.GUIDE_TO : c.GUIDE_SHARE]
    return case.claim._replace(guides=np.concatenate([rows[:first], row[None, :], rows[last:]]))


def other_times(case: Case, first: int, last: int, amount: float) -> Claim:
    """The claim in which some guides, one behind the other, meet at later times."""
    changed = put(case, "guides", slice(first, last), c.GUIDE_T1, plus(amount))
    changed.guides[first + 1 : last + 1, c.GUIDE_T0] += amount
    return changed


def back_and_forth(case: Case) -> Claim:
    """The claim in which a straight leg goes on, back and on again."""
    rows = case.claim.guides
    shares = [rows[4, c.GUIDE_SHARE + 1], rows[3, c.GUIDE_SHARE]]
    claim = put(case, "guides", 3, c.GUIDE_SHARE + 1, shares[0])
    claim.guides[4, [c.GUIDE_SHARE, c.GUIDE_SHARE + 1]] = shares
    claim.guides[5, c.GUIDE_SHARE] = shares[1]
    return claim


def aside(case: Case, row: int, far: float) -> Claim:
    """The claim in which two chords of a path meet aside from it."""
    claim = put(case, "guides", row, c.GUIDE_TO + 2, plus(far))
    claim.guides[row + 1, c.GUIDE_FROM + 2] += far
    return claim


FAULTS_OF_ARRIVALS: tuple[Fault, ...] = (
    # straight legs
    Fault("a guide less", WAYS, T.GUIDE, lambda k: drop(k, "guides", 5)),
    Fault("a wider line", WAYS, T.GUIDE, lambda k: put(k, "guides", 5, c.GUIDE_MOST, times(1.001))),
    Fault("a line 1 µm aside", WAYS, T.GUIDE, lambda k: put(k, "guides", slice(None), c.GUIDE_TO + 1, plus(1e-6))),
    Fault("a line from elsewhere", WAYS, T.GUIDE, lambda k: put(k, "guides", 0, c.GUIDE_FROM, plus(1e-6))),
    Fault("a line to another frame", WAYS, T.GUIDE, lambda k: put(k, "guides", 3, c.GUIDE_FRAME + 1, plus(1.0))),
    Fault("a line of another link", WAYS, T.GUIDE, lambda k: put(k, "guides", 3, c.GUIDE_LINK, plus(-1.0))),
    Fault("a line that goes back", WAYS, T.GUIDE, back_and_forth),
    Fault("a line that is not gone to its end", WAYS, T.GUIDE, lambda k: put(k, "guides", -1, 15, times(0.99))),
    Fault("a line with a gap", WAYS, T.GUIDE, lambda k: put(k, "guides", 3, c.GUIDE_SHARE + 1, plus(-1e-6))),
    Fault("a line that ends early", WAYS, T.GUIDE, lambda k: put(k, "guides", -1, c.GUIDE_T1, plus(-1e-3))),
    # paths and traces
    Fault("a corner that is cut", "circular-legs", T.GUIDE, lambda k: one_chord(k, 10, 40)),
    Fault("a path 2 µm aside", "circular-legs", T.GUIDE, lambda k: aside(k, 20, 2e-6)),
    Fault("a wider path", "circular-legs", T.GUIDE, lambda k: put(k, "guides", 5, c.GUIDE_MOST, times(1.6))),
    Fault("half a chord", "circular-legs", T.GUIDE, lambda k: put(k, "guides", 5, c.GUIDE_SHARE + 1, 0.5)),
    Fault("a trace 1 ms late", "bead-on-belt", T.GUIDE, lambda k: other_times(k, 200, 210, 1e-3)),
    Fault("a trace that cuts an arc", "bead-on-belt", T.GUIDE, lambda k: one_chord(k, 300, 306)),
    Fault("a trace 1 µm aside", "bead-on-belt", T.GUIDE, lambda k: aside(k, 300, 1e-6)),
    Fault("a lead-in 20 µm aside", "bead-on-belt", T.GUIDE, lambda k: aside(k, 10, 2e-5)),
    Fault("a lead-out in one chord", "bead-on-belt", T.GUIDE, lambda k: one_chord(k, len(k.claim.guides) - 20, -1)),
    Fault("a slower trace", "bead-on-belt", T.RATE, lambda k: put(k, "rates", -1, c.RATE_LEAST, times(0.999))),
    Fault("a faster trace", "bead-on-belt", T.RATE, lambda k: put(k, "rates", -1, c.RATE_MOST, times(1.001))),
    Fault("a trace in another frame", "bead-on-belt", T.RATE, lambda k: put(k, "rates", -1, c.RATE_FRAME, 0.0)),
    Fault("a trace with any yaw", "bead-on-belt", T.POINT, lambda k: put(k, "points", 0, c.POINT_YAW, -1.0)),
    # outer ends of straight parts
    Fault("a shorter approach", WAYS, T.POINT, lambda k: put(k, "points", outer_ends(k), c.POINT_MIDDLE, plus(-1e-3))),
    Fault("no stop above", WAYS, T.POINT, lambda k: put(k, "points", outer_ends(k), slice(16, 18), -1.0)),
    # joints
    Fault("a wait in motion", "shutter", T.JOINTS, lambda k: put(k, "sums", 2, c.SUM_HIGH, plus(1e-6))),
    Fault("a wait that ends early", "shutter", T.JOINTS, lambda k: put(k, "sums", 2, c.SUM_T1, plus(-1e-3))),
    Fault("no rest", WAYS, T.JOINTS, lambda k: put(k, "sums", 1, c.SUM_LOW, -1.0)),
    Fault("no rest of a joint", WAYS, T.JOINTS, lambda k: drop(k, "sums", 1)),
    Fault("a via at which it stops", WAYS, T.JOINTS, lambda k: put(k, "sums", -1, c.SUM_LOW, 0.0)),
    # pitch and roll
    Fault("a pitch farther off", TILTS, T.JOINTS, lambda k: put(k, "sums", slice(None), c.SUM_HIGH, plus(1e-5))),
    Fault(
        "another pitch", TILTS, T.JOINTS, lambda k: put(k, "sums", sums(k, 0, lasting=False), slice(11, 13), plus(1e-5))
    ),
    Fault("a pitch that changes", TILTS, T.JOINTS, lambda k: put(k, "sums", sums(k, 1, lasting=False), 12, 1e-5)),
    Fault("a roll of other joints", TILTS, T.JOINTS, lambda k: put(k, "sums", slice(None), c.SUM_SHARE + 4, 0.5)),
    Fault("a way that leaves its chord", TILTS, T.JOINTS, lambda k: drop(k, "sums", -1)),
    Fault("a way beyond its end", TILTS, T.JOINTS, lambda k: put(k, "sums", -2, c.SUM_HIGH, plus(1e-5))),
    # arches and a yaw that is kept
    Fault("a lower arch", "standard-cycle", T.ARCH, lambda k: put(k, "axes", 0, c.AXIS_LOW, plus(-1e-5))),
    Fault("an arch without height", "standard-cycle", T.ARCH, lambda k: drop(k, "axes", 1)),
    Fault(
        "an arch that goes down first",
        "standard-cycle",
        T.ARCH,
        lambda k: put(k, "sums", sums(k, 1, lasting=True), c.SUM_LOW, plus(-0.5)),
    ),
    Fault("an arch no way up", "standard-cycle", T.ARCH, lambda k: drop(k, "sums", 3)),
    Fault("no top", "standard-cycle", T.ARCH, lambda k: drop(k, "sums", sums(k, 0, lasting=False))),
    Fault("a yaw that is not kept", WAYS, T.DIRECTION, lambda k: drop(k, "axes", 0)),
    Fault("a yaw that may be opposite", WAYS, T.DIRECTION, lambda k: drop(k, "axes", 1)),
    Fault("another yaw at first", WAYS, T.DIRECTION, lambda k: put(k, "axes", 0, c.AXIS_HIGH, 1e-5)),
    # errors
    Fault("an error less", FLOW, T.ERROR, lambda k: drop(k, "errors", 0)),
    Fault("a larger error", FLOW, T.ERROR, lambda k: put(k, "errors", 1, c.ERROR_FAR, plus(1e-6))),
    Fault("a larger error of the yaw", FLOW, T.ERROR, lambda k: put(k, "errors", 1, c.ERROR_YAW, plus(1e-6))),
    Fault("a part that is exact", FLOW, T.ERROR, lambda k: put(k, "errors", 1, c.ERROR_OFF, 0.0)),
    Fault("an error in another phase", FLOW, T.ERROR, lambda k: put(k, "errors", 1, c.ERROR_PHASE, plus(1.0))),
    Fault("an error at another time", FLOW, T.ERROR, lambda k: put(k, "errors", 1, c.ERROR_TIME, plus(1e-3))),
    Fault("an error in another frame", FLOW, T.ERROR, lambda k: put(k, "errors", 1, c.ERROR_FRAME, plus(1.0))),
    Fault("an error of another point", FLOW, T.ERROR, lambda k: put(k, "errors", 1, c.ERROR_TARGET, plus(1e-6))),
    Fault("an error of another place", FLOW, T.ERROR, lambda k: put(k, "errors", 1, c.ERROR_TOOL, plus(1e-6))),
    # vias that are missed
    Fault("a via farther off", "parabolic-blend", T.POINT, lambda k: put(k, "points", 0, c.POINT_POSITION, plus(1e-6))),
)
