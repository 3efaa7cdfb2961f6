"""Cells that commands read, and the word that kernels are compiled first."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

from assur.api.cli.border import say
from assur.api.cli.inputs import Target
from assur.scenes import kernels as compiled_kernels

if TYPE_CHECKING:
    from assur.scenes.reading.cell import Cell


def read_cell(given: Target) -> Cell:
    """The cell of what was given, read; only a start at a pose takes the kernels for it."""
    if given.starts_at_a_pose:
        announce_compilation()
    return given.cell


@cache
def announce_compilation() -> None:
    """Says, once, that the first command of an installation takes longer, and why."""
    if not compiled_kernels.is_compiled():
        say(f"compiling the planner's kernels once, one to five minutes; they are kept in {compiled_kernels.folder()}")
