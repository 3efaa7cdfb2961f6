"""Checks plans without trusting who made them: `check(scene, plan)`.

It is looked up when it is first asked for: what a verdict is may be known without loading compiled code.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from assur.planner.checker.verdict import Code, Finding, Verdict

if TYPE_CHECKING:
    from assur.planner.checker.checking import check

__all__ = ["Code", "Finding", "Verdict", "check"]


def __getattr__(name: str) -> Any:
    """`check`, imported now. Raises `AttributeError` for any other name."""
    if name == "check":
        from assur.planner.checker.checking import check

        return check
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
