"""Why a control point is not met in its window, or a motion does not end in time: typed facts, times in seconds."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Literal


class Miss(StrEnum):
    """Why a control point is not met in its window, or a motion does not end in time."""

    TOO_SHORT = "too short"
    """The window is open for less time than the point must be tracked."""
    OVER_BEFORE_START = "over before start"
    OPENS_AFTER_LATEST_END = "opens after latest end"
    LATEST_END_BEFORE_START = "latest end before start"
    ENTERS_AFTER_LATEST_END = "enters after latest end"
    """The point comes into its window along the conveyor only after the latest end."""
    NEVER_INSIDE = "never inside"
    """The point is at no time inside its window along the conveyor."""
    NO_COMMON_INSTANT = "no common instant"
    """The window in time and the window along the conveyor have no instant in common."""
    OPENS_AFTER_LAW = "opens after law"
    """The window opens when the motion of the frame is not known any more."""
    NOT_INSIDE_WHILE_KNOWN = "not inside while known"
    NOT_INSIDE_SOON = "not inside soon"
    """The point is not inside within the time that is searched."""
    CLOSED_ON_ARRIVAL = "closed on arrival"
    """The arm comes after the window has closed."""
    LATEST_END_ON_ARRIVAL = "latest end on arrival"
    """The arm comes so late that tracking would last beyond the latest end."""
    ENDS_TOO_LATE = "ends too late"
    """The motion ends after the latest end."""
    NO_MEETING_LEFT = "no meeting left"
    OUTSIDE = "outside"
    NO_COMMON_BEGIN = "no common begin"
    """No begin of the motion was found from which all windows are met."""


FOR_ALL_TIMES = frozenset(
    {
        Miss.TOO_SHORT,
        Miss.OVER_BEFORE_START,
        Miss.OPENS_AFTER_LATEST_END,
        Miss.LATEST_END_BEFORE_START,
        Miss.ENTERS_AFTER_LATEST_END,
        Miss.NEVER_INSIDE,
        Miss.NO_COMMON_INSTANT,
    }
)
"""Misses that do not depend on when, or whether, the arm comes."""


@dataclass(frozen=True, slots=True, kw_only=True)
class WindowMissed:
    """`open_s`: how long the window is open; `needed_s`: how long the point must be tracked; `belt_m`: how far the
    conveyor goes in the time that is missing; `searched_s`: how long was searched."""

    kind: Literal["window"] = "window"
    miss: Miss
    open_s: float | None = None
    needed_s: float | None = None
    belt_m: float | None = None
    searched_s: float | None = None
