"""A link of the studio holds the text and the cell of a task; what comes by a link is hostile until it is read."""

from __future__ import annotations

import base64
import json
import random
import zlib
from collections.abc import Iterator

import httpx
import pytest
from playwright.sync_api import Browser, BrowserContext

from tests.browser.studio_page import Studio
from tests.browser.test_studio_cell_and_task import DRAWS_TABLE, POINTS, SHORT, value_of
from tests.browser.test_studio_changes import drag
from tests.browser.test_studio_drawing import DRAWN
from tests.scenes.tasks.test_joining import CELL

pytestmark = pytest.mark.slow

OWN = 'about: "h\u00fclse \u2192 \U0001f980"\nrequest:\n  robot: {model: nobody}\n'
LONGEST = 2**20
COUNTS = """window.inflated = 0;
const Real = DecompressionStream;
window.DecompressionStream = function (format) {
    const { writable, readable } = new Real(format);
    const count = (chunk, sink) => { window.inflated += chunk.length; sink.enqueue(chunk); };
    return { writable, readable: readable.pipeThrough(new TransformStream({ transform: count })) };
};"""
NO_CLIPBOARD = "Object.defineProperty(navigator, 'clipboard', { value: undefined });"


def packed(content: str | bytes) -> str:
    """A text as a link has it, by another program than the browser."""
    made = zlib.compressobj(9, zlib.DEFLATED, -15)
    whole = made.compress(content.encode() if isinstance(content, str) else content) + made.flush()
    return base64.urlsafe_b64encode(whole).decode().rstrip("=")


def unpacked(link: str) -> dict[str, str]:
    parts = dict(part.split("=", 1) for part in link.split("#")[1].split("&"))
    return {
        key: zlib.decompress(base64.urlsafe_b64decode(value + "=" * (-len(value) % 4)), -15).decode()
        for key, value in parts.items()
    }


def linked(studio: Studio) -> str:
    """The link that Save copies."""
    studio.page.evaluate("navigator.clipboard.writeText('')")
    studio.page.select_option("#save", "link")
    studio.until("document.getElementById('note').textContent.startsWith('The link is copied')")
    return str(studio.page.evaluate("navigator.clipboard.readText()"))


@pytest.fixture
def other(browser: Browser) -> Iterator[BrowserContext]:
    """The browser of another person: with nothing in its storage."""
    made = browser.new_context()
    yield made
    made.close()


def test_a_link_shows_the_same_text_to_another_person(
    studio: Studio, other: BrowserContext, service: httpx.Client
) -> None:
    studio.page.fill("#text", OWN)
    link = linked(studio)
    assert link.startswith(f"{studio.address}#text=")
    assert unpacked(link) == {"text": OWN}
    theirs = Studio(other.new_page(), service, "#" + link.split("#")[1])
    assert theirs.text == OWN
    assert theirs.page.url == theirs.address
    assert theirs.ask("location.href") == theirs.address
    assert [name for _, name in theirs.own()] == ["h\u00fclse \u2192 \U0001f980"]
    assert theirs.note == ""
    theirs.reload()
    assert theirs.text == OWN
    assert len(theirs.own()) == 1


def test_a_link_to_a_task_holds_its_cell(studio: Studio, other: BrowserContext, service: httpx.Client) -> None:
    assert studio.dropped(("task.yaml", SHORT.encode()), ("cell.yaml", CELL.encode()))
    studio.until(DRAWS_TABLE)
    link = linked(studio)
    assert unpacked(link) == {"text": SHORT, "cell": CELL}
    page = other.new_page()
    posted = list[str]()
    page.on("request", lambda request: posted.append(request.url) if request.method == "POST" else None)
    theirs = Studio(page, service, "#" + link.split("#")[1])
    theirs.until(f"{DRAWS_TABLE} && {DRAWN}.view.bodies.some((body) => body.name === 'c')")
    assert theirs.text == SHORT
    assert theirs.faults == ""
    assert theirs.saved("cell") == ("cell.yaml", CELL.encode())
    assert {address.rsplit("/v1/", 1)[1] for address in posted} == {"scenes/parse"}
    assert theirs.said == []
    # their own text stays where the same text comes again, and keeps the name of its file
    studio.page.goto(link)
    studio.until("location.hash === ''")
    studio.until(f"document.getElementById('text').value === {json.dumps(SHORT)}")
    assert sorted(name for _, name in studio.own()) == ["cell", "task"]


def test_a_link_holds_the_task_that_is_drawn_beside_its_cell(
    studio: Studio, other: BrowserContext, service: httpx.Client
) -> None:
    """A drag of the table shows the cell, in the drawing of the task. A cell that is shown alone goes alone."""
    assert studio.dropped(("task.yaml", SHORT.encode()), ("cell.yaml", CELL.encode()))
    studio.until(f"{DRAWS_TABLE} && {DRAWN}.view.bodies.some((body) => body.name === 'c')")
    studio.ask(f"{DRAWN}.look('top')")
    drag(studio, "table", 0, -30)
    studio.until("document.getElementById('text').value.includes('assur-cell/1')")
    moved = studio.text
    assert moved != CELL
    link = linked(studio)
    assert studio.note.endswith("holds the task and its cell as they are now.")
    assert unpacked(link) == {"text": SHORT, "cell": moved}
    theirs = Studio(other.new_page(), service, "#" + link.split("#")[1])
    theirs.until(f"{DRAWS_TABLE} && {DRAWN}.view.bodies.some((body) => body.name === 'c')")
    assert theirs.text == SHORT
    seen = f"JSON.stringify([{POINTS}, {DRAWN}.view.bodies.map((body) => [body.name, body.seats])])"
    studio.until(f"{DRAWN}.view.bodies.find((body) => body.name === 'table').seats[0].at_m[1] < -0.2")
    assert theirs.ask(seen) == studio.ask(seen)
    cell = value_of(studio, "cell")
    studio.choose("demo")
    studio.choose(cell)
    assert unpacked(linked(studio)) == {"text": moved}
    assert studio.note.endswith("holds the text as it is now.")


