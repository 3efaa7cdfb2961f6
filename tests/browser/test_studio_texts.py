"""The studio loses no text: it is kept over a reload, undone, opened, dropped and saved as it is seen."""

from __future__ import annotations

import httpx
import pytest
from playwright.sync_api import BrowserContext, Dialog, Page

from tests.browser.studio_page import Studio

pytestmark = pytest.mark.slow

CELL = "about: a cell of mine\nrequest:\n  robot: {model: nobody}\n"
FULL = """Object.defineProperty(Storage.prototype, 'setItem', { value() {
    throw new DOMException('full', 'QuotaExceededError');
} });"""
OFF = """for (const name of ['localStorage', 'sessionStorage'])
    Object.defineProperty(window, name, { get() { throw new DOMException('denied', 'SecurityError'); } });"""


@pytest.fixture
def tabs(context: BrowserContext, service: httpx.Client) -> tuple[Studio, Studio]:
    """Two tabs of one browser, of which the first has a text of its own, which both show."""
    first = Studio(context.new_page(), service)
    first.page.fill("#text", CELL)
    second = Studio(context.new_page(), service)
    assert second.text == CELL
    return first, second


def texts(page: Page) -> list[str]:
    """The texts that the browser keeps."""
    found: list[str] = page.evaluate(
        "Object.entries(localStorage).filter(([key]) => key.startsWith('assur-text-'))"
        ".map(([, raw]) => JSON.parse(raw).text)"
    )
    return sorted(found)


def test_a_text_is_the_same_after_a_reload(studio: Studio) -> None:
    studio.type("# one\n")
    written = studio.text
    assert written.endswith("# one\n")
    studio.reload()
    assert studio.text == written
    studio.type("# two")
    studio.reload()
    assert studio.text == f"{written}# two"
    assert len(studio.own()) == 1


def test_a_later_tab_has_the_latest_text(studio: Studio, context: BrowserContext, service: httpx.Client) -> None:
    studio.page.fill("#text", CELL)
    studio.page.close()
    assert Studio(context.new_page(), service).text == CELL


def test_a_text_that_is_no_yaml_is_kept_and_saved_before_any_plan(studio: Studio) -> None:
    broken = "about: [no, yaml\n  \tat: all: {\u00e4\n\n\n"
    studio.page.fill("#text", broken)
    assert studio.saved("text") == ("no-yaml.yaml", broken.encode())
    studio.reload()
    assert studio.text == broken


def test_a_chosen_scenario_and_one_letter_leave_the_other_text_as_it_was(studio: Studio) -> None:
    studio.page.fill("#text", CELL)
    ((value, name),) = studio.own()
    assert name == "a cell of mine"
    studio.choose("transfer")
    studio.type("x")
    assert sorted(texts(studio.page)) == sorted([CELL, studio.text])
    studio.choose(value)
    assert studio.text == CELL
    studio.reload()
    assert studio.text == CELL


def test_undo_goes_back_over_chosen_scenarios_and_files_and_redo_forward(studio: Studio, service: httpx.Client) -> None:
    demo, transfer = (service.get(f"/v1/scenes/{name}/text").text for name in ("demo", "transfer"))
    studio.type("# mine")
    mine = studio.text
    studio.choose("transfer")
    studio.opened("cell.yaml", CELL)
    assert studio.text == CELL
    studio.undo()
    assert studio.text == transfer
    assert studio.page.input_value("#scenario") == "transfer"
    studio.page.click("#undo")
    assert studio.text == mine
    assert studio.page.input_value("#scenario").startswith("text:")
    studio.page.keyboard.press("Control+Shift+z")
    assert studio.text == transfer
    # a text that redo brought back is not written over the one that was there before
    assert texts(studio.page) == sorted([mine, CELL])
    studio.undo()
    for _ in range(len("# mine")):  # at most: the browser takes letters that were typed together back together
        if studio.text != demo:
            studio.undo()
    assert studio.text == demo
    assert studio.page.input_value("#scenario") == "demo"


