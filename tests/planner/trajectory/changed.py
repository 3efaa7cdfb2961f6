"""A trajectory with other columns, for forged plans."""

from __future__ import annotations

from typing import Any

from assur.planner.trajectory import Trajectory


def changed(path: Trajectory, **columns: Any) -> Trajectory:
    """The trajectory with other `time`, `q`, `qd`, `qdd` or `jumps`; what they must be is validated again."""
    own = {name: getattr(path, name) for name in ("time", "q", "qd", "qdd", "jumps")}
    return Trajectory(**{**own, **columns})
