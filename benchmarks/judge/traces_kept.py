"""What a plan promises of a path that is traced: where the tool is at each instant of it, and how fast it goes there.

Paths here are lines and arcs that go over into each other without a corner; of others only the ends are evaluated.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchmarks.judge.arrivals_kept import Target
from benchmarks.judge.faults import Violation, beyond
from benchmarks.judge.motion import Motion
from benchmarks.judge.poses import Document, Floats

TRACKED_M = 1e-5
READ_M = 1e-7
SPEED_SHARE = 1e-2
CORNER_RAD = 1e-3


@dataclass(frozen=True, eq=False)
class Part:
    """A line; or an `arc`: its centre, unit vectors (3,) outwards and ahead at its beginning, and radius, m."""

    begin: Floats
    end: Floats
    length: float
    arc: tuple[Floats, Floats, Floats, float] | None = None

    def at(self, s: Floats) -> Floats:
        if self.arc is None:
            return self.begin + s[:, None] * (self.end - self.begin) / self.length
        centre, out, ahead, radius = self.arc
        angle = s[:, None] / radius
        return centre + radius * (np.cos(angle) * out + np.sin(angle) * ahead)

    def tangent(self, s: float) -> Floats:
        if self.arc is None:
            return np.asarray((self.end - self.begin) / self.length)
        _, out, ahead, radius = self.arc
        return np.asarray(-np.sin(s / radius) * out + np.cos(s / radius) * ahead)


def line(begin: Floats, end: Floats) -> Part:
    return Part(begin, end, float(np.linalg.norm(end - begin)))


def arc(begin: Floats, via: Floats, end: Floats) -> Part:
    """The arc from a point through another to a third: its centre is as far from all three."""
    a, b = via - begin, end - begin
    n = np.cross(a, b)
    n = n / np.linalg.norm(n)
    # in the plane: two chords, each bisected
    rows = np.array([a, b, n])
    centre = begin + np.linalg.solve(rows, np.array([a @ a / 2.0, b @ b / 2.0, 0.0]))
    radius = float(np.linalg.norm(begin - centre))
    out = (begin - centre) / radius
    ahead = np.cross(n, out)
    angle = float(np.arctan2((end - centre) @ ahead, (end - centre) @ out)) % (2.0 * np.pi)
    return Part(begin, end, radius * angle, (centre, out, ahead, radius))


def parts_of(start: Floats, path: list[Document]) -> list[Part] | None:
    """The parts of a path from `start`; None if there is one that is not known here, or a corner."""
    found: list[Part] = []
    here = start
    for piece in path:
        ((kind, given),) = piece.items()
        if kind == "spline":
            return None
        end = np.array(given["to_m"])
        part = line(here, end) if kind == "line" else arc(here, np.array(given["via_m"]), end)
        if found and found[-1].tangent(found[-1].length) @ part.tangent(0.0) < np.cos(CORNER_RAD):
            return None
        found.append(part)
        here = end
    return found


def on_path(parts: list[Part], s: Floats) -> Floats:
    """Points (N, 3) at lengths (N,)."""
    found, begin = np.empty((len(s), 3)), 0.0
    for k, part in enumerate(parts):
        last = k == len(parts) - 1
        inside = (s >= begin - (1.0 if k == 0 else 0.0)) & ((s < begin + part.length) | last)
        found[inside] = part.at(s[inside] - begin)
        begin += part.length
    return found


def traces_kept(motion: Motion) -> list[Violation]:
    found = list[Violation]()
    for arrival in motion.answer["arrivals"]:
        ((kind, given),) = motion.request["task"][arrival["step"]].items()
        if kind == "trace":
            found += _trace(motion, arrival, given)
    return found


def _trace(motion: Motion, arrival: Document, given: Document) -> list[Violation]:
    speed, t0, t1 = float(given["speed_m_s"]), float(arrival["time_s"]), float(arrival["until_s"])
    frame, at = motion.cell.seat({**given["start"], "at_m": [0.0, 0.0, 0.0]})
    target = Target(frame, at.moved(0.0, -float(given["start"].get("yaw_rad", 0.0))), False)
    t = np.linspace(t0, t1, max(int((t1 - t0) / 1e-3), 20) + 1)
    local = target.at(motion, t).inverse().points(motion.tool(t).p)
    name, stated, found = arrival["control_point"], arrival["trace"], list[Violation]()
    parts = parts_of(np.array(given["start"]["at_m"]), given["path"])
    if parts is not None:
        length = sum(part.length for part in parts)
        found += beyond("trace", f"{name}, length", abs(stated["length_m"] - length), 1e-6, t0)
        found += beyond("trace", f"{name}, time", abs((t1 - t0) * speed - length), 1e-6, t0)
        off = np.linalg.norm(local - on_path(parts, (t - t0) * speed), axis=1)
        k = int(off.argmax())
        found += beyond("trace", f"{name}, place", float(off[k]), min(TRACKED_M, stated["error_m"]) + READ_M, t[k])
    h = 1e-5
    inner = np.clip(t, t0 + h, t1 - h)
    ends = [target.at(motion, inner + k).inverse().points(motion.tool(inner + k).p) for k in (-h, h)]
    size = np.linalg.norm(ends[1] - ends[0], axis=1) / (2.0 * h)
    for k in (int(size.argmin()), int(size.argmax())):
        found += beyond("trace", f"{name}, speed", abs(float(size[k]) / speed - 1.0), SPEED_SHARE + 1e-6, t[k])
    found += beyond("trace", f"{name}, fastest", float(size.max()), stated["fastest_m_s"] * (1.0 + 1e-6), t0)
    return found + beyond("trace", f"{name}, slowest", stated["slowest_m_s"], float(size.min()) * (1.0 + 1e-6), t0)
