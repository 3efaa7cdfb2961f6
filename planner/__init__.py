"""Proved jerk-limited motion of SCARA-class robots through moving control points among moving bodies.

``from assur.planner import Scene, check, plan``: `plan(scene)` returns an outcome (`assur.planner.model.outcome`) and
`check(scene, plan)` a verdict. Each is imported on first use, so ``import assur.planner`` loads no native library.
Facts only: documents, files and units are the business of `scenes`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from assur.planner.checked import check
    from assur.planner.model.scene import Scene
    from assur.planner.pipeline import plan

__all__ = ["Scene", "check", "plan"]


def __getattr__(name: str) -> Any:
    """One of `__all__`, imported now. Raises `AttributeError` for any other name."""
    if name == "Scene":
        from assur.planner.model.scene import Scene

        return Scene
    if name == "check":
        from assur.planner.checked import check

        return check
    if name == "plan":
        from assur.planner.pipeline import plan

        return plan
    raise AttributeError(f"module 'planner' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
