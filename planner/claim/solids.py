"""Bodies as convex pieces, in their own axes; and the surfaces of those that are meshes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.claim import columns as c
from assur.planner.geometry.pieces import Pieces
from assur.planner.geometry.shapes import Body
from assur.planner.model.scene import Scene


def bodies_in(scene: Scene) -> tuple[Body, ...]:
    """The robot's, the tool's and those around, in the order of a claim."""
    own = (item.body for item in scene.robot.bodies)
    return (*own, *scene.tool.bodies, *(item.body for item in scene.bodies))


def solids_of(bodies: Sequence[Body], solids: Pieces) -> dict[str, FloatArray]:
    """Bodies, pieces, vertices and triangles. `solids`: the pieces of these bodies. A piece with triangles has their
    corners as its vertices."""
    rows = np.zeros((len(bodies), c.BODY))
    rows[:, c.BODY_PIECE], rows[:, c.BODY_PIECES] = solids.first, solids.count
    pieces, corners = _pieces(solids), list[FloatArray]()
    for k in np.flatnonzero(solids.hull >= 0).tolist():
        hull = solids.hulls[solids.hull[k]]
        corners.append(hull.vertices @ solids.rotation[k].T + solids.position[k])
    surfaces = {k: cut for k, body in enumerate(bodies) for cut in [body.cut_surface] if cut}
    numbers = solids.hull.tolist()
    for body, cut in surfaces.items():
        for piece, (own, _) in enumerate(cut, start=int(solids.first[body])):
            corners[numbers[piece]] = own
    sizes, hulls = np.zeros(len(pieces)), solids.hull >= 0
    sizes[hulls] = [len(each) for each in corners]
    pieces[:, c.PIECE_VERTICES], pieces[:, c.PIECE_VERTEX] = sizes, np.cumsum(sizes) - sizes
    triangles, count = [c.table("triangles", [])], 0
    for body in range(len(bodies)):
        begin = count
        for piece, (_, chosen) in enumerate(surfaces.get(body, ()), start=int(solids.first[body])):
            own = np.full((len(chosen), c.TRIANGLE), float(piece))
            own[:, c.TRIANGLE_VERTEX : c.TRIANGLE_PIECE] = chosen + pieces[piece, c.PIECE_VERTEX]
            triangles.append(own)
            count += len(own)
        rows[body, c.BODY_TRIANGLE], rows[body, c.BODY_TRIANGLES] = begin, count - begin
    return {
        "bodies": rows,
        "pieces": pieces,
        "vertices": np.concatenate([c.table("vertices", []), *corners]),
        "triangles": np.concatenate(triangles),
    }


def _pieces(solids: Pieces) -> FloatArray:
    """The rows of all pieces, without their vertices."""
    found, count = np.zeros((len(solids.shapes), c.PIECE)), len(solids.shapes)
    found[:, c.PIECE_CENTRE : c.PIECE_AXIS] = solids.position
    found[:, c.PIECE_AXIS : c.PIECE_DISC] = solids.rotation[:, :, 2]
    found[:, c.PIECE_DISC], found[:, c.PIECE_BALL] = solids.disc, solids.ball
    long = solids.half != 0.0
    found[:, c.PIECE_EDGES] = long.sum(1)
    edges = np.where(long[:, :, None], solids.rotation.transpose(0, 2, 1) * solids.half[:, :, None], 0.0)
    order = np.argsort(~long, axis=1, kind="stable")[:, :, None]  # edges of no length come last
    found[:, c.PIECE_EDGE : c.PIECE_EDGE + 9] = np.take_along_axis(edges, order, 1).reshape(count, 9)
    return found
