"""Tampered plans of five-bars for the tests."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from planner.digest import digest
from planner.outcome import Plan
from scenes.requests import cell_of


def resealed(request: dict[str, Any], plan: Plan) -> Plan:
    """The plan with the digest that it should have, so that it is not refused for that alone."""
    scene = cell_of(request).scene
    c = plan.certificate
    fits = digest(scene.digest, plan.trajectory, plan.legs, plan.arrivals, c)
    return replace(plan, certificate=replace(c, digest=fits))
