"""What a report holds, what it leaves out, and that it says so."""

from __future__ import annotations

import pytest

from assur.scenes.report import report as of_report
from assur.scenes.report.report import arrivals, refusal, report_of, table
from assur.scenes.scenarios import shipped
from assur.scenes.view import display_meshes
from tests.scenes.cells.answers import answer
from tests.scenes.view.shown import cell

VERDICT = {"ok": True, "findings": [], "not_checked": []}


def report(name: str) -> str:
    """The report of a shipped scenario."""
    verdict = VERDICT if answer(name)["status"] == "planned" else None
    return report_of(cell(name), answer(name), title=name, about=shipped(name).about, verdict=verdict, version="0.0")


def test_long_lists_of_numbers_are_left_out_where_the_page_would_be_too_large(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = report("demo")
    assert "Lists of more than" not in whole
    monkeypatch.setattr(of_report, "MOST_BYTES", len(whole.encode()) - 1)
    less = report("demo")
    assert len(less.encode()) < len(whole.encode())
    assert "Lists of more than" in less
    assert "numbers, SHA-256" in less


def test_a_mesh_that_is_drawn_with_fewer_triangles_is_named_with_what_was_moved(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert "is drawn with" not in report("heavy-casting-refused")
    monkeypatch.setattr(display_meshes, "MOST_TRIANGLES", 20)
    reduced = report("heavy-casting-refused")
    assert "is drawn with" in reduced
    assert "corners are off by up to" in " ".join(reduced.split())


def test_a_refusal_says_why_and_what_was_tried() -> None:
    page = report("shut-gate")
    for words in ("Why there is no plan", "BODY_COLLISION", "200 candidates", "not planned"):
        assert words in page
    assert "Arrivals" not in page


def test_how_points_are_met_is_told_as_on_the_command_line() -> None:
    page = report("demo")
    assert page.count("with its velocity") == 2
    assert page.count(">at rest<") == 1


def test_how_far_parts_are_from_tool_and_support_is_told_where_an_arrival_says_it() -> None:
    page = report("lab-arm")
    (pick,) = (each for each in answer("lab-arm")["arrivals"] if each.get("grip_m"))
    assert page.count('<th class="number">tool to part mm</th>') == 1
    assert f">{1000 * pick['grip_m']:.2f}</td>" in page
    assert all("grip_m" not in each and "support_m" not in each for each in answer("shut-gate").get("arrivals", ()))
    bare = [{**each, "grip_m": None, "support_m": None} for each in answer("demo")["arrivals"]]
    assert "to part mm" not in arrivals({**answer("demo"), "arrivals": bare})


def test_a_change_that_is_proposed_is_not_called_right() -> None:
    given = {**answer("shut-gate"), "relaxation": {"what": "clearance", "value": "2 mm", "duration_s": 1.0}}
    verdict = {**VERDICT, "not_checked": ["relaxation", "tried"]}
    page = refusal(given, verdict)
    assert "<dt>a change that is proposed</dt><dd>clearance: 2 mm</dd>" in page
    assert "<dt>not checked</dt><dd>relaxation, tried</dd>" in page
    assert "not checked" not in refusal(given, None)


def test_text_in_a_table_is_text() -> None:
    assert "<b>" not in table(["<b>"], [[("<b>bold</b>", False)]])
    assert table(["n"], [[("1", True)]]).count('class="number"') == 2
