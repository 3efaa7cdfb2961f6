"""What a plan promises of its control points: where the tool is when they are met, how fast, and in which window."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchmarks.judge.arms import tilt
from benchmarks.judge.cell import grasp_of
from benchmarks.judge.faults import Violation, beyond
from benchmarks.judge.motion import Motion
from benchmarks.judge.poses import Document, Floats, Poses, short

MEET_M, MEET_RAD = 2e-6, 2e-6
"""Measured error that is allowed where a point is met."""
MEET_M_S, MEET_RAD_S = 5e-6, 5e-6
"""Likewise of the velocity and the yaw rate that are matched."""
TIME_S = 1e-8
REST = 1e-8
"""Rates of joints, rad/s or m/s."""
APART_S = 2e-5
"""Between the two instants from which a velocity follows."""


@dataclass(frozen=True, eq=False)
class Target:
    """Where the tool should be: a pose (the yaw None: any) in a frame; with pitch and roll where they are required."""

    frame: str
    pose: Poses
    yaw: bool
    pitch: float | None = None
    roll: float | None = None

    def at(self, motion: Motion, t: Floats) -> Poses:
        return motion.frame(self.frame, t).then(self.pose)


class Targets:
    """The tool's targets of all steps, as the parts go from hand to hand."""

    def __init__(self, motion: Motion) -> None:
        self._motion = motion
        self._parts = dict(motion.cell.seats)
        holding = motion.request["start"].get("holding")
        self._grasp = None if holding is None else grasp_of(holding)
        self.of_step: dict[int, Target] = {}
        for arrival in motion.answer["arrivals"]:
            self.of_step[arrival["step"]] = self._of(arrival)

    def _of(self, arrival: Document) -> Target:
        ((kind, given),) = self._motion.request["task"][arrival["step"]].items()
        turn = Poses.of(yaw=arrival["yaw_offset_rad"])
        turns = self._motion.arm.turns
        if kind == "pick":
            frame, pose = self._parts.pop(given["part"])
            self._grasp = grasp_of(given, arrival["yaw_offset_rad"])
            return Target(frame, pose.then(self._grasp), turns)
        if kind == "place":
            frame, pose = self._motion.cell.seat(given["to"])
            assert self._grasp is not None
            self._parts[given["part"]] = frame, pose
            return Target(frame, pose.then(self._grasp), turns)
        to = given["start"] if kind == "trace" else given["to"]
        frame, pose = self._motion.cell.seat(to)
        angles = {key: to[f"{key}_rad"] for key in ("pitch", "roll") if isinstance(to.get(f"{key}_rad"), float | int)}
        return Target(frame, pose.then(turn), turns and "yaw_rad" in to, angles.get("pitch"), angles.get("roll"))


def arrivals_kept(motion: Motion, targets: Targets) -> list[Violation]:
    found = list[Violation]()
    for arrival in motion.answer["arrivals"]:
        ((kind, given),) = motion.request["task"][arrival["step"]].items()
        found += _arrival(motion, arrival, kind, given, targets.of_step[arrival["step"]])
    steps = [arrival["step"] for arrival in motion.answer["arrivals"]]
    if steps != list(range(len(motion.request["task"]))):
        found.append(Violation("steps", str(steps), float(len(steps)), float(len(motion.request["task"]))))
    return found


def _arrival(motion: Motion, arrival: Document, kind: str, given: Document, target: Target) -> list[Violation]:
    name, t = arrival["control_point"], np.array([arrival["time_s"]])
    found = _timing(motion, arrival, kind, given, target)
    tool, wanted = motion.tool(t)[0], target.at(motion, t)[0]
    if arrival["missed_by"] is None:
        found += beyond("arrival", f"{name}, place", _far(tool.p, wanted.p), MEET_M, t[0])
        found += beyond("arrival", f"{name}, as reported", _far(tool.p, np.array(arrival["at_m"])), MEET_M, t[0])
        if target.yaw:
            found += beyond("arrival", f"{name}, yaw", float(abs(short(tool.yaw - wanted.yaw))), MEET_RAD, t[0])
        found += _tilt(motion, name, target, t)
    if given.get("via") or arrival["missed_by"] is not None or kind == "trace":
        return found
    if motion.request.get("options", {}).get("timing") == "parabolic_blend":
        rates = np.abs(motion.spline.evaluate(t, 1)).max()  # met at rest, and the acceleration jumps
        return found + beyond("match", f"{name}, at rest", float(rates), REST, t[0])
    if given.get("match", "velocity") == "position":
        speed, turning = _rates(motion, target, t, world=True)
    else:
        speed, turning = _rates(motion, target, t, world=False)
    found += beyond("match", f"{name}, velocity", speed, MEET_M_S, t[0])
    if target.yaw:
        found += beyond("match", f"{name}, yaw rate", turning, MEET_RAD_S, t[0])
    return found


