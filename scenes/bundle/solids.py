"""Bodies as convex pieces, and where each sits in each phase."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import Body, Hull, Piece
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Scene
from assur.scenes.bundle.arms import link_number
from assur.scenes.bundle.surfaces import in_pieces

Document = dict[str, Any]


def bodies_in(scene: Scene) -> tuple[Body, ...]:
    """The robot's, the tool's and those around, in this order."""
    own = [item.body for item in scene.robot.bodies]
    return (*own, *scene.tool.bodies, *(item.body for item in scene.bodies))


def body_of(body: Body) -> Document:
    """A body with its pieces, in its own axes."""
    pieces = [_piece(piece) for piece in body.pieces]
    if body.surface is not None:
        for piece, (vertices, triangles) in zip(pieces, in_pieces(body.pieces, body.surface), strict=True):
            piece |= {"vertices": vertices, "triangles": triangles}
    return {"name": body.name, "pieces": pieces}


def _piece(piece: Piece) -> Document:
    at, turn, shape = piece.position.tolist(), piece.rotation, piece.shape
    found = {"centre": at, "edges": [], "disc": 0.0, "axis": turn[:, 2].tolist(), "ball": 0.0, "vertices": []}
    if isinstance(shape, Hull):
        found["vertices"] = (shape.vertices @ turn.T + piece.position).tolist()
    else:
        edges = [[float(x) * half for x in turn[:, k].tolist()] for k, half in enumerate(shape.half) if half != 0.0]
        found |= {"edges": edges, "disc": shape.disc, "ball": shape.ball}
    return {**found, "triangles": []}


def seats_of(scene: Scene, phases: Sequence[Phase]) -> tuple[list[Document], list[list[int]]]:
    """All seats, and for each phase the number of that of each body."""
    links, frames = scene.robot.links, list(scene.frames)
    bodies = bodies_in(scene)
    flange, around = links.index("flange"), {item.name for item in scene.bodies}
    ridden = {item.body.name: link_number(scene.robot, item.link) for item in scene.robot.bodies}
    seats, number, of_phases = list[Document](), dict[tuple[Any, ...], int](), []
    for phase in phases:
        held, row = phase.attached.held, []
        for k, body in enumerate(bodies):
            link, frame, pose = -1, -1, Pose()
            if held is not None and held.part == body.name:
                link, pose = flange, held.in_flange
            elif body.name in around:
                where, pose = phase.attached.pose_of(scene, body.name)
                frame = frames.index(where)
            else:
                link = ridden.get(body.name, flange)
            key = (k, link, frame, pose)
            if key not in number:
                number[key] = len(seats)
                place = [pose.x, pose.y, pose.z, pose.yaw]
                seats.append({"body": k, "link": link, "frame": frame, "pose": place})
            row.append(number[key])
        of_phases.append(row)
    return seats, of_phases
