"""The proof bundle of a planned answer: its claim as a document, which a second checker reads (docs/bundle.md)."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from assur.planner.errors import InputError
from assur.planner.model.claims import NOTHING, Claims
from assur.scenes.requests import cell_of, read_plan
from assur.scenes.scenario import with_files

if TYPE_CHECKING:
    from assur.planner.model.outcome import Plan
    from assur.planner.model.scene import Scene
    from assur.scenes.reading.cell import Cell


def bundle_document(request: object, plan: object, *, folder: Path | None = None) -> dict[str, Any]:
    """The proof bundle of a planned answer with a full certificate (docs/bundle.md).

    `folder`: below which the request may name files. Raises `InputError` naming the field: for a fault of a document,
    for a field of the answer that repeats the request wrongly, and for a promise that no bundle can state. Whether the
    plan is right is not judged here: the prover of the bundle does that.
    """
    return bundle_cell(cell_of(request if folder is None else with_files(request, folder)), plan)


def bundle_cell(cell: Cell, plan: object) -> dict[str, Any]:
    """The same for a cell that has been read."""
    made, untrue, claims = read_plan(cell, plan)
    if untrue:
        reasons = "; ".join(finding.what for finding in untrue)
        raise InputError("plan", "this answer", f"one that is right: {reasons}")
    return bundle_of(cell.scene, made, claims)


def bundle_of(scene: Scene, plan: Plan, claims: Claims = NOTHING) -> dict[str, Any]:
    """The bundle of a plan for a scene, and of what else is stated of it. Raises `InputError` for what a bundle cannot
    state."""
    from assur.planner.claim.answer import with_answer
    from assur.planner.claim.document import document_of, labels_of
    from assur.planner.claim.filling import claim_of, with_plan
    from assur.planner.model.phases import phases

    base, of_plan = claim_of(scene), phases(scene, plan.legs, plan.arrivals)
    claim = with_answer(base, with_plan(base, plan, of_plan), plan, of_plan, claims)
    return document_of(claim, labels_of(base, plan, of_plan, claims))
