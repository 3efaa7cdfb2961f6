"""What the checker refused in a search: a fault of the planner, with which the sentence of a refusal begins."""

from __future__ import annotations

from assur.planner.model.outcome import Census
from assur.planner.model.refusal import Refuted


def checker_first(census: Census) -> str:
    """How many plans the checker refused, and what it found in one of them; nothing: it refused none."""
    lines = ((line.count, line.refusal.facts) for line in census.lines)
    return beginning([(count, facts.code, facts.what) for count, facts in lines if isinstance(facts, Refuted)])


def beginning(found: list[tuple[int, str, str]]) -> str:
    """The same of lines of a census: how many plans were refused, and for which code and what."""
    if not found:
        return ""
    count, (_, code, what) = sum(each[0] for each in found), found[0]
    plans = "a plan" if count == 1 else f"{count} plans"
    return f"A fault of the planner: the checker refused {plans} of the search ({code}: {what}); please report it. "
