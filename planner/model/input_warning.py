"""What of a request is possible, but probably not meant. No plan is refused for it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class WarningKind(StrEnum):
    """The kind of a warning."""

    TOOL_IN_ARM = "TOOL_IN_ARM"
    """A body of the tool overlaps a link of the arm from which nobody keeps it apart."""
    PART_FLOATS = "PART_FLOATS"
    """A part rests on nothing, and something is a few millimetres below it."""
    TOOL_OFF_PART = "TOOL_OFF_PART"
    """No body of the tool is near the part where it is picked."""
    RELEASED_IN_AIR = "RELEASED_IN_AIR"
    """A part is released above a body that it does not touch."""
    SUPPORT_OFF_PART = "SUPPORT_OFF_PART"
    """A step names a body that its part touches, and it does not."""
    BODIES_OVERLAP = "BODIES_OVERLAP"
    """A part to be picked is inside another body."""
    MAY_MISS = "MAY_MISS"
    """The tool may miss the part that it picks, and no tolerance is stated."""


@dataclass(frozen=True, slots=True)
class InputWarning:
    """`bodies`: the tool's body and the arm's, the part and what is below it, or what it should touch, the tool's
    nearest body and the part, or two that overlap; `amount_m`: how far the part is above what is below it, or from what
    it should touch, the overlap that is allowed and exceeded (0: none), how far the tool is from the part, or may be
    off it. `step`: the name of a pick that may miss its part, or of the step that names what its part touches; `cause`:
    what adds most to the error of that pick, or why the tool is far from the part."""

    kind: WarningKind
    bodies: tuple[str, str]
    amount_m: float
    step: str = ""
    cause: str = ""
