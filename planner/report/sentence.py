"""Sentences for people about refusals, made of facts. No decision reads them."""

from __future__ import annotations

from assur.planner.model.outcome import Census, CensusLine
from assur.planner.model.refusal import OF_CANDIDATES, Reason, Refusal, Stage
from assur.planner.model.scene import Scene
from assur.planner.report.refusal_words import because


def sentence(scene: Scene, refusal: Refusal | None, line: CensusLine | None, census: Census, *, cut: bool) -> str:
    """Why there is no plan. `line`: where the refusal is counted, if it is; `cut`: the clock ended the search."""
    budget = f"{scene.options.budget_s:g} s"
    if refusal is None:
        if census.candidates:
            return (
                f"No plan was found among {census.candidates} candidate{'s' * (census.candidates > 1)}; "
                "the search ended before it reached the last step."
            )
        return f"No plan was found in {budget}; nothing was tried."
    tail = ""
    if line is not None and refusal.stage in OF_CANDIDATES and census.candidates:
        most = _most_frequent(line, census)
        others = _others(line, census, most)
        candidates = " candidates" if line.count <= census.refused else ""
        tail = f"{others} ({_counted(line, census)}{candidates}{_span(refusal)})"
        if most is not None:
            tail += f"; most frequent: {_named(scene, most.refusal)} ({_counted(most, census)})"
        if cut:
            tail += f"; the budget of {budget} was spent"
    step = "" if refusal.stage is Stage.START else f"{scene.task[refusal.step].name}: "
    return f"{step}{because(scene, refusal)}{tail}."


def _counted(line: CensusLine, census: Census) -> str:
    """How often it was refused; more often than candidates were: before there was a candidate, too."""
    often = line.count <= census.refused
    return f"{line.count} of {census.candidates}" if often else f"{line.count} times, also before there was a candidate"


def _most_frequent(line: CensusLine, census: Census) -> CensusLine | None:
    """What stopped most candidates at the step, where that is not what stopped the one that came furthest."""
    here = (each for each in census.lines if each.refusal.step == line.refusal.step)
    of_candidates = (each for each in here if each.refusal.stage in OF_CANDIDATES)
    most = max(of_candidates, key=lambda each: each.count, default=line)
    cause, other = line.refusal, most.refusal
    same = (cause.reason, cause.subject) == (other.reason, other.subject)
    return most if most.count > line.count and not same else None


def _named(scene: Scene, refusal: Refusal) -> str:
    """A refusal by its reason and what it is about; where that has no name, in words."""
    about = " and ".join(refusal.bodies) or refusal.joint or refusal.frame
    return f"{refusal.reason} of {about}" if about else because(scene, refusal)


def _others(line: CensusLine, census: Census, most: CensusLine | None) -> str:
    """Bodies that are hit about as often, at the same step, without those that are hit most often."""
    leading = line.refusal
    if leading.reason is not Reason.BODY_COLLISION:
        return ""
    seen, also = set(leading.bodies[1:]), []
    for other in census.lines:
        bodies, same = other.refusal.bodies, other.refusal.step == leading.step
        alike = same and other.refusal.reason is leading.reason and 2 * other.count >= line.count
        if alike and other is not most and not seen.issuperset(bodies[1:]):
            seen |= set(bodies[1:])
            also.append(f"{bodies[0]} with {' and '.join(bodies[1:])}")
    return f"; likewise {', '.join(also[:2])}" if also else ""


def _span(refusal: Refusal) -> str:
    if refusal.interval is None:
        return ""
    a, b = refusal.interval
    return f", at {a:.2f} s" if b - a < 0.005 else f", between {a:.2f} s and {b:.2f} s"