def test_letters_that_were_typed_together_are_undone_together_and_a_long_text_is_undone(studio: Studio) -> None:
    studio.opened("cell.yaml", CELL)
    studio.type("# one")
    studio.page.keyboard.press("Enter")
    studio.type("two")
    studio.undo()
    assert studio.text == f"{CELL}# one\n"
    long = "# a line of a long text, in which a browser is slow\n" * 5000
    studio.opened("long.yaml", long)
    assert studio.text == long
    studio.undo()
    assert studio.text == f"{CELL}# one\n"
    studio.page.click("#undo")
    studio.page.click("#undo")
    assert studio.text == CELL
    studio.page.keyboard.press("Control+y")
    assert studio.text == f"{CELL}# one"
    for _ in range(9):
        studio.page.click("#undo")
    assert studio.text == studio.page.evaluate("fetch('v1/scenes/demo/text').then((response) => response.text())")


def test_a_deleted_text_is_gone_and_undo_brings_it_back(studio: Studio) -> None:
    studio.page.fill("#text", CELL)
    studio.page.click("#delete")
    studio.until("document.getElementById('delete').hidden")
    assert texts(studio.page) == []
    studio.undo()
    assert studio.text == CELL
    assert texts(studio.page) == [CELL]


def test_save_writes_the_text_that_is_seen_and_not_the_planned_one(studio: Studio) -> None:
    studio.choose("transfer")
    studio.planned()
    studio.write("schema: assur/1", "schema: assur/7")
    studio.page.wait_for_selector("#faults p")
    told = studio.faults
    assert studio.page.locator("#answers figcaption .stale").is_visible()
    assert studio.page.get_attribute("#of-answer", "label") == "Answer to the text before its last change"
    _, content = studio.saved("text")
    assert content.decode() == studio.text
    assert "assur/7" in studio.text
    assert studio.faults == told  # Save leaves the list of faults


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("cell.yaml", CELL),
        ("no.ending.yml", "# \u00fcber\n" + CELL),
        ("windows.yaml", CELL.replace("\n", "\r\n")),
        ("cell.json", '{"about": "j", "request": {"robot": {"model": "x"}}}'),
        ("README", "nothing of\n\na scenario  \n"),
    ],
)
def test_a_file_is_opened_and_saved_as_it_was(studio: Studio, name: str, content: str) -> None:
    studio.opened(name, content)
    assert studio.text == content.replace("\r\n", "\n")
    assert studio.saved("text") == (name, content.encode())
    studio.reload()
    assert studio.saved("text") == (name, content.encode())
    assert [each for _, each in studio.own()] == [name.rsplit(".", 1)[0]]


def test_a_file_is_dropped_anywhere_also_on_a_player(studio: Studio) -> None:
    studio.choose("transfer")
    studio.planned()
    studio.player()
    assert studio.dropped(("one.yaml", CELL.encode()))
    assert studio.text == CELL
    assert studio.dropped(("two.yaml", b"about: two"), target="#answers iframe")
    assert studio.text == "about: two"
    assert texts(studio.page) == sorted([CELL, "about: two"])
    assert studio.dropped(("a.yaml", b"a: 1"), ("b.yaml", b"b: 1"))
    assert "2 files" in studio.faults
    assert studio.text == "about: two"


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("plan.csv", b"t,j1\n", "another kind of file"),
        ("cell.urdf", b"<robot/>", "another kind of file"),
        ("latin.yaml", "about: \u00fc".encode("latin-1"), "no text in UTF-8"),
        ("zero.yaml", b"about: \0", "zero byte"),
        ("long.yaml", b"#" * (2**20 + 1), "too long"),
    ],
)
def test_a_file_that_is_no_scenario_is_refused_by_name_and_the_text_stays(
    studio: Studio, name: str, content: bytes, said: str
) -> None:
    before = studio.text
    studio.opened(name, content)
    assert said in studio.faults
    assert studio.text == before
    assert texts(studio.page) == []


def test_the_scenario_of_the_address_is_shown_and_ones_own_text_stays(
    studio: Studio, context: BrowserContext, service: httpx.Client
) -> None:
    studio.page.fill("#text", CELL)
    other = Studio(context.new_page(), service, "?scenario=shut-gate")
    assert other.text == service.get("/v1/scenes/shut-gate/text").text
    assert other.page.input_value("#scenario") == "shut-gate"
    studio.page.goto(f"{studio.address}?scenario=transfer")
    studio.ready()
    assert studio.text == service.get("/v1/scenes/transfer/text").text
    assert texts(studio.page) == [CELL]
    studio.type("# more")  # the address is that of a scenario as it is shipped, and no longer that of this text
    changed = studio.text
    assert studio.page.url == studio.address
    studio.reload()
    assert studio.text == changed
    assert texts(studio.page) == sorted([CELL, changed])


