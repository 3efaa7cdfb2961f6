"""What a claim cannot state yet."""

from __future__ import annotations

from assur.planner.errors import InputError


def unstated(what: str) -> InputError:
    """The refusal of a plan with something that no claim can state."""
    return InputError("plan", what, "an answer without it: a proof bundle cannot state it yet")
