"""What the rows of a claim are called for people, and of which request and plan it is. Nothing is proved of it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from assur.planner.claim.answer import named_answer
from assur.planner.claim.filling import SceneClaim, named_rows
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


def labels_of(base: SceneClaim, plan: Plan, phases: Sequence[Phase], claims: Claims = NOTHING) -> Labels:
    """The labels of the claim that `with_plan` makes of the same, and `with_answer` of what an answer states."""
    scene, named = base.scene, named_rows(base, plan, phases)
    for name, rows in named_answer(base, plan, phases, claims).items():
        named[name] += rows
    robots = scene.robot, *(robot for robot, _ in base.cell.frames.others)
    return Labels(
        request_digest=scene.digest,
        plan_digest=plan.certificate.digest,
        arms=tuple(map(_arm, robots)),
        frames=tuple(scene.frames),
        bodies=tuple(base.cell.carriers.body),
        phases=tuple(str(phase.kind) for phase in phases),
        **{table: tuple(name for name, _ in rows) for table, rows in named.items()},
    )


def _arm(robot: Robot) -> tuple[str, tuple[str, ...]]:
    return robot.name, robot.links
