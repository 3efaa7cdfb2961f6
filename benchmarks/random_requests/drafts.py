"""The pieces of random cells: arms, tools, places where parts come from and go to, obstacles.

All lengths follow from the arm's reach R and stroke, so that the same recipes do for an arm of 130 mm and of 600 mm.
Positions are thought of from the arm's base and written in the world.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from benchmarks.judge.arms import Arm, robot_file
from benchmarks.judge.poses import Document, Floats, Poses, si

SCARAS = (
    "mitsubishi-rh-6frh5520",
    "mitsubishi-rh-6crh6020",
    "fanuc-sr-3ia",
    "benchmark-scara",
    "fiuba-scara",
    "olier-scara",
    "lab-scara",
)
THREE_AXES = "oviedo-scara"
FIVE_BAR = "mitsubishi-rp-5ah"
ELBOW, POLAR, FIVE_AXES = TILTING = ("elbow-arm", "polar-arm", "mitsubishi-rv-m1")


class Choices:
    """What is chosen at random."""

    rng: np.random.Generator

    def between(self, low: float, high: float) -> float:
        return float(self.rng.uniform(low, high))

    def chance(self, share: float) -> bool:
        return bool(self.rng.uniform() < share)

    def one_of(self, *options: Any) -> Any:
        return options[int(self.rng.integers(len(options)))]


@dataclass(eq=False)
class Draft(Choices):
    """A request that is being written, in SI. `heading`: yaw of the base, rad; `low`, `high`: heights of the tool point
    above the base, m; `half`: half sizes of the part; `loose_m`, `upright_m`: how far parts may be off, about, where
    they are met."""

    rng: np.random.Generator
    model: str
    request: Document = field(default_factory=dict)
    base: Poses = field(default_factory=Poses.of)
    heading: float = 0.0
    low: float = 0.0
    high: float = 0.0
    reach: float = 0.0
    half: tuple[float, float, float] = (0.0, 0.0, 0.0)
    loose_m: float = 0.0
    upright_m: float = 0.0
    side: float = 1.0

    def stand(self) -> None:
        """Puts the arm somewhere."""
        at, self.heading = self.rng.uniform(-0.5, 0.5, 3), self.between(-math.pi, math.pi)
        self.base = Poses.of(at, self.heading)

    def begin(self, tool: Document) -> None:
        """The request with the arm at its base, a tool, and nothing else."""
        base = {"at_m": [float(x) for x in self.base.p], "yaw_rad": self.heading}
        self.request |= {"schema": "assur/1", "robot": {"model": self.model, "tool": tool, "base": base}}
        self.request |= {"start": {}, "frames": {}, "bodies": [], "task": [], "options": options_of(self)}

    @property
    def stroke(self) -> float:
        return self.high - self.low

    @property
    def five_bar(self) -> bool:
        return self.model == FIVE_BAR

    def at(self, angle: float, radius: float, z: float) -> list[float]:
        """A point given from the base, in the world."""
        return [float(x) for x in self.base.points((radius * math.cos(angle), radius * math.sin(angle), z))]

    def yaw(self, angle: float) -> float:
        return self.heading + angle

    def add_frame(self, name: str, law: Document, unknown: Document) -> None:
        self.request["frames"][name] = {**law, **({"uncertainty": unknown} if unknown else {})}

    def add_body(self, name: str, shape: Document, at: list[float], yaw: float = 0.0, frame: str = "world") -> Document:
        body = {"name": name, "shape": shape, "pose": {"frame": frame, "at_m": at, "yaw_rad": yaw}}
        self.request["bodies"].append(body)
        return body

    # what is not known

    def of_frame(self, line: bool, scale: float = 1.0) -> Document:
        """The uncertainty of a frame, sometimes none."""
        if self.chance(0.15):
            return {}
        found = {"position_m": self.between(0.0, 2e-3) * scale}
        if self.chance(0.4):
            found["speed_m_s"] = self.between(0.0, 1.5e-3) * scale
        if line and self.chance(0.4):
            found["lateral_m"] = self.between(0.0, 1e-3) * scale
        if self.chance(0.4):
            found["vertical_m"] = self.between(0.0, 4e-4) * scale
        if self.chance(0.3):
            found["yaw_rad"] = self.between(0.0, 4e-3)
        return found

    def loosen(self, body: Document, scale: float = 1.0) -> Document:
        """Gives a body an uncertainty, which is returned; sometimes none."""
        if self.chance(0.4):
            return {}
        found = {"position_m": self.between(0.0, 1e-3) * scale}
        if self.chance(0.5):
            found["yaw_rad"] = self.between(0.0, 0.03)
        if self.chance(0.4):
            found["vertical_m"] = self.between(0.0, 3e-4) * scale
        body["uncertainty"] = found
        return found

    def count(self, unknown: Document) -> None:
        """Adds what is not known to what contacts have to give way."""
        self.loose_m += unknown.get("position_m", 0.0) + 3.0 * unknown.get("speed_m_s", 0.0)
        self.loose_m += unknown.get("lateral_m", 0.0) + 0.1 * unknown.get("yaw_rad", 0.0)
        self.upright_m += unknown.get("vertical_m", 0.0)


def finished(request: Document) -> Document:
    """A request without what is empty, or is no part of it."""
    request.pop("beside_m", None)
    return {key: value for key, value in request.items() if value or key not in ("frames", "bodies")}


def drafted(rng: np.random.Generator, model: str, tool: str) -> Draft:
    """An arm of a model somewhere, with a tool, at rest, and nothing around it."""
    draft = Draft(rng, model)
    ((family, given),) = robot_file(model).items()
    draft.stand()
    draft.reach = float(si(given, "l1") + si(given, "l2")) if family == "scara" else 0.42
    lift = next(j for j in given["joints"] if any(key in j for key in ("range_mm", "range_m")))
    ends = sorted(float(lift.get("sign", 1)) * si(lift, "range") + float(si(lift, "zero", 0.0)))
    stroke = ends[1] - ends[0]
    length = draft.between(0.25, 0.5) * stroke
    draft.low, draft.high, draft.side = ends[0] - length, ends[1] - length, draft.one_of(-1.0, 1.0)
    width, deep = draft.between(0.03, 0.07) * draft.reach, draft.between(0.03, 0.06) * draft.reach
    draft.half = (width, deep, draft.between(0.05, 0.1) * stroke)
    joints = dict.fromkeys((joint["name"] for joint in given["joints"]), 0.0)
    draft.begin(_tool(draft, tool, length, given.get("tool_frame") == "z_down"))
    draft.request["execution"] = _execution(draft, given, list(joints))
    if draft.chance(0.3):
        draft.request["robot"]["limits"] = {"acceleration": draft.between(0.4, 1.0)}
    return draft


def start_above(draft: Draft, angle: float, radius: float) -> None:
    """Lets the tool begin at rest near its highest, above a place."""
    z = draft.low + draft.between(0.8, 0.95) * draft.stroke
    tool: Document = {"at_m": draft.at(angle, radius, z)}
    if draft.model != THREE_AXES:
        tool["yaw_rad"] = draft.yaw(angle) + draft.between(-0.5, 0.5)
    elbow = "left-right" if draft.five_bar else draft.one_of("left", "right")
    draft.request["start"].update({"at_s": draft.between(0.0, 2.0), "tool": tool, "elbow": elbow})


def _tool(draft: Draft, kind: str, length: float, down: bool) -> Document:
    sign, reach = (1.0 if down else -1.0), draft.reach
    tool: Document = {"tcp_m": [0.0, 0.0, sign * length]}
    if kind == "none":
        return tool
    if kind == "cup":
        radius = draft.between(0.012, 0.03) * reach
        shape: Document = {"cylinder": {"radius_m": radius, "height_m": length}}
        tool["bodies"] = [{"name": "cup", "shape": shape, "at_m": [0.0, 0.0, sign * length / 2.0]}]
        return tool
    # two jaws beside the part, below a palm
    beside, thick = draft.between(0.5e-3, 3e-3), 0.012 * reach
    draft.request["beside_m"] = beside
    below = 1.2 * draft.half[2]
    palm: Document = {"cylinder": {"radius_m": 0.03 * reach, "height_m": 0.6 * length}}
    jaw: Document = {"box": {"size_m": [thick, 0.03 * reach, 0.4 * length + below]}}
    middle = 0.6 * length + (0.4 * length + below) / 2.0
    x = draft.half[0] + beside + thick / 2.0
    tool["bodies"] = [
        {"name": "palm", "shape": palm, "at_m": [0.0, 0.0, sign * 0.3 * length]},
        {"name": "jaw-a", "shape": jaw, "at_m": [x, 0.0, sign * middle]},
        {"name": "jaw-b", "shape": jaw, "at_m": [-x, 0.0, sign * middle]},
    ]
    return tool


def options_of(draft: Draft) -> Document:
    """The options of a random cell."""
    found: Document = {
        "seed": int(draft.rng.integers(1000)),
        "budget_s": 60,
        "max_candidates": 24,
        "stop": "first",
        "report": "full",
        "elbow": "auto",
        "singularity_margin": draft.between(0.05, 0.2),
        "clearance_m": {"travel": draft.between(0.0, 5e-3), "near": draft.between(0.0, 1e-3)},
    }
    if draft.chance(0.3):
        found["stay_safe_s"] = draft.between(0.1, 1.0)
    return found


def _execution(draft: Draft, given: Document, names: list[str]) -> Document:
    found: Document = {}
    if draft.chance(0.6):
        found["start_tolerance_s"] = draft.between(0.0, 0.02)
    if draft.chance(0.7):
        lag = {}
        for name, joint in zip(names, given["joints"], strict=True):
            turns = "range_deg" in joint or "range_rad" in joint
            if draft.chance(0.8):
                lag[f"{name}_rad" if turns else f"{name}_m"] = draft.between(0.0, 1e-3 if turns else 3e-4)
        if lag:
            found["lag"] = lag
            draft.upright_m += sum(amount for name, amount in lag.items() if name.endswith("_m"))
            draft.loose_m += draft.reach * sum(amount for name, amount in lag.items() if name.endswith("_rad"))
    return found


def tool_reach(draft: Draft) -> tuple[float, float]:
    """Angle and radius, from the base, of a place that the tool reaches well."""
    if draft.five_bar:
        x, y = draft.between(0.22, 0.36), draft.side * draft.between(0.02, 0.14)
        draft.side = -draft.side
        return math.atan2(y, x), math.hypot(x, y)
    angle = draft.side * draft.between(0.35, 1.5)
    draft.side = -draft.side
    return angle, draft.between(0.55, 0.88) * draft.reach


def part_shape(draft: Draft) -> Document:
    """A shape that fits the part's half sizes."""
    x, y, z = (2.0 * half for half in draft.half)
    if draft.chance(0.65):
        return {"box": {"size_m": [x, y, z]}}
    return {"cylinder": {"radius_m": x / 2.0, "height_m": z}}


