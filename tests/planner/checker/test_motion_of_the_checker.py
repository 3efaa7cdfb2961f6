"""The checker's own kinematics and laws: the places and rates of the robots' and laws' own, and bounds that hold."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray
from assur.planner.checker import jets
from assur.planner.checker.laws import tables
from assur.planner.checker.motion import Tables, all_jets, carry
from assur.planner.kernels.columns.laws import PERIOD
from assur.planner.laws import (
    Change,
    Law,
    Pose,
    conveyor,
    fixed,
    indexer,
    keyframes,
    linear,
    oscillation,
    swing,
    turntable,
)
from assur.planner.model.link_frames import link_law
from assur.planner.model.scene import Scene
from assur.planner.trajectory import Trajectory
from assur.scenes.requests import scene_of, shipped
from tests.planner.checker.hand_made import arm, crossing, frame
from tests.planner.laws.laws import Case, cases, samples

ARMS = ("demo", "shut-gate", "elbow-arm", "polar-arm", "rv-m1", "five-bar-type-2")
RAMPS = (Change(0.4, 0.0, 0.8, 6.0), Change(1.8, -0.3, 0.5, math.inf), Change(3.0, 0.1, 2.0, 40.0))
POSE = Pose(0.3, -0.2, 0.1, 0.7)
KEYS = (Pose(0, 0, 0, 0), Pose(0.3, 0.1, 0.2, 2.0), Pose(0.1, -0.2, 0.1, -1.0), Pose(0.2, 0.2, 0.0, 0.5))
LAWS: dict[str, Law] = {
    "fixed": fixed(POSE),
    "linear": linear(POSE, (0.1, -0.2, 0.05), 0.3),
    "conveyor": conveyor(POSE, 0.25, (), 7.0),
    "conveyor that stops and runs back": conveyor(POSE, 0.25, RAMPS, 0.9),
    "conveyor seen after its ramps": conveyor(POSE, 0.25, RAMPS, 9.0),
    "dial": turntable(POSE, 0.8, 0.02, RAMPS, -2.0),
    "indexer that turns": indexer(POSE, 0.7, 0.3, 0.25, "turn", 0.1),
    "indexer that travels without a dwell": indexer(POSE, 0.2, 0.4, 0.0, "travel", 5.1),
    "swing": swing(POSE, 0.9, 1.3, 0.4),
    "shutter": oscillation(POSE, (0.0, 0.0, 1.0), 0.3, 0.9, -0.6),
    "shaker, askew": oscillation(POSE, (0.3, -0.9, 0.1), -0.02, 0.11, 2.0),
    "keyframes that repeat": keyframes([0.1, 0.7, 0.8, 1.4], (*KEYS[:3], KEYS[0]), "periodic"),
    "keyframes that repeat and turn": keyframes([5.1, 5.7, 6.4], (*KEYS[:2], Pose(yaw=2.0 * math.pi)), "periodic"),
    "two keyframes that turn on": keyframes([0.0, 0.6], (KEYS[0], Pose(yaw=-4.0 * math.pi)), "periodic"),
    "keyframes": keyframes([0.0, 0.7, 1.1, 3.5], KEYS, "clamped"),
    "natural keyframes": keyframes([-0.2, 0.7, 1.1, 3.5], KEYS, "natural"),
    "neighbour": link_law(
        arm(),
        Trajectory(
            np.array([0.5, 1.0, 1.7]),
            np.array([[0.1, 0.5, 0.1, 0.0], [0.4, -0.2, 0.2, 1.0], [0.3, 0.1, 0.15, 0.2]]),
            np.array([[0.0] * 4, [0.3, 0.1, 0.0, -0.2], [0.0] * 4]),
            np.array([[0.0] * 4, [1.0, -2.0, 0.5, 1.0], [0.0] * 4]),
        ),
        4,
    ),
}
UNTIL = 3.4


def wandering(scene: Scene, seed: int) -> Trajectory:
    """A motion around the start, from rest to rest."""
    rng, n = np.random.default_rng(seed), len(scene.robot.joints)
    width = (scene.robot.limits.upper - scene.robot.limits.lower) * 0.02
    q = scene.start.q + np.cumsum(rng.normal(size=(5, n)), 0) * width
    qd, qdd = rng.normal(size=(5, n)) * width * 5, rng.normal(size=(5, n)) * width * 20
    qd[[0, -1]] = qdd[[0, -1]] = 0.0
    return Trajectory(scene.start.time + np.cumsum([0.0, 0.1, 0.25, 0.07, 0.2]), q, qd, qdd)


def carried(found: Tables, links: int, c: int, t0: float, t1: float) -> FloatArray | None:
    """The jets (JETS, 6) of a carrier over [t0, t1]."""
    rows = all_jets(found) * np.nan
    known = carry(c if c >= links else 0, t0, t1, found, rows)
    return rows[c] if known else None


@pytest.mark.parametrize("name", ARMS)
def test_links_are_where_the_robot_has_them_and_move_as_it_says(name: str) -> None:
    scene = scene_of(shipped(name).request)
    robot, links = scene.robot, len(scene.robot.links)
    for seed in range(3):
        path = wandering(scene, seed)
        found = tables(scene, path, path.start, path.end)
        for t in np.random.default_rng(seed).uniform(path.start, path.end, 10):
            state = [path.evaluate(np.array(t), order) for order in range(4)]
            p, rotation = robot.placements(state[0])
            for link in range(links):
                own = carried(found, links, link, float(t), float(t))
                if own is None:
                    assert not np.isfinite(p).all()
                    continue
                motion = robot.link_motion(link, *state)
                assert np.abs(own[:3, 0] - p[link]).max() <= 1e-14
                assert np.abs(own[3:, 0].reshape(3, 3).T - rotation[link]).max() <= 1e-14
                assert np.abs(own[:3, 2] - motion.v).max() <= 1e-12
                assert np.abs(own[:3, 4] - motion.a).max() <= 1e-10


@pytest.mark.parametrize("name", sorted(LAWS))
def test_frames_are_where_their_laws_have_them_and_move_as_they_say(name: str) -> None:
    law = LAWS[name]
    scene = replace(crossing(), frames={**crossing().frames, "it": frame("it", law)})
    links, path = len(scene.robot.links), wandering(scene, 0)
    found = tables(scene, path, path.start, UNTIL)
    for t in (0.0, *np.random.default_rng(1).uniform(0.0, UNTIL, 60)):
        own, motion = carried(found, links, links + 2, float(t), float(t)), law.motion(np.array(t))
        assert own is not None
        assert np.abs(own[:3, 0] - motion.p).max() <= 1e-13
        assert np.abs(own[3:5, 0] - [math.cos(motion.yaw), math.sin(motion.yaw)]).max() <= 1e-13
        assert np.abs(own[:3, 2] - motion.v).max() <= 1e-12
        assert own[3, 0] * own[4, 2] - own[4, 0] * own[3, 2] == pytest.approx(float(motion.yaw_d), abs=1e-12)
        assert np.abs(own[:3, 4] - motion.a).max() <= 1e-9
        assert own[3, 0] * own[4, 4] - own[4, 0] * own[3, 4] == pytest.approx(float(motion.yaw_dd), abs=1e-9)


@pytest.mark.parametrize("name", [*ARMS, *sorted(LAWS)])
def test_bounds_over_intervals_hold_at_every_instant_that_is_looked_at(name: str) -> None:
    if name in LAWS:
        scene = replace(crossing(), frames={**crossing().frames, "it": frame("it", LAWS[name])})
        carriers = [len(scene.robot.links) + 2]
    else:
        scene = scene_of(shipped(name).request)
        carriers = list(range(len(scene.robot.links)))
    links, path = len(scene.robot.links), wandering(scene, 4)
    until = UNTIL if name in LAWS else path.end
    found, rng = tables(scene, path, path.start, until), np.random.default_rng(7)
    for h in (0.3, 0.05, 0.004):
        a = float(rng.uniform(path.start, until - h))
        for c in carriers:
            over = carried(found, links, c, a, a + h)
            if over is None:
                assert name == "five-bar-type-2"
                continue
            for t in np.linspace(a, a + h, 40)[:-1]:
                at = carried(found, links, c, float(t), float(t))
                assert at is not None
                for order in range(3):
                    slack = 1e-12 * (1 + np.abs(at[:, 2 * order]))
                    assert (over[:, 2 * order] <= at[:, 2 * order] + slack).all()
                    assert (over[:, 2 * order + 1] >= at[:, 2 * order] - slack).all()


def of_frame(law: Law, start: float, until: float) -> Callable[[float, float], FloatArray]:
    """The jets (JETS, 6) of a frame with this law over an interval, for a plan from `start` on."""
    scene = replace(crossing(), frames={**crossing().frames, "it": frame("it", law)})
    path = wandering(replace(scene, start=replace(scene.start, time=start)), 0)
    links, found = len(scene.robot.links), tables(scene, path, path.start, until)

    def jets_over(t0: float, t1: float) -> FloatArray:
        over = carried(found, links, links + 2, t0, t1)
        assert over is not None
        return over

    return jets_over


REPEATING = ("turn", "travel", "swing", "oscillation", "repeated")


@given(cases(REPEATING), st.integers(-(10**4), 10**4), st.lists(st.floats(-1, 1), min_size=3, max_size=3))
def test_what_repeats_is_where_the_law_has_it_at_every_seam_and_far_from_it(
    case: Case, rounds: int, where: list[float]
) -> None:
    """The checker's own polynomials, the law's own motion, and difference quotients of the checker's places."""
    law, step = case.law, 1e-4
    shift = rounds * (float(law.row[PERIOD]) or law.cycle_s or 0.0)
    seams = [shift + switch for switch in case.switches[:4]]
    beside = [seam + d for seam in seams for d in (-1e-9, 1e-9)]
    inside = [shift + 2.0 * w for w in where]
    over = of_frame(law, min([*beside, *inside]) - 3 * step, max([*beside, *inside]) + 3 * step)
    far = 1.0 + abs(shift)
    for t in (*seams, *beside, *inside):
        own, motion = over(t, t), law.motion(np.array(t))
        turn = np.array([math.cos(motion.yaw), math.sin(motion.yaw)])
        # to the rounding of the time, a thousandth of a nanosecond and what the law does in it
        assert np.abs(own[:3, 0] - motion.p).max() <= 1e-13 * far * (1 + np.abs(motion.v).max())
        assert np.abs(own[3:5, 0] - turn).max() <= 1e-13 * far * (1 + abs(float(motion.yaw_d)))
        assert np.abs(own[:3, 2] - motion.v).max() <= 1e-13 * far * (1 + np.abs(motion.a).max()) + 1e-10
        assert np.abs(own[:3, 4] - motion.a).max() <= 1e-12 * far * (1 + np.abs(motion.j).max()) + 1e-8
    for t in inside:
        if any(abs(t - seam - shift) <= 3 * step for seam in case.switches):
            continue
        at = [over(t + k * step, t + k * step)[:5, 0] for k in (-2, -1, 1, 2)]
        rate = (at[0] - 8 * at[1] + 8 * at[2] - at[3]) / (12 * step)
        scale = 1 + np.abs(over(t, t)[:5, 2:]).max()
        assert np.abs(rate - over(t, t)[:5, 2]).max() <= 1e-6 * scale * far


