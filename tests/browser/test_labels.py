"""The names in the picture: none hides another, and each can be read."""

from __future__ import annotations

from typing import Any

import pytest

pytestmark = pytest.mark.slow

OVERLAPS = """(() => {
    const shown = [...document.querySelectorAll('#labels .label:not([hidden])')];
    const boxes = shown.map((label) => label.getBoundingClientRect());
    const over = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
    return boxes.flatMap((a, k) => boxes.slice(k + 1).filter((b) => over(a, b))).length;
})()"""
HIDDEN = "[...document.querySelectorAll('#labels .label[hidden]:not(.distance)')].map((label) => label.textContent)"
SHOWN = (
    "[...document.querySelectorAll('#labels .label:not([hidden]):not(.distance)')].map((label) => label.textContent)"
)


@pytest.mark.parametrize("name", ["packing", "transfer", "demo"])
@pytest.mark.parametrize("view", ["perspective", "top", "side", "front"])
def test_no_label_hides_another(name: str, view: str, opened: Any) -> None:
    shown = opened(name)
    points = shown.ask("assur.view.control_points.length")
    for share in (0.0, 0.3, 0.7, 1.0):
        shown.ask(f"assur.look('{view}'), assur.seek({share} * assur.view.lasts_s)")
        assert shown.ask(OVERLAPS) == 0
        assert shown.ask(SHOWN) != []
        assert len(shown.ask(SHOWN)) + len(shown.ask(HIDDEN)) == points


def test_a_label_without_room_is_shown_when_it_is_marked_or_the_pointer_is_at_its_point(opened: Any) -> None:
    """From so far that all points are at one place of the picture."""
    shown = opened("packing")
    shown.ask("assur.look('top')")
    assert shown.ask(HIDDEN) == []
    shown.ask("assur.camera.zoom(40), assur.draw()")
    hidden = shown.ask(HIDDEN)
    assert hidden
    assert shown.ask(OVERLAPS) == 0
    for name in hidden:
        step = shown.ask(f"assur.view.control_points.find((point) => point.name === '{name}').step")
        shown.ask(f"assur.mark({{kind: 'step', name: '{step}'}})")
        assert name in shown.ask(SHOWN)
        assert shown.ask("document.querySelector('.label.chosen').textContent") == name
        assert shown.ask(OVERLAPS) == 0
    shown.ask("assur.mark()")
    assert shown.ask(HIDDEN) == hidden
    point = f"assur.view.control_points.find(({{name}}) => name === '{hidden[0]}')"
    at = shown.ask(f"assur.renderer.onPage(assur.tracks.pointPose({point}, 0).p)")
    box = shown.page.locator("#stage").bounding_box()
    shown.page.mouse.move(box["x"] + at["x"], box["y"] + at["y"])
    assert hidden[0] in shown.ask(SHOWN)
    assert shown.ask(OVERLAPS) == 0
    shown.page.mouse.move(box["x"] + 5, box["y"] + box["height"] - 5)
    assert shown.ask(HIDDEN) == hidden
    assert shown.said == []
