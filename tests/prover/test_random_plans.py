"""Plans of random cells before both checkers: a short form of ``make prove-random``."""

from __future__ import annotations

import pytest

from assur.scenes.requests import Detail, plan_document
from benchmarks.checker_refusals import SECOND
from benchmarks.judge.campaigns import CAMPAIGNS, RunningCampaign, Tally, run
from benchmarks.random_requests.random_cells import KINDS, random_cell

PROOFS = CAMPAIGNS["proofs"]


def test_both_checkers_agree_on_a_plan_of_each_kind_of_cell(monkeypatch: pytest.MonkeyPatch) -> None:
    def first_plan(request: dict[str, object], certificate: Detail) -> dict[str, object]:
        own = dict(request["options"])  # type: ignore[call-overload]
        own |= {"stop": "first", "budget_s": 60.0}
        request["options"] = own
        return plan_document(request, certificate=certificate)

    monkeypatch.setattr("benchmarks.judge.product.plan_document", first_plan)
    going = RunningCampaign("proofs", 5)
    run([going], None, len(KINDS))
    assert (going.total.evaluated, going.total.clean) == (len(KINDS), True)


NO_LINES: dict[str, list[object]] = {"lines": []}


def test_checkers_that_differ_are_counted_as_a_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    kind = next(iter(KINDS))
    monkeypatch.setattr("assur.prover.prove.prove", lambda _: (False, ["a row of one and another"]))
    monkeypatch.setattr("benchmarks.judge.product.check_document", lambda *_: {"ok": True, "findings": []})
    monkeypatch.setattr("benchmarks.judge.product.bundle_document", lambda *_: {})
    answer = {"status": "planned", "census": NO_LINES}
    monkeypatch.setattr("benchmarks.judge.product.plan_document", lambda *_, **__: answer)
    found, request = Tally(), random_cell(kind, 5)
    assert PROOFS.judge(found, request, answer, 5) == (None, [{"kind": SECOND, "about": "a row of one and another"}])
    assert PROOFS.evaluate(found, kind, 5, request)
    assert (found.evaluated, dict(found.faults), found.clean) == (1, {SECOND: 1}, False)
    answer |= {"status": "not_planned", "reason": "X"}
    assert not PROOFS.evaluate(found, kind, 5, request)
    assert (found.evaluated, dict(found.refused)) == (1, {"X": 1})


@pytest.mark.parametrize("seed", [5000017, 5000035])
def test_lag_of_a_closed_chain_is_bounded_joint_by_joint(seed: int) -> None:
    """Rows whose gap is 4 µm too small for a bound that takes the rates of all joints as one ball."""
    found = Tally()
    assert PROOFS.evaluate(found, "five-bar", seed, random_cell("five-bar", seed))
    assert found.clean
