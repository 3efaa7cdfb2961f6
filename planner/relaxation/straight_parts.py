"""Changes at a point: the straight parts of the ways to and from it, its height, and how deep contacts may become."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from assur.planner.model.refusal import Refusal, Separation, Stage
from assur.planner.model.scene import Follow, Move, Pick, Place, Scene, Step
from assur.planner.relaxation.change import Change, of_step, with_step
from assur.planner.relaxation.rounded import SHOWN_M, up

TIMES = (1, 2, 5)
"""So many times what is missing is tried as a contact tolerance: another pick or place may need more."""


def heights(scene: Scene, step: int, what: Step) -> Iterator[Change]:
    """Shorter straight parts of the ways to and from the point: of one of both alone, then of both."""
    if not isinstance(what, Pick | Place):
        return
    lengths = {"approach": what.approach_m, "depart": what.depart_m}
    for share in (0.5, 0.2):
        shorter = {name: share * length for name, length in lengths.items() if length > 0.0}
        alone = [{name: length} for name, length in shorter.items()] if len(shorter) == 2 else []
        yield from (_straight(scene, step, "heights", each) for each in (*alone, shorter) if each)


def _straight(scene: Scene, step: int, kind: str, lengths: dict[str, float]) -> Change:
    """A change of the lengths of straight parts, m."""
    value = ", ".join(f"{name} {1e3 * length:g} mm" for name, length in lengths.items())
    return of_step(scene, step, kind, value, **{f"{name}_m": length for name, length in lengths.items()})


def longer_straight_part(scene: Scene, step: int, facts: Separation) -> Iterator[Change]:
    """An approach or a depart that is as long as the refusal says that it must be."""
    if isinstance(scene.task[step], Pick | Place) and facts.end is not None and facts.least_m is not None:
        yield _straight(scene, step, "straight part", {facts.end: up(facts.least_m, SHOWN_M)})


def higher_points(scene: Scene, step: int, refusal: Refusal) -> Iterator[Change]:
    """A point that is higher in its frame: so that what overlaps there only touches, then by all that is missing. Of a
    pick it is the grasp that is higher on the part."""
    facts = refusal.facts
    if not isinstance(facts, Separation) or facts.gap_m is None or facts.required_m is None or facts.end is not None:
        return
    if refusal.stage is not Stage.CONTROL_POINT and facts.rule not in ("near", "contact"):
        return
    # a tenth of what is shown more: the proof keeps a reserve
    for rise in (up(-facts.gap_m, SHOWN_M), up(facts.required_m - facts.gap_m + 0.1 * SHOWN_M, SHOWN_M)):
        higher = _higher(scene.task[step], rise)
        if higher and rise > 0.0:
            yield of_step(scene, step, "point height", f"{1e3 * rise:g} mm higher", **higher)


def _higher(what: Step, rise: float) -> dict[str, object]:
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
    least = up(what.contact_tolerance_m + short, SHOWN_M)
    yield "contact tolerance", f"{1e3 * least:g} mm at {what.name}", with_step(scene, step, _softer(what, least))
    for times in TIMES:
        deep = up(what.contact_tolerance_m + times * short, SHOWN_M)
        task = tuple(_softer(each, deep) if isinstance(each, Pick | Place) else each for each in scene.task)
        yield "contact tolerance", f"{1e3 * deep:g} mm at each pick and place", replace(scene, task=task)


def _softer(step: Pick | Place, deep: float) -> Pick | Place:
    return replace(step, contact_tolerance_m=max(step.contact_tolerance_m, deep))
