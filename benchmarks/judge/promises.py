"""All that a plan promises, evaluated as it is planned."""

from __future__ import annotations

import numpy as np

from benchmarks.judge.apart_kept import ROUNDING_M, WITHIN_M, apart_kept
from benchmarks.judge.arrivals_kept import Targets, arrivals_kept
from benchmarks.judge.faults import Violation, beyond
from benchmarks.judge.joints_kept import joints_kept
from benchmarks.judge.motion import Motion, Phase
from benchmarks.judge.poses import Document
from benchmarks.judge.solids import Gap
from benchmarks.judge.traces_kept import traces_kept
from benchmarks.judge.ways_kept import ways_kept

TOOL = 0.05
"""Share by which the tool's speed may exceed the reported peak, between the instants at which it is searched."""


def broken_promises(request: Document, answer: Document) -> list[Violation]:
    """What a planned answer promises and does not keep; `request` in SI, of a kind that the judge knows."""
    motion = Motion(request, answer)
    targets = Targets(motion)
    return [
        *joints_kept(motion),
        *arrivals_kept(motion, targets),
        *ways_kept(motion, targets),
        *traces_kept(motion),
        *apart_kept(motion),
        *hands_kept(motion),
        *_tool(motion),
    ]


def _tool(motion: Motion) -> list[Violation]:
    """The tool point has the reported peak of speed at the reported time, and nowhere is it much faster."""
    stated, h = motion.answer["margins"]["tool"], 1e-5
    t = np.linspace(motion.start_s + h, motion.end_s - h, max(int((motion.end_s - motion.start_s) / 5e-4), 10))
    speed = np.linalg.norm(motion.tool(t + h).p - motion.tool(t - h).p, axis=1) / (2.0 * h)
    found = beyond(
        "tool", "speed", float(speed.max()), stated["speed_m_s"] * (1.0 + TOOL) + 1e-6, float(t[speed.argmax()])
    )
    at = min(max(float(stated["speed_at_s"]), motion.start_s + h), motion.end_s - h)
    there = motion.tool(np.array([at - h, at + h])).p
    off = abs(float(np.linalg.norm(there[1] - there[0])) / (2.0 * h) - float(stated["speed_m_s"]))
    return found + beyond("tool", "speed, as reported", off, 1e-3 * float(stated["speed_m_s"]) + 1e-4, at)


def hands_kept(motion: Motion) -> list[Violation]:
    """At the end of the dwell of each pick and place: the smallest distance, 0 where there is contact."""
    found = list[Violation]()
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


def _distance(
    motion: Motion, arrival: Document, part: str, others: list[str], key: str, phase: Phase
) -> list[Violation]:
    stated = arrival.get(key)
    if stated is None:
        return []  # what an answer leaves out is no claim
    t = np.array([arrival["until_s"]])
    places = motion.bodies(phase, t, {part, *others})
    gaps = [Gap(motion.shapes[part], motion.shapes[name]).at(places[part][0], places[name][0]) for name in others]
    true = max(min(gaps), 0.0)
    return beyond("hands", f"{arrival['control_point']}, {key}", abs(stated - true), WITHIN_M + ROUNDING_M, t[0])
