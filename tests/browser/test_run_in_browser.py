"""The page of a run in a real Chromium: the first view is of the arm, and only what is known and near has a name."""

from __future__ import annotations

from functools import cache
from typing import Any

import pytest

from assur.scenes.report.run_report import run_report
from assur.scenes.session.recorded import Events
from assur.scenes.simulation.cell_file import cell_named
from assur.scenes.simulation.simulate import Simulation
from tests.browser.test_labels import OVERLAPS, SHOWN

pytestmark = pytest.mark.slow

CELLS = ("belt-to-nest", "two-belts-two-places")
CUT_MINUTES = 0.594
"""So long a run of the first cell ends while the arm goes to a part."""
# From where to where the axes of the arm at the begin and the path of its tool are: shares of the width and the height.
TAKEN = """(() => {
    const { batches, tracks } = assur.renderer;
    const { clientWidth: width, clientHeight: height } = assur.canvas;
    const at = (p) => { const { x, y } = assur.renderer.onPage(p); return [x / width, y / height]; };
    const { points } = tracks.toolPath;
    const all = Array.from({ length: points.length / 3 }, (_, k) => at(points.subarray(3 * k, 3 * k + 3)));
    const own = batches.filter(({ kinds }) => kinds.has('robot') || kinds.has('tool'));
    for (const { carrier, low, high } of own) for (const p of [low, high]) {
        const { p: origin } = tracks.carriers[carrier].at(0);
        all.push(at([origin[0], origin[1], origin[2] + p[2]]));
    }
    const span = (k) => all.map((each) => each[k]).reduce(([a, b], c) => [Math.min(a, c), Math.max(b, c)], [9, -9]);
    return [span(0), span(1)];
})()"""
PARTS = """assur.view.bodies.filter(({ kind, name }) => kind === 'part')
    .filter((body) => assur.tracks.isThere(body, assur.t)).map(({ name }) => name)"""
FAR_M = "{}.map((name) => assur.view.bodies.find((body) => body.name === name))" + (
    ".map((body) => Math.hypot(...assur.tracks.bodyPose(body, assur.t).p))"
)


@cache
def page(name: str, minutes: float = 0.6) -> str:
    """The page of half a minute of a cell of the benchmark."""
    made, events = Simulation(cell_named(f"benchmarks/flows/{name}.yaml", {}).document, minutes, 1, 1, 20.0), Events()
    made.run(record=events)
    return run_report(events.events, title=name, about="", version="0", found=made.document)


@pytest.mark.parametrize("name", CELLS)
def test_the_first_view_is_of_the_arm_and_all_of_its_path(name: str, opened: Any) -> None:
    shown = opened(name, page(name))
    for view in ("perspective", "top", "side", "front"):
        shown.ask(f"assur.look('{view}')")
        spans = shown.ask(TAKEN)
        assert all(0.0 <= low < high <= 1.0 for low, high in spans), view
    shown.ask("assur.look('perspective')")
    assert max(high - low for low, high in shown.ask(TAKEN)) > 0.5
    assert shown.said == []


def test_a_point_that_the_run_does_not_reach_is_neither_shown_nor_in_the_first_view(opened: Any) -> None:
    """The run ends while the arm goes to a part that is far upstream at the begin."""
    shown = opened("cut", page(CELLS[0], CUT_MINUTES))
    unmet = "assur.view.control_points.filter(({ time_s }) => time_s === null)"
    assert shown.ask(f"{unmet}.length") == 1
    assert shown.ask(f"{unmet}.some((point) => assur.tracks.isShown(point, 0))") is False
    assert max(high - low for low, high in shown.ask(TAKEN)) > 0.5


@pytest.mark.parametrize("name", CELLS)
def test_a_part_is_shown_from_when_it_is_known(name: str, opened: Any) -> None:
    shown = opened(name, page(name))
    assert shown.ask(PARTS) == []  # the belts are empty at the begin
    most = 0
    for share in (0.3, 0.6, 0.9):
        shown.ask(f"assur.seek({share} * assur.view.lasts_s)")
        there = shown.ask(PARTS)
        most = max(most, len(there))
        assert max(shown.ask(FAR_M.format(there)), default=0.0) < 1.2  # none is upstream of its line
    assert 0 < most < 12
    parts = shown.ask("assur.view.bodies.filter(({ kind }) => kind === 'part').length")
    assert parts > most


@pytest.mark.parametrize("name", CELLS)
def test_no_label_of_a_run_hides_another_or_is_there_twice(name: str, opened: Any) -> None:
    shown, most = opened(name, page(name)), 0
    for share in (0.0, 0.3, 0.6, 0.9):
        shown.ask(f"assur.seek({share} * assur.view.lasts_s)")
        assert shown.ask(OVERLAPS) == 0
        labels = shown.ask(SHOWN)
        assert len(labels) == len(set(labels))
        most = max(most, len(labels))
    assert most > 1
