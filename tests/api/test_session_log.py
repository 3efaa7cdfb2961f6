"""The log of a session: what was called is in it, other tools read it, and it is replayed to the same plans."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from mcap_ros2.writer import Writer

import assur
from assur.planner.errors import InputError
from assur.scenes.session.log import CALLS, CELL, STATES, STEP_S, TEXT
from tests.api.test_session import PARTS, START, at, kept, transfer

Document = dict[str, Any]


def recorded(path: Path) -> assur.Session:
    """A session with a chain of three transfers, refused calls among them, which is logged and closed."""
    with assur.Session(kept(), start=START, refuge="home", log=path) as session:
        for name, along_mm in PARTS.items():
            session.see(name, kind="bracket", pose=at(along_mm))
        with pytest.raises(InputError):
            session.gone("nobody")
        for part in PARTS:
            if part == "c":
                session.gone("a")
            made = session.propose([transfer(part)])
            session.commit(made)
            with pytest.raises(InputError, match="not committed yet"):
                session.commit(made)
            session.advance(made.starts_s)
        assert session.holds({"frame": "belt", "along_mm": 150 * session.clock_s}).holds
        with pytest.raises(InputError):
            session.advance(float("nan"))
        session.advance(session.clock_s + 0.5)
    return session


def messages(path: Path, topic: str) -> list[Any]:
    with path.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        return [each[3] for each in reader.iter_decoded_messages(topics=[topic], log_time_order=False)]


def calls(path: Path) -> list[Document]:
    return [json.loads(each.data) for each in messages(path, CALLS)]


def rewritten(path: Path, change: Callable[[list[Document]], None]) -> Path:
    """The log with other calls."""
    events, found = calls(path), path.with_name("rewritten.mcap")
    change(events)
    with found.open("wb") as file, Writer(file) as writer:
        writer.add_attachment(0, 0, CELL, "application/json", json.dumps(kept().document).encode())
        text = writer.register_msgdef("std_msgs/msg/String", TEXT)
        for event in events:
            writer.write_message(CALLS, text, {"data": json.dumps(event)}, 0)
    return found


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, assur.Session]:
    path = tmp_path_factory.mktemp("log") / "run.mcap"
    return path, recorded(path)


def test_all_calls_are_in_the_log_and_those_that_are_refused(log: tuple[Path, assur.Session]) -> None:
    events = calls(log[0])
    of_part = ["propose", "commit", "commit", "advance"]
    assert [each["call"] for each in events] == [
        "session", *["see"] * 3, "gone", *of_part, *of_part, "gone", *of_part, "covered", "advance", "advance"
    ]  # fmt: skip
    assert [k for k, each in enumerate(events) if "refused" in each] == [4, 7, 11, 16, 19]
    assert [each["clock_s"] for each in events] == sorted(each["clock_s"] for each in events)
    plans = [each["result"] for each in events if each["call"] in ("session", "commit") and "result" in each]
    assert len(plans) == 4
    for plan in plans:
        assert plan["answer"]["elapsed_s"] == 0.0
        assert assur.check(plan["request"], plan["answer"])["ok"]


def test_the_states_of_the_joints_are_those_of_the_plans(log: tuple[Path, assur.Session]) -> None:
    path, session = log
    states, last = messages(path, STATES), session.committed[-1]
    times = np.array([each.header.stamp.sec + 1e-9 * each.header.stamp.nanosec for each in states])
    assert np.abs(np.diff(times) - STEP_S).max() < 1e-8
    assert times[0] == pytest.approx(STEP_S)
    assert times[-1] == pytest.approx(session.clock_s, abs=STEP_S)
    compared = 0
    for time, state in zip(times.tolist(), states, strict=True):
        if time > last.starts_s:
            there = last.answer.trajectory.at(round(time, 9))
            assert list(state.name) == ["j1", "j2", "j3", "j4"]
            assert np.abs(np.array(state.position) - there.positions).max() < 1e-9
            assert np.abs(np.array(state.velocity) - there.velocities).max() < 1e-7
            compared += 1
    assert compared > 20


def test_the_same_calls_give_the_same_log_to_the_bit_and_a_replay_gives_all_of_it(
    log: tuple[Path, assur.Session], tmp_path: Path
) -> None:
    recorded(tmp_path / "again.mcap")
    assert (tmp_path / "again.mcap").read_bytes() == log[0].read_bytes()
    found = assur.replay(log[0])
    assert found.same
    assert (found.calls, found.difference) == (len(calls(log[0])), None)


def of(events: list[Document], call: str) -> Document:
    return next(each for each in events if each["call"] == call)


@pytest.mark.parametrize(
    ("change", "difference"),
    [
        (lambda e: of(e, "commit")["result"].update(starts_s=9.0), "commit.result.starts_s is 9.0 in the log, and"),
        (
            lambda e: of(e, "session")["result"]["answer"].update(duration_s=9.0),
            "session.result.answer.duration_s is 9",
        ),
        (lambda e: of(e, "propose")["arguments"].update(steps=[]), "propose.result.base_ends_s is"),
        (lambda e: of(e, "see").update(refused="x"), "see.refused is only in the log"),
        (lambda e: of(e, "gone").update(refused="x"), 'gone.refused is "x" in the log, and "name: got'),
        (lambda e: e.remove(of(e, "commit")), "commit.refused is only in the log"),
        (lambda e: of(e, "session")["arguments"].update(refuge="moon"), "the session is refused: refuge: got 'moon'"),
    ],
)
def test_a_replay_says_what_differs_first(
    log: tuple[Path, assur.Session], change: Callable[[list[Document]], None], difference: str
) -> None:
    found = assur.replay(rewritten(log[0], change))
    assert not found.same
    assert difference in str(found.difference)


@pytest.mark.parametrize(
    "change",
    [
        list.clear,
        lambda e: e.pop(0),
        lambda e: e.insert(1, 3),
        lambda e: of(e, "see").update(call="__init__"),
        lambda e: of(e, "see").update(call=["see"]),
        lambda e: of(e, "see")["arguments"].update(more=1),
        lambda e: of(e, "see").update(arguments=[]),
        lambda e: of(e, "see")["arguments"].update(fields=7),
        lambda e: of(e, "propose")["arguments"].update(steps=7),
        lambda e: of(e, "session")["arguments"].pop("refuge"),
    ],
)
def test_calls_that_no_session_has_are_refused(
    log: tuple[Path, assur.Session], change: Callable[[list[Document]], None]
) -> None:
    with pytest.raises(InputError, match=r"rewritten\.mcap'; allowed: the log of a session"):
        assur.replay(rewritten(log[0], change))


def test_a_file_that_is_no_log_or_that_is_damaged_is_refused(log: tuple[Path, assur.Session], tmp_path: Path) -> None:
    whole, path = log[0].read_bytes(), tmp_path / "cut.mcap"
    changed = bytearray(whole)
    changed[len(whole) // 2] ^= 1
    for content in (b"", b"text", whole[:8], whole[:100], whole[: len(whole) // 2], whole[:-10], bytes(changed)):
        path.write_bytes(content)
        with pytest.raises(InputError, match=r"cut\.mcap'; allowed: the log of a session"):
            assur.replay(path)
    with pytest.raises(FileNotFoundError):
        assur.replay(tmp_path / "none.mcap")


def test_a_session_that_is_refused_leaves_no_open_log_and_one_that_is_closed_goes_on(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="refuge"):
        assur.Session(kept(), start=START, refuge="moon", log=tmp_path / "refused.mcap")
    with pytest.raises(InputError, match="one call at least"):
        assur.replay(tmp_path / "refused.mcap")
    session = assur.Session(kept(), start=START, refuge="home", log=tmp_path / "short.mcap")
    session.close()
    session.close()
    session.advance(0.5)
    assert assur.replay(tmp_path / "short.mcap").calls == 1
    with pytest.raises(FileNotFoundError):
        assur.Session(kept(), start=START, refuge="home", log=tmp_path / "no" / "folder.mcap")


def test_without_the_library_a_log_says_how_it_is_installed(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setitem(sys.modules, "mcap_ros2", None)
    for name in ("mcap_ros2.decoder", "mcap_ros2.writer", "assur.scenes.session.log"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    with pytest.raises(ModuleNotFoundError, match=r"pip install 'assur\[log\]'"):
        assur.Session(kept(), start=START, refuge="home", log=tmp_path / "run.mcap")
    assert not (tmp_path / "run.mcap").exists()
