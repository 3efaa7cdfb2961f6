"""Carriers: kinds whose parts have slots. They come in streams of their own, and are filled."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from assur.planner.geometry.shapes import support
from assur.scenes.bounds import MAX_SLOTS
from assur.scenes.faults import Refused, choices
from assur.scenes.schema.cell_file import CellDocument, SlotsDocument
from assur.scenes.schema.streams import StreamDocument

if TYPE_CHECKING:
    from assur.planner.geometry.shapes import Body


def shares_of(item: StreamDocument) -> dict[str, float]:
    """The kinds of a stream, and their shares."""
    return {item.kind: 1.0} if item.kind is not None else dict(item.kinds or {})


def slots_for(kind: str, item: StreamDocument) -> str | None:
    """The slots to which a kind of a stream goes, as they are written."""
    return item.to.get(kind) if isinstance(item.to, dict) else item.to


def check_brought(grid: str, cell: CellDocument, where: tuple[str, ...]) -> None:
    """Raises `Refused`, at `where`, for slots on a kind that no stream brings, or several."""
    kind = cell.slots[grid].kind
    bringing = [name for name, item in cell.streams.items() if kind in shares_of(item)]
    if len(bringing) != 1:
        there = f"{kind} comes with {', '.join(bringing)}" if bringing else f"no stream brings {kind}"
        raise Refused(f"slots that come with one stream: {grid} is on {kind}, and {there}", *where)


def check_on_kind(grid: SlotsDocument, cell: CellDocument, solids: Mapping[str, Body]) -> None:
    """Raises `Refused` for slots on a kind that the cell has not, in several layers, or not above its parts."""
    kind, (nx, ny, nz) = str(grid.kind), grid.count or (1, 1, 1)
    if kind not in cell.kinds:
        raise Refused(f"one of the kinds: {choices(cell.kinds, kind)}", "kind")
    if nz != 1:
        raise Refused("1 along z: parts on a carrier lie side by side", "count")
    if nx * ny > MAX_SLOTS:
        raise Refused(f"at most {MAX_SLOTS:,} slots in all", "count")
    for x, y, _ in _corners(grid):
        for along in ((x, 0.0), (0.0, y)):
            length = math.hypot(*along)
            n = np.array([*along, 0.0]) / (length or 1.0)
            most = max((support(piece, n) for piece in solids[kind].pieces), default=0.0) if kind in solids else length
            if length > most:
                off = f"one is {1e3 * length:.6g} mm from its origin, and it ends {1e3 * most:.6g} mm from there"
                raise Refused(f"slots above {kind}: {off}", "at_m" if [x, y] == list(grid.at_m[:2]) else "step_m")


def _corners(grid: SlotsDocument) -> list[list[float]]:
    """The places of the slots at the corners of a grid, m."""
    (nx, ny, _), step = grid.count or (1, 1, 1), grid.step_m or [0.0, 0.0, 0.0]
    x, y, z = grid.at_m
    return [[x + i * step[0], y + j * step[1], z] for i in {0, nx - 1} for j in {0, ny - 1}]


def filled(name: str, cell: CellDocument, solids: Mapping[str, Body]) -> tuple[float, tuple[float, float]]:
    """The radius and the heights of a kind, with the largest parts in all of its slots."""
    radius, (low, high) = solids[name].radius, solids[name].heights
    on_it = {grid: slots for grid, slots in cell.slots.items() if slots.kind == name}
    parts = [(kind, slots_for(kind, item)) for item in cell.streams.values() for kind in shares_of(item)]
    for kind, to in parts:
        if to in on_it and kind in solids:
            for x, y, z in _corners(on_it[to]):
                radius = max(radius, math.hypot(x, y) + solids[kind].radius)
                low, high = min(low, z + solids[kind].heights[0]), max(high, z + solids[kind].heights[1])
    return radius, (low, high)
