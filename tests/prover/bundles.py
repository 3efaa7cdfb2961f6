"""Bundles of shipped scenarios, and what their tests ask of the prover."""

from __future__ import annotations

import copy
import json
from functools import cache
from typing import Any

from assur.planner.checker.claim.verdict import check_claim
from assur.planner.claim import columns as c
from assur.planner.claim import document as written
from assur.planner.claim.frames import arms_of, knots_of, law_of
from assur.planner.claim.obligations import solids_of
from assur.planner.geometry.shapes import Body, pieces
from assur.planner.laws import Law
from assur.planner.model.outcome import Plan
from assur.planner.model.scene import Scene
from assur.planner.robots.robot import Robot
from assur.planner.trajectory import Trajectory
from assur.prover.prove import prove
from assur.scenes.bundle import bundle_of
from assur.scenes.requests import cell_of, read_plan
from assur.scenes.scenarios import shipped
from tests.planner.claim import reading
from tests.scenes.cells.answers import answer

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


def arm_document(robot: Robot, path: Trajectory, begin: float, until: float) -> Document:
    """An arm that follows a trajectory, and stands before and after it, in a bundle."""
    knots, rows = knots_of(path, begin, until), {name: table.tolist() for name, table in arms_of([robot]).items()}
    rows["arms"][0][c.ARM_KNOTS] = len(knots)
    rows["knots"] = knots.tolist()
    return written.arm_document(rows, rows["arms"][0], robot.name, list(robot.links))


def law_document(law: Law, begin: float) -> Document:
    """A frame that moves by a law, from `begin` on at least, in a bundle."""
    at, pieces, waves, period = law_of(law, begin)
    frame = [-1.0, -1.0, *at, 0.0, len(pieces), 0.0, len(waves), 0.0, 0.0, 0.0, *period]
    rows = {"frames": [frame], "laws": pieces, "waves": list(map(list, waves)), "displaced": []}
    return written.frame_document(rows, 0, "frame")


def body_document(body: Body) -> Document:
    """A body in a bundle."""
    rows = {name: table.tolist() for name, table in solids_of([body], pieces([body])).items()}
    return written.body_document(rows, rows["bodies"][0], body.name)


def shown(document: Document) -> tuple[bool, Any]:
    """What the prover says of a bundle: that it is shown, and its claims; or that it is not, and what is not."""
    return prove(json.dumps(document).encode())


def agreed(document: Document) -> tuple[bool, Any]:
    """What the prover says of a bundle, of which the claim checker says the same."""
    answer = shown(document)
    assert check_claim(reading.read(document)[0]).accepted is answer[0]
    return answer
