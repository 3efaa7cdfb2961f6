"""The report of every shipped scenario in a real browser: it loads from a file, draws, and shows what was planned."""

from __future__ import annotations

import io
import json
from typing import Any

import numpy as np
import pytest
from matplotlib.image import imread, imsave
from numpy.typing import NDArray
from scipy.interpolate import BPoly

from assur.planner.model.phases import AFTER_S
from assur.scenes.conventions import converted
from assur.scenes.report.report import report_of
from assur.scenes.requests import cell_of, plan_cell
from assur.scenes.scenarios import shipped_scenarios
from tests.browser.conftest import report
from tests.scenes.cells.answers import answer
from tests.scenes.test_parts_taken_away import nest
from tests.scenes.view.shown import cell, scene, view

pytestmark = pytest.mark.slow

MOST_BYTES = 1_000_000
MOST_TRIANGLES, MOST_DRAW_CALLS = 120_000, 150
"""Of one picture: bodies and their shadows."""
PIXEL = 1.0
LEAST_COLOURS = 40
ROBOTS = ("demo", "five-bar", "rv-m1", "polar-arm", "two-robots", "lab-arm")
"""One of each family, and one beside another."""


def picture(png: bytes) -> NDArray[np.float64]:
    """Colours (h, w, 3) of a picture, from 0 to 1."""
    return np.asarray(imread(io.BytesIO(png), format="png"), dtype=np.float64)[..., :3]


def colours(png: bytes) -> int:
    """How many different colours a picture has."""
    return len(np.unique((255 * picture(png)).astype(int).reshape(-1, 3), axis=0))


@pytest.mark.parametrize("name", shipped_scenarios())
def test_every_report_loads_draws_and_asks_for_nothing(name: str, opened: Any) -> None:
    assert len(report(name).encode()) <= MOST_BYTES
    shown = opened(name)
    assert colours(shown.shot()) > LEAST_COLOURS
    assert shown.said == []
    assert [url for url in shown.asked if not url.startswith("file://")] == []
    assert len(shown.asked) == 1
    stats = shown.ask("assur.renderer.stats")
    assert 0 < stats["triangles"] <= MOST_TRIANGLES
    assert 0 < stats["drawCalls"] <= MOST_DRAW_CALLS
    assert shown.ask("document.querySelectorAll('.chart').length") == (6 if view(name)["distances"] else 0)
    # the tables need no graphics and no script
    assert shown.page.locator(".facts h2").count() >= 5


def test_a_page_that_asks_for_something_or_breaks_is_found_out(opened: Any) -> None:
    head, tail = report("heavy-casting-refused").split("</main>")
    broken = head + "<img src='https://example.invalid/x.png'><script>broken()</script></main>" + tail
    shown = opened("heavy-casting-refused", broken)
    # both are seen here, and the policy of the page refuses both: nothing runs that is not its own, nothing is fetched
    assert len([line for line in shown.said if "Content Security Policy" in line]) == 2
    assert [url for url in shown.asked if not url.startswith("file://")] == ["https://example.invalid/x.png"]


def test_an_empty_canvas_is_found_out() -> None:
    empty = io.BytesIO()
    imsave(empty, np.full((8, 8, 3), 0.9), format="png")
    assert colours(empty.getvalue()) <= LEAST_COLOURS


def tool_points(name: str, times: list[float]) -> NDArray[np.float64]:
    """Where the tool point is (T, 3) at times of the request's clock, by the planner's forward kinematics on the
    answer's own knots."""
    robot, tool = scene(name).robot, scene(name).tool
    knots, found = answer(name)["trajectory"], []
    states = np.stack([np.array(knots[key]) for key in ("position", "velocity", "acceleration")], axis=1)
    path = BPoly.from_derivatives(np.array(knots["time_s"]), states)
    for time in times:
        q = converted(np.asarray(path(time)), cell(name).conventions)
        position, rotation = robot.placements(q)
        flange = robot.links.index("flange")
        found.append(position[flange] + rotation[flange] @ tool.tcp.position)
    return np.array(found)


def five_times(name: str) -> list[float]:
    start, end = answer(name)["trajectory"]["time_s"][0], answer(name)["trajectory"]["time_s"][-1]
    return [start + share * (end - start) for share in (0.0, 0.21, 0.47, 0.78, 1.0)]


