"""What the rows of a claim are called for people, and of which request and plan it is. Nothing is proved of it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from assur.planner.claim.filling import SceneClaim
from assur.planner.claim.peaks import tool_peaks_of
from assur.planner.claim.points import axes_of, points_of, rates_of
from assur.planner.model.claims import NOTHING, Claims
from assur.planner.model.outcome import Plan
from assur.planner.model.phases import Phase
from assur.planner.robots.robot import Robot


class Labels(NamedTuple):
    """Digests, and a name for each row of the tables that these fields are called after: `arms` with those of their
    links."""

    request_digest: str
    plan_digest: str
    arms: tuple[tuple[str, tuple[str, ...]], ...]
    frames: tuple[str, ...]
    bodies: tuple[str, ...]
    phases: tuple[str, ...]
    points: tuple[str, ...]
    rates: tuple[str, ...]
    axes: tuple[str, ...]


OF_TOOL = "tool"
"""What the rows of the tool's peaks are called."""


def labels_of(base: SceneClaim, plan: Plan, phases: Sequence[Phase], claims: Claims = NOTHING) -> Labels:
    """The labels of the claim that `with_plan` makes of the same, and `with_answer` of what an answer states."""
    scene = base.scene
    peaks = tool_peaks_of(scene, plan, phases, claims)
    axes = axes_of(scene, plan) + base.postures.of_plan(plan) + base.postures.of_answer(plan, claims)
    robots = scene.robot, *(robot for robot, _ in base.cell.frames.others)
    return Labels(
        request_digest=scene.digest,
        plan_digest=plan.certificate.digest,
        arms=tuple(map(_arm, robots)),
        frames=tuple(scene.frames),
        bodies=tuple(base.cell.carriers.body),
        phases=tuple(str(phase.kind) for phase in phases),
        points=tuple(name for name, _ in points_of(scene, plan)),
        rates=(*(name for name, _ in rates_of(scene, plan, phases)), *(OF_TOOL for _ in peaks)),
        axes=tuple(name for name, _ in axes),
    )


def _arm(robot: Robot) -> tuple[str, tuple[str, ...]]:
    return robot.name, robot.links
