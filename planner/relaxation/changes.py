"""The changes of a request that are tried, in families of one kind, each from its weakest change to its strongest.

Never a robot beyond its limits, never a clearance below the uncertainties (those are added to it).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from assur.planner.errors import InputError
from assur.planner.laws import slowed
from assur.planner.model.refusal import Refusal, Separation
from assur.planner.model.scene import Follow, Move, Pick, Place, Scene, Step, Trace, Window
from assur.planner.relaxation.by_cause import kinds_about
from assur.planner.relaxation.change import Change, frame_of, of_options, of_step, with_step
from assur.planner.relaxation.smaller_clearances import smaller_clearances
from assur.planner.relaxation.straight_parts import contact_tolerances, heights, higher_points, longer_straight_part

MORE = 4
"""How much more the change of the budget allows."""
FAR = 1e6
"""An end of a window, s or m, that is as good as none."""
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
        later = Window(None if span is None else (span[0], FAR), None if along is None else (along[0], FAR))
        yield on_step("window", "open at its end", window=later)
        yield on_step("window", "open", window=Window())
    if options.latest_end_s is not None:
        yield option("latest end", "none", latest_end_s=None)
    if options.acceleration_time_s is not None:
        yield option("acceleration time", "left to the planner", acceleration_time_s=None)
    # a longer search: of more time and, where the request counts them, more candidates
    seconds, count = MORE * options.budget_s, options.max_candidates and MORE * options.max_candidates
    counted = f"{count} candidates in " if count else ""
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
    for law in (slowed(frame.law, share) for share in BELTS):
        if law is not None:
            frames = {**scene.frames, name: replace(frame, law=law)}
            yield "belt speed", f"{1e3 * law.numbers.speed:.0f} mm/s", replace(scene, frames=frames)


def _is_part(scene: Scene, name: str) -> bool:
    return any(isinstance(step, Pick | Place) and step.part == name for step in scene.task)
