"""A line of the text and a body in the drawing select each other."""

from __future__ import annotations

import pytest

from tests.browser.studio_page import Studio
from tests.browser.test_studio_cell_and_task import DRAWS_TABLE, SHORT
from tests.browser.test_studio_drawing import DRAWN, drawn
from tests.scenes.tasks.test_joining import CELL

pytestmark = pytest.mark.slow

CHOSEN = f"[...new Set({DRAWN}.renderer.chosen)].map((k) => ({DRAWN}.view.bodies[k] || {{}}).name)"
MARKED = (
    "(({ value, selectionStart, selectionEnd }) => value.slice(selectionStart, selectionEnd))"
    "(document.getElementById('text'))"
)
LABELS = (
    "[...document.querySelector('#drawing iframe').contentDocument.querySelectorAll('.label.chosen')]"
    ".map((label) => label.textContent)"
)


def caret(studio: Studio, before: str) -> None:
    at = studio.text.index(before)
    studio.page.focus("#text")
    studio.page.evaluate("(at) => document.getElementById('text').setSelectionRange(at, at)", at)


def click(studio: Studio, body: str) -> None:
    """Clicks a body in the view from above, where its middle is."""
    studio.ask(f"{DRAWN}.look('top')")
    at = studio.ask(
        f"(() => {{ const body = {DRAWN}.view.bodies.find((each) => each.name === '{body}');"
        f"return {DRAWN}.renderer.onPage({DRAWN}.tracks.bodyPose(body, 0).p); }})()"
    )
    box = studio.page.frame_locator("#drawing iframe").locator("#stage").bounding_box()
    assert box is not None
    studio.page.mouse.click(box["x"] + at["x"], box["y"] + at["y"])


def test_the_line_of_the_caret_marks_its_body_and_its_step(studio: Studio) -> None:
    drawn(studio)
    caret(studio, "radius_mm: 60")
    studio.until(f"JSON.stringify({CHOSEN}) === '[\"dial-post\"]'")
    caret(studio, "grasp_mm: [0, 0, 10]")
    studio.until(f"JSON.stringify({LABELS}) === '[\"pick-1\"]'")
    assert studio.ask(CHOSEN) == [None]
    caret(studio, "about")
    studio.until(f"{LABELS}.length === 0")
    assert studio.ask(CHOSEN) == [None]


def test_a_click_on_a_body_selects_its_lines(studio: Studio) -> None:
    drawn(studio)
    click(studio, "belt-bed")
    studio.until(f"{MARKED}.startsWith('{{name: belt-bed')")
    assert studio.ask(MARKED) == next(line.strip()[2:] for line in studio.text.splitlines() if "name: belt-bed" in line)
    studio.until(f"JSON.stringify({CHOSEN}) === '[\"belt-bed\"]'")


def test_after_a_click_on_a_body_the_keys_are_those_of_the_picture(studio: Studio) -> None:
    """Arrow keys move the body that was clicked, and undo takes it back; the numbers of its lines are marked."""
    drawn(studio)
    text = studio.text
    click(studio, "belt-bed")
    studio.until(f"JSON.stringify({CHOSEN}) === '[\"belt-bed\"]'")
    line = text[: text.index("name: belt-bed")].count("\n") + 1
    assert studio.page.locator("#lines .marked").all_inner_texts() == [str(line)]
    for key in ("ArrowUp", "ArrowUp", "ArrowRight"):
        studio.page.keyboard.press(key)
    studio.until("document.getElementById('scenario').value.startsWith('text:')")
    own, changed = (each.splitlines()[line - 1] for each in (text, studio.text))
    x, y, z = numbers(own, "pose: {")
    assert changed == own.replace(f"at_mm: [{x:g}, {y:g}, {z:g}]", f"at_mm: [{x + 1:g}, {y + 2:g}, {z:g}]")
    assert studio.ask("document.activeElement.tagName") == "IFRAME"
    studio.page.keyboard.press("Control+z")
    assert studio.text == text
    studio.page.keyboard.press("Control+y")
    assert studio.text.splitlines()[line - 1] == changed


def numbers(text: str, before: str) -> list[float]:
    """The list of numbers behind some words of a text."""
    behind = text.partition(before)[2].partition("[")[2]
    return [float(each) for each in behind.partition("]")[0].split(",")]


def test_a_drag_turns_the_camera_and_selects_nothing(studio: Studio) -> None:
    drawn(studio)
    caret(studio, "about")
    box = studio.page.frame_locator("#drawing iframe").locator("#stage").bounding_box()
    assert box is not None
    studio.page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    studio.page.mouse.down()
    studio.page.mouse.move(box["x"] + 0.6 * box["width"], box["y"] + 0.5 * box["height"], steps=3)
    studio.page.mouse.up()
    assert studio.ask(MARKED) == ""


def test_a_click_on_a_body_of_the_cell_opens_its_text(studio: Studio) -> None:
    assert studio.dropped(("cell.yaml", CELL.encode()), ("task.yaml", SHORT.encode()))
    studio.until(f"{DRAWS_TABLE} && {DRAWN}.view.bodies.some((body) => body.name === 'c')")
    click(studio, "table")
    studio.until(f"{MARKED}.startsWith('{{name: table')")
    assert studio.text == CELL
