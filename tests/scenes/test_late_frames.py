"""Frames that are fixed on frames: each is looked up with a look at the clock, for a long chain takes long."""

from __future__ import annotations

import pytest

from assur.planner.frames.motion import Pose
from assur.planner.model.deadline import OutOfTimeError
from assur.scenes.faults import Gathered
from assur.scenes.reading import frames
from assur.scenes.requests import validate
from tests.scenes.test_budgets import with_task

CHAIN = 12


@pytest.mark.parametrize("last", [1, CHAIN, CHAIN + 1, 2 * CHAIN - 1])
def test_the_clock_is_looked_at_for_each_frame_twice(last: int, monkeypatch: pytest.MonkeyPatch) -> None:
    chain = {f"f{k}": {"fixed": ({"frame": f"f{k - 1}"} if k else {}) | {"at_mm": [1, 0, 0]}} for k in range(CHAIN)}
    move = {"move": {"to": {"at_mm": [350, 100, 250], "yaw_deg": 0}}}
    request = validate(with_task(move, frames=chain))
    calls = 0

    def raise_if_late() -> None:
        nonlocal calls
        calls += 1
        if calls == last:
            raise OutOfTimeError

    monkeypatch.setattr(frames, "raise_if_late", raise_if_late)
    with pytest.raises(OutOfTimeError):
        frames.frames_of(request.frames, Gathered())
    assert calls == last
    last = 0
    found = frames.frames_of(request.frames, Gathered())
    # the first has a law of its own
    assert calls > 2 * CHAIN - 1
    assert found.placed(f"f{CHAIN - 1}", Pose())[1].x == pytest.approx(1e-3 * (CHAIN - 1))
