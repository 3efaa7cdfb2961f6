"""Changes that are not typed: a refusal's proposal by its button, a thing that is dragged in the view from above."""

from __future__ import annotations

import json
from typing import Any

import pytest

from tests.browser.studio_page import IDLE, Studio
from tests.browser.test_studio_cell_and_task import DRAWS_TABLE, SHORT, value_of
from tests.browser.test_studio_drawing import DRAWN, drawn
from tests.browser.test_studio_selection import numbers
from tests.scenes.tasks.test_joining import CELL
from tests.scenes.tasks.test_proposals import APART, HIGH, HIGHER, LATE

pytestmark = pytest.mark.slow

TEXT = """\
about: a follow that takes too long for its window # 500 ms
request:
  schema: assur/1
  robot: {model: mitsubishi-rh-6frh5520, tool: {tcp_mm: [0, 0, 0]}}
  start: {joints: {j1_deg: 20, j2_deg: 60, j3_mm: 250, j4_deg: 0}}
  frames:
    belt: {conveyor: {at_mm: [0, 350, 50], speed_mm_s: 250}} # runs along x
    plate: {fixed: {at_mm: [300, -200, 0], yaw_deg: 90}}
  bodies:
    - {name: post, shape: {cylinder: {radius_mm: 30, height_mm: 9}}, pose: {frame: plate, at_mm: [0, 100, 30]}} # turned
    - name: crate
      shape: {box: {size_mm: [60, 60, 60]}}
      pose:
        at_m: [-0.3, 0.1, 0.03] # in metres
  task:
    - follow:
        name: print # the step
        to: {frame: belt, at_mm: [0, 0, 150], yaw_deg: 0}
        duration_ms: 500 # too long
        window_mm: [-40, 40]
    - move: {name: away, to: {at_mm: [400, 100, 150]}}
  options: {max_candidates: 60, budget_s: 30, stop: first}
"""


def opened(studio: Studio, text: str = TEXT) -> None:
    drawn(studio)
    studio.page.fill("#text", text)
    studio.until(f"{DRAWN}.view.bodies.some((body) => body.name === 'crate')")
    studio.ask(f"{DRAWN}.look('top')")


def place(studio: Studio, name: str) -> tuple[float, float]:
    """Where a body, or a control point, is on the page."""
    at = studio.ask(
        f"(() => {{ const [player, name] = [{DRAWN}, '{name}'];"
        "const body = player.view.bodies.find((each) => each.name === name);"
        "const point = player.view.control_points.find((each) => each.name === name);"
        "const { p } = body ? player.tracks.bodyPose(body, 0) : player.tracks.pointPose(point, 0);"
        "return player.renderer.onPage(p); })()"
    )
    box = studio.page.frame_locator("#drawing iframe").locator("#stage").bounding_box()
    assert box is not None
    return box["x"] + at["x"], box["y"] + at["y"]


def pixels(studio: Studio, mm: float) -> float:
    """So many millimetres in the view from above."""
    canvas = "document.querySelector('#drawing iframe').contentDocument.getElementById('stage').clientHeight"
    return float(studio.ask(f"{mm} / 1000 / {DRAWN}.camera.across(1, 0)[0] * {canvas}"))


def grip_of(studio: Studio, name: str) -> tuple[float, float]:
    """Where on the page a pointer takes a thing, near its place: a bracket has a hole there."""
    left, top = place(studio, name)
    box = studio.page.frame_locator("#drawing iframe").locator("#stage").bounding_box()
    assert box is not None
    at = f"{{left: {left - box['x']}, top: {top - box['y']}}}"
    dx, dy = studio.ask(
        f"(() => {{ const [{{ grip }}, {{ left, top }}] = [{DRAWN}, {at}];"
        "const near = [0, 4, -4, 8, -8, 12, -12].flatMap((x, _, all) => all.map((y) => [x, y]));"
        f"return near.find(([x, y]) => (grip.at(left + x, top + y) || {{}}).title === '{name}'); }})()"
    )
    return left + dx, top + dy


def drag(studio: Studio, name: str, x_mm: float, y_mm: float, *, fine: bool = False) -> None:
    left, top = grip_of(studio, name)
    mouse = studio.page.mouse
    mouse.move(left, top)
    if fine:
        studio.page.keyboard.down("Shift")
    mouse.down()
    mouse.move(left + pixels(studio, x_mm) / 2, top, steps=3)
    mouse.move(left + pixels(studio, x_mm), top - pixels(studio, y_mm), steps=3)
    mouse.up()
    if fine:
        studio.page.keyboard.up("Shift")


