"""The changes of a request that are tried, in families of one kind, each from its weakest change to its strongest.

Never a robot beyond its limits, never a clearance below the uncertainties (those are added to it).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from assur.planner.errors import InputError
from assur.planner.laws import slowed
from assur.planner.model.easier_path import rounder, slower
from assur.planner.model.refusal import Refusal, Separation
from assur.planner.model.scene import Follow, Move, Pick, Place, Scene, Step, Window
from assur.planner.relaxation.by_cause import kinds_about
from assur.planner.relaxation.change import Change, frame_of, with_step
from assur.planner.relaxation.smaller_clearances import smaller_clearances
from assur.planner.relaxation.straight_parts import contact_tolerances, heights, higher_points, longer_straight_part

MORE = 4
"""How much more the change of the budget allows."""
FAR = 1e6
"""An end of a window, s or m, that is as good as none."""


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
    if what.window != Window():
        span, along = what.window.time, what.window.along
        later = Window(None if span is None else (span[0], FAR), None if along is None else (along[0], FAR))
        yield "window", "open at its end", with_step(scene, step, replace(what, window=later))
        yield "window", "open", with_step(scene, step, replace(what, window=Window()))
    if options.latest_end_s is not None:
        yield "latest end", "none", replace(scene, options=replace(options, latest_end_s=None))
    if options.acceleration_time_s is not None:
        yield (
            "acceleration time",
            "left to the planner",
            replace(scene, options=replace(options, acceleration_time_s=None)),
        )
    yield _budget(scene)
    if options.elbow != "auto" and len(scene.robot.modes) > 1:
        yield "elbow", "auto", replace(scene, options=replace(options, elbow="auto"))
    if isinstance(what, Move | Follow) and what.target.pitch is not None:
        yield "pitch", "free", with_step(scene, step, replace(what, target=replace(what.target, pitch=None)))
    if isinstance(what, Move) and what.match == "velocity":
        yield "match", "position", with_step(scene, step, replace(what, match="position"))
    for kind, steps in (("process speed", slower(what)), ("blend", rounder(what))):
        yield from ((kind, value, with_step(scene, step, changed)) for value, changed in steps)
    yield from heights(scene, step, what)
    if refusal is not None and isinstance(refusal.facts, Separation) and refusal.step == step:
        yield from longer_straight_part(scene, step, refusal.facts)
        yield from higher_points(scene, step, refusal)
        yield from contact_tolerances(scene, step, refusal.facts)
    yield from _dwells(scene, step, what)
    yield from _belts(scene, what)
    yield from smaller_clearances(scene, refusal)
    if options.singularity_margin > 0:
        yield "singularity margin", "0", replace(scene, options=replace(options, singularity_margin=0.0))
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


def _budget(scene: Scene) -> Change:
    """A longer search: of more time and, where the request counts them, more candidates."""
    options, seconds = scene.options, MORE * scene.options.budget_s
    if options.max_candidates is None:
        return "budget", f"{seconds:g} s", replace(scene, options=replace(options, budget_s=seconds))
    count = MORE * options.max_candidates
    longer = replace(options, budget_s=seconds, max_candidates=count)
    return "budget", f"{count} candidates in {seconds:g} s", replace(scene, options=longer)


def _dwells(scene: Scene, step: int, what: Step) -> Iterator[Change]:
    for share in (0.8, 0.6, 0.4, 0.2, 0.1):
        if isinstance(what, Follow):
            duration = share * what.duration_s
            yield "dwell", f"{1e3 * duration:.0f} ms", with_step(scene, step, replace(what, duration_s=duration))
        elif isinstance(what, Pick | Place) and what.dwell_s > 0:
            dwell = share * what.dwell_s
            yield "dwell", f"{1e3 * dwell:.0f} ms", with_step(scene, step, replace(what, dwell_s=dwell))


def _belts(scene: Scene, what: Step) -> Iterator[Change]:
    name = frame_of(scene, what)
    frame = scene.frames[name]
    for share in (0.8, 0.5):
        law = slowed(frame.law, share)
        if law is None:
            return
        frames = {**scene.frames, name: replace(frame, law=law)}
        yield "belt speed", f"{1e3 * law.numbers.speed:.0f} mm/s", replace(scene, frames=frames)


def _is_part(scene: Scene, name: str) -> bool:
    return any(isinstance(step, Pick | Place) and step.part == name for step in scene.task)
