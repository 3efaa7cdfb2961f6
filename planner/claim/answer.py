"""What an answer states beside its plan, as rows of the plan's claim."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from assur.planner.claim import columns as c
from assur.planner.claim.columns import Claim
from assur.planner.claim.distances import least_of, proofs_of
from assur.planner.claim.filling import SceneClaim, rows_of
from assur.planner.claim.peaks import joint_peaks_of, tool_peaks_of
from assur.planner.claim.points import Rows
from assur.planner.model.claims import Claims
from assur.planner.model.outcome import Plan
from assur.planner.model.phases import Phase


def with_answer(base: SceneClaim, claim: Claim, plan: Plan, phases: Sequence[Phase], claims: Claims) -> Claim:
    """The claim of a plan (`filling.with_plan`) with rows for what an answer states: peaks, margins, working modes,
    smallest clearances, grips and supports. `phases`: those of the plan.

    What an answer states and what is not so gets a row that cannot be shown, or none; the checkers report it.
    """
    named = named_answer(base, plan, phases, claims)
    rows = {name: [row for _, row in each] for name, each in named.items()} | {
        "sums": joint_peaks_of(base.scene, plan, phases, claims.peaks or ()),
        "distances": base.distances(plan, phases).stated(claims),
    }
    tables = {name: np.concatenate([getattr(claim, name), c.table(name, added)]) for name, added in rows.items()}
    least = least_of(claims.nearest), least_of(claims.placed)
    tables["required"] = claim.required.copy()
    tables["required"][0, c.REQUIRED_NEAREST :] = least
    shown = proofs_of(base.prover, plan, phases, least)
    if shown is not None:
        tables["gap_rows"] = rows_of(shown, base.cell.carriers.body)
    return claim._replace(**tables)


def named_answer(base: SceneClaim, plan: Plan, phases: Sequence[Phase], claims: Claims) -> dict[str, Rows]:
    """The rows for what an answer states that have names for people, by their table."""
    return {
        "rates": [("tool", row) for row in tool_peaks_of(base.scene, plan, phases, claims)],
        "axes": base.postures.of_answer(plan, claims),
    }
