"""Answers to the shipped scenarios, each planned once, and their plans with other proofs."""

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
from assur.scenes.requests import cell_of, plan_cell, scene_of
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
