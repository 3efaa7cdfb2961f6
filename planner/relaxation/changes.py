"""The changes of a request that are tried, in families of one kind, each from its weakest change to its strongest.

Never a robot beyond its limits, never a clearance below the uncertainties (those are added to it).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from assur.planner.errors import InputError
from assur.planner.laws import slowed
from assur.planner.model.options import LONGEST_BUDGET_S, MOST_CANDIDATES
from assur.planner.model.refusal import Refusal, Separation, Stage
from assur.planner.model.scene import Follow, Move, Pick, Place, Scene, Step, Trace, Window
from assur.planner.model.task import is_taken_away
from assur.planner.relaxation.kinds import kinds_about

# A change of a request, and what all changes of a step share.

Change = tuple[str, str, Scene]
"""Kind, value for people, and the request with the change."""


def frame_of(scene: Scene, what: Step) -> str:
    """The frame in which a step's control point is."""
    if isinstance(what, Pick):
        return scene.index[what.part].frame
    return what.to.frame if isinstance(what, Place) else what.target.frame


def with_step(scene: Scene, number: int, step: Step) -> Scene:
    return replace(scene, task=(*scene.task[:number], step, *scene.task[number + 1 :]))


def of_step(scene: Scene, number: int, kind: str, value: str, **changed: Any) -> Change:
    """A change of these fields of a step."""
    return kind, value, with_step(scene, number, replace(scene.task[number], **changed))


def of_window(scene: Scene, steps: Sequence[int], value: str, window: Window) -> Change:
    """A change of the window of these steps, the picks with one window (`of_same_window`) or one step."""
    task = [replace(each, window=window) if i in steps else each for i, each in enumerate(scene.task)]
    every = f", all {len(steps)} picks of this window" if len(steps) > 1 else ""
    return "window", f"{value}{every}", replace(scene, task=tuple(task))


def of_same_window(scene: Scene, step: int) -> list[int]:
    """The picks with the window of this one, in their order: a transfer states one window for all its parts, so that
    one alone cannot be changed there. Of any other step the step alone."""
    what = scene.task[step]
    if not isinstance(what, Pick):
        return [step]
    return [i for i, each in enumerate(scene.task) if isinstance(each, Pick) and each.window == what.window]


def of_options(scene: Scene, kind: str, value: str, **changed: Any) -> Change:
    """A change of these options."""
    return kind, value, replace(scene, options=replace(scene.options, **changed))


# Numbers of changes, rounded to whole units.

SHOWN_M = 1e-4
"""Lengths are proposed in whole tenths of a millimetre."""
WHOLE = 1e-3
"""Windows are proposed in whole milliseconds, and in whole millimetres of belt."""
ROUNDING = 1e-9
"""Ends of windows that differ by no more, s or m, are the same."""


def up(value: float, unit: float) -> float:
    """The next whole number of units; a millionth of one is rounding."""
    return math.ceil(value / unit - 1e-6) * unit


def down(value: float, unit: float) -> float:
    return math.floor(value / unit + 1e-6) * unit


# Smaller required distances: of the pair that a refusal is about, then of all.


def smaller_clearances(scene: Scene, refusal: Refusal | None) -> Iterator[Change]:
    """Smaller distances of the pair that the refusal is about, by what is missing, by half and none; then of all pairs
    for which no exception is made."""
    if refusal is not None and isinstance(refusal.facts, Separation) and len(refusal.bodies) == 2:
        gap, required = refusal.facts.gap_m, refusal.facts.required_m
        short = None if gap is None or required is None else required - gap
        first, second = refusal.bodies
        for text, changed in _changed(scene, short, first, second):
            yield "pair clearance", f"{first} and {second}: {text}", changed
    for text, changed in _changed(scene, None):
        yield "clearance", text, changed


def _changed(scene: Scene, short: float | None, *names: str) -> Iterator[tuple[str, Scene]]:
    """The scene with smaller distances of two bodies, or of all, in words and as a scene. `short`: by how much they are
    missed, m."""
    options = scene.options
    for travel, near in _smaller(*options.clearance.distances(*names), short):
        clearance = options.clearance.lowered(travel, near, names)
        yield _distances(travel, near), replace(scene, options=replace(options, clearance=clearance))


