"""The cause of a search without a plan: what stopped the candidate that came furthest."""

from __future__ import annotations

from itertools import pairwise
from types import SimpleNamespace
from typing import Any, cast

import pytest

from assur.planner.collision.screening import Encounter
from assur.planner.model.outcome import CensusLine
from assur.planner.model.refusal import Bodies, Quantity, Reason, Refusal, Refuted, Separation, Stage, Unit
from assur.planner.report.sentence import sentence
from assur.planner.search.beam import SearchResult
from assur.planner.search.cause import cause_of
from assur.planner.search.partial_plan import Extension, RefusedMotion, TimedCandidate
from tests.planner.cells import cell, go

SCENE = cell(go(0.35, 0.2, name="first"), go(0.3, 0.0, name="second"))


def refusal(stage: Stage, missing: float | None, name: str = "gate", step: int = 0, unit: Unit = "m") -> Refusal:
    return Refusal(
        stage=stage,
        reason=Reason.BODY_COLLISION,
        step=step,
        subject=Bodies(("cup", name)),
        interval=(1.0, 1.0),
        amount=None if missing is None else Quantity(missing, unit),
        facts=Separation(touching=False, gap_m=0.0, required_m=missing, rule="travel", clearance_m=missing),
    )


def motion(step: int, *, whole: bool) -> TimedCandidate | Extension:
    """A motion from a partial plan through so many steps: to the point, or the whole way through it."""
    before, none = cast(Any, SimpleNamespace(step=step)), cast(Any, None)
    return Extension(before, none, none, (), none) if whole else TimedCandidate(before, none, none, ())


def stopped(found: SearchResult, step: int, *refusals: Refusal, whole: bool) -> None:
    """A candidate that was refused, as the search counts it."""
    found.census.candidates += 1
    found.census.add_all(found.refused(motion(step, whole=whole), tuple(Encounter(each) for each in refusals)))


def cause(found: SearchResult) -> CensusLine:
    line = cause_of(found).line
    assert line is not None
    return line


def test_motions_rank_by_steps_then_stages_then_by_how_little_is_missing() -> None:
    order = [
        (0, False, Stage.SCREENING, None),
        (0, False, Stage.SCREENING, 0.02),
        (0, False, Stage.SCREENING, 0.01),
        (0, False, Stage.TRACKING, 0.01),
        (0, False, Stage.LIMITS, 0.02),
        (0, True, Stage.SCREENING, 0.05),
        (0, True, Stage.SCREENING, 0.04),
        (0, True, Stage.CERTIFICATE, 0.06),
        (1, False, Stage.SCREENING, 0.07),
    ]
    ranks = [
        RefusedMotion(motion(step, whole=whole), (Encounter(refusal(stage, missing)),)).rank
        for step, whole, stage, missing in order
    ]
    assert all(one < other for one, other in pairwise(ranks))


@pytest.mark.parametrize("last", [True, False])
def test_what_stopped_the_candidate_that_came_furthest_is_the_cause_whenever_it_was_tried(last: bool) -> None:
    found, best = SearchResult(), refusal(Stage.CERTIFICATE, 0.0001, "part")
    if not last:
        stopped(found, 0, best, whole=True)
    for k in range(9):
        stopped(found, 0, refusal(Stage.SCREENING, 0.01 + k / 1e3, "post"), whole=False)
    if last:
        stopped(found, 0, best, whole=True)
    line, census = cause(found), found.census.census()
    assert (line.refusal.bodies, line.count) == (("cup", "part"), 1)
    told = sentence(SCENE, line.refusal, line, census, cut=False)
    assert told.startswith("first: cup would come too close to part: gap 0 mm, required 0.1 mm")
    assert told.endswith("; most frequent: BODY_COLLISION of cup and post (9 of 10).")


def test_steps_count_more_than_anything() -> None:
    found = SearchResult()
    for _ in range(5):
        stopped(found, 0, refusal(Stage.CERTIFICATE, 0.0001, "part"), whole=True)
    found.deepest, found.longest = 1, cast(Any, SimpleNamespace(step=1))
    # nothing was timed from there yet: what is counted at that step
    found.census.add(refusal(Stage.TIMING, None, "wall", step=1))
    assert cause(found).refusal.bodies == ("cup", "wall")
    stopped(found, 1, refusal(Stage.SCREENING, 0.5, "gate", step=1), whole=False)
    assert cause(found).refusal.bodies == ("cup", "gate")


def test_of_bodies_at_one_instant_the_most_frequent_is_told_with_the_numbers_of_that_candidate() -> None:
    found = SearchResult()
    deep, flat = refusal(Stage.SCREENING, 0.03, "shaft"), refusal(Stage.SCREENING, 0.02, "nozzle")
    stopped(found, 0, deep, flat, whole=False)
    stopped(found, 0, refusal(Stage.SCREENING, 0.04, "shaft"), refusal(Stage.SCREENING, 0.01, "nozzle"), whole=False)
    stopped(found, 0, refusal(Stage.SCREENING, 0.05, "nozzle"), whole=False)
    told = cause_of(found)
    assert told.line is not None
    assert told.motion is not None
    assert (told.line.refusal.bodies, told.line.count) == (("cup", "nozzle"), 3)
    # sentence, table and picture: of the candidate that came furthest, and not the least that any candidate lacks
    assert told.line.refusal.facts == flat.facts
    assert told.motion.encounters[0].refusal == flat
    assert told.line in told.census.lines
    assert (told.line.least, told.line.most) == (0.01, 0.05)


def test_what_the_checker_refused_came_further_than_all_else() -> None:
    found = SearchResult()
    stopped(found, 1, refusal(Stage.CERTIFICATE, 1e-5, step=1), whole=True)
    facts = Refuted(code="LIMIT", what="too fast", where="1.2 s")
    found.census.add(Refusal(stage=Stage.CHECKER, reason=Reason.NOT_CERTIFIED, step=1, facts=facts))
    assert cause(found).refusal.facts == facts


def test_without_a_refusal_there_is_no_cause() -> None:
    assert cause_of(SearchResult()).line is None
