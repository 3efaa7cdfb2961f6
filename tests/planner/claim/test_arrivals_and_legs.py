"""Rows about arrivals and legs are true where motions are sampled, and errors where what is uncertain is drawn."""

from __future__ import annotations

import numpy as np
import pytest

from assur.planner.arrays import FloatArray
from assur.planner.claim import columns as c
from assur.planner.frames.motion import Motion
from tests.planner.checker.statement.cases import Case, case_of

WAYS, TILTS, FLOW = "demo, straight ways", "rv-m1, straight way", "dense-flow, more uncertain"
GUIDED = {WAYS: 120, TILTS: 60, "circular-legs": 850, "bead-on-belt": 400, "scan-on-dial": 400}
"""Cases with guides, and how many rows these have at most."""
WITH_SUMS = ("shutter", "standard-cycle", "tray", "carton", WAYS, TILTS)
UNCERTAIN = (FLOW, "demo, more uncertain", "belt-to-belt", "bead-on-belt", "elbow-arm", "five-bar", "rv-m1", WAYS)
DRAWS = 4000
ROUNDED = 1e-12


def turned(yaw: FloatArray, points: FloatArray) -> FloatArray:
    """Points (T, 3) turned about the vertical by yaws (T,)."""
    cosine, sine = np.cos(yaw), np.sin(yaw)
    x, y, z = points.T
    return np.stack([cosine * x - sine * y, sine * x + cosine * y, z], axis=1)


def on_link(case: Case, link: float, point: FloatArray, q: FloatArray) -> FloatArray:
    """A point (3,) of a link of the robot in the world, (T, 3), for joints (T, n)."""
    p, r = case.scene.robot.placements(q)
    row = int(link)
    return np.asarray(p[:, row] + r[:, row] @ point)


def frame(case: Case, number: float, t: FloatArray) -> Motion:
    """The motion of a frame at times (T,)."""
    return list(case.scene.frames.values())[int(number)].law.motion(t)


def instants(row: FloatArray, many: int = 33) -> FloatArray:
    """Times of the interval of a row; in an interval its own piece counts at its end."""
    return np.linspace(row[0], row[1], many)[: -1 if row[1] > row[0] else None]


@pytest.mark.parametrize("name", GUIDED)
def test_the_tool_is_near_its_guides(name: str) -> None:
    case = case_of(name)
    path, rows = case.plan.trajectory, case.claim.guides
    assert 10 < len(rows) <= GUIDED[name]
    for row in rows:
        t = np.linspace(row[0], row[1], 17)
        share = np.linspace(row[c.GUIDE_SHARE], row[c.GUIDE_SHARE + 1], 17)[:, None]
        ends = []
        for k, first in enumerate((c.GUIDE_FROM, c.GUIDE_TO)):
            at = frame(case, row[c.GUIDE_FRAME + k], t)
            ends.append(at.p + turned(at.yaw, np.tile(row[first : first + 3], (17, 1))))
        tool = on_link(case, row[c.GUIDE_LINK], row[c.GUIDE_TOOL : c.GUIDE_FRAME], path.evaluate(t))
        off = np.linalg.norm(tool - ends[0] - share * (ends[1] - ends[0]), axis=1)
        assert (off <= row[c.GUIDE_MOST]).all()


@pytest.mark.parametrize("name", WITH_SUMS)
def test_sums_of_joints_keep_their_bounds(name: str) -> None:
    case = case_of(name)
    assert len(case.claim.sums) > 3
    for row in case.claim.sums:
        found = case.plan.trajectory.evaluate(instants(row), int(row[c.SUM_ORDER]))
        value = found @ row[c.SUM_SHARE : c.SUM_LOW][: found.shape[1]]
        assert (row[c.SUM_LOW] + 5e-9 <= value).all()
        assert (value <= row[c.SUM_HIGH] - 5e-9).all()


@pytest.mark.parametrize("name", [WAYS, "standard-cycle", "transfer"])
def test_arches_are_as_high_and_yaws_are_kept_as_rows_say(name: str) -> None:
    case = case_of(name)
    rows = case.claim.axes[case.claim.axes[:, c.AXIS_OTHER] == -1.0]
    assert len(rows) == 2
    for row in rows:
        q = case.plan.trajectory.evaluate(instants(row))
        place = on_link(case, row[c.AXIS_LINK], row[c.AXIS_ON : c.AXIS_OTHER], q)
        if not row[c.AXIS_PLACE]:
            place = place - on_link(case, row[c.AXIS_LINK], np.zeros(3), q)
        value = place @ row[c.AXIS_DIRECTION : c.AXIS_LOW]
        assert (row[c.AXIS_LOW] + 5e-9 <= value).all()
        assert (value <= row[c.AXIS_HIGH] - 5e-9).all()


