"""Rows for what an answer states are true where motions are sampled, and peaks and margins are reached."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from assur.planner.arrays import FloatArray
from assur.planner.claim import columns as c
from assur.planner.claim import filling
from assur.planner.claim.answer import with_answer
from assur.planner.claim.distances import WITHIN_M
from assur.planner.claim.joint_sums import MARGIN
from assur.planner.kernels.solids import FIRST, REQUIRED, SECOND
from assur.planner.model.phases import phases
from assur.planner.robots.facts import AHEAD
from assur.planner.robots.robot import Robot
from tests.planner.checker.statement.cases import Case, case_of
from tests.planner.checker.statement.test_answers import answered
from tests.planner.robots.families import NAMES, robot_named
from tests.planner.second_solids import carriers, place, support

CASES = ("demo", "five-bar", "rv-m1", "polar-arm", "heavy-casting", "parabolic-blend")
MANY = 4001
"""Instants at which a motion is sampled."""


def product(robot: Robot, row: FloatArray, q: FloatArray) -> FloatArray:
    """The scalar product (T,) that a row of `axes` is about, for joints q (T, n)."""
    p, r = robot.placements(q)
    link, other = (int(row[k]) for k in (c.AXIS_LINK, c.AXIS_OTHER))
    way = np.einsum("tij,j->ti", r[:, link], row[c.AXIS_ON : c.AXIS_OTHER])
    if row[c.AXIS_PLACE] == 1.0:
        way = way + p[:, link] - p[:, other]
    along = np.einsum("tij,j->ti", r[:, other], row[c.AXIS_DIRECTION : c.AXIS_LOW])
    return np.asarray((way * along).sum(-1))


def times(case: Case, row: FloatArray) -> FloatArray:
    """Instants of the interval of a row, and of the motion."""
    path = case.plan.trajectory
    t = np.linspace(path.start, path.end, MANY)
    return np.concatenate([row[:2], t[(t > row[0]) & (t < row[1])]])


@pytest.mark.parametrize("name", CASES)
def test_numbers_of_postures_keep_their_bounds(name: str) -> None:
    case, claim = answered(name)
    path, own = case.plan.trajectory, claim.axes[claim.axes[:, c.AXIS_OTHER] >= 0.0]
    assert len(own) > 2
    for row in own:
        found = product(case.scene.robot, row, path.evaluate(times(case, row)))
        assert (found >= row[c.AXIS_LOW] - 1e-12).all()
        assert (found <= row[c.AXIS_HIGH] + 1e-12).all()
    least = case.claims.singularity
    whole = own[(own[:, 0] == path.start) & (own[:, 1] == path.end)]
    assert least is not None
    assert len(whole) >= len(case.scene.robot.chain.bends) or (least[0] or 0.0) < MARGIN


@pytest.mark.parametrize("name", CASES)
def test_joints_keep_their_peaks_and_reach_them(name: str) -> None:
    case, claim = answered(name)
    path, limits = case.plan.trajectory, case.scene.robot.limits
    reached = set[tuple[int, int]]()
    for row in claim.sums[len(case.claim.sums) :]:
        (joint,), order = np.flatnonzero(row[c.SUM_SHARE : c.SUM_LOW]), int(row[c.SUM_ORDER])
        t = times(case, row)
        # at the end of an interval its own piece counts
        t = t[[0]] if row[0] == row[1] else t[t < row[1]]
        found = path.evaluate(t, order)[:, joint]
        slack = 1e-9 * float((limits.velocity, limits.acceleration, limits.jerk)[order - 1][joint])
        assert (found >= row[c.SUM_LOW] - slack).all()
        assert (found <= row[c.SUM_HIGH] + slack).all()
        if row[0] == row[1]:
            reached.add((int(joint), order))
    orders = range(1, 4) if case.scene.options.jerk_limited else range(1, 3)
    moves = {joint for joint in range(path.n) if np.ptp(path.q[:, joint]) > 1e-6}
    assert reached >= {(joint, order) for joint in moves for order in orders}


@pytest.mark.parametrize("name", CASES)
def test_the_tool_keeps_its_peaks_and_reaches_them(name: str) -> None:
    case, claim = answered(name)
    path, robot, h, instants = case.plan.trajectory, case.scene.robot, 1e-5, set[int]()

    def tool(t: FloatArray, tcp: FloatArray) -> FloatArray:
        p, r = robot.placements(path.evaluate(np.clip(t, path.start, path.end)))
        return np.asarray(p[:, -1] + np.einsum("tij,j->ti", r[:, -1], tcp))

    for row in claim.rates[len(case.claim.rates) :]:
        order, tcp, t = int(row[c.RATE_ORDER]), row[c.RATE_POINT : c.RATE_FRAME], times(case, row)
        t = np.clip(t, path.start + h, path.end - h)
        if path.jumps and order == 2:
            t = t[np.abs(t[:, None] - path.time).min(axis=1) > h]
        one, here, other = (tool(t + k * h, tcp) for k in (-1.0, 0.0, 1.0))
        way = (other - one) / (2.0 * h) if order == 1 else (other - 2.0 * here + one) / h**2
        size = np.linalg.norm(way, axis=-1)
        assert (size <= row[c.RATE_MOST] + 1e-3).all()
        assert (size >= row[c.RATE_LEAST] - 1e-3 * (1.0 + row[c.RATE_LEAST])).all()
        if row[0] == row[1] and row[c.RATE_LEAST] > 0.0:
            instants.add(order)
    assert instants == {1, 2}


def farthest(case: Case, row: FloatArray, side: int, claim: c.Claim) -> FloatArray:
    """The point (3,) of a piece that a row of `distances` gives, by the tables of the claim."""
    p, body = int(row[c.DISTANCE_PHASE]), int(row[c.DISTANCE_BODY + side])
    seat = claim.seats[int(claim.seated[p, body])]
    t, path = np.array([row[c.DISTANCE_TIME]]), case.plan.trajectory
    where = carriers(case.scene, path.evaluate(np.clip(t, path.start, path.end)), t)
    links = len(case.scene.robot.links)
    k = int(seat[1]) if seat[1] >= 0 else links + int(seat[2])
    turn, at = where.rotation[0, k], where.position[0, k]
    x, y, z, yaw = seat[c.SEAT_POSE :]
    own = np.array([[math.cos(yaw), -math.sin(yaw), 0.0], [math.sin(yaw), math.cos(yaw), 0.0], [0.0, 0.0, 1.0]])
    at, turn = at + turn @ np.array([x, y, z]), turn @ own
    piece = claim.pieces[int(claim.bodies[body, 0] + row[c.DISTANCE_PIECE + side])]
    total = np.zeros(3)
    for weight, way in zip(
        row[c.DISTANCE_WEIGHT : c.DISTANCE_DIRECTION], row[c.DISTANCE_DIRECTION :].reshape(4, 3), strict=True
    ):
        if weight == 0.0:
            continue
        n = (1.0 - 2.0 * side) * way / np.linalg.norm(way)
        u, first, many = n @ turn, int(piece[c.PIECE_VERTEX]), int(piece[c.PIECE_VERTICES])
        corners = claim.vertices[first : first + many]
        point = piece[c.PIECE_CENTRE : c.PIECE_AXIS].copy() if not many else corners[int(np.argmax(corners @ u))].copy()
        for edge in piece[c.PIECE_EDGE :].reshape(-1, 3)[: int(piece[c.PIECE_EDGES])]:
            point += np.sign(u @ edge) * edge
        across = u - (u @ piece[c.PIECE_AXIS : c.PIECE_DISC]) * piece[c.PIECE_AXIS : c.PIECE_DISC]
        if piece[c.PIECE_DISC] > 0.0:
            point += piece[c.PIECE_DISC] * across / np.linalg.norm(across)
        total += weight * (at + turn @ (point + piece[c.PIECE_BALL] * u))
    return total


@pytest.mark.parametrize("name", CASES)
def test_points_of_bodies_are_as_near_as_is_stated(name: str) -> None:
    case, claim = answered(name)
    assert len(claim.distances)
    for row in claim.distances:
        assert row[c.DISTANCE_WEIGHT : c.DISTANCE_DIRECTION].sum() == pytest.approx(1.0, abs=1e-12)
        one, other = (farthest(case, row, side, claim) for side in (0, 1))
        assert np.linalg.norm(other - one) <= row[c.DISTANCE_MOST] - 1e-5


@pytest.mark.parametrize("name", CASES)
def test_rows_of_the_second_distance_cover_all_pairs_and_hold(name: str) -> None:
    case, claim = answered(name)
    base, of_plan = filling.claim_of(case.scene), phases(case.scene, case.plan.legs, case.plan.arrivals)
    number = base.cell.carriers.body
    arm, placed = claim.required[0, c.REQUIRED_NEAREST :]
    for p, phase in enumerate(of_plan):
        arrangement = base.prover.of(phase)
        pairs = base.prover.pairs(arrangement, phase).rows
        within = (claim.gap_rows[:, 0] >= phase.t0) & (claim.gap_rows[:, 1] <= phase.t1)
        rows = claim.gap_rows[within]
        for pair in pairs[pairs[:, REQUIRED] >= 0.0]:
            names = [arrangement.names[arrangement.body[int(pair[k])]] for k in (FIRST, SECOND)]
            own = rows[[set(row[c.ROW_BODY : c.ROW_PIECE]) == {number[each] for each in names} for row in rows]]
            # rows of whole bodies, or of pieces, in turn: they reach from begin to end
            assert own[:, 0].min() == phase.t0, (p, names)
            assert own[:, 1].max() == phase.t1, (p, names)
    for row in claim.gap_rows[:: max(1, len(claim.gap_rows) // 60)]:
        p = int(np.searchsorted(claim.phases[:, 0], row[0], side="right")) - 1
        arrangement, at = base.prover.of(of_plan[p]), np.linspace(row[0], row[1], 3)
        path, names, bodies = case.plan.trajectory, list(number), row[c.ROW_BODY : c.ROW_PIECE].astype(int)
        where = carriers(case.scene, path.evaluate(np.clip(at, path.start, path.end)), at)
        reaches = list[FloatArray]()
        for k, sign in ((0, 1.0), (1, -1.0)):
            units = list(arrangement.pieces(arrangement.number[names[bodies[k]]]))
            piece = int(row[c.ROW_PIECE + k])
            n = sign * np.tile(row[c.ROW_NORMAL :] / np.linalg.norm(row[c.ROW_NORMAL :]), (3, 1, 1))
            # the box that holds all pieces reaches as far as each of them at least
            placed_there = [place(arrangement, where, np.arange(3), np.full(3, unit))
                            for unit in (units if piece < 0 else [units[piece]])]  # fmt: skip
            reaches.append(np.max([support(x, n)[:, 0] + (x.centre * n[:, 0]).sum(-1) for x in placed_there], axis=0))
        on_links = claim.seats[claim.seated[p, bodies].astype(int), c.SEAT_LINK] >= 0.0
        assert (-reaches[0] - reaches[1] >= (arm if on_links.any() else placed) - 1e-9).all()


@pytest.mark.parametrize("name", NAMES)
def test_the_bends_of_an_arm_are_its_margin_and_their_signs_its_mode(name: str) -> None:
    robot, rng = robot_named(name), np.random.default_rng(1)
    chain, seen = robot.chain, set[int]()
    q = rng.uniform(robot.limits.lower, robot.limits.upper, (2000, len(robot.joints)))
    mode, margin = robot.mode_of(q), robot.margin(q)
    q, mode, margin = q[mode >= 0], mode[mode >= 0], margin[mode >= 0]
    on = [(0.0, 0.0, 0.0) if b.length > 0.0 else AHEAD for b in chain.bends]
    rows = [(0.0, 0.0, b.link, float(b.length > 0.0), *axis, b.other, *b.along, 0.0, 0.0)
            for b, axis in zip(chain.bends, on, strict=True)]  # fmt: skip
    found = [product(robot, np.array(row, dtype=float), q) / (b.length or 1.0)
             for row, b in zip(rows, chain.bends, strict=True)]  # fmt: skip
    assert np.min(np.abs(found), axis=0) == pytest.approx(margin, abs=1e-9)
    for k in range(len(q)):
        if margin[k] > 1e-6:
            assert tuple(np.sign([each[k] for each in found]).astype(int)) == chain.signs[mode[k]]
            seen.add(int(mode[k]))
    assert seen == set(range(len(robot.modes)))


def test_a_clearance_that_is_not_kept_has_no_rows_for_its_phase() -> None:
    case = case_of("demo")
    said = case.claims.nearest
    assert said is not None
    assert said[0] is not None
    too_large = replace(case.claims, nearest=(replace(said[0], gap_m=said[0].gap_m + 0.01),))
    base, of_plan = filling.claim_of(case.scene), phases(case.scene, case.plan.legs, case.plan.arrivals)
    claim = with_answer(base, case.claim, case.plan, of_plan, too_large)
    then = next(phase for phase in of_plan if phase.t0 <= said[0].time <= phase.t1)
    assert claim.required[0, c.REQUIRED_NEAREST] == said[0].gap_m + 0.01 - WITHIN_M
    assert not ((claim.gap_rows[:, 0] < then.t1) & (claim.gap_rows[:, 1] > then.t0)).any()
    assert len(claim.gap_rows)