def _smaller(travel: float, near: float, short: float | None) -> Iterator[tuple[float, float]]:
    """Smaller distances of travel and near, from the greatest to none; one of both alone before both. `short`: by how
    much they are missed."""
    sizes = [(0.5 * travel, 0.5 * near), (0.0, 0.0)]
    if short is not None and short > 0.0:
        sizes.insert(0, (_less(travel, short), _less(near, short)))
    seen = {(travel, near)}
    for less_travel, less_near in sizes:
        for pair in ((travel, less_near), (less_travel, near), (less_travel, less_near)):
            if pair not in seen:
                seen.add(pair)
                yield pair


def _less(distance: float, short: float) -> float:
    """What is left, a hundredth of a millimetre less at least: the proof keeps a reserve."""
    return max(0.0, down(distance - short - 0.1 * SHOWN_M, SHOWN_M))


def _distances(travel: float, near: float) -> str:
    return f"travel {1e3 * travel:g} mm, near {1e3 * near:g} mm"


# Changes at a point: the straight parts of the ways to and from it, its height, and how deep contacts may become.

TIMES = (1, 2, 5)
"""So many times what is missing is tried as a contact tolerance: another pick or place may need more."""
SOFTEST_M = 2e-3
"""No gripper and no part gives way by more, m."""


def heights(scene: Scene, step: int, what: Step) -> Iterator[Change]:
    """Shorter straight parts of the ways to and from the point: of one of both alone, then of both. Those of a kind or
    of a grid of slots, which state them for all, are changed at once."""
    if not isinstance(what, Pick | Place):
        return
    lengths = {"approach": what.approach_m, "depart": what.depart_m}
    for share in (0.5, 0.2):
        shorter = {name: share * length for name, length in lengths.items() if length > 0.0}
        alone = [{name: length} for name, length in shorter.items()] if len(shorter) == 2 else []
        yield from (_straight(scene, step, "heights", each) for each in (*alone, shorter) if each)


def _straight(scene: Scene, step: int, kind: str, lengths: dict[str, float]) -> Change:
    """A change of the lengths of straight parts, m, of a pick or place and of all others that are alike."""
    value = ", ".join(f"{name} {1e3 * length:g} mm" for name, length in lengths.items())
    alike, changed = _alike(scene, step), dict[str, Any]({f"{name}_m": length for name, length in lengths.items()})
    every = f", all {len(alike)} alike" if len(alike) > 1 else ""
    task = [replace(each, **changed) if i in alike else each for i, each in enumerate(scene.task)]
    return kind, f"{value}{every}", replace(scene, task=tuple(task))


def _alike(scene: Scene, step: int) -> list[int]:
    """The steps that have their straight parts from the same kind or grid as this one: they are alike
    (`_is_alike`) and have the same lengths."""
    what = scene.task[step]
    lengths = what.approach_m, what.depart_m
    others = [(i, each) for i, each in enumerate(scene.task) if (each.approach_m, each.depart_m) == lengths]
    return [i for i, each in others if i == step or _is_alike(each, what)]


def longer_straight_part(scene: Scene, step: int, facts: Separation) -> Iterator[Change]:
    """An approach or a depart that is as long as the refusal says that it must be."""
    if isinstance(scene.task[step], Pick | Place) and facts.end is not None and facts.least_m is not None:
        yield _straight(scene, step, "straight part", {facts.end: up(facts.least_m, SHOWN_M)})


def higher_points(scene: Scene, step: int, refusal: Refusal) -> Iterator[Change]:
    """A point that is higher in its frame: so that what overlaps there only touches, then by all that is missing. Of a
    pick it is the grasp that is higher on the part. Then a place with all others of its height, as slots are."""
    facts = refusal.facts
    if not isinstance(facts, Separation) or facts.gap_m is None or facts.required_m is None or facts.end is not None:
        return
    if refusal.stage is not Stage.CONTROL_POINT and facts.rule not in ("near", "contact"):
        return
    what = scene.task[step]
    if any(is_taken_away(each) and each.part in refusal.bodies and each is not what for each in scene.task):
        return  # no part is put on one that somebody takes away
    # a tenth of what is shown more: the proof keeps a reserve
    rises = up(-facts.gap_m, SHOWN_M), up(facts.required_m - facts.gap_m + 0.1 * SHOWN_M, SHOWN_M)
    for rise in rises:
        if rise > 0.0 and (higher := _higher(what, rise)):
            yield of_step(scene, step, "point height", f"{1e3 * rise:g} mm higher", **higher)
    count = sum(_is_alike(each, what) for each in scene.task) if isinstance(what, Place) else 0
    for rise in dict.fromkeys(rises) if count > 1 else ():
        if rise > 0.0:
            task = tuple(replace(each, **_higher(each, rise)) if _is_alike(each, what) else each for each in scene.task)
            value = f"{1e3 * rise:g} mm higher, all {count} places of this height"
            yield "place heights", value, replace(scene, task=task)


