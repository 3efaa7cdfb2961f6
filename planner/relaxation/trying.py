"""What would have helped: small changes of a request, each tried; first those that the refusal asks for, then the
others in the order in which a shop would make them.

Changes of one kind are a family. Its strongest member is tried first: where it does not help, no weaker one does. Where
it helps, the weakest member that helps, too, is reported.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from itertools import groupby

import numpy as np

from assur.planner.collision.proof import Prover
from assur.planner.frames.motion import Pose
from assur.planner.laws.belt_window import travelled
from assur.planner.model.outcome import Plan, Relaxation
from assur.planner.model.progress import Watch
from assur.planner.model.refusal import Refusal
from assur.planner.model.scene import Scene, Window
from assur.planner.relaxation.by_cause import allowed
from assur.planner.relaxation.change import Change, frame_of, with_step
from assur.planner.relaxation.changes import MORE, changes
from assur.planner.relaxation.rounded import ROUNDING, WHOLE, down, up
from assur.planner.search.beam import Search

ATTEMPT_S = 1.0
"""Longest time for one change of a request that counts no candidates, s."""
SHARE, FIRST_SHARE = 1 / 3, 1 / 2
"""... and no more than this share of what is left: of the first, which is what the cause asks for, it is more."""
FEWEST_S = 0.02
"""A change is not tried with less time than this left, s."""
NARROWED = frozenset({"window", "latest end"})
"""Kinds of which the plan that was found says how much would do."""


def relax(
    scene: Scene,
    step: int,
    blocker: str | None,
    deadline: float,
    refusal: Refusal | None = None,
    *,
    search: type[Search],
    proved: bool = False,
    watch: Watch | None = None,
) -> tuple[Relaxation | None, tuple[str, ...], bool]:
    """The first kind of change that works, as small as it was found to work; what was tried; and whether the time was
    spent before all of it was. `deadline` in monotonic seconds.

    `refusal`: why there is no plan, and whether that is `proved`: only what it leaves open is tried. `search`: what
    plans with the timing of the scene.
    """
    tried: list[str] = []
    attempt = partial(_attempt, deadline=deadline, tried=tried, search=search, watch=watch)
    for what, members in groupby(changes(scene, step, blocker, refusal), key=lambda change: change[0]):
        if not allowed(refusal, what, proved=proved):
            continue
        family = list(members)
        left = deadline - time.perf_counter()
        if left < FEWEST_S:
            return None, tuple(tried), True
        strongest = attempt(family[-1])
        if strongest is None:
            continue
        relaxation, spent = _weakest(scene, step, family, strongest, deadline, attempt)
        return relaxation, tuple(tried), spent
    return None, tuple(tried), False


def _weakest(
    scene: Scene,
    step: int,
    family: list[Change],
    strongest: Plan,
    deadline: float,
    attempt: Callable[[Change], Plan | None],
) -> tuple[Relaxation, bool]:
    """The weakest member of a family whose strongest has the plan `strongest`; whether the time was spent before it was
    known to be the weakest."""
    change, made = family[-1], strongest
    for weaker in family[:-1]:
        if deadline - time.perf_counter() < FEWEST_S:
            return _told(scene, change, made), True
        found = attempt(weaker)
        if found is not None:
            change, made = weaker, found
            break
    if change[0] in NARROWED:
        # what was opened altogether is closed again behind the plan, and that is tried, too
        narrow = _narrowed(scene, step, change, made)
        if narrow is not None:
            if deadline - time.perf_counter() < FEWEST_S:
                return _told(scene, change, made), True
            found = attempt(narrow)
            if found is not None:
                change, made = narrow, found
    return _told(scene, change, made), False


def _told(scene: Scene, change: Change, made: Plan) -> Relaxation:
    return Relaxation(change[0], change[1], made.trajectory.end - scene.start.time)


def _attempt(
    change: Change, deadline: float, tried: list[str], search: type[Search], watch: Watch | None
) -> Plan | None:
    """The search that the changed request would cause, up to its first plan: what is found here, that request finds.

    A search that could only repeat what has failed, because no more time is left for it, is left out.
    """
    what, value, scene = change
    options, left = scene.options, deadline - time.perf_counter()
    if options.max_candidates is not None:
        # the count ends each attempt, so what is found does not depend on the machine; the clock only keeps half of
        # the time for the changes that follow
        longest = left / 2
    elif what == "budget":
        longest = left / 2
        if longest * MORE <= options.budget_s:
            return None
    else:
        # the first is what the cause asks for
        longest = min(ATTEMPT_S, (SHARE if tried else FIRST_SHARE) * left)
    if what != "budget" and options.max_candidates is None:
        longest = min(longest, options.budget_s)
    tried.append(f"{what}: {value}")
    changed = replace(scene, options=replace(options, budget_s=longest))
    told: Watch | None = None if watch is None else lambda progress: watch(replace(progress, stage="relaxation"))
    first = search(changed, Prover(changed), time.perf_counter(), watch=told)
    first.until_first = True
    return first.run().plan


def _narrowed(scene: Scene, step: int, change: Change, made: Plan) -> Change | None:
    """The window, or the latest end, just as wide as the plan uses it, in round numbers; None if it uses no more than
    the request allows."""
    if change[0] == "latest end":
        latest = scene.options.latest_end_s
        ends = up(made.trajectory.end, WHOLE)
        if latest is None or not ends > latest + ROUNDING:
            return None
        options = replace(scene.options, latest_end_s=ends)
        return "latest end", f"{ends:.3f} s, {1e3 * (ends - latest):.0f} ms later", replace(scene, options=options)
    window = scene.task[step].window
    arrival = next(each for each in made.arrivals if each.step == step)
    texts, span, along = [], window.time, window.along
    if span is not None:
        low, high = min(span[0], down(arrival.time, WHOLE)), max(span[1], up(arrival.until, WHOLE))
        texts += [f"from {low:.3f} s, {1e3 * (span[0] - low):.0f} ms earlier"] * (low < span[0] - ROUNDING)
        texts += [f"until {high:.3f} s, {1e3 * (high - span[1]):.0f} ms later"] * (high > span[1] + ROUNDING)
        span = (low, high)
    law = scene.frames[frame_of(scene, scene.task[step])].law
    if along is not None and arrival.along_m is not None and law.way is not None:
        ways = travelled(law, Pose(), np.array([arrival.time, arrival.until]))
        begin, end = arrival.along_m, arrival.along_m + float(ways[1] - ways[0])
        low, high = min(along[0], down(min(begin, end), WHOLE)), max(along[1], up(max(begin, end), WHOLE))
        texts += [f"from {1e3 * low:.0f} mm, {1e3 * (along[0] - low):.0f} mm sooner"] * (low < along[0] - ROUNDING)
        texts += [f"to {1e3 * high:.0f} mm, {1e3 * (high - along[1]):.0f} mm farther"] * (high > along[1] + ROUNDING)
        along = (low, high)
    if not texts:
        return None
    return "window", " and ".join(texts), with_step(scene, step, replace(scene.task[step], window=Window(span, along)))
