"""Streams of a cell: what comes and when follows from the cell and a seed alone, and what is wrong is named."""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import assur
from assur.scenes.faults import Gathered, located
from assur.scenes.reading.frames import frames_of
from assur.scenes.schema.cell_file import CellDocument
from assur.scenes.schema.read import read
from assur.scenes.streams.arrivals import ArrivingPart, arrivals
from assur.scenes.streams.stream import Stream, streams_of
from tests.refused import refused_at

Document = dict[str, Any]
CELL: Document = {
    "schema": "assur-cell/1",
    "robot": {"model": "mitsubishi-rh-6frh5520", "tool": {"tcp_mm": [0, 0, -100]}},
    "frames": {
        "belt": {"conveyor": {"at_mm": [0, 350, 50], "speed_mm_s": 200}},
        "stopped": {"conveyor": {"at_mm": [0, 350, 50], "speed_mm_s": 0}},
        "backwards": {"conveyor": {"at_mm": [0, 350, 50], "speed_mm_s": -200}},
        "ramps": {"conveyor": {"speed_mm_s": 200, "changes": [{"at_s": 3, "speed_mm_s": 100}]}},
        "short": {"conveyor": {"speed_mm_s": 200}, "valid_s": [0, 10]},
        "table": {"fixed": {}},
    },
    "kinds": {
        "bar": {"shape": {"box": {"size_mm": [60, 80, 20]}}},
        "disc": {"shape": {"cylinder": {"radius_mm": 20, "height_mm": 10}}, "uncertainty": {"position_mm": 2}},
    },
    "slots": {"box": {"at_mm": [300, -230, 60]}, "tray": {"at_mm": [-300, -230, 60]}},
}
STREAM: Document = {
    "frame": "belt",
    "kind": "bar",
    "at_mm": [-900, 0, 10],
    "every_s": 1.0,
    "seen": {"at_mm": -600, "latency_ms": 80},
    "to": "box",
    "window_mm": [-250, 250],
}
MANY = 200.0
"""Seconds that have many parts."""


def cell(changes: Document | None = None, **streams: Document) -> Document:
    own = {key: value for key, value in {**STREAM, **(changes or {})}.items() if value is not None}
    return {**CELL, "streams": {"bars": own, **streams}}


def found(document: Document) -> tuple[Stream, ...]:
    faults = Gathered()
    with located(document):
        valid = read(CellDocument, document)
        made = streams_of(valid, frames_of(valid.frames, faults), faults)
        faults.settle()
    return made


def coming(changes: Document | None = None, seed: int = 1, until_s: float = MANY) -> tuple[ArrivingPart, ...]:
    return arrivals(found(cell(changes))[0], seed, until_s)


MEAN: Document = {"every_s": None, "mean_s": 1.2}
RANDOM: Document = {**MEAN, "lane_mm": [-20, 30], "yaw_deg": [-30, 60], "kind": None, "kinds": {"bar": 3, "disc": 1}}


def test_a_regular_stream_brings_a_part_every_second_and_each_is_known_after_line_and_latency() -> None:
    parts = coming()
    assert [part.time_s for part in parts] == [float(k) for k in range(len(parts))]
    assert [part.name for part in parts[:2]] == ["bars-1", "bars-2"]
    for part in parts:
        assert part.seen_s == pytest.approx(part.time_s + 0.3 / 0.2, abs=1e-12)
        assert part.known_s == pytest.approx(part.seen_s + 0.08, abs=1e-12)
        assert part.passes_s(-0.6, 0.2) == pytest.approx(part.seen_s)
        assert (part.x_m, part.y_m, part.yaw_rad) == (-0.9, 0.0, 0.0)
    assert len(parts) == math.floor(MANY - 1.58) + 1


def test_the_same_seed_is_the_same_stream_whatever_other_streams_there_are() -> None:
    alone = arrivals(found(cell(RANDOM))[0], 7, MANY)
    beside = {**STREAM, "mean_s": 0.9}
    del beside["every_s"]
    several = found({**cell(RANDOM), "streams": {"more": beside, **cell(RANDOM)["streams"]}})
    assert [each.name for each in several] == ["more", "bars"]
    assert arrivals(several[1], 7, MANY) == alone
    assert arrivals(several[0], 7, MANY)[0].time_s != alone[0].time_s
    assert arrivals(several[1], 8, MANY) != alone


def test_a_longer_time_only_adds_parts() -> None:
    for changes in ({}, RANDOM, {**RANDOM, "batch": {"count": 2, "apart_s": 0.2}, "mean_s": 3}, {"jitter_s": 0.3}):
        parts = coming(changes)
        assert parts == coming(changes, until_s=2 * MANY)[: len(parts)]