def neighbour_of(draft: Draft, count: int) -> Document:
    """Another SCARA that faces the same place and goes to and fro, from rest to rest."""
    model = draft.one_of(*SCARAS[:4])
    ((_, given),) = robot_file(model).items()
    reach = float(si(given, "l1") + si(given, "l2"))
    angle = draft.between(-2.0, 2.0)
    far = draft.reach + draft.between(0.5, 1.0) * reach
    robot = {
        "model": model,
        "base": {"at_m": draft.at(angle, far, 0.0), "yaw_rad": draft.yaw(angle) + draft.between(2.0, 4.0)},
        "tool": {"tcp_m": [0.0, 0.0, 0.0]},
    }
    arm = Arm.of(robot)
    middle, half = (arm.lower + arm.upper) / 2.0, (arm.upper - arm.lower) / 2.0
    rows: Floats = middle + half * draft.rng.uniform(-0.6, 0.6, (count, len(middle)))
    time = draft.request["start"].get("at_s", 0.0) + np.cumsum(draft.rng.uniform(0.5, 1.2, count)) - 0.7
    units = ["m" if f"{name}" in ("z", "j3", "d3") else "rad" for name in arm.names]
    found: Document = {
        "name": "other",
        "robot": robot,
        "trajectory": {
            "joint_names": list(arm.names),
            "joint_units": units,
            "time_s": time.tolist(),
            "position": rows.tolist(),
            "velocity": np.zeros_like(rows).tolist(),
            "acceleration": np.zeros_like(rows).tolist(),
        },
    }
    if draft.chance(0.6):
        found["start_uncertainty_s"] = draft.between(0.0, 0.03)
    return found
