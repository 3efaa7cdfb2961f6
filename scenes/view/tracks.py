"""A motion as the viewer, the report and the animated model show it: carriers that move, and bodies on carriers.

What is drawn is an interpolation of these poses, without kinematics and without time laws.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import Body
from assur.planner.model.attachments import at_start
from assur.planner.model.outcome import Arrival
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Follow, Move, Pick, Place, Scene, Step, Trace, WorldBody
from assur.planner.trajectory import Trajectory
from assur.scenes.schema import view as document
from assur.scenes.view.display_meshes import Mesh, mesh_of
from assur.scenes.view.packing import floats
from assur.scenes.view.poses import STEP_S, WITHIN_M, Track, carrier_poses, instants, thinned
from assur.scenes.view.quaternions import rotated
from assur.scenes.view.thinning import needed_of_curves

KINDS: dict[type[Step], document.StepKind] = {
    Move: "move",
    Follow: "follow",
    Trace: "trace",
    Pick: "pick",
    Place: "place",
}
"""The kind of each step."""
PATH_POINTS = 200
"""Points of a traced path."""


@dataclass(frozen=True, eq=False)
class Tracks:
    """A motion as it is shown, from `start` to `end`, s: links, then frames, as carriers, and what is on them, by their
    index. Times in `bodies` and `points` are counted from `start`. The tool point has the pose `tcp` on the carrier
    `flange`; `tool_path` (P, 3), m, is its path within 0.1 mm, at times `tool_time` (P,), s."""

    start: float
    end: float
    carriers: tuple[Track, ...]
    meshes: tuple[Mesh, ...]
    bodies: list[document.ShownBody]
    points: list[document.ShownPoint]
    flange: int
    tcp: Pose
    tool_time: FloatArray
    tool_path: FloatArray


def tracks(
    scene: Scene,
    trajectory: Trajectory,
    phases: tuple[Phase, ...],
    arrivals: tuple[Arrival, ...] = (),
    step_s: float = STEP_S,
) -> Tracks:
    """The tracks of a motion of a scene. Every point of every body is within 0.1 mm of its pose at any time.

    Without phases of the robot the arm is at rest at its first knot while the frames move, and bodies have the seats of
    the first phase, if there is one. `step_s`: time between the instants at which poses are computed, s.
    """
    end = max([trajectory.end, *(phase.t1 for phase in phases if phase.robot)])
    meshes, bodies = shown_bodies(scene, phases, trajectory.start)
    points = shown_points(scene, arrivals, trajectory.start)
    return drawn(scene, trajectory, end, meshes, bodies, points, step_s)


def drawn(
    scene: Scene,
    trajectory: Trajectory,
    end: float,
    meshes: tuple[Mesh, ...],
    bodies: list[document.ShownBody],
    points: list[document.ShownPoint],
    step_s: float = STEP_S,
) -> Tracks:
    """The tracks of a motion with these bodies and control points, which are on its links and frames, up to `end`."""
    start, flange, tcp = trajectory.start, scene.robot.links.index("flange"), scene.tool.tcp
    names = [*scene.robot.links, *scene.frames]
    reach = [0.0] * len(names)
    reach[flange] = float(np.hypot(*tcp.position[:2])) + abs(tcp.z)
    for body in bodies:
        for seat in body["seats"]:
            far = float(np.linalg.norm(seat["at_m"])) + meshes[body["mesh"]].reach
            reach[seat["carrier"]] = max(reach[seat["carrier"]], far)
    for point in points:
        reach[point["carrier"]] = max(reach[point["carrier"]], float(np.linalg.norm(point["at_m"])))
    t = instants(trajectory, start, end, step_s)
    poses = carrier_poses(scene, trajectory, t)
    position, rotation = poses[flange]
    tool = position + rotated(rotation, tcp.position)
    kept = needed_of_curves(t, tool, np.full(3, WITHIN_M / 3**0.5))
    return Tracks(
        start=start,
        end=end,
        carriers=tuple(thinned(name, t, *pose, far) for name, pose, far in zip(names, poses, reach, strict=True)),
        meshes=meshes,
        bodies=bodies,
        points=points,
        flange=flange,
        tcp=tcp,
        tool_time=t[kept],
        tool_path=tool[kept],
    )


def _frame_carriers(scene: Scene) -> dict[str, int]:
    """The carrier of each frame, by its name: frames come after links."""
    return {name: number for number, name in enumerate(scene.frames, len(scene.robot.links))}


def shown_bodies(
    scene: Scene, phases: tuple[Phase, ...], start: float
) -> tuple[tuple[Mesh, ...], list[document.ShownBody]]:
    """All meshes, and all bodies: bodies of the same shape share a mesh. Times are counted from `start`, s."""
    flange = scene.robot.links.index("flange")
    shown: list[tuple[Body, document.BodyKind, _Stays, document.Unknown | None]] = []
    own: list[tuple[Body, int, document.BodyKind]] = [(each.body, each.link, "robot") for each in scene.robot.bodies]
    own += [(body, flange, "tool") for body in scene.tool.bodies]
    shown += [(body, kind, ([_seat(0.0, link, Pose())], None), None) for body, link, kind in own]
    kinds = _kinds(scene)
    for world in scene.bodies:
        stays = _seats(scene, phases, world.name, start, flange)
        shown.append((world.body, kinds[world.name], stays, _unknown(scene, world)))
    meshes, known, bodies = list[Mesh](), dict[tuple[bytes, bytes], int](), list[document.ShownBody]()
    for body, kind, (seats, gone_s), unknown in shown:
        mesh = mesh_of(body)
        number = known.setdefault((mesh.vertices.tobytes(), mesh.faces.tobytes()), len(meshes))
        if number == len(meshes):
            meshes.append(mesh)
        bodies.append(
            document.ShownBody(name=body.name, kind=kind, mesh=number, seats=seats, gone_s=gone_s, unknown=unknown)
        )
    return tuple(meshes), bodies


def _kinds(scene: Scene) -> dict[str, document.BodyKind]:
    """The kind of each body of the surroundings. The names of a neighbour's bodies and frames begin with its own."""
    parts = {step.part for step in scene.task}
    if scene.start.holding is not None:
        parts.add(scene.start.holding.part)
    neighbours = tuple(name.partition("/")[0] + "/" for name in scene.frames if "/" in name)
    kinds = dict[str, document.BodyKind]()
    for name in scene.index:
        kinds[name] = "part" if name in parts else "neighbour" if name.startswith(neighbours) else "body"
    return kinds


