"""Requests of the kinds for which planner and checkers have disagreed; their searches end by a count."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from benchmarks.judge.arms import Arm, rate, robot_file
from benchmarks.judge.poses import Document, Floats, si
from benchmarks.random_requests.drafts import (
    ELBOW,
    FIVE_AXES,
    FIVE_BAR,
    POLAR,
    SCARAS,
    THREE_AXES,
    TILTING,
    finished,
    neighbour_of,
)
from benchmarks.random_requests.kinds import KINDS, random_cell
from benchmarks.random_requests.points import Points
from benchmarks.random_requests.random_cells import surround

LATEST_S = 9.9e4
"""Latest start, s; no instant of a request may be later than 1e5 s."""
HEIGHT_M = 0.1
"""Of the flange of a five-bar with two joints above its base."""


# what a request is made of


def log_between(rng: np.random.Generator, low: float, high: float) -> float:
    """A number between two positive ones, whose logarithm is uniform."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


class NearAnEnd(Points):
    """Some joint of each target is at an end of its range, or almost."""

    def _somewhere(self, near: float | None = None) -> Floats:
        q, rng = super()._somewhere(near), self.draft.rng
        if near is not None:  # a target, not the start
            joint, upper = int(rng.integers(len(q))), bool(rng.integers(2))
            inside = rng.choice([-1.0, 0.0, 1.0, 1.0, 1.0]) * log_between(rng, 1e-10, 1e-3)
            q[joint] = self.arm.upper[joint] - inside if upper else self.arm.lower[joint] + inside
        return q


class TwoJoints(Points):
    """A five-bar without lift and wrist: two cranks, written out in the request."""

    @property
    def turns(self) -> bool:
        return False

    def _somewhere(self, near: float | None = None) -> Floats:
        q = super()._somewhere(near)
        q[2:] = HEIGHT_M, 0.0
        return q

    def write_out(self) -> None:
        """The same arm without its other joints."""
        ((_, given),) = robot_file(FIVE_BAR).items()
        lengths = {key: si(given, key).tolist() for key in ("separation", "proximal", "distal")}
        cranks = [body for body in given["bodies"]["value"] if body["link"].startswith(("proximal", "distal"))]
        arm = {f"{key}_m": value for key, value in lengths.items()} | {"height_m": HEIGHT_M, "self_pairs": []}
        arm |= {"assembly": given["assembly"], "joints": joints_of(FIVE_BAR)[:2], "bodies": cranks}
        robot, start = self.draft.request["robot"], self.draft.request["start"]
        del robot["model"]
        robot["five_bar"] = arm
        start["joints"] = {name: value for name, value in start["joints"].items() if name.startswith(("j1", "j2"))}
        self.draft.request.pop("execution", None)  # may state lag of joints that are not there


def joints_of(model: str) -> list[Document]:
    """The joints of a shipped robot, in SI."""
    ((_, given),) = robot_file(model).items()
    joints = []
    for each in given["joints"]:
        unit = "rad" if any(key in each for key in ("range_deg", "range_rad")) else "m"
        joint: Document = {"name": each["name"], f"range_{unit}": si(each, "range").tolist()}
        for kind, per in (("velocity", "s"), ("acceleration", "s2"), ("jerk", "s3")):
            joint[f"{kind}_{unit}_{per}"] = rate(each, kind)
        if "sign" in each:
            joint["sign"] = each["sign"]
        for zero in ("zero_m", "zero_rad"):
            if any(key.startswith("zero") for key in each) and zero.endswith(unit):
                joint[zero] = float(si(each, "zero"))
        joints.append(joint)
    return joints


def later(document: Any, by_s: float) -> Any:
    """A document whose instants are all later by so many seconds."""
    if isinstance(document, list):
        return [later(each, by_s) for each in document]
    if not isinstance(document, dict):
        return document
    instants = ("at_s", "start_s", "time_s", "window_s", "latest_end_s")
    return {
        key: (np.asarray(value) + by_s).tolist() if key in instants else later(value, by_s)
        for key, value in document.items()
    }


def points_of(rng: np.random.Generator, *models: str, cell: type[Points] = Points) -> Points:
    """A cell of an arm of one of these models. Where the arm has no yaw, its tool is on the flange axis."""
    points = cell(rng, str(rng.choice(models)))
    robot = points.draft.request["robot"]
    if not points.turns:
        robot["tool"]["tcp_m"][:2] = 0.0, 0.0
        points.arm = Arm.of(robot)
    return points


def with_lag(points: Points, turning: float, sliding: float) -> None:
    """Lag of most joints, from a hundredth of so many rad and m to all of it."""
    rng, lag = points.draft.rng, {}
    for j, name in enumerate(points.arm.names):
        if rng.uniform() < 0.8:
            slides = bool(points.arm.slides[j])
            lag[f"{name}_{'m' if slides else 'rad'}"] = log_between(rng, 0.01, 1.0) * (sliding if slides else turning)
    points.draft.request.setdefault("execution", {})["lag"] = lag


# kinds


def mesh_round_the_arm(rng: np.random.Generator) -> Document:
    """S1: an arm that works within a mesh: the shipped tray, ten times as large, with the arm in it."""
    points = points_of(rng, *SCARAS, THREE_AXES, FIVE_BAR)
    points.steps(int(rng.integers(1, 3)), still=True)
    aside = points.draft.at(0.0, 0.0, points.draft.low - 0.4) + rng.uniform(-0.3, 0.3, 3) * (1.0, 1.0, 0.5)
    points.draft.add_body("tray", {"mesh": {"asset": "tray", "unit": "cm"}}, aside.tolist(), rng.uniform(-3.0, 3.0))
    return points.draft.request