@given(cases(REPEATING), st.floats(-30, 30), st.sampled_from([0.0, 0.05, 0.7, 3.0, 25.0]))
def test_bounds_of_what_repeats_hold_over_no_period_and_over_many(case: Case, start: float, length: float) -> None:
    law, end = case.law, start + length
    over = of_frame(law, start, end + 1.0)(start, end)
    t = np.unique([*np.linspace(start, end, 400), *samples(Case(law, (start, end), case.switches), start, end, 2)])
    motion = law.motion(t)
    turned = np.stack([np.cos(motion.yaw), np.sin(motion.yaw)], axis=-1)
    for order, value in enumerate((np.hstack([motion.p, turned]), motion.v, motion.a)):
        own, slack = over[: value.shape[1], 2 * order : 2 * order + 2], 1e-10 * (1 + np.abs(value))
        assert (own[:, 0] <= value + slack).all()
        assert (own[:, 1] >= value - slack).all()
    if length >= 3.0:
        return
    # not much wider than the motion is
    width = over[:3, 3] - over[:3, 2]
    truth = np.ptp(motion.v, axis=0)
    assert (width <= truth + 40 * length * (1 + np.abs(motion.a).max(axis=0) + np.abs(motion.j).max()) + 1e-9).all()


def test_what_is_not_known_is_not_bounded() -> None:
    law = linear(POSE, (0.1, 0.0, 0.0), valid=(0.1, 2.0))
    scene = replace(crossing(), frames={**crossing().frames, "it": frame("it", law)})
    links, path = len(scene.robot.links), wandering(scene, 0)
    found = tables(scene, path, path.start, UNTIL)
    for t0, t1, known in (
        (0.1, 2.0, True),
        (0.0, 0.2, False),
        (1.9, 2.1, False),
        (0.05, 0.05, False),
        (1.0, 0.5, False),
    ):
        assert (carried(found, links, links + 2, t0, t1) is not None) == known


