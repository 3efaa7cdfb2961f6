"""A cell and its task are opened together, drawn, planned and saved; each keeps its own text."""

from __future__ import annotations

import pytest

from tests.browser.studio_page import Studio
from tests.browser.test_studio_drawing import COUNTED, DRAWN, drawn
from tests.scenes.tasks.test_joining import CELL, TASK

pytestmark = pytest.mark.slow

SHORT = TASK.split("steps:")[0] + "steps: [{move: {to: home}}]\noptions: {stop: first, max_candidates: 50}\n"
DRAWS_TABLE = f"{DRAWN} && {DRAWN}.view && {DRAWN}.view.bodies.some((body) => body.name === 'table')"
POINTS = f"{DRAWN}.view.control_points.map((point) => point.name)"


@pytest.fixture
def both(studio: Studio) -> Studio:
    """The studio with a cell and a task, of which the task is shown."""
    assert studio.dropped(("task.yaml", SHORT.encode()), ("cell.yaml", CELL.encode()))
    studio.until(f"{DRAWS_TABLE} && {DRAWN}.view.bodies.some((body) => body.name === 'c')")
    return studio


def value_of(studio: Studio, name: str) -> str:
    return next(value for value, each in studio.own() if each == name)


def test_a_cell_and_a_task_are_drawn_planned_and_saved(both: Studio) -> None:
    assert both.text == SHORT
    assert sorted(name for _, name in both.own()) == ["cell", "task"]
    assert both.faults == ""
    both.planned()
    assert "planned" in both.page.locator("#answers figcaption").inner_text()
    assert both.saved("text") == ("task.yaml", SHORT.encode())
    assert both.saved("cell") == ("cell.yaml", CELL.encode())
    assert not both.page.locator("#answers .stale").is_visible()
    assert both.said == []


def test_the_texts_of_a_task_and_its_cell_are_chosen_in_one_drawing(both: Studio) -> None:
    both.ask(f"{DRAWN}.look('top')")
    state, points = both.ask(f"{DRAWN}.camera.state"), both.ask(POINTS)
    both.ask(COUNTED)
    for number, name in enumerate(("cell", "task", "cell"), start=1):
        both.choose(value_of(both, name))
        both.until(f"window.drawings === {number}")
        assert both.ask(f"{DRAWN}.camera.state") == state
        assert both.ask(POINTS) == points
    assert both.text == CELL
    both.planned()
    assert "task" in both.page.locator("#answers figcaption strong").inner_text()


def test_a_cell_alone_is_drawn_and_not_planned(both: Studio) -> None:
    cell = value_of(both, "cell")
    both.choose("demo")
    both.choose(cell)
    both.until(f"{DRAWS_TABLE} && JSON.stringify({POINTS}) === '[\"home\"]'")
    assert both.page.locator("#drawn").inner_text().startswith("without a task")
    both.page.click("#plan")
    both.page.wait_for_selector("#faults p")
    assert "A task is planned" in both.faults


def test_a_change_of_the_cell_counts_for_the_task_and_its_answer(both: Studio) -> None:
    both.planned()
    cell, task = value_of(both, "cell"), value_of(both, "task")
    both.choose(cell)
    both.write("size_mm: [300, 300, 50]", "size_mm: [300, 300, 60]")
    both.choose(task)
    assert both.page.locator("#answers .stale").is_visible()
    assert both.text == SHORT


def test_a_fault_of_the_cell_leads_into_its_text(both: Studio) -> None:
    cell, task = value_of(both, "cell"), value_of(both, "task")
    both.choose(cell)
    both.write("positions: {home: {at_mm: [350, 0, 150]}}", "positions: {home: {at_mm: [350, 0]}}")
    both.choose(task)
    both.page.wait_for_selector("#faults button")
    line = both.page.locator("#faults button").inner_text()
    assert line == f"cell.yaml, line {CELL[: CELL.index('positions')].count(chr(10)) + 1}"
    assert both.page.locator("#lines .fault").count() == 0
    both.page.click("#faults button")
    marked = "(({ value, selectionStart, selectionEnd }) => value.slice(selectionStart, selectionEnd))"
    assert "home" in both.ask(f"{marked}(document.getElementById('text'))")


def test_a_task_without_its_cell_says_which_file_to_open(studio: Studio) -> None:
    drawn(studio)
    studio.opened("task.yaml", SHORT)
    studio.page.wait_for_selector("#absent:not([hidden])")
    missing = "The cell cell.yaml is missing. Open it, too: then this task is drawn."
    assert studio.page.locator("#absent").inner_text() == missing
    assert not studio.page.locator("#drawing iframe").is_visible()
    studio.page.wait_for_selector("#faults p")
    assert studio.faults.startswith("line 3")
    assert '"cell.yaml"' in studio.faults
    assert "open it, too" in studio.faults
    studio.opened("cell.yaml", CELL)
    studio.until(DRAWS_TABLE)
    assert studio.text == SHORT
    assert studio.faults == ""
    assert studio.page.locator("#drawing iframe").is_visible()
    assert not studio.page.locator("#absent").is_visible()


def test_another_text_with_a_fault_has_no_picture(studio: Studio) -> None:
    drawn(studio)
    studio.opened("wrong.yaml", "about: a text\nrequest: {schema: assur/1}\n")
    studio.page.wait_for_selector("#absent:not([hidden])")
    assert studio.page.locator("#absent").inner_text() == "Nothing is drawn: the text has a fault."
    assert not studio.page.locator("#drawing iframe").is_visible()


def test_two_files_that_are_no_cell_and_task_are_refused(studio: Studio) -> None:
    before = studio.text
    assert studio.dropped(("a.yaml", CELL.encode()), ("b.yaml", CELL.encode()))
    assert "2 files" in studio.faults
    assert studio.text == before
