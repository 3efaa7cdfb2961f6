"""A run that was stopped goes on where it was; a process that dies costs its item, not the run."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from benchmarks import runner
from benchmarks.dialogue import Program, ProgramDied
from benchmarks.figures import Figure, figure
from benchmarks.machine import ROOT, machine, pin, sources
from benchmarks.progress import Progress
from benchmarks.section import Document, Item, Records, Section, Summary
from benchmarks.sections import durations, dyad, sets, side_by_side
from benchmarks.sections.all_of_them import SECTIONS
from tests.benchmarks import made_up

PARAMETERS = {"x": 1}
NAMES = ["a1", "a2", "b1", "b2"]


class StoppedError(Exception):
    """Somebody pressed the keys."""


def section(measured: list[str], stop_at: str | None = None) -> Section:
    """A section of four items in two groups, which says what it measures and stops before one of them."""

    @contextmanager
    def measuring(_parameters: Document, group: str) -> Iterator[Callable[[str], Document]]:
        def measure(item: str) -> Document:
            if item == stop_at:
                raise StoppedError
            measured.append(item)
            return {"findings": [], "group": group}

        yield measure

    def summary(_parameters: Document, records: Records) -> Summary:
        return Summary((figure("count", records, lambda rows: float(len(rows))),))

    items = [Item(name[0], name) for name in NAMES]
    return Section("made up", "", lambda _: PARAMETERS, lambda _: items, measuring, summary)


def here(section: Section, parameters: Document, group: str) -> object:
    """Measures in this process."""
    return section.measuring(parameters, group)


def test_a_stopped_run_measures_only_what_is_left_and_comes_to_the_same(tmp_path: Path) -> None:
    path, measured, ticks = tmp_path / "p.jsonl", list[str](), list[int]()
    with pytest.raises(StoppedError):
        runner.measured(section(measured, "b1"), PARAMETERS, Progress(path, PARAMETERS), lambda: ticks.append(1), here)
    assert (measured, len(ticks)) == (["a1", "a2"], 2)
    again = section(measured)
    records = runner.measured(again, PARAMETERS, Progress(path, PARAMETERS), lambda: ticks.append(1), here)
    assert measured == NAMES
    assert len(ticks) == 4
    assert list(records) == NAMES
    assert again.summary(PARAMETERS, records).figures == (Figure("count", 4.0),)


def test_a_line_that_was_cut_off_in_writing_is_measured_again(tmp_path: Path) -> None:
    path = tmp_path / "p.jsonl"
    kept = Progress(path, PARAMETERS)
    for name in NAMES:
        kept.add(name, {"findings": []})
    whole = path.read_text(encoding="utf-8")
    for cut in (1, 5, 20):
        path.write_text(whole[:-cut], encoding="utf-8")
        assert list(Progress(path, PARAMETERS).records) == NAMES[:3]
        measured: list[str] = []
        runner.measured(section(measured), PARAMETERS, Progress(path, PARAMETERS), lambda: None, here)
        assert measured == ["b2"]
        assert list(Progress(path, PARAMETERS).records) == NAMES


def test_other_parameters_sources_or_machines_begin_anew(tmp_path: Path) -> None:
    path = tmp_path / "p.jsonl"
    made = section([])
    one = runner.key(made, PARAMETERS, False)
    assert {"parameters", "sources", "machine", "sample"} <= set(one)
    Progress(path, one).add("a1", {"findings": []})
    assert list(Progress(path, one).records) == ["a1"]
    for name, other in (("parameters", {"x": 2}), ("sources", "0"), ("machine", {}), ("sample", True)):
        Progress(path, one).add("a1", {"findings": []})
        assert Progress(path, one | {name: other}).records == {}


def test_an_item_whose_process_dies_is_not_clean_and_is_measured_again_when_resumed(tmp_path: Path) -> None:
    path, measured = tmp_path / "p.jsonl", list[str]()
    made = section(measured)

    @contextmanager
    def dying(section: Section, parameters: Document, group: str) -> Iterator[Callable[[str], Document]]:
        with section.measuring(parameters, group) as measure:
            yield lambda item: {"findings": ["the measuring process died"]} if item == "a2" else measure(item)

    records = runner.measured(made, PARAMETERS, Progress(path, PARAMETERS), lambda: None, dying)
    (refused,) = made.summary(PARAMETERS, records).figures
    assert refused.value is None
    assert refused.refused is not None
    assert "a2: the measuring process died" in refused.refused
    records = runner.measured(made, PARAMETERS, Progress(path, PARAMETERS), lambda: None, here)
    assert measured == ["a1", "b1", "b2", "a2"]
    assert made.summary(PARAMETERS, records).figures[0].value == 4.0


ECHO = """
import os, sys
from benchmarks.dialogue import answer_lines
def prepare():
    print("noise of a library")
    os.write(1, b"noise of a native library\\n")
    def answer(question):
        print("more noise")
        if question.get("die"):
            os._exit(3)
        if question.get("hang"):
            import time
            time.sleep(60)
        return {"got": question}
    return {"version": "1"}, answer