@given(st.lists(st.floats(-2, 2), min_size=6, max_size=6), st.floats(1e-3, 1.0))
def test_jets_of_products_waves_roots_and_inverses_hold(c: list[float], h: float) -> None:
    """Against the numbers themselves, with rates by complex steps and their differences."""

    def one(t: complex) -> complex:
        return c[0] + t * (c[1] + t * c[2])

    def other(t: complex) -> complex:
        return 5.0 + c[3] * c[3] + t * (c[4] + t * c[5]) / 4.0

    def polynomial(a: float, b: float, d: float) -> tuple[float, ...]:
        ends = [a, a + h * (b + h * d)]
        inner = -b / (2 * d) if d else -1.0
        values = [*ends, a + inner * (b + inner * d)] if 0 < inner < h else ends
        rates = (b, b + 2 * h * d)
        return min(values), max(values), min(rates), max(rates), 2 * d, 2 * d

    first, second = polynomial(c[0], c[1], c[2]), polynomial(5 + c[3] ** 2, c[4] / 4, c[5] / 4)
    cosine, sine = jets.turned(first)  # type: ignore[arg-type]
    cases: list[tuple[jets.Jet, Callable[[complex], complex]]] = [
        (jets.times(first, second), lambda t: one(t) * other(t)),  # type: ignore[arg-type]
        (cosine, lambda t: complex(np.cos(one(t)))),
        (sine, lambda t: complex(np.sin(one(t)))),
        (jets.inverse(second), lambda t: 1 / other(t)),  # type: ignore[arg-type]
        (jets.root(second), lambda t: complex(np.sqrt(other(t)))),  # type: ignore[arg-type]
        (jets.plus(jets.scaled(-3.0, first), second), lambda t: other(t) - 3 * one(t)),  # type: ignore[arg-type]
    ]
    for jet, f in cases:
        for t in np.linspace(0.0, h, 17):
            rate = [f(complex(x, 1e-30)).imag / 1e-30 for x in (t - 1e-6, t, t + 1e-6)]
            taken = (f(complex(t)).real, rate[1], (rate[2] - rate[0]) / 2e-6)
            for order, slack in ((0, 1e-13), (1, 1e-12), (2, 1e-6)):
                assert jet[2 * order] - slack * (1 + abs(taken[order])) <= taken[order]
                assert taken[order] <= jet[2 * order + 1] + slack * (1 + abs(taken[order]))