def _tilt(motion: Motion, name: str, target: Target, t: Floats) -> list[Violation]:
    """Pitch and roll of the tool of an arm with five axes, from the rotation of its flange (H9)."""
    found, links = list[Violation](), motion.links(t)
    if "link4" not in links:
        return found
    for key, required, reached in zip(("pitch", "roll"), (target.pitch, target.roll), tilt(links), strict=True):
        if required is not None:
            off = float(np.abs(short(reached - required))[0])
            found += beyond("arrival", f"{name}, {key}", off, MEET_RAD, t[0])
    return found


def _far(a: Floats, b: Floats) -> float:
    return float(np.linalg.norm(a - b))


def _rates(motion: Motion, target: Target, t: Floats, world: bool) -> tuple[float, float]:
    """Speed and yaw rate of the tool against its target's, or in the world, m/s and rad/s, from two instants."""
    begin = max(t[0] - APART_S / 2.0, motion.start_s)
    end = min(begin + APART_S, motion.end_s)
    both = np.array([end - APART_S, end])
    tool, wanted = motion.tool(both), target.at(motion, both)
    way, turn = np.diff(tool.p, axis=0)[0], float(short(np.diff(tool.yaw))[0])
    if not world:
        way, turn = way - np.diff(wanted.p, axis=0)[0], turn - float(short(np.diff(wanted.yaw))[0])
    return float(np.linalg.norm(way)) / APART_S, abs(turn) / APART_S


def _timing(motion: Motion, arrival: Document, kind: str, given: Document, target: Target) -> list[Violation]:
    """Dwells and windows."""
    name, t0, t1, found = arrival["control_point"], arrival["time_s"], arrival["until_s"], list[Violation]()
    if kind in ("pick", "place", "follow"):
        required = float(given.get("duration_s" if kind == "follow" else "dwell_s", 0.0))
        found += beyond("dwell", name, abs(t1 - t0 - required), TIME_S, t0)
    begin, end = given.get("window_s", (-np.inf, np.inf))
    found += beyond("window", f"{name}, opens", float(begin) - t0, TIME_S, t0)
    found += beyond("window", f"{name}, closes", t1 - float(end), TIME_S, t1)
    line, spelt = motion.cell.frames[target.frame].line, motion.request.get("frames", {}).get(target.frame, {})
    law = spelt.get("conveyor", spelt.get("linear"))
    if law is None and arrival["along_m"] is not None:
        found.append(Violation("along", f"{name}: nothing to go along", float(arrival["along_m"]), 0.0, t0))
    if line is not None and law is not None:
        point = _point(motion, kind, given)
        at = motion.frame(point[0], np.array([t0, t1])).then(point[1]).p
        along = (at - np.array(law["at_m"])) @ line
        along_m = np.nan if arrival["along_m"] is None else float(arrival["along_m"])
        found += beyond("along", name, abs(along_m - float(along[0])), MEET_M, t0)
        first, last = given.get("window_m", (-np.inf, np.inf))
        found += beyond("window", f"{name}, along", float(first - along.min()), MEET_M, t0)
        found += beyond("window", f"{name}, along", float(along.max() - last), MEET_M, t1)
    return found


def _point(motion: Motion, kind: str, given: Document) -> tuple[str, Poses]:
    """What counts along a conveyor: the control point, where the tool should be."""
    if kind == "pick":
        frame, pose = motion.cell.seats[given["part"]]
        return frame, pose.then(grasp_of(given))
    return motion.cell.seat(given["start"] if kind == "trace" else given["to"])
