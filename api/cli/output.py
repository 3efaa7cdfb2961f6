"""What commands write: tables and documents on standard output, lines of their own on standard error."""

from __future__ import annotations

import sys
from functools import cache
from typing import TYPE_CHECKING, Any

from assur.api.cli import console_report
from assur.api.cli.inputs import Target
from assur.api.documents import to_json
from assur.api.problems import printable
from assur.scenes import kernels as compiled_kernels

if TYPE_CHECKING:
    from assur.scenes.reading.cell import Cell


def say(text: str, code: int = 0, line: int | None = None) -> int:
    """One line on standard error; returns `code`."""
    at = "" if line is None else f"line {line}: "
    sys.stderr.write(f"assur: {at}{printable(text, 2500)}\n")
    return code


def read_cell(given: Target) -> Cell:
    """The cell of what was given, read; only a start at a pose takes the kernels for it."""
    if given.starts_at_a_pose:
        announce_compilation()
    return given.cell


@cache
def announce_compilation() -> None:
    """Says, once, that the first command of an installation takes longer, and why."""
    if not compiled_kernels.is_compiled():
        say(f"compiling the planner's kernels once, about a minute; they are kept in {compiled_kernels.folder()}")


def tell(*parts: Any) -> None:
    console = console_report.console()
    for part in parts:
        console.print(part, soft_wrap=isinstance(part, str))


def tell_json(document: Any) -> None:
    sys.stdout.buffer.write(to_json(document) + b"\n")
