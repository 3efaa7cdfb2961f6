"""Grids of slots: where each slot is."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from assur.scenes.schema.model import ORIGIN
from assur.scenes.schema.normal import normal


def slot_poses(grids: dict[str, Any]) -> Iterator[tuple[str, int, dict[str, Any]]]:
    """Each slot of the `slots` of a cell, which are valid: its grid, its number and its pose, in SI."""
    for name, written in grids.items():
        grid = normal(written)
        for number in range(1, math.prod(counts(grid)) + 1):
            yield name, number, pose_of_slot(grid, number)


def counts(grid: dict[str, Any]) -> tuple[int, ...]:
    """The number of slots of a grid, which is valid, along x, y and z."""
    return tuple(int(count) for count in grid.get("count", (1, 1, 1)))


def pose_of_slot(grid: dict[str, Any], number: int) -> dict[str, Any]:
    """The pose of a slot of a grid, which is in SI."""
    nx, ny, _ = counts(grid)
    n, step = number - 1, grid.get("step_m", (0.0, 0.0, 0.0))
    steps = n % nx, n // nx % ny, n // (nx * ny)
    at = [start + many * far for start, many, far in zip(grid.get("at_m", ORIGIN), steps, step, strict=True)]
    kept: dict[str, Any] = {key: grid[key] for key in ("frame", "body", "yaw_rad") if key in grid}
    return {"yaw_rad": 0.0, **kept, "at_m": at}
