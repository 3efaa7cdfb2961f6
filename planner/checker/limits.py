"""Whether the spline keeps the joint limits at every instant, not at samples.

Control values bound a piece (V1), and those at its ends are taken. A piece whose control values keep the limit keeps
it; one that takes a value beyond breaks it; any other is halved and asked again. What is not decided in the end is
refused.
"""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.spline import Spline, cut
from assur.planner.checker.verdict import Code, Finding
from assur.planner.model.scene import Scene

RATE = 1e-9
"""Relative; for positions of half the range. Knots on a limit round to 1e-16 beyond it, and a touching parabola is
decided after some fifteen halvings; anyone who looks for excess looks for 1e-6."""
JERK = 1e-6
"""Relative. Jerk is a third difference of the knots' numbers: with pieces down to 10 µs they round it to some 1 rad/s³,
1e-4 of a usual limit, which a planner must leave free; what is checked here is the spline as written."""
HALVINGS = 45
"""A part is then 3e-14 of its piece: its ends cannot be told apart."""
KINDS = ("position", "velocity", "acceleration", "jerk")


def limits(scene: Scene, line: Spline) -> list[Finding]:
    """One finding for each kind of limit and joint that is broken, with the worst excess found and when.

    With parabolic blends the jerk has no bound, and is not looked at: the certificate says so (`blends`).
    """
    given = scene.robot.limits
    half, middle = (given.upper - given.lower) / 2, (given.upper + given.lower) / 2
    findings = []
    asked = line.control[:3] if scene.options.blended else line.control
    for kind, control in enumerate(asked):
        limit = (half, given.velocity, given.acceleration, given.jerk)[kind]
        allowed = limit * (1 + (JERK if kind == 3 else RATE))
        centred = control - middle[:, None] if kind == 0 else control
        for joint, (excess, time) in _broken(centred, allowed, line).items():
            what = f"{scene.robot.joints[joint].name} breaks its {KINDS[kind]} limit"
            unit = ("rad" if scene.robot.joints[joint].kind == "revolute" else "m") + ("", "/s", "/s²", "/s³")[kind]
            findings.append(Finding(Code.LIMIT, what, excess, unit, f"{time:.6g} s"))
    return findings


def _broken(control: FloatArray, allowed: FloatArray, line: Spline) -> dict[int, tuple[float, float]]:
    """By joint, the excess (and its time) of polynomials (K-1, n, d+1) in size over `allowed` (n,)."""
    size = np.abs(control)
    if (size.max((0, 2)) <= allowed).all():
        return {}
    piece, joint = np.nonzero(~(size.max(-1) <= allowed))
    row, s0, s1 = control[piece, joint], np.zeros(len(piece)), np.ones(len(piece))
    broken: dict[int, tuple[float, float]] = {}
    for _ in range(HALVINGS):
        if not len(row):
            return broken
        bound, taken = np.abs(row).max(1) - allowed[joint], np.abs(row[:, [0, -1]]).max(1) - allowed[joint]
        for k in np.flatnonzero(~(taken <= 0)):
            s = s0[k] if abs(row[k, 0]) >= abs(row[k, -1]) else s1[k]
            worst = (float(taken[k]), float(line.time[piece[k]] + s * line.length[piece[k]]))
            broken[int(joint[k])] = max(worst, broken.get(int(joint[k]), worst))
        # What is broken already needs no better excess than a joint's first few.
        open_ = ~(bound <= 0) & ~np.isin(joint, list(broken))
        row, piece, joint, s0, s1 = row[open_], piece[open_], joint[open_], s0[open_], s1[open_]
        zero, one, centre = np.zeros(len(row)), np.ones(len(row)), (s0 + s1) / 2
        row = np.concatenate([cut(row, zero, one / 2), cut(row, one / 2, one)])
        piece, joint = np.tile(piece, 2), np.tile(joint, 2)
        s0, s1 = np.concatenate([s0, centre]), np.concatenate([centre, s1])
    for i in range(len(row)):
        time = float(line.time[piece[i]] + s0[i] * line.length[piece[i]])
        broken[int(joint[i])] = (float(np.abs(row[i]).max() - allowed[joint[i]]), time)
    return broken
