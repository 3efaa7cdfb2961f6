"""`assur simulate`: what it prints, writes and refuses."""

from __future__ import annotations

import html
import json
import re
from pathlib import Path

import pytest

import assur
from assur.api.cli.border import BAD_INPUT, FAULT, INTERRUPTED, RIGHT, WRONG
from assur.planner.checker.verdict import Code, Finding, Verdict
from assur.scenes.scenarios import CELLS
from assur.scenes.session.log import SessionLog, read_log
from assur.scenes.simulation.cell_file import shipped_cells
from assur.scenes.simulation.run import Run
from benchmarks.judge.sessions import broken_sessions
from tests.api.test_command_line import run

CELL = CELLS / "shared" / "soap-flow.yaml"
BRIEF = ("--minutes", "0.25")


def test_the_result_is_printed_and_written_and_the_same_as_that_of_python(tmp_path: Path) -> None:
    out = tmp_path / "result.json"
    code, output, errors = run("simulate", "soap-flow", *BRIEF, "--seeds", "2", "--out", str(out))
    assert (code, errors) == (RIGHT, "")
    written = json.loads(out.read_text(encoding="utf-8"))
    assert written == assur.simulate(assur.load(CELL), minutes=0.25, seeds=2)
    low, high = written["interval"]
    first = f"soap-flow: {written['parts_per_minute']:.1f} parts a minute (95 % interval {low:.1f} to {high:.1f})"
    assert output.splitlines()[:2] == [first, written["bottleneck"]]
    for words in (
        "seeds 1 to 2, look-ahead, elbow left",
        "waits for a part",
        "worst error of a pick",
        "travel to the slot",
        "motions checked",
        "note: parts in one lane",
    ):
        assert words in output
    code, output, _ = run("simulate", str(CELL), *BRIEF, "--seeds", "2", "--json")
    assert (code, json.loads(output)) == (RIGHT, written)


def test_a_part_in_the_air_is_noted_before_the_run_and_in_the_result() -> None:
    code, output, errors = run("simulate", "soap-flow", *BRIEF, "--set", "slots.box.at_mm=[255, -235, 68]")
    note = "note: slots.box.at_mm: soap is 3 mm from box-bottom, and rests on nothing\n"
    assert (code, errors, note in output) == (RIGHT, f"assur: {note}", True)


def test_values_are_set_and_their_faults_are_named_where_they_were_set() -> None:
    code, output, _ = run("simulate", "soap-flow", *BRIEF, "--set", 'selection="fifo"', "--json")
    assert (code, json.loads(output)["selection"]) == (RIGHT, "fifo")
    code, _, errors = run("simulate", "soap-flow", *BRIEF, "--set", "streams.soap.mean_s=0.1")
    assert code == BAD_INPUT
    assert errors.startswith("assur: --set streams.soap.mean_s: got 0.1; allowed: 0.4807 s or more")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("soap-flo",), "assur: CELL: got \"soap-flo\"; allowed: a cell file that exists, or a shipped cell"),
        (("demo",), "a shipped cell with streams: soap-flow"),
        ((str(CELLS / "demo.yaml"),), "assur: schema: it is missing; allowed: assur-cell/1: a cell with streams"),
        ((str(CELLS / "packing.yaml"),), "assur: schema: got \"assur-task/1\"; allowed: assur-cell/1"),
        ((str(CELLS / "shared" / "packing.yaml"),), "assur: streams: it is missing; allowed: at least one stream"),
        (("soap-flow", "--minutes", "nan"), "assur: minutes: "),
        (("soap-flow", "--minutes", "0"), "assur: minutes: got 0.0; allowed: 0.01 to 1440"),
        (("soap-flow", "--seeds", "0"), "assur: seeds: got 0; allowed: a whole number, 1 to 1000"),
        (("soap-flow", "--planning-ms", "-1"), "assur: planning_ms: got -1"),
        (("soap-flow", "--minutes", "0.02"), "minutes: got 0.02; allowed: so long that a part of each stream is known"),
        (("soap-flow", "--set", "stream.soap.mean_s=3"), "did you mean streams?"),
        (("soap-flow", "--out", "/"), "assur: --out: "),
        (("soap-flow", "--log", "/none/x.mcap"), "assur: --log: "),
        (("soap-flow", "--log", "x", "--page", "x"), "assur: --log: got \"x\"; allowed: another file than those"),
    ],
)  # fmt: skip
def test_what_is_not_right_is_refused_in_one_line(arguments: tuple[str, ...], words: str) -> None:
    code, output, errors = run("simulate", *arguments)
    assert (code, output) == (BAD_INPUT, "")
    assert words in errors


def test_a_fault_of_the_cell_has_its_line_and_json_is_read_too(tmp_path: Path) -> None:
    file = tmp_path / "cell.yaml"
    file.write_text(CELL.read_text(encoding="utf-8").replace("kind: soap", "kind: sop"), encoding="utf-8")
    code, _, errors = run("simulate", str(file))
    assert (code, errors.startswith('assur: line 29: streams.soap.kind: got "sop"')) == (BAD_INPUT, True)
    (tmp_path / "cell.json").write_text(json.dumps(assur.load(CELL)), encoding="utf-8")
    code, output, _ = run("simulate", str(tmp_path / "cell.json"), *BRIEF, "--json")
    assert (code, json.loads(output)["complete"]) == (RIGHT, True)


