"""A cell with streams is simulated in the studio: progress, cancel, figures, and the page of a run."""

from __future__ import annotations

import re

import pytest

from assur.scenes.scenarios import CELLS
from tests.browser.studio_page import IDLE, Studio

CELL = (CELLS / "shared" / "soap-flow.yaml").read_text(encoding="utf-8")
SHOWN = "#simulations figure"


@pytest.fixture
def simulating(studio: Studio) -> Studio:
    """The studio with the shipped cell."""
    studio.opened("soap-flow.yaml", CELL)
    assert studio.page.locator("#simulate").is_visible()
    return studio


def simulated(studio: Studio, minutes: str, seeds: str) -> None:
    studio.page.fill("#minutes", minutes)
    studio.page.fill("#seeds", seeds)
    studio.page.click("#simulate")
    studio.until(IDLE)


def figure(studio: Studio, name: str) -> str:
    return str(studio.page.locator(f"{SHOWN} dl div", has_text=name).locator("dd").inner_text())


def test_a_shipped_cell_is_simulated_and_the_page_of_its_first_run_is_shown(simulating: Studio) -> None:
    page = simulating.page
    simulated(simulating, "0.25", "2")
    assert simulating.faults == ""
    assert re.fullmatch(r"\d+\.\d \(95 % interval -?\d+\.\d to \d+\.\d\)", figure(simulating, "parts a minute"))
    assert re.fullmatch(r"\d+ of \d+", figure(simulating, "missed"))
    assert figure(simulating, "moving").endswith(" % of the time")
    assert "part " in figure(simulating, "waits for")
    assert figure(simulating, "simulated") == "0.50 min, seeds 1 to 2"
    run = page.frame_locator(f"{SHOWN} iframe")
    run.locator("html[data-ready=yes]").wait_for()
    assert "parts a minute" in run.locator(".chip").first.inner_text()
    assert not page.locator("#drawing").is_visible()
    simulating.write("mean_s: 1.5", "mean_s: 2.5")
    assert page.locator(f"{SHOWN} .stale").is_visible()
    page.locator(f"{SHOWN} button", has_text="Close").click()
    assert page.locator(SHOWN).count() == 0
    assert simulating.said == []


@pytest.mark.slow
def test_a_simulation_shows_its_progress_and_what_there_is_when_it_is_cancelled(simulating: Studio) -> None:
    page = simulating.page
    page.fill("#minutes", "50")
    page.click("#simulate")
    seconds = (
        "[...document.querySelectorAll('#numbers div')].find((row) => row.textContent.startsWith('simulated in it'))"
    )
    simulating.until(f"parseFloat(({seconds})?.lastChild.textContent) > 5")
    assert page.locator("#doing").inner_text() == "Simulating"
    assert page.locator("#plan").is_disabled()
    page.click("#cancel")
    simulating.until(IDLE)
    assert page.locator(f"{SHOWN} figcaption").inner_text().startswith("soap-flow")
    assert "simulated until it was ended" in page.locator(f"{SHOWN} figcaption").inner_text()
    assert float(figure(simulating, "simulated").split()[0]) < 50.0
    assert page.locator(f"{SHOWN} iframe").count() == 0


@pytest.mark.slow
def test_what_is_not_simulated_says_why(simulating: Studio) -> None:
    simulated(simulating, "61", "1")
    assert "minutes: got 61; allowed: at most 60" in simulating.faults
    simulating.write("mean_s: 1.5", "mean_s: 0.1")
    simulated(simulating, "0.25", "1")
    line = CELL[: CELL.index("mean_s: 1.5")].count("\n") + 1
    assert simulating.faults.startswith(f"line {line}")
    assert "cell: streams.soap.mean_s" in simulating.faults
    simulating.page.fill("#text", CELL.split("streams:")[0] + "refuge: home\n")
    simulated(simulating, "0.25", "1")
    assert "cell: streams; allowed: at least one stream" in simulating.faults
    simulating.choose("packing")
    simulated(simulating, "0.25", "1")
    assert "The cell of this task is not open here." in simulating.faults
    simulating.choose("demo")
    assert not simulating.page.locator("#simulate").is_visible()
    assert simulating.page.locator(SHOWN).count() == 0
