"""Cells that commands read, and the word that kernels are compiled first."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import TYPE_CHECKING

from assur.api.cli import console_report
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


@contextmanager
def compiled_work(what: str) -> Iterator[None]:
    """Within it something that needs the kernels is going on; a terminal shows `what`."""
    announce_compilation()
    with console_report.working(what):
        yield


@cache
def announce_compilation() -> None:
    """Says, once, that the first command of an installation takes longer, and why."""
    if not compiled_kernels.is_compiled():
        say(f"compiling the planner's kernels once, one to three minutes; they are kept in {compiled_kernels.folder()}")
