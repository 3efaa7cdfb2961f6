"""docs/examples.md shows what the planner answers now, and each of its sections is whole."""

from __future__ import annotations

import re
import runpy

import pytest

from assur.scenes.scenarios import shipped_scenarios
from tests.docs.pages import ROOT, commands, text

PAGE = "docs/examples.md"
PROGRAM = runpy.run_path(str(ROOT / "docs" / "make_examples.py"), run_name="make_examples")
ANSWER, answer_to, head = PROGRAM["ANSWER"], PROGRAM["answer_to"], PROGRAM["head"]
SHOWN = {match.group(1): match.group(0) for match in ANSWER.finditer(text(PAGE))}


@pytest.mark.parametrize("name", SHOWN)
def test_an_answer_that_is_shown_is_that_of_the_planner(name: str) -> None:
    answer = answer_to(name)
    assert f"```text\n{head(name, answer)}\n```" in SHOWN[name]


def test_a_changed_number_is_found() -> None:
    answer = answer_to("rv-m1")
    answer["duration_s"] += 0.001
    assert head("rv-m1", answer) not in SHOWN["rv-m1"]


def test_an_answer_that_the_clock_ended_is_not_shown() -> None:
    answer = answer_to("rv-m1")
    with pytest.raises(SystemExit, match="rv-m1: the clock"):
        head("rv-m1", answer | {"cut_by_clock": True})


def test_every_section_has_its_command_its_answer_and_what_to_look_at() -> None:
    sections = re.split(r"^### ", text(PAGE), flags=re.MULTILINE)[1:]
    names = [re.findall(r"<!-- answer: ([\w-]+) -->", section) for section in sections]
    assert [name for (name,) in names] == list(SHOWN)
    assert [command.line for command in commands(PAGE)] == [f"assur plan {name}" for name in SHOWN]
    for section, (name,) in zip(sections, names, strict=True):
        assert f"$ assur plan {name}\n" in section
        assert f"(../scenes/cells/{name}.yaml)" in section
        assert "*In the viewer, look at* " in section
    assert set(SHOWN) <= set(shipped_scenarios())
    assert len(SHOWN) >= 12


def test_the_examples_are_of_every_kind() -> None:
    statuses = [section.split("\n\n")[1].split(": ")[-1] for section in SHOWN.values()]
    assert statuses.count("not planned") >= 4
    reasons = set(re.findall(r"^not planned +([A-Z_]+)", text(PAGE), re.MULTILINE))
    assert reasons >= {"OUT_OF_REACH", "WINDOW_MISSED", "BODY_COLLISION", "LOAD_LIMIT"}
