"""docs/glossary.md has the words that the API uses, each explained once, in order, with a link; and no others."""

from __future__ import annotations

import json
import re

from assur.planner.model.outcome import LegKind
from assur.planner.model.refusal import Reason, Stage
from assur.scenes.requests import request_schema
from tests.docs.pages import PAGES, prose, spans, text

PAGE = "docs/glossary.md"
ENTRY = re.compile(r"^- \*\*(.+?)\*\*: (.*?)(?=^- \*\*|\Z)", re.MULTILINE | re.DOTALL)
ENTRIES = ENTRY.findall(text(PAGE))
STATUSES = {"planned", "not_planned", "reached", "not_reached"}


def unused(terms: list[str]) -> list[str]:
    """Terms that no other page and no description of the request uses."""
    pages = " ".join(text(page) for page in PAGES if page != PAGE) + json.dumps(request_schema())
    everything = " ".join(pages.lower().split())
    return [term for term in terms if term.lower() not in everything]


def test_every_term_is_used_by_another_page_or_the_schema() -> None:
    assert len(ENTRIES) > 40
    assert unused([term for term, _ in ENTRIES]) == []


def test_a_term_that_nobody_uses_is_found() -> None:
    assert unused(["knot", "flux capacitor"]) == ["flux capacitor"]


def test_terms_are_in_the_order_of_the_alphabet_and_each_is_there_once() -> None:
    terms = [term for term, _ in ENTRIES]
    assert terms == sorted(set(terms), key=str.lower)


def test_every_term_has_at_least_one_sentence_and_a_link() -> None:
    for term, words in ENTRIES:
        assert re.search(r"\]\([\w./-]+\.md(#[\w-]+)?\)", words), term
        assert words.count(". ") + words.count(".\n") <= 4, term


def test_every_status_reason_stage_and_leg_of_the_api_is_explained() -> None:
    glossary = {term for term, _ in ENTRIES} | set(spans(PAGE))
    refusals = set(re.findall(r"^\| `([^`]+)` \|", prose("docs/refusals.md"), re.MULTILINE))
    words = STATUSES | {str(word) for kinds in (Reason, Stage, LegKind) for word in kinds}
    assert words - glossary - refusals == set()
