"""The deadline is looked at in each part of the work, as often as there are things to work on.

A clock counts who reads it. A part of the work that does not look any more is found here, whatever the machine.
"""

from __future__ import annotations

import sys
import time
from collections import Counter

import pytest

from assur.planner.model import deadline
from assur.scenes.requests import cell_of, plan_cell, shipped


class Clock:
    """Reads the time for `assur.planner.model.deadline`, and counts by module and function who asks."""

    def __init__(self) -> None:
        self.asked: Counter[str] = Counter()

    def perf_counter(self) -> float:
        frame = sys._getframe(1)
        while frame.f_globals["__name__"] == deadline.__name__ and frame.f_back is not None:
            frame = frame.f_back
        module = str(frame.f_globals["__name__"]).removeprefix("assur.")
        self.asked[f"{module}.{frame.f_code.co_name}"] += 1
        return time.perf_counter()


def asked(name: str, monkeypatch: pytest.MonkeyPatch) -> Counter[str]:
    clock = Clock()
    monkeypatch.setattr(deadline, "time", clock)
    scenario = shipped(name)
    plan_cell(cell_of(scenario.request, folder=scenario.folder), unstated={"report": "full"})
    return clock.asked


FRAMES, BODIES, STEPS = "frames", "bodies", "task"
"""At least as often as the request has of these."""
LOOKS: dict[str, dict[str, str | int]] = {
    "demo": {
        "scenes.reading.frames.frames_of": FRAMES,
        "scenes.reading.cell._surroundings": BODIES,
        "planner.search.beam._late": 10,
        "planner.search.beam._met": STEPS,
        "planner.search.meeting_options.options": STEPS,
        "planner.legs.follower.followed": STEPS,
        "planner.feasibility.input_warnings.unusual_places": STEPS,
    },
    "crowded": {"scenes.reading.cell._surroundings": BODIES, "planner.feasibility.hits.near": BODIES},
    "hose-on-gripper": {"planner.feasibility.necessary.yaw_impossible": STEPS},
    "parabolic-blend": {"planner.search.beam._met": STEPS},
    "circular-legs": {"scenes.reading.task._parts": STEPS, "planner.model.path.at": STEPS},
    "beside-a-neighbour": {"planner.checked.check": 1, "planner.checked._judged": 2},
    "shut-gate": {"planner.collision.proof.over": 1, "planner.feasibility.hits.hits": STEPS},
}


@pytest.mark.parametrize("name", LOOKS)
def test_each_part_of_the_work_looks_at_the_deadline(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    request = shipped(name).request
    found = asked(name, monkeypatch)
    for place, least in LOOKS[name].items():
        wanted = least if isinstance(least, int) else len(request[least])
        assert found[place] >= wanted > 0, (place, found)