def test_a_button_writes_the_change_that_helps_and_plans_again(studio: Studio) -> None:
    opened(studio)
    studio.planned()
    row = studio.page.locator("#answers .proposal")
    assert "This change was tried and works: window:" in row.inner_text()
    row.locator("button").click()
    studio.until("document.querySelector('#answers figcaption').textContent.includes(': planned,')")
    low, high = numbers(studio.text, "window_mm:")
    assert high > 40
    assert studio.text == TEXT.replace("[-40, 40]", f"[{low:g}, {high:g}]")
    assert studio.page.locator("#answers .proposal").count() == 0
    studio.undo()
    assert studio.text == TEXT
    assert studio.said == []


def test_a_proposal_says_nothing_of_another_text(studio: Studio) -> None:
    opened(studio)
    studio.planned()
    button = studio.page.locator("#answers .proposal button")
    assert button.is_enabled()
    studio.write("too long", "longer")
    assert not button.is_enabled()
    studio.undo()
    studio.until("!document.querySelector('#answers .proposal button').disabled")


def test_a_change_of_the_cell_is_written_there(studio: Studio) -> None:
    cell = CELL.replace("near: 1}}", "near: 1}, latest_end_ms: 50} # soon")
    task = SHORT.replace("stop: first", "stop: first, budget_s: 30")
    assert studio.dropped(("cell.yaml", cell.encode()), ("task.yaml", task.encode()))
    studio.until(DRAWS_TABLE)
    studio.planned()
    studio.page.locator("#answers .proposal button").click()
    studio.until("document.querySelector('#answers figcaption').textContent.includes(': planned,')")
    assert studio.text == task
    studio.choose(value_of(studio, "cell"))
    latest = studio.text.split("latest_end_ms: ")[1].split("}")[0]
    assert float(latest) > 50
    assert studio.text == cell.replace("latest_end_ms: 50", f"latest_end_ms: {latest}")


def test_a_body_is_dragged_in_its_frame_and_only_its_numbers_change(studio: Studio) -> None:
    """The axes of the plate are turned by 90 degrees: to the right is along its -y."""
    opened(studio)
    state = studio.ask(f"{DRAWN}.camera.state")
    drag(studio, "post", 50, 20)
    studio.until("!document.getElementById('text').value.includes('[0, 100, 30]')")
    x, y, z = numbers(studio.text, "frame: plate,")
    assert (abs(x - 20) <= 3, abs(y - 50) <= 3, z) == (True, True, 30)
    assert studio.text == TEXT.replace("[0, 100, 30]", f"[{x:g}, {y:g}, 30]")
    studio.until(
        f"Math.abs({DRAWN}.view.bodies.find((body) => body.name === 'post').seats[0].at_m[1] - {y / 1000}) < 1e-6"
    )
    assert studio.ask(f"{DRAWN}.camera.state") == state
    assert studio.ask("document.activeElement.id") != "text"
    studio.undo()
    assert studio.text == TEXT
    assert studio.said == []


def test_a_drag_with_shift_is_finer_and_keeps_the_unit_of_the_text(studio: Studio) -> None:
    opened(studio)
    drag(studio, "crate", 33.3, 0, fine=True)
    studio.until("!document.getElementById('text').value.includes('[-0.3, 0.1, 0.03]')")
    x, y, z = numbers(studio.text, "at_m:")
    assert (round(x, 4), y, z) == (x, 0.1, 0.03)
    assert abs(x + 0.3 - 0.0333) <= 3e-3
    assert studio.text == TEXT.replace("[-0.3, 0.1, 0.03]", f"[{x:g}, 0.1, 0.03]")


def test_a_control_point_is_dragged_and_arrow_keys_move_what_is_marked(studio: Studio) -> None:
    opened(studio)
    drag(studio, "away", -40, -30)
    studio.until("!document.getElementById('text').value.includes('[400, 100, 150]')")
    x, y, _ = numbers(studio.text, "away, to:")
    assert (abs(x - 360) <= 3, abs(y - 70) <= 3) == (True, True)
    studio.until(f"{DRAWN}.grip.chosen !== null && {DRAWN}.grip.chosen.kind === 'step'")
    studio.page.frame_locator("#drawing iframe").locator("#stage").focus()
    for key in ("ArrowRight", "ArrowRight", "Shift+ArrowUp"):
        studio.page.keyboard.press(key)
    studio.until(f"document.getElementById('text').value.includes('[{x + 2:g}, {y + 10:g}, 150]')")