def test_no_two_parts_of_one_lane_overlap_and_lanes_that_are_apart_do_not_wait_for_each_other() -> None:
    gap_s = 2 * math.hypot(30, 40) / 200
    busy = {**MEAN, "mean_s": 0.6}
    times = sorted(part.time_s for part in coming(busy))
    assert min(b - a for a, b in pairwise(times)) >= gap_s - 1e-9
    assert sum(b - a < gap_s + 1e-9 for a, b in pairwise(times)) > 50
    parts = coming({**busy, "lanes_mm": [-60, 60]})
    for lane in (-0.06, 0.06):
        own = sorted(part.time_s for part in parts if part.y_m == lane)
        assert len(own) > 100
        assert min(b - a for a, b in pairwise(own)) >= gap_s - 1e-9
    every = sorted(part.time_s for part in parts)
    assert min(b - a for a, b in pairwise(every)) < 0.1 * gap_s


@pytest.mark.parametrize("changes", [MEAN, {"every_s": 1.5, "batch": {"count": 2, "apart_s": 0.1}}])
def test_parts_of_one_lane_keep_the_gap_that_is_stated(changes: Document) -> None:
    made = found(cell({**changes, "gap_mm": 30}))[0]
    times = sorted(part.time_s for part in arrivals(made, 1, MANY))
    assert min(b - a for a, b in pairwise(times)) == pytest.approx((2 * math.hypot(30, 40) + 30) / 200)
    assert made.least_gap_m == 0.03


@pytest.mark.parametrize(
    ("changes", "gap_m"),
    [
        ({}, 0.1),
        ({"jitter_s": 0.1}, 0.06),
        ({"jitter_s": 0.1, "gap_mm": 80}, 0.08),
        ({"jitter_s": 0.4}, 0.0),
        (MEAN, 0.0),
        ({"every_s": 3, "batch": {"count": 2, "apart_s": 0.6}}, 0.02),
        ({"every_s": 3, "batch": {"count": 2, "apart_s": 2.4}}, 0.02),
    ],
)
def test_how_near_parts_of_one_lane_may_come_follows_from_their_times(changes: Document, gap_m: float) -> None:
    """Bars are 100 mm from corner to corner."""
    made = found(cell(changes))[0]
    assert made.least_gap_m == pytest.approx(gap_m)
    times = sorted(part.time_s for part in arrivals(made, 1, MANY))
    assert min(b - a for a, b in pairwise(times)) >= (0.1 + gap_m) / 0.2 - 1e-9
    assert found(cell(table(TABLE)))[0].least_gap_m is None


def test_places_yaw_kinds_and_times_have_the_distribution_that_is_stated() -> None:
    parts = coming(RANDOM, until_s=3_000.0)
    y, yaw = np.array([part.y_m for part in parts]), np.array([part.yaw_rad for part in parts])
    assert (y.min(), y.max()) == (pytest.approx(-0.02, abs=1e-3), pytest.approx(0.03, abs=1e-3))
    assert y.mean() == pytest.approx(0.005, abs=2e-3)
    assert np.degrees([yaw.min(), yaw.max()]) == pytest.approx([-30, 60], abs=1)
    assert np.mean([part.kind.name == "disc" for part in parts]) == pytest.approx(0.25, abs=0.04)
    assert len(parts) == pytest.approx(3_000 / 1.2, rel=0.05)


def test_jitter_moves_each_part_by_at_most_so_much() -> None:
    parts = coming({"jitter_s": 0.25})
    off = np.array([part.time_s - k for k, part in enumerate(parts)])
    assert 0.2 < abs(off).max() <= 0.25
    assert abs(off.mean()) < 0.05


def test_a_batch_brings_its_parts_one_after_the_other() -> None:
    parts = coming({"every_s": 5, "batch": {"count": 3, "apart_s": 0.7}})
    assert [part.time_s for part in parts[:5]] == pytest.approx([0, 0.7, 1.4, 5, 5.7])


TABLE = "time_ms,x_mm,y_mm,yaw_deg,kind\n# a comment\n0,-900,5,10,bar\n\n1500,-880,-5,0,disc\n"


def table(text: str, **changes: Any) -> Document:
    more = {"kind": None, "kinds": {"bar": 1, "disc": 1}, **changes}
    return {**more, "every_s": None, "csv": {"text": text}}


