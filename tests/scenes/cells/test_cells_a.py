"""Belts and a dial, a standard cycle, a dense flow: what must be true of their answers, by a second kinematics.

The tool's motion is that of `tests.scenes.cells.second_kinematics`, belts and dial are from the numbers of the request.
"""

from __future__ import annotations

import copy
import itertools
import math
from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np
import pytest

from assur.planner.collision.screening import Encounter
from assur.planner.model.refusal import Reason, Refusal, Separation
from assur.planner.pipeline import plan
from assur.planner.search.census import Counter
from assur.scenes.requests import Scenario, plan_document, scene_of, shipped
from tests.planner.cells import amount_of, unit_of
from tests.scenes.cells.second_kinematics import ACCELERATION, VELOCITY, Array, Motion, answer, arrival, leg

PLANNED = ("belt-to-belt", "standard-cycle", "fast-belt", "dense-flow", "full-dial")
REFUSED = ("fast-belt-long-follow", "dense-flow-uncorrected", "dense-flow-uncertain")
MET_M, MET_M_S = 2e-6, 5e-6
"""Of a meeting: 2 µm (and 2 µrad), 5 µm/s (and 5 µrad/s)."""
TRACKED_M = 1e-5
"""What a follow may be off, m."""


@cache
def scenario(name: str) -> Scenario:
    return shipped(name)


@cache
def run(name: str) -> Motion:
    return Motion(answer(name), tcp=scenario(name).request["robot"]["tool"]["tcp_mm"][2] / 1000)


def shape_of(name: str, body: str) -> dict[str, Any]:
    found: dict[str, Any] = next(b for b in scenario(name).request["bodies"] if b["name"] == body)
    return found


def belt_point(
    at_mm: list[float], yaw_deg: float, speed: float, local_mm: list[float], t: Array
) -> tuple[Array, Array]:
    """World position (..., 3) at t and velocity (3,) of a point that rides on a belt."""
    c, s = math.cos(math.radians(yaw_deg)), math.sin(math.radians(yaw_deg))
    x, y, z = local_mm
    start = np.array([at_mm[0] + c * x - s * y, at_mm[1] + s * x + c * y, at_mm[2] + z]) / 1000
    velocity = speed * np.array([c, s, 0.0])
    return start + np.asarray(t)[..., None] * velocity, velocity


def assert_rides(at: Motion, step: int, place: tuple[Array, Array], t: Array) -> None:
    """The tool is at the point of a belt, with its velocity and without turning: at the ends and in between."""
    where, velocity = place
    assert np.abs(at.tool(t)[:, :3] - where).max() < TRACKED_M
    ends = at.rate(t[[0, -1]])
    assert np.abs(at.tool(t[[0, -1]])[:, :3] - where[[0, -1]]).max() < MET_M
    assert np.abs(ends[:, :3] - velocity).max() < MET_M_S
    assert np.abs(ends[:, 3]).max() < MET_M_S
    assert np.ptp(np.unwrap(at.tool(t)[:, 3])) < 1e-4
    assert t[0] == pytest.approx(at.answer["arrivals"][step]["time_s"])


@pytest.mark.parametrize("name", PLANNED)
def test_the_maker_s_limits_of_speed_and_acceleration_are_kept_between_samples_too(name: str) -> None:
    at = run(name)
    t = np.arange(*at.span, 2.5e-4)
    scale = scenario(name).request["robot"].get("limits", {}).get("acceleration", 1.0)
    assert (np.abs(at.joints(t, 1)).max(0) <= VELOCITY * (1 + 1e-6)).all()
    assert (np.abs(at.joints(t, 2)).max(0) <= scale * ACCELERATION * (1 + 1e-6)).all()
    assert np.abs(at.joints(np.array(at.span), 1)).max() == 0.0  # begins and ends at rest


