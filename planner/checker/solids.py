"""All convex pieces of a scene, and each body's bounding box, as one table; supports and reaches of many at once.

The checker's own table: it shares the shapes and their numbers (`assur.planner.geometry.pieces`) with the planner,
nothing else. A *solid* is a row of it: a piece of a body, or the box in the body's own axes that holds all its pieces.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.geometry.shapes import Body
from assur.planner.model.scene import Scene

UPRIGHT = 1e-12
"""A solid of revolution whose axis is off the vertical by no more than this (a few roundings, rad) stands upright."""

_SIGNS = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])


class Seated(NamedTuple):
    """The solids of seated bodies, one after the other: of each body (K,) the first place of its pieces, with its box
    behind them; by place (N,) the bounds, m, of the horizontal distance of its points from the carrier's z axis and of
    that from its origin, which solid is there, its centre (N, 3) and its axes (N, 3, 3), columns, in the carrier."""

    start: IntArray
    reach: FloatArray
    distance: FloatArray
    solid: IntArray
    centre: FloatArray
    axes: FloatArray


@dataclass(frozen=True, eq=False)
class Solids:
    """`first`, `count`, `box` (B,) say which solids are a body's pieces and its box; the rest is (S, ...), in m."""

    bodies: tuple[Body, ...]
    number: dict[str, int]
    first: IntArray
    count: IntArray
    box: IntArray
    position: FloatArray
    rotation: FloatArray
    half: FloatArray
    disc: FloatArray
    ball: FloatArray
    hull: IntArray
    vertices: tuple[FloatArray, ...]

    def of(self, body: IntArray, piece: IntArray) -> IntArray:
        """Solids of pieces (N,) of bodies (N,), −1 being the box."""
        return np.where(piece < 0, self.box[body], self.first[body] + piece)

    def support(self, solid: IntArray, n: FloatArray) -> FloatArray:
        """max of n·x over solids (N,) for n (N, 3) in the axes of their bodies (equation S1)."""
        local = (n[:, None, :] @ self.rotation[solid])[:, 0]
        return np.asarray((n * self.position[solid]).sum(1) + self.about(solid, local))

    def about(self, solid: IntArray, n: FloatArray) -> FloatArray:
        """max of n·x over solids (N,) about their centres, for n (N, 3) in their own axes."""
        found: FloatArray = (np.abs(n) * self.half[solid]).sum(1)
        found += self.disc[solid] * np.hypot(n[:, 0], n[:, 1])
        found += self.ball[solid] * np.sqrt((n * n).sum(1))
        if self.vertices:
            hull = self.hull[solid]
            for k in np.unique(hull[hull >= 0]):
                rows = np.flatnonzero(hull == k)
                found[rows] += (n[rows] @ self.vertices[k].T).max(1)
        return found

    def reach(self, body: IntArray, offset: FloatArray) -> Seated:
        """Where the solids of bodies (K,) at `offset` (K, 4) in their carriers are (x, y, z, yaw), and how far turning
        a carrier moves them: about its z axis, and about any axis through its origin.

        An upright solid of revolution looks the same however it turns, so its points may be taken to move as its
        centre does; a ball looks the same however it tilts, too. What bounds the points of all pieces serves for the
        box, too: a gap of boxes is a gap of what is in them.
        """
        sizes = self.count[body] + 1
        start = np.cumsum(sizes) - sizes
        of = np.repeat(np.arange(len(body)), sizes)
        place = np.arange(len(of)) - start[of]
        boxed = place == sizes[of] - 1
        solid = np.where(boxed, self.box[body[of]], self.first[body[of]] + place)
        turn = turns(offset[:, 3])[of]
        centre = (turn @ self.position[solid, :, None])[..., 0] + offset[of, :3]
        axes = turn @ self.rotation[solid]
        found = self._radii(solid, centre, axes)
        if len(body):
            widest = np.maximum.reduceat(np.where(boxed, 0.0, found), start, axis=1)
            found = np.where(boxed, np.minimum(found, widest[:, of]), found)
        return Seated(start, found[0], found[1], solid, centre, axes)

    def _radii(self, solid: IntArray, centre: FloatArray, axes: FloatArray) -> FloatArray:
        """(2, N): from the carrier's z axis and from its origin."""
        corners = centre[:, None, :] + (_SIGNS * self.half[solid][:, None, :]) @ np.swapaxes(axes, 1, 2)
        found = _farthest(corners) + self.disc[solid] + self.ball[solid]
        if self.vertices:
            for k in np.flatnonzero(self.hull[solid] >= 0):
                found[:, k] = _farthest((centre[k] + self.vertices[self.hull[solid[k]]] @ axes[k].T)[None])[:, 0]
        return np.asarray(np.where(self._alike(solid), _farthest(centre[:, None]), found))

    def _alike(self, solid: IntArray) -> BoolArray:
        """Whether each solid looks the same however it turns about the vertical, and however it tilts, (2, N): an
        upright one of revolution, and a ball."""
        flat = self.half[solid] == 0.0
        revolved = flat[:, 0] & flat[:, 1] & (self.hull[solid] < 0)
        ball = revolved & flat[:, 2] & (self.disc[solid] == 0.0)
        upright = np.abs(self.rotation[solid, :2, 2]).max(1) <= UPRIGHT
        return np.stack([ball | (revolved & upright), ball])