def test_a_table_states_each_part_and_its_file_is_read_with_the_cell(tmp_path: Path) -> None:
    parts = coming(table(TABLE))
    assert [(part.time_s, part.x_m, part.y_m, part.kind.name) for part in parts] == [
        (0.0, -0.9, 0.005, "bar"),
        (1.5, -0.88, -0.005, "disc"),
    ]
    assert parts[0].yaw_rad == math.radians(10)
    assert parts[1].seen_s == pytest.approx(1.5 + 0.28 / 0.2)
    (tmp_path / "arrivals.csv").write_text(TABLE, encoding="utf-8")
    written = cell(table(TABLE))
    written["streams"]["bars"]["csv"] = {"file": "arrivals.csv"}
    import yaml

    (tmp_path / "cell.yaml").write_text(yaml.safe_dump(written), encoding="utf-8")
    read_back = assur.load(tmp_path / "cell.yaml")
    assert arrivals(found(read_back)[0], 1, MANY) == parts
    for name, text in (("empty.csv", b" "), ("binary.csv", b"\xff\xfe")):
        (tmp_path / name).write_bytes(text)
        written["streams"]["bars"]["csv"] = {"file": name}
        (tmp_path / "cell.yaml").write_text(yaml.safe_dump(written), encoding="utf-8")
        with refused_at("streams.bars.csv.file"):
            assur.load(tmp_path / "cell.yaml")
    for name in ("none.csv", "../arrivals.csv", "/etc/passwd"):
        written["streams"]["bars"]["csv"] = {"file": name}
        (tmp_path / "cell.yaml").write_text(yaml.safe_dump(written), encoding="utf-8")
        with refused_at("streams.bars.csv.file"):
            assur.load(tmp_path / "cell.yaml")


@pytest.mark.parametrize(
    ("text", "allowed"),
    [
        ("x_mm,y_mm\n1,2\n", "titles"),
        ("time_s,x_mm,y_mm,x_m\n1,2,3,4\n", "titles"),
        ("time_s,x_mm,y_mm,colour\n1,2,3,red\n", "titles"),
        ("time_s,x_mm,y_mm\n", "a row for each part"),
        ("time_s,x_mm,y_mm\n0,-900\n", "line 2 of the table 3 values"),
        ("time_s,x_mm,y_mm\n0,-900,nan\n", "line 2 of the table a finite number for y_m"),
        ("time_s,x_mm,y_mm\n0,inf,0\n", "a finite number for x_m"),
        ("time_s,x_mm,y_mm\n0,1e9,0\n", "a finite number for x_m"),
        ("time_s,x_mm,y_mm\nsoon,-900,0\n", "there is 'soon'"),
        ("time_s,x_mm,y_mm\n2,-900,0\n1,-900,0\n", "line 3 of the table a time of 2 s or later"),
        ("time_s,x_mm,y_mm,kind\n0,-900,0,brick\n", "a kind of this stream"),
        ('time_s,x_mm,y_mm\n0,-900,"0\n', "CSV"),
    ],
)
def test_what_is_wrong_in_a_table_is_named_with_its_line(text: str, allowed: str) -> None:
    with refused_at("streams.bars.csv", allowed):
        found(cell(table(text)))


def test_a_part_of_a_table_that_comes_behind_the_line_is_never_seen() -> None:
    with refused_at("streams.bars.seen.at_mm", "that of line 2 comes at -500 mm"):
        found(cell(table("time_s,x_mm,y_mm\n0,-500,0\n")))
    with refused_at("streams.bars.csv.file", "assur.load"):
        found(cell(table("") | {"csv": {"file": "arrivals.csv"}}))


