"""The program behind docs/decisions still measures what the pages say, each part on one problem."""

from __future__ import annotations

import re
import runpy
from typing import Any

import pytest
from rich.console import Console

from tests.docs.pages import ROOT, commands, text

PROGRAM = ROOT / "docs" / "decisions" / "measure.py"
INDEX = "docs/decisions/README.md"


@pytest.fixture(scope="module")
def measure() -> dict[str, Any]:
    return runpy.run_path(str(PROGRAM), run_name="measure")


def test_the_commands_that_are_shown_are_the_parts_of_the_program(measure: dict[str, Any]) -> None:
    shown = [command.line for command in commands(INDEX)]
    assert shown == [f"python -m docs.decisions.measure {part}" for part in measure["WHAT"]]


@pytest.mark.parametrize("part", ["grid", "knots", "scores"])
def test_every_part_measures_something(part: str, measure: dict[str, Any]) -> None:
    console: Console = measure["OUT"]
    with console.capture() as printed:
        measure["WHAT"][part](1)
    lines = printed.get().splitlines()
    assert len(lines) >= 4


@pytest.mark.slow
def test_limits_are_looked_for_in_logs_of_a_kind(measure: dict[str, Any]) -> None:
    console: Console = measure["OUT"]
    with console.capture() as printed:
        measure["limits_in"](["noise"], 1)
    line = printed.get().splitlines()[-1]
    assert re.fullmatch(r"noise +2 +[0-2] +\S+ % +0 +[0-2] +\S+ % +0 *", line)


def test_every_decision_is_in_the_index_and_bears_its_number() -> None:
    pages = sorted(path.name for path in PROGRAM.parent.glob("0*.md"))
    assert re.findall(r"\]\((0\d{3}-[\w-]+\.md)\)", text(INDEX)) == pages
    for number, page in enumerate(pages, start=1):
        assert page.startswith(f"{number:04d}-")
        assert text(f"docs/decisions/{page}").startswith(f"# {number:04d} ")