def test_a_change_of_the_cell_is_undone_at_once(studio: Studio) -> None:
    cell = CELL.replace("near: 1}}", "near: 1}, latest_end_ms: 50} # soon")
    task = SHORT.replace("stop: first", "stop: first, budget_s: 30")
    assert studio.dropped(("cell.yaml", cell.encode()), ("task.yaml", task.encode()))
    studio.until(DRAWS_TABLE)
    studio.planned()
    studio.page.locator("#answers .proposal button").click()
    studio.until("document.querySelector('#answers figcaption').textContent.includes(': planned,')")
    assert not studio.page.locator("#answers .stale").is_visible()
    studio.undo()
    assert studio.text == task
    assert studio.page.locator("#answers .stale").is_visible()
    studio.choose(value_of(studio, "cell"))
    assert studio.text == cell


def test_a_straight_part_of_a_kind_is_applied_for_all_its_picks(studio: Studio) -> None:
    """The second part is too high for the approach, which is that of the kind of both: it is changed in the cell."""
    assert studio.dropped(("cell.yaml", HIGH.encode()), ("task.yaml", HIGHER.encode()))
    studio.until(DRAWS_TABLE)
    studio.planned()
    row = studio.page.locator("#answers .proposal")
    assert "This change was tried and works: heights: approach 26 mm, all 2 alike." in row.inner_text()
    row.locator("button").click()
    studio.until("document.querySelector('#answers figcaption').textContent.includes(': planned,')")
    studio.choose(value_of(studio, "cell"))
    assert studio.text == HIGH.replace("approach: {mm: 130}", "approach: {mm: 26}")


def test_a_window_of_a_transfer_is_applied_for_all_its_parts(studio: Studio) -> None:
    """The second part comes past the end of the window, which is that of both picks."""
    assert studio.dropped(("cell.yaml", APART.encode()), ("task.yaml", LATE.encode()))
    studio.until(DRAWS_TABLE)
    studio.planned()
    row = studio.page.locator("#answers .proposal")
    assert "all 2 picks of this window" in row.inner_text()
    row.locator("button").click()
    studio.until("document.querySelector('#answers figcaption').textContent.includes(': planned,')")
    low, high = numbers(studio.text, "window_mm:")
    assert (low, high > -100) == (-280, True)
    assert studio.text == LATE.replace("[-280, -100]", f"[-280, {high:g}]")


BARRED = """\
about: a body stands where the tool is to be
request:
  schema: assur/1
  robot: {model: mitsubishi-rh-6frh5520, tool: {tcp_mm: [0, 0, -100], bodies: [
    {name: cup, shape: {cylinder: {radius_mm: 12, height_mm: 100}}, at_mm: [0, 0, -50]}]}}
  start: {joints: {j1_deg: 20, j2_deg: 60, j3_mm: 250, j4_deg: 0}}
  bodies: [{name: crate, shape: {box: {size_mm: [60, 60, 300]}}, pose: {at_mm: [400, -200, 150]}}]
  task: [{move: {name: away, to: {at_mm: [400, -200, 100]}}}]
  options: {max_candidates: 60, budget_s: 30, stop: first, explain_budget_s: 30}
"""


def test_a_body_that_is_in_the_way_is_left_out_by_hand(studio: Studio) -> None:
    opened(studio, BARRED)
    studio.planned()
    row = studio.page.locator("#answers .proposal")
    assert "This change was tried and works: without: crate." in row.inner_text()
    assert row.inner_text().endswith(
        "There is no button: no value leaves out what is in the text. Change the text by hand."
    )
    assert row.locator("button").count() == 0


def test_what_would_not_help_is_listed(studio: Studio) -> None:
    """Each of two bodies stands where the tool is to be. After a time of nothing, no change was tried."""
    one = BARRED.split("bodies: [")[2].split("]\n  task", maxsplit=1)[0]
    both = BARRED.replace(one, f"{one}, {one.replace('crate', 'chest')}")
    opened(studio, both)
    studio.planned()
    answer = json.loads(studio.saved("answer")[1])
    row = studio.page.locator("#answers .proposal")
    assert {"without: crate"} <= set(answer["tried"])
    assert row.locator("li").all_inner_texts() == answer["tried"]
    assert row.locator("span").all_inner_texts() == ["What would not help, each tried by itself:"]
    studio.page.fill("#text", both.replace("explain_budget_s: 30", "explain_budget_ms: 0.001"))
    studio.planned()
    assert row.locator("span").all_inner_texts() == [
        "What would help is not known: the time for trying changes was over (explain_budget_s)."
    ]
    assert row.locator("li").count() == 0
    assert studio.said == []


