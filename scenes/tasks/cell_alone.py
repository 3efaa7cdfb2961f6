"""A cell without a task, as it is drawn: the arm stands inside of its limits, and moves to each named position."""

from __future__ import annotations

from itertools import product
from typing import Any

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.scenes.bounds import MAX_STEPS
from assur.scenes.faults import Refused, located, within
from assur.scenes.schema.cell_file import TASK, CellDocument
from assur.scenes.schema.normal import plain
from assur.scenes.schema.read import read
from assur.scenes.tasks.joining import joined
from assur.scenes.tasks.origins import OF_CELL, Joined, within_document

SHARES = (0.6, 0.4, 0.5, 0.75, 0.25)
"""Where each joint may stand, as a share of its range. Not in the middle, where many arms are stretched."""
ANYWHERE = {"at_m": [0.0, 0.0, 0.0]}
"""The only step of a cell without positions, which is not to be drawn."""


def cell_alone(cell: object) -> Joined:
    """The request of a cell whose task is to be written. Raises `DocumentError` whose fields begin with `cell`."""
    with within_document(OF_CELL):
        written = plain(cell)
        stated: CellDocument = read(CellDocument, written)
        with located(written):
            joints = _joints(stated)
    steps: list[dict[str, Any]] = [{"move": {"name": name, "to": name}} for name in stated.positions]
    return joined(
        cell,
        {"schema": TASK, "start": {"joints": joints}, "steps": steps[:MAX_STEPS] or [{"move": {"to": ANYWHERE}}]},
    )


def _joints(stated: CellDocument) -> dict[str, float]:
    """Joint positions within all limits, by their keys."""
    from assur.scenes.conventions import as_maker
    from assur.scenes.reading.robots import RobotWithTool, equipped
    from assur.scenes.reading.start import position

    def stands(q: FloatArray, given: RobotWithTool) -> bool:
        try:
            position(q, given)
        except (InputError, Refused):  # a chain that does not close with these joints
            return False
        return True

    with within("robot"):
        given = equipped(stated.robot)
    limits = given.robot.limits
    ways = (
        limits.lower + shares * (limits.upper - limits.lower) for shares in product(SHARES, repeat=len(limits.lower))
    )
    q = next((each for each in ways if stands(each, given)), 0.5 * (limits.lower + limits.upper))
    return dict(zip(given.conventions.keys, as_maker(q, given.conventions).tolist(), strict=True))
