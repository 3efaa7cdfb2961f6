"""Fills the answers into docs/examples.md: `python -m docs.make_examples`.

The words of the page are written by hand. Between `<!-- answer: NAME -->` and `<!-- end -->` stands the head of the
answer to the shipped scenario of that name, as `assur plan NAME` prints it. Searches of these scenarios end by a count,
so that every machine finds the same.
"""

from __future__ import annotations

import re
import sys
from io import StringIO
from pathlib import Path
from typing import Any

from rich.console import Console

from assur.api.cli import console_report
from assur.scenes.requests import cell_of, plan_cell, shipped

PAGE = Path(__file__).parent / "examples.md"
ANSWER = re.compile(r"(?<=<!-- answer: )([\w-]+)( -->\n).*?(?=<!-- end -->)", re.DOTALL)
KEPT = ("arrival", "traced path", "may be off")
"""Tables of an answer that are shown; a blank line ends each."""
LINES = ("duration", "smallest clearance", "not planned")
"""Single lines that are shown."""


def _printed(answer: dict[str, Any]) -> list[str]:
    """The lines of an answer as the command line prints them, without blanks at their ends."""
    told = console_report.planned(answer) if answer["status"] == "planned" else console_report.not_planned(answer)
    out = StringIO()
    shown = Console(file=out, width=console_report.WIDTH, markup=False, highlight=False, emoji=False, soft_wrap=False)
    for part in told:
        shown.print(part, soft_wrap=isinstance(part, str))
    return [line.rstrip() for line in out.getvalue().splitlines()]


def head(name: str, answer: dict[str, Any]) -> str:
    """What of an answer is shown: points and when they are met, duration and smallest clearance; or the refusal."""
    if answer["cut_by_clock"]:
        raise SystemExit(f"{name}: the clock ended the search; its numbers are not those of every machine")
    lines = _printed(answer)
    kept = [f"{name}: {'planned' if answer['status'] == 'planned' else 'not planned'}", ""]
    if answer["status"] == "not_planned":
        kept += lines[:2]
        return "\n".join(kept)
    inside = False
    for line in lines:
        inside = line.startswith(KEPT) or (inside and bool(line))
        if inside or line.startswith(LINES):
            if line.startswith(("duration", *KEPT[1:])):
                kept.append("")
            kept.append(line)
    return "\n".join(kept)


def answer_to(name: str) -> dict[str, Any]:
    """The answer to a shipped scenario with a full report, as `assur plan` requires it."""
    scenario = shipped(name)
    return plan_cell(cell_of(scenario.request, folder=scenario.folder), unstated={"report": "full"})


def filled(page: str) -> str:
    """The page with the answers of now."""

    def answered(match: re.Match[str]) -> str:
        name = match.group(1)
        return f"{name}{match.group(2)}\n```text\n{head(name, answer_to(name))}\n```\n\n"

    return ANSWER.sub(answered, page)


def main() -> int:
    """Writes the answers of now into the page."""
    PAGE.write_text(filled(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