def neighbour_and_late_clock(rng: np.random.Generator) -> Document:
    """S2: another robot moves, and the clock began long ago."""
    points = points_of(rng, *SCARAS)
    points.steps(int(rng.integers(1, 3)))
    points.draft.request["neighbours"] = [neighbour_of(points.draft, int(rng.integers(2, 6)))]
    return dict(later(points.draft.request, log_between(rng, 1e3, LATEST_S)))


def late_clock(rng: np.random.Generator) -> Document:
    """S2: random cells of all kinds, and the clock began long ago."""
    request = random_cell(str(rng.choice(KINDS)), int(rng.integers(1_000_000)))
    return dict(later(request, log_between(rng, 1e3, LATEST_S)))


def no_yaw(rng: np.random.Generator) -> Document:
    """S3: arms that have no yaw of their own follow what moves, and the first candidates fail."""
    model = str(rng.choice((ELBOW, POLAR, FIVE_BAR)))
    points = points_of(rng, model, cell=TwoJoints if model == FIVE_BAR else Points)
    points.steps(int(rng.integers(1, 4)))
    surround(points.draft, 4)
    if isinstance(points, TwoJoints):
        points.write_out()
    return points.draft.request


def flown_by(rng: np.random.Generator) -> Document:
    """S4: moves that the tool flies by."""
    points = points_of(rng, FIVE_AXES, ELBOW, POLAR, FIVE_BAR, THREE_AXES)
    count = int(rng.integers(2, 6))
    for number in range(count):
        move: Document = {"to": points.target(0.6, still=rng.uniform() < 0.8)}
        if number < count - 1:
            move["via"] = True
        points.draft.request["task"].append({"move": move})
    surround(points.draft, 1)
    return points.draft.request


def lag_on_a_tilting_arm(rng: np.random.Generator) -> Document:
    """S5: servo lag on an arm that tilts, and small bodies beside its targets, whose places are uncertain."""
    points = points_of(rng, *TILTING)
    for number in range(int(rng.integers(1, 4))):
        points.steps(1)
        way = rng.normal(size=3)
        at = points.arm.tool(points.q).p + rng.uniform(0.03, 0.09) * way / np.linalg.norm(way)
        shape = {"cylinder": {"radius_m": rng.uniform(0.004, 0.012), "height_m": rng.uniform(0.01, 0.03)}}
        body = points.draft.add_body(f"pin-{number}", shape, at.tolist())
        body["uncertainty"] = {"vertical_m": rng.uniform(0.0, 1e-3), "position_m": rng.uniform(0.0, 1e-3)}
    with_lag(points, 1e-2, 3e-3)
    surround(points.draft, 3)
    return points.draft.request


def tiny_limits(rng: np.random.Generator) -> Document:
    """S6: velocities, accelerations and jerks of the joints down to 1e-6."""
    points = points_of(rng, *SCARAS, ELBOW, POLAR)
    model = points.draft.model
    points.draft.request["robot"].pop("limits", None)
    for _ in range(int(rng.integers(1, 3))):
        points.draft.request["task"].append({"move": {"to": points.target(log_between(rng, 1e-6, 0.3), still=True)}})
    ((family, given),) = robot_file(model).items()
    joints = joints_of(model)
    scales = [log_between(rng, 1e-6, 1.0) for _ in range(3)]
    for joint in joints:
        for scale, kind in zip(scales, ("velocity", "acceleration", "jerk"), strict=True):
            for key in [key for key in joint if key.startswith(kind)]:
                own = scale if rng.uniform() < 0.7 else log_between(rng, 1e-6, 1.0)
                joint[key] = max(own * joint[key], 1e-6)
    del points.draft.request["robot"]["model"]
    points.draft.request["robot"][family] = {**given, "joints": joints}
    return points.draft.request


def much_lag(rng: np.random.Generator) -> Document:
    """S10: so much lag of upright arms that the required distance depends on the interval."""
    points = points_of(rng, *SCARAS[:4], FIVE_BAR, FIVE_BAR, FIVE_BAR)
    points.steps(int(rng.integers(1, 4)))
    with_lag(points, 3e-2, 3e-3)
    surround(points.draft, 3)
    return points.draft.request


def reach_limits(rng: np.random.Generator) -> Document:
    """Targets at the ends of joint ranges: inside by 1e-10 to 1e-3, at the end, or outside by as little."""
    points = points_of(rng, POLAR, POLAR, ELBOW, FIVE_AXES, *SCARAS[:3], cell=NearAnEnd)
    points.steps(int(rng.integers(1, 3)))
    return points.draft.request


HARD: dict[str, Callable[[np.random.Generator], Document]] = {
    "mesh round the arm": mesh_round_the_arm,
    "neighbour, late clock": neighbour_and_late_clock,
    "late clock": late_clock,
    "no yaw": no_yaw,
    "moves flown by": flown_by,
    "lag, tilting arm": lag_on_a_tilting_arm,
    "tiny limits": tiny_limits,
    "much lag": much_lag,
    "ends of ranges": reach_limits,
}


def hard_request(kind: str, seed: int) -> Document:
    """The request of a kind (one of `HARD`) and a seed, in SI."""
    return finished(HARD[kind](np.random.default_rng([seed, 2000 + list(HARD).index(kind)])))
