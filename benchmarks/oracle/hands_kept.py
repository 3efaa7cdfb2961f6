"""How near the tool is to the part that it takes, and the part to what it is put down on, as an answer tells it."""

from __future__ import annotations

import numpy as np

from benchmarks.oracle.apart_kept import ROUNDING_M, WITHIN_M
from benchmarks.oracle.faults import Broken, beyond
from benchmarks.oracle.motion import Motion, Phase
from benchmarks.soak.poses import Document
from benchmarks.soak.solids import Gap


def hands_kept(motion: Motion) -> list[Broken]:
    """At the end of the dwell of each pick and place: the smallest distance, 0 where there is contact."""
    found = list[Broken]()
    for phase in motion.phases:
        number = phase.stage.handed_over
        if number is None:
            continue
        ((kind, given),) = motion.request["task"][number].items()
        arrival = next(each for each in motion.answer["arrivals"] if each["step"] == number)
        if kind == "pick":
            found += _distance(motion, arrival, given["part"], motion.cell.tool_bodies, "grip_m", phase)
        elif "contact_with" in given:
            found += _distance(motion, arrival, given["part"], given["contact_with"], "support_m", phase)
    return found


def _distance(motion: Motion, arrival: Document, part: str, others: list[str], key: str, phase: Phase) -> list[Broken]:
    told = arrival.get(key)
    if told is None:
        return []  # what an answer leaves out is no claim
    t = np.array([arrival["until_s"]])
    places = motion.bodies(phase, t, {part, *others})
    gaps = [Gap(motion.shapes[part], motion.shapes[name]).at(places[part][0], places[name][0]) for name in others]
    true = max(min(gaps), 0.0)
    return beyond("hands", f"{arrival['control_point']}, {key}", abs(told - true), WITHIN_M + ROUNDING_M, t[0])
