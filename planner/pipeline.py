"""The story of a request, in one page.

scene ─► what is impossible? ─► search (candidates ─► dyad ─► Ruckig ─► screening ─► FCL ─► proof) ─► check ─► outcome
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from functools import partial

from assur.planner.blends import BlendSearch
from assur.planner.bound.duration import least_duration
from assur.planner.collision.proof import Prover
from assur.planner.compiled import load_defined
from assur.planner.feasibility.hits import AtStart, never_touching
from assur.planner.feasibility.input_warnings import unusual_arrivals, unusual_bodies, unusual_places, unusual_supports
from assur.planner.feasibility.necessary import (
    arches_impossible,
    start_collides,
    start_impossible,
    windows_impossible,
    yaw_impossible,
)
from assur.planner.feasibility.witnesses import RefusalProof, refusal_proof
from assur.planner.kernel_cache import is_compiled
from assur.planner.legs.meeting import every_turn
from assur.planner.legs.missed import holds_for_all_times
from assur.planner.legs.tilt import pitch_free
from assur.planner.model.deadline import Deadline, OutOfTimeError, Stopwatch, Watch, out_of_time
from assur.planner.model.input_warning import InputWarning
from assur.planner.model.outcome import Arrival, Census, CensusLine, NotPlanned, Outcome, Plan, Planned, Relaxation
from assur.planner.model.phases import yaw_offsets
from assur.planner.model.refusal import ForbiddenYaw, Reason, Refusal, Stage
from assur.planner.model.scene import Scene
from assur.planner.relaxation.kinds import worth_trying
from assur.planner.relaxation.trying import relax
from assur.planner.report.checker_first import checker_first
from assur.planner.report.margins import reported
from assur.planner.report.sentence import sentence
from assur.planner.report.straight_parts import assumed
from assur.planner.search.beam import Search, SearchResult
from assur.planner.search.cause import cause_of
from assur.planner.search.census import Counter
from assur.planner.search.partial_plan import best_candidate

MARGINS_S = 0.15
"""So long after the budget, s, warnings and the smallest clearance of a plan may still be looked for."""


@dataclass(frozen=True, slots=True)
class _Run:
    """When a run began, by `time.perf_counter`, who watches it, what measures its stages, and whether it checks its
    plans."""

    started: float
    watch: Watch | None
    laps: Stopwatch
    checked: bool

    @property
    def elapsed(self) -> float:
        return time.perf_counter() - self.started

    def tail(self, scene: Scene) -> Deadline:
        """The deadline for warnings and margins, which are computed after the outcome."""
        return Deadline(self.started, max(scene.options.budget_s, self.elapsed) + MARGINS_S)


def plan(
    scene: Scene,
    *,
    started: float | None = None,
    watch: Watch | None = None,
    laps: Stopwatch | None = None,
    checked: bool = True,
) -> Outcome:
    """A trajectory through the scene's control points, proved free of collision, or why there is none.

    It is jerk-limited, unless the scene's timing is `parabolic_blend`.

    `started`: the reading of `time.perf_counter` from which the budget counts (None: now); a caller that has built the
    scene for this request says when it began.
    `watch` receives how far the search has come, at each of its rounds; what it raises ends the planning.
    `laps` measures the stages `search`, with proof and check, `explain` (what would have helped) and `margins`.
    Every plan was accepted by the checker, if it is `checked`; else the caller has to check it. What the prover accepts
    and the checker refuses is a fault of the planner: it is no answer, the census counts it at the stage `checker`, and
    the sentence of a refusal begins with it.
    """
    if started is None and not is_compiled():
        load_defined()  # to compile takes minutes, which are none of the budget
    run = _Run(time.perf_counter() if started is None else started, watch, laps or Stopwatch(), checked)
    prover = Prover(scene)
    outcome = _outcome(scene, run, prover)
    if isinstance(outcome, NotPlanned) and scene.options.report == "full":
        with run.tail(scene):
            warnings, late = _warnings(scene, prover, ())
        cut = outcome.cut_by_clock or late
        outcome = replace(outcome, warnings=warnings, elapsed_s=run.elapsed, cut_by_clock=cut)
    run.laps.lap("margins")
    return outcome


def _warnings(scene: Scene, prover: Prover, arrivals: tuple[Arrival, ...]) -> tuple[tuple[InputWarning, ...], bool]:
    """What is probably not meant by a request, and by the arrivals of its plan; and whether the deadline in force
    passed before all was looked for. Then the kinds that were not finished are left out."""
    found, at = list[InputWarning](), AtStart(scene, prover)
    kinds = (
        partial(unusual_bodies, at=at),
        partial(unusual_places, at=at),
        partial(unusual_supports, prover=prover, arrivals=arrivals),
        partial(unusual_arrivals, arrivals=arrivals),
    )
    for kind in kinds:
        try:
            found += kind(scene)
        except OutOfTimeError:
            return tuple(found), True
    return tuple(found), False


def _outcome(scene: Scene, run: _Run, prover: Prover) -> Outcome:
    """A plan, or why there is none; that without warnings."""
    try:
        with Deadline(run.started, scene.options.budget_s):
            never = (
                start_impossible(scene, prover)
                or arches_impossible(scene)
                or windows_impossible(scene)
                or yaw_impossible(scene)
                or never_touching(scene, prover)
            )
    except OutOfTimeError:
        return _not_planned(scene, run, None, Counter().census(), proof=None, cut=True)
    found = SearchResult()
    if never is None:
        found = _search_of(scene)(scene, prover, run.started, watch=run.watch, checked=run.checked).run()
        run.laps.lap("search")
        if found.plan is not None:
            return _planned(scene, run, prover, found, found.plan)
        with run.tail(scene):
            # the search may have ended before this test
            never = found.never or start_collides(scene, prover)
        if never is None:
            return _not_found(scene, run, prover, found)
    census, proof = found.census.census(), refusal_proof(scene, prover, never)
    return _not_planned(scene, run, never, census, proof=proof, cut=False)


def _search_of(scene: Scene) -> type[Search]:
    """What plans with the timing of the scene."""
    return Search if scene.options.jerk_limited else BlendSearch


def _planned(scene: Scene, run: _Run, prover: Prover, found: SearchResult, made: Plan) -> Planned:
    full = scene.options.report == "full"
    with run.tail(scene):
        # warnings first: the smallest clearance may use all remaining time
        warnings = _warnings(scene, prover, made.arrivals)[0] if full else ()
        least = reported(scene, prover, made)
        late = out_of_time()
    return Planned(
        plan=made,
        reported=least,
        lower_bound_s=least_duration(scene) if full else None,
        census=found.census.census(),
        assumptions=assumed(scene),
        seed=scene.options.seed,
        elapsed_s=run.elapsed,
        first_s=found.first_s,
        cut_by_clock=found.cut_by_clock or late,
        warnings=warnings,
    )


def _not_found(scene: Scene, run: _Run, prover: Prover, found: SearchResult) -> NotPlanned:
    cause = cause_of(found)
    line, census = cause.line, cause.census
    refusal = None if line is None else line.refusal
    nothing_tried = census.candidates == 0 and not found.cut_by_clock
    proof = None
    if nothing_tried and refusal is not None and for_all_times(scene, refusal):
        proof = refusal_proof(scene, prover, refusal)
    without = _not_planned(
        scene, run, refusal, census, proof=proof, cut=found.cut_by_clock, deepest=found.deepest, line=line
    )
    return replace(without, best=best_candidate(scene, cause.motion, found.longest))


def for_all_times(scene: Scene, refusal: Refusal) -> bool:
    """Whether a refusal before any candidate holds for all times: it does not depend on how the arm came here."""
    if refusal.stage is Stage.WINDOW:
        return holds_for_all_times(refusal)
    if yaw_offsets(scene, scene.task[refusal.step]) is None or pitch_free(scene, scene.task[refusal.step]):
        return False  # some yaws, or pitches, were tried, not all
    if refusal.reason is Reason.NEAR_SINGULARITY and not (refusal.amount is not None and refusal.amount.value > 0):
        return False  # no margin was required: a stretched arm may stand there
    if isinstance(refusal.facts, ForbiddenYaw) and refusal.facts.on_the_way and not every_turn(scene.robot):
        return False
    return (
        refusal.stage is Stage.INVERSE and refusal.interval is not None and refusal.interval[0] == refusal.interval[1]
    )


def _not_planned(
    scene: Scene,
    run: _Run,
    refusal: Refusal | None,
    census: Census,
    *,
    proof: RefusalProof | None,
    cut: bool,
    deepest: int = 0,
    line: CensusLine | None = None,
) -> NotPlanned:
    """The outcome of a refusal; `proof`: what shows that it holds for all times and modes (None: it may not);
    `deepest`: the step that was never passed, where there is no refusal."""
    options, step = scene.options, min(deepest, len(scene.task) - 1) if refusal is None else refusal.step
    relaxation: Relaxation | None = None
    tried: tuple[str, ...] = ()
    spent = False
    if options.explain_budget_s > 0 and worth_trying(refusal):
        deadline = time.perf_counter() + options.explain_budget_s
        relaxation, tried, spent = relax(
            scene,
            step,
            _blocker(scene, census, refusal, step),
            deadline,
            refusal,
            proved=proof is not None,
            search=_search_of(scene),
            watch=run.watch,
        )
        run.laps.lap("explain")
    ended = Reason.TIMED_OUT if cut or not census.candidates else Reason.COUNT_SPENT
    return NotPlanned(
        reason=ended if refusal is None else refusal.reason,
        proved=proof is not None,
        sentence=("" if proof else checker_first(census)) + sentence(scene, refusal, line, census, cut=cut),
        refusal=refusal,
        census=census,
        relaxation=relaxation,
        tried=tried,
        explain_budget_spent=spent,
        assumptions=assumed(scene),
        seed=options.seed,
        elapsed_s=run.elapsed,
        cut_by_clock=cut,
        witness=None if proof is None else proof.witness,
    )


def _blocker(scene: Scene, census: Census, refusal: Refusal | None, step: int) -> str | None:
    """The body of the surroundings, no part, that a refusal names, or that refused most candidates of a step."""
    parts = {each.part for each in scene.task}
    named = () if refusal is None else refusal.bodies
    counts: dict[str, int] = {}
    for line in census.lines:
        for name in line.refusal.bodies:
            if line.refusal.step == step and name in scene.index and name not in parts:
                counts[name] = counts.get(name, 0) + line.count
    of_refusal = (name for name in named if name in scene.index and name not in parts)
    return next(of_refusal, None) or max(counts, key=lambda name: counts[name], default=None)
