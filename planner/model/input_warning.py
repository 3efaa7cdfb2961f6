"""What of a request is possible, but probably not meant. No plan is refused for it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Odd(StrEnum):
    """The kind of a warning."""

    TOOL_IN_ARM = "TOOL_IN_ARM"
    """A body of the tool overlaps a link of the arm from which nobody keeps it apart."""
    PART_FLOATS = "PART_FLOATS"
    """A part rests on nothing, and something is a few millimetres below it."""
    TOOL_OFF_PART = "TOOL_OFF_PART"
    """No body of the tool touches the part where it is picked, or comes near it."""
    RELEASED_IN_AIR = "RELEASED_IN_AIR"
    """A part is released above a body that it does not touch."""
    BODIES_OVERLAP = "BODIES_OVERLAP"
    """A part to be picked is inside another body."""
    MAY_MISS = "MAY_MISS"
    """The tool may miss the part that it picks, and no tolerance is stated."""


@dataclass(frozen=True, slots=True)
class InputWarning:
    """`bodies`: the tool's body and the arm's, the part and what is below it, the tool's first body and the part, or
    two that overlap; `amount_m`: how far the part is above what is below it, the overlap that is allowed and exceeded
    (0: none), how far beside the tool the part was looked for, or how far off the tool may be. `step`, `cause`:
    of a pick that may miss its part, the name of the step and what adds most to the error."""

    kind: Odd
    bodies: tuple[str, str]
    amount_m: float
    step: str = ""
    cause: str = ""
