"""Requests with their plans and claims, for the tests of the statement checker: shipped scenarios, and variants of them
in which more is uncertain, or which have laws that no scenario has."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np

import assur
from assur.planner.checker.statement import Handling, state_cell, state_legs, state_plan
from assur.planner.checker.statement.solids import bodies_of
from assur.planner.checker.verdict import Finding
from assur.planner.claim import filling
from assur.planner.claim.columns import Claim
from assur.planner.claim.filling import with_plan
from assur.planner.model.claims import NOTHING, Claims
from assur.planner.model.digest import digest
from assur.planner.model.outcome import Plan
from assur.planner.model.scene import Scene
from assur.scenes.requests import cell_of, read_plan

Document = dict[str, Any]
CANDIDATES = 200
"""Budget of each plan: a count, so that no clock decides which plan it is."""


@dataclass(frozen=True)
class Case:
    """A request, the scene that it means, a plan, the claim of the plan, and what else its answer states."""

    request: Document
    scene: Scene
    plan: Plan
    claim: Claim
    claims: Claims = NOTHING

    def body(self, name: str) -> int:
        """The row of a body."""
        return [body.name for body in bodies_of(self.scene)].index(name)

    def piece(self, name: str, which: int = 0) -> int:
        """The row of a piece of a body."""
        return int(self.claim.bodies[self.body(name), 0]) + which

    def frame(self, name: str) -> int:
        """The row of a frame."""
        return list(self.scene.frames).index(name)

    def phase(self, kind: str, which: int = 0) -> int:
        """The row of a phase that is a leg of this kind."""
        return [k for k, leg in enumerate(self.plan.legs) if leg.kind == kind][which]


def differences(case: Case, claim: Claim | None = None, plan: Plan | None = None) -> list[Finding]:
    """What the statement checker reports of a case, or of another claim or plan for its request."""
    claim, plan = claim or case.claim, plan or case.plan
    handling = Handling(case.scene, plan)
    return state_legs(handling) or state_cell(case.scene, claim) or state_plan(handling, claim)


def sealed(scene: Scene, plan: Plan) -> Plan:
    """The plan with the digest that fits a request."""
    own = digest(scene.digest, plan.trajectory, plan.legs, plan.arrivals, plan.certificate)
    return replace(plan, certificate=replace(plan.certificate, digest=own))


def claim_of(scene: Scene, plan: Plan) -> Claim:
    """The claim of a plan."""
    return with_plan(filling.claim_of(scene), plan)


def planned(request: Document) -> Case | None:
    """The case of a request; None: it has no plan."""
    answer = assur.plan(request)
    if not answer.planned:
        return None
    cell = cell_of(request)
    plan, _, claims = read_plan(cell, json.loads(json.dumps(dict(answer))))
    return Case(request, cell.scene, plan, claim_of(cell.scene, plan), claims)


@cache
def case_of(name: str) -> Case:
    """The case of a shipped scenario or of a variant, which has a plan."""
    base, change = VARIANTS.get(name, (name, lambda _: None))
    request = assur.load(base)
    options = request.setdefault("options", {})
    options.pop("budget_ms", None)
    options |= {"max_candidates": CANDIDATES, "budget_s": 60.0, "stop": "first", "report": "full"}
    change(request)
    found = planned(request)
    assert found is not None, name
    return found


def step(request: Document, number: int) -> Document:
    """What a request says of a step."""
    found: Document = next(iter(request["task"][number].values()))
    return found


def _open_demo(d: Document) -> None:
    d["options"]["clearance_exceptions"] = [
        {"between": ["cup"], "and": ["bar"], "clearance_mm": {"travel": 12, "near": 6}},
        {"between": ["dial-post"], "clearance_mm": {"travel": 10, "near": 3}},
    ]
    d["options"]["stay_safe_s"] = 0.3
    d["execution"] = {"lag": {"j1_deg": 0.01, "j2_deg": 0.01, "j3_mm": 0.02}, "start_tolerance_ms": 2}
    for number in (0, 1):
        step(d, number)["contact_tolerance_mm"] = 1.0


def _open_flow(d: Document) -> None:
    d["execution"]["start_tolerance_ms"] = 1
    more = {"lateral_mm": 0.2, "vertical_mm": 0.1, "yaw_deg": 0.05, "position_mm": 0.5}
    d["frames"]["belt"]["uncertainty"].update(more)
    own = {"position_mm": 0.3, "vertical_mm": 0.1, "yaw_deg": 0.2}
    next(body for body in d["bodies"] if body["name"] == "before")["uncertainty"] = own
    for number in (0, 1):
        step(d, number)["contact_tolerance_mm"] = 2.0


def _open_robots(d: Document) -> None:
    d["neighbours"][0]["start_uncertainty_s"] = 0.05


def _stopping(d: Document) -> None:
    stop = {"at_s": 1.2, "speed_mm_s": 100, "acceleration_mm_s2": 500, "jerk_mm_s3": 5000}
    d["frames"]["belt"]["conveyor"]["changes"] = [stop]


def _laws(d: Document) -> None:
    """Frames of the kinds that no shipped scenario has, far above the robot."""
    shuttle = [{"time_s": t, "at_mm": [x, 0, 2000]} for t, x in ((-1, 0), (0.3, 200), (1.1, 150), (9, 0))]
    again = [
        {"time_s": t, "at_mm": [x, 0, 2000], "yaw_deg": a} for t, x, a in ((0, 0, 0), (0.5, 90, 200), (0.8, 0, 360))
    ]
    d["frames"] |= {
        "star": {"indexer": {"at_mm": [0, 0, 2000], "step_deg": 45, "move_ms": 300, "dwell_ms": 200, "start_s": 0.1}},
        "beam": {"indexer": {"at_mm": [0, 0, 2500], "yaw_deg": 30, "step_mm": 80, "move_ms": 300, "dwell_ms": 0}},
        "lift": {"keyframes": {"points": shuttle, "ends": "clamped"}},
        "lift-2": {"keyframes": {"points": shuttle, "ends": "natural"}},
        "round": {"keyframes": {"points": again, "repeat": True}},
        "cart": {"linear": {"at_mm": [0, 0, 2000], "velocity_mm_s": [30, 40, 5], "at_s": 0.5}},
        "mast": {
            "linear": {"at_mm": [0, 0, 2200], "velocity_mm_s": [0, 0, 5]},
            "uncertainty": {"position_mm": 0.5, "vertical_mm": 0.5},
        },
        "nest": {"fixed": {"frame": "dial", "at_mm": [40, 0, 1900], "yaw_deg": 20}},
    }
    d["bodies"] += [
        {"name": f"on-{name}", "shape": {"sphere": {"radius_mm": 20}}, "pose": {"frame": name, "at_mm": [9, 0, 0]}}
        for name in ("star", "beam", "lift", "lift-2", "round", "cart", "mast", "nest")
    ]


def _stacked(d: Document) -> None:
    """What the part rests on is not named: it follows from where bodies are."""
    for number in (0, 1):
        step(d, number).pop("contact_with", None)


def _near(d: Document) -> None:
    """Grips and supports must be near."""
    step(d, 0)["grip_within_mm"] = 0.1
    step(d, 1)["support_within_mm"] = 0.1


def _ways(d: Document) -> None:
    """Straight parts with stops, one of them little longer than the distance in travel; a straight leg that begins in
    motion on the dial; then from rest to rest, with the yaw that the tool has; and a via."""
    step(d, 0)["approach"]["stop"] = True
    step(d, 1)["depart"] = {"mm": 8.5, "stop": True}
    step(d, 2)["leg"] = "cartesian"
    x, y, z = step(d, 2)["to"]["at_mm"]
    kept = {"at_mm": [x, y + 60, z + 5], "yaw_keep": True}
    d["task"] += [
        {"move": {"to": kept, "leg": "cartesian", "match": "position"}},
        {"move": {"to": {"at_mm": [x + 30, y + 40, z + 15]}, "via": True}},
        {"move": {"to": {"at_mm": [x, y, z]}}},
    ]


def _lagging(d: Document) -> None:
    d["execution"] = {"lag": {"j1_deg": 0.1, "j2_deg": 0.1, "j4_deg": 0.1}}


def _tilts(d: Document) -> None:
    """A straight leg with another pitch and roll at its end."""
    to = {"at_mm": [320, 120, 400], "pitch_deg": -70, "roll_deg": 20}
    d["task"].append({"move": {"name": "on", "to": to, "leg": "cartesian"}})


VARIANTS: dict[str, tuple[str, Callable[[Document], object]]] = {
    "demo, more uncertain": ("demo", _open_demo),
    "dense-flow, more uncertain": ("dense-flow", _open_flow),
    "demo, all laws": ("demo", _laws),
    "demo, near parts": ("demo", _near),
    "demo, supports not named": ("demo", _stacked),
    "demo, belt that slows down": ("demo", _stopping),
    "two-robots, start uncertain": ("two-robots", _open_robots),
    "demo, straight ways": ("demo", _ways),
    "rv-m1, straight way": ("rv-m1", _tilts),
    "hose-on-gripper, lag": ("hose-on-gripper", _lagging),
}
"""By the name of a variant: the scenario, and what is changed in its request."""


def copied(claim: Claim) -> Claim:
    """A claim whose tables may be written to."""
    return Claim(*(np.array(table) for table in claim))