class TestBeltToBelt:
    """The cell `belt-to-belt`."""

    def test_the_part_is_taken_at_the_speed_of_the_first_belt(self) -> None:
        at = run("belt-to-belt")
        t = np.linspace(*leg(at.answer, "FOLLOW", 0), 50)
        assert_rides(at, 0, belt_point([0, 340, 50], 0, 0.25, [-400, 15, 20], t), t)

    @pytest.mark.parametrize(("speed", "off"), [(0.25001, 0.0), (0.25, 0.02)])
    def test_a_belt_that_is_a_little_faster_or_a_part_elsewhere_would_be_noticed(
        self, speed: float, off: float
    ) -> None:
        at = run("belt-to-belt")
        t = np.linspace(*leg(at.answer, "FOLLOW", 0), 50)
        with pytest.raises(AssertionError):
            assert_rides(at, 0, belt_point([0, 340, 50], 0, speed, [-400 + off, 15, 20], t), t)

    def test_it_is_put_down_at_the_speed_of_the_second_which_runs_back_and_askew(self) -> None:
        at = run("belt-to-belt")
        t = np.linspace(*leg(at.answer, "FOLLOW", 1), 50)
        # the carrier's frame is 3 mm above the belt, the part's 13 mm above that, the grasp 10 mm above the part's
        place = belt_point([330, -260, 60], 192, 0.16, [-120, 0, 26], t)
        assert place[1][0] < -0.15
        assert_rides(at, 1, place, t)

    def test_the_part_s_walls_are_parallel_to_those_of_its_pocket(self) -> None:
        at = run("belt-to-belt")
        picked, placed = arrival(at.answer, "pick-1"), arrival(at.answer, "place-2")
        tool_in_part = picked["yaw_rad"] - math.radians(27)
        part_on_belt = placed["yaw_rad"] - tool_in_part - math.radians(192)
        assert math.remainder(tool_in_part, math.pi / 2) == pytest.approx(0, abs=MET_M)
        assert math.remainder(part_on_belt, 2 * math.pi) == pytest.approx(0, abs=2 * MET_M)

    def test_the_part_is_not_torn_off_the_cup(self) -> None:
        at = run("belt-to-belt")
        t = np.arange(leg(at.answer, "FOLLOW", 0)[1], leg(at.answer, "FOLLOW", 1)[1], 2e-4)
        step = 1e-5
        acceleration = (at.rate(t + step)[:, :3] - at.rate(t - step)[:, :3]) / (2 * step)
        most = float(np.sqrt((acceleration**2).sum(-1)).max())
        assert most <= 40 * (1 + 1e-3)  # differences are good to about 1e-4 of it
        assert answer("belt-to-belt")["margins"]["tool_acceleration_limit_m_s2"] == 40


class TestStandardCycle:
    """The cell `standard-cycle`."""

    def test_both_ways_together_take_047_s_at_catalogue_limits(self) -> None:
        request = scenario("standard-cycle").request
        assert "limits" not in request["robot"]
        assert request["robot"]["tool"]["mass_kg"] == 2.0
        found = answer("standard-cycle")
        assert found["duration_s"] <= 0.47
        assert found["lower_bound_s"] <= found["duration_s"]

    def test_each_way_goes_25_mm_up_300_mm_across_and_25_mm_down(self) -> None:
        at = run("standard-cycle")
        there, back = arrival(at.answer, "there"), arrival(at.answer, "back")
        first, last = at.tool(np.array(at.span))
        middle = at.tool(there["time_s"])
        assert math.dist(first[:2], middle[:2]) == pytest.approx(0.3, abs=1e-6)
        assert math.dist(middle[:2], last[:2]) == pytest.approx(0.3, abs=1e-6)
        for begin, end in ((at.span[0], there["time_s"]), (there["time_s"], back["time_s"])):
            z = at.tool(np.linspace(begin, end, 4001))[:, 2]
            assert z[0] == pytest.approx(0.062, abs=MET_M)
            assert z[-1] == pytest.approx(0.062, abs=MET_M)
            assert z.max() >= 0.087 - 1e-6

    def test_the_load_stands_still_in_its_seats_and_nowhere_else(self) -> None:
        at = run("standard-cycle")
        there = arrival(at.answer, "there")["time_s"]
        assert np.abs(at.rate(there)).max() < MET_M_S
        for begin, end in ((at.span[0], there), (there, at.span[1])):
            moving = at.rate(np.linspace(begin + 0.03, end - 0.03, 500))
            # corners overlapped: never slower than a tenth of the 300 mm / 0.2 s that it comes to
            assert np.sqrt((moving[:, :3] ** 2).sum(-1)).min() > 0.15

    def test_across_begins_before_up_is_done(self) -> None:
        at = run("standard-cycle")
        t = np.linspace(at.span[0], arrival(at.answer, "there")["time_s"], 4001)
        z, speed = at.tool(t)[:, 2], np.hypot(*at.rate(t)[:, :2].T)
        up = int(np.argmax(z >= 0.087 - 1e-6))
        assert speed[up] > 0.5


