"""Proved rows of a phase, what could not be proved, and the certificate that is written from the rows of all phases."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.kernels.proof import ALONG, OTHER, T0, T1, UNIT
from assur.planner.model.digest import digest
from assur.planner.model.outcome import Arrival, Certificate, Leg, covered
from assur.planner.model.scene import Scene
from assur.planner.tables.bodies import Arrangement
from assur.planner.trajectory import Trajectory


@dataclass(frozen=True, slots=True)
class Unproved:
    """Two bodies that could not be shown to stay apart around `time`: `gap` m where `required` m is asked.

    `touching`: FCL says that they touch.
    """

    bodies: tuple[str, str]
    time: float
    gap: float
    required: float
    touching: bool
    of_robot: bool


@dataclass(frozen=True, slots=True)
class Rows:
    """Proved rows of one phase, `table` (N, ROW_COLUMNS) of units; where the second is -1, of the first alone."""

    arrangement: Arrangement
    table: FloatArray

    def __len__(self) -> int:
        return len(self.table)

    @property
    def first(self) -> IntArray:
        """(N,) first units."""
        return self.table[:, UNIT].astype(np.int64)

    @property
    def second(self) -> IntArray:
        """(N,) second units, -1 for none."""
        return self.table[:, OTHER].astype(np.int64)


def written(
    scene: Scene, trajectory: Trajectory, legs: tuple[Leg, ...], arrivals: tuple[Arrival, ...], proofs: list[Rows]
) -> Certificate:
    """The certificate of a whole plan from the rows of its phases."""
    number: dict[str, int] = {}

    def bodies(rows: Rows, unit: IntArray) -> IntArray:
        """Numbers of the names of bodies, in the order in which they are first needed; of no body -1."""
        mine, which = np.unique(np.where(unit < 0, -1, rows.arrangement.body[unit]), return_inverse=True)
        of = [-1 if body < 0 else number.setdefault(rows.arrangement.names[body], len(number)) for body in mine]
        return np.array(of, dtype=np.int64)[which]

    def pieces(rows: Rows, unit: IntArray) -> IntArray:
        return np.where(unit < 0, -1, rows.arrangement.piece[unit])

    units = [(rows, rows.first, rows.second) for rows in proofs]
    table = np.concatenate([rows.table for rows in proofs])
    certificate = Certificate(
        first=np.concatenate([bodies(rows, first) for rows, first, _ in units]),
        second=np.concatenate([bodies(rows, second) for rows, _, second in units]),
        names=tuple(number),
        t0=table[:, T0].copy(),
        t1=table[:, T1].copy(),
        first_piece=np.concatenate([pieces(rows, first) for rows, first, _ in units]),
        second_piece=np.concatenate([pieces(rows, second) for rows, _, second in units]),
        normal=table[:, ALONG : ALONG + 3].copy(),
        covers=covered(blended=scene.options.blended),
    )
    return replace(certificate, digest=digest(scene.digest, trajectory, legs, arrivals, certificate))
