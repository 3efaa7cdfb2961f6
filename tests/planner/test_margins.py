"""What a plan leaves: peaks, what binds, the smallest clearance."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray
from assur.planner.claim.columns import LINK, LINK_OFFSET
from assur.planner.collision.nearest import nearest
from assur.planner.collision.proof import Prover
from assur.planner.errors import FaultError
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import box
from assur.planner.kernels.links import CHAIN, LINKS
from assur.planner.kernels.postures import tool_peaks
from assur.planner.kernels.solids import REQUIRED
from assur.planner.laws import conveyor
from assur.planner.legs.limits import least_margins
from assur.planner.legs.tool_motion import tool_accelerations, tool_peak
from assur.planner.legs.tool_motion import tool_peaks as tool_peaks_of
from assur.planner.model.outcome import Clearances, LegKind, Margins, Planned
from assur.planner.model.phases import Phase, phases
from assur.planner.model.scene import Clearance, Tool
from assur.planner.pipeline import plan
from assur.planner.report.margins import contacts, reported
from assur.planner.trajectory import Trajectory
from tests.planner.cells import CRANKED, CUP, belt_and_dial, cell, frame, go, stands, table_to_table
from tests.planner.certificate.moving_ball import LAWS, SHAPES, encounter
from tests.planner.robots.five_bars import five_bar
from tests.planner.second_solids import carriers, distance_by_gjk, place


@settings(max_examples=50)
@given(st.integers(0, 10**6), st.sampled_from(SHAPES), st.sampled_from(LAWS), st.integers(1, 3))
def test_the_smallest_clearance_is_below_the_truth_by_no_more_than_a_twentieth_of_a_millimetre(
    seed: int, kind: str, how: str, pieces: int
) -> None:
    case = encounter(seed, kind, how, pieces)
    radius = max(0.002, case.nearest()[0] - 0.003)
    scene = case.scene(radius)
    found = nearest(Prover(scene), case.path, (case.phase(),))
    assert found is not None
    assert found.bodies == ("ball", "thing")
    there = float(case.apart(np.array([found.time]))[0]) - radius
    # what dense sampling finds is never below the truth, and by less than 10 µm above it
    least = max(0.0, case.nearest()[0] - radius)
    assert least - 5e-5 - 1e-5 <= found.gap_m <= least + 1e-9
    assert found.distance_m == pytest.approx(max(0.0, there), abs=1e-6)
    assert 0.0 <= found.distance_m - found.gap_m <= 5e-5


def test_allowed_contacts_are_not_the_smallest_clearance() -> None:
    q = np.array([0.3, 1.2, 0.15, 0.0])
    path = Trajectory(np.array([0.0, 1.0]), np.stack([q, q]), np.zeros((2, 4)), np.zeros((2, 4)))
    plate = stands("plate", box(2.0, 2.0, 0.02), 0.0, 0.0, 0.15 - 0.06 - 0.01)
    scene = cell(go(0.3, 0.0), bodies=(plate,), tool=CUP)
    phase = Phase(0.0, 1.0, LegKind.FOLLOW, 0)
    found = nearest(Prover(scene), path, (phase,))
    assert found is not None
    assert found.bodies == ("cup", "plate")
    assert found.gap_m == pytest.approx(0.0, abs=1e-12)
    touching = replace(phase, contacts=frozenset({("cup", "plate")}))
    found = nearest(Prover(scene), path, (touching,))
    assert found is not None
    assert found.bodies == ("quill", "plate")
    assert found.gap_m == pytest.approx(0.06)
    assert found.phase is LegKind.FOLLOW


def test_with_nothing_around_there_is_no_smallest_clearance() -> None:
    outcome = plan(cell(go(0.35, -0.2)))
    assert isinstance(outcome, Planned)
    assert outcome.margins.nearest is None


def test_peaks_are_those_of_the_dense_samples_and_the_largest_ratio_binds() -> None:
    scene = cell(go(0.35, -0.2), go(0.2, 0.4, name="b"))
    outcome = plan(scene)
    assert isinstance(outcome, Planned)
    path, limits = outcome.plan.trajectory, scene.robot.limits
    t = np.linspace(path.start, path.end, 20001)
    ratios = {}
    for i, peak in enumerate(outcome.margins.peaks):
        for kind, order, limit in (
            ("velocity", 1, limits.velocity),
            ("acceleration", 2, limits.acceleration),
            ("jerk", 3, limits.jerk),
        ):
            sampled = np.abs(path.evaluate(t, order)[:, i]).max()
            stated = getattr(peak, kind)
            assert sampled <= stated * (1 + 1e-9) + 1e-12
            assert stated <= sampled * 1.01 + 1e-3 * limit[i]
            ratio = getattr(peak, f"{kind}_ratio")
            assert ratio == pytest.approx(stated / limit[i])
            assert ratio <= 1 + 1e-6
            ratios[f"{kind} of {peak.joint}"] = ratio
    bound = outcome.margins.binds.rsplit(" (", 1)[0]
    assert ratios[bound] == pytest.approx(max(ratios.values()))
    assert outcome.margins.singularity <= float(scene.robot.margin(path.q).max())


def test_a_plan_with_a_clearance_has_it_left_outside_contacts() -> None:
    for clearance in (Clearance(0.004, 0.001), Clearance(0.01, 0.0005)):
        outcome = plan(table_to_table(go(0.3, 0.0, 0.15), clearance=clearance))
        assert isinstance(outcome, Planned)
        found = outcome.margins.nearest
        assert found is not None
        least = clearance.near_m if found.phase in (LegKind.APPROACH, LegKind.FOLLOW, LegKind.DEPART) else 0.0
        assert found.gap_m >= max(least, min(clearance.near_m, clearance.travel_m))


@pytest.mark.parametrize("tool", [CUP, CRANKED])
def test_the_tools_peaks_are_those_of_its_point_by_differences(tool: Tool) -> None:
    """Positions alone, from the second implementation of the arm, differentiated."""
    scene = cell(go(0.35, -0.2), go(0.2, 0.4, name="b"), tool=tool)
    outcome = plan(scene)
    assert isinstance(outcome, Planned)
    path, tcp, h = outcome.plan.trajectory, scene.tool.tcp, 2e-5
    t = np.linspace(path.start + h, path.end - h, 60001)

    def at(times: FloatArray) -> FloatArray:
        q = path.evaluate(times)
        turn, both = q[:, 0] + q[:, 1] + q[:, 3], q[:, 0] + q[:, 1]
        x = 0.325 * np.cos(q[:, 0]) + 0.275 * np.cos(both) + np.cos(turn) * tcp.x - np.sin(turn) * tcp.y
        y = 0.325 * np.sin(q[:, 0]) + 0.275 * np.sin(both) + np.sin(turn) * tcp.x + np.cos(turn) * tcp.y
        return np.stack([x, y, q[:, 2]], -1)

    before, here, after = at(t - h), at(t), at(t + h)
    speed = np.linalg.norm(after - before, axis=1) / (2 * h)
    pull = np.linalg.norm(after - 2 * here + before, axis=1) / h**2
    told = outcome.margins.tool
    assert told is not None
    assert told.speed == pytest.approx(speed.max(), rel=1e-5)
    assert told.acceleration == pytest.approx(pull.max(), rel=2e-3)
    for time, value, sampled in (
        (told.speed_time, told.speed, speed),
        (told.acceleration_time, told.acceleration, pull),
    ):
        assert np.interp(time, t, sampled) == pytest.approx(value, rel=2e-3)


def test_what_binds_is_told_with_the_leg_in_which_it_is_used_most() -> None:
    scene = cell(go(0.35, -0.2), go(0.2, 0.4, name="b"))
    outcome = plan(scene)
    assert isinstance(outcome, Planned)
    found, path = outcome.margins.busiest, outcome.plan.trajectory
    assert found is not None
    kind, joint = outcome.margins.binds.rsplit(" (", 1)[0].split(" of ")
    number = [each.name for each in scene.robot.joints].index(joint)
    order = {"velocity": 1, "acceleration": 2, "jerk": 3}[kind]
    t = np.linspace(path.start, path.end, 100001)[:-1]
    used = np.abs(path.evaluate(t, order)[:, number])
    at_peak = used >= 0.99 * used.max()
    long = {
        (leg.kind, leg.step, leg.t0, leg.t1): float(at_peak[(t >= leg.t0) & (t < leg.t1)].sum() * (t[1] - t[0]))
        for leg in outcome.plan.legs
    }
    most = max(long, key=lambda leg: long[leg])
    assert (found.kind, found.step, found.t0, found.t1) == most
    assert found.at_limit_s == pytest.approx(long[most], abs=0.004)
    assert len(long) > 1
    assert joint in outcome.margins.helps


def test_the_nearest_pairs_are_those_of_dense_samples_pair_by_pair() -> None:
    """The second implementation of solids and carriers, at 4,000 instants, for travel and near a point apart."""
    scene = table_to_table(go(0.3, 0.0, 0.15))
    outcome = plan(scene)
    assert isinstance(outcome, Planned)
    path, of_plan = outcome.plan.trajectory, phases(scene, outcome.plan.legs, outcome.plan.arrivals)
    prover, told = Prover(scene), outcome.margins
    for near, found in ((False, told.travel_pairs), (True, told.near_pairs)):
        least: dict[tuple[str, ...], float] = {}
        for phase in (each for each in of_plan if each.near is near):
            arrangement = prover.of(phase)
            rows = prover.pairs(arrangement, phase).rows
            t = np.linspace(phase.t0, phase.t1, 400)
            where = carriers(scene, path.evaluate(t), t)
            for row in rows[rows[:, REQUIRED] >= 0.0]:
                units = [int(row[0]), int(row[1])]
                names = tuple(sorted(arrangement.names[arrangement.body[unit]] for unit in units))
                one, other = (place(arrangement, where, np.arange(len(t)), np.full(len(t), unit)) for unit in units)
                for k in range(0, len(t), 4):
                    apart = distance_by_gjk(one, other, k)[2]
                    least[names] = min(least.get(names, np.inf), apart)
        order = sorted(least.items(), key=lambda each: each[1])
        assert len(found) == min(4, len(order))
        for each, (_, sampled) in zip(found, order, strict=False):
            mine = least[tuple(sorted(each.bodies))]
            assert mine - 2e-3 <= each.gap_m <= mine + 1e-6
            assert each.gap_m <= sampled + 5e-5
            assert each.phase in (("APPROACH", "FOLLOW", "DEPART") if near else ("WAIT", "MOVE", "ARCH"))
        assert len({tuple(sorted(each.bodies)) for each in found}) == len(found)
        assert [each.distance_m for each in found] == sorted(each.distance_m for each in found)
    assert told.nearest is not None
    firsts = [pairs[0].gap_m for pairs in (told.travel_pairs, told.near_pairs)]
    assert min(firsts) == pytest.approx(told.nearest.gap_m, abs=1e-4)
    short, none = (plan(replace(scene, options=replace(scene.options, report=word))) for word in ("short", "none"))
    assert isinstance(short, Planned)
    assert isinstance(none, Planned)
    assert short.reported == Clearances(told.nearest, told.placed)
    assert (short.lower_bound_s, short.warnings, none.reported) == (None, (), None)
    with pytest.raises(FaultError):
        _ = short.margins


def test_contacts_of_phases_in_a_row_are_one() -> None:
    outcome = plan(belt_and_dial(go(0.35, 0.0, 0.12)))
    assert isinstance(outcome, Planned)
    of_plan = phases(belt_and_dial(go(0.35, 0.0, 0.12)), outcome.plan.legs, outcome.plan.arrivals)
    found = contacts(of_plan)
    legs = {(leg.kind, leg.step): leg for leg in outcome.plan.legs}
    by_pair = {contact.bodies: contact for contact in found if contact.t0 < legs[LegKind.MOVE, 1].t0}
    cup = by_pair["cup", "part"]
    assert cup.t0 == legs[LegKind.APPROACH, 0].t0
    assert cup.t1 == legs[LegKind.FOLLOW, 0].t1
    for contact in found:
        assert contact.bodies == tuple(sorted(contact.bodies))
        assert contact.t0 < contact.t1


def test_the_tools_acceleration_is_that_of_its_point_by_differences() -> None:
    belt = frame("belt", conveyor(Pose(-0.3, 0.35), 0.3))
    scene = cell(go(0.2, 0.0, 0.15, 0.0, "belt"), frames=(belt,), tool=CRANKED, end="moving")
    outcome = plan(scene)
    assert isinstance(outcome, Planned)
    path, h = outcome.plan.trajectory, 1e-4

    def at(t: FloatArray) -> FloatArray:
        p, yaw = scene.robot.forward(path.evaluate(t))
        tcp = scene.tool.tcp
        c, s = np.cos(yaw), np.sin(yaw)
        offset = np.stack([c * tcp.x - s * tcp.y, s * tcp.x + c * tcp.y, np.full_like(c, tcp.z)], -1)
        return np.asarray(p + offset)

    for begin in np.linspace(path.start + 2 * h, path.end - 0.05, 40):
        peak, when = tool_peak(scene, path, begin, begin + 0.04)
        t = np.append(np.linspace(begin, begin + 0.04, 81), when)
        by_difference = np.linalg.norm(at(t - h) - 2 * at(t) + at(t + h), axis=1) / h**2
        assert by_difference[-1] == pytest.approx(peak, rel=0.02, abs=0.1)
        assert by_difference.max() <= 1.05 * peak + 0.1
    found = reported(scene, Prover(scene), path, phases(scene, outcome.plan.legs, outcome.plan.arrivals))
    assert isinstance(found, Margins)
    dense = np.linspace(path.start + h, path.end - h, 40_001)
    pulls = np.linalg.norm(at(dense - h) - 2 * at(dense) + at(dense + h), axis=1) / h**2
    speeds = np.linalg.norm(at(dense + h) - at(dense - h), axis=1) / (2 * h)
    assert found.tool is not None
    assert found.tool.speed == pytest.approx(speeds.max(), rel=1e-6)
    assert found.tool.speed_time == pytest.approx(dense[speeds.argmax()], abs=1e-4)
    assert found.tool_acceleration == found.tool.acceleration == pytest.approx(pulls.max(), rel=2e-3)
    assert tool_accelerations(scene, path, dense) == pytest.approx(pulls, rel=0.02, abs=0.1)


def test_of_both_sides_of_a_jump_the_larger_counts_unless_it_is_outside() -> None:
    """Joint 1 speeds up at 1 rad/s² for a second, then brakes at 2: the tool point goes round the base."""
    scene = cell(go(0.35, -0.2))
    q, v, a = np.zeros((3, 4, 4))
    q[:, 0], v[:, 0], a[:, 0] = [0.0, 0.5, 0.5, 0.75], [0.0, 1.0, 1.0, 0.0], [1.0, 1.0, -2.0, -2.0]
    path = Trajectory(np.array([0.0, 1.0, 1.0, 1.5]), q, v, a, jumps=True)
    reach = float(np.hypot(*scene.robot.forward(np.zeros(4))[0][:2]))
    for end, pull, least in ((1.5, 5.0, 0.0), (1.5, 5.0, 1.0), (1.0, 2.0, 0.0)):
        found = tool_peaks_of(scene, path, least, end)
        assert (found.speed, found.speed_time) == pytest.approx((reach, 1.0))
        assert (found.acceleration, found.acceleration_time) == pytest.approx((np.sqrt(pull) * reach, 1.0))


def test_a_peak_of_what_is_not_known_is_not_a_number() -> None:
    scene = cell(go(0.35, -0.2))
    row = scene.robot.row.copy()
    row[CHAIN + LINK_OFFSET : CHAIN + LINK * int(row[LINKS]) : LINK] = np.nan
    path = Trajectory(np.array([0.0, 1.0]), *np.zeros((3, 2, 4)))
    peaks = np.zeros(4)
    tool_peaks(row, path.edges, path.coefficients, 0.0, 0.0, 0.0, 1.0, 0.1, 8, peaks)
    assert np.isnan(peaks[[0, 2]]).all()


def test_the_least_margin_is_found_between_instants() -> None:
    """The elbow passes through a straight arm between two instants, or turns round just before one."""
    scene = cell(go(0.35, -0.2))
    for through, least in ((-0.4, 0.0), (0.3, np.sin(0.3))):
        q = np.zeros((3, 4))
        q[:, 1] = 0.8, through, 0.8
        path = Trajectory(np.array([0.0, 0.5003, 1.0]), q, np.zeros((3, 4)), np.zeros((3, 4)))
        serial, parallel = least_margins(scene.robot, path, np.linspace(0.0, 1.0, 101))
        assert serial[0] == pytest.approx(least, abs=1e-6)
        assert scene.robot.margin(path.evaluate(serial[1])) == serial[0]
        assert parallel is None


def test_a_singular_position_that_is_passed_is_found_beside_a_margin_that_is_small_for_longer() -> None:
    scene, q = cell(go(0.35, -0.2)), np.zeros((4, 4))
    q[:, 1] = 0.8, 0.004, 0.8, -0.8
    path = Trajectory(np.array([0.0, 0.5, 1.0, 1.5]), q, np.zeros((4, 4)), np.zeros((4, 4)))
    t = np.linspace(0.0, 1.5, 150)
    sizes = scene.robot.margin(path.evaluate(t))
    assert sizes[:75].min() < sizes[75:].min()
    assert least_margins(scene.robot, path, t)[0][0] == pytest.approx(0.0, abs=1e-6)


def test_a_margin_of_what_is_not_known_is_not_a_number() -> None:
    arm = replace(five_bar("odd"), separation=0.6)
    q = np.zeros((2, 4))
    q[:, :2] = (np.pi / 2, -np.pi / 2)  # the couplers do not reach each other
    path = Trajectory(np.array([0.0, 1.0]), q, np.zeros((2, 4)), np.zeros((2, 4)))
    serial, parallel = least_margins(arm, path, np.linspace(0.0, 1.0, 11))
    assert np.isnan(serial[0])
    assert parallel is not None
    assert np.isnan(parallel[0])


@pytest.mark.parametrize("posts", [9, 90])
def test_no_pair_is_nearer_at_any_of_many_instants(posts: int) -> None:
    rng = np.random.default_rng(3)
    bodies = tuple(
        stands(f"post {i}", box(0.05, 0.04, 0.3), r * np.cos(a), r * np.sin(a), 0.1)
        for i, (a, r) in enumerate(zip(rng.uniform(-3.0, 3.0, posts), rng.uniform(0.55, 1.5, posts), strict=True))
    )
    scene = cell(go(0.35, -0.2), bodies=bodies)
    phase = Phase(0.0, 1.0, LegKind.MOVE, 0)
    apart = 0
    for _ in range(6):
        q = np.stack([rng.uniform([-2.0, -1.5, 0.1, -1.0], [2.0, 1.5, 0.2, 1.0]) for _ in range(2)])
        path = Trajectory(np.array([0.0, 1.0]), q, np.zeros((2, 4)), np.zeros((2, 4)))
        prover = Prover(scene)
        found = nearest(prover, path, (phase,))
        assert found is not None
        solids = prover.of(phase)
        a, b = prover.pairs(solids, phase).rows[:, :2].astype(np.int64).T
        t = np.append(np.linspace(0.0, 1.0, 11), found.time)
        where = carriers(scene, path.evaluate(t), t)
        names = [(solids.names[solids.body[x]], solids.names[solids.body[y]]) for x, y in zip(a, b, strict=True)]
        for row in range(len(t)):
            rows = np.full(len(a), row)
            one, other = place(solids, where, rows, a), place(solids, where, rows, b)
            distances = [max(0.0, distance_by_gjk(one, other, k)[0]) for k in range(len(a))]
            assert found.gap_m <= min(distances) + 1e-9
        # the last instant is that at which it is said to be nearest, and the pair is the one that is named
        assert distances[names.index(found.bodies)] == pytest.approx(found.gap_m, abs=5e-5)
        apart += found.gap_m > 1e-3
    assert apart >= 2
