"""A closed surface covered, by construction, with convex hulls: the union of the hulls contains every triangle.

The space around the mesh is cut by planes across the axes; each cell's hull is that of the triangles' parts inside the
cell, so whatever the cuts, every point of every triangle is in the hull of a cell (M1). A convex mesh is one hull, the
solid itself. Otherwise the cell whose hull reaches furthest out of the solid is cut where the volume of the hulls falls
most, until all are tight, or there are enough pieces, or enough work was done. If the hulls are not tight then, the
cover is larger than the solid: an arm may be kept out of a hollow that it could enter, but never let through a wall.

The places of the cuts take long to find and little memory to keep. `Cuts` has them, and `cover_by` makes the hulls from
them; these contain the surface for any cuts.

Enclosed space that no hull touches is not covered: `assur.planner.geometry.containment` checks it with the same
triangles.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.geometry.shapes import Hull, Piece
from assur.scenes.meshes.cells import Cell, Place
from assur.scenes.meshes.clip import clip
from assur.scenes.meshes.hull import MAX_CORNERS, hull_of, volume_of_hull
from assur.scenes.meshes.parts import Parts, at_once
from assur.scenes.meshes.surface import Surface, volume_of

MAX_PIECES = 64
"""Most hulls of one cover; more would cost the planner more than they are worth."""
MAX_WORK = 60_000
"""Most points of the hulls that are made to find the cuts of one cover: some tenths of a second. The cost of a mesh is
bounded by a count, so that a cover is a function of the mesh alone."""
TIGHT_SHARE = 0.01
"""A hull is tight if it reaches out of the solid by no more than this share of the mesh's largest extent,"""
TIGHT_M = 2e-4
"""or by no more than this, m."""
CONVEX_SHARE = 1e-6
"""Share of the hull's volume by which a convex mesh's own may fall short, from rounding in the file (float32)."""


@dataclass(frozen=True, eq=False)
class Cover:
    """Convex pieces in the mesh's own frame, m; the surface, unless the one piece is the solid itself; and how far the
    pieces were found to reach out of the solid, m."""

    pieces: tuple[Piece, ...]
    surface: tuple[FloatArray, IntArray] | None
    excess_m: float


@dataclass(frozen=True, slots=True)
class Cuts:
    """Where a surface is cut, and which cells are joined again: the part of a cover that is costly to compute.

    `convex`: it is one hull, the solid itself. `planes`: cell, axis, place (m) of each cut; cell 0 is the whole, and
    those below and above cut number i are 2i + 1 and 2i + 2. `groups`: cells that are left, in groups with one hull
    each. `excess_m`: as of the cover.
    """

    convex: bool
    planes: tuple[tuple[int, int, float], ...]
    groups: tuple[tuple[int, ...], ...]
    excess_m: float


class Covering:
    """The work on a cover. It may be interrupted between two parts and continued later: the cuts are the same."""

    def __init__(self, surface: Surface) -> None:
        self._surface = surface
        self.tight_m = max(TIGHT_M, TIGHT_SHARE * float(np.ptp(surface.vertices, axis=0).max()))
        """How far hulls may reach out of the solid, m."""
        self._planes: list[tuple[int, int, float]] = []
        self._cells: list[Cell] = []
        self._done: list[Cell] = []
        self._open: list[Cell] = []
        """The cell that is being cut."""
        self.work = 0
        """Number of points of the hulls so far."""

    @property
    def pieces(self) -> int:
        """Cells so far."""
        return len(self._cells) + len(self._done) + len(self._open)

    @property
    def excess_m(self) -> float:
        """How far the hulls of the cells so far reach out of the solid, m."""
        return max((cell.excess for cell in (*self._cells, *self._done, *self._open)), default=0.0)

    def in_parts(self) -> Parts[tuple[Cuts, Cover]]:
        """Finds the cover and its cuts; once."""
        surface = self._surface
        solid = volume_of(surface.corners)
        yield
        if volume_of_hull(surface.vertices) - solid <= CONVEX_SHARE * solid:
            whole = Cuts(True, (), ((0,),), 0.0)
            return whole, (yield from cover_by(surface, whole))
        first = Cell(surface.corners, 0, self.tight_m)
        yield
        yield from first.parts()
        self._cells = [first]
        while self._cells and self.pieces < MAX_PIECES and self.work < MAX_WORK:
            yield from self._cut(heapq.heappop(self._cells))
        yield
        found = sorted(self._done + self._cells, key=lambda cell: cell.number)
        hulls = [hull_of(cell.triangles.reshape(-1, 3)) for cell in found]
        groups = tuple(tuple(found[i].number for i in group) for group in convex_groups(hulls))
        cuts = Cuts(False, tuple(self._planes), groups, self.excess_m)
        points = {cell.number: cell.triangles.reshape(-1, 3) for cell in found}
        known = {cell.number: hull for cell, hull in zip(found, hulls, strict=True)}
        return cuts, (yield from _joined(surface, cuts, points, known))

    def _cut(self, cell: Cell) -> Iterator[None]:
        place: Place | None = None
        if cell.excess > self.tight_m:
            place, made = cell.best()
            self.work += made
        if place is None:
            self._done.append(cell)
            yield
            return
        number = 2 * len(self._planes) + 1
        self._planes.append((cell.number, *place))
        self._open.append(cell)
        yield
        halves = cell.halves(place, number)
        for half in halves:
            yield from half.parts()
        self._open.remove(cell)
        for half in halves:
            heapq.heappush(self._cells, half)
        yield


