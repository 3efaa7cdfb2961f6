"""Proved rows of a phase, what could not be proved, and the certificate that is written from the rows of all phases."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from planner.arrays import FloatArray, IntArray
from planner.digest import digest
from planner.outcome import Arrival, Certificate, Leg, covered
from planner.scene import Scene
from planner.solids import Solids
from planner.trajectory import Trajectory


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
    """Proved rows of one phase; bodies are numbers in `solids.names`."""

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
    names = tuple(dict.fromkeys(name for rows in proofs for name in rows.solids.names))
    number = {name: i for i, name in enumerate(names)}

    def bodies(rows: Rows, unit: IntArray) -> IntArray:
        of = np.array([number[name] for name in rows.solids.names], dtype=np.int64)
        return of[rows.solids.body[unit]]

    def column(name: str) -> FloatArray:
        return np.concatenate([getattr(rows, name) for rows in proofs])

    certificate = Certificate(
        names=names,
        t0=column("t0"),
        t1=column("t1"),
        first=np.concatenate([bodies(rows, rows.first) for rows in proofs]),
        first_piece=np.concatenate([rows.solids.piece[rows.first] for rows in proofs]),
        second=np.concatenate([bodies(rows, rows.second) for rows in proofs]),
        second_piece=np.concatenate([rows.solids.piece[rows.second] for rows in proofs]),
        normal=column("normal"),
        gap0=column("gap0"),
        gap1=column("gap1"),
        speed=column("speed"),
        acceleration=column("acceleration"),
        covers=covered(blended=scene.options.blended),
    )
    return replace(certificate, digest=digest(scene.digest, trajectory, legs, arrivals, certificate))
