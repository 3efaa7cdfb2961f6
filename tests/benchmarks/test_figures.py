"""A figure is formed over clean answers only; the pages show what the committed results say."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from assur.scenes.requests import scene_of
from benchmarks import figures
from benchmarks.best_known import PATH, read, worst
from benchmarks.figures import Figure, figure, finish
from benchmarks.first_answer import OURS, figures_of
from benchmarks.judge.problems import Finding
from benchmarks.judged import SETS, label, problem_set
from benchmarks.machine import ROOT, machine
from benchmarks.peers.running import NEEDS, REQUIREMENTS, peers
from benchmarks.report import BLOCKS, MARKED, PAGE, SCRIPTS, filled, results
from benchmarks.scaling import FEW_SIZES, aside, crowd
from benchmarks.scaling import figures_of as scaling_figures
from benchmarks.session import moved
from benchmarks.side_by_side import fatal
from benchmarks.translation import Terms, request


def line(wall_s: float = 0.002, **more: Any) -> dict[str, Any]:
    """The record of a planned answer."""
    times = {"build_s": 0.001, "wall_s": wall_s, "cpu_s": wall_s, "first_s": wall_s, "check_s": 0.001}
    return {"status": "planned", **times, "checker_refused": 0, "findings": [], **more}


def answers(**more: Any) -> dict[str, dict[str, Any]]:
    """Records of every set as `benchmarks.first_answer` keeps them."""
    return {f"{OURS}/{label(*pair)}/0/{number}": line(**more) for pair in SETS for number in range(4)}


def by_name(found: list[Figure]) -> dict[str, Figure]:
    return {each.name: each for each in found}


def test_figures_stand_beside_their_bars() -> None:
    records = answers()
    shown = by_name(figures_of(records, OURS))
    median = shown["first answer, median"]
    assert (median.reached(), median.required(), median.met()) == (
        "2.00 / 2.00 / 2.00 / 2.00 ms",
        "at most 1.5 ms",
        "no",
    )
    share = shown["solved within 0.1 s"]
    assert (share.required(), share.met()) == ("at least 93 / 95 / 96 / 95 %", "yes")
    assert [each.met() for each in shown.values() if each.bar == (0.0,)] == ["yes", "yes"]


def test_one_answer_that_is_not_clean_refuses_the_figures_of_its_set_and_is_counted() -> None:
    records = answers()
    records[f"{OURS}/static/0/1"] = line(findings=["collision: link-1"], checker_refused=1)
    shown = by_name(figures_of(records, OURS))
    assert shown["first answer, median"].values[0] is None
    assert "collision" in str(shown["first answer, median"].refused)
    assert shown["first answer, median"].met() == "? / no / no / no"
    assert shown["prover accepts, checker refuses"].values == (1.0,)
    assert shown["answers that the recheck refuses"].met() == "no"
    assert figure("x", [{"a": {"status": "planned"}}], lambda _: 1.0).values == (None,)
    assert figure("x", [{}], lambda _: 1.0).refused == "nothing was measured"
    assert figure("x", [{"a": line()}], lambda _: np.nan).refused == "no answer to measure"


def test_a_result_is_read_as_it_was_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(figures, "SAMPLES", tmp_path)
    made = figures_of(answers(), OURS)
    finish("first_answer", "a test", True, {"seeds": 1}, answers(), made)
    head, records, found = figures.read(tmp_path / "first_answer.jsonl")
    assert (head["sample"], head["parameters"], found) == (True, {"seeds": 1}, made)
    assert {item: {**record, "item": item} for item, record in answers().items()} == records
    shown = BLOCKS["bars"]({"first_answer": (head, records, found)})
    assert "| first answer, median | at most 1.5 ms | 2.00 / 2.00 / 2.00 / 2.00 ms | no |  |" in shown


def test_what_each_further_body_costs_is_the_slope_between_ten_and_a_thousand() -> None:
    records = {
        f"{kind}/{size}/0/0": line(build_s=1e-3 + 2e-5 * size, wall_s=1e-3 + 2e-5 * size + 2e-3 + 1e-6 * size)
        for kind, sizes in FEW_SIZES.items()
        for size in sizes
    }
    shown = by_name(scaling_figures(records, FEW_SIZES))
    assert shown["each further distant body, planning"].values[0] == pytest.approx(1.0)
    assert shown["each further distant body, building"].values[0] == pytest.approx(20.0)
    assert shown["a thousand bodies within reach over ten, planning"].values[0] == pytest.approx(3e-3 / 2.01e-3)


@pytest.mark.parametrize("make", [crowd, aside])
def test_a_smaller_cell_is_part_of_a_larger_one(make: Any) -> None:
    small, large = make(3, 10), make(3, 200)
    assert small["obstacles"] == large["obstacles"][:10]
    assert (small["start"], small["goal"]) == (large["start"], large["goal"])


def test_a_session_goes_on_from_where_the_arm_and_its_goal_are() -> None:
    problems = problem_set("moving_goal")
    document = request(problems.problems[0], problems.limits, Terms())
    rows = np.random.default_rng(1).uniform(-0.1, 0.1, (3, 3, 4)) + np.array([0.0, 0.5, 0.15, 0.0])
    knots = {
        "time_s": [0.0, 0.2, 0.5],
        **dict(zip(("position", "velocity", "acceleration"), rows.tolist(), strict=True)),
    }
    later = moved(document, knots, 0.2, [0.01, -0.02])
    scene = scene_of(later)
    assert scene.start.time == 0.2
    for found, row in zip((scene.start.q, scene.start.qd, scene.start.qdd), rows[:, 1], strict=True):
        np.testing.assert_allclose(found, row, atol=1e-9)
    before, after = (each["frames"]["goal"]["linear"] for each in (document, later))
    slip = np.subtract(after["velocity_m_s"], before["velocity_m_s"])
    np.testing.assert_allclose(slip, [0.01, -0.02, 0.0], atol=1e-12)
    np.testing.assert_allclose(np.subtract(after["at_m"], before["at_m"]) + 0.2 * slip, 0.0, atol=1e-12)


def test_a_peer_without_a_limit_of_jerk_may_jump_in_acceleration_at_its_ends_and_nothing_else() -> None:
    still = "does not begin at rest: q̇ [0.0, 0.0, 0.0, 0.0], q̈ [1.0, 0.0, 0.0, 0.0]"
    assert not fatal(Finding("x", "start", still))
    assert fatal(Finding("x", "start", still.replace("q̇ [0.0", "q̇ [0.1")))
    assert fatal(Finding("x", "start", "begins 0.1 away from the given start"))
    assert fatal(Finding("x", "collision", "link-1 hits obstacle 0"))
    assert not fatal(Finding("x", "jerk", "joint 1 goes from -9 to 9"))


def test_a_peer_that_does_not_start_or_dies_is_missing_with_its_reason_and_the_others_go_on() -> None:
    import sys

    echo = "print('{\"version\": \"1\"}', flush=True)\nfor line in iter(input, 'x'): print(line, flush=True)"
    once = "print('{}', flush=True)\ninput()"
    commands = {"ompl": [sys.executable, "-c", echo], "mplib": [sys.executable, "-c", once]}
    with peers(("ompl", "mplib"), commands) as there:
        assert there.versions["ompl"] == "1"
        assert there.ask("ompl", {"a": 1}) == {"a": 1}
        assert there.ask("mplib", {})["status"] == "missing"
        assert "died" in there.ask("mplib", {})["reason"]
        assert there.ask("ompl", {"b": 2}) == {"b": 2}
    with peers(("ompl",), {"ompl": [sys.executable, "-c", "raise SystemExit(3)"]}) as there:
        assert "does not start" in there.ask("ompl", {})["reason"]
    lines = [line for line in REQUIREMENTS.read_text(encoding="utf-8").splitlines() if line and line[0] != "#"]
    assert {line.partition("==")[0] for line in lines if "==" in line} == {
        name for all_ in NEEDS.values() for name in all_
    }


def test_the_worst_share_is_of_the_largest_ratios(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(figures, "FOLDER", tmp_path)
    monkeypatch.setattr("benchmarks.best_known.FOLDER", tmp_path)
    records = {f"0.2/static/A{i:03}": line(duration_s=1.0 + i, best_s=1.0) for i in range(8)}
    records |= {"0.02/static/A009": line(duration_s=99.0, best_s=1.0), "0.2/static/A010": line(best_s=None)}
    finish("durations", "a test", False, {}, records, [])
    assert worst(0.25) == {"static/A006", "static/A007"}


def test_the_page_shows_what_the_committed_results_say() -> None:
    content = PAGE.read_text(encoding="utf-8")
    assert len(MARKED.findall(content)) == content.count("<!-- benchmark: ") >= 2
    assert filled(content, results()) == content


def test_the_report_shows_every_script_that_the_benchmark_runs() -> None:
    assert f"SCRIPTS := {' '.join(SCRIPTS)}\n" in (ROOT / "Makefile").read_text(encoding="utf-8")


def test_the_committed_results_are_of_whole_runs_and_records_are_of_problems_that_exist() -> None:
    for name, (head, _, _) in results().items():
        assert name in SCRIPTS
        assert not head["sample"], name
    ids = {label(name, match): {str(p["id"]) for p in problem_set(name).problems} for name, match in SETS}
    for name, records in read(PATH).items():
        assert set(records) <= ids[name]
        assert all(set(it) == {"duration_s", "by", "commit", "searched_s"} for it in records.values())


def test_what_is_said_of_the_machine_names_no_path() -> None:
    assert str(ROOT) not in str(machine())
    assert "/" not in str(machine())
