"""A record is only ever lowered, and only by an answer in which nothing is found."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from benchmarks.best_known import PATH, SCHEMA, Known, RaisedError, found, main, merged, read, write
from benchmarks.figures import Figure
from benchmarks.judged import SETS, label, problem_set
from benchmarks.sections import durations
from tests.benchmarks.made_up import line


def record(duration_s: float, by: str = "x", searched_s: float = 0.0) -> dict[str, object]:
    return {"duration_s": duration_s, "by": by, "commit": None, "searched_s": searched_s}


def known(**durations: float) -> Known:
    return {"static": {name: record(duration) for name, duration in durations.items()}}


def test_a_merge_keeps_the_shorter_of_two_whoever_comes_first() -> None:
    one, other = known(A000=0.5, A001=0.6), known(A000=0.4, A001=0.7, A002=0.8)
    both, lowered = merged(one, other)
    assert {name: it["duration_s"] for name, it in both["static"].items()} == {"A000": 0.4, "A001": 0.6, "A002": 0.8}
    assert lowered == ["static/A000", "static/A002"]
    assert merged(other, one)[0]["static"].keys() == both["static"].keys()
    assert {n: r["duration_s"] for n, r in merged(other, one)[0]["static"].items()} == {
        n: r["duration_s"] for n, r in both["static"].items()
    }
    assert one == known(A000=0.5, A001=0.6)  # neither is touched
    assert merged(both, known(A000=0.4)) == (both, [])


def test_a_merge_remembers_the_longest_search_whichever_found_the_record() -> None:
    slow = {"static": {"A000": record(0.5, "long", 90.0)}}
    both, lowered = merged(slow, known(A000=0.4))
    assert lowered == ["static/A000"]
    assert (both["static"]["A000"]["by"], both["static"]["A000"]["searched_s"]) == ("x", 90.0)
    both, lowered = merged(known(A000=0.4), slow)
    assert lowered == []
    assert (both["static"]["A000"]["by"], both["static"]["A000"]["searched_s"]) == ("x", 90.0)


@pytest.mark.parametrize("duration", [0.0, -1.0, math.nan])
def test_a_duration_that_is_none_is_no_record(duration: float, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="A000"):
        merged({}, known(A000=duration))
    with pytest.raises(ValueError, match="A000"):
        merged(known(A000=0.5), known(A000=duration))
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
    assert read(path) == known(A000=0.4, A001=0.6)


def test_a_file_of_another_form_is_no_file_of_records(tmp_path: Path) -> None:
    path = tmp_path / "known.json"
    path.write_text("[]", encoding="utf-8")
    with pytest.raises(ValueError, match=SCHEMA):
        read(path)


def test_only_answers_in_which_nothing_is_found_are_records() -> None:
    unchecked = line()
    del unchecked["findings"]
    answers = {"A": line(duration_s=0.5), "B": line(findings=["collision"]), "C": line(None), "D": unchecked}
    new = found("static", answers, "x", 30.0)
    assert list(new["static"]) == ["A"]
    assert new["static"]["A"] | {"commit": None} == record(0.5, "x", 30.0)
    assert found("static", {"B": answers["B"]}, "x") == {}


def test_the_records_of_the_repository_are_of_problems_that_exist() -> None:
    ids = {label(name, match): {str(p["id"]) for p in problem_set(name).problems} for name, match in SETS}
    for name, records in read(PATH).items():
        assert set(records) <= ids[name]
        assert all(set(it) == {"duration_s", "by", "commit", "searched_s"} for it in records.values())


def test_a_ratio_is_only_formed_against_records_that_were_searched_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "known.json"
    monkeypatch.setattr(durations, "PATH", path)
    parameters = durations.SECTION.parameters(True)
    records = {item.name: line(duration_s=0.5) for item in durations.SECTION.items(parameters)}

    def figures() -> dict[str, Figure]:
        return {figure.name: figure for figure in durations.summary(parameters, records).figures}

    name = "static: duration at 0.2 s over the best known, median"
    assert figures()[name].value is None
    assert "no record" in str(figures()[name].refused)
    write(path, known(A000=0.4))  # found on the way
    assert figures()[name].value is None
    write(path, {"static": {"A000": record(0.4, "long", 90.0), "A010": record(0.6, "long", 90.0)}})
    assert figures()[name].value == pytest.approx((0.5 / 0.4 + 1.0) / 2)  # this run is shorter for A010
    assert figures()["moving goal: duration at 0.2 s over the best known, median"].value is None
    durations.lower_records(parameters, records)
    after = read(path)["static"]
    assert (after["A000"]["duration_s"], after["A010"]["duration_s"]) == (0.4, 0.5)
    assert after["A010"]["searched_s"] == 90.0
    assert after["A020"]["searched_s"] == 0.0


def test_the_curve_is_of_the_problems_that_every_budget_solves_and_of_clean_answers() -> None:
    groups = {
        "0.1": {"A": line(duration_s=0.6), "B": line(None), "C": line(duration_s=0.9)},
        "1": {"A": line(duration_s=0.5), "B": line(duration_s=2.0), "C": line(duration_s=0.8)},
    }
    curve = durations.points(groups, {"A": 0.5, "B": 1.0})
    assert curve["0.1"] == {"median": 1.2, "p95": 1.2, "problems": 1, "solved": 1, "of": 2}
    assert curve["1"] == {"median": 1.0, "p95": 1.0, "problems": 1, "solved": 2, "of": 2}
    groups["1"]["C"] = line(findings=["collision"])
    curve = durations.points(groups, {"A": 0.5, "B": 1.0})
    assert (curve["1"]["median"], curve["0.1"]["median"]) == (None, 1.2)
    assert durations.points({}, {"A": 0.5}) == {}


def test_the_command_writes_records_and_goes_on_where_it_was(tmp_path: Path) -> None:
    path, work = tmp_path / "known.json", tmp_path / "work"
    main(budget_s=1.0, seeds=1, only=["A000", "B001"], limit=None, known=path, work=work)
    first = read(path)
    assert {name: list(records) for name, records in first.items()} == {"static": ["A000"], "moving bodies": ["B001"]}
    assert first["static"]["A000"]["searched_s"] == 1.0
    (progress,) = work.iterdir()
    lines = progress.read_bytes()
    path.unlink()
    main(budget_s=1.0, seeds=1, only=["A000", "B001"], limit=None, known=path, work=work)
    assert progress.read_bytes() == lines
    assert read(path) == first
