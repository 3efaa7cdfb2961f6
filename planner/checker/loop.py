"""Whether a robot with a loop stays in its assembly mode throughout, as its own proof says of ranges of the joints.

Every piece of the spline is a range of joint positions (V1); what the robot does not prove of it is halved and asked
again, until a position is found that is not allowed, or intervals are too short: what is not decided is refused.
"""

from __future__ import annotations

import numpy as np

from assur.planner.checker.ranges import Ranges
from assur.planner.checker.verdict import Code, Finding
from assur.planner.model.scene import Scene

HALVINGS = 30
"""Of a piece, at most: one of a second is then a nanosecond long."""
MOST = 200_000
"""Intervals in a round after which the search ends undecided."""


def loops(scene: Scene, swept: Ranges) -> list[Finding]:
    """A finding if the trajectory is not proved to stay assembled, with the robot's least parallel margin."""
    robot, line = scene.robot, swept.spline
    everywhere = np.full((1, len(robot.joints)), np.inf)
    if robot.assembled(-everywhere, everywhere).all():
        return []  # no loop: it assembles wherever its joints are
    a, b = line.time[:-1], line.time[1:]
    for _ in range(HALVINGS):
        if len(a) > MOST:
            break
        bounds = swept.sweep(a, b)
        open_ = ~robot.assembled(bounds.lower, bounds.upper)
        a, b = a[open_], b[open_]
        if not len(a):
            return []
        middle = (a + b) / 2
        margin = robot.parallel_margin(line.state(middle)[0])
        bad = np.flatnonzero(~(margin >= robot.parallel_least))
        if len(bad):
            i = int(bad[np.argmin(np.where(np.isnan(margin[bad]), -np.inf, margin[bad]))])
            missing = robot.parallel_least - margin[i]
            what = f"{robot.name} leaves its assembly mode, or comes nearer to a type 2 singularity than it may"
            return [Finding(Code.ASSEMBLY, what, float(missing), "1", f"{middle[i]:.6g} s")]
        a, b = np.concatenate([a, middle]), np.concatenate([middle, b])
    what = f"{robot.name} is not proved to stay in its assembly mode"
    return [Finding(Code.ASSEMBLY, what, where=f"{a[0]:.6g} s")]
