"""Bundles of shipped scenarios, and what their tests ask of the prover."""

from __future__ import annotations

import copy
import json
from functools import cache
from typing import Any

from assur.planner.model.outcome import Plan
from assur.planner.model.scene import Scene
from assur.prover.prove import prove
from assur.scenes.bundle.writing import bundle_of
from assur.scenes.requests import cell_of, read_plan
from assur.scenes.scenarios import shipped
from tests.scenes.cells.second_kinematics import answer

Document = dict[str, Any]


@cache
def planned(name: str) -> tuple[Scene, Plan]:
    """The scene of a shipped scenario, and its plan."""
    scenario = shipped(name)
    cell = cell_of(scenario.request, folder=scenario.folder)
    return cell.scene, read_plan(cell, answer(name))[0]


@cache
def _bundle(name: str) -> Document:
    return bundle_of(*planned(name))


def bundle(name: str) -> Document:
    """The bundle of a scenario's plan, to be changed at will."""
    return copy.deepcopy(_bundle(name))


def shown(document: Document) -> tuple[bool, Any]:
    """What the prover says of a bundle: that it is shown, and its claims; or that it is not, and what is not."""
    return prove(json.dumps(document).encode())
