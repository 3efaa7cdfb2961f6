"""What would have helped: small changes of a request, each tried; first those that the refusal asks for, then the
others in the order in which a shop would make them.

Changes of one kind are a family. Its strongest member is tried first: where it does not help, no weaker one does. Where
it helps, the weakest member that helps, too, is reported.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from itertools import groupby

import numpy as np

from assur.planner.collision.proof import Prover
from assur.planner.frames.motion import Pose
from assur.planner.laws.belt_window import travelled
from assur.planner.model.deadline import Watch
from assur.planner.model.outcome import Arrival, Plan, Relaxation
from assur.planner.model.refusal import Refusal
from assur.planner.model.scene import Scene, Window
from assur.planner.relaxation.changes import (
    MORE,
    ROUNDING,
    WHOLE,
    Change,
    changes,
    down,
    frame_of,
    of_options,
    of_same_window,
    of_window,
    up,
)
from assur.planner.relaxation.kinds import allowed
from assur.planner.search.beam import Search

ATTEMPT_S = 1.0
"""Longest time for one change of a request that counts no candidates, s."""
SHARE, FIRST_SHARE = 1 / 3, 1 / 2
"""... and no more than this share of what is left: of the first, which is what the cause asks for, it is more."""
FEWEST_S = 0.02
"""A change is not tried with less time than this left, s."""
NARROWED = frozenset({"window", "latest end"})
"""Kinds whose sufficient amount is read from the plan that was found."""
WIDER = (1, 2, 4)
"""So many times what the plan uses is tried as a wider window."""


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
        strongest, spent = _first(family[-1:], deadline, attempt)
        if spent:
            return None, tuple(tried), True
        if strongest is None:
            continue
        weaker, spent = _first(family[:-1], deadline, attempt)
        works = weaker or strongest
        if what in NARROWED:
            # what was opened altogether is closed again behind the plan, and that is tried, too; else it is removed: an
            # end that is as good as none is not proposed
            narrower, spent = (None, True) if spent else _first(_narrowed(scene, *works), deadline, attempt)
            works = narrower or strongest
        (_, value, changed), made = works
        return Relaxation(what, value, made.trajectory.end - scene.start.time, changed), tuple(tried), spent
    return None, tuple(tried), False


def _first(
    changes: list[Change], deadline: float, attempt: Callable[[Change], Plan | None]
) -> tuple[tuple[Change, Plan] | None, bool]:
    """The first change that has a plan, and the plan; and whether the time was spent before one was found."""
    for change in changes:
        if deadline - time.perf_counter() < FEWEST_S:
            return None, True
        made = attempt(change)
        if made is not None:
            return (change, made), False
    return None, False


def _attempt(
    change: Change, deadline: float, tried: list[str], search: type[Search], watch: Watch | None
) -> Plan | None:
    """The search that the changed request would cause, up to its first plan: what is found here, that request finds.

    A search that could only repeat what has failed, because no more time is left for it, is left out.
    """
    what, value, scene = change
    options, left = scene.options, deadline - time.perf_counter()
    if options.max_candidates is not None or what == "budget":
        # a count ends each attempt, so what is found does not depend on the machine; the clock only keeps half of the
        # time for the changes that follow
        longest = left / 2
        if options.max_candidates is None and longest * MORE <= options.budget_s:
            return None
    else:
        # the first is what the cause asks for
        longest = min(ATTEMPT_S, (SHARE if tried else FIRST_SHARE) * left, options.budget_s)
    changed = replace(scene, options=replace(options, budget_s=longest))
    reporting: Watch | None = None if watch is None else lambda progress: watch(replace(progress, stage="relaxation"))
    first = search(changed, Prover(changed), time.perf_counter(), watch=reporting)
    first.until_first = True
    found = first.run()
    if found.plan is not None or not found.cut_by_clock:
        tried.append(f"{what}: {value}")  # of what the clock ended nobody knows whether it helps
    return found.plan


def _narrowed(scene: Scene, change: Change, made: Plan) -> list[Change]:
    """The windows that a change opens, or the latest end, just as wide as the plan uses them, in round numbers, and
    windows a few times as much wider: the search may need more than its plan. Nothing if the plan uses no more than the
    request allows."""
    if change[0] == "latest end":
        latest = scene.options.latest_end_s
        ends = up(made.trajectory.end, WHOLE)
        if latest is None or not ends > latest + ROUNDING:
            return []
        value = f"{ends:.3f} s, {1e3 * (ends - latest):.0f} ms later"
        return [of_options(scene, "latest end", value, latest_end_s=ends)]
    opened = [
        i for i, (own, new) in enumerate(zip(scene.task, change[2].task, strict=True)) if own.window != new.window
    ]
    groups = list(dict.fromkeys(tuple(of_same_window(scene, i)) for i in opened))
    found = list[Change]()
    for times in WIDER:
        changed, words = scene, list[str]()
        for steps in groups:
            window, texts = _window_used(scene, steps, made, times)
            if texts:
                _, value, changed = of_window(changed, steps, " and ".join(texts), window)
                words.append(f"{scene.task[steps[0]].name} {value}" if len(groups) > 1 else value)
        if words:
            found.append(("window", "; ".join(words), changed))
    return found


def _window_used(scene: Scene, steps: Sequence[int], made: Plan, times: int) -> tuple[Window, list[str]]:
    """The window of these steps so many times as much wider as a plan uses it, and by how much in words (none: it uses
    no more)."""
    window, texts = scene.task[steps[0]].window, list[str]()
    met = [each for each in made.arrivals if each.step in steps]
    instants, ways = [at for each in met for at in (each.time, each.until)], _ways(scene, met)
    span, along = window.time, window.along
    if span is not None:
        span, texts = _used(span, instants, times, "s", 1.0, "from until earlier later")
    if along is not None and ways:
        along, more = _used(along, ways, times, "mm", 1e3, "from to sooner farther")
        texts += more
    return Window(span, along), texts


def _ways(scene: Scene, met: list[Arrival]) -> list[float]:
    """Where along their conveyors, m, points are when they are met, and when they are left."""
    found = list[float]()
    for each in met:
        law = scene.frames[frame_of(scene, scene.task[each.step])].law
        if each.along_m is not None and law.way is not None:
            way = travelled(law, Pose(), np.array([each.time, each.until]))
            found += [each.along_m, each.along_m + float(way[1] - way[0])]
    return found


def _used(
    window: tuple[float, float], used: list[float], times: int, unit: str, factor: float, words: str
) -> tuple[tuple[float, float], list[str]]:
    """A window, s or m, that is so many times as much wider as it is used, and how much wider in words: `words` are
    those before both ends and behind both differences, `unit` and `factor` are of the ends."""
    low, high = min(window[0], down(min(used), WHOLE)), max(window[1], up(max(used), WHOLE))
    low -= down((times - 1) * (window[0] - low), WHOLE)
    high += down((times - 1) * (high - window[1]), WHOLE)
    first, last, sooner, later = words.split()
    digits, small = (3, "ms") if factor == 1.0 else (0, unit)
    rows = (first, low, window[0] - low, sooner), (last, high, high - window[1], later)
    return (low, high), [
        f"{word} {factor * end:.{digits}f} {unit}, {1e3 * by:.0f} {small} {behind}"
        for word, end, by, behind in rows
        if by > ROUNDING
    ]
