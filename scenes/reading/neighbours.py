"""Other robots in the cell: each of their links is a frame that moves as their own trajectory says."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from assur.planner.errors import InputError
from assur.planner.frames import Fixed, Frame
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import Body
from assur.planner.model.scene import WorldBody
from assur.scenes.conventions import Conventions, converted
from assur.scenes.faults import Path, fault, located
from assur.scenes.reading import robots
from assur.scenes.reading.bodies import Places
from assur.scenes.schema import answer
from assur.scenes.schema.robots import NeighbourDocument

if TYPE_CHECKING:
    from assur.planner.trajectory import Trajectory


def trajectory_of(document: object, path: Path, item: answer.Trajectory, conventions: Conventions) -> Trajectory:
    """The planner's trajectory from one in the maker's convention. Raises `DocumentError` at the field at fault."""
    from assur.planner.trajectory import Trajectory

    names = [joint.name for joint in conventions]
    units = [joint.unit for joint in conventions]
    if item["joint_names"] != names:
        raise fault(document, (*path, "joint_names"), f"{names}")
    if item["joint_units"] != units:
        raise fault(document, (*path, "joint_units"), f"{units}")
    arrays = []
    times = item["time_s"]
    for key, rows in (
        ("position", item["position"]),
        ("velocity", item["velocity"]),
        ("acceleration", item["acceleration"]),
    ):
        if len(rows) != len(times):
            raise fault(document, (*path, key), f"{len(times)} rows, one for each time")
        for k, row in enumerate(rows):
            if len(row) != len(names):
                raise fault(document, (*path, key, k), f"{len(names)} numbers, one for each joint")
        arrays.append(converted(np.array(rows, dtype=np.float64), conventions))
    try:
        q, qd, qdd = arrays
        return Trajectory(np.array(times, dtype=np.float64), q, qd, qdd, jumps=item.get("acceleration_jumps", False))
    except InputError as error:
        key = "time_s" if "time" in error.field else ""
        raise fault(document, (*path, key) if key else path, error.allowed) from error


def add_neighbour(
    document: object, path: Path, item: NeighbourDocument, frames: dict[str, Frame], places: Places
) -> list[WorldBody]:
    """Puts a neighbour's links among the frames and gives its bodies, all called NEIGHBOUR/name."""
    from assur.planner.model.link_frames import TrajectoryLaw

    given = robots.equipped(document, (*path, "robot"), item.robot)
    robot = given.robot
    if robot.tilting:
        raise fault(document, (*path, "robot"), "an arm whose links stay upright, not one whose links tilt")
    if item.trajectory.acceleration_jumps:
        allowed = "false: a neighbour's links are frames, and the acceleration of a frame does not jump"
        raise fault(document, (*path, "trajectory", "acceleration_jumps"), allowed)
    spelt: answer.Trajectory = item.trajectory.model_dump()  # type: ignore[assignment]
    trajectory = trajectory_of(document, (*path, "trajectory"), spelt, given.conventions)
    if not (trajectory.rest_at_start and trajectory.rest_at_end):
        allowed = "rest at its first and last knot: it stands still before and after"
        raise fault(document, (*path, "trajectory", "velocity"), allowed)
    for number, link in enumerate(robot.links):
        name = f"{item.name}/{link}"
        with located(document, *path, "trajectory"):
            law = Fixed(robot.base) if link == "base" else TrajectoryLaw(robot, trajectory, number)
        frames[name] = Frame(name, law)
    carried = [(body.body, robot.links[body.link]) for body in robot.bodies]
    carried += [(body, "flange") for body in given.tool.bodies]
    found = []
    for body, link in carried:
        renamed = Body(f"{item.name}/{body.name}", body.pieces, body.surface)
        if renamed.name in places:
            raise fault(document, (*path, "robot"), f"bodies with different names; {body.name} is there twice")
        places[renamed.name] = (f"{item.name}/{link}", Pose())
        found.append(WorldBody(renamed, f"{item.name}/{link}"))
    return found
