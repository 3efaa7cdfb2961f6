"""The studio on a telephone and on a tablet: the picture comes first, and is large enough to be seen."""

from __future__ import annotations

import pytest

from tests.browser.studio_page import Studio

pytestmark = pytest.mark.slow

SIZES = {"telephone": (390, 800), "small telephone": (320, 568), "lying telephone": (800, 390), "tablet": (820, 1100)}
LEAST = 250
"""Pixels of the picture, at least, where there are twice as many in the window."""


@pytest.mark.parametrize("size", SIZES)
def test_the_picture_comes_first_and_is_seen(studio: Studio, size: str) -> None:
    page = studio.page
    width, height = SIZES[size]
    page.set_viewport_size({"width": width, "height": height})
    page.evaluate("scrollTo(0, 1e6)")
    studio.planned()
    studio.player()
    assert page.evaluate("scrollY") == 0
    stage = page.frame_locator("#answers iframe").locator("#stage").bounding_box()
    editor = page.locator("#text").bounding_box()
    assert stage is not None
    assert editor is not None
    seen = min(stage["y"] + stage["height"], height) - stage["y"]
    assert seen >= min(LEAST, height / 3)
    assert stage["y"] < editor["y"]
    assert editor["height"] >= 200
    # nothing is wider than the window, in the page and in the player
    assert page.evaluate("document.documentElement.scrollWidth") == width
    assert page.frames[-1].evaluate("document.documentElement.scrollWidth <= innerWidth")


def test_before_there_is_an_answer_the_text_is_seen(studio: Studio) -> None:
    studio.page.set_viewport_size({"width": 390, "height": 800})
    box = studio.page.locator("#text").bounding_box()
    assert box is not None
    assert box["y"] < 260
