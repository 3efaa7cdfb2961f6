"""Plans that nobody but this test makes: right ones are right up to their bounds, and not beyond."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from assur.planner.arrays import FloatArray
from assur.planner.checked import check
from assur.planner.checker import Code, Verdict
from assur.planner.collision.proof import Prover
from assur.planner.laws import Pose, conveyor
from assur.planner.model.outcome import Plan
from assur.planner.model.phases import phases
from assur.planner.model.scene import Scene, Window
from assur.planner.trajectory import Trajectory
from tests.planner.checker.hand_made import (
    asking,
    belt_case,
    crossing_case,
    frame,
    proved,
    sealed,
    with_rows,
)
from tests.planner.second_solids import carriers, gaps, place, standing


def codes(scene: Scene, plan: Plan) -> set[Code]:
    verdict = check(scene, plan)
    assert verdict.ok == (not verdict.findings)
    return {finding.code for finding in verdict.findings}


def with_knot_at(plan: Plan, t: float) -> tuple[Plan, int]:
    """The same motion with a knot more, and its number."""
    path = plan.trajectory
    number = int(path.time.searchsorted(t))
    columns = zip((path.time, path.q, path.qd, path.qdd), (np.array(t), *path.state(t)), strict=True)
    return replace(plan, trajectory=Trajectory(*(np.insert(old, number, new, axis=0) for old, new in columns))), number


@pytest.mark.parametrize("case", [crossing_case, belt_case])
def test_a_right_plan_is_right(case: Callable[[], tuple[Scene, Plan]]) -> None:
    assert check(*case()) == Verdict(True, ())


def test_the_same_motion_with_more_knots_is_right() -> None:
    scene, plan = crossing_case()
    more, _ = with_knot_at(plan, 0.3)
    assert codes(scene, sealed(scene, more)) == set()


def gap(scene: Scene, plan: Plan, row: int, normal: FloatArray, t: FloatArray) -> float:
    """The least gap along a normal, at times (T,), of the bodies or pieces that a row of the certificate is of."""
    c, arrangement = plan.certificate, Prover(scene).of(phases(scene, plan.legs, plan.arrivals)[0])
    where, at, along = carriers(scene, standing(plan.trajectory, t), t), np.arange(len(t)), normal[None, None]
    sides = []
    for number, piece in ((c.first[row], c.first_piece[row]), (c.second[row], c.second_piece[row])):
        units = list(arrangement.pieces(arrangement.number[c.names[number]]))
        sides.append([place(arrangement, where, at, np.full(len(t), unit)) for unit in units[slice(*pick(piece))]])
    return min(float(gaps(one, other, np.tile(along, (len(t), 1, 1))).min()) for one in sides[0] for other in sides[1])


def pick(piece: int) -> tuple[int | None, int | None]:
    """The ends of the slice of one piece, or of all pieces (-1)."""
    return (None, None) if piece < 0 else (piece, piece + 1)


def test_one_row_may_do_for_many_and_no_row_for_what_it_does_not_part() -> None:
    """Rows last the whole of their phase, along some other normal: the checker halves them itself, or refuses them."""
    scene, plan = crossing_case()
    rng = np.random.default_rng(3)
    c, kept = plan.certificate, set()
    for i in np.flatnonzero((c.second >= 0) & (c.t0 < plan.legs[-1].t1)).tolist():
        leg = next(leg for leg in plan.legs if leg.t0 <= c.t0[i] < leg.t1)
        t0, t1, normal = c.t0.copy(), c.t1.copy(), c.normal.copy()
        t0[i], t1[i] = leg.t0, leg.t1
        normal[i] += rng.normal(size=3) * rng.choice([0.0, 0.3, 1.0])
        normal[i] /= np.linalg.norm(normal[i])
        found = codes(scene, with_rows(scene, plan, t0=t0, t1=t1, normal=normal))
        least = gap(scene, plan, i, normal[i], np.linspace(leg.t0, leg.t1, 200))
        if least < 0.003:
            assert found == {Code.ROW}
        elif least > 0.0035:
            assert found == set()
        kept.add(least < 0.003)
    assert kept == {True, False}


def test_a_knot_that_breaks_a_limit_only_between_samples_is_found() -> None:
    """Both knots of a short piece are at rest, and the joint is faster than allowed between them."""
    scene, plan = crossing_case()
    plan, knot = with_knot_at(plan, 0.05)
    line = plan.trajectory
    time = np.insert(line.time, knot + 1, line.time[knot] + 0.01)
    knots = {"q": line.q, "qd": line.qd, "qdd": line.qdd}
    columns = {name: np.insert(states, knot + 1, states[knot], axis=0) for name, states in knots.items()}
    columns["q"][knot + 1 :, 3] += 0.22
    quick = sealed(scene, replace(plan, trajectory=Trajectory(time, *columns.values())))
    # Greatest speed of a quintic from rest to rest: 15/8 of the mean, 41.25 rad/s against 40.
    (fast,) = (f for f in check(scene, quick).findings if f.code is Code.LIMIT)
    assert fast.what.startswith("joint theta4")
    assert float(fast.where.removesuffix(" s")) == pytest.approx(line.time[knot], abs=1e-9)


def known_until(end: float) -> Callable[[Scene], Scene]:
    """A belt that is known until a time. It bears a neighbour up to the end of the standstill, at 2.96 s."""
    belt = frame("belt", conveyor(Pose(0.0, 0.28), 0.1, valid=(-1.0, end)))
    return lambda scene: replace(scene, frames={**scene.frames, "belt": belt})


def pulled(share: float) -> Callable[[Scene], Scene]:
    """A held part may accelerate so much as a share of what it does, by samples."""

    def change(scene: Scene) -> Scene:
        plan, robot = belt_case()[1], scene.robot
        t = np.linspace(plan.arrivals[0].until, plan.arrivals[1].until, 200_001)[:-1]
        state: Any = tuple(plan.trajectory.evaluate(t, order) for order in range(4))
        motion = robot.link_motion(robot.links.index("flange"), *state).at(scene.tool.tcp)
        return replace(scene, carry_acceleration=share * float(np.sqrt((motion.a**2).sum(-1)).max()))

    return change


def ending(later: float) -> Callable[[Scene], Scene]:
    """The motion must have ended so much later than it does, s."""

    def change(scene: Scene) -> Scene:
        end = belt_case()[1].trajectory.end + later
        return replace(scene, options=replace(scene.options, latest_end_s=end))

    return change


def within(step: int, **window: tuple[float, float]) -> Callable[[Scene], Scene]:
    """Tracking lasts from 0.7 to 0.8 s; the part is then 0.03 to 0.02 m before the conveyor's pose."""
    return lambda scene: asking(scene, step, window=Window(**window))


