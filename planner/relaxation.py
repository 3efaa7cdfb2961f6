"""What would have helped: small changes of a request, each tried, in the order in which a shop would make them.

Never a robot beyond its limits, never a clearance below the uncertainties (those are added to it).
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import replace

from assur.planner.blends.search import searcher
from assur.planner.collision.proof import Prover
from assur.planner.errors import InputError
from assur.planner.frames import Conveyor
from assur.planner.model.outcome import Relaxation
from assur.planner.model.refusal import Reason, Refusal
from assur.planner.model.scene import WORLD, Clearance, Follow, Move, Pick, Place, Scene, Step, Window
from assur.planner.search.beam import Found

ATTEMPT_S = 1.0
"""Longest time for one change of a request that counts no candidates, s."""
MORE = 4
"""How much more the change of the budget allows."""
FEWEST_S = 0.02
"""A change is not tried with less time than this left, s."""


def relax(
    scene: Scene,
    step: int,
    blocker: str | None,
    deadline: float,
    refusal: Refusal | None = None,
    *,
    proved: bool = False,
) -> tuple[Relaxation | None, tuple[str, ...], bool]:
    """The first change that works, what was tried, and whether the time was spent; `deadline` in monotonic seconds.

    `refusal`: why there is no plan, and whether that is `proved`: only what it leaves open is tried.
    """
    tried: list[str] = []
    geometric = refusal is not None and refusal.reason in GEOMETRIC
    for what, value, changed in changes(scene, step, blocker):
        if (proved and what == "budget") or (geometric and what not in OF_GEOMETRY):
            continue
        left = deadline - time.perf_counter()
        if left < FEWEST_S:
            return None, tuple(tried), True
        tried.append(f"{what}: {value}")
        found = _attempt(changed, min(left, _longest(what, changed, left)))
        if found.best is not None:
            taken = found.best.state.time - scene.start.time
            return Relaxation(what, _reached(found, what, value, step), taken), tuple(tried), False
    return None, tuple(tried), False


def _longest(what: str, changed: Scene, left: float) -> float:
    """Longest time for one change, s. Where the request counts candidates, the count ends each attempt, so what is
    found does not depend on the machine; the clock only keeps half of the time for the changes that follow."""
    if changed.options.max_candidates is not None:
        return left / 2
    return ATTEMPT_S if what != "budget" else min(changed.options.budget_s, left / 2)


def _attempt(scene: Scene, budget: float) -> Found:
    """The search that the changed request would cause, up to its first plan: what is found here, that request finds."""
    changed = replace(scene, options=replace(scene.options, budget_s=budget))
    search = searcher(changed, Prover(changed), time.perf_counter())
    search.until_first = True
    return search.run()


def _reached(found: Found, what: str, value: str, step: int) -> str:
    """A window that was opened altogether is reported as what the plan used of it."""
    if what != "window" or found.best is None:
        return value
    arrival = next(a for a in found.best.arrivals if a.step == step)
    text = f"open until {arrival.until:.3f} s"
    return text if arrival.along_m is None else f"{text} ({1e3 * arrival.along_m:.0f} mm at the meeting)"


def changes(scene: Scene, step: int, blocker: str | None) -> Iterator[tuple[str, str, Scene]]:
    """Changes in order: window, acceleration time, budget, elbow, pitch, match, heights of approach and depart, dwell,
    belt speed, clearance, margin, a body or another robot left out."""
    what, options = scene.task[step], scene.options
    if what.window != Window():
        yield "window", "open", _step(scene, step, replace(what, window=Window()))
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
        yield "pitch", "free", _step(scene, step, replace(what, target=replace(what.target, pitch=None)))
    if isinstance(what, Move) and what.match == "velocity":
        yield "match", "position", _step(scene, step, replace(what, match="position"))
    yield from _heights(scene, step, what)
    yield from _dwells(scene, step, what)
    yield from _belts(scene, what)
    near, travel = options.clearance.near_m, options.clearance.travel_m
    if near > 0 or travel > 0:
        for share in (0.5, 0.0):
            value = f"travel {1e3 * share * travel:g} mm, near {1e3 * share * near:g} mm"
            clearance = Clearance(share * travel, share * near)
            yield "clearance", value, replace(scene, options=replace(options, clearance=clearance))
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


def _budget(scene: Scene) -> tuple[str, str, Scene]:
    """A longer search: of more time and, where the request counts them, more candidates."""
    options, seconds = scene.options, MORE * scene.options.budget_s
    if options.max_candidates is None:
        return "budget", f"{seconds:g} s", replace(scene, options=replace(options, budget_s=seconds))
    count = MORE * options.max_candidates
    longer = replace(options, budget_s=seconds, max_candidates=count)
    return "budget", f"{count} candidates in {seconds:g} s", replace(scene, options=longer)


def _heights(scene: Scene, step: int, what: Step) -> Iterator[tuple[str, str, Scene]]:
    """Shorter straight ways to and from the point."""
    if not isinstance(what, Pick | Place) or not max(what.approach_m, what.depart_m) > 0:
        return
    for share in (0.5, 0.2):
        approach, depart = share * what.approach_m, share * what.depart_m
        lower = replace(what, approach_m=approach, depart_m=depart)
        yield "heights", f"approach {1e3 * approach:g} mm, depart {1e3 * depart:g} mm", _step(scene, step, lower)


def _dwells(scene: Scene, step: int, what: Step) -> Iterator[tuple[str, str, Scene]]:
    for share in (0.8, 0.6, 0.4, 0.2, 0.1):
        if isinstance(what, Follow):
            duration = share * what.duration_s
            yield "dwell", f"{1e3 * duration:.0f} ms", _step(scene, step, replace(what, duration_s=duration))
        elif isinstance(what, Pick | Place) and what.dwell_s > 0:
            dwell = share * what.dwell_s
            yield "dwell", f"{1e3 * dwell:.0f} ms", _step(scene, step, replace(what, dwell_s=dwell))


def _belts(scene: Scene, what: Step) -> Iterator[tuple[str, str, Scene]]:
    name = (
        scene.index[what.part].frame
        if isinstance(what, Pick)
        else (what.to.frame if isinstance(what, Place) else what.target.frame)
    )
    frame = scene.frames[name]
    if name == WORLD or not isinstance(frame.law, Conveyor) or frame.law.changes:
        return
    for share in (0.8, 0.5):
        law = replace(frame.law, speed=share * frame.law.speed)
        frames = {**scene.frames, name: replace(frame, law=law)}
        yield "belt speed", f"{1e3 * law.speed:.0f} mm/s", replace(scene, frames=frames)


def _is_part(scene: Scene, name: str) -> bool:
    return any(isinstance(step, Pick | Place) and step.part == name for step in scene.task)


def _step(scene: Scene, number: int, step: Step) -> Scene:
    return replace(scene, task=(*scene.task[:number], step, *scene.task[number + 1 :]))


GEOMETRIC = frozenset({Reason.OUT_OF_REACH, Reason.JOINT_LIMIT})
OF_GEOMETRY = frozenset({"elbow", "pitch", "heights"})
"""Where a point cannot be reached, only another posture or another height can help."""
HOPELESS = frozenset({Reason.START_IN_COLLISION, Reason.LAW_ENDS, Reason.LOAD_LIMIT})
"""Reasons that no change of the list can mend."""


def worth_trying(refusal: Refusal | None) -> bool:
    """Whether any change of the list could help."""
    return refusal is None or refusal.reason not in HOPELESS
