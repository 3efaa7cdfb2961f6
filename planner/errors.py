"""Faults, drawn as a small tree: the caller's and ours.

A refusal of a candidate or of a request that cannot be planned is a *value* (see `assur.planner.model.outcome`);
exceptions are for what should never have been asked, and for what should never have happened.
"""

from __future__ import annotations


class AssurError(Exception):
    """Root of every exception that this project raises on purpose."""


class InputError(AssurError):
    """The caller's fault: a field holds a value that is not allowed.

    Arguments: `field`, the dotted path of the field (``task[0].pick.part``); `value`, what it held;
    `allowed`, a sentence fragment that says what would have been accepted.
    """

    def __init__(self, field: str, value: object, allowed: str) -> None:
        shown = repr(value)
        if len(shown) > 80:
            shown = shown[:77] + "..."
        super().__init__(f"{field}: got {shown}; allowed: {allowed}")
        self.field = field
        self.value = value
        self.allowed = allowed

    def __reduce__(self) -> tuple[type[InputError], tuple[str, object, str]]:
        return type(self), (self.field, self.value, self.allowed)


class FaultError(AssurError):
    """Ours: an invariant of the planner does not hold."""
