"""What is probably not meant about what a part rests on: bodies that `contact_with` names and it does not touch."""

from __future__ import annotations

from collections.abc import Sequence

from assur.planner.collision.proof import Prover
from assur.planner.collision.touching import apart
from assur.planner.feasibility.touching import always
from assur.planner.model.attachments import at_start
from assur.planner.model.deadline import look
from assur.planner.model.input_warning import InputWarning, Odd
from assur.planner.model.outcome import Arrival
from assur.planner.model.scene import Pick, Place, Scene

OFF_M = 0.002
"""A part that is no farther than this from what it is said to rest on is dropped on purpose, as some grippers do, or
measured so, m."""


def odd_supports(scene: Scene, prover: Prover, arrivals: Sequence[Arrival]) -> tuple[InputWarning, ...]:
    """A warning for each body that a pick or place names as touched by its part and that is farther than `OFF_M` from
    it, in the order of the task. What moves against the part is looked at where there is an arrival. Raises
    `OutOfTimeError` where the deadline in force passes."""
    attached, found = at_start(scene), list[InputWarning]()
    until = {arrival.step: arrival.until for arrival in arrivals}
    for number, step in enumerate(scene.task):
        look()
        before, attached = attached, attached.after(scene, step)
        if not isinstance(step, Pick | Place) or not step.contact_with:
            continue
        time = scene.start.time if always(scene, step, before) else until.get(number)
        if time is None:
            continue
        # a part that is picked is still where it is, one that is placed is there already
        here = before if isinstance(step, Pick) else attached
        for name in step.contact_with:
            distance = apart(prover, here, time, step.part, name)
            if distance > OFF_M:
                found.append(InputWarning(Odd.SUPPORT_OFF_PART, (step.part, name), distance, step.name))
    return tuple(found)
