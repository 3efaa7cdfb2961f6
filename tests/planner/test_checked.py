"""The entry that has a plan checked: both checkers judge the claim that is made of it, and findings have names."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from assur.planner import checked
from assur.planner.checked import check, kept_cell
from assur.planner.checker import Code, Verdict, statement
from assur.planner.checker.claim.verdict import ClaimCode, ClaimFinding
from assur.planner.model.outcome import Plan
from assur.planner.model.scene import Scene
from tests.planner.checker.hand_made import crossing_case, sealed, with_rows, without


def broken(scene: Scene, plan: Plan, *codes: Code) -> str:
    """The first sentence of a verdict with these codes."""
    verdict = check(scene, plan)
    assert [finding.code for finding in verdict.findings] == list(codes)
    return verdict.findings[0].what


def test_a_right_plan_is_right_and_its_cell_is_compared_once(monkeypatch: pytest.MonkeyPatch) -> None:
    scene, plan = crossing_case()
    compared = list[Any]()
    state_cell = statement.state_cell

    def counted(*given: Any) -> Any:
        compared.append(given)
        return state_cell(*given)

    monkeypatch.setattr(checked, "state_cell", counted)
    assert check(scene, plan) == Verdict(True, ())
    assert check(scene, plan) == Verdict(True, ())
    later = replace(scene, start=replace(scene.start, time=scene.start.time + 1.0))
    assert kept_cell(later).base.cell is kept_cell(scene).base.cell
    assert not check(later, plan).ok
    assert len(compared) == 1
    # equal facts that are other objects may have been changed meanwhile: they are compared again
    assert check(replace(scene, bodies=(*scene.bodies,)), plan).ok
    assert len(compared) == 2


def test_an_earlier_start_is_another_cell() -> None:
    scene, _ = crossing_case()
    kept = kept_cell(scene)
    assert not kept.fits(replace(scene, start=replace(scene.start, time=scene.start.time - 2.0)))
    assert not kept.fits(replace(scene, frames=dict(scene.frames)))


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
    verdict = check(scene, sealed(scene, replace(plan, trajectory=replace(path, qd=faster))))
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


@pytest.mark.parametrize("name", [*ClaimCode])
def test_each_code_of_the_claim_checker_has_a_code_and_words(name: str) -> None:
    code = checked._code(name)
    assert code in Code
    if isinstance(name, ClaimCode) and name not in (ClaimCode.FORM, ClaimCode.FAULT):
        assert checked._named(ClaimFinding(name, "", np.nan), {}).what == checked.WORDS[name]


def test_findings_have_names_where_rows_have_them_and_their_time() -> None:
    labels = {"points": ["pick"], "bodies": ["cup", "post"]}
    found = [
        checked._named(ClaimFinding(code, what, 0.5), labels)
        for code, what in (
            (ClaimCode.POINT, "number 0"),
            (ClaimCode.GUIDE, "number 7"),
            (ClaimCode.ROW, "row 4, bodies 1 and -1"),
        )
    ]
    assert [each.where for each in found] == ["0.5 s"] * 3
    assert found[0].what == "pick: the tool is not at its point, or does not move with it"
    assert found[1].what == "the tool leaves its way"
    assert found[2].what == "row 4, post and what never moves: a row does not hold"
