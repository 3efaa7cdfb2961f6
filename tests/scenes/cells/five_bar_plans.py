"""Tampered plans of five-bars for the tests."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from assur.planner.model.digest import digest
from assur.planner.model.outcome import Plan
from assur.scenes.requests import cell_of


def resealed(request: dict[str, Any], plan: Plan) -> Plan:
    """The plan with the digest that it should have, so that it is not refused for that alone."""
    scene = cell_of(request).scene
    c = plan.certificate
    fits = digest(scene.digest, plan.trajectory, plan.legs, plan.arrivals, c)
    return replace(plan, certificate=replace(c, digest=fits))
