"""Plans of random cells before both checkers: a short form of ``make prove-random``."""

from __future__ import annotations

import pytest

from assur.scenes.requests import Detail, plan_document
from benchmarks.checker_refusals import SECOND
from benchmarks.proofs import Agreement, agreements, judged
from benchmarks.random_requests.random_cells import KINDS, random_cell


def test_both_checkers_agree_on_a_plan_of_each_kind_of_cell(monkeypatch: pytest.MonkeyPatch) -> None:
    def first_plan(request: dict[str, object], certificate: Detail) -> dict[str, object]:
        own = dict(request["options"])  # type: ignore[call-overload]
        own |= {"stop": "first", "budget_s": 60.0}
        request["options"] = own
        return plan_document(request, certificate=certificate)

    monkeypatch.setattr("benchmarks.judge.product.plan_document", first_plan)
    found = Agreement()
    for found in agreements(len(KINDS), 5):
        assert found.plans == found.shown
    assert (found.shown, found.differ, len(found.times)) == (len(KINDS), [], len(KINDS))


NO_LINES: dict[str, list[object]] = {"lines": []}


def test_checkers_that_differ_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    kind = next(iter(KINDS))
    monkeypatch.setattr("assur.prover.prove.prove", lambda _: (False, ["a row of one and another"]))
    monkeypatch.setattr("benchmarks.judge.product.check_document", lambda *_: {"ok": True, "findings": []})
    monkeypatch.setattr("benchmarks.judge.product.bundle_document", lambda *_: {})
    monkeypatch.setattr(
        "benchmarks.judge.product.plan_document", lambda *_, **__: {"status": "planned", "census": NO_LINES}
    )
    found = Agreement()
    judged(found, kind, 5)
    assert found.differ == [(kind, 5, f"{SECOND}; a row of one and another")]
    assert (found.shown, found.plans) == (0, 1)
    monkeypatch.setattr(
        "benchmarks.judge.product.plan_document",
        lambda *_, **__: {"status": "not_planned", "reason": "X", "census": NO_LINES},
    )
    judged(found, kind, 5)
    assert (found.plans, dict(found.refused)) == (1, {"X": 1})
    assert random_cell(kind, 5) == random_cell(kind, 5)


@pytest.mark.parametrize("seed", [5000017, 5000035])
def test_lag_of_a_closed_chain_is_bounded_joint_by_joint(seed: int) -> None:
    """Rows whose gap is 4 µm too small for a bound that takes the rates of all joints as one ball."""
    found = Agreement()
    judged(found, "five-bar", seed)
    assert (found.shown, found.differ) == (1, [])
