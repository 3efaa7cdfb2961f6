"""Whether a control point can be tracked at no time for as long as it must be, whenever the arm comes.

The way of a point along its conveyor is a polynomial of the time, piece after piece, and the last piece, which never
ends, is a straight line. Between its turning points and the times at which it passes an end of the window it is on one
side of both.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.polynomial import Chebyshev

from assur.planner.arrays import FloatArray
from assur.planner.checker.refusals.stated import NotShownError, Proof, exceeded, law_ends, same
from assur.planner.checker.refusals.ways import ways
from assur.planner.checker.statement import laws
from assur.planner.checker.statement.differences import SAME, Four, numbers, then
from assur.planner.checker.statement.limits import SHARES, share_with_load
from assur.planner.laws import Law
from assur.planner.model.attachments import at_start
from assur.planner.model.refusal import LawEnds, Overshoot, Quantity, Reason, Refusal
from assur.planner.model.scene import Place, Scene
from assur.planner.model.window_missed import Miss, WindowMissed
from assur.planner.model.witness import PROVED_M, PROVED_S, PROVED_SHARE, OpenIntervals

Times = tuple[float, float]
STATED = 1e-6
"""Times, s, and lengths, m, that are stated may be off by this: an end of a window in time is found to 1e-9 of a
step, and on a belt of 1 mm/s a way of 1 nm takes 1 µs."""
LONG_S = 2e6
"""No law is known for so long, s (`FURTHEST_S` on both sides of time zero): what goes on for ever ends here."""
CUTS_S = (1e1, 1e2, 1e3, 1e4, 1e5, 1e6)
"""The way is cut so long, s, after the start: a polynomial that is read off its values is as exact as these are."""
REAL = 1e-6
"""A root whose imaginary part, s, is not above this counts as a real one: a window that is only just touched."""
ROUNDING = 1e-14
"""A coefficient that is not above this share of the largest one is rounding."""


@dataclass(frozen=True, slots=True)
class Tracking:
    """When the control point of a step may be tracked, and for how long. Times are s.

    `law`: of its `frame`; `point`: x, y, z, yaw in it. `along`: its window along a conveyor, m (None: it has none, or
    is on no conveyor); `in_time`: that in time; `known`: when the motion of its frame is known; `start`, `latest`: the
    first and the last time at all."""

    frame: str
    law: Law
    point: Four
    along: tuple[float, float] | None
    in_time: Times
    known: Times
    needed: float
    start: float
    latest: float

    def span(self) -> Times:
        """From when until when tracking may last, the way along a conveyor left aside; empty if reversed."""
        return max(self.start, self.known[0], self.in_time[0]), min(self.known[1], self.latest, self.in_time[1])

    def way(self, formula: laws.Formula) -> Callable[[FloatArray], FloatArray]:
        """How far along its conveyor the point is, m, at times (m,) for which the formula of its law holds."""
        direction, zero = laws.measured_along(self.law) or ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0))
        point = np.array(then((0.0, 0.0, 0.0, zero[3]), self.point)[:3]) - zero[:3]
        return lambda times: np.asarray((formula.place(times)[:, :3] + point) @ direction)

    def pieces(self) -> Iterator[tuple[Chebyshev, list[float]]]:
        """The way piece by piece, m by s, from the start on for as long as the law is known, with the times at which it
        begins, turns round, passes an end of its window, and ends."""
        begin, end = self.start, min(self.known[1], self.start + LONG_S)
        if self.along is None or not begin < end:
            return
        formula = laws.formula_of(self.law, begin, end)
        cuts = {begin, end, *(t for t in (*formula.ends, *(begin + s for s in CUTS_S)) if begin < t < end)}
        for a, b in pairwise(sorted(cuts)):
            way = Chebyshev.interpolate(self.way(formula), formula.degree, domain=[a, b])
            way = way.trim(ROUNDING * float(np.abs(way.coef).max()))
            roots = [root for each in (way.deriv(), *(way - limit for limit in self.along)) for root in each.roots()]
            inner = (float(root.real) for root in roots if abs(root.imag) <= REAL)
            yield way, sorted({a, b, *(t for t in inner if a < t < b)})

    def inside(self) -> list[Times]:
        """When the point is in its window along a conveyor, from the start on: intervals in order. All of the time
        where there is no such window."""
        if self.along is None:
            return [(self.start, min(self.known[1], self.start + LONG_S))]
        (low, high), found = self.along, list[Times]()
        for way, times in self.pieces():
            spans = [*((t, t) for t in times), *pairwise(times)]
            for a, b in sorted(each for each in spans if low <= way(sum(each) / 2.0) <= high):
                if found and a <= found[-1][1] + PROVED_S:
                    found[-1] = found[-1][0], max(found[-1][1], b)
                else:
                    found.append((a, b))
        return found

    def open_spans(self, wider: float = 0.0) -> list[Times]:
        """When the point may be tracked, `wider`, s, at both ends: intervals in order."""
        low, high = self.span()
        both = [(max(low - wider, a), min(high + wider, b)) for a, b in self.inside()]
        return [(a, b) for a, b in both if a <= b]

    def farthest(self) -> float:
        """How far, m, the point stays outside its window along a conveyor from the start on for ever; not above 0: it
        comes into it."""
        low, high = self.along or (-math.inf, math.inf)
        ways = (float(way(t)) for way, times in self.pieces() for t in times)
        return min((max(low - x, x - high) for x in ways), default=-math.inf)


def tracking(scene: Scene, number: int) -> Tracking:
    """What is required of the control point of a step. Which part is where follows from the steps before."""
    step, latest = scene.task[number], scene.options.latest_end_s
    frame, point = ways(scene, number)[0].before.point(scene, step)
    law = scene.frames[frame].law
    return Tracking(
        frame=frame,
        law=law,
        point=numbers(point),
        along=step.window.along if laws.measured_along(law) is not None else None,
        in_time=step.window.time or (-math.inf, math.inf),
        known=laws.known(law),
        needed=step.dwell_s,
        start=scene.start.time,
        latest=math.inf if latest is None else latest,
    )


def witness_of(scene: Scene, number: int) -> OpenIntervals:
    """All times at which the control point of a step may be met at all, as they are stated."""
    return OpenIntervals(spans_s=tuple(tracking(scene, number).open_spans()))


def missed(scene: Scene, refusal: Refusal, witness: OpenIntervals) -> Iterator[Proof]:
    """Refusals of a point that can never be tracked for long enough. Raises `NotShownError` where it may be."""
    of = tracking(scene, refusal.step)
    along = None if of.along is None else (of.along[0] - PROVED_M, of.along[1] + PROVED_M)
    wide = replace(of, along=along).open_spans(PROVED_S)
    if not max((b - a for a, b in wide), default=-math.inf) < of.needed - PROVED_S:
        raise NotShownError("the point can be tracked for long enough")
    spans = of.open_spans()
    if not _are_alike(spans, list(witness.spans_s)):
        raise NotShownError("the point can be met at other times than the witness says")
    if isinstance(refusal.facts, LawEnds):
        yield _by_law(of)
        return
    longest = max((b - a for a, b in spans), default=-math.inf)
    for miss, amount in _misses(of):
        yield from _miss(WindowMissed(miss=miss), amount)
    for a, b in (each for each in spans if same(each[1] - each[0], longest, STATED)):
        gone = _gone(of, b, b + of.needed - longest)
        short = WindowMissed(miss=Miss.TOO_SHORT, open_s=longest, needed_s=of.needed, belt_m=gone)
        yield from _miss(short, of.needed - longest, (a, b))


def _miss(facts: WindowMissed, by: float, when: Times | None = None) -> Iterator[Proof]:
    """A window that is missed by more than nothing, s or m."""
    if by > 0.0:
        amount = Quantity(by, "m" if facts.miss is Miss.NEVER_INSIDE else "s")
        yield Proof(Reason.WINDOW_MISSED, facts, amount, within=STATED, interval=when)


def _are_alike(spans: list[Times], stated: list[Times]) -> bool:
    """Whether intervals are the same; one that has no length, up to rounding, does not count."""

    def has(found: list[Times], a: float, b: float) -> bool:
        return b - a <= STATED or any(same(a, c, STATED) and same(b, d, STATED) for c, d in found)

    return all(has(stated, *each) for each in spans) and all(has(spans, *each) for each in stated)


def _by_law(of: Tracking) -> Proof:
    """Because the law of its frame ends: the point could be met if the motion went on."""
    needed = of.start
    if not of.known[1] < of.start:
        going_on = replace(of, known=(of.known[0], math.inf)).open_spans()
        long_enough = [a for a, b in going_on if b - a >= of.needed - PROVED_S]
        if not long_enough:
            raise NotShownError("if the motion were known for longer, the point could not be met either")
        needed = min(long_enough) + of.needed
    return law_ends(of.frame, of.known, needed, of.needed, by=STATED)


def _misses(of: Tracking) -> Iterator[tuple[Miss, float]]:
    """Ways in which the windows leave no time, and by how much, s or m; not above 0: they leave some."""
    (low, high), (opens, closes) = of.span(), of.in_time
    yield Miss.OVER_BEFORE_START, of.start - closes
    if low == max(opens, of.known[0]):
        yield Miss.OPENS_AFTER_LATEST_END, low - of.latest
    yield Miss.LATEST_END_BEFORE_START, of.start - of.latest
    yield Miss.NEVER_INSIDE, of.farthest()
    spans = of.inside()
    if spans:
        later = any(a <= closes and b >= low for a, b in spans)
        miss = Miss.ENTERS_AFTER_LATEST_END if later else Miss.NO_COMMON_INSTANT
        yield miss, min(max(a - high, low - b) for a, b in spans)


def _gone(of: Tracking, t0: float, t1: float) -> float | None:
    """How far the point goes along its conveyor from t0 to t1, m; None: it does not, is on none, or it is not known."""
    if laws.measured_along(of.law) is None or not (of.known[0] <= t0 and t1 <= of.known[1]):
        return None
    first, last = of.way(laws.formula_of(of.law, t0, t1))(np.array([t0, t1])).tolist()
    return abs(last - first) or None


# A joint that exceeds a limit after the start in every motion that ends at rest (W2 of docs/guarantees.md).
#
# The acceleration of a joint with jerk limit J and acceleration limit A is never less than that of the hardest braking,
# max(a - J t, -A), so velocity and position are never less than those of the hardest braking, either.


def overshoots(scene: Scene, _: int = 0) -> Iterator[Proof]:
    """Each limit of a joint that is exceeded after the start by all motions that end at rest. It is also
    exceeded from each state that a plan may have in place of the start (its first knot may differ, and a motion is at
    rest up to `SAME`), with limits that are exceeded as far as a plan may."""
    if not scene.options.jerk_limited or scene.options.end != "rest" or not scene.start.moving:
        return  # without a limit the jerk is as high as is needed, and a motion that ends in motion may end before
    given, start = scene.robot.limits, scene.start
    for k in range(len(scene.robot.joints)):
        low, high, fastest = (float(each[k]) for each in (given.lower, given.upper, given.velocity))
        for sign in (1.0, -1.0):
            q, v, a = (sign * float(each[k]) for each in (start.q, start.qd, start.qdd))
            worse = q - SAME, v - 2.0 * SAME, a - 2.0 * SAME
            end = high if sign > 0.0 else -low
            for share, until in _shares(scene):
                hard = share * float(given.acceleration[k]), share * float(given.jerk[k])
                harder = hard[0] * (1.0 + SHARES[2]), hard[1] * (1.0 + SHARES[3])
                after, value = highest_velocity(v, a, hard[1])
                least = highest_velocity(*worse[1:], harder[1])[1]
                if after <= until and least - fastest > PROVED_SHARE * fastest:
                    facts = Overshoot(rate="velocity", value=value, limit=fastest, after_s=after)
                    yield exceeded(scene, Reason.MOTION_LIMIT, k, value - fastest, facts, 1)
                after, value = farthest_position(q, v, a, *hard)
                least = farthest_position(*worse, *harder)[1]
                if after <= until and least - end > PROVED_SHARE * (high - low):
                    reached, limit = scene.counted(k, sign * value), scene.counted(k, sign * end)
                    facts = Overshoot(rate=None, value=reached, limit=limit, after_s=after)
                    yield exceeded(scene, Reason.JOINT_LIMIT, k, value - end, facts)


def _shares(scene: Scene) -> list[tuple[float, float]]:
    """The shares of acceleration and jerk that loads leave after the start, and how long each is in force at least, s:
    a part is held until it was tracked to the end of the dwell, and then nothing is lighter than the tool."""
    tool, held = scene.tool.mass_kg or 0.0, at_start(scene).held
    alone = share_with_load(scene, tool), math.inf
    if held is None:
        return [alone]
    loaded = share_with_load(scene, tool + (scene.index[held.part].mass_kg or 0.0))
    place = next((step for step in scene.task if isinstance(step, Place)), None)
    return [(loaded, math.inf)] if place is None else [(loaded, place.dwell_s - SAME), alone]


def highest_velocity(v: float, a: float, jerk: float) -> tuple[float, float]:
    """When, s, and how high the velocity is at the least peak after a start with velocity v and acceleration a."""
    return (a / jerk, v + a * a / (2.0 * jerk)) if a > 0.0 else (0.0, v)


def farthest_position(q: float, v: float, a: float, acceleration: float, jerk: float) -> tuple[float, float]:
    """When, s, and where the hardest braking from position q, velocity v and acceleration a turns round, in the
    direction of increasing q; at minus infinity if it never moves that way."""
    ramp = (a + acceleration) / jerk
    left = v + (a * a - acceleration * acceleration) / (2.0 * jerk)
    if left > 0.0:
        after = ramp + left / acceleration
        return after, q + ramp * (v + ramp * (a / 2.0 - ramp * jerk / 6.0)) + left * left / (2.0 * acceleration)
    square = a * a + 2.0 * jerk * v
    after = (a + math.sqrt(square)) / jerk if square >= 0.0 else 0.0
    if not after > 0.0:
        return 0.0, -math.inf
    return after, q + after * (v + after * (a / 2.0 - after * jerk / 6.0))