class TestFastBelt:
    """The cell `fast-belt`."""

    def test_the_print_is_made_at_the_speed_of_the_belt_and_within_its_window(self) -> None:
        at = run("fast-belt")
        begin, end = leg(at.answer, "FOLLOW", 0)
        assert end - begin == pytest.approx(0.08, abs=1e-9)
        t = np.linspace(begin, end, 50)
        assert_rides(at, 0, belt_point([0, 400, 60], 0, 0.5, [-500, 0, 35], t), t)
        x = at.tool(t)[:, 0]
        assert x[0] >= -0.1 - MET_M
        assert x[-1] <= 0.09 + MET_M
        window = arrival(at.answer, "print")["window_left_s"]
        assert window == pytest.approx((0.09 - x[0]) / 0.5 - 0.08, abs=1e-4)

    def test_the_head_stays_between_the_guards_wherever_it_is_over_the_belt(self) -> None:
        at = run("fast-belt")
        tool = at.tool(np.arange(*at.span, 5e-4))
        over = tool[:, 1] > 0.32
        assert over.any()
        # inner faces at 145 mm, a head of 18 mm, and at least the 5 mm of a follow
        assert np.abs(tool[over, 0]).max() <= 0.145 - 0.018 - 0.005 + 1e-9

    def test_the_two_files_differ_in_the_duration_of_the_print_only(self) -> None:
        short, long = (copy.deepcopy(scenario(name).request) for name in ("fast-belt", "fast-belt-long-follow"))
        assert short["task"][0]["follow"].pop("duration_ms") == 80
        assert long["task"][0]["follow"].pop("duration_ms") == 500
        del long["options"]["explain_budget_s"]
        assert short == long

    def test_a_longer_print_misses_its_window_by_so_many_ms_and_mm(self) -> None:
        found = answer("fast-belt-long-follow")
        assert found["reason"] == "WINDOW_MISSED"
        assert found["proved"]
        refusal = found["refusal"]
        assert refusal["unit"] == "s"
        assert refusal["amount"] == pytest.approx(0.5 - 0.19 / 0.5, abs=1e-6)
        assert refusal["interval_s"] == pytest.approx([0.8, 1.18], abs=1e-6)
        assert "120 ms" in found["sentence"]
        assert "60 mm" in found["sentence"]

    def test_the_relaxation_is_a_shorter_print_and_planning_that_one_works(self) -> None:
        found = answer("fast-belt-long-follow")
        relaxation = found["relaxation"]
        assert relaxation["what"] == "dwell"
        number, unit = relaxation["value"].split()
        assert unit == "ms"
        # 400 ms do not fit into a window of 380 ms, and of the changes that are tried 300 ms is the next
        assert float(number) == 300
        # a window that is opened was tried before; no longer search, for the refusal is proved
        assert [each.split(":")[0] for each in found["tried"][:2]] == ["window", "dwell"]
        request = copy.deepcopy(scenario("fast-belt-long-follow").request)
        request["task"][0]["follow"]["duration_ms"] = float(number)
        assert plan_document(request, certificate="digest")["status"] == "planned"


DENSE = ("dense-flow", "dense-flow-uncorrected", "dense-flow-uncertain")