def interrupted_after(clock_s: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """From now on a run is interrupted, as by Ctrl-C, when its clock is behind this time."""
    step = Run.step

    def interrupted(own: Run) -> None:
        if own.session.clock_s > clock_s:
            raise KeyboardInterrupt
        step(own)

    monkeypatch.setattr(Run, "step", interrupted)


def test_an_interrupted_simulation_prints_what_there_is(monkeypatch: pytest.MonkeyPatch) -> None:
    interrupted_after(6.0, monkeypatch)
    code, output, errors = run("simulate", "soap-flow", "--minutes", "30", "--json")
    assert (code, errors) == (INTERRUPTED, "assur: interrupted: these are the figures until then\n")
    found = json.loads(output)
    assert not found["complete"]
    assert 6.0 < found["runs"][0]["simulated_s"] < 12.0


def test_a_motion_that_is_refused_ends_the_run_as_a_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    refused = Verdict.of([Finding(Code.FORM, "the motion jumps")])
    verdicts = iter([Verdict.of([]), refused, refused])
    monkeypatch.setattr("assur.planner.checked.check", lambda *_: next(verdicts))
    code, output, errors = run("simulate", "soap-flow", *BRIEF)
    assert (code, output) == (FAULT, "")
    assert "the checker refuses the motion that begins at 0.02 s: the motion jumps" in errors


def test_the_log_of_a_run_is_replayed_and_the_page_of_it_is_that_of_its_log(tmp_path: Path) -> None:
    log, page, again = tmp_path / "run.mcap", tmp_path / "run.html", tmp_path / "again.html"
    code, output, errors = run("simulate", "soap-flow", *BRIEF, "--seeds", "2", "--log", str(log), "--page", str(page))
    assert code == RIGHT
    assert errors.startswith(f"assur: page of the first run: {page}, ")
    code, replayed, _ = run("replay", str(log), "--page", str(again))
    calls = int(re.findall(r"(\d+) calls, each gives the same again", replayed)[0])
    cell, events = read_log(log)
    every = list(events)
    assert (code, len(every)) == (RIGHT, calls)
    assert cell["streams"] == assur.load(CELL)["streams"]
    own = assur.simulate(assur.load(CELL), minutes=0.25)
    assert output.splitlines()[0].startswith("soap-flow: ")
    for text in (page.read_text(encoding="utf-8"), again.read_text(encoding="utf-8")):
        assert f"<dd>{own['picked']}, {own['placed']}</dd>" in text
    assert broken_sessions(cell, every) == []


def test_a_log_that_does_not_give_the_same_is_refused(tmp_path: Path) -> None:
    log = tmp_path / "run.mcap"
    assert run("simulate", "soap-flow", *BRIEF, "--log", str(log))[0] == RIGHT
    cell, events = read_log(log)
    changed = SessionLog(tmp_path / "other.mcap", cell)
    for event in events:
        changed.called({**event, "clock_s": event["clock_s"] + 1e-9} if event["call"] == "commit" else event)
    changed.close()
    page = tmp_path / "other.html"
    code, output, errors = run("replay", str(tmp_path / "other.mcap"), "--page", str(page))
    assert (code, output, page.exists()) == (WRONG, "", False)
    assert "commit.clock_s is" in errors
    for arguments, words in (
        ((str(tmp_path / "none"),), "assur: LOG: "),
        ((str(CELL),), "allowed: the log of a session"),
    ):
        code, output, errors = run("replay", *arguments)
        assert (code, output) == (BAD_INPUT, "")
        assert words in errors


def test_the_shipped_cells_are_those_with_streams() -> None:
    assert shipped_cells() == ("soap-flow", "tray-flow")


def test_what_would_help_is_printed_and_on_the_page_and_each_change_can_be_set(tmp_path: Path) -> None:
    own = ("--set", "streams.soap.mean_s=0.8", "--set", "kinds.soap.dwell_ms=900")
    page = tmp_path / "run.html"
    code, output, errors = run("simulate", "soap-flow", *BRIEF, *own, "--what-helps", "--page", str(page))
    assert (code, errors.startswith("assur: page of the first run: ")) == (RIGHT, True)
    assert "what would help, in parts a minute" in output
    assert "one seed: whether a difference is more than chance is not known" in output
    assert "no dwell: --set kinds.soap.dwell_ms=0\n" in output
    code, output, _ = run("simulate", "soap-flow", *BRIEF, *own, "--what-helps", "--json")
    found, shown = json.loads(output), page.read_text(encoding="utf-8")
    proved = [row for row in found["helps"] if row["percent"] is not None]
    assert "What would help<" in shown
    assert found["bottleneck"] in html.unescape(shown)
    for row in found["helps"]:
        assert f"<td>{html.escape(row['what'])}</td>" in shown
    assert "no dwell" in {row["what"] for row in proved}
    for row in proved:
        values = [text for path, value in row["set"].items() for text in ("--set", f"{path}={json.dumps(value)}")]
        code, output, _ = run("simulate", "soap-flow", *BRIEF, *own, *values, "--json")
        assert (code, json.loads(output)["parts_per_minute"]) == (RIGHT, row["parts_per_minute"])
        assert "helps" not in json.loads(output)


def test_what_would_help_is_not_tried_after_runs_that_were_interrupted(monkeypatch: pytest.MonkeyPatch) -> None:
    interrupted_after(6.0, monkeypatch)
    code, output, _ = run("simulate", "soap-flow", "--minutes", "30", "--what-helps")
    assert (code, "what would help: no change was tried" in output) == (INTERRUPTED, True)
