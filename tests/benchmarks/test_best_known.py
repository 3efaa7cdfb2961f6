"""A record is only ever lowered, and only by an answer in which nothing is found."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest

from benchmarks.best_known import SCHEMA, Known, RaisedError, found, main, merged, read, searched, write
from benchmarks.commits import ask


def record(duration_s: float, by: str = "x", searched_s: float = 0.0) -> dict[str, object]:
    return {"duration_s": duration_s, "by": by, "commit": None, "searched_s": searched_s}


def known(**durations: float) -> Known:
    return {"static": {name: record(duration) for name, duration in durations.items()}}


def test_a_merge_keeps_the_shorter_of_two_and_remembers_the_longest_search() -> None:
    one, other = known(A000=0.5, A001=0.6), known(A000=0.4, A001=0.7, A002=0.8)
    both, lowered = merged(one, other)
    assert {name: it["duration_s"] for name, it in both["static"].items()} == {"A000": 0.4, "A001": 0.6, "A002": 0.8}
    assert lowered == ["static/A000", "static/A002"]
    assert one == known(A000=0.5, A001=0.6)  # neither is touched
    assert merged(both, known(A000=0.4)) == (both, [])
    slow = {"static": {"A000": record(0.5, "long", 90.0)}}
    for pair in ((slow, known(A000=0.4)), (known(A000=0.4), slow)):
        kept = merged(*pair)[0]["static"]["A000"]
        assert (kept["by"], kept["searched_s"]) == ("x", 90.0)


@pytest.mark.parametrize("duration", [0.0, -1.0, math.nan])
def test_a_duration_that_is_none_is_no_record(duration: float, tmp_path: Path) -> None:
    for old in ({}, known(A000=0.5)):
        with pytest.raises(ValueError, match="A000"):
            merged(old, known(A000=duration))
    path = tmp_path / "known.json"
    path.write_text(json.dumps({"schema": SCHEMA, "records": known(A000=duration)}), encoding="utf-8")
    with pytest.raises(ValueError, match="A000"):
        read(path)


def test_the_file_can_be_lowered_and_refuses_to_be_raised_or_to_lose_a_record(tmp_path: Path) -> None:
    path = tmp_path / "known.json"
    assert read(path) == {}
    write(path, known(A000=0.5, A001=0.6))
    write(path, known(A000=0.4, A001=0.6))
    before = path.read_bytes()
    for worse in (known(A000=0.41, A001=0.6), known(A000=0.4), {}, known(A000=math.nan, A001=0.6)):
        with pytest.raises(RaisedError):
            write(path, worse)
        assert path.read_bytes() == before
    path.write_text("[]", encoding="utf-8")
    with pytest.raises(ValueError, match=SCHEMA):
        read(path)


def test_only_answers_in_which_nothing_is_found_are_records() -> None:
    good: dict[str, Any] = {"duration_s": 0.5, "findings": []}
    answers: dict[str, dict[str, Any]] = {
        "A": good,
        "B": {**good, "findings": ["collision"]},
        "C": {"findings": []},
        "D": {"duration_s": 0.5},
    }
    new = found("static", answers, "x", 30.0)
    assert list(new["static"]) == ["A"]
    assert new["static"]["A"] | {"commit": None} == record(0.5, "x", 30.0)
    assert found("static", {"B": answers["B"]}, "x") == {}


def test_a_run_goes_on_where_it_was_and_drops_a_line_that_was_cut_off(tmp_path: Path) -> None:
    path, key = tmp_path / "run.jsonl", {"budget_s": 1.0}
    assert searched(path, key) == {}
    with path.open("a", encoding="utf-8") as stream:
        stream.write('{"item": "a"}\n{"item": "b"')
    assert searched(path, key) == {"a": {"item": "a"}} == searched(path, key)
    assert searched(path, {"budget_s": 2.0}) == {}


@pytest.mark.slow
def test_the_command_writes_records_and_searches_nothing_twice(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def soon(program: Any, document: Any) -> Any:
        return ask(program, document | {"options": document["options"] | {"stop": "first", "budget_s": 60.0}})

    monkeypatch.setattr("benchmarks.best_known.ask", soon)
    path, work = tmp_path / "known.json", tmp_path / "work"
    main(budget_s=1.5, seeds=1, only=["A000"], share=None, known=path, work=work)
    first = read(path)
    (progress,) = work.iterdir()
    lines = progress.read_bytes()
    path.unlink()
    main(budget_s=1.5, seeds=1, only=["A000"], share=None, known=path, work=work)
    assert progress.read_bytes() == lines
    assert read(path) == first
