"""The table says of each bar what was reached, and the pages show what the committed results say."""

from __future__ import annotations

from pathlib import Path

import pytest
import typer

from benchmarks.bars import BARS, FOUR, lines, refused, table
from benchmarks.bench import main
from benchmarks.machine import ROOT
from benchmarks.plots import draw
from benchmarks.report import BLOCKS, MARKED, PAGES, RESULTS, filled, printed, results, sections
from benchmarks.sections import durations
from benchmarks.sections.all_of_them import SECTIONS
from tests.benchmarks import made_up


@pytest.fixture(autouse=True)
def known(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Records against which made-up durations have ratios."""
    made_up.long_records(tmp_path / "known.json")
    monkeypatch.setattr(durations, "PATH", tmp_path / "known.json")


def by_title(there: dict[str, made_up.Document]) -> dict[str, tuple[str, str, str]]:
    return {line.title: (line.bar, line.reached, line.met) for line in lines(there)}


def test_every_figure_that_the_table_shows_is_made_by_its_section() -> None:
    made = {name: {figure.name for figure in summary.figures} for name, summary in made_up.summaries().items()}
    assert set(made) == {section.name for section in SECTIONS}
    assert [(bar.title, name) for bar in BARS for name in bar.figures if name not in made[bar.section]] == []
    assert all(len(bar.bars) == len(bar.figures) for bar in BARS)


def test_the_bars_are_those_that_were_set() -> None:
    asked = {line.title: line.bar for line in lines({})}
    assert asked["solved within 0.1 s"] == "at least 93 / 90 / 92 / none %"
    assert asked["solved within 1 s"] == "at least 95 / 95 / 95 / 92 %"
    assert asked["first answer, median"] == "at most 3 ms"
    assert asked["first answer, 95 %"] == "at most 30 ms"
    assert asked["duration at 0.2 s over the best known, median"] == "at most 1.05"
    assert asked["duration at 0.2 s over the best known, 95 %"] == "at most 1.25"
    assert asked["dyad, ours over the mended printed equations"] == "at most 0.4"
    assert asked["straight legs over Ruckig's joint move, median"] == "at most 1.1"
    assert asked["planning time, 10 to 1,000 bodies"] == "at most 3 times"
    assert asked["planning time, 1 to 10 control points: via / move / pick"] == "at most 12 times"
    assert asked["HTTP round trip minus planning, median"] == "at most 3 ms"
    assert asked["two workers over one, requests per second"] == "at least 1.8 times"
    assert {line.reached for line in lines({})} == {"not measured"}


def test_figures_stand_beside_their_bars() -> None:
    shown = by_title(made_up.results())
    assert shown["solved within 0.1 s"][1:] == ("100 / 100 / 100 / 100 %", "yes")
    assert shown["first answer, median"][1:] == ("2.0 / 2.0 / 2.0 / 2.0 ms", "yes")
    assert shown["duration at 0.2 s over the best known, median"][1:] == ("1.111 / 1.111 / 1.111 / 1.111", "no")
    assert shown["dyad, ours over the mended printed equations"][1:] == ("0.25", "yes")
    assert shown["straight legs over Ruckig's joint move, median"][1:] == ("1.100", "yes")
    assert shown["planning time, 10 to 1,000 bodies"][1:] == ("2.0 times", "yes")
    assert shown["HTTP round trip minus planning, median"][1:] == ("2.0 ms", "yes")
    assert shown["two workers over one, requests per second"][1:] == ("1.90 times", "yes")
    assert shown["plans in which checker or recheck find anything"][1:] == ("0 of 70", "yes")


def test_a_refused_figure_is_printed_as_refused_and_never_as_a_number() -> None:
    there = made_up.results()
    for figure in there["sets"]["figures"]:
        if figure["name"].startswith("moving bodies: "):
            figure |= {"value": None, "refused": "1 not clean, first B007: collision"}
    there["sets"]["answers"]["not_clean"] = ["moving_bodies/position/adaptive/B007"]
    shown = by_title(there)
    assert shown["first answer, median"][1:] == ("2.0 / refused / 2.0 / 2.0 ms", "yes / ? / yes / yes")
    assert shown["plans in which checker or recheck find anything"][1:] == ("1 of 70", "no")
    (why,) = [text for text in refused(there) if "B007" in text]
    assert why.startswith("1 not clean, first B007: collision: moving bodies: solved within 0.1 s;")
    assert "B007" in BLOCKS["refusals"](there)
    assert table(there).row_count == len(BARS) + 1


def test_a_bar_that_is_missed_on_one_set_says_on_which() -> None:
    there = made_up.results()
    (slow,) = [figure for figure in there["sets"]["figures"] if figure["name"] == f"{FOUR[2]}: first answer, median"]
    slow["value"] = 3.04
    assert by_title(there)["first answer, median"][1:] == ("2.0 / 2.0 / 3.0 / 2.0 ms", "yes / yes / no / yes")
    (few,) = [figure for figure in there["sets"]["figures"] if figure["name"] == f"{FOUR[1]}: solved within 0.1 s"]
    few["value"] = 89.0
    assert by_title(there)["solved within 0.1 s"][1:] == ("100 / 89 / 100 / 100 %", "yes / no / yes / none")


def test_figures_beside_the_bars_are_shown_too_and_none_twice_without_a_note() -> None:
    there = made_up.results()
    shown = BLOCKS["others"](there)
    assert "| dyad: printed | 80 ns |  |" in shown
    assert "straight legs over the joint move, 95 %" in shown
    assert "static: solved within 0.1 s |" not in shown
    (unsolved,) = [one for one in there["sets"]["figures"] if one["name"] == "static: solved within 1 s"]
    unsolved["note"] = "not solved: A005"
    assert "| static: solved within 1 s | 100 % | not solved: A005 |" in BLOCKS["others"](there)


def test_a_peer_that_is_missing_is_shown_with_its_reason() -> None:
    there = made_up.results()
    shown = BLOCKS["peers"](there)
    assert "| MPlib |  | missing: no wheel |" in shown
    assert "| OMPL RRTConnect | 2 | 10 of 10 | 0 of 10 | 10 | 10.0 ms | 70.0 / 70.0 ms | 0.600 s |" in shown
    assert printed("peers", shown).row_count == 3
    assert any(text.startswith("missing: no wheel: MPlib: solved") for text in refused(there))


@pytest.mark.parametrize("page", PAGES, ids=[page.name for page in PAGES])
def test_the_pages_show_what_the_committed_results_say(page: Path) -> None:
    content = page.read_text(encoding="utf-8")
    assert len(MARKED.findall(content)) == content.count("<!-- benchmark: ") >= 2
    assert filled(content, results()) == content


def test_a_page_that_shows_something_else_is_found() -> None:
    page = PAGES[1].read_text(encoding="utf-8")
    there = made_up.results()
    shown = filled(page, there)
    assert shown != page
    assert filled(shown, there) == shown
    for wrong in (shown.replace("2.0 / 2.0", "1.0 / 2.0", 1), shown.replace("| MPlib |", "| Mplib |", 1)):
        assert wrong != shown
        assert filled(wrong, there) == shown
    assert {name for _, name, _, _ in MARKED.findall(page)} == {
        name for name in BLOCKS if not name.startswith("readme")
    }


def test_the_committed_results_are_of_whole_clean_runs() -> None:
    for name, document in sections(results(RESULTS)).items():
        assert name in {section.name for section in SECTIONS}
        assert not document["sample"], name
        assert document["answers"]["not_clean"] == [], name


def test_the_plots_are_drawn_from_the_results(tmp_path: Path) -> None:
    drawn = draw(made_up.results(), tmp_path)
    assert sorted(path.name for path in drawn) == sorted(
        f"{name}.{kind}" for name in ("solved", "duration", "scaling") for kind in ("png", "svg")
    )
    assert all(path.stat().st_size > 5_000 for path in drawn)
    assert draw({}, tmp_path / "none") == []


def test_a_quick_run_leaves_the_results_of_the_repository_alone(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = sorted(path.name for path in RESULTS.glob("*")), (ROOT / "benchmarks/best_known.json").read_bytes()
    with pytest.raises(typer.Exit) as ended:
        main(quick=True, only=["dyad"], out=None, progress=tmp_path, fresh=False)
    assert ended.value.exit_code == 0
    assert "dyad, ours over the mended printed equations" in capsys.readouterr().out
    assert [path.name for path in (tmp_path / "quick" / "results").iterdir()] == ["dyad.json"]
    assert (
        sorted(path.name for path in RESULTS.glob("*")),
        (ROOT / "benchmarks/best_known.json").read_bytes(),
    ) == before
