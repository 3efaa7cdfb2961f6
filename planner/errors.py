"""Faults, drawn as a small tree: the caller's and ours.

A refusal of a candidate or of a request that cannot be planned is a *value* (see `assur.planner.model.outcome`);
exceptions are for input that is never valid, and for faults of this program.
"""

from __future__ import annotations

from typing import Any


class AssurError(Exception):
    """Root of every exception that this project raises on purpose."""


class InputError(AssurError):
    """The caller's fault: a field holds a value that is not allowed.

    Arguments: `field`, the dotted path of the field (``task[0].pick.part``); `value`, what it held;
    `allowed`, a sentence fragment that says what would have been accepted.
    """

    def __init__(self, field: str, value: object, allowed: str) -> None:
        super().__init__(f"{_cut(field, LONGEST_FIELD)}: got {_shown(value)}; allowed: {allowed}")
        self.field = field
        self.value = value
        self.allowed = allowed

    @property
    def errors(self) -> list[dict[str, Any]]:
        """Each fault that is known: `field`, `value`, `allowed`. Here it is one; a document may have several."""
        return [{"field": self.field, "value": self.value, "allowed": self.allowed}]

    def __reduce__(self) -> tuple[type[InputError], tuple[str, object, str]]:
        return type(self), (self.field, self.value, self.allowed)


class FaultError(AssurError):
    """Ours: an invariant of the planner does not hold."""


LONGEST_SHOWN, LONGEST_FIELD = 80, 400
"""So many characters of a value that is refused, and of the path of its field, are repeated."""


def _shown(value: object) -> str:
    """A value as an error repeats it. Python writes no number of thousands of digits."""
    if isinstance(value, int) and abs(value) >= 10**20:
        return "a whole number of more than 20 digits"
    try:
        shown = repr(value)
    except ValueError:
        return f"a {type(value).__name__} with a whole number of more than 4300 digits"
    return _cut(shown, LONGEST_SHOWN)


def _cut(text: str, longest: int) -> str:
    return text if len(text) <= longest else text[: longest - 3] + "..."
