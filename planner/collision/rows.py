"""Proved rows of a phase, what could not be proved, and the certificate that is written from the rows of all phases."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import compress

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.collision.bodies import Arrangement
from assur.planner.kernels.proof import ALONG, FROM, OTHER, T0, T1, TO, UNIT
from assur.planner.kernels.solids import BODY, PIECE
from assur.planner.model.digest import digest
from assur.planner.model.outcome import Arrival, Certificate, Leg, covered
from assur.planner.model.scene import Scene
from assur.planner.trajectory import Trajectory


@dataclass(frozen=True, slots=True)
class ProofFailure:
    """Two bodies that could not be shown to stay apart around `time`: `gap` m instead of `required` m.

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


def written(
    scene: Scene, trajectory: Trajectory, legs: tuple[Leg, ...], arrivals: tuple[Arrival, ...], proofs: list[Rows]
) -> Certificate:
    """The certificate of a whole plan from the rows of its phases."""
    tables, of_units = [], []
    for rows in proofs:
        tables.append(rows.table)
        units = rows.table[:, UNIT : OTHER + 1].astype(np.int64)
        found = rows.arrangement.rows[:, BODY : PIECE + 1][units]
        found[units < 0] = -1
        of_units.append(found)
    # (N, 2, 2): body and piece, of the first unit and of the second
    table, columns = np.concatenate(tables), np.concatenate(of_units).astype(np.int64)
    # only the bodies that are needed are named; the last entry is that of no body, -1
    names = proofs[0].arrangement.names
    needed = np.zeros(len(names) + 1, dtype=np.int64)
    needed[columns[:, :, 0]] = 1
    number = needed.cumsum() - 1
    number[-1] = -1
    shifted = bool(table[:, FROM : TO + 1].any())
    certificate = Certificate.of_columns(
        first=number[columns[:, 0, 0]],
        second=number[columns[:, 1, 0]],
        names=tuple(compress(names, needed.tolist())),
        t0=table[:, T0],
        t1=table[:, T1],
        first_piece=columns[:, 0, 1],
        second_piece=columns[:, 1, 1],
        normal=table[:, ALONG : ALONG + 3],
        shift0=table[:, FROM] if shifted else None,
        shift1=table[:, TO] if shifted else None,
        covers=covered(trajectory),
    )
    vars(certificate)["digest"] = digest(scene.digest, trajectory, legs, arrivals, certificate)
    return certificate
