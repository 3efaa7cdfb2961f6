"""The law of a frame that is a link of the other robot in the cell."""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.planner.kernels import law_columns as c
from assur.planner.laws import ALWAYS, ArmLink, Law, Numbers
from assur.planner.laws.validity import interval
from assur.planner.model.assembly_mode import leaves_assembly
from assur.planner.robots.robot import Robot
from assur.planner.trajectory import Trajectory


def link_law(robot: Robot, trajectory: Trajectory, link: int, valid: tuple[float, float] = ALWAYS) -> Law:
    """The frame of link number `link` of `robot`, which follows `trajectory` and is at rest before and after it.

    At the first knot the motion counts, at the last one the standing (equation F6).

    Raises `InputError` for a link that the robot has not, a robot with links that tilt, a trajectory of another number
    of joints, one whose acceleration jumps, one that does not begin and end at rest, or one on which a robot with a
    loop is not proved to stay assembled. Not checked: that the trajectory keeps the robot's limits.
    """
    links, joints = len(robot.links), len(robot.joints)
    if link not in range(links):
        raise InputError("neighbour.link", link, f"a link number from 0 to {links - 1} of {robot.name}")
    if trajectory.n != joints:
        raise InputError("neighbour.trajectory", trajectory.n, f"{joints} joints of {robot.name}")
    if robot.tilting:
        allowed = "an arm whose links stay upright: every frame of a cell turns about the vertical only"
        raise InputError("neighbour.robot", robot.name, allowed)
    if trajectory.jumps:
        raise InputError("neighbour.trajectory", "jumps in acceleration", "a trajectory without, as frames have none")
    for end, rests in (("start", trajectory.rest_at_start), ("end", trajectory.rest_at_end)):
        if not rests:
            raise InputError(f"neighbour.trajectory.{end}", "in motion", "at rest: no velocity, no acceleration")
    lost = leaves_assembly(robot, 0, trajectory)
    if lost is not None:
        at = "" if lost.interval is None else f" at {lost.interval[0]:.3f} s"
        allowed = f"a motion on which {robot.name} stays assembled"
        raise InputError("neighbour.trajectory", f"a type 2 singularity{at}", allowed)
    made, known = _tables(robot, trajectory, link), interval(valid, "neighbour.valid")
    return Law("link", Numbers(), known, *made, link=ArmLink(robot, trajectory, link))


def _tables(robot: Robot, trajectory: Trajectory, link: int) -> tuple[FloatArray, FloatArray]:
    """Row and side table of the law: robot and spline as one run of numbers
    (`assur.planner.kernels.laws.trajectory_of`)."""
    spline, row = trajectory.spline, np.zeros(c.LAW_COLUMNS)
    run = np.concatenate([part.ravel() for part in (robot.row, *spline)])
    row[[c.LINKED, c.LINK, c.COUNT]] = 1.0, link, len(spline[1])
    side = np.zeros((math.ceil(run.size / c.PIECE_COLUMNS), c.PIECE_COLUMNS))
    side.ravel()[: run.size] = run
    return row, side
