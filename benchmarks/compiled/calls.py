"""Function by function: first whether each says what its original says, then how long both take on the same calls."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from benchmarks.cold import forget
from benchmarks.compiled import packing
from benchmarks.compiled.comparing import ALIKE, Beside, Compared, Timed
from benchmarks.compiled.replacements import REPLACEMENTS, Replacement, replaced
from benchmarks.compiled.requests import Question
from planner.pipeline import plan
from scenes.requests import scene_of

REPEATS = 9
"""Of each call, original and compiled in turn; their medians count."""
UNHURRIED = {"budget_s": 60.0, "max_candidates": 300}
"""Options while calls are compared: a proof that the clock ends in one of the two would tell nothing."""

Document = dict[str, Any]


def compared(questions: list[Question], some: Sequence[Replacement] = REPLACEMENTS) -> dict[str, Compared]:
    """Every call of these functions while these requests are answered, by the original and by the compiled
    function. Raises `Differs`."""
    beside = Beside()
    with replaced(some, beside):
        for question in questions:
            forget()
            packing.forget()
            options = question.document["options"] | UNHURRIED
            plan(scene_of(question.document | {"options": options}))
    return beside.found


def timed(questions: list[Question], differences: dict[str, Compared]) -> list[Document]:
    """A row for each function: calls, ms before and after in these requests on the average, largest difference.

    One function is replaced at a time, so what an original calls is original too. Each call is repeated: what it keeps
    for the next call is warm for both.
    """
    rows = []
    for replacement in REPLACEMENTS:
        clock = Timed(REPEATS)
        with replaced((replacement,), clock):
            for question in questions:
                forget()
                packing.forget()
                plan(scene_of(question.document))
        many, told = len(questions), differences[replacement.name]
        rows.append(
            {
                "function": replacement.name,
                "fused": replacement.fused,
                "calls": clock.calls / many,
                "before_ms": 1e3 * clock.before_s / many,
                "after_ms": 1e3 * clock.after_s / many,
                "compared": told.calls,
                "difference": told.worst,
                "alike": told.worst <= ALIKE,
            }
        )
    return rows
