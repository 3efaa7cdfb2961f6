"""Other robots in the cell: each of their links is a frame that moves as their own trajectory says."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import Body
from assur.planner.laws import Frame, Uncertainty, fixed
from assur.planner.model.scene import WorldBody
from assur.scenes.bounds import SHORTEST_STEP_S
from assur.scenes.conventions import Conventions, converted, converted_rates
from assur.scenes.faults import Refused, within
from assur.scenes.reading import robots
from assur.scenes.reading.bodies import Places
from assur.scenes.schema import answer
from assur.scenes.schema.robots import NeighbourDocument

if TYPE_CHECKING:
    from assur.planner.trajectory import Trajectory


def crowded(time: FloatArray, *, jumps: bool) -> int | None:
    """The first of knots at `time` (K,) s that is less than `SHORTEST_STEP_S` later than the one before it; None: there
    is none. `jumps`: whether two knots may be at one time. Times are rounded: a step may be short by as much."""
    step = np.diff(time)
    short = ~(step >= SHORTEST_STEP_S - 4.0 * np.spacing(np.abs(time[1:]) + SHORTEST_STEP_S))
    wrong = np.flatnonzero(short & (step != 0.0) if jumps else short)
    return int(wrong[0]) + 1 if len(wrong) else None


def trajectory_of(item: answer.Trajectory, conventions: Conventions) -> Trajectory:
    """The planner's trajectory from one in the maker's convention. Raises `Refused` at the field at fault."""
    from assur.planner.trajectory import Trajectory

    names = [joint.name for joint in conventions]
    units = [joint.unit for joint in conventions]
    if item["joint_names"] != names:
        raise Refused(f"{names}", "joint_names")
    if item["joint_units"] != units:
        raise Refused(f"{units}", "joint_units")
    arrays = []
    times = item["time_s"]
    instants = np.array(times, dtype=np.float64)
    k = crowded(instants, jumps=item.get("acceleration_jumps", False))
    if k is not None:
        raise Refused(
            f"a time {SHORTEST_STEP_S:g} s at least later than {times[k - 1]:.15g} s, the one before", "time_s", k
        )
    for key, rows in (
        ("position", item["position"]),
        ("velocity", item["velocity"]),
        ("acceleration", item["acceleration"]),
    ):
        if len(rows) != len(times):
            raise Refused(f"{len(times)} rows, one for each time", key)
        for k, row in enumerate(rows):
            if len(row) != len(names):
                raise Refused(f"{len(names)} numbers, one for each joint", key, k)
        turned = converted if key == "position" else converted_rates
        arrays.append(turned(np.array(rows, dtype=np.float64), conventions))
    try:
        q, qd, qdd = arrays
        return Trajectory(instants, q, qd, qdd, jumps=item.get("acceleration_jumps", False))
    except InputError as error:
        raise Refused(error.allowed, *(["time_s"] if "time" in error.field else [])) from error


def add_neighbour(item: NeighbourDocument, frames: dict[str, Frame], places: Places) -> list[WorldBody]:
    """Puts a neighbour's links among the frames and gives its bodies, all called NEIGHBOUR/name."""
    from assur.planner.model.link_frames import link_law

    with within("robot"):
        given = robots.equipped(item.robot)
        robot = given.robot
        if robot.tilting:
            raise Refused("an arm whose links stay upright, not one whose links tilt")
        if given.forbidden_yaw:
            raise Refused("none: a neighbour does what its trajectory says", "limits", "forbidden_yaw_rad")
    if item.trajectory is None:
        raise Refused("a trajectory in its place: a request never names a file", "plan", "file")
    shift = Uncertainty(shift_s=(-item.start_uncertainty_s, item.start_uncertainty_s))
    with within("trajectory"):
        if item.trajectory.acceleration_jumps:
            allowed = "false: a neighbour's links are frames, and the acceleration of a frame does not jump"
            raise Refused(allowed, "acceleration_jumps")
        spelt: answer.Trajectory = item.trajectory.model_dump()  # type: ignore[assignment]
        if item.starts_at_s is not None:
            spelt["time_s"] = [item.starts_at_s + (t - spelt["time_s"][0]) for t in spelt["time_s"]]
        trajectory = trajectory_of(spelt, given.conventions)
        if not (trajectory.rest_at_start and trajectory.rest_at_end):
            raise Refused("rest at its first and last knot: it stands still before and after", "velocity")
        for number, link in enumerate(robot.links):
            name = f"{item.name}/{link}"
            if link == "base":
                frames[name] = Frame(name, fixed(robot.base))
            else:
                frames[name] = Frame(name, link_law(robot, trajectory, number), shift)
    carried = [(body.body, robot.links[body.link]) for body in robot.bodies]
    carried += [(body, "flange") for body in given.tool.bodies]
    found = []
    for body, link in carried:
        renamed = Body(f"{item.name}/{body.name}", body.pieces, body.surface)
        if renamed.name in places:
            raise Refused(f"bodies with different names; {body.name} is there twice", "robot")
        places[renamed.name] = (f"{item.name}/{link}", Pose())
        found.append(WorldBody(renamed, f"{item.name}/{link}"))
    return found
