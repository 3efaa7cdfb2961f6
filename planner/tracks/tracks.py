"""The one place at which a motion becomes what viewer, report and models of it are made of.

Whoever shows it interpolates poses, and puts bodies where their carriers are: no kinematics, no time laws.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.collision.proof import Prover
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import Body
from assur.planner.model.attachments import at_start
from assur.planner.model.outcome import Arrival
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Follow, Move, Pick, Place, Scene, Step, Trace
from assur.planner.tracks.curves import Curves, LimitSpan, curves, limit_spans
from assur.planner.tracks.distances import Nearby, distances
from assur.planner.tracks.poses import STEP_S, Track, frame_poses, instants, link_poses, thinned
from assur.planner.tracks.shells import Shell, shell_of
from assur.planner.tracks.thinning import kept_of_curves
from assur.planner.tracks.triangles import Mesh, mesh_of
from assur.planner.tracks.turns import turned
from assur.planner.trajectory import Trajectory

Kind = Literal["robot", "tool", "part", "body", "neighbour"]
StepKind = Literal["move", "follow", "trace", "pick", "place"]
KINDS: dict[type[Step], StepKind] = {Move: "move", Follow: "follow", Trace: "trace", Pick: "pick", Place: "place"}
PATH_POINTS = 200
"""Points of a traced path."""


@dataclass(frozen=True, slots=True)
class Seat:
    """From this time on, s, a body is at this pose on a carrier, a link or a frame, by its number."""

    time: float
    carrier: int
    pose: Pose


@dataclass(frozen=True, eq=False)
class ShownBody:
    """A body: what it is, which mesh it has, where it sits when, and how far it may be from there."""

    name: str
    kind: Kind
    mesh: int
    seats: tuple[Seat, ...]
    shell: Shell


@dataclass(frozen=True, eq=False)
class ControlPoint:
    """A control point: the pose of the tool point on a carrier. `time`, `until`: when it is met, s; None: it is not.
    `path` (P, 3): points of a path that is traced, on the carrier, m."""

    name: str
    step: int
    kind: StepKind
    carrier: int
    pose: Pose
    time: float | None
    until: float | None
    path: FloatArray | None


@dataclass(frozen=True, eq=False)
class Tracks:
    """A motion as it is shown, from `start` to `end`, s. `flange`: the carrier of the tool point, which is at `tcp` on
    it; `tool_path` (P, 3): its way, m, within 0.1 mm, at times `tool_time` (P,). `near` are the spans of approach,
    follow and depart, with their ends."""

    start: float
    end: float
    carriers: tuple[Track, ...]
    meshes: tuple[Mesh, ...]
    bodies: tuple[ShownBody, ...]
    points: tuple[ControlPoint, ...]
    flange: int
    tcp: Pose
    tool_time: FloatArray
    tool_path: FloatArray
    curves: Curves | None
    limits: tuple[LimitSpan, ...]
    distances: tuple[Nearby, ...]
    near: tuple[tuple[float, float], ...]


def tracks(
    scene: Scene,
    trajectory: Trajectory,
    phases: tuple[Phase, ...],
    arrivals: tuple[Arrival, ...] = (),
    also: tuple[float, ...] = (),
    step_s: float = STEP_S,
) -> Tracks:
    """What is shown of a motion of a scene, in these phases. `also`: instants at which distances are wanted, too, s;
    `step_s`: time between those at which poses are looked at, s.

    Without phases of the robot the arm stands at its first knot for as long as the trajectory lasts, while frames move,
    and bodies sit where the first of the phases, if there is one, has them. Every
    point of every body is within 0.1 mm of where it is, at any time.
    """
    robot = [phase for phase in phases if phase.robot]
    start, end = trajectory.start, max([trajectory.end, *(phase.t1 for phase in robot)])
    links = len(scene.robot.links)
    numbers = {name: links + k for k, name in enumerate(scene.frames)}
    flange = scene.robot.links.index("flange")
    meshes, shown = _bodies(scene, phases, start, numbers, flange)
    points = _points(scene, arrivals, numbers)
    reach = [float(np.hypot(*scene.tool.tcp.position[:2])) + abs(scene.tool.tcp.z) if k == flange else 0.0
             for k in range(links + len(numbers))]  # fmt: skip
    for body in shown:
        for seat in body.seats:
            off = float(np.linalg.norm(seat.pose.position))
            reach[seat.carrier] = max(reach[seat.carrier], off + meshes[body.mesh].reach)
    for point in points:
        reach[point.carrier] = max(reach[point.carrier], float(np.linalg.norm(point.pose.position)))
    t = instants(trajectory, start, end, step_s)
    position, rotation = link_poses(scene, trajectory, t)
    carriers = [thinned(name, t, position[:, k], rotation[:, k], reach[k]) for k, name in enumerate(scene.robot.links)]
    carriers += [thinned(name, t, *frame_poses(scene, name, t), reach[k]) for name, k in numbers.items()]
    tool = position[:, flange] + turned(rotation[:, flange], scene.tool.tcp.position)
    kept = kept_of_curves(t, tool, np.full(3, 1e-4 / 3**0.5))
    moves = bool(robot)
    return Tracks(
        start=start,
        end=end,
        carriers=tuple(carriers),
        meshes=tuple(meshes),
        bodies=tuple(shown),
        points=points,
        flange=flange,
        tcp=scene.tool.tcp,
        tool_time=t[kept],
        tool_path=tool[kept],
        curves=curves(scene, trajectory) if moves else None,
        limits=limit_spans(scene, tuple(robot)),
        distances=distances(Prover(scene), trajectory, phases, also),
        near=tuple((phase.t0, phase.t1) for phase in robot if phase.near),
    )


def _bodies(
    scene: Scene, phases: tuple[Phase, ...], start: float, numbers: dict[str, int], flange: int
) -> tuple[list[Mesh], list[ShownBody]]:
    """All bodies, and the meshes that they have; bodies of the same shape share one."""
    meshes, known = list[Mesh](), dict[tuple[bytes, bytes], int]()

    def number(mesh: Mesh) -> int:
        key = mesh.vertices.tobytes(), mesh.faces.tobytes()
        if key not in known:
            known[key] = len(meshes)
            meshes.append(mesh)
        return known[key]

    parts = {step.part for step in scene.task if step.part is not None}
    if scene.start.holding is not None:
        parts.add(scene.start.holding.part)
    own: list[tuple[Body, int, Kind]] = [(each.body, each.link, "robot") for each in scene.robot.bodies]
    own += [(body, flange, "tool") for body in scene.tool.bodies]
    found = [
        ShownBody(body.name, kind, number(mesh_of(body)), (Seat(start, link, Pose()),), Shell())
        for body, link, kind in own
    ]
    others = {name.partition("/")[0] for name in scene.frames if "/" in name}
    for world in scene.bodies:
        is_kind: Kind = "part" if world.name in parts else "body"
        if is_kind == "body" and world.name.partition("/")[0] in others and "/" in world.name:
            is_kind = "neighbour"
        seats = _seats(scene, phases, world.name, start, numbers, flange)
        found.append(ShownBody(world.name, is_kind, number(mesh_of(world.body)), seats, shell_of(scene, world)))
    return meshes, found


def _seats(
    scene: Scene, phases: tuple[Phase, ...], name: str, start: float, numbers: dict[str, int], flange: int
) -> tuple[Seat, ...]:
    """Where a body of the surroundings sits, each place once, from when on."""
    found = list[Seat]()
    for time, attached in [(start, at_start(scene)), *((phase.t0, phase.attached) for phase in phases)]:
        held = attached.held
        if held is not None and held.part == name:
            carrier, pose = flange, held.in_flange
        else:
            frame, pose = attached.pose_of(scene, name)
            carrier = numbers[frame]
        if found and found[-1].time == time:
            found.pop()
        if not found or (found[-1].carrier, found[-1].pose) != (carrier, pose):
            found.append(Seat(time, carrier, pose))
    return tuple(found)


def _points(scene: Scene, arrivals: tuple[Arrival, ...], numbers: dict[str, int]) -> tuple[ControlPoint, ...]:
    """The control points of the task, in order, where the tool point is when they are met."""
    met = {arrival.step: arrival for arrival in arrivals}
    attached, found = at_start(scene), list[ControlPoint]()
    for number, step in enumerate(scene.task):
        arrival = met.get(number)
        offset = 0.0 if arrival is None else arrival.yaw_offset
        frame, pose = attached.flange(scene, step, offset)
        found.append(
            ControlPoint(
                name=step.name,
                step=number,
                kind=KINDS[type(step)],
                carrier=numbers[frame],
                pose=pose.then(scene.tool.tcp),
                time=None if arrival is None else arrival.time,
                until=None if arrival is None else arrival.until,
                path=_path(step),
            )
        )
        attached = attached.after(scene, step, offset)
    return tuple(found)


def _path(step: Step) -> FloatArray | None:
    """Points (P, 3) of the path of a trace, m, in the frame of its target."""
    if not isinstance(step, Trace):
        return None
    return step.path.curve.at(np.linspace(0.0, step.path.length, PATH_POINTS))[0]


def standing(scene: Scene, lasts: float, q: FloatArray) -> Trajectory:
    """The arm with joints q (n,) from the start on, for so long, s: what is shown where nothing was planned."""
    still = np.zeros((2, len(q)))
    time = np.array([scene.start.time, scene.start.time + lasts])
    return Trajectory(time, np.array([q, q]), still, still)
