"""The other robot in the cell: a link of an arm that runs a plan made earlier."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.planner.frames.motion import Motion
from assur.planner.frames.validity import ALWAYS, KnownLaw, interval
from assur.planner.model.assembly_mode import leaves_assembly
from assur.planner.robots.robot import Robot
from assur.planner.trajectory import Trajectory
from assur.planner.trajectory.spline import Spline, spline_table


@dataclass(frozen=True, eq=False)
class TrajectoryLaw(KnownLaw):
    """The frame of link number `link` of `robot`, which follows `trajectory` and stands still before and after it.

    At the first knot the motion counts, at the last one the standing (equation F6).

    Raises `InputError` for a link that the robot has not, a robot with links that tilt, a trajectory of another number
    of joints, one whose acceleration jumps, one that does not begin and end at rest, or one on which a robot with a
    loop is not proved to stay assembled. Not checked: that the trajectory keeps the robot's limits.
    """

    robot: Robot
    trajectory: Trajectory
    link: int
    valid: tuple[float, float] = ALWAYS
    spline: Spline = field(init=False, repr=False)
    """The trajectory as tables."""

    def __post_init__(self) -> None:
        links, joints = len(self.robot.links), len(self.robot.joints)
        if self.link not in range(links):
            raise InputError("neighbour.link", self.link, f"a link number from 0 to {links - 1} of {self.robot.name}")
        if self.trajectory.n != joints:
            raise InputError("neighbour.trajectory", self.trajectory.n, f"{joints} joints of {self.robot.name}")
        if self.robot.tilting:
            allowed = "an arm whose links stay upright: every frame of a cell turns about the vertical only"
            raise InputError("neighbour.robot", self.robot.name, allowed)
        if self.trajectory.jumps:
            raise InputError(
                "neighbour.trajectory", "jumps in acceleration", "a trajectory without, as frames have none"
            )
        for end, rests in (("start", self.trajectory.rest_at_start), ("end", self.trajectory.rest_at_end)):
            if not rests:
                raise InputError(f"neighbour.trajectory.{end}", "in motion", "at rest: no velocity, no acceleration")
        lost = leaves_assembly(self.robot, 0, self.trajectory)
        if lost is not None:
            at = "" if lost.interval is None else f" at {lost.interval[0]:.3f} s"
            allowed = f"a motion on which {self.robot.name} stays assembled"
            raise InputError("neighbour.trajectory", f"a type 2 singularity{at}", allowed)
        object.__setattr__(self, "valid", interval(self.valid, "neighbour.valid"))
        object.__setattr__(self, "spline", spline_table(self.trajectory, self.robot.rate_matrix))

    def _motion(self, t: FloatArray, /) -> Motion:
        path = self.trajectory
        held = np.minimum(np.maximum(t, path.start), path.end)
        q, qd, qdd, qddd = (path.evaluate(held, derivative) for derivative in range(4))
        # At rest the first three are zero by themselves; the jerk is not, it jumps.
        moving = (path.start <= t) & (t < path.end)
        return self.robot.link_motion(self.link, q, qd, qdd, np.where(moving[..., None], qddd, 0.0))
