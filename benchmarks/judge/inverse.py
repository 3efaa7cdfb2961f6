"""Where the joints of an arm must be so that its flange is somewhere, in every working mode, of all families.

Written from docs/kinematics.md (K1 to K3, K23 to K25, H2, H3, K35) as the geometry of triangles: the cosine rule.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from benchmarks.judge.arms import Arm
from benchmarks.judge.poses import Floats, si

TURNS = 2.0 * np.pi * np.arange(-3.0, 4.0)
PARALLEL = 0.1
"""How near to one line the couplers of a five-bar may come, unless its document says otherwise."""


@dataclass(frozen=True, eq=False)
class Solution:
    """In one working mode, at N places: `q` (N, n), each joint in its best turn; `short`, by how much the links are too
    short or too long, m (N,); `beyond`, by how much each joint is beyond its range, rad or m (N, n), 0 or less inside;
    `margin` of the arm (N,): 0 where it is singular."""

    mode: str
    q: Floats
    short: Floats
    beyond: Floats
    margin: Floats

    @property
    def missing(self) -> Floats:
        """The most of what is missing at each place (N,), rad or m: 0 or less where the arm can be there."""
        return np.asarray(np.maximum(self.short, self.beyond.max(axis=1)))


def solutions(
    arm: Arm, p: Floats, yaw: Floats | None, pitch: Floats | None = None, roll: Floats | None = None
) -> list[Solution]:
    """Of the flange at places p (N, 3) in the world, m. Angles (N,) that are None do not count: a yaw is that of the
    flange; an arm with five axes needs a pitch, and a roll that is None is any."""
    if arm.tilts:
        return list(_tilting(arm, p, pitch, roll))
    return list(_scara(arm, p, yaw) if arm.family == "scara" else _five_bar(arm, p, yaw))


def _finished(arm: Arm, mode: str, q: Floats, short: Floats, margin: Floats, free: tuple[int, ...] = ()) -> Solution:
    """Every joint that turns in the turn in which it is least beyond its range; `free` ones are anywhere."""
    best = np.empty_like(q)
    over = np.empty_like(q)
    for j in range(q.shape[1]):
        turns = np.zeros(1) if arm.slides[j] else TURNS
        all_ = q[:, j, None] + turns
        beyond = np.maximum(arm.lower[j] - all_, all_ - arm.upper[j])
        k = beyond.argmin(axis=1)
        rows = np.arange(len(q))
        best[:, j], over[:, j] = all_[rows, k], beyond[rows, k]
        if j in free:
            best[:, j], over[:, j] = (arm.lower[j] + arm.upper[j]) / 2.0, arm.lower[j] - arm.upper[j]
    return Solution(mode, best, short, over, margin)


def _triangle(d: Floats, a: float, b: float) -> tuple[Floats, Floats]:
    """The angle between two links a and b in line at 0, whose ends are d apart, and by how much they are too short or
    too long."""
    cosine = (d**2 - a**2 - b**2) / (2.0 * a * b)
    return np.arccos(np.clip(cosine, -1.0, 1.0)), np.maximum(np.maximum(d - a - b, abs(a - b) - d), 0.0)


def _scara(arm: Arm, p: Floats, yaw: Floats | None) -> Iterator[Solution]:
    l1, l2 = arm.length("l1"), arm.length("l2")
    x, y = p[:, 0] - arm.base.p[0], p[:, 1] - arm.base.p[1]
    elbow, short = _triangle(np.hypot(x, y), l1, l2)
    for mode, sign in (("right", 1.0), ("left", -1.0)):
        second = sign * elbow
        first = np.arctan2(y, x) - np.arctan2(l2 * np.sin(second), l1 + l2 * np.cos(second))
        ours = [first - float(arm.base.yaw), second, p[:, 2] - arm.base.p[2] - arm.zero]
        free: tuple[int, ...] = ()
        if arm.turns:
            ours.append(np.zeros(len(p)) if yaw is None else yaw - first - second)
            free = (arm.order[3],) if yaw is None else ()
        q = np.empty((len(p), len(arm.names)))
        for i, j in enumerate(arm.order):
            q[:, j] = ours[i] * arm.signs[j]
        yield _finished(arm, mode, q, short, np.abs(np.sin(second)), free)


def _five_bar(arm: Arm, p: Floats, yaw: Floats | None) -> Iterator[Solution]:
    separation, psi = arm.length("separation"), float(arm.base.yaw)
    cranks, couplers = si(arm.numbers, "proximal"), si(arm.numbers, "distal")
    c, s = np.cos(psi), np.sin(psi)
    dx, dy = p[:, 0] - arm.base.p[0], p[:, 1] - arm.base.p[1]
    tip = np.stack([c * dx + s * dy, c * dy - s * dx], axis=1)
    for first in (1.0, -1.0):
        for second in (1.0, -1.0):
            angles, elbows, short, serial = [], [], np.zeros(len(p)), np.ones(len(p))
            for side, sign in ((0, first), (1, second)):
                a, b = float(cranks[side]), float(couplers[side])
                pivot = np.array([0.0, (0.5 if side == 0 else -0.5) * separation])
                way = tip - pivot
                bend, missing = _triangle(np.linalg.norm(way, axis=1), a, b)
                # the elbow is left of the line to the tip where the crank is turned on from it
                angle = np.arctan2(way[:, 1], way[:, 0]) + sign * np.arctan2(b * np.sin(bend), a + b * np.cos(bend))
                angles.append(angle)
                elbows.append(pivot + a * np.stack([np.cos(angle), np.sin(angle)], axis=1))
                short, serial = np.maximum(short, missing), np.minimum(serial, np.abs(np.sin(bend)))
            u, w = tip - elbows[0], elbows[1] - tip
            parallel = -(u[:, 0] * w[:, 1] - u[:, 1] * w[:, 0]) / (couplers[0] * couplers[1])
            parallel = parallel if arm.numbers["assembly"] == "front" else -parallel
            q = np.stack([angles[0], angles[1], p[:, 2] - arm.base.p[2] - arm.zero], axis=1)
            free: tuple[int, ...] = ()
            if arm.turns:
                turn = np.zeros(len(p)) if yaw is None else yaw - psi - np.arctan2(u[:, 1], u[:, 0])
                q, free = np.column_stack([q, turn]), ((3,) if yaw is None else ())
            least = float(arm.numbers.get("parallel_margin", PARALLEL))
            margin = np.where(parallel >= least, serial, -1.0)
            names = {1.0: "left", -1.0: "right"}
            yield _finished(arm, f"{names[first]}-{names[second]}", q * arm.signs, short, margin, free)


def _tilting(arm: Arm, p: Floats, pitch: Floats | None, roll: Floats | None) -> Iterator[Solution]:
    x, y = p[:, 0] - arm.base.p[0], p[:, 1] - arm.base.p[1]
    height, flat = p[:, 2] - arm.base.p[2] - arm.length("height"), np.hypot(x, y)
    for back in (False, True):
        rho = -flat if back else flat
        heading = np.arctan2(y, x) + (np.pi if back else 0.0) - float(arm.base.yaw)
        if arm.family == "polar_arm":
            d, most = np.hypot(rho, height), float(arm.upper[2])
            q = np.stack([heading, np.arctan2(height, rho), d], axis=1)
            margin = np.minimum(d / most, flat / most)
            yield _finished(arm, "back" if back else "front", q, np.zeros(len(p)), margin)
            continue
        l1, l2 = arm.lengths[0], arm.lengths[1]
        wrist = np.stack([rho, height], axis=1)
        if arm.family == "five_axis_arm":
            if pitch is None:
                raise ValueError("an arm with five axes needs a pitch")
            wrist = wrist - arm.lengths[2] * np.stack([np.cos(pitch), np.sin(pitch)], axis=1)
        bend, short = _triangle(np.linalg.norm(wrist, axis=1), l1, l2)
        for sign in (-1.0, 1.0):
            third = sign * bend
            second = np.arctan2(wrist[:, 1], wrist[:, 0]) - np.arctan2(l2 * np.sin(third), l1 + l2 * np.cos(third))
            margin = np.minimum(np.abs(np.sin(third)), flat / sum(arm.lengths))
            up = (sign < 0.0) != back
            mode = ("back-" if back else "") + ("up" if up else "down")
            columns = [heading, second, third]
            free: tuple[int, ...] = ()
            if arm.family == "five_axis_arm" and pitch is not None:
                columns += [pitch - second - third, np.zeros(len(p)) if roll is None else roll]
                free = (4,) if roll is None else ()
            yield _finished(arm, mode, np.stack(columns, axis=1), short, margin, free)
