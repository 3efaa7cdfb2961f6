"""Answers to the shipped scenarios, each planned once, and to other requests; and what the checker finds in them."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

from assur.planner.checked import check
from assur.planner.checker import Code
from assur.planner.model.digest import digest
from assur.planner.model.outcome import Plan, Planned
from assur.planner.model.scene import Scene
from assur.planner.pipeline import plan
from assur.scenes.requests import cell_of, check_document, plan_cell, plan_document, scene_of
from assur.scenes.scenarios import shipped

Document = dict[str, Any]


@cache
def answer(name: str) -> Document:
    """The answer to a shipped scenario."""
    scenario = shipped(name)
    with scenario.located():
        return plan_cell(cell_of(scenario.request, folder=scenario.folder), unstated={"report": "full"})


@cache
def proof(name: str) -> tuple[Scene, Plan]:
    """A cell's scene and plan."""
    scene = scene_of(shipped(name).request)
    outcome = plan(scene)
    assert isinstance(outcome, Planned)
    return scene, outcome.plan


def forged(name: str, **columns: Any) -> set[Code]:
    """What the checker finds when columns of the proof are others and its digest fits; false rows cover nothing."""
    scene, honest = proof(name)
    other = replace(honest.certificate, **columns)
    parts = (scene.digest, honest.trajectory, honest.legs, honest.arrivals, other)
    verdict = check(scene, replace(honest, certificate=replace(other, digest=digest(*parts))))
    return {finding.code for finding in verdict.findings}


def planned(request: Document) -> Document:
    """The plan for a request, which the checker accepts."""
    made = plan_document(request)
    assert made["status"] == "planned", made["sentence"]
    verdict = check_document(request, made)
    assert verdict["ok"], verdict["findings"]
    return dict(made)


def not_planned(request: Document) -> Document:
    """The refusal of a request."""
    made = plan_document(request)
    assert made["status"] == "not_planned"
    return dict(made)


def findings_of(request: Document, given: Document) -> set[str]:
    """What the checker finds in an answer to a request."""
    return {finding["code"] for finding in check_document(request, given)["findings"]}


def resealed(request: dict[str, Any], plan: Plan) -> Plan:
    """The plan with the digest that it should have, so that it is not refused for that alone."""
    scene = cell_of(request).scene
    c = plan.certificate
    fits = digest(scene.digest, plan.trajectory, plan.legs, plan.arrivals, c)
    return replace(plan, certificate=replace(c, digest=fits))


def codes(request: Document, plan: Plan) -> list[Code]:
    """What the checker finds in a plan for a request when its digest fits."""
    return [finding.code for finding in check(cell_of(request).scene, resealed(request, plan)).findings]
