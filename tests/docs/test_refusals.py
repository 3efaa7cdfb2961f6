"""docs/refusals.md lists every reason, warning and finding that the code knows, and nothing else; and what it says of
proofs agrees with the shipped scenarios."""

from __future__ import annotations

import re
from dataclasses import fields
from enum import StrEnum

import pytest

from assur.planner.checker.verdict import Code
from assur.planner.model.input_warning import WarningKind
from assur.planner.model.refusal import Reason, Stage
from assur.planner.report.refusal_table import KINDS
from assur.scenes.reading.refusal import ABOUT
from assur.scenes.requests import plan_scenario, shipped
from assur.scenes.scenarios import shipped_scenarios
from tests.docs.pages import PAGES, prose

PAGE = "docs/refusals.md"


def section(heading: str) -> str:
    """A section of the page."""
    return prose(PAGE).split(f"## {heading}\n")[1].split("\n## ")[0]


def rows(heading: str) -> dict[str, list[str]]:
    """The table of a section: the cells of each row by the first one."""
    table = [line.strip("|").split(" | ") for line in section(heading).splitlines() if line.startswith("| `")]
    return {cells[0].strip(" `"): [cell.strip() for cell in cells[1:]] for cells in table}


@pytest.mark.parametrize(
    ("heading", "codes"),
    [("The reasons", Reason), ("The stages", Stage), ("Warnings", WarningKind), ("What the checker finds", Code)],
    ids=str,
)
def test_a_table_lists_every_code_once_in_the_order_of_the_code(heading: str, codes: type[StrEnum]) -> None:
    assert list(rows(heading)) == [str(code) for code in codes]
    assert section(heading).count("\n| `") == len(codes)


@pytest.mark.parametrize("heading", ["The reasons", "The stages", "Warnings", "What the checker finds"])
def test_no_cell_of_a_table_is_empty(heading: str) -> None:
    assert all(len(cell) > 3 for cells in rows(heading).values() for cell in cells)


def test_the_table_of_facts_is_that_of_the_code() -> None:
    written = {
        next(each.default for each in fields(facts) if each.name == "kind"): [
            ", ".join(f"`{reason}`" for reason in kind.reasons),
            " or ".join(ABOUT[each] for each in kind.about),
            ", ".join(kind.units) or "none",
        ]
        for facts, kind in KINDS.items()
    }
    assert {name: [cell.removesuffix(" |") for cell in cells] for name, cells in rows("The facts").items()} == written
    assert [section("The facts").count(f"`{name}` |") for name in written] == [1] * len(written)


FOUND_BY = {"proof": {True}, "search": {False}, "both": {True, False}}


def test_every_shipped_refusal_is_found_as_the_table_says() -> None:
    table = rows("The reasons")
    assert {cells[1] for cells in table.values()} == set(FOUND_BY)
    refusals = [each for each in map(shipped, shipped_scenarios()) if each.expect.get("status") == "not_planned"]
    assert len(refusals) > 8
    for scenario in refusals:
        answer = plan_scenario(scenario)
        assert answer["proved"] in FOUND_BY[table[answer["reason"]][1]], answer["sentence"]


def test_no_other_page_holds_a_second_table_of_reasons() -> None:
    for page in PAGES:
        lines = re.findall(r"^\| `([A-Z_]+)` \|", prose(page), re.MULTILINE)
        if page != PAGE:
            assert len(set(lines) & {str(reason) for reason in Reason}) < 2, page
