"""Why a search finds no plan: what stopped the candidate that came furthest, and not what stopped most of them."""

from __future__ import annotations

from dataclasses import dataclass, replace

from assur.planner.collision.screening import Encounter
from assur.planner.model.outcome import Census, CensusLine
from assur.planner.model.refusal import OF_CANDIDATES, Stage
from assur.planner.search.beam import SearchResult
from assur.planner.search.census import kind_of
from assur.planner.search.partial_plan import RefusedMotion


@dataclass(frozen=True, eq=False)
class Cause:
    """The line of the census that is the cause (None: nothing was refused), the census with its facts, and the motion
    that was refused for it (None: none was timed)."""

    line: CensusLine | None
    census: Census
    motion: RefusedMotion | None


def cause_of(found: SearchResult) -> Cause:
    """The cause of a search without a plan. What the checker refused came further than all else: it was a whole one."""
    census, furthest = found.census.census(), found.furthest
    whole = next((line for line in census.lines if line.refusal.stage is Stage.CHECKER), None)
    if whole is not None:
        return Cause(whole, census, None)
    if furthest is None or (found.longest is not None and furthest.motion.before.step < found.longest.step):
        return Cause(most_frequent(census, found.deepest), census, None)
    place = {kind_of(line.refusal): k for k, line in enumerate(census.lines)}

    def of_all(encounter: Encounter) -> int:
        return place[kind_of(encounter.refusal)]

    # of several bodies that it meets at one instant, the one that most candidates meet
    reported = min(furthest.encounters, key=of_all)
    census = found.census.census(reported)
    return Cause(census.lines[of_all(reported)], census, replace(furthest, encounters=(reported,)))


def most_frequent(census: Census, step: int) -> CensusLine | None:
    """The most frequent refusal at a step or behind it: some searches take several steps at once."""
    here = [line for line in census.lines if line.refusal.step >= step]
    of_candidates = [line for line in here if line.refusal.stage in OF_CANDIDATES]
    # a mode that is not reached at all refuses once for all candidates: it counts as most frequent
    once = [line for line in here if line.refusal.stage is Stage.INVERSE]
    if once and not of_candidates:
        return once[0]
    return max(of_candidates or here, key=lambda line: line.count, default=None)
