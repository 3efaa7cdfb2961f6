"""No decision reads a sentence: with nonsense for every text, each verdict stays what it was."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from assur.planner.model.outcome import NotPlanned, Outcome, Planned
from assur.planner.model.scene import Scene
from assur.planner.pipeline import plan
from assur.planner.report import sentence
from assur.scenes import answer as answers
from tests.planner.test_pipeline import PROVED, REASONS

NONSENSE = ("the arm comes", "too close", "latest_end_s", "above the point", "")
"""Texts that decisions once depended on, and none at all."""


def nonsense(monkeypatch: pytest.MonkeyPatch, text: str) -> None:
    """Replaces every function of the module that makes sentences, wherever it has been imported."""
    from assur.planner import pipeline

    for module in (sentence, pipeline, answers):
        for name in ("sentence", "because", "note"):
            if callable(getattr(module, name, None)):
                monkeypatch.setattr(module, name, lambda *_, **__: text)


def verdict(outcome: Outcome) -> dict[str, Any]:
    """All of an outcome that decides something."""
    lines = [
        (line.refusal.stage, line.refusal.reason, line.refusal.step, line.refusal.subject, line.count)
        for line in outcome.census.lines
    ]
    found: dict[str, Any] = {"planned": isinstance(outcome, Planned), "census": lines}
    if isinstance(outcome, NotPlanned):
        found |= {"reason": outcome.reason, "proved": outcome.proved, "refusal": outcome.refusal}
        found |= {"relaxation": outcome.relaxation and outcome.relaxation.what, "tried": outcome.tried}
    else:
        found |= {"end": outcome.plan.trajectory.end, "digest": outcome.plan.certificate.digest}
    return found


TABLE: dict[str, Callable[[], Scene]] = {
    **{str(reason): make for reason, (make, *_) in REASONS.items()},
    **{name: make for name, (make, *_) in PROVED.items()},
}


@pytest.mark.parametrize("name", sorted(TABLE))
def test_no_refusal_changes_with_its_sentence(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    before = verdict(plan(TABLE[name]()))
    for text in NONSENSE:
        with monkeypatch.context() as patched:
            nonsense(patched, text)
            outcome = plan(TABLE[name]())
        assert verdict(outcome) == before
        assert not isinstance(outcome, NotPlanned) or outcome.sentence == text