class TestDenseFlow:
    """Fingers have 11.5 mm to each neighbour; 1.5 mm are asked; the belt drifts by 5 mm/s."""

    def test_the_three_files_differ_in_what_is_uncertain_and_what_is_corrected_only(self) -> None:
        requests = [copy.deepcopy(scenario(name).request) for name in DENSE]
        assert requests[0].pop("execution") == requests[2].pop("execution") == {"belt_correction": True}
        assert "execution" not in requests[1]
        assert requests[0] == requests[1]
        frames = requests[2].pop("frames")
        assert len(frames) == 3
        assert all(frame == requests[0]["frames"]["belt"] for frame in frames.values())
        del requests[0]["frames"]
        parts = [body["pose"] for body in requests[2]["bodies"] if "frame" in body["pose"]]
        assert len({pose["frame"] for pose in parts}) == len(parts) == 3
        for pose in parts:
            pose["frame"] = "belt"
        assert requests[0] == requests[2]

    def test_neighbours_are_20_mm_apart_and_the_speed_is_known_to_2_percent(self) -> None:
        x = [shape_of("dense-flow", body)["pose"]["at_mm"][0] for body in ("before", "part", "behind")]
        length = shape_of("dense-flow", "part")["shape"]["box"]["size_mm"][0]
        assert [x[0] - x[1] - length, x[1] - x[2] - length] == [20, 20]
        belt = scenario("dense-flow").request["frames"]["belt"]
        assert belt["uncertainty"]["speed_mm_s"] == 0.02 * belt["conveyor"]["speed_mm_s"]

    def test_the_part_is_taken_from_between_its_neighbours_at_belt_speed(self) -> None:
        at = run("dense-flow")
        t = np.linspace(*leg(at.answer, "FOLLOW", 0), 50)
        assert_rides(at, 0, belt_point([0, 380, 50], 0, 0.25, [-900, 0, 30], t), t)
        # the fingers are along the belt: the yaw leaves them no other place
        assert math.remainder(at.tool(t)[0, 3], 2 * math.pi) == pytest.approx(0, abs=MET_M)

    def test_it_is_planned_although_the_belt_drifts_by_more_than_there_is_beside_a_finger(self) -> None:
        begin, _ = leg(answer("dense-flow"), "FOLLOW", 0)
        assert 0.005 * begin > 0.0115
        nearest = answer("dense-flow")["margins"]["nearest"]
        assert 0.0015 <= nearest["gap_m"] <= 0.0115 + 1e-6

    @pytest.mark.parametrize(("name", "drifts"), [("dense-flow-uncorrected", 1), ("dense-flow-uncertain", 2)])
    def test_every_candidate_is_refused_by_both_neighbours_for_what_is_missing_to_the_drift(
        self, name: str, drifts: int, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        """What a phase requires, it requires with the drift at its end: 11.5 mm are there, 1.5 mm and the drift are
        required. A finger is refused in one of three phases: the approach, which ends when the part is met, the dwell,
        which ends 80 ms later, or the departure, 80 mm upwards. In which, depends on where screening looks first; it
        tells all that is too near at one instant. The census keeps least and most only, so the refusals are taken one
        by one."""
        lines = answer(name)["census"]["lines"]
        refusals: list[Refusal] = []
        add_all = Counter.add_all

        def recorded(self: Counter, encounters: Sequence[Encounter]) -> None:
            refusals.extend(encounter.refusal for encounter in encounters)
            add_all(self, encounters)

        monkeypatch.setattr(Counter, "add_all", recorded)
        plan(scene_of(scenario(name).request))
        neighbours = ("finger-back", "behind"), ("finger-front", "before")
        for bodies in neighbours:
            mine = [refusal for refusal in refusals if refusal.bodies == bodies]
            assert {(refusal.reason, unit_of(refusal)) for refusal in mine} == {(Reason.BODY_COLLISION, "m")}
            told = next(line for line in lines if tuple(line["bodies"]) == bodies)
            assert told["count"] == len(mine)
            assert told["least"] == min(amount_of(refusal) for refusal in mine)
            assert told["most"] == max(amount_of(refusal) for refusal in mine)
        of_fingers = [refusal for refusal in refusals if refusal.bodies in neighbours and self.beside(refusal)]
        assert len(of_fingers) >= 0.8 * sum(refusal.bodies in neighbours for refusal in refusals)
        every = np.array([self.end(refusal, drifts) for refusal in of_fingers])
        assert every.min() == pytest.approx((900 - 200) / 250, abs=1e-6)  # where the window begins
        assert every.max() < (900 + 250) / 250
        # what a candidate is refused for at one instant is counted in one go: the phase is the same
        at_once = [(one, other) for one, other in itertools.pairwise(of_fingers) if one.interval == other.interval]
        assert len(at_once) >= 80
        for one, other in at_once:
            assert {one.bodies, other.bodies} == set(neighbours)
            assert self.end(one, drifts) == pytest.approx(self.end(other, drifts), abs=1e-6)

    def beside(self, refusal: Refusal) -> bool:
        """Whether a finger was beside a neighbour, or still above; one that is on its way may be nearer."""
        assert isinstance(refusal.facts, Separation)
        return refusal.facts.gap_m is not None and refusal.facts.gap_m >= 0.0115 - 1e-9

    def end(self, refusal: Refusal, drifts: int) -> float:
        """When the phase of a refusal beside a neighbour ends, s, by the drift that it requires."""
        facts, interval = refusal.facts, refusal.interval
        assert isinstance(facts, Separation)
        assert facts.required_m is not None
        assert interval is not None
        end = (facts.required_m - 0.0015) / (drifts * 0.005)
        assert interval[1] - 1e-9 <= end <= interval[1] + 1.2
        return end

    @pytest.mark.parametrize("name", ["dense-flow-uncorrected", "dense-flow-uncertain"])
    def test_both_neighbours_are_named_in_the_sentence(self, name: str) -> None:
        sentence = answer(name)["sentence"]
        assert "before" in sentence
        assert "behind" in sentence


class TestFullDial:
    """The dial's centre is at (330, -130), a nest is 150 mm from it."""

    centre = np.array([0.33, -0.13])
    rate = 20 * 2 * math.pi / 60

    def angle(self, t: Array) -> Array:
        return math.pi + self.rate * np.asarray(t)

    def test_the_part_is_put_down_at_the_nest_s_speed_and_yaw_rate(self) -> None:
        at = run("full-dial")
        t = np.linspace(*leg(at.answer, "FOLLOW", 1), 50)
        out = np.stack([np.cos(self.angle(t)), np.sin(self.angle(t))], axis=-1)
        across = np.stack([-out[:, 1], out[:, 0]], axis=-1)
        tool, rate = at.tool(t), at.rate(t)
        assert np.abs(tool[:, :2] - self.centre - 0.15 * out).max() < TRACKED_M
        assert np.abs(tool[:, 2] - 0.108).max() < TRACKED_M  # 60 + 28 and the grasp's 20 mm
        for end in (0, -1):
            assert np.abs(tool[end, :2] - self.centre - 0.15 * out[end]).max() < MET_M
            assert np.abs(rate[end, :2] - 0.15 * self.rate * across[end]).max() < MET_M_S
            assert abs(rate[end, 2]) < MET_M_S
            assert rate[end, 3] == pytest.approx(self.rate, abs=MET_M_S)

    def test_the_part_does_not_turn_in_its_nest_while_the_dial_turns_by_seven_degrees(self) -> None:
        at = run("full-dial")
        t = np.linspace(*leg(at.answer, "FOLLOW", 1), 50)
        turned = at.tool(t)[:, 3] - self.angle(t)
        assert self.rate * (t[-1] - t[0]) == pytest.approx(math.radians(7.2))
        assert np.ptp(turned) < 1e-4

    def test_seven_of_eight_nests_are_filled_45_degrees_apart(self) -> None:
        bodies = scenario("full-dial").request["bodies"]
        nests = [b["pose"]["at_mm"] for b in bodies if b["name"].startswith("nest-")]
        parts = [b["pose"]["at_mm"] for b in bodies if b["name"].startswith("part-")]
        angles = [math.degrees(math.atan2(y, x)) % 360 for x, y, _ in nests]
        assert angles == pytest.approx([45 * k for k in range(8)], abs=0.01)
        assert [at[:2] for at in parts] == [at[:2] for at in nests[1:]]

    def test_the_carried_part_goes_round_the_hub_and_keeps_off_the_seven_others(self) -> None:
        at = run("full-dial")
        t = np.arange(leg(at.answer, "FOLLOW", 0)[1], leg(at.answer, "FOLLOW", 1)[1], 5e-4)
        tool = at.tool(t)
        assert tool[:, 2].max() - 0.04 < 0.25  # its bottom never comes over the hub's top
        near = tool[:, 2] < 0.25
        assert np.hypot(*(tool[near, :2] - self.centre).T).min() > 0.05 + 0.02 + 0.0015
        for k in range(1, 8):
            angle = self.angle(t) + k * math.pi / 4
            other = self.centre + 0.15 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
            apart = np.hypot(*(tool[:, :2] - other).T)
            beside = tool[:, 2] - 0.04 < 0.108  # low enough to touch it
            assert (apart[beside] > 0.02 + 0.02 + 0.0015).all()
