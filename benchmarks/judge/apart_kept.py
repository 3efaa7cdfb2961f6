"""What a plan promises of distances: what each pair must keep in each phase, and the smallest clearance."""

from __future__ import annotations

import numpy as np

from benchmarks.judge.faults import Violation, beyond
from benchmarks.judge.motion import Motion
from benchmarks.judge.nearest import NearPair, nearest_of
from benchmarks.judge.poses import Document
from benchmarks.judge.solids import Gap

WITHIN_M = 5e-5
"""Largest difference of the reported smallest clearance from the true one."""
ROUNDING_M = 5e-6
"""Of a distance of `coal`, whose search ends within a micrometre, and of the search over time (`nearest.FOUND_M`)."""
SEARCH_M = 1e-3
"""Pairs are evaluated up to the reported smallest clearance plus this."""


def apart_kept(motion: Motion) -> list[Violation]:
    """Clearances, allowed contacts, and both smallest clearances, each with its pair and time."""
    margins = motion.answer["margins"]
    stated = margins["nearest"], margins["placed"]
    reach = SEARCH_M + max((max(float(each["gap_m"]), 0.0) for each in stated if each), default=0.0)
    found = nearest_of(motion, reach)
    broken = _required(motion, found)
    for put_down, smallest in zip((False, True), stated, strict=True):
        broken += _smallest(motion, found, smallest, put_down=put_down)
    return broken


def _smallest(motion: Motion, found: list[NearPair], stated: Document | None, *, put_down: bool) -> list[Violation]:
    """The smallest clearance of the robot, or of parts that were `put_down`."""
    free = [near for near in found if not near.pair.contact and near.put_down is put_down]
    if stated is None:
        required = any(
            not pair.contact and phase.put_down(pair) is put_down for phase in motion.phases for pair in phase.pairs
        )
        return [Violation("nearest", "no pair is reported", 0.0, 0.0)] if required else []
    if not free:
        return [Violation("nearest", "no pair is so near", float("inf"), stated["gap_m"])]
    best = min(free, key=lambda near: near.gap_m)
    about = f"{best.pair.first}, {best.pair.second} {best.kind}"
    broken = beyond("nearest", f"nearer: {about}", stated["gap_m"] - best.gap_m, WITHIN_M + ROUNDING_M, best.time_s)
    broken += beyond("nearest", f"farther: {about}", best.gap_m - stated["gap_m"], WITHIN_M + ROUNDING_M, best.time_s)
    return broken + _named(motion, stated, put_down=put_down)


def _required(motion: Motion, found: list[NearPair]) -> list[Violation]:
    broken = []
    for near in found:
        first, second = motion.shapes[near.pair.first], motion.shapes[near.pair.second]
        if (first.mesh or second.mesh) and near.pair.required < 0.0:
            continue  # how deep a surface is crossed is not known
        about = f"{near.pair.first}, {near.pair.second} {near.kind}"
        kind = "contact" if near.pair.contact else "clearance"
        broken += beyond(kind, about, near.pair.required - near.gap_m, ROUNDING_M, near.time_s)
    return broken


def _named(motion: Motion, stated: Document, *, put_down: bool) -> list[Violation]:
    """The reported pair has the reported gap at the reported time, in a phase of the reported kind."""
    time, (one, other) = float(stated["time_s"]), stated["bodies"]
    best = float("inf")
    for phase in motion.phases:
        inside = phase.stage.t0 - 1e-9 <= time <= phase.stage.t1 + 1e-9
        named = any(
            {one, other} == {pair.first, pair.second} and not pair.contact and phase.put_down(pair) is put_down
            for pair in phase.pairs
        )
        if inside and named:
            t = np.array([min(max(time, phase.stage.t0), phase.stage.t1)])
            places = motion.bodies(phase, t, {one, other})
            best = min(best, Gap(motion.shapes[one], motion.shapes[other]).at(places[one][0], places[other][0]))
    gap = float(stated["gap_m"])
    return beyond("nearest", f"as named: {one}, {other}", abs(best - gap), WITHIN_M + ROUNDING_M, time)