def projected(shown: Any, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Where points (P, 3) are on the canvas (P, 2), in pixels, by the page's matrix for the camera."""
    matrix = np.array(list(shown.ask("Array.from(assur.renderer.matrix)"))).reshape(4, 4).T
    width, height = shown.ask("[assur.renderer.canvas.clientWidth, assur.renderer.canvas.clientHeight]")
    out = np.column_stack([points, np.ones(len(points))]) @ matrix.T
    out = out[:, :2] / out[:, 3:]
    return np.column_stack([(out[:, 0] + 1) / 2 * width, (1 - out[:, 1]) / 2 * height])


def marked(png: bytes, near: NDArray[np.float64], within: float = 12.0) -> NDArray[np.float64]:
    """The middle (2,) of the pixels with the colour of the tool point's dot `within` some pixels of a place."""
    image = picture(png)
    h, w, _ = image.shape
    dot = np.array([0xFF, 0x00, 0xFF]) / 255
    y, x = np.mgrid[0:h, 0:w]
    weight = (np.abs(image - dot).max(-1) < 0.25) & (np.hypot(x + 0.5 - near[0], y + 0.5 - near[1]) < within)
    assert weight.any()
    return np.array([(x[weight] + 0.5).mean(), (y[weight] + 0.5).mean()])


@pytest.mark.parametrize("name", ROBOTS)
def test_the_pose_that_is_drawn_is_the_planners_within_a_pixel_at_five_times(name: str, opened: Any) -> None:
    shown = opened(name)
    # a colour that nothing else has, and nothing else over the dot
    shown.ask("document.documentElement.style.setProperty('--accent', '#ff00ff')")
    shown.ask("assur.restyle(), assur.show = {}")
    times = five_times(name)
    there = projected(shown, tool_points(name, times))
    for time, expected in zip(times, there, strict=True):
        shown.ask(f"assur.seek({time} - assur.view.start_s)")
        drawn = marked(shown.shot(), expected, within=5.0)  # farther away the path has the same colour
        assert np.abs(drawn - expected).max() <= PIXEL


def test_a_pose_of_another_instant_is_found_out(opened: Any) -> None:
    shown = opened("demo")
    shown.ask("document.documentElement.style.setProperty('--accent', '#ff00ff')")
    shown.ask("assur.restyle(), assur.show = {}, assur.look('top')")
    time = answer("demo")["margins"]["tool"]["speed_at_s"]
    (expected,) = projected(shown, tool_points("demo", [time]))
    shown.ask(f"assur.seek({time} + 0.003 - assur.view.start_s)")
    assert np.abs(marked(shown.shot(), expected) - expected).max() > PIXEL


def test_one_cursor_moves_robot_plots_and_time_line(opened: Any) -> None:
    shown = opened("demo")
    state = """(() => ({
        tool: assur.tracks.toolPose(assur.t).p,
        cursors: assur.charts.map((chart) => chart.cursor),
        line: document.querySelector('#timeline .cursor').style.left,
        readout: document.querySelector('.values').textContent,
        slider: Number(document.getElementById('time').value),
        said: document.getElementById('now').textContent,
        leg: document.getElementById('leg').textContent,
    }))()"""
    before = shown.ask(state)
    picture_before = shown.shot()
    box = shown.page.locator(".chart canvas").first.bounding_box()
    shown.page.mouse.click(box["x"] + 0.6 * box["width"], box["y"] + 0.5 * box["height"])
    after = shown.ask(state)
    assert shown.shot() != picture_before
    share = after["slider"] / view("demo")["lasts_s"]
    assert 0.4 < share < 0.7
    assert len(set(after["cursors"])) == 1
    assert after["cursors"][0] > before["cursors"][0]
    assert float(after["line"].removesuffix("%")) == pytest.approx(100 * share, abs=0.01)
    assert float(after["said"]) == pytest.approx(after["slider"], abs=1e-3)
    for key in ("tool", "readout", "leg"):
        assert after[key] != before[key]


def test_keys_play_step_and_turn_the_view(opened: Any) -> None:
    shown = opened("demo")
    knots = answer("demo")["trajectory"]["time_s"]
    shown.page.keyboard.press("ArrowRight")
    assert shown.ask("assur.t") == pytest.approx(knots[1], abs=1e-6)
    shown.page.keyboard.press("ArrowLeft")
    assert shown.ask("assur.t") == pytest.approx(knots[0], abs=1e-6)
    shown.page.keyboard.press("End")
    assert shown.ask("assur.t") == shown.ask("assur.view.lasts_s")
    shown.page.keyboard.press("Home")
    shown.page.keyboard.press("Space")
    shown.until("assur.t > 0.02")
    shown.page.keyboard.press("Space")
    assert shown.ask("assur.playing") is False
    shown.page.keyboard.press("2")
    assert shown.ask("assur.camera.flat") is True
    shown.page.locator("#stage").focus()
    azimuth = shown.ask("assur.camera.azimuth")
    shown.page.keyboard.press("ArrowLeft")
    assert shown.ask("assur.camera.azimuth") != azimuth
    assert shown.ask("assur.camera.flat") is False


def test_mouse_orbits_pans_and_zooms(opened: Any) -> None:
    shown = opened("demo")
    box = shown.page.locator("#stage").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    eye = "JSON.stringify([assur.camera.azimuth, assur.camera.elevation])"
    before = shown.ask(eye)
    shown.page.mouse.move(x, y)
    shown.page.mouse.down()
    shown.page.mouse.move(x + 80, y + 20)
    shown.page.mouse.up()
    assert shown.ask(eye) != before
    target, before = shown.ask("assur.camera.target"), shown.ask(eye)
    shown.page.keyboard.down("Shift")
    shown.page.mouse.down()
    shown.page.mouse.move(x + 10, y)
    shown.page.mouse.up()
    shown.page.keyboard.up("Shift")
    assert shown.ask("assur.camera.target") != target
    assert shown.ask(eye) == before
    distance = shown.ask("assur.camera.distance")
    shown.page.mouse.wheel(0, 240)
    shown.until(f"assur.camera.distance > {distance}")


def test_a_refusal_shows_its_sentence_and_its_census(opened: Any) -> None:
    shown = opened("shut-gate")
    assert shown.page.locator("#refusal .sentence").inner_text() == answer("shut-gate")["sentence"]
    # the cursor stands where the two bodies met, and both are those that are red
    best = answer("shut-gate")["best_candidate"]
    assert shown.ask("assur.t + assur.view.start_s") == pytest.approx(best["at_s"], abs=1e-6)
    red = shown.ask("assur.renderer.hot.map((number) => assur.view.bodies[number].name)")
    assert sorted(red) == sorted(best["bodies"])
    assert shown.ask("assur.renderer.hotShare") > 0.5
    counts = shown.page.locator(".census .count").all_inner_texts()
    assert [int(text) for text in counts] == [line["count"] for line in answer("shut-gate")["census"]["lines"]]
    widths = [box["width"] for box in (bar.bounding_box() for bar in shown.page.locator(".census .filled").all())]
    assert widths == sorted(widths, reverse=True)


def test_a_part_that_was_taken_away_is_seen_no_longer(opened: Any) -> None:
    request = nest(2000)
    found = plan_cell(cell_of(request), unstated={"report": "full"})
    page = report_of(cell_of(request), found, title="nest", about="", verdict={"ok": True, "findings": []}, version="0")
    shown = opened("nest", page)
    number = shown.ask("assur.view.bodies.findIndex((body) => body.name === 'a')")
    gone_s = shown.ask(f"assur.view.bodies[{number}].gone_s")
    shown.ask("assur.look('top')")
    seen = f"""((t) => {{
        assur.seek(t);
        assur.draw();
        const at = assur.renderer.onPage(assur.tracks.bodyPose(assur.view.bodies[{number}], t).p);
        return assur.renderer.bodyAt(at.x, at.y);
    }})"""
    assert shown.ask(f"{seen}({gone_s} - 0.001)") == number
    assert shown.ask(f"{seen}({gone_s} + 0.001)") not in (number, -1)
    why = f"waits until a is gone (at {gone_s - AFTER_S:.3f} s)"
    shown.ask(f"assur.seek({gone_s} - 0.001)")
    assert shown.page.locator("#leg").inner_text() == f"WAIT, place-b: {why}"
    assert shown.page.locator(".bar.leg-wait").inner_text() == why
    assert shown.said == []


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_text_is_readable_in_light_and_dark(scheme: str, opened: Any) -> None:
    shown = opened("demo", scheme=scheme)
    for names in (("--ink", "--page"), ("--ink", "--panel"), ("--faint", "--panel"), ("--good", "--panel")):
        both = [shown.ask(f"getComputedStyle(document.documentElement).getPropertyValue('{name}')") for name in names]
        assert contrast(*both) >= 4.5, names


def contrast(one: str, other: str) -> float:
    """The ratio of contrast of two colours, by the Web Content Accessibility Guidelines 2.2."""

    def luminance(text: str) -> float:
        parts = [int(text.strip()[k : k + 2], 16) / 255 for k in (1, 3, 5)]
        linear = [x / 12.92 if x <= 0.04045 else ((x + 0.055) / 1.055) ** 2.4 for x in parts]
        return float(np.array([0.2126, 0.7152, 0.0722]) @ np.array(linear))

    low, high = sorted([luminance(one), luminance(other)])
    return (high + 0.05) / (low + 0.05)


def test_grey_on_grey_is_found_out() -> None:
    assert contrast("#000000", "#ffffff") == pytest.approx(21.0)
    assert contrast("#999999", "#aaaaaa") < 4.5


def test_a_tablet_shows_all_of_it_without_scrolling_sideways(opened: Any) -> None:
    shown = opened("demo", size={"width": 820, "height": 1180})
    assert shown.ask("document.documentElement.scrollWidth") <= 820
    box = shown.page.locator("#stage").bounding_box()
    assert box["height"] > 300
    for button in shown.page.locator("button").all():
        size = button.bounding_box()
        assert min(size["width"], size["height"]) >= 30


def test_the_view_that_a_page_holds_is_the_document(opened: Any) -> None:
    shown = opened("tray")
    assert json.loads(json.dumps(shown.ask("assur.view"))) == view("tray")