@pytest.mark.parametrize("name", ["bead-on-belt", "scan-on-dial"])
def test_the_tool_has_the_speed_of_a_trace_in_its_frame(name: str) -> None:
    case, h = case_of(name), 1e-5
    (row,) = case.claim.rates[case.claim.rates[:, c.RATE_ORDER] == 1.0]
    t = np.linspace(row[0] + h, row[1] - h, 2001)

    def seen(times: FloatArray) -> FloatArray:
        at = frame(case, row[c.RATE_FRAME], times)
        q = case.plan.trajectory.evaluate(times)
        return turned(-at.yaw, on_link(case, row[c.RATE_LINK], row[c.RATE_POINT : c.RATE_FRAME], q) - at.p)

    speed = np.linalg.norm(seen(t + h) - seen(t - h), axis=1) / (2.0 * h)
    assert row[c.RATE_LEAST] <= speed.min()
    assert speed.max() <= row[c.RATE_MOST]


def drawn_errors(case: Case, row: FloatArray, rng: np.random.Generator) -> tuple[FloatArray, FloatArray]:
    """Errors (N, 3) of the point of a row, m, and of its yaw (N,), rad, for what is uncertain drawn N times: within its
    bounds, and at them."""
    claim, phase, own = case.claim, int(row[c.ERROR_PHASE]), int(row[c.ERROR_FRAME])
    path, required, count = case.plan.trajectory, case.claim.required[0], len(case.claim.frames)

    def signs() -> FloatArray:
        return np.where(rng.random(DRAWS) < 0.7, rng.choice([-1.0, 1.0], DRAWS), rng.uniform(-1.0, 1.0, DRAWS))

    def flat(amount: float) -> FloatArray:
        angle = rng.uniform(0.0, 2.0 * np.pi, DRAWS)
        return amount * np.stack([np.cos(angle), np.sin(angle), np.zeros(DRAWS)], axis=1)

    point, tool = row[c.ERROR_TARGET : c.ERROR_OFF], row[c.ERROR_TOOL : c.ERROR_TARGET]
    late = (signs() + 1.0) / 2.0
    shift = claim.frames[own, [c.FRAME_SHIFT, c.FRAME_SHIFT + 1]]
    first, last = -shift[1], required[c.REQUIRED_LATE] - shift[0]
    at = frame(case, own, row[c.ERROR_TIME] + first + late * (last - first))
    yaw = signs() * claim.frames[own, c.FRAME_YAW]
    place = at.p + turned(at.yaw + yaw, np.tile(point[:3], (DRAWS, 1)))
    lasts = max(row[c.ERROR_TIME] + required[c.REQUIRED_LATE] - required[c.REQUIRED_SINCE], 0.0)
    for each in claim.displaced:
        number = int(each[c.DISPLACED_FRAME])
        amount = each[c.DISPLACED_AMOUNT] + each[c.DISPLACED_GROWTH] * lasts
        share = np.zeros(DRAWS)
        if each[c.DISPLACED_SHARED]:
            low, high = claim.shares[phase, number], claim.shares[phase, count + number]
            share = low + (signs() + 1.0) / 2.0 * (high - low)
        way = amount * signs()[:, None] * each[c.DISPLACED_DIRECTION : c.DISPLACED_AMOUNT]
        way = flat(amount) if each[c.DISPLACED_LEVEL] else way
        place = place + ((number == own) - share)[:, None] * way
    off = row[c.ERROR_OFF : c.ERROR_ARM]
    place = place + flat(off[0]) + np.outer(signs() * off[1], [0.0, 0.0, 1.0])
    q = np.tile(path.evaluate(row[c.ERROR_TIME]), (DRAWS, 1))
    lagging = q + np.stack([signs() * lag for lag in required[c.REQUIRED_LAG :][: path.n]], axis=1)
    hand = on_link(case, row[c.ERROR_LINK], tool[:3], lagging)
    yaws = yaw + signs() * off[2] + at.yaw - frame(case, own, row[[c.ERROR_TIME]]).yaw
    if "yaw" in case.scene.robot.coordinates:
        yaws = yaws - (case.scene.robot.forward(lagging)[1] - case.scene.robot.forward(q)[1])
    return place - hand, np.abs(np.remainder(yaws + np.pi, 2.0 * np.pi) - np.pi)


@pytest.mark.parametrize("name", UNCERTAIN)
def test_no_error_is_larger_than_its_row_says_and_some_come_near_it(name: str) -> None:
    case, rng = case_of(name), np.random.default_rng(5)
    assert [row[c.ERROR_TIME] for row in case.claim.errors] == [each.until for each in case.plan.arrivals]
    for row in case.claim.errors:
        error, yaw = drawn_errors(case, row, rng)
        size = np.linalg.norm(error, axis=1) + yaw * row[c.ERROR_ARM]
        most = size.max(), np.hypot(error[:, 0], error[:, 1]).max(), np.abs(error[:, 2]).max(), yaw.max()
        assert (np.array(most) <= row[c.ERROR_FAR :] + ROUNDED).all()
        # what is drawn comes near what is stated, but for the reserves of the planner
        assert most[0] >= 0.8 * (row[c.ERROR_FAR] - 1e-5)
