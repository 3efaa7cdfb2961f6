"""The compiled functions say what their originals say, what does not is not timed, and without numba that is said.

Where numba is not installed the kernels run as plain Python, so what they compute is held here in either case.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import typer

from benchmarks.compiled import __main__ as program
from benchmarks.compiled import calls, door, measuring, packing, replacements, requests, table
from benchmarks.compiled.comparing import ALIKE, Beside, Differs, Timed, difference
from benchmarks.compiled.floor import MARK, place
from benchmarks.compiled.replacements import REPLACEMENTS, Gone, Replacement, replaced
from benchmarks.compiled.requests import AFTER, BEFORE, Answer, Both, Question, in_turn, questions
from benchmarks.report import BLOCKS, NOTHING, RESULTS
from planner.pipeline import plan
from planner.separation import rough_gaps
from planner.solids import Carriers, Solids
from scenes.requests import scene_of

Document = dict[str, Any]
RESULT = json.loads((RESULTS / program.NAME).read_text(encoding="utf-8"))
QUESTIONS = questions()
FEW = 12
"""Candidates: enough for a plan of the problems here, few enough for plain Python."""


def small(title: str) -> Question:
    """A problem of a set that is solved at the first attempt."""
    return next(question for question in QUESTIONS[title] if question.problem["direct"])


SINGLE = [replacement for replacement in REPLACEMENTS if not replacement.fused]
"""Functions of a plain meaning. The fused ones follow the inside of the planner; the experiment itself compares them,
and does not go on where they have parted."""


@pytest.mark.parametrize("title", list(QUESTIONS))
def test_every_single_function_says_to_the_last_digits_what_its_original_says(
    title: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(calls.UNHURRIED, "max_candidates", FEW)
    packing.FALLBACKS.clear()
    with np.errstate(all="ignore"):
        found = calls.compared([small(title)], SINGLE)
    assert set(found) == {replacement.name for replacement in SINGLE}
    assert {name: told.worst for name, told in found.items() if not told.worst <= ALIKE} == {}
    silent = {name for name, told in found.items() if told.calls == 0}
    assert silent <= {"gjk.separate", "separation.swept_gaps", "separation.face_normals"}
    assert dict(packing.FALLBACKS) == {}


def broken(answer: Callable[..., Any], by: float) -> Replacement:
    def wrong(solids: Solids, where: Carriers, a: Any, b: Any) -> Any:
        return answer(solids, where, a, b) + by

    return Replacement("planner.separation", "rough_gaps", wrong)


def test_a_function_that_is_off_ends_the_comparison() -> None:
    scene = scene_of(small("static").document)
    with replaced((broken(rough_gaps, 1e-13),), Beside()):
        plan(scene)
    with (
        pytest.raises(Differs, match=r"separation\.rough_gaps: the compiled function is off by 1e-06"),
        replaced((broken(rough_gaps, 1e-6),), Beside()),
    ):
        plan(scene)


@pytest.mark.parametrize(
    ("one", "other", "told"),
    [
        (np.array([1.0, np.nan, np.inf]), np.array([1.0, np.nan, np.inf]), 0.0),
        (np.array([1000.0]), np.array([1001.0]), 1e-3),
        (np.array([0.001]), np.array([0.002]), 1e-3),
        (np.array([1.0]), np.array([np.nan]), np.inf),
        (np.array([1.0]), np.array([np.inf]), np.inf),
        (np.array([1.0]), np.array([1.0, 1.0]), np.inf),
        (np.array([1]), np.array([2]), np.inf),
        (np.array([True]), np.array([False]), np.inf),
        ((1.0, None), (1.0, 0.0), np.inf),
        ((1.0, "a"), (1.5, "a"), 0.5),
        ({"a": 1.0}, {"b": 1.0}, np.inf),
        (Carriers(np.zeros(1), np.zeros(1)), Carriers(np.zeros(1), np.ones(1)), 1.0),
    ],
)
def test_differences_are_found_wherever_they_are(one: Any, other: Any, told: float) -> None:
    assert difference(one, other) == pytest.approx(told)
    assert difference(one, one) == 0.0


def test_everything_is_put_back_even_after_an_error() -> None:
    before = {replacement.name: replacement.original for replacement in REPLACEMENTS}
    screening = sys.modules["planner.screening"]
    place_before = vars(screening)["place"]
    with replaced():
        assert all(replacement.original is replacement.compiled for replacement in REPLACEMENTS)
        assert vars(screening)["place"] is not place_before
    with pytest.raises(ZeroDivisionError), replaced():
        raise ZeroDivisionError
    assert {replacement.name: replacement.original for replacement in REPLACEMENTS} == before
    assert vars(screening)["place"] is place_before


@pytest.mark.parametrize(
    ("module", "attribute"), [("planner.nowhere", "x"), ("planner.gjk", "x"), ("planner.gjk", "x.y")]
)
def test_what_the_planner_no_longer_has_is_an_error_and_nothing_is_touched(module: str, attribute: str) -> None:
    gone = Replacement(module, attribute, print)
    first = REPLACEMENTS[0]
    before = first.original
    with pytest.raises(Gone, match="the experiment must follow the planner"), replaced((first, gone)):
        pytest.fail("it went on")
    assert first.original is before


def test_calls_are_repeated_original_and_compiled_in_turn() -> None:
    order: list[str] = []

    def stand_in(solids: Solids, where: Carriers, a: Any, b: Any) -> Any:
        order.append("compiled")
        return rough_gaps(solids, where, a, b)

    clock = Timed(3)
    with replaced((Replacement("planner.separation", "rough_gaps", stand_in),), clock):
        plan(scene_of(small("static").document))
    assert clock.calls > 0
    assert len(order) == 3 * clock.calls
    assert clock.after_s >= 0 < clock.before_s


def test_without_numba_the_program_says_so_and_measures_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(door, "numba", None)
    with pytest.raises(typer.Exit) as ended:
        program.main(quick=True, out=tmp_path)
    assert ended.value.exit_code == 2
    said = " ".join(capsys.readouterr().out.split())
    assert said.startswith("numba is not installed in this environment")
    assert "make bench-compiled" in said
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("error", [Gone("planner.x has no y"), Differs("x: off by 1")])
def test_where_planner_and_kernels_have_parted_nothing_is_timed(
    error: Exception, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def experiment(*_: Any) -> Document:
        raise error

    monkeypatch.setattr(door, "is_there", lambda: True)
    monkeypatch.setattr(program, "pin", lambda: "not pinned")
    monkeypatch.setattr(measuring, "experiment", experiment)
    with pytest.raises(typer.Exit) as ended:
        program.main(quick=True, out=tmp_path)
    assert ended.value.exit_code == 1
    assert f"Nothing was timed: {error}" in " ".join(capsys.readouterr().out.split())
    assert list(tmp_path.iterdir()) == []


def answer(elapsed_s: float, digest: str | None = "x", findings: tuple[str, ...] = ()) -> Answer:
    return Answer(elapsed_s, digest, None if digest is None else 0.5, findings)


def both(number: int, before: list[Answer], after: list[Answer]) -> Both:
    return Both(QUESTIONS["static"][number], {BEFORE: before, AFTER: after})


def test_each_way_begins_in_turn_and_what_neither_solves_is_asked_once(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[tuple[str, str]] = []

    def answered(question: Question, way: str) -> Answer:
        asked.append((question.problem["id"], way))
        return answer(0.01, None if question.problem["id"] == "A001" else "x")

    monkeypatch.setattr(requests, "answered", answered)
    made = list(in_turn(QUESTIONS["static"][:2], 2))
    assert asked == [
        *(("A000", way) for way in (BEFORE, AFTER, AFTER, BEFORE)),
        *(("A001", way) for way in (AFTER, BEFORE)),
    ]
    assert [one.first_s(BEFORE) for one in made] == [0.01, None]


def test_figures_are_of_the_quickest_rounds_and_refused_where_an_answer_is_not_clean() -> None:
    rounds = [answer(t) for t in (0.04, 0.2, 0.02)]
    clean = [both(0, rounds, [answer(0.01)] * 3), both(1, [answer(1.0, None)], [answer(1.0, None)])]
    found = {figure.name: figure for figure in measuring.figures("static", clean)}
    assert found["static: first answer, median, original"].value == pytest.approx(20.0)
    assert found["static: compiled over original, median"].value == pytest.approx(0.5)
    assert found["static: solved within 0.1 s, original"].value == 50.0
    dirty = [both(0, rounds, [answer(0.01, findings=("collision: x",))])]
    assert {figure.value for figure in measuring.figures("static", dirty)} == {None}
    assert all("collision: x" in str(figure.refused) for figure in measuring.figures("static", dirty))


def test_the_requests_nearest_to_a_quantile_are_chosen_from_the_originals_times() -> None:
    of_set = [both(k, [answer(0.01 * (k + 1))], [answer(0.001)]) for k in range(5)] + [both(5, [answer(1.0, None)], [])]
    chosen, middle = measuring.nearest(of_set, 0.5, 1)
    assert [question.problem["id"] for question in chosen] == ["A002"]
    assert middle == pytest.approx(0.03)
    assert measuring.nearest(of_set[5:], 0.5, 1) == ([], 0.0)


@pytest.mark.parametrize(
    ("modules", "told"),
    [
        (["benchmarks.compiled.floor", "planner.pipeline", "planner.search"], "rest"),
        (["planner.pipeline", "planner.screening", "benchmarks.compiled.screening"], MARK + "screening (supports)"),
        (["planner.screening", "benchmarks.compiled.screening", "planner.collision"], "screening (fcl)"),
        (["planner.search", "benchmarks.compiled.proving", "numba.x"], MARK + "certificate"),
        (["planner.margins", "benchmarks.compiled.nearest"], MARK + "margins"),
        (["planner.checker.check", "benchmarks.compiled.checking"], MARK + "checker"),
        (["planner.timing.solver", "numpy"], "timing (ruckig)"),
    ],
)
def test_a_stack_is_compiled_where_its_innermost_frame_of_ours_is(modules: list[str], told: str) -> None:
    assert place(modules) == told


def test_the_committed_result_is_of_a_whole_clean_run_over_all_replaced_functions() -> None:
    data = RESULT["data"]
    assert RESULT["schema"] == "assur-benchmark/1"
    assert RESULT["section"] == "compiled"
    assert (RESULT["sample"], RESULT["changed"]) == (False, False)
    assert RESULT["answers"]["not_clean"] == []
    assert all(figure["value"] is not None for figure in RESULT["figures"])
    assert [row["function"] for row in data["functions"]] == data["replaced"]
    assert data["replaced"] == [replacement.name for replacement in replacements.REPLACEMENTS]
    assert all(row["difference"] <= RESULT["parameters"]["alike"] for row in data["functions"])
    assert set(data["sets"]) == set(QUESTIONS)
    assert all(len(rows) == 100 for rows in data["sets"].values())
    assert data["compiled_late"] == 0


def test_the_floor_is_never_above_the_compiled_time() -> None:
    assert RESULT["data"]["stages"]
    for of in RESULT["data"]["stages"].values():
        assert 0 < of["floor_ms"] <= of["compiled_ms"] < of["original_ms"]
        assert all(0 <= row["rest"] <= row["compiled"] + 1e-12 for row in of["stages_ms"].values())


def test_the_page_shows_requests_stages_functions_and_what_it_was_measured_on() -> None:
    shown = BLOCKS["compiled"]({"compiled": RESULT})
    for made in (table.requests, table.stages, table.functions, table.starting):
        assert made(RESULT) in shown
    assert RESULT["commit"][:10] in shown
    assert BLOCKS["compiled"]({}) == NOTHING
    worse = json.loads(json.dumps(RESULT))
    for figure in worse["figures"]:
        figure["value"] = None
    assert "refused" in table.requests(worse)
