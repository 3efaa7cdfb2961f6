"""Random cells in which an arm of any family goes through points: at rest, in motion, along lines and paths.

All points are where the arm's own joints put its tool, so that most of them are in reach.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from benchmarks.judge.arms import Arm, tilt
from benchmarks.judge.poses import Document, Floats
from benchmarks.random_requests.drafts import Draft, drafted
from benchmarks.random_requests.random_cells import surround

REACH = {"elbow-arm": 0.48, "polar-arm": 0.65, "mitsubishi-rv-m1": 0.48}
"""Of the arms whose links tilt, m."""


class Points:
    """A cell that is being written: its arm, where its joints are after the last step, and when that is, about."""

    def __init__(self, rng: np.random.Generator, model: str) -> None:
        self.draft = _draft(rng, model)
        self.arm = Arm.of(self.draft.request["robot"])
        self.q = self._somewhere()
        self.number = 0
        self.due = self.draft.request["start"].setdefault("at_s", self.draft.between(0.0, 2.0)) + 0.2
        self.draft.request["start"]["joints"] = self.arm.named(self.q)

    @property
    def turns(self) -> bool:
        """Whether the arm has a yaw of its own."""
        return self.arm.turns

    def _somewhere(self, near: float | None = None) -> Floats:
        """Joints within their ranges, of all or within a share of them about the last ones; a five-bar's must meet."""
        rng, half = self.draft.rng, (self.arm.upper - self.arm.lower) / 2.0
        middle = (self.arm.upper + self.arm.lower) / 2.0
        for _ in range(1000):
            q = middle + half * rng.uniform(-0.75, 0.75, len(half))
            if near is not None:
                q = np.clip(
                    self.q + half * rng.uniform(-near, near, len(half)), middle - 0.85 * half, middle + 0.85 * half
                )
            if self.arm.family == "five_bar":
                q[0], q[1] = rng.uniform(0.35, 1.6), -rng.uniform(0.35, 1.6)
                if near is not None:
                    q[:2] = self.q[:2] + rng.uniform(-near, near, 2)
            if np.isfinite(self.arm.tool(q).p).all():
                return np.asarray(q)
        raise ValueError("joints that do not meet")

    def in_motion(self) -> None:
        """The start is in motion."""
        arm, rng = self.arm, self.draft.rng
        start, n = self.draft.request["start"], len(self.q)
        start["velocity"] = self.arm.named(arm.velocity * rng.uniform(-0.3, 0.3, n), ("rad_s", "m_s"))
        start["acceleration"] = self.arm.named(arm.acceleration * rng.uniform(-0.2, 0.2, n), ("rad_s2", "m_s2"))

    def target(self, near: float | None = None, still: bool = False, lasts: float = 0.0) -> Document:
        """Where the tool should be next: in the world, or on something that moves and is there in time."""
        draft, q = self.draft, self._somewhere(near)
        place, self.q = self.arm.tool(q), q
        self.due += draft.between(0.4, 0.9) + lasts
        found: Document = {"at_m": [float(x) for x in place.p]}
        yaw = float(place.yaw) if self.turns else 0.0
        if not still and draft.chance(0.6):
            name, self.number = f"carrier-{self.number}", self.number + 1
            law, at, turn = _law(draft, place.p, self.due)
            draft.add_frame(name, law, draft.of_frame(False) if self.turns and draft.chance(0.3) else {})
            found = {"frame": name, "at_m": at}
            yaw -= turn
        if self.turns:
            found |= draft.one_of({"yaw_rad": yaw}, {"yaw_rad": yaw}, {"yaw_free": True})
        if self.arm.family == "five_axis_arm":
            pitch, roll = tilt(self.arm.links(q))
            if draft.chance(0.7):
                found["pitch_rad"] = float(pitch)
            if draft.chance(0.5):
                found["roll_rad"] = float(roll)
        return found

    def steps(self, count: int, still: bool = False) -> None:
        """Moves and follows."""
        draft = self.draft
        for number in range(count):
            kind = draft.one_of("move", "move", "straight", "via", "follow", "position")
            last = number == count - 1
            if kind == "follow":
                lasts = draft.between(0.05, 0.3)
                to = self.target(0.5, still, lasts)
                if self.turns and "yaw_rad" not in to:
                    to["yaw_free"] = True
                draft.request["task"].append({"follow": {"to": to, "duration_s": lasts}})
                continue
            move: Document = {"to": self.target(0.12 if kind == "straight" else 0.6, still or kind == "straight")}
            if kind == "straight":
                move["leg"] = "cartesian"
            if kind == "via" and not last:
                move["via"] = True
            if kind == "position":
                move["match"] = "position"
            draft.request["task"].append({"move": move})

    def options(self) -> None:
        """Windows, ends, what else a plan must keep."""
        draft, options = self.draft, self.draft.request["options"]
        if draft.chance(0.2):
            options["elbow"] = "keep"
        if draft.chance(0.15):
            options["latest_end_s"] = self.due + draft.between(0.5, 3.0)
        if draft.chance(0.3):
            ((_, step),) = draft.request["task"][0].items()
            if not step.get("via"):
                begin = draft.request["start"]["at_s"]
                step["window_s"] = [begin, begin + draft.between(0.8, 4.0)]
        if self.turns and self.arm.family == "scara" and draft.chance(0.2):
            ahead = float(self.arm.tool(self.q).yaw) + draft.between(0.4, 2.5)
            draft.request["robot"].setdefault("limits", {})["forbidden_yaw_rad"] = [[ahead, ahead + 0.3]]

    def trace(self) -> None:
        """A path in a frame: a line and an arc that goes on from it."""
        draft = self.draft
        start = self.target(0.3)
        if self.turns and "yaw_rad" not in start:
            start["yaw_free"] = True
        at, heading = np.array(start["at_m"]), draft.between(-3.0, 3.0)
        along = np.array([math.cos(heading), math.sin(heading), draft.between(-0.2, 0.2)])
        along /= np.linalg.norm(along)
        length, radius = draft.between(0.01, 0.06), draft.between(0.015, 0.04)
        aside = np.array([-along[1], along[0], 0.0]) / np.hypot(along[0], along[1])
        here = at + length * along
        angle = draft.between(0.5, 1.5)
        via, end = (here + radius * (np.sin(a) * along + (1.0 - np.cos(a)) * aside) for a in (angle / 2.0, angle))
        path: list[Document] = [{"line": {"to_m": here.tolist()}}]
        if draft.chance(0.7):
            path.append({"arc": {"via_m": via.tolist(), "to_m": end.tolist()}})
        speed = draft.between(0.02, 0.12)
        draft.request["task"].append({"trace": {"start": start, "path": path, "speed_m_s": speed}})