answer_lines(prepare)
"""


def test_a_program_answers_line_by_line_whatever_its_libraries_print() -> None:
    with Program([sys.executable, "-c", ECHO], folder=ROOT) as program:
        assert program.greeting == {"version": "1"}
        assert program.ask({"n": 1}, 30) == {"got": {"n": 1}}
        assert program.ask({"n": 2}, 30) == {"got": {"n": 2}}


@pytest.mark.parametrize("question", [{"die": True}, {"hang": True}], ids=["dies", "hangs"])
def test_a_program_that_dies_or_hangs_is_told_and_ended(question: Document) -> None:
    with Program([sys.executable, "-c", ECHO], folder=ROOT) as program:
        with pytest.raises(ProgramDied):
            program.ask(question, 1.0)
        with pytest.raises(ProgramDied):
            program.ask({"n": 1}, 1.0)


def test_a_program_that_does_not_speak_is_no_program() -> None:
    with pytest.raises(ProgramDied, match="not JSON"):
        Program([sys.executable, "-c", "print('hello')"], folder=ROOT)
    with pytest.raises(ProgramDied, match="exit 4"):
        Program([sys.executable, "-c", "raise SystemExit(4)"], folder=ROOT)


def test_the_measuring_process_measures_a_real_section() -> None:
    parameters = dyad.SECTION.parameters(True) | {"dyads": 200, "blocks": [100, 200], "repeats": 1}
    with runner.process(dyad.SECTION, parameters, "dyad") as ask:
        record = ask("round 0")
    assert record["findings"] == []
    assert set(record["ns"]) == {"100", "200"}
    assert all(value > 0 for row in record["ns"].values() for value in row.values())


def test_a_fault_in_an_item_is_its_record_and_the_process_goes_on() -> None:
    parameters = sets.SECTION.parameters(True)
    with runner.process(sets.SECTION, parameters, "static/position/adaptive") as ask:
        wrong = ask("static/position/adaptive/A999")
        assert wrong == {"findings": ["fault: KeyError: 'A999'"]}
        assert ask("static/position/adaptive/A000")["findings"] == []
    assert sets.SECTION.again(wrong)


@pytest.mark.parametrize("section", SECTIONS, ids=[section.name for section in SECTIONS])
@pytest.mark.parametrize("finding", ["fault: ValueError: x", "the measuring process died: x"])
def test_a_record_of_a_fault_refuses_figures_in_every_section_and_breaks_nothing(
    section: Section, finding: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made_up.long_records(tmp_path / "known.json")
    for module in (durations, side_by_side):
        monkeypatch.setattr(module, "PATH", tmp_path / "known.json")
    parameters = section.parameters(True)
    items = section.items(parameters)
    records = made_up.records(section.name, parameters, items)
    before = section.summary(parameters, records)
    bad = "static/position/0.2/A000" if section.name == "durations" else items[0].name
    records[bad] = {"findings": [finding]}
    assert section.again(records[bad])
    after = section.summary(parameters, records)
    assert [one.name for one in after.figures] == [one.name for one in before.figures]
    changed = [one for one, was in zip(after.figures, before.figures, strict=True) if one != was]
    assert changed
    assert all(one.value is None and finding in str(one.refused) for one in changed)
    if section.after is not None:
        section.after(parameters, records)


def test_what_is_said_of_the_machine_names_no_host_and_no_path() -> None:
    import json
    import platform

    said = json.dumps([machine(), sources()])
    assert platform.node() not in said or platform.node() in machine()["system"]
    assert str(ROOT) not in said
    assert "/" not in said
    assert {"cpu", "cores", "python", "libraries"} <= set(machine())


def test_pinning_leaves_one_core_to_a_process_and_to_what_it_starts() -> None:
    code = "import os; from benchmarks.machine import pin; print(pin()); print(len(os.sched_getaffinity(0)))"
    import os
    import subprocess

    if hasattr(os, "sched_getaffinity"):
        ran = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
        said, cores = ran.stdout.splitlines()
        assert "sched_setaffinity" in said
        assert cores == "1"
    else:
        assert "not pinned" in pin()