def test_a_thing_of_the_cell_is_dragged_in_the_drawing_of_its_task(studio: Studio) -> None:
    """A part in a slot moves the grid: the text of the cell is shown, the drawing stays that of the task, from above,
    and one undo takes the drag back."""
    assert studio.dropped(("cell.yaml", CELL.encode()), ("task.yaml", SHORT.encode()))
    studio.until(f"{DRAWS_TABLE} && {DRAWN}.view.bodies.some((body) => body.name === 'c')")
    studio.ask(f"{DRAWN}.look('top')")
    seen = studio.ask(f"{DRAWN}.camera.state")
    before = studio.ask(f"{DRAWN}.view.bodies.find((body) => body.name === 'c').seats[0].at_m")
    drag(studio, "c", 20, 0)
    studio.until(f"{DRAWN}.view.bodies.find((body) => body.name === 'c').seats[0].at_m[0] > {before[0]} + 0.01")
    x, y, z = numbers(studio.text, "slots:")
    assert (abs(x - 320) <= 3, y, z) == (True, -250, 60)
    moved = CELL.replace("[300, -250, 60]", f"[{x:g}, -250, 60]")
    assert studio.text == moved
    assert studio.ask("document.getElementById('scenario').value") == value_of(studio, "cell")
    assert studio.ask(f"{DRAWN}.camera.state") == seen
    studio.undo()
    studio.until(f"{DRAWN}.view.bodies.find((body) => body.name === 'c').seats[0].at_m[0] === {before[0]}")
    assert studio.text == SHORT
    assert studio.ask(f"{DRAWN}.camera.state") == seen
    studio.page.keyboard.press("Control+y")
    assert studio.text == moved
    studio.until(f"{DRAWN}.view.bodies.find((body) => body.name === 'c').seats[0].at_m[0] > {before[0]} + 0.01")
    studio.undo()
    studio.choose(value_of(studio, "cell"))
    assert studio.text == CELL
    assert studio.said == []


def test_beside_the_text_of_its_cell_a_task_is_drawn_planned_and_dragged(studio: Studio) -> None:
    task = SHORT.replace("-450, 0, 10", "-250, 0, 10")
    assert studio.dropped(("cell.yaml", CELL.encode()), ("task.yaml", task.encode()))
    studio.until(f"{DRAWS_TABLE} && {DRAWN}.view.bodies.some((body) => body.name === 'a')")
    studio.ask(f"{DRAWN}.look('top')")
    drag(studio, "table", 0, -30)
    studio.until("!document.getElementById('text').value.includes('[350, -200, 25]')")
    studio.planned()
    assert "task" in studio.page.locator("#answers figcaption strong").inner_text()
    assert not studio.page.locator("#answers .stale").is_visible()
    studio.write("mass_kg: 0.12", "mass_kg: 0.13")
    studio.page.wait_for_selector("#drawing:not([hidden])")
    studio.until(f"{DRAWN}.view.bodies.some((body) => body.name === 'a')")
    drag(studio, "a", 20, 0)
    studio.until("document.getElementById('text').value.includes('assur-task/1')")
    x, y, _ = numbers(studio.text, "name: a,")
    assert (abs(x + 230) <= 3, y) == (True, 0)
    assert studio.text == task.replace("-250, 0, 10", f"{x:g}, 0, 10")
    assert studio.ask(f"{DRAWN}.camera.above")


@pytest.mark.parametrize("view", ["perspective", "side"])
def test_in_other_views_a_drag_turns_the_camera(studio: Studio, view: str) -> None:
    opened(studio)
    studio.ask(f"{DRAWN}.look('{view}')")
    before = studio.ask(f"{DRAWN}.camera.azimuth")
    left, top = place(studio, "crate")
    studio.page.mouse.move(left, top)
    studio.page.mouse.down()
    studio.page.mouse.move(left + 40, top, steps=3)
    studio.page.mouse.up()
    studio.page.wait_for_timeout(300)
    assert studio.text == TEXT
    assert studio.ask(f"{DRAWN}.camera.azimuth") != before


def test_why_a_thing_is_not_moved_is_told(studio: Studio) -> None:
    """The point of a pick is where its part is; the box is written in a file of the service."""
    told: Any = studio.page.locator("#note.bad")
    opened(
        studio,
        TEXT.replace(
            "to: {at_mm: [400, 100, 150]}", "to: {body: crate, at_mm: [0, 0, 150]}, leg: cartesian, path: [{line: {}}]"
        ),
    )
    text = studio.text
    drag(studio, "away", 30, 30)
    told.wait_for()
    assert "without a path" in told.inner_text()
    assert studio.text == text
    studio.until(IDLE)
    studio.choose("packing")
    studio.until(f"{DRAWN}.view.bodies.some((body) => body.name.includes('fence'))")
    studio.ask(f"{DRAWN}.look('top')")
    name = studio.ask(f"{DRAWN}.view.bodies.find((body) => body.name.includes('fence')).name")
    text = studio.text
    drag(studio, name, 30, 30)
    told.wait_for()
    assert "file of the cell" in told.inner_text()
    assert studio.text == text