def _is_alike(step: Step, what: Step) -> bool:
    """Whether two picks have the same grasp; or two places are of the same height, in the same frame and on the same
    bodies."""
    match step, what:
        case Pick(), Pick():
            return step.grasp == what.grasp
        case Place(), Place():
            same = (step.to.frame, step.contact_with) == (what.to.frame, what.contact_with)
            return same and abs(step.to.pose.z - what.to.pose.z) <= ROUNDING
    return False


def _higher(what: Step, rise: float) -> dict[str, Any]:
    """What changes of a step with its point higher; nothing: it has more than one."""
    if isinstance(what, Pick):
        return {"grasp": replace(what.grasp, z=what.grasp.z + rise)}
    if isinstance(what, Follow | Place) or (isinstance(what, Move) and not what.path):
        at, name = what.target, "to" if isinstance(what, Place) else "target"
        return {name: replace(at, pose=replace(at.pose, z=at.pose.z + rise))}
    return {}


def contact_tolerances(scene: Scene, step: int, facts: Separation) -> Iterator[Change]:
    """Contacts that may become as much deeper as is missing: at the step alone, at each pick and place, and there more
    of it."""
    what = scene.task[step]
    if not isinstance(what, Pick | Place) or facts.rule != "contact":
        return
    if facts.gap_m is None or facts.required_m is None:
        return
    short = facts.required_m - facts.gap_m + 0.1 * SHOWN_M
    if short > SOFTEST_M:
        return  # the point is wrong
    least = up(what.contact_tolerance_m + short, SHOWN_M)
    yield "contact tolerance", f"{1e3 * least:g} mm at {what.name}", with_step(scene, step, _softer(what, least))
    for times in TIMES:
        deep = up(what.contact_tolerance_m + times * short, SHOWN_M)
        task = tuple(_softer(each, deep) if isinstance(each, Pick | Place) else each for each in scene.task)
        yield "contact tolerance", f"{1e3 * deep:g} mm at each pick and place", replace(scene, task=task)


def _softer(step: Pick | Place, deep: float) -> Pick | Place:
    return replace(step, contact_tolerance_m=max(step.contact_tolerance_m, deep))


MORE = 4
"""How much more the change of the budget allows."""
LAST_S, LAST_M = 1e5, 100.0
"""Ends of windows that are as good as none: the last that a request can state."""
SPEEDS = (0.8, 0.5, 0.2, 0.1)
"""Shares of a process speed, from the weakest change to the strongest."""
BLENDS = (1.5, 2.0, 4.0)
"""Multiples of a blend, likewise."""
DWELLS, BELTS = (0.8, 0.6, 0.4, 0.2, 0.1), (0.8, 0.5)
"""Shares of a dwell, and of the speed of a belt, that are tried."""


def changes(scene: Scene, step: int, blocker: str | None, refusal: Refusal | None = None) -> Iterator[Change]:
    """All changes: first the kinds that the refusal is about, then the others, each kind from its weakest change to its
    strongest."""
    about = kinds_about(refusal)
    listed = list(_listed(scene, step, blocker, refusal))
    for kind in about:
        yield from (change for change in listed if change[0] == kind)
    yield from (change for change in listed if change[0] not in about)


