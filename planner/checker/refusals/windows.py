"""Whether a control point can be tracked at no time for as long as it must be, whenever the arm comes."""

from __future__ import annotations

import math

from assur.planner.checker.laws import travel
from assur.planner.checker.refusals.openings import Asked, Times, asked, farthest_inside, inside, open_spans
from assur.planner.checker.refusals.start import same
from assur.planner.model.proofs.witness import PROVED_S, Openings
from assur.planner.model.refusal import LawEnds, Refusal, finite
from assur.planner.model.scene import Scene
from assur.planner.model.window_missed import Miss, WindowMissed

TOLD = 1e-6
"""Times, s, and lengths, m, that are told may be off by this: an end of a window in time is found to 1e-9 of a
step, and on a belt of 1 mm/s a way of 1 nm takes 1 µs."""


def witness_of(scene: Scene, number: int) -> Openings:
    """All times at which the control point of a step may be met at all, as they are told."""
    return Openings(spans_s=tuple(open_spans(asked(scene, number), 0.0, 0.0)))


def missed(scene: Scene, refusal: Refusal, witness: Openings) -> str:
    """Why it is not shown that the point can never be tracked for long enough; nothing: it is."""
    of = asked(scene, refusal.step)
    longest = max((b - a for a, b in open_spans(of)), default=-math.inf)
    if not longest < of.needed_s - PROVED_S:
        return "the point can be tracked for long enough"
    told = open_spans(of, 0.0, 0.0)
    if not _alike(told, witness.spans_s):
        return "the point can be met at other times than the witness says"
    facts = refusal.facts
    if isinstance(facts, LawEnds):
        return _by_law(of, refusal, facts)
    return _by_window(of, refusal, facts, told) if isinstance(facts, WindowMissed) else "it is about no window"


def _alike(told: list[Times], said: tuple[Times, ...]) -> bool:
    """Whether intervals are the same; those that have no length, up to rounding, do not count."""
    one, other = ([span for span in spans if span[1] - span[0] > TOLD] for spans in (told, list(said)))
    if len(one) != len(other):
        return False
    return all(
        same(a, b, TOLD) for first, second in zip(one, other, strict=True) for a, b in zip(first, second, strict=True)
    )


def _by_law(of: Asked, refusal: Refusal, facts: LawEnds) -> str:
    """... because the law of its frame ends: as it ends there, and the point could be met if it went on."""
    if refusal.frame != of.frame:
        return "the point is in another frame"
    low, high = of.known
    if high < of.start:
        needed = of.start
    else:
        going_on = [a for a, b in open_spans(of, 0.0, 0.0, lawless=True) if b - a >= of.needed_s - PROVED_S]
        if not going_on:
            return "if the motion were known for longer, the point could not be met either"
        needed = min(going_on) + of.needed_s
    amount = None if refusal.amount is None else refusal.amount.value
    told = facts.known_s == (finite(low), finite(high)) and same(facts.needed_s, needed, TOLD)
    told = told and same(facts.tracked_s, of.needed_s) and not facts.on_arrival
    return (
        "" if told and same(amount, max(low - needed, needed - high), TOLD) else "the motion is needed at other times"
    )


def _by_window(of: Asked, refusal: Refusal, facts: WindowMissed, told: list[Times]) -> str:
    """... because its windows leave no time: for the reason that is given, by as much as is given."""
    amount = None if refusal.amount is None else refusal.amount.value
    if facts.searched_s is not None:
        return "only a part of the time was searched"
    if facts.miss is not Miss.TOO_SHORT and facts != WindowMissed(miss=facts.miss):
        return "it tells how long a window is open that is none"
    true = _amount(of, refusal, facts, told)
    if true is None or not same(amount, true, TOLD) or not true > 0.0:
        return f"it is not so that it is missed by as much ({facts.miss})"
    return ""


def _amount(of: Asked, refusal: Refusal, facts: WindowMissed, told: list[Times]) -> float | None:
    """By how much the window is missed, in the way that is told; None: it is not missed in this way."""
    opens = -math.inf if of.window.time is None else of.window.time[0]
    low, high = of.span()
    latest = math.inf if of.latest is None else of.latest
    match facts.miss:
        case Miss.TOO_SHORT:
            longest = max((b - a for a, b in told), default=-math.inf)
            longest_spans = [span for span in told if same(span[1] - span[0], longest, TOLD)]
            said = refusal.interval
            ends = [said is not None and all(map(_near, said, span)) for span in longest_spans]
            belt = refusal.interval and _gone(of, refusal.interval[1], refusal.interval[1] + of.needed_s - longest)
            right = same(facts.open_s, longest, TOLD) and same(facts.needed_s, of.needed_s) and any(ends)
            return of.needed_s - longest if right and same(facts.belt_m, belt or None, TOLD) else None
        case Miss.OVER_BEFORE_START:
            return of.start - of.closes
        case Miss.OPENS_AFTER_LATEST_END:
            return low - latest if low == max(opens, of.known[0]) else None
        case Miss.LATEST_END_BEFORE_START:
            return of.start - latest
        case Miss.NEVER_INSIDE:
            return farthest_inside(of)
        case Miss.ENTERS_AFTER_LATEST_END | Miss.NO_COMMON_INSTANT:
            spans = inside(of, 0.0)
            later = any(a <= of.closes and b >= low for a, b in spans)
            if not spans or later is not (facts.miss is Miss.ENTERS_AFTER_LATEST_END):
                return None
            return min(max(a - high, low - b) for a, b in spans)
    return None


def _near(one: float, other: float) -> bool:
    return same(one, other, TOLD)


def _gone(of: Asked, t0: float, t1: float) -> float | None:
    """How far the point goes along its conveyor from t0 to t1, m; None: on none, or not known."""
    law = of.law
    if law.kind not in ("conveyor", "linear") or not (of.known[0] <= t0 and t1 <= of.known[1]):
        return None

    def at(t: float) -> float:
        pieces = travel(law, min(t0, of.start), t1)
        begin, _, powers = next((piece for piece in pieces if piece[0] <= t <= piece[1]), pieces[-1])
        return sum(c * (t - begin) ** k for k, c in enumerate(powers))

    return abs(at(t1) - at(t0))