@pytest.mark.parametrize("name", ["nope", "", "../demo", "<b>"])
def test_an_address_with_an_unknown_scenario_says_so(context: BrowserContext, service: httpx.Client, name: str) -> None:
    studio = Studio(context.new_page(), service)
    studio.page.fill("#text", CELL)
    studio.page.goto(f"{studio.address}?scenario={name}")
    studio.ready()
    assert studio.faults
    assert studio.text == CELL


@pytest.mark.parametrize("script", [FULL, OFF])
def test_a_storage_that_is_full_or_off_is_told_and_the_page_works(
    context: BrowserContext, service: httpx.Client, script: str
) -> None:
    page = context.new_page()
    page.add_init_script(script)
    studio = Studio(page, service)
    studio.choose("transfer")
    assert page.locator("#kept").inner_text() == ""
    studio.type("# more")
    written = studio.text
    assert "Save it as a file" in page.locator("#kept").inner_text()
    asked = list[str]()

    def told(dialog: Dialog) -> None:
        asked.append(dialog.type)
        dialog.dismiss()

    page.on("dialog", told)
    page.close(run_before_unload=True)
    page.wait_for_timeout(200)
    assert asked == ["beforeunload"]  # the browser asks before the text is lost
    assert studio.saved("text")[1].decode() == written
    studio.planned()
    assert studio.text == written


def test_a_text_that_could_not_be_kept_is_kept_once_there_is_room(studio: Studio) -> None:
    studio.ask(
        "window.real = Storage.prototype.setItem, Storage.prototype.setItem = () => { throw new Error('full'); }, 0"
    )
    studio.type("a")
    assert studio.page.locator("#kept").inner_text() != ""
    studio.ask("Storage.prototype.setItem = window.real, 0")
    studio.type("b")
    assert studio.page.locator("#kept").inner_text() == ""
    assert texts(studio.page) == [studio.text]


def test_two_tabs_with_one_text_part_and_keep_both(tabs: tuple[Studio, Studio]) -> None:
    first, second = tabs
    first.type("# first")
    second.until("document.getElementById('kept').textContent.includes('Another tab')")
    second.type("# second")
    first.type(" again")
    assert texts(first.page) == sorted([f"{CELL}# first again", f"{CELL}# second"])
    for tab, written in ((first, f"{CELL}# first again"), (second, f"{CELL}# second")):
        tab.reload()
        assert tab.text == written


def test_a_tab_that_missed_what_another_wrote_does_not_write_over_it(
    studio: Studio, context: BrowserContext, service: httpx.Client
) -> None:
    studio.page.fill("#text", CELL)
    page = context.new_page()
    page.add_init_script("addEventListener('storage', (event) => event.stopImmediatePropagation(), true)")
    second = Studio(page, service)
    studio.type("# first")
    assert second.text == CELL
    assert page.locator("#kept").inner_text() == ""
    second.type("# second")
    assert texts(page) == sorted([f"{CELL}# second", f"{CELL}# first"])
    assert "Another tab" in second.page.locator("#kept").inner_text()


def test_a_text_that_another_tab_deleted_is_kept_again_once_it_is_changed(tabs: tuple[Studio, Studio]) -> None:
    first, second = tabs
    first.page.click("#delete")
    first.until("document.getElementById('delete').hidden")
    second.until("document.getElementById('delete').hidden")
    assert second.text == CELL
    second.type("# still here")
    assert texts(second.page) == [f"{CELL}# still here"]


def test_what_is_not_ours_in_the_storage_does_no_harm(context: BrowserContext, service: httpx.Client) -> None:
    page = context.new_page()
    page.add_init_script(
        "localStorage.setItem('assur-text-x', '{'), localStorage.setItem('assur-text-y', '{\"text\": 7}'),"
        " localStorage.setItem('assur-text-z', 'null'), sessionStorage.setItem('assur-text', 'x')"
    )
    studio = Studio(page, service)
    assert studio.text == service.get("/v1/scenes/demo/text").text
    assert studio.said == []