def cover(surface: Surface) -> Cover:
    """The cover of a surface. Deterministic."""
    return at_once(Covering(surface).in_parts())[1]


def cover_by(surface: Surface, cuts: Cuts) -> Parts[Cover]:
    """The cover with these cuts. Its hulls contain the surface for any cuts, because each hull contains the triangles
    in its cells. A cell that is in no group has a hull of its own."""
    cells: dict[int, FloatArray] = {0: surface.corners}
    for i, (number, axis, at) in enumerate(cuts.planes):
        cells[2 * i + 1], cells[2 * i + 2] = clip(cells.pop(number), axis, at)
        yield
    points = {number: cell.reshape(-1, 3) for number, cell in cells.items() if len(cell)}
    return (yield from _joined(surface, cuts, points, {}))


def _joined(surface: Surface, cuts: Cuts, points: dict[int, FloatArray], known: dict[int, Hull]) -> Parts[Cover]:
    """The cover of cells with these points: a hull for each group, and for what is in none. `known`: hulls of cells."""
    groups = [tuple(number for number in group if number in points) for group in cuts.groups]
    grouped = {number for group in groups for number in group}
    groups += [(number,) for number in points if number not in grouped]
    hulls = list[Hull]()
    for group in filter(None, groups):
        if len(group) == 1 and group[0] in known:
            hulls.append(known[group[0]])
            continue
        yield
        # Made of the points themselves, so that rounding does not add up from hull to hull.
        hulls.append(hull_of(np.concatenate([points[number] for number in group])))
    whole = None if cuts.convex else (surface.vertices, surface.faces)
    return Cover(tuple(Piece(hull) for hull in hulls), whole, cuts.excess_m)


# Which hulls are convex together, and may become one: fewer pieces, and nothing more is covered.

GAIN_SHARE = 1e-4
"""Share of their own volumes by which the hull of two hulls may be larger than they are, for them to become one."""
NEAR_M = 1e-6
"""Boxes of two hulls that are further apart than this do not touch, m."""


class _Group:
    """Hulls that are convex together: their numbers, corners, and the volume of their hull."""

    def __init__(self, members: list[int], corners: FloatArray) -> None:
        self.members, self.corners = members, corners
        self.volume = volume_of_hull(corners)
        self.low, self.high = corners.min(0), corners.max(0)


def convex_groups(hulls: list[Hull]) -> list[list[int]]:
    """The numbers of the hulls in groups. The hull of a group is hardly larger than its members. Earlier hulls choose
    their group first."""
    groups = [_Group([i], hull.vertices) for i, hull in enumerate(hulls)]
    refused: set[tuple[_Group, _Group]] = set()
    i = 0
    while i < len(groups):
        partner = _partner(groups, i, refused)
        if partner is None:
            i += 1
            continue
        one, other = groups[i], groups.pop(partner)
        groups[i] = _Group(one.members + other.members, np.concatenate([one.corners, other.corners]))
        i = 0
    return [group.members for group in groups]


def _partner(groups: list[_Group], i: int, refused: set[tuple[_Group, _Group]]) -> int | None:
    """The next group that is convex together with group i. Pairs in `refused` are known not to be, and are not tried
    again."""
    for k in range(i + 1, len(groups)):
        pair = groups[i], groups[k]
        if pair not in refused:
            if _convex(*pair):
                return k
            refused.add(pair)
    return None


def _convex(one: _Group, other: _Group) -> bool:
    if np.maximum(one.low - other.high, other.low - one.high).max() > NEAR_M:
        return False
    if len(one.corners) + len(other.corners) > MAX_CORNERS:
        return False
    together = volume_of_hull(np.concatenate([one.corners, other.corners]))
    return together <= (one.volume + other.volume) * (1 + GAIN_SHARE)
