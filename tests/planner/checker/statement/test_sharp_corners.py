"""A path whose corners are sharp and rounded by little has rows that keep to it, and both checkers accept them."""

from __future__ import annotations

from typing import Any

import assur
from assur.planner.checker.claim.verdict import check_claim
from tests.planner.checker.statement.cases import differences, planned

PATH: list[dict[str, Any]] = [
    {"line": {"to_mm": [-82.24, 157.17, 96.48]}},
    {"arc": {"via_mm": [-82.48, 47.27, 109.82], "to_mm": [-48.98, -43.5, 90]}},
    {"spline": {"through_mm": [[-39.6, -71.89, 102.4], [16.43, -115.48, 87.23]]}},
    {"line": {}},
]
BLEND_MM = 3.1


def request() -> dict[str, Any]:
    """A leg along a line, an arc, a spline and a line, with sharp corners."""
    found: dict[str, Any] = assur.load("circular-legs")
    way = found["task"][2]["move"]
    way["path"] = PATH
    way["blend_mm"] = BLEND_MM
    options = found.setdefault("options", {})
    options.pop("budget_ms", None)
    options.update(stop="first", budget_s=60.0, max_candidates=60)
    return found


def test_a_leg_round_sharp_corners_is_shown_and_stated() -> None:
    case = planned(request())
    assert case is not None
    assert len(case.claim.guides) > 10
    assert check_claim(case.claim).findings == ()
    assert differences(case) == []