def turns(yaw: FloatArray) -> FloatArray:
    """Rotations (..., 3, 3) about the vertical by `yaw` (...); NaN where it is."""
    found = np.zeros((*yaw.shape, 3, 3))
    found[..., 0, 0] = found[..., 1, 1] = np.cos(yaw)
    found[..., 1, 0] = np.sin(yaw)
    found[..., 0, 1] = -found[..., 1, 0]
    found[..., 2, 2] = np.where(np.isnan(yaw), np.nan, 1.0)
    return found


def _farthest(points: FloatArray) -> FloatArray:
    """Greatest distance of points (N, K, 3) from the z axis and from the origin, (2, N)."""
    return np.stack([np.hypot(points[..., 0], points[..., 1]).max(1), np.sqrt((points * points).sum(-1)).max(1)])


def solids(scene: Scene) -> Solids:
    """The table of a scene: bodies of the robot, of the tool, of the surroundings, in this order."""
    bodies = [item.body for item in scene.robot.bodies] + list(scene.tool.bodies) + [item.body for item in scene.bodies]
    raw, boxes = scene.pieces, len(bodies)
    vertices = tuple(hull.vertices for hull in raw.hulls)
    low, high = np.zeros((2, boxes, 3))
    if boxes:
        size = (np.abs(raw.rotation) * raw.half[:, None]).sum(-1) + raw.ball[:, None]
        size += raw.disc[:, None] * np.hypot(raw.rotation[..., 0], raw.rotation[..., 1])
        lowest, highest = raw.position - size, raw.position + size
        for k in np.flatnonzero(raw.hull >= 0):
            corners = raw.position[k] + vertices[raw.hull[k]] @ raw.rotation[k].T
            lowest[k], highest[k] = corners.min(0), corners.max(0)
        low, high = np.minimum.reduceat(lowest, raw.first), np.maximum.reduceat(highest, raw.first)
    return Solids(
        bodies=tuple(bodies),
        number={body.name: i for i, body in enumerate(bodies)},
        first=raw.first,
        count=raw.count,
        box=len(raw.position) + np.arange(boxes),
        position=np.concatenate([raw.position, (high + low) / 2]),
        rotation=np.concatenate([raw.rotation, np.tile(np.eye(3), (boxes, 1, 1))]),
        half=np.concatenate([raw.half, (high - low) / 2]),
        disc=np.concatenate([raw.disc, np.zeros(boxes)]),
        ball=np.concatenate([raw.ball, np.zeros(boxes)]),
        hull=np.concatenate([raw.hull, np.full(boxes, -1)]),
        vertices=vertices,
    )
