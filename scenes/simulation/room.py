"""Room between the parts of a stream: whether one can be picked between two others that are as near as may be."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from assur.planner.geometry.shapes import support
from assur.planner.report.number_format import amount

if TYPE_CHECKING:
    from assur.planner.model.scene import Tool
    from assur.scenes.schema.cell_file import CellDocument
    from assur.scenes.streams.stream import Stream

DIRECTIONS = 72
"""Horizontal directions in which the extent of a tool is taken, 5° apart."""


def room_notes(cell: CellDocument, streams: Sequence[Stream], tool: Tool, apart_m: float) -> Iterator[str]:
    """Notes about streams whose parts may come nearer to each other than `apart_m`, the clearance near control points,
    what is not known of both, and a tool that is wider than the part need."""
    for stream in streams:
        least_m = stream.least_gap_m
        if stream.brings_carriers or least_m is None:
            continue
        wider_m = max(_reach(cell, kind.name, stream, tool, apart_m) for kind in stream.kinds) - stream.radius_m
        off_m = 2.0 * max(kind.off_m for kind in stream.kinds)
        needed_m = apart_m + off_m + max(0.0, wider_m)
        if least_m < needed_m:
            tool_is = f", {amount(wider_m, 'm')} by which the tool is wider" if wider_m > 0.0 else ""
            yield (
                f"{stream.name}: a part may come {amount(least_m, 'm')} behind another, and to pick it for "
                f"certain {amount(needed_m, 'm')} are needed ({amount(apart_m, 'm')} clearance, {amount(off_m, 'm')} "
                f"uncertainty{tool_is}). gap_mm of the stream states how near parts come"
            )


def _reach(cell: CellDocument, kind: str, stream: Stream, tool: Tool, apart_m: float) -> float:
    """How far from the origin of a part that it picks a tool is beside other parts at most, m: those of its bodies that
    go down to their tops."""
    x, y, z = cell.kinds[kind].grasp_m or (0.0, 0.0, 0.0)
    top = max(each.heights_m[1] for each in stream.kinds) + apart_m
    low = [body for body in tool.bodies if z + body.heights[0] - tool.tcp.z < top]
    turns = 2.0 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    ways = np.column_stack([np.cos(turns), np.sin(turns), np.zeros(DIRECTIONS)])
    far = [support(piece, n) - float(n @ tool.tcp.position) for body in low for piece in body.pieces for n in ways]
    return math.hypot(x, y) + max(far, default=0.0)