BOUNDS: dict[str, tuple[Callable[[Scene], Scene], Code | None]] = {
    "a window in time that fits": (within(0, time=(0.7, 0.8)), None),
    "a window in time that closes early": (within(0, time=(0.0, 0.75)), Code.WINDOW),
    "a window in time that opens late": (within(0, time=(0.71, 2.0)), Code.WINDOW),
    "a window along the belt that fits": (within(0, along=(-0.03, -0.02)), None),
    "a window along the belt that closes early": (within(0, along=(-0.2, -0.025)), Code.WINDOW),
    "a window along what is no belt": (within(1, along=(-1.0, 1.0)), Code.WINDOW),
    "a law that ends later": (known_until(2.97), None),
    "a law that ends 10 ms early": (known_until(2.95), Code.LAW),
    "a law that ends while it is followed": (known_until(0.75), Code.LAW),
    "a pull that is allowed": (pulled(1.0001), None),
    "a pull that is too hard": (pulled(0.9999), Code.RATE),
    "an end in time": (ending(0.0), None),
    "an end 1 ms late": (ending(-1e-3), Code.END),
}


@pytest.mark.parametrize("name", BOUNDS)
def test_what_is_asked_is_kept_up_to_its_bound_and_not_beyond(name: str) -> None:
    scene, plan = belt_case()
    change, found = BOUNDS[name]
    asked = codes(change(scene), plan)
    assert found in asked if found else asked == set()


def test_a_wait_in_which_the_arm_moves_is_found() -> None:
    scene, plan = crossing_case()
    wait, up, there = plan.legs
    longer = (replace(wait, t1=0.12), replace(up, t0=0.12), there)
    assert codes(scene, proved(scene, plan.trajectory, longer, plan.arrivals)) == {Code.JOINTS}


def test_legs_that_leave_a_gap_overlap_or_miss_the_end_are_found() -> None:
    scene, plan = crossing_case()
    wait, up, there = plan.legs
    for legs in (
        (replace(wait, t1=0.09), up, there),
        (wait, replace(up, t0=np.nextafter(up.t0, 0)), there),
        (wait, up, replace(there, t1=0.9)),
        (wait, there, up),
    ):
        assert Code.LEGS in codes(scene, sealed(scene, replace(plan, legs=legs)))
