"""Windows that are missed: why, and by how much at least."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from assur.planner.errors import FaultError
from assur.planner.legs.control_point import HORIZON_S, ControlPoint
from assur.planner.model.outcome import LATEST, Reason, Refusal
from assur.planner.model.scene import Scene


def window_missed(scene: Scene, point: ControlPoint, earliest: float) -> Refusal:
    """Why no meeting time is left: the window is over before `earliest`, or the dwell does not fit into it."""
    intervals = point.intervals
    if not intervals:
        whole = replace(point, dwell=0.0).intervals
        if not whole:
            law = scene.frames[point.frame].law
            if not law.valid[1] >= scene.start.time:
                return Refusal(
                    "window", Reason.LAW_ENDS, point.step, (point.frame,), None, scene.start.time - law.valid[1], "s"
                )
            return Refusal("window", Reason.WINDOW_MISSED, point.step, (), None, *_never_open(scene, point))
        low, high = max(whole, key=lambda span: span[1] - span[0])
        short = point.dwell - (high - low)
        detail = f"the window is open for {1e3 * (high - low):.0f} ms, the glue takes {1e3 * point.dwell:.0f} ms"
        return Refusal(
            "window",
            Reason.WINDOW_MISSED,
            point.step,
            (),
            (low, high),
            short,
            "s",
            detail + _way(point, high, high + short),
        )
    low, high = intervals[-1]
    latest = scene.options.latest_end_s
    # the same difference as that of the intervals, to the bit
    by_latest = latest is not None and high == latest - point.dwell
    late = f"the arm comes too late for {LATEST}" if by_latest else "the arm comes after the window has closed"
    detail = late + _way(point, high, earliest)
    return Refusal("window", Reason.WINDOW_MISSED, point.step, (), (low, high), earliest - high, "s", detail)


def _never_open(scene: Scene, point: ControlPoint) -> tuple[float, str, str]:
    """By how much, its unit, and in words: why the point may be met at no time, however short the glue.

    A number is a fact for all times; there is none where not all of them were looked at, or known.
    """
    (low, high), start, latest = point.span, scene.start.time, scene.options.latest_end_s
    ends = scene.frames[point.frame].law.valid[1]
    if point.window.time is not None and point.window.time[1] < start:
        return start - point.window.time[1], "s", "the window is over before the start"
    if latest is not None and high == latest < low:
        return low - latest, "s", f"the window opens after {LATEST}" if low > start else f"{LATEST} is before the start"
    if high < low:
        return math.nan, "", "the window opens when the motion of the frame is not known any more"
    if point.window.along is None:
        raise FaultError("a span that is not empty, without a window along a conveyor, is one of the intervals")
    inside = point.inside(point.window.along)
    if not inside:
        return _never_inside(point, point.window.along)
    if high == ends:
        return math.nan, "", "the point is not inside its windows while its motion is known"
    if high > start + HORIZON_S:
        return math.nan, "", f"the point is not inside its windows in the next {HORIZON_S:g} s"
    gap = min(max(a - high, low - b) for a, b in inside)
    closes = math.inf if point.window.time is None else point.window.time[1]
    if any(a <= closes and b >= low for a, b in inside):
        return gap, "s", f"the point comes into its window after {LATEST}"
    return gap, "s", "the window in time and the window along the belt have no instant in common"


def _never_inside(point: ControlPoint, window: tuple[float, float]) -> tuple[float, str, str]:
    """The same for a point that is in its window along a conveyor at no time that is looked at."""
    grid = point.scene.start.time + HORIZON_S * np.arange(1001) / 1000
    way = point.along(grid)
    low, high = window
    if way is None or not np.isfinite(way).all():
        return math.nan, "", "the point is not inside its window while its motion is known"
    leaving = way[-1] >= way[-2] if way[-1] > high else way[-1] <= way[-2]
    if not leaving:
        return math.nan, "", f"the point is not inside its window in the next {HORIZON_S:g} s"
    return float(np.maximum(low - way, way - high).min()), "m", "the point is never inside its window"


def _way(point: ControlPoint, t0: float, t1: float) -> str:
    way = point.along(np.array([t0, t1]))
    if way is None or not np.isfinite(way).all():
        return ""
    return f" ({1e3 * abs(float(way[1] - way[0])):.0f} mm of belt)"
