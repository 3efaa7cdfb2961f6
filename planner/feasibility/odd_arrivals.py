"""What is probably not meant about how exactly parts are met: picks that may miss their part."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from assur.planner.checker.refusals.ways import ways
from assur.planner.geometry.shapes import Body, support
from assur.planner.model.arrival_error import Cause
from assur.planner.model.deadline import look
from assur.planner.model.input_warning import InputWarning, Odd
from assur.planner.model.outcome import Arrival
from assur.planner.model.scene import Pick, Scene

DIRECTIONS = 180
"""Horizontal directions in which the extent of a part is taken, 1° apart, its own axes among them."""


def odd_arrivals(scene: Scene, arrivals: Sequence[Arrival]) -> tuple[InputWarning, ...]:
    """A warning for each pick without a tolerance of its position where the tool may be farther from the part than half
    of the part's smallest horizontal extent. Raises `OutOfTimeError` where the deadline in force passes."""
    found = []
    for arrival in arrivals:
        step, error = scene.task[arrival.step], arrival.error
        if isinstance(step, Pick) and error is not None and _may_miss(scene, step, error.position_m):
            most = max(error.shares, key=lambda share: share.position_m, default=None)
            cause = "" if most is None else str(most.cause)
            if most is not None and most.cause is Cause.FRAME:
                cause = f"frame {ways(scene, arrival.step)[0].frame}"
            bodies = scene.tool.bodies[0].name if scene.tool.bodies else scene.robot.links[-1], step.part
            found.append(InputWarning(Odd.MAY_MISS, bodies, error.position_m, step.name, cause))
    return tuple(found)


def _may_miss(scene: Scene, step: Pick, error_m: float) -> bool:
    return math.isinf(step.tolerance.position_m) and error_m > smallest_extent(scene.index[step.part].body) / 2.0


def smallest_extent(body: Body) -> float:
    """The smallest width of a body between two parallel vertical planes, m; up to 1 % too large for shapes that lie
    askew in their body's frame, as it is looked for in steps of 1°."""
    widths = []
    for angle in np.pi * np.arange(DIRECTIONS) / DIRECTIONS:
        look()
        n = np.array([np.cos(angle), np.sin(angle), 0.0])
        widths.append(
            max(support(piece, n) for piece in body.pieces) + max(support(piece, -n) for piece in body.pieces)
        )
    return float(min(widths))