def test_a_cell_that_comes_by_a_link_renames_no_other_text(studio: Studio) -> None:
    studio.opened("mine.yaml", CELL)
    studio.page.goto(f"{studio.address}#text={packed(SHORT)}&cell={packed(CELL)}")
    studio.until(f"document.getElementById('text').value === {json.dumps(SHORT)}")
    assert sorted(name for _, name in studio.own())[:2] == ["cell", "mine"]
    studio.choose(value_of(studio, "mine"))
    assert studio.saved("text") == ("mine.yaml", CELL.encode())


def test_a_link_that_is_opened_in_an_open_page_is_undone(studio: Studio) -> None:
    studio.type("# mine")
    mine = studio.text
    studio.page.goto(f"{studio.address}#text={packed(OWN)}")
    studio.until(f"document.getElementById('text').value === {json.dumps(OWN)}")
    assert studio.page.url == studio.address
    studio.undo()
    assert studio.text == mine
    assert len(studio.own()) == 2


def test_a_link_is_shown_where_a_page_may_not_copy(context: BrowserContext, service: httpx.Client) -> None:
    context.add_init_script(NO_CLIPBOARD)
    studio = Studio(context.new_page(), service)
    studio.page.fill("#text", OWN)
    studio.page.select_option("#save", "link")
    studio.page.wait_for_selector("#link-dialog[open]")
    assert unpacked(studio.page.input_value("#link")) == {"text": OWN}
    studio.page.keyboard.press("Enter")
    assert not studio.page.locator("#link-dialog").is_visible()


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        ("", "There is no text"),
        (random.Random(1).randbytes(60_000).hex(), "up to 65536 are allowed"),
    ],
)
def test_a_text_that_no_link_can_hold_is_refused(studio: Studio, content: str, reason: str) -> None:
    studio.page.evaluate("navigator.clipboard.writeText('before')")
    studio.page.fill("#text", content)
    studio.page.select_option("#save", "link")
    studio.until(f"document.getElementById('note').textContent.includes({json.dumps(reason)})")
    assert studio.page.evaluate("navigator.clipboard.readText()") == "before"


GOOD = packed(OWN)
WRONG = {
    "text=": "its text is empty",
    f"text={packed('')}": "its text is empty",
    f"text={packed(' ')}&cell={packed(CELL)}": "its text is empty",
    f"text={GOOD[:-8]}": "its text cannot be read",
    f"text={GOOD}AAAA": "its text cannot be read",
    f"text={GOOD}=": "its text cannot be read",
    "text=A": "its text cannot be read",
    "text=%22%3E": "its text cannot be read",
    f"text={packed(bytes([0xC3, 0x28]))}": "its text cannot be read",
    f"text={packed('a: b' + chr(0))}": "has a zero byte",
    f"text={GOOD}&text={GOOD}": 'it has "text"',
    f"text={GOOD}&more={GOOD}": 'it has "more"',
    f"cell={packed(CELL)}": "a cell without a text",
    f"text={packed(SHORT)}&cell=": "its cell is empty",
    f"text={GOOD}&cell={packed(CELL)}": "no cell of a task",
    f"text={packed(SHORT)}&cell={GOOD}": "no cell of a task",
    f"text={packed('x' * (LONGEST + 1))}": "up to 1048576 characters",
    f"text={packed(SHORT)}&cell={packed(CELL + '#' * LONGEST)}": "The cell in the link is too long",
}


def test_a_link_that_is_wrong_is_named_and_the_page_goes_on(studio: Studio) -> None:
    studio.page.fill("#text", CELL)
    for hash_, reason in WRONG.items():
        studio.page.goto(f"{studio.address}#{hash_}")
        studio.until(f"document.getElementById('note').textContent.includes({json.dumps(reason)})")
        assert studio.page.get_attribute("#note", "class") == "bad"
        assert (studio.text, studio.page.url) == (CELL, studio.address)
        studio.page.fill("#text", f"{CELL}# more")  # the page goes on, without the message
        assert studio.note == ""
        studio.page.fill("#text", CELL)
    assert len(studio.own()) == 1


def test_a_page_that_begins_with_a_wrong_link_shows_the_text_that_was_there(
    studio: Studio, context: BrowserContext, service: httpx.Client
) -> None:
    studio.page.fill("#text", OWN)
    second = Studio(context.new_page(), service, f"#text={GOOD[:-8]}")
    assert "Was all of it copied?" in second.note
    assert (second.text, second.page.url) == (OWN, second.address)
    second.reload()
    assert second.note == ""


def test_no_more_is_inflated_than_a_text_may_have(context: BrowserContext, service: httpx.Client) -> None:
    context.add_init_script(COUNTS)
    studio = Studio(context.new_page(), service, f"#text={packed(bytes(64 * LONGEST))}")
    assert "up to 1048576 characters" in studio.note
    assert LONGEST < studio.ask("inflated") <= 4 * LONGEST
    longest = "# " + "x" * (LONGEST - 2)
    studio.page.goto(f"{studio.address}#text={packed(longest)}")
    studio.until(f"document.getElementById('text').value.length === {LONGEST}")
    assert studio.text == longest
