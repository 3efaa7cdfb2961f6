"""The report of an answer, with the verdict of the checker in it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from assur.api.version import version
from assur.scenes.requests import report_page, verdict_on

if TYPE_CHECKING:
    from assur.scenes.reading.cell import Cell


def checked_report(cell: Cell, answer: dict[str, Any], title: str, about: str) -> tuple[str, dict[str, Any] | None]:
    """The page, and the verdict; None: the answer has not enough of its proof to be checked. Raises `InputError`."""
    verdict = verdict_on(cell, answer)
    return report_page(cell, answer, title=title, about=about, verdict=verdict, version=version()), verdict
