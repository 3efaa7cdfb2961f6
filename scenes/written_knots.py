"""The knots of a trajectory as they are written in an answer, in the maker's convention, and read back bit by bit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from assur.planner.errors import FaultError
from assur.planner.model.outcome import Plan
from assur.planner.trajectory import Trajectory
from assur.scenes.conventions import as_maker, converted, rates_as_maker, zeros
from assur.scenes.reading.cell import Cell
from assur.scenes.schema import answer as document


def settled(cell: Cell, plan: Plan) -> Plan:
    """The plan whose knots are read back bit by bit from what is written of them.

    Where a joint has a zero of its own, positions are rounded on the way to the maker's count and back, by some 1e-16.
    They are rounded so once, here: x ↦ (x ⊖ y) ⊕ y leaves what it gave before as it is (Knuth, The Art of Computer
    Programming 4.2.2, theorem D). The proof keeps 1 µm, and the checker checks what is written.
    """
    from assur.planner.model.digest import digest

    if not any(zeros(cell.conventions)):
        return plan
    knots = plan.trajectory
    q = converted(as_maker(knots.q, cell.conventions), cell.conventions)
    trajectory = Trajectory(knots.time, q, knots.qd, knots.qdd, jumps=knots.jumps)
    certificate = replace(
        plan.certificate, digest=digest(cell.scene.digest, trajectory, plan.legs, plan.arrivals, plan.certificate)
    )
    return replace(plan, trajectory=trajectory, certificate=certificate)


def trajectory_document(cell: Cell, trajectory: Trajectory) -> document.Trajectory:
    """The knots of a settled plan in the maker's convention. Reading them back gives the planner's, bit by bit."""
    rates = rates_as_maker(np.stack([trajectory.qd, trajectory.qdd]), cell.conventions)
    written = np.concatenate([as_maker(trajectory.q, cell.conventions)[None], rates])
    if not np.isfinite(written).all():
        raise FaultError("a trajectory is not finite")
    rows: list[list[list[float]]] = written.tolist()
    return {
        "joint_names": [joint.name for joint in cell.conventions],
        "joint_units": ["rad" if joint.kind == "revolute" else "m" for joint in cell.conventions],
        "time_s": trajectory.time.tolist(),
        "position": rows[0],
        "velocity": rows[1],
        "acceleration": rows[2],
        "acceleration_jumps": bool(trajectory.jumps),
    }
