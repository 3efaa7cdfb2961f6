"""What the checker says of an answer, in words: right or wrong, and of a refusal which fields are not verified."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from rich.table import Table

from assur.api.cli.console_report import findings, rows

NOTES = {
    "best_candidate": "the motion that came furthest; it is no plan",
    "census": "what became of the candidates",
    "cut_by_clock": "whether the time ended the search",
    "elapsed_s": "how long it took",
    "explain_budget_spent": "whether there was time to try more changes",
    "reason": "why the search found no plan",
    "refusal": "at which step, by what, and by how much",
    "refusal.amount": "how deep the bodies overlap",
    "refusal.facts.gap_m": "the same",
    "refusal.facts.least_m": "how near they came in the search",
    "relaxation": "a change that is proposed; whether it helps is not verified here",
    "sentence": "the same, and how often, in words",
    "tried": "the changes that were tried",
    "warnings": "what is probably not meant",
}
"""Fields of a refusal that the checker does not verify, and what they say."""


def everything(verdict: dict[str, Any], answer: dict[str, Any]) -> Iterator[Table | str]:
    """The whole verdict for people."""
    refused = answer["status"] == "not_planned"
    if verdict["ok"]:
        yield _right(answer)
    else:
        yield "refusal wrong" if refused else "plan wrong"
        yield ""
        yield findings(verdict)
    if refused and verdict["not_checked"]:
        unseen = rows(("not checked", ""), ((field, NOTES[field]) for field in verdict["not_checked"]))
        yield from ("", unseen, "")
    if verdict["ok"]:
        yield verdict["notice"]


def _right(answer: dict[str, Any]) -> str:
    """The sentence for an answer in which nothing is wrong."""
    if answer["status"] == "planned":
        return "plan right: everything that it promises holds against the model"
    if answer["proved"]:
        return "refusal right: no plan exists, for the reason that it says"
    return "refusal right as far as it can be checked: it says that it is not proved"
