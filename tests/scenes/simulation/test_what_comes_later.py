"""A judge that knows all parts: each committed motion is proved again with the parts that were not seen when it was
planned, at their true places. It finds the stretch that is not seen left out."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import assur
from assur.scenes.requests import cell_of, read_plan
from assur.scenes.resampling.certifying import Refutation, recertified
from assur.scenes.scenarios import CELLS
from assur.scenes.simulation.cell import SimulatedCell, simulated
from assur.scenes.streams.arrivals import arrivals
from tests.scenes.simulation.test_simulation import SEED, Recorded, cell

Document = dict[str, Any]
UNTIL_S = 25.0
NEAR: Document = {"mean_s": 0.5, "seen": {"at_mm": -330, "latency_ms": 150}}
"""Parts that come near to each other, seen shortly before the window."""


def near() -> SimulatedCell:
    """The cell with these parts, which are not lifted high before they are carried away."""
    kind = assur.load(CELLS / "shared" / "soap-flow.yaml")["kinds"]["soap"]
    return simulated(cell(NEAR, kinds={"soap": {**kind, "depart": {"mm": 30}}}))


def refuted(made: SimulatedCell) -> list[str]:
    """Motions of a run that are refuted with the parts that are not known when they are planned."""
    done, (stream,), found = Recorded(made, until_s=UNTIL_S).through(), made.streams, list[str]()
    later = arrivals(stream, SEED, 2.0 * UNTIL_S)
    kind = made.kept.file.written["kinds"]["soap"]
    assert len(done.tally.cycles) >= 3
    for proposed_s, each in done.committed:
        assert each.segment is not None
        bodies = [body for body in each.judged.request["bodies"] if body["name"] != "unseen.soap"]
        known = {body["name"] for body in bodies}
        for part in later:
            if part.known_s > proposed_s and part.seen_s < each.segment.proved_until_s:
                assert part.name not in known
                at = {"frame": stream.frame, "at_m": [stream.seen_m, part.y_m, stream.at_m[2]], "at_s": part.seen_s}
                own = {key: kind[key] for key in ("shape", "mass_kg", "yaw_symmetry", "uncertainty")}
                bodies.append({"name": part.name, **own, "pose": {**at, "yaw_rad": part.yaw_rad}})
        plan, _, _ = read_plan(each.segment.cell, each.judged.answer)
        judged = recertified(cell_of({**each.judged.request, "bodies": bodies}).scene, plan, plan.trajectory)
        if isinstance(judged, Refutation):
            found += [finding.what for finding in judged.findings]
    return found


def test_no_motion_meets_a_part_that_comes_later() -> None:
    assert refuted(near()) == []


def test_the_judge_finds_what_is_not_seen_left_out() -> None:
    made = near()
    (unseen,) = made.unseen
    pose = {**unseen.part["pose"], "at_m": [-40.0, *unseen.part["pose"]["at_m"][1:]]}
    without = replace(unseen, part={**unseen.part, "pose": pose}, clear_m=-10.0)
    assert len(refuted(replace(made, unseen=(without,)))) >= 1