def _listed(scene: Scene, step: int, blocker: str | None, refusal: Refusal | None) -> Iterator[Change]:
    """Changes in the order of a shop: window, latest end, acceleration time, budget, elbow, pitch, match, process
    speed, blend, heights of approach and depart, height of the point, contact tolerance, dwell, belt speed, clearance
    of a pair or of all, margin, a body or another robot left out."""
    what, options = scene.task[step], scene.options
    on_step, option = partial(of_step, scene, step), partial(of_options, scene)
    if what.window != Window():
        span, along = what.window.time, what.window.along
        later = Window(None if span is None else (span[0], LAST_S), None if along is None else (along[0], LAST_M))
        alike = of_same_window(scene, step)
        yield of_window(scene, alike, "without its end", later)
        yield of_window(scene, alike, "removed", Window())
        others = [i for i, each in enumerate(scene.task) if each.window != Window()]
        if others != alike:
            task = tuple(replace(each, window=Window()) for each in scene.task)
            yield "window", f"all {len(others)} removed", replace(scene, task=task)
    if options.latest_end_s is not None:
        yield option("latest end", "none", latest_end_s=None)
    if options.acceleration_time_s is not None:
        yield option("acceleration time", "left to the planner", acceleration_time_s=None)
    # a longer search: of more time and, where the request counts them, more candidates
    seconds, count = min(MORE * options.budget_s, LONGEST_BUDGET_S), options.max_candidates
    count = count and min(MORE * count, MOST_CANDIDATES)
    counted = f"{count} candidates in " if count else ""
    if (seconds, count) != (options.budget_s, options.max_candidates):
        yield option("budget", f"{counted}{seconds:g} s", budget_s=seconds, max_candidates=count)
    if options.elbow != "auto" and len(scene.robot.modes) > 1:
        yield option("elbow", "auto", elbow="auto")
    if isinstance(what, Move | Follow) and what.target.pitch is not None:
        yield on_step("pitch", "free", target=replace(what.target, pitch=None))
    if isinstance(what, Move) and what.match == "velocity":
        yield on_step("match", "position", match="position")
    for kind, steps in (("process speed", _slower(what)), ("blend", _rounder(what))):
        yield from ((kind, value, with_step(scene, step, changed)) for value, changed in steps)
    yield from heights(scene, step, what)
    if refusal is not None and isinstance(refusal.facts, Separation) and refusal.step == step:
        yield from longer_straight_part(scene, step, refusal.facts)
        yield from higher_points(scene, step, refusal)
        yield from contact_tolerances(scene, step, refusal.facts)
    time, lasts = ("duration_s" if isinstance(what, Follow) else "dwell_s"), what.dwell_s
    if isinstance(what, Follow | Pick | Place) and lasts > 0.0:
        yield from (on_step("dwell", f"{1e3 * s * lasts:.0f} ms", **{time: s * lasts}) for s in DWELLS)
    yield from _belts(scene, what)
    yield from smaller_clearances(scene, refusal)
    if options.singularity_margin > 0:
        yield option("singularity margin", "0", singularity_margin=0.0)
    if blocker is not None and blocker in scene.index and not _is_part(scene, blocker):
        # the bodies of another robot have its name before theirs
        robot, of_robot, _ = blocker.partition("/")
        bodies = tuple(
            body
            for body in scene.bodies
            if body.name != blocker and not (of_robot and body.name.startswith(f"{robot}/"))
        )
        try:
            yield "without", robot, replace(scene, bodies=bodies)
        except InputError:
            # a step names the body (contact_with): without it the task would be another one
            return


def _slower(step: Step) -> Iterator[tuple[str, Step]]:
    """A trace at lower process speeds, each with the speed in words; nothing for other steps."""
    if isinstance(step, Trace):
        for share in SPEEDS:
            speed = share * step.speed_m_s
            yield f"{1e3 * speed:g} mm/s", replace(step, speed_m_s=speed)


def _rounder(step: Step) -> Iterator[tuple[str, Step]]:
    """A path with larger blends, each with the blend in words; nothing where a larger blend changes no corner."""
    for factor in BLENDS:
        if isinstance(step, Trace):
            path = replace(step.path, blend_m=factor * step.path.blend_m)
            if path.length != step.path.length:
                yield f"{1e3 * path.blend_m:g} mm", replace(step, path=path)
        elif isinstance(step, Move) and len(step.path) > 1 and step.blend_m > 0.0:
            blend = factor * step.blend_m
            yield f"{1e3 * blend:g} mm", replace(step, blend_m=blend)


def _belts(scene: Scene, what: Step) -> Iterator[Change]:
    name = frame_of(scene, what)
    frame = scene.frames[name]
    if any(body.frame == name and body.since_s is not None for body in scene.bodies):
        return  # at another speed the body would be elsewhere on the belt
    for law in (slowed(frame.law, share) for share in BELTS):
        if law is not None:
            frames = {**scene.frames, name: replace(frame, law=law)}
            yield "belt speed", f"{1e3 * law.numbers.speed:.0f} mm/s", replace(scene, frames=frames)


def _is_part(scene: Scene, name: str) -> bool:
    return any(isinstance(step, Pick | Place) and step.part == name for step in scene.task)