_Stays = tuple[list[document.ShownSeat], float | None]
"""The seats of a body in the order of time, and when it is taken away, s since the start; None: it is not."""


def _seats(scene: Scene, phases: tuple[Phase, ...], name: str, start: float, flange: int) -> _Stays:
    """Where a body of the surroundings is."""
    carriers, seats = _frame_carriers(scene), list[tuple[float, int, Pose]]()
    for time, attached in [(start, at_start(scene)), *((phase.t0, phase.attached) for phase in phases)]:
        if attached.has_gone(scene, name):
            return [_seat(since - start, carrier, pose) for since, carrier, pose in seats], time - start
        held = attached.held
        if held is not None and held.part == name:
            carrier, pose = flange, held.in_flange
        else:
            frame, pose = attached.pose_of(scene, name)
            carrier = carriers[frame]
        if seats and seats[-1][0] == time:
            seats.pop()
        if not seats or seats[-1][1:] != (carrier, pose):
            seats.append((time, carrier, pose))
    return [_seat(time - start, carrier, pose) for time, carrier, pose in seats], None


def _seat(since: float, carrier: int, pose: Pose) -> document.ShownSeat:
    return {"from_s": since, "carrier": carrier, "at_m": [pose.x, pose.y, pose.z], "yaw_rad": pose.yaw}


def _unknown(scene: Scene, world: WorldBody) -> document.Unknown | None:
    """The uncertainty of a body and of its frame as one outline, without the time by which the frame may be late; None:
    there is none. The proof also uses the direction of each error; the outline does not."""
    frame, own = scene.frames[world.frame].uncertainty, world.uncertainty
    far = float(np.hypot(world.pose.x, world.pose.y)) + world.body.radius
    horizontal = frame.position_m + frame.lateral_m + frame.yaw_rad * far
    horizontal += own.position_m + own.yaw_rad * world.body.radius
    growth, vertical = frame.speed_m_s, frame.vertical_m + own.vertical_m
    if not horizontal + growth + vertical > 0.0:
        return None
    return {"horizontal_m": horizontal, "growth_m_s": growth, "vertical_m": vertical}


def shown_points(scene: Scene, arrivals: tuple[Arrival, ...], start: float) -> list[document.ShownPoint]:
    """The control points of the task, in order, with the pose of the tool point when they are met."""
    met, carriers = {arrival.step: arrival for arrival in arrivals}, _frame_carriers(scene)
    attached, points = at_start(scene), list[document.ShownPoint]()
    for number, step in enumerate(scene.task):
        arrival = met.get(number)
        offset = 0.0 if arrival is None else arrival.yaw_offset
        frame, flange = attached.flange(scene, step, offset)
        pose, path = flange.then(scene.tool.tcp), None
        if isinstance(step, Trace):
            path = floats(step.path.curve.at(np.linspace(0.0, step.path.length, PATH_POINTS))[0])
        points.append(
            {
                "name": step.name,
                "step": number,
                "kind": KINDS[type(step)],
                "carrier": carriers[frame],
                "at_m": [pose.x, pose.y, pose.z],
                "yaw_rad": pose.yaw,
                "time_s": None if arrival is None else arrival.time - start,
                "until_s": None if arrival is None else arrival.until - start,
                "path_m": path,
            }
        )
        attached = attached.after(scene, step, offset)
    return points