def _law(draft: Draft, p: Floats, due: float) -> tuple[Document, list[float], float]:
    """Something that is at a point, m, when it is due, s: its law, where the point is in it, and its yaw then."""
    kind, x = draft.one_of("belt", "dial", "oscillation", "swing", "linear"), [float(v) for v in p]
    yaw = draft.between(-3.0, 3.0)
    if kind == "belt":
        return (
            {"conveyor": {"at_m": x, "yaw_rad": yaw, "speed_m_s": draft.between(0.02, 0.25), "at_s": due}},
            [0, 0, 0],
            yaw,
        )
    if kind == "linear":
        velocity = [draft.between(-0.1, 0.1) for _ in range(3)]
        return {"linear": {"at_m": x, "yaw_rad": yaw, "velocity_m_s": velocity, "at_s": due}}, [0, 0, 0], yaw
    if kind == "oscillation":
        law = {
            "at_m": x,
            "yaw_rad": yaw,
            "direction": [draft.between(-1, 1), draft.between(-1, 1), draft.between(0.1, 1)],
        }
        more = {"amplitude_m": draft.between(0.01, 0.05), "period_s": draft.between(0.8, 3.0)}
        return {"oscillation": {**law, **more, "phase_rad": draft.between(-3, 3)}}, [0, 0, 0], yaw
    r, towards = draft.between(0.02, 0.15), draft.between(-3.0, 3.0)
    pivot = [x[0] - r * math.cos(towards), x[1] - r * math.sin(towards), x[2]]
    if kind == "dial":
        rate = draft.between(-1.2, 1.2)
        law = {"at_m": pivot, "yaw_rad": towards, "rate_rad_s": rate, "at_s": due}
        return {"turntable": law}, [r, 0.0, 0.0], towards
    law = {
        "pivot_m": pivot,
        "yaw_rad": towards,
        "amplitude_rad": draft.between(0.1, 0.5),
        "period_s": draft.between(1, 3),
    }
    return {"swing": law}, [r, 0.0, 0.0], towards


