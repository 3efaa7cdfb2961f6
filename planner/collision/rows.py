"""Proved rows of a phase, what could not be proved, and the certificate that is written from the rows of all phases."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.collision.arrangement import Solids
from assur.planner.model.digest import digest
from assur.planner.model.outcome import Arrival, Certificate, Leg, covered
from assur.planner.model.scene import Scene
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
    """Proved rows of one phase, of units; where the second is -1, of the first alone."""

    solids: Solids
    t0: FloatArray
    t1: FloatArray
    first: IntArray
    second: IntArray
    normal: FloatArray
    gap0: FloatArray
    gap1: FloatArray
    speed: FloatArray
    acceleration: FloatArray


def no_rows(solids: Solids) -> Rows:
    none, index = np.zeros(0), np.zeros(0, dtype=np.int64)
    return Rows(solids, none, none, index, index, np.zeros((0, 3)), none, none, none, none)


def written(
    scene: Scene, trajectory: Trajectory, legs: tuple[Leg, ...], arrivals: tuple[Arrival, ...], proofs: list[Rows]
) -> Certificate:
    """The certificate of a whole plan from the rows of its phases."""
    number: dict[str, int] = {}

    def bodies(rows: Rows, unit: IntArray) -> IntArray:
        """Numbers of the names of bodies, in the order in which they are first needed; of no body -1."""
        mine, which = np.unique(np.where(unit < 0, -1, rows.solids.body[unit]), return_inverse=True)
        of = [-1 if body < 0 else number.setdefault(rows.solids.names[body], len(number)) for body in mine]
        return np.array(of, dtype=np.int64)[which]

    def pieces(rows: Rows, unit: IntArray) -> IntArray:
        return np.where(unit < 0, -1, rows.solids.piece[unit])

    def column(name: str) -> FloatArray:
        return np.concatenate([getattr(rows, name) for rows in proofs])

    first = np.concatenate([bodies(rows, rows.first) for rows in proofs])
    second = np.concatenate([bodies(rows, rows.second) for rows in proofs])
    certificate = Certificate(
        names=tuple(number),
        t0=column("t0"),
        t1=column("t1"),
        first=first,
        first_piece=np.concatenate([pieces(rows, rows.first) for rows in proofs]),
        second=second,
        second_piece=np.concatenate([pieces(rows, rows.second) for rows in proofs]),
        normal=column("normal"),
        covers=covered(blended=scene.options.blended),
    )
    return replace(certificate, digest=digest(scene.digest, trajectory, legs, arrivals, certificate))
