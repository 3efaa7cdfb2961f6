"""The judge of sessions finds nothing in a session as it is, and each fault that is made on purpose in one."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import assur
from assur.scenes.session import committed
from assur.scenes.session.log import read_log
from assur.scenes.session.session import RunningCell
from assur.scenes.tasks import next_task
from benchmarks.judge.sessions import broken_sessions
from tests.api.test_session import START, at, cell

Document = dict[str, Any]
Patch = pytest.MonkeyPatch
OFF = {"position_mm": 0.4, "yaw_deg": 0.5}


def transfer(part: str, to: str = "box") -> Document:
    return {"transfer": {"parts": [part], "to": to}}


def played(path: Path, play: Callable[[assur.Session], None]) -> dict[str, list[str]]:
    """What the judge finds in the log of a session: what each kind of fault is about."""
    with assur.Session(assur.Cell(cell()), start=START, refuge="home", log=path) as session:
        play(session)
    document, events = read_log(path)
    found: dict[str, list[str]] = {}
    for violation in broken_sessions(document, list(events)):
        found.setdefault(violation.kind, []).append(violation.about)
    return found


def see(session: assur.Session, name: str, along_mm: float) -> None:
    session.see(name, kind="bracket", pose=at(along_mm), uncertainty=OFF)


def handle(session: assur.Session, part: str, to: str = "box") -> None:
    made = session.propose([transfer(part, to)])
    assert made.planned, made.answer.sentence
    session.commit(made)
    session.advance(made.starts_s)


def two_parts(session: assur.Session) -> None:
    """Two transfers, the second part seen while the first is on its way."""
    see(session, "a", -300.0)
    handle(session, "a")
    see(session, "b", -600.0)
    handle(session, "b")
    session.advance(session.committed[-1].answer["arrivals"][1]["until_s"])
    session.gone("a")
    made = session.propose([{"move": {"to": "home"}}])
    session.commit(made)
    session.advance(made.starts_s + 1.0)


def test_nothing_is_found_in_a_session_as_it_is(tmp_path: Path) -> None:
    assert played(tmp_path / "run.mcap", two_parts) == {}


def _no_horizon(patch: Patch) -> None:
    made = RunningCell._with_refuge
    first = [True]

    def steps(self: RunningCell, given: Any) -> list[object]:
        if first.pop() if first else False:
            return made(self, given)
        return [*given, {"move": {"to": {"at_mm": [350, 60, 180]}}}]

    patch.setattr(RunningCell, "_with_refuge", steps)


def _without_part(patch: Patch) -> None:
    state_of = next_task.state_of

    def forgetful(*args: Any) -> Any:
        state = state_of(*args)
        known = {name: each for name, each in state.uncertainty.items() if name != "a"}
        if "a" not in state.handled:
            return state
        return replace(state, uncertainty=known, gone=state.gone | {"a"}, gone_at_s={**state.gone_at_s, "a": 0.0})

    patch.setattr(next_task, "state_of", forgetful)


def _known_exactly(patch: Patch) -> None:
    parts = RunningCell._parts_at

    def exact(self: RunningCell, *a: Any) -> list[Document]:
        return [{key: value for key, value in part.items() if key != "uncertainty"} for part in parts(self, *a)]

    patch.setattr(RunningCell, "_parts_at", exact)


def _elsewhere(patch: Patch) -> None:
    parts = RunningCell._parts_at

    def moved(self: RunningCell, *a: Any) -> list[Document]:
        return [
            {**part, "pose": at(-603.0)} if part["name"] == "b" and "pose" in part else part for part in parts(self, *a)
        ]

    patch.setattr(RunningCell, "_parts_at", moved)


def _any_start(patch: Patch) -> None:
    patch.setattr(committed, "MOST_JUMPS", (np.inf,) * 3)


def _planning_takes_no_time(patch: Patch) -> None:
    at_first = RunningCell.__init__

    def begin(self: RunningCell, *a: Any) -> None:
        at_first(self, *a)
        self._planning_s = 0.0

    patch.setattr(RunningCell, "__init__", begin)


def _no_proof_needed(patch: Patch) -> None:
    patch.setattr(RunningCell, "proved_until_s", property(lambda _: np.inf))


def _no_look_at_the_clock(patch: Patch) -> None:
    commit = RunningCell.commit

    def late(self: RunningCell, number: object) -> None:
        clock_s, self.clock_s = self.clock_s, -np.inf
        commit(self, number)
        self.clock_s = clock_s

    patch.setattr(RunningCell, "commit", late)


def wait(session: assur.Session) -> None:
    session.advance(30.0)


def late(session: assur.Session) -> None:
    see(session, "a", -300.0)
    made = session.propose([transfer("a")])
    session.advance(made.decide_by_s + 0.05)
    session.commit(made)


def stale(session: assur.Session) -> None:
    """A proposal from the way to the first goal is committed behind another one."""
    session.commit(session.propose([{"move": {"to": {"at_mm": [300, 150, 180]}}}]))
    session.advance(session.clock_s + 0.1)
    old = session.propose([{"move": {"to": {"at_mm": [320, 120, 180]}}}], at_s=session.clock_s + 0.2)
    new = session.propose([{"move": {"to": {"at_mm": [350, -200, 180]}}}], at_s=session.clock_s + 0.1)
    kept = dict(session._running._open)
    session.commit(new)
    session._running._open.update(kept)
    session.commit(old)
    session.advance(old.starts_s + 0.5)


def soon(session: assur.Session) -> None:
    see(session, "a", -300.0)
    session.commit(session.propose([transfer("a")], at_s=session.clock_s + 0.001))
    session.advance(session.clock_s + 0.5)


def into_one_slot(session: assur.Session) -> None:
    """The first part is forgotten, so that the second one is put on it."""
    see(session, "a", -300.0)
    see(session, "b", -600.0)
    for part in ("a", "b"):
        handle(session, part)
    session.advance(session.committed[-1].answer["arrivals"][1]["until_s"] + 0.2)


def seen_at_the_tool(session: assur.Session) -> None:
    """A part that nobody has seen before lies where another one is picked."""
    see(session, "a", -300.0)
    handle(session, "a")
    session.advance(session.committed[-1].answer["arrivals"][0]["until_s"])
    see(session, "b", -280.0)
    session.advance(session.clock_s + 0.2)


@pytest.mark.parametrize(
    ("patch", "play", "kind", "about"),
    [
        (_no_horizon, two_parts, "refuge", "place"),
        (_no_look_at_the_clock, late, "late", "commit 1"),
        (_planning_takes_no_time, soon, "late", "planning 1"),
        (_any_start, stale, "jump", "q"),
        (_without_part, into_one_slot, "parts", "a is left out"),
        (_without_part, into_one_slot, "hit", "b, a"),
        (_known_exactly, two_parts, "known", "a, position"),
        (_elsewhere, two_parts, "place", "b"),
        (_no_proof_needed, wait, "uncovered", "the clock"),
        (lambda _: None, seen_at_the_tool, "hit", "a, b"),
    ],
)
def test_each_fault_that_is_made_on_purpose_is_found(
    patch: Callable[[Patch], None],
    play: Callable[[assur.Session], None],
    kind: str,
    about: str,
    monkeypatch: Patch,
    tmp_path: Path,
) -> None:
    patch(monkeypatch)
    found = played(tmp_path / "run.mcap", play)
    assert about in found.get(kind, []), json.dumps(found, indent=1)


def test_a_part_that_is_counted_twice_is_found(tmp_path: Path) -> None:
    """The log is changed: the part that was put down is listed where it was seen."""
    path = tmp_path / "run.mcap"
    assert played(path, two_parts) == {}
    document, read = read_log(path)
    events = list(read)
    plan = [each for each in events if each["call"] == "commit"][1]["result"]["request"]
    body = next(each for each in plan["bodies"] if each["name"] == "a")
    body["pose"] = at(-300.0)
    plan["bodies"].append({**body, "name": "ghost"})
    kinds = [(each.kind, each.about) for each in broken_sessions(document, events)]
    assert {("place", "a"), ("parts", "ghost is not there")} <= set(kinds)


def test_the_faults_are_refused_by_the_session_itself(tmp_path: Path) -> None:
    """Without the changes of the tests above none of these comes to be."""
    for play in (wait, late, stale, soon):
        with pytest.raises(assur.AssurError):
            played(tmp_path / "run.mcap", play)
