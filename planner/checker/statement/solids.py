"""Do the solids of a claim hold those of the request? Bodies of robot, tool and surroundings, in this order.

A piece of the claim is centre + sum of s_i edge_i + disc + ball, or the hull of its vertices; one of the request has a
position, axes, half lengths, a disc across its third axis and a ball, or vertices. So they are compared by their
numbers, in the body's axes, m. A larger disc or ball states more.

A body whose pieces cover the surface of a mesh has the triangles of the surface as well. The claim's triangles are
those of the mesh, or parts of them. If (1) each is in one of the mesh's and turned the same way round, (2) their areas
add up to the mesh's and (3) the surface is closed, which the claim checker shows, they cover each triangle of the mesh
exactly once: inside of it no edge may be free, so the number of parts over a point is the same everywhere, and by the
areas it is one.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.checker.statement.differences import SAME, Requirements, is_same
from assur.planner.checker.verdict import Code
from assur.planner.claim import columns as c
from assur.planner.geometry.shapes import Body, Hull, Piece
from assur.planner.model.scene import Scene


def bodies_of(scene: Scene) -> list[Body]:
    """All bodies, in the order of a claim."""
    own, around = [item.body for item in scene.robot.bodies], [item.body for item in scene.bodies]
    return [*own, *scene.tool.bodies, *around]


def require_solids(report: Requirements, scene: Scene, claim: c.Claim) -> None:
    """The bodies of the claim hold those of the request, in the same order."""
    bodies = bodies_of(scene)
    if len(claim.bodies) != len(bodies):
        report.require(False, Code.SOLID, f"the claim has {len(claim.bodies)} bodies, not {len(bodies)}")
    stated, known = claim.pieces.tolist(), dict[tuple[bytes, bytes], int]()
    for body, (first, count, triangle, triangles) in zip(bodies, claim.bodies.astype(int).tolist(), strict=False):
        if body.surface is not None:
            vertices, faces = body.surface
            own = claim.triangles[triangle : triangle + triangles]
            _require_surface(report, body.name, vertices[faces], claim, range(first, first + count), own, known)
        elif count != len(body.pieces) or triangles:
            report.require(False, Code.SOLID, f"{body.name} has {len(body.pieces)} pieces, which fill it")
        else:
            for row, piece in zip(stated[first : first + count], body.pieces, strict=True):
                if not _is_stated(claim, row, piece):
                    report.require(False, Code.SOLID, f"a piece of {body.name} is not that of the request")


def _is_stated(claim: c.Claim, row: list[float], piece: Piece) -> bool:
    """Whether a row of `pieces` is that of a piece: vertices of a hull, in any order; else edges, without those of no
    length, and a disc and a ball that are no smaller."""
    shape, axes, edges = piece.shape, piece.rotation.T.tolist(), c.PIECE_EDGE
    if isinstance(shape, Hull):
        points = shape.vertices @ piece.rotation.T + piece.position
        vertices = claim.vertices[int(row[c.PIECE_VERTEX]) :][: int(row[c.PIECE_VERTICES])]
        if vertices.shape == points.shape and is_same(vertices, points):
            return True
        return len(vertices) > 0 and all(np.abs(vertices - point).max(axis=1).min() <= SAME for point in points)
    required = [*piece.position.tolist(), *axes[2], shape.disc, shape.ball, row[c.PIECE_VERTEX]]
    required += [0.0] * (c.PIECE - len(required))
    for half, (x, y, z) in zip(shape.half, axes, strict=True):
        if half != 0.0:
            required[edges : edges + 3], edges = (half * x, half * y, half * z), edges + 3
    required[c.PIECE_EDGES] = (edges - c.PIECE_EDGE) / 3
    if row == required:
        return True
    if shape.disc == 0.0:
        required[c.PIECE_AXIS : c.PIECE_DISC] = row[c.PIECE_AXIS : c.PIECE_DISC]
    for k in (c.PIECE_DISC, c.PIECE_BALL):
        required[k] = max(required[k], row[k])  # more may be stated
    return all(abs(x - y) <= SAME for x, y in zip(row, required, strict=True))


def _require_surface(
    report: Requirements,
    name: str,
    mesh: FloatArray,
    claim: c.Claim,
    pieces: range,
    triangles: FloatArray,
    known: dict[tuple[bytes, bytes], int],
) -> None:
    """The triangles of a body of the claim are those (m, 3, 3) of the mesh, and each is in one of the body's pieces.
    `known`: how many are not, of meshes that were compared already."""
    piece, corners = triangles[:, c.TRIANGLE_PIECE].astype(int), triangles[:, : c.TRIANGLE_PIECE].astype(int)
    if not ((piece >= pieces.start) & (piece < pieces.stop)).all():
        report.require(False, Code.SOLID, f"a triangle of {name} is in a piece of another body")
        return
    first, count = claim.pieces[piece][:, [c.PIECE_VERTEX, c.PIECE_VERTICES]].T
    inside = ((corners >= first[:, None]) & (corners < (first + count)[:, None])).all()
    report.require(inside, Code.SOLID, f"a triangle of {name} is not in its piece")
    stated = claim.vertices[corners]
    key = mesh.tobytes(), stated.tobytes()
    if key not in known:
        known[key] = _uncovered(mesh, stated)
    report.require(not known[key], Code.SOLID, f"{known[key]} triangles of {name} are not those of the mesh")


def _uncovered(mesh: FloatArray, stated: FloatArray) -> int:
    """How many triangles of a mesh (m, 3, 3) are not covered once by those stated (n, 3, 3), and how many of these are
    not in one triangle of the mesh. Equal triangles are taken away first; the others were cut."""
    left = dict[bytes, list[int]]()
    for k, key in enumerate(_keys(mesh)):
        left.setdefault(key, []).append(k)
    parts = [k for k, key in enumerate(_keys(stated)) if not (left.get(key) and left[key].pop() >= 0)]
    faces = [k for numbers in left.values() for k in numbers]
    if not faces or not parts:
        return len(faces) + len(parts)
    whole, rest = mesh[faces], stated[parts]
    (normal, area), (part_normal, part_area) = _normals(whole), _normals(rest)
    thin = part_area <= SAME * math.sqrt(area.max())  # too thin to have a direction
    covered, homes = np.zeros(len(whole)), np.zeros(len(rest), dtype=int)
    sides = np.cross(normal[:, None], np.roll(whole, -1, axis=1) - whole)
    sides /= np.maximum(np.linalg.norm(sides, axis=2), 1e-300)[:, :, None]
    for face, (corners, n, inwards) in enumerate(zip(whole, normal, sides, strict=True)):
        # in the plane of the triangle, and to the left of its three edges
        off = np.abs((rest - corners[0]) @ n).max(1)
        for corner, side in zip(corners, inwards, strict=True):
            off = np.maximum(off, -((rest - corner) @ side).min(1))
        inside = (off <= SAME) & (thin | (part_normal @ n > 0.0))
        homes += inside
        covered[face] = part_area[inside & ~thin].sum()
    around = np.linalg.norm(whole - np.roll(whole, 1, axis=1), axis=2).sum(1)
    missing = ~(np.abs(covered - area) <= 2.0 * SAME * around)
    return int(missing.sum() + np.where(thin, homes == 0, homes != 1).sum())


def _keys(triangles: FloatArray) -> list[bytes]:
    """A text for each triangle, the same for equal ones, whichever corner is the first."""
    order = np.lexsort(triangles.transpose(2, 0, 1)[::-1], axis=-1) if len(triangles) else np.zeros((0, 3), dtype=int)
    turn: IntArray = (order[:, :1] + np.arange(3)) % 3
    return [row.tobytes() for row in np.take_along_axis(triangles + 0.0, turn[:, :, None], axis=1)]


def _normals(triangles: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Unit normals (m, 3), anticlockwise seen from outside, and areas (m,) of triangles."""
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    length = np.linalg.norm(normal, axis=1)
    return normal / np.maximum(length, 1e-300)[:, None], length / 2.0
