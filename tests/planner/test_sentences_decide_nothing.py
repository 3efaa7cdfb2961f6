"""No decision reads a sentence: with nonsense for every text, each status, verdict, proof and exit code stays."""

from __future__ import annotations

import copy
import json
import sys
from collections.abc import Callable
from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from assur.api.cli.border import RIGHT, WRONG
from assur.api.command_line import app
from assur.api.workers.jobs import FIRST_PLAN
from assur.planner.model.outcome import NotPlanned, Outcome
from assur.planner.model.scene import Scene
from assur.planner.pipeline import plan
from assur.planner.report import notes, refusal_words, sentence
from assur.planner.report.refusal_table import KINDS
from assur.scenes import answer_facts
from assur.scenes.answer_facts import refused_document
from assur.scenes.reading import plan as read_plans
from assur.scenes.reading import refusal as read_refusals
from assur.scenes.requests import check_document, plan_document, shipped, shipped_scenarios
from tests.planner.test_pipeline import PROVED, REASONS

NONSENSE = "the arm comes, 2 vias: tracking takes latest_end_s too close above the point"
"""Words on which decisions once depended."""
MOST = 12
"""Candidates of a shipped scenario: enough for refusals, few enough for all scenarios twice."""
TEXTS = {"sentence", "detail", "note"}
TIMES = {"elapsed_s", "first_s"}


@pytest.fixture
def nonsense(monkeypatch: pytest.MonkeyPatch) -> Callable[[], None]:
    """Replaces every function that makes words, wherever it has been imported."""

    def replace() -> None:
        makers = [
            item
            for texts in (sentence, refusal_words, notes)
            for item in vars(texts).values()
            if callable(item) and item.__module__ == texts.__name__ and item.__annotations__.get("return") == "str"
        ]
        assert {"sentence", "because", "note", "warned"} <= {each.__name__ for each in makers}
        # those that are imported in the course of a check, too, so that none keeps nonsense
        assert {read_plans.__name__, read_refusals.__name__, answer_facts.__name__} <= sys.modules.keys()
        originals = set(map(id, makers))
        for module in [each for key, each in sys.modules.items() if key.startswith("assur.")]:
            for name in [name for name, item in vars(module).items() if id(item) in originals]:
                monkeypatch.setattr(module, name, lambda *_, **__: NONSENSE)

    return replace


BY_KIND = {each.default: kind for facts, kind in KINDS.items() for each in fields(facts) if each.name == "kind"}


def is_of_the_table(line: Any) -> bool:
    """Whether reason, subject and unit of a refusal, as a document, go with its facts: another could not be read."""
    kind = BY_KIND[line["facts"]["kind"]]
    bodies = ("nothing", "body", "pair")[len(line["bodies"])]
    about = "joint" if line["joint"] else "frame" if line["frame"] else bodies
    return line["reason"] in kind.reasons and about in kind.about and line["unit"] in (None, *kind.units)


def decided(scene: Scene, outcome: Outcome) -> Any:
    """All of an outcome but the sentence and the time that it took."""
    assert all(is_of_the_table(refused_document(scene, line.refusal)) for line in outcome.census.lines)
    lines = [(line.refusal, line.count, line.most) for line in outcome.census.lines]
    if isinstance(outcome, NotPlanned):
        assert outcome.refusal is None or is_of_the_table(refused_document(scene, outcome.refusal))
        return outcome.reason, outcome.proved, outcome.refusal, outcome.tried, lines
    return outcome.plan.certificate.digest, outcome.plan.legs, lines


TABLE: dict[str, Callable[[], Scene]] = {
    **{str(reason): make for reason, (make, *_) in REASONS.items()},
    **{name: make for name, (make, *_) in PROVED.items()},
}


@pytest.mark.parametrize("name", sorted(TABLE))
def test_no_refusal_changes_with_its_sentence(name: str, nonsense: Callable[[], None]) -> None:
    scene = TABLE[name]()
    before = decided(scene, plan(scene))
    nonsense()
    outcome = plan(TABLE[name]())
    assert decided(scene, outcome) == before
    assert not isinstance(outcome, NotPlanned) or outcome.sentence == NONSENSE


def without(document: Any, keys: set[str]) -> Any:
    if isinstance(document, dict):
        return {key: without(value, keys) for key, value in document.items() if key not in keys}
    return [without(item, keys) for item in document] if isinstance(document, list) else document


@pytest.mark.parametrize("name", sorted(shipped_scenarios()))
def test_no_answer_to_a_shipped_scenario_changes_with_its_sentences(name: str, nonsense: Callable[[], None]) -> None:
    scenario = shipped(name)
    request = copy.deepcopy(scenario.request)
    request["options"] |= {"max_candidates": MOST, "explain_budget_s": 0, "budget_s": 60}
    for other in ("explain_budget_ms", "budget_ms"):
        request["options"].pop(other, None)
    before = plan_document(request, folder=scenario.folder)
    assert check_document(request, before, folder=scenario.folder)["ok"]
    assert all(map(is_of_the_table, before["census"]["lines"]))
    nonsense()
    answer = plan_document(request, folder=scenario.folder)
    assert without(answer, TEXTS | TIMES) == without(before, TEXTS | TIMES)
    # the checker compares words with those that are made of the facts, whatever they are
    assert check_document(request, json.loads(json.dumps(answer)), folder=scenario.folder)["ok"]
    if before.get("proved", True):  # of a search that found nothing, a sentence tells what is not known to the checker
        assert check_document(request, before, folder=scenario.folder)["ok"] is ("sentence" not in before)


@pytest.mark.parametrize(("x_m", "code"), [(0.4, RIGHT), (4.0, WRONG)])
def test_no_exit_code_changes_with_a_sentence(
    x_m: float, code: int, tmp_path: Path, nonsense: Callable[[], None]
) -> None:
    file = tmp_path / "request.json"
    file.write_text(json.dumps({**FIRST_PLAN, "task": [{"move": {"to": {"at_m": [x_m, 0.0, 0.25]}}}]}))
    runner = CliRunner()
    before = runner.invoke(app, ["plan", str(file)])
    nonsense()
    after = runner.invoke(app, ["plan", str(file)])
    assert (before.exit_code, after.exit_code) == (code, code)
    assert (NONSENSE in before.output, NONSENSE in after.output) == (False, True)