def _draft(rng: np.random.Generator, model: str) -> Draft:
    if model not in REACH:
        draft = drafted(rng, model, "cup" if rng.uniform() < 0.7 else "none")
        if draft.chance(0.3):
            tcp = [float(x) for x in draft.request["robot"]["tool"]["tcp_m"]]
            draft.request["robot"]["tool"]["tcp_m"] = tcp
            tcp[0], tcp[1] = (draft.between(-0.05, 0.05) * draft.reach for _ in range(2))
        return draft
    draft = Draft(rng, model)
    draft.stand()
    draft.low, draft.high, draft.reach = 0.1, 0.5, REACH[model]
    tool: Document = {"tcp_m": [0.0, 0.0, 0.0]}
    if draft.chance(0.4):
        shape: Document = {"sphere": {"radius_m": draft.between(0.008, 0.02)}}
        tool["bodies"] = [{"name": "tip", "shape": shape, "at_m": [0.0, 0.0, 0.0]}]
    draft.begin(tool)
    if draft.chance(0.3):
        draft.request["robot"]["limits"] = {"acceleration": draft.between(0.4, 1.0)}
    return draft


def through_points(models: tuple[str, ...], moving_start: bool = False) -> Callable[[np.random.Generator], Draft]:
    """Moves and follows of arms of these models."""

    def make(rng: np.random.Generator) -> Draft:
        cell = Points(rng, str(rng.choice(models)))
        if moving_start:
            cell.in_motion()
        cell.steps(int(rng.integers(1, 4)))
        cell.options()
        surround(cell.draft, 2)
        _mesh(cell.draft)
        if cell.draft.chance(0.1):
            cell.draft.request["options"]["end"] = "moving"
            cell.draft.request["options"].pop("stay_safe_s", None)
        return cell.draft

    return make


def traced(models: tuple[str, ...]) -> Callable[[np.random.Generator], Draft]:
    """Paths that are traced by arms of these models."""

    def make(rng: np.random.Generator) -> Draft:
        cell = Points(rng, str(rng.choice(models)))
        cell.trace()
        if cell.draft.chance(0.4):
            cell.steps(1)
        surround(cell.draft, 2)
        return cell.draft

    return make


def blended(models: tuple[str, ...]) -> Callable[[np.random.Generator], Draft]:
    """Parabolic blends past some points, by arms of these models."""

    def make(rng: np.random.Generator) -> Draft:
        cell = Points(rng, str(rng.choice(models)))
        count = int(rng.integers(1, 4))
        for number in range(count):
            move: Document = {"to": cell.target(0.5, still=True)}
            if number < count - 1 and cell.draft.chance(0.6):
                move["via"] = True
            cell.draft.request["task"].append({"move": move})
        cell.draft.request["options"]["timing"] = "parabolic_blend"
        if cell.draft.chance(0.5):
            cell.draft.request["options"]["acceleration_time_s"] = cell.draft.between(0.15, 0.4)
        surround(cell.draft, 2)
        return cell.draft

    return make


def _mesh(draft: Draft) -> None:
    """Sometimes a shipped mesh that stands somewhere."""
    if draft.chance(0.3):
        asset = draft.one_of("bracket", "housing", "tray")
        angle, radius = draft.between(-2.2, 2.2), draft.between(0.5, 1.1) * draft.reach
        at = draft.at(angle, radius, draft.low + draft.between(-0.1, 0.5) * draft.stroke)
        draft.add_body("mesh", {"mesh": {"asset": asset, "unit": "mm"}}, at, draft.between(-3.0, 3.0))
