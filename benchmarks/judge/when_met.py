"""Whether the tool can be at a control point at all: inverse kinematics in all modes and turns, over a long time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from benchmarks.judge.arms import tilt
from benchmarks.judge.cell import Cell, grasp_of
from benchmarks.judge.inverse import Solution, solutions
from benchmarks.judge.poses import Document, Floats, Poses

HORIZON_S = 600.0
"""Length of the search in time."""
SAMPLE_S = 5e-3
YAWS = 720
"""Directions that are tried where the yaw is free and the tool point is beside the flange's axis."""
PITCHES = 720


@dataclass(frozen=True, eq=False)
class Point:
    """A control point: its pose in a frame, the yaws that the tool may have against it (None: any), pitch and roll
    (None: any), heights above it that are needed, m, and how long it is tracked, s."""

    frame: str
    pose: Poses
    yaws: tuple[float, ...] | None
    pitch: float | None
    roll: float | None
    heights: tuple[float, ...]
    dwell: float


class Reach:
    """Where and when the arm of a cell can be at control points."""

    def __init__(self, cell: Cell) -> None:
        self.cell, self.request, self.arm, self.frames = cell, cell.request, cell.arm, cell.frames
        self.least_margin = float(self.request["options"].get("singularity_margin", 0.05))
        """Where a point is met, the arm is no nearer to a singularity: here this is required of all points."""

    def point(self, number: int) -> Point | None:
        """The control point of a step; None for a place, whose part may be held in more than one way."""
        ((kind, given),) = self.request["task"][number].items()
        three = not self.arm.turns
        if kind in ("place", "trace"):
            return None
        if kind == "pick":
            body = next(each for each in self.request["bodies"] if each["name"] == given["part"])
            frame, pose = self.cell.seats[body["name"]]
            symmetry = int(body.get("yaw_symmetry", 1))
            turns = None if symmetry == 0 or three else tuple(2.0 * np.pi * k / symmetry for k in range(symmetry))
            # the grasp turns with the tool about the part's own axis: it is on it here
            grasped, dwell = pose.then(grasp_of(given)), float(given.get("dwell_s", 0.0))
            return Point(frame, grasped, turns, None, None, self.heights(given), dwell)
        frame, pose = self.cell.seat(given["to"])
        yaws = (0.0,) if "yaw_rad" in given["to"] and not three else None
        angles = [given["to"].get(f"{key}_rad") for key in ("pitch", "roll")]
        return Point(frame, pose, yaws, angles[0], angles[1], (0.0,), float(given.get("duration_s", 0.0)))

    def heights(self, pick: Document) -> tuple[float, float, float]:
        """Heights of the tool above a pick's control point that are needed: there, before and after it, m."""
        travel = float(self.request["options"].get("clearance_m", {}).get("travel", 0.0))
        before, after = (max(float(pick[end]["m"]), 1.1 * travel) for end in ("approach", "depart"))
        return 0.0, before, after

    def times(self, point: Point, number: int) -> Floats:
        """When the point may be met, densely; one instant if it is fixed and may be met at any time."""
        spans = self.open(point, number)
        if not self.frames[point.frame].moves:
            return np.array([spans[0][0]]) if spans else np.zeros(0)
        return np.concatenate(
            [np.linspace(t0, t1, max(int((t1 - t0) / SAMPLE_S), 1) + 1) for t0, t1 in spans] or [np.zeros(0)]
        )

    def open(self, point: Point, number: int) -> list[tuple[float, float]]:
        """Intervals in which the point may be tracked, from the start to the horizon, s: window, law, latest end."""
        ((_, given),) = self.request["task"][number].items()
        spelt, options = self.request.get("frames", {}).get(point.frame, {}), self.request["options"]
        low, high = given.get("window_s", (-np.inf, np.inf))
        first, last = spelt.get("valid_s", (-np.inf, np.inf))
        low = max(float(low), self.cell.start_s, float(first))
        high = min(float(high), float(last), float(options.get("latest_end_s", np.inf)), low + HORIZON_S)
        if not low <= high:
            return []
        if "window_m" not in given or "conveyor" not in spelt:
            return [(low, high)]
        law, (begin, end) = spelt["conveyor"], given["window_m"]
        line = self.frames[point.frame].line
        assert line is not None

        def inside(t: Floats) -> Floats:
            p = self.frames[point.frame].at(t).then(point.pose).p
            along = (p - np.array(law["at_m"])) @ line
            return np.asarray(np.minimum(along - begin, end - along))

        grid = np.unique(np.append(np.arange(low, high, SAMPLE_S), high))
        value = inside(grid)
        good = np.concatenate([[False], value >= 0.0, [False]])
        found = list[tuple[float, float]]()
        first, last = np.flatnonzero(good[1:] & ~good[:-1]), np.flatnonzero(good[:-1] & ~good[1:]) - 1
        for k, m in zip(first, last, strict=True):
            t0 = grid[k] if k == 0 else _edge(inside, grid[k - 1], grid[k])
            t1 = grid[m] if m + 1 == len(grid) else _edge(inside, grid[m + 1], grid[m])
            found.append((float(t0), float(t1)))
        return found

    def best(self, point: Point, number: int) -> tuple[float, float, str]:
        """The least of what is missing of any joint position at the point and at all heights, in one of the modes that
        may be used, m or rad; when, s; and in which mode. Infinite if the point may be met at no time."""
        t = self.times(point, number)
        if len(t) == 0:
            return np.inf, np.nan, ""
        missing, when, mode = self._least(point, t)
        if len(t) > 1 and np.isfinite(missing):
            for step in (SAMPLE_S, SAMPLE_S / 20.0, SAMPLE_S / 400.0, SAMPLE_S / 8000.0):
                near = np.clip(when + np.linspace(-step, step, 81), t[0], t[-1])
                finer = self._least(point, near)
                if finer[0] < missing:
                    missing, when, mode = finer
        return missing, when, mode

    def _least(self, point: Point, t: Floats) -> tuple[float, float, str]:
        found: tuple[float, float, str] = (np.inf, np.nan, "")
        for places in self.tools(point, t):
            of_mode: dict[str, Floats] = {}
            for height in point.heights:
                for each in self.postures(point, places, height):
                    worst = np.where(each.margin >= self.least_margin, each.missing, np.inf)
                    of_mode[each.mode] = np.maximum(of_mode.get(each.mode, -np.inf), worst)
            for mode, values in of_mode.items():
                k = int(np.argmin(values))
                if self.allowed(mode) and values[k] < found[0]:
                    found = (float(values[k]), float(t[k]), mode)
        return found

    def tools(self, point: Point, t: Floats) -> list[Poses]:
        """Where the tool may be at times (T,), one for each of its yaws; pitches are counted apart."""
        there = self.frames[point.frame].at(t).then(point.pose)
        tcp = self.arm.tcp
        if point.yaws is not None:
            return [there.moved(0.0, turn) for turn in point.yaws]
        if self.arm.tilts or float(np.hypot(tcp.p[0], tcp.p[1])) == 0.0:
            return [there]
        if len(t) > 1:
            yaws = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
        else:
            yaws = np.linspace(0.0, 2.0 * np.pi, YAWS, endpoint=False)
        return [there.moved(0.0, yaw) for yaw in yaws]

    def postures(self, point: Point, tool: Poses, height: float = 0.0) -> list[Solution]:
        """All solutions with the tool at places (T,), raised by a height."""
        flange = tool.then(self.arm.tcp.inverse())
        p = flange.p + np.array([0.0, 0.0, height])
        if self.arm.tilts:
            if self.arm.family != "five_axis_arm":
                return solutions(self.arm, p, None)
            full = np.ones(len(p))
            roll = None if point.roll is None else point.roll * full
            pitches = np.linspace(-np.pi, np.pi, PITCHES) if point.pitch is None else [point.pitch]
            return [each for pitch in pitches for each in solutions(self.arm, p, None, pitch * full, roll)]
        if not self.arm.turns or point.yaws is not None:
            return solutions(self.arm, p, flange.yaw)
        beside = float(np.hypot(self.arm.tcp.p[0], self.arm.tcp.p[1])) > 0.0
        return solutions(self.arm, p, flange.yaw if beside else None)

    def allowed(self, mode: str) -> bool:
        """Whether the request allows a working mode; of the start's only the family knows."""
        elbow = self.request["options"].get("elbow", "keep")
        if elbow in ("auto", mode):
            return True
        return elbow == "keep" and mode == self.start_mode()

    def start_mode(self) -> str:
        """The working mode of the arm at the start."""
        q = self.start_joints()
        links = self.arm.links(q)
        pitch, roll = tilt(links) if "link4" in links else (None, None)
        found = solutions(self.arm, links["flange"].p, links["flange"].yaw, pitch, roll)
        off = [float(np.abs((each.q[0] - q[0] + np.pi) % (2 * np.pi) - np.pi).max()) for each in found]
        return found[int(np.argmin(off))].mode

    def start_joints(self) -> Floats:
        """Of the start, (1, n); it states joints."""
        return self.arm.values(self.request["start"]["joints"])[None]


def _edge(inside: Callable[[Floats], Floats], out: float, within: float) -> float:
    """Where a window begins between an instant outside of it and one inside."""
    for _ in range(60):
        middle = (out + within) / 2.0
        if inside(np.array([middle]))[0] >= 0.0:
            within = middle
        else:
            out = middle
    return within
