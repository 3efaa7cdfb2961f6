"""What the checker refused in a search: a fault of the planner, with which the sentence of a refusal begins."""

from __future__ import annotations

from assur.planner.model.outcome import Census
from assur.planner.model.refusal import Refuted, Stage


def checker_first(census: Census) -> str:
    """How many plans the checker refused, and what it found in one of them; nothing: it refused none."""
    lines = [line for line in census.lines if line.refusal.stage is Stage.CHECKER]
    found = [line.refusal.facts for line in lines if isinstance(line.refusal.facts, Refuted)]
    return beginning(sum(line.count for line in lines), found[0].code, found[0].what) if found else ""


def beginning(count: int, code: str, what: str) -> str:
    """A sentence about so many plans; this was found in one of them."""
    plans = "a plan" if count == 1 else f"{count} plans"
    return f"A fault of the planner: the checker refused {plans} of the search ({code}: {what}); please report it. "