@pytest.mark.parametrize(
    ("changes", "field", "allowed"),
    [
        ({"frame": "bolt"}, "frame", "did you mean belt"),
        ({"frame": "table"}, "frame", "the name of a conveyor"),
        ({"frame": "stopped"}, "frame", "a speed above 0: stopped has 0 mm/s"),
        ({"frame": "backwards"}, "frame", "a speed above 0: backwards has -200 mm/s"),
        ({"frame": "ramps"}, "frame", "without changes"),
        ({"frame": "short"}, "frame", "valid_s"),
        ({"kind": "bare"}, "kind", "did you mean bar"),
        ({"kind": None, "kinds": {"bar": 1, "brick": 1}}, "kinds.brick", "one of the kinds"),
        ({"kind": None, "kinds": {"bar": 0}}, "kinds.bar", ""),
        ({"kind": None, "kinds": {}}, "kinds", ""),
        ({"kind": None}, "", "exactly one of kind, kinds"),
        ({"to": "bix"}, "to", "did you mean box"),
        ({"to": {"disc": "box"}}, "to", "slots for bar"),
        ({"to": {"bar": "bix"}}, "to.bar", "did you mean box"),
        ({"to": {"bar": "box", "disc": "tray"}}, "to.disc", "kinds of this stream"),
        ({"to": 3}, "to", "text, or a mapping"),
        ({"to": ["box"]}, "to", "text, or a mapping"),
        ({"to": {}}, "to", "at least 1 item"),
        ({"to": "bo x"}, "to", "a name: a letter"),
        ({"to": {"bar": 3}}, "to.bar", "text"),
        ({"to": {"b ar": "box"}}, "to.b ar", "a name: a letter"),
        ({"every_s": 0.49}, "every_s", "0.5 s or more"),
        ({"every_s": math.nan}, "every_s", ""),
        ({"every_s": 0}, "every_s", ""),
        ({"every_s": None}, "", "exactly one of every_s, mean_s, csv"),
        ({**MEAN, "mean_s": 0.4}, "mean_s", "0.5 s or more"),
        ({**MEAN, "jitter_s": 0.1}, "jitter_s", "at most one"),
        ({"mean_s": 2}, "mean_s", "exactly one"),
        ({"jitter_s": 0.6}, "jitter_s", "at most 0.5 s"),
        ({"jitter_s": -1}, "jitter_s", ""),
        ({"batch": {"count": 3, "apart_s": 0.1}}, "every_s", "1.5 s or more"),
        ({"every_s": 3, "batch": {"count": 3, "apart_s": 1.6}}, "batch", "over before the next"),
        ({**MEAN, "mean_s": 0.9, "gap_mm": 100}, "mean_s", "1 s or more"),
        ({"every_s": 0.9, "gap_mm": 100}, "every_s", "or have less than the gap of 100 mm between them"),
        ({"gap_mm": -1}, "gap_mm", "at least 0"),
        ({"gap_mm": math.nan}, "gap_mm", ""),
        ({"every_s": None, "csv": {"text": "time_s,x_mm,y_mm\n0,-900,0\n"}, "gap_mm": 5}, "gap_mm", "at most one"),
        ({"batch": {"count": 0, "apart_s": 1}}, "batch.count", ""),
        ({"lane_mm": [20, -20]}, "lane_mm", "the least first"),
        ({"lane_mm": [0, 1], "lanes_mm": [0]}, "lanes_mm", "at most one"),
        ({"yaw_deg": [20, -20]}, "yaw_deg", "the least first"),
        ({"window_mm": [250, -250]}, "window_mm", "the least x first"),
        ({"window_mm": [250, 250]}, "window_mm", "the least x first"),
        ({"seen": {"at_mm": -901}}, "seen.at_mm", "-900 mm or more"),
        ({"seen": {"at_mm": 300}}, "seen.at_mm", "their window ends at 250 mm"),
        ({"seen": {"at_mm": -600, "latency_s": 4.25}}, "seen.at_mm", "parts are known when they are at 250 mm"),
        ({"seen": {"at_mm": math.inf}}, "seen.at_mm", ""),
        ({"seen": {"at_mm": -600, "latency_s": -1}}, "seen.latency_s", ""),
        ({"colour": "red"}, "colour", ""),
    ],
)  # fmt: skip
def test_what_is_wrong_in_a_stream_is_named(changes: Document, field: str, allowed: str) -> None:
    with refused_at(f"streams.bars.{field}".rstrip("."), allowed):
        found(cell(changes))


@pytest.mark.parametrize("to", [3, True, ["box"], {}, {"bar": 3}, {"b ar": "box"}, "bo x"])
def test_slots_that_are_no_name_and_no_mapping_are_one_fault(to: object) -> None:
    with pytest.raises(assur.InputError) as caught:
        found(cell({"to": to}))
    assert len(caught.value.errors) == 1


def test_all_streams_are_read_and_all_faults_are_named() -> None:
    with pytest.raises(assur.InputError) as caught:
        found(cell({"frame": "bolt"}, more={**STREAM, "kind": "brick"}))
    assert [each["field"] for each in caught.value.errors] == ["streams.bars.frame", "streams.more.kind"]
    with refused_at("selection", "look-ahead"):
        read(CellDocument, {**CELL, "selection": "best"})


def test_the_name_of_a_stream_is_short_enough_for_its_parts() -> None:
    found({**CELL, "streams": {48 * "s": STREAM}})
    with refused_at(f"streams.{49 * 's'}", "up to 48 characters"):
        found({**CELL, "streams": {49 * "s": STREAM}})


def test_streams_change_no_request_of_the_cell() -> None:
    task: Document = {"start": {"joints": {"j1_deg": 20, "j2_deg": 60, "j3_mm": 300, "j4_deg": 0}}}
    task["steps"] = [{"move": {"to": {"at_mm": [350, 0, 180], "yaw_deg": 0}}}]
    more = {**cell(), "selection": "fifo", "refuge": "home", "positions": {"home": {"at_mm": [350, 0, 180]}}}
    assert assur.Cell(more).request(**task) == assur.Cell(CELL).request(**task)
