"""The tables of a claim: those of a scene, which are made once, and those of each plan for it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.claim import columns as c
from assur.planner.claim.arrival_errors import errors_of
from assur.planner.claim.columns import Claim
from assur.planner.claim.distances import Distances, is_limited
from assur.planner.claim.frames import EMPTY, early_of, frames_of, with_knots
from assur.planner.claim.joint_sums import required_postures, sums_of
from assur.planner.claim.obligations import (
    Carriers,
    Seats,
    carriers_of,
    distances_of,
    limits_of,
    phases_of,
    seats_of,
    solids_in,
)
from assur.planner.claim.points import Rows as NamedRows
from assur.planner.claim.points import axes_of, guides_of, points_of, rates_of
from assur.planner.collision.proof import Prover
from assur.planner.geometry.shapes import Body
from assur.planner.model.outcome import Certificate, Plan
from assur.planner.model.phases import Phase
from assur.planner.model.phases import phases as phases_in
from assur.planner.model.scene import Scene, bodies_in
from assur.planner.robots.robot import Robot
from assur.planner.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class CellClaim:
    """What follows from robot, tool, frames, bodies and what is required of them, whatever the task is. `early`: from
    when on all motions are stated that have no begin, s; `others`: the other arms and what they follow, from arm 1 on;
    `tables`: those of the cell, and those that have no rows where a plan needs none."""

    bodies: tuple[Body, ...]
    carriers: Carriers
    early: float
    others: tuple[tuple[Robot, Trajectory], ...]
    tables: dict[str, FloatArray]


@dataclass(frozen=True, eq=False)
class SceneClaim:
    """What follows from a scene, whatever the plan is. Its tables are shared by the claims of all plans."""

    scene: Scene
    cell: CellClaim
    seats: Seats

    @cached_property
    def prover(self) -> Prover:
        """What finds distances of bodies, made where the first one is needed."""
        return Prover(self.scene)

    def distances(self, plan: Plan, phases: Sequence[Phase]) -> Distances:
        """What writes rows of distances for a plan."""
        return Distances(self.prover, self.cell.carriers.body, plan, phases)


def cell_of(scene: Scene) -> CellClaim:
    """The part of a scene's claim that depends on its cell alone. Raises `InputError` for what cannot be stated."""
    bodies, early = bodies_in(scene), early_of(scene)
    frames, others = frames_of(scene, early)
    tables = {**EMPTY, **frames, **solids_in(scene), **distances_of(scene)}
    return CellClaim(bodies, carriers_of(scene), early, others, tables)


def claim_of(scene: Scene, cell: CellClaim | None = None) -> SceneClaim:
    """The claim of a scene without a plan. `cell`: if it is made already. Raises `InputError` for what cannot be
    stated."""
    cell = cell or cell_of(scene)
    return SceneClaim(scene, cell, seats_of(scene, cell.carriers))


def with_plan(base: SceneClaim, plan: Plan, phases: Sequence[Phase] | None = None) -> Claim:
    """The claim of a plan; of a motion that has no task, if it has no arrivals. `phases`: those of the plan, if they
    are made already. Raises `InputError` for what cannot be stated."""
    scene, cell, path = base.scene, base.cell, plan.trajectory
    if phases is None:
        phases = phases_in(scene, plan.legs, plan.arrivals)
    rows = dict[str, Sequence[Sequence[float]]](
        sums=sums_of(scene, plan),
        guides=guides_of(scene, plan, phases),
        distances=base.distances(plan, phases).required() if is_limited(scene) else (),
        errors=errors_of(scene, plan, phases),
    )
    for name, named in named_rows(base, plan, phases).items():
        rows[name] = [row for _, row in named]
    tables = with_knots(cell.tables, path, max([phase.t1 for phase in phases if phase.robot]))
    tables = {**cell.tables, **tables, **phases_of(scene, cell.carriers, base.seats, phases)}
    for name, own in rows.items():
        if own:
            tables[name] = c.table(name, own)
    required = tables["required"] = tables["required"].copy()
    required[0, c.REQUIRED_UNTIL], required[0, c.REQUIRED_SINCE] = phases[-1].t1, scene.start.time
    tables["limits"] = limits_of(scene, path.start, phases)
    tables["rows"] = rows_of(plan.certificate, cell.carriers.body)
    return Claim(**tables)


def named_rows(base: SceneClaim, plan: Plan, phases: Sequence[Phase]) -> dict[str, NamedRows]:
    """The rows of a plan's claim that have names for people, by their table."""
    return {
        "points": points_of(base.scene, plan, phases),
        "rates": rates_of(base.scene, plan, phases),
        "axes": axes_of(base.scene, plan) + required_postures(base.scene, plan),
    }


def rows_of(certificate: Certificate, number: dict[str, int]) -> FloatArray:
    """All rows, in their order; where a row is against a plane its second body is -1. `number`: the claim's rows of
    bodies by name."""
    found = np.zeros((len(certificate), c.ROW))
    found[:, c.ROW_T0], found[:, c.ROW_T1] = certificate.t0, certificate.t1
    shifts = ((c.ROW_S0, certificate.shift0, -math.inf), (c.ROW_S1, certificate.shift1, math.inf))
    for column, ahead, end in shifts:
        if ahead is not None and ahead.any():
            # windows are sums of two numbers, which the rows have rounded
            found[:, column] = np.where(ahead != 0.0, np.nextafter(ahead, end), 0.0)
    at = np.array([*map(number.__getitem__, certificate.names), -1])
    found[:, c.ROW_BODY], found[:, c.ROW_BODY + 1] = at[certificate.first], at[certificate.second]
    found[:, c.ROW_PIECE], found[:, c.ROW_PIECE + 1] = certificate.first_piece, certificate.second_piece
    found[:, c.ROW_NORMAL :] = certificate.normal
    return found
