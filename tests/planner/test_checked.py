"""The entry that has a plan checked: both checkers judge the claim that is made of it, and findings have names."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from assur.planner import checked, pipeline
from assur.planner.checked import check, stated_scene
from assur.planner.checker import Code, Verdict, statement
from assur.planner.checker.claim.verdict import KINDS, ClaimFinding
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import box
from assur.planner.laws import conveyor
from assur.planner.model.kept import MOST, NOTHING_KEPT
from assur.planner.model.outcome import Plan, Planned
from assur.planner.model.scene import Scene
from tests.planner.cells import cell, frame, go, stands
from tests.planner.checker.hand_made import crossing_case, sealed, with_rows, without
from tests.planner.trajectory.changed import changed as changed_path


def broken(scene: Scene, plan: Plan, *codes: Code) -> str:
    """The first sentence of a verdict with these codes."""
    verdict = check(scene, plan)
    assert [finding.code for finding in verdict.findings] == list(codes)
    return verdict.findings[0].what


def test_a_right_plan_is_right_and_its_cell_is_compared_once(monkeypatch: pytest.MonkeyPatch) -> None:
    scene, plan = crossing_case()
    scene = replace(scene, bodies=(*scene.bodies,))  # a cell of its own, which no other test has had compared
    compared = list[Any]()
    state_cell = statement.state_cell

    def counted(*given: Any) -> Any:
        compared.append(given)
        return state_cell(*given)

    monkeypatch.setattr(checked, "state_cell", counted)
    assert check(scene, plan) == Verdict(True, ())
    assert check(scene, plan) == Verdict(True, ())
    later = replace(scene, start=replace(scene.start, time=scene.start.time + 1.0))
    assert stated_scene(later).base.cell is stated_scene(scene).base.cell
    assert not check(later, plan).ok
    assert len(compared) == 1
    # equal facts that are other objects may have been changed meanwhile: they are compared again
    assert check(replace(scene, bodies=(*scene.bodies,)), plan).ok
    assert len(compared) == 2


def test_an_earlier_start_and_other_frames_distances_and_lags_are_claimed_anew() -> None:
    scene, _ = crossing_case()
    cell_claim = stated_scene(scene).base.cell
    assert stated_scene(replace(scene, task=scene.task[:1])).base.cell is cell_claim
    lag = replace(scene.execution, start_tolerance_s=0.01)
    for other in (
        replace(scene, frames=dict(scene.frames)),
        replace(scene, execution=lag),
        replace(scene, options=replace(scene.options, clearance=replace(scene.options.clearance, travel_m=0.1))),
        replace(scene, start=replace(scene.start, time=scene.start.time - 2.0)),
    ):
        assert stated_scene(other).base.cell is not cell_claim


def test_a_cell_keeps_values_for_scenes_of_the_same_objects_only() -> None:
    scene, _ = crossing_case()
    later = replace(scene, start=replace(scene.start, time=scene.start.time + 1.0))
    assert later.kept is scene.kept
    assert later.pieces is scene.pieces
    fewer = replace(scene, bodies=scene.bodies[1:])
    assert fewer.kept is not scene.kept
    assert len(fewer.pieces.count) == len(scene.pieces.count) - 1
    assert not NOTHING_KEPT.fits(scene)
    made = [scene.kept.of(lambda _: object(), scene, number) for number in range(2 * MOST)]
    assert len(scene.kept._made) <= MOST
    assert len(set(map(id, made))) == 2 * MOST


def test_what_a_caller_raises_between_blocks_is_raised() -> None:
    scene, plan = crossing_case()

    def late() -> None:
        raise TimeoutError

    with pytest.raises(TimeoutError):
        check(scene, plan, between=late)


def test_findings_name_bodies_joints_and_steps() -> None:
    scene, plan = crossing_case()
    names = plan.certificate.names
    normal = -plan.certificate.normal
    what = broken(scene, with_rows(scene, plan, normal=normal), Code.ROW)
    assert sum(name in what for name in names) == 2
    assert what.endswith("a row does not hold")
    rows = plan.certificate.first == plan.certificate.first[0]
    uncovered = check(scene, without(scene, plan, rows)).findings
    assert {finding.code for finding in uncovered} == {Code.COVER}
    assert all(names[plan.certificate.first[0]] in finding.what for finding in uncovered)
    path = plan.trajectory
    faster = path.qd.copy()
    faster[1, 0] += 100.0
    verdict = check(scene, sealed(scene, replace(plan, trajectory=changed_path(path, qd=faster))))
    assert f"joint {scene.robot.joints[0].name}: a limit is not kept" in [each.what for each in verdict.findings]
    assert all(each.where.endswith(" s") for each in verdict.findings if each.code == Code.LIMIT)


def test_a_certificate_about_a_body_that_there_is_not_is_refused() -> None:
    scene, plan = crossing_case()
    names = ("nobody", *plan.certificate.names[1:])
    assert "'nobody'" in broken(scene, with_rows(scene, plan, names=names), Code.ROW)
    first = plan.certificate.first.copy()
    for number in (len(names), -1):
        first[3] = number
        assert "row 3" in broken(scene, with_rows(scene, plan, first=first), Code.ROW)


def test_another_digest_is_refused() -> None:
    scene, plan = crossing_case()
    broken(scene, replace(plan, certificate=replace(plan.certificate, digest="sha256:0")), Code.DIGEST)


def test_findings_have_names_where_rows_have_them_and_their_time() -> None:
    names = {"points": ["pick"], "bodies": ["cup", "post"], "joints": ["joint j1"], "phases": ["phase travel"]}
    steps, words = [(0.0, 0.4, "pick"), (0.4, 1.0, "place")], {code: what for code, _, what in KINDS}
    found = [
        checked._named(ClaimFinding(code, words[code], table, row, bodies, 0.5, amount), names, steps)
        for code, table, row, bodies, amount in (
            (Code.POINT, "points", 0, (), np.nan),
            (Code.GUIDE, "guides", 7, (), 2e-5),
            (Code.ROW, "rows", 4, (1, -1), np.nan),
            (Code.LIMIT, "joints", 0, (), np.nan),
            (Code.COVER, "phases", 0, (0, 1), np.nan),
            (Code.PHASE, "", 0, (), np.nan),
        )
    ]
    assert [each.where for each in found] == ["0.5 s"] * len(found)
    assert [each.what for each in found] == [
        "pick: the tool is not at its point, or does not move with it",
        "place: the tool leaves its way",
        "row 4, post and what never moves: a row does not hold",
        "joint j1: a limit is not kept",
        "phase travel, cup and post: no rows for all of the time",
        words[Code.PHASE],
    ]
    assert [(each.amount, each.unit) for each in found if not math.isnan(each.amount)] == [(2e-5, "m")]


def test_a_plan_that_ends_after_a_day_is_right() -> None:
    scene = cell(go(0.35, -0.25, 0.15, leg="joint"), time=99_999.9)
    outcome = pipeline.plan(scene)
    assert isinstance(outcome, Planned)
    assert outcome.plan.trajectory.end > 100_000.0
    assert check(scene, outcome.plan) == Verdict(True, ())


def test_of_a_plan_that_ends_after_a_day_beside_a_belt_the_belt_is_named() -> None:
    belt = frame("belt", conveyor(Pose(0.0, 3.0, 0.0), 0.1, at_time=99_990.0))
    part = stands("part", box(0.05, 0.05, 0.05), frame="belt")
    scene = cell(go(0.35, -0.25, 0.15, leg="joint"), frames=(belt,), bodies=(part,), time=99_999.9)
    still = replace(scene, bodies=())
    outcome = pipeline.plan(still)
    assert isinstance(outcome, Planned)
    found = check(scene, sealed(scene, outcome.plan)).findings
    assert found[0].code == Code.LAW
    assert found[0].what.startswith("the motion of belt is stated until 100,000 s only, and the plan ends at 100,000.")
