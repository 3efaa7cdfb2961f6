"""Windows that are missed: why, and by how much at least."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from planner.legs.control_point import ControlPoint
from planner.outcome import Reason, Refusal
from planner.scene import Scene


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
            return Refusal("window", Reason.WINDOW_MISSED, point.step, (), None, *point.never_inside())
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
    detail = "the arm comes after the window has closed" + _way(point, high, earliest)
    return Refusal("window", Reason.WINDOW_MISSED, point.step, (), (low, high), earliest - high, "s", detail)


def _way(point: ControlPoint, t0: float, t1: float) -> str:
    way = point.along(np.array([t0, t1]))
    if way is None or not np.isfinite(way).all():
        return ""
    return f" ({1e3 * abs(float(way[1] - way[0])):.0f} mm of belt)"
