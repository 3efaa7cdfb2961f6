"""What is in the way of the arm at one time and posture: the first pair that is too near, or a mesh around it."""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.collision.arrangement import Carriers, Solids, carriers
from assur.planner.collision.gjk import separate
from assur.planner.collision.proof import Prover
from assur.planner.collision.support_gaps import likely_gaps, place, rough_gaps
from assur.planner.frames.motion import Pose
from assur.planner.geometry.containment import inside
from assur.planner.model.clearance import SLACK_M, clearance, uncertainty
from assur.planner.model.phases import Phase, pair
from assur.planner.model.scene import Scene


def closest(
    scene: Scene,
    prover: Prover,
    solids: Solids,
    phase: Phase,
    q: FloatArray,
    exempt: frozenset[tuple[str, str]],
    among: frozenset[str] | None = None,
) -> tuple[tuple[str, str], float, str] | None:
    """The first pair nearer than required at the phase's beginning; `among`: only these bodies of the surroundings,
    against what hangs on the flange."""
    a, b = prover.asked(solids)
    if among is not None:
        which = _hanging(scene, solids, among, a, b)
        a, b = a[which], b[which]
    if not len(a):
        return None
    where = carriers(scene, q[None], np.array([phase.t0]))
    need = _required(scene, phase, solids, b)
    near = np.flatnonzero(~(rough_gaps(solids, where, a, b)[0] - SLACK_M > need))
    if not len(near):
        return None
    row = np.zeros(len(near), dtype=np.int64)
    gap = likely_gaps(place(solids, where, row, a[near]), place(solids, where, row, b[near]))
    for i in near[~(gap - SLACK_M > need[near])]:
        x, y = int(a[i]), int(b[i])
        names = (solids.names[solids.body[x]], solids.names[solids.body[y]])
        if pair(*names) in exempt:
            continue
        found = _pair(prover, solids, where, (x, y), float(need[i]))
        if found is not None:
            return names, *found
    return None


def _hanging(scene: Scene, solids: Solids, among: frozenset[str], a: IntArray, b: IntArray) -> IntArray:
    """Numbers of the pairs of units (P,) of which one hangs on the flange and the other is of a body in `among`."""
    links = scene.robot.links
    hanging = np.array([*(link in ("flange", "quill") for link in links), *(False for _ in scene.frames)])
    other = np.array([i >= solids.robot_bodies and name in among for i, name in enumerate(solids.names)])
    return np.flatnonzero(hanging[solids.carrier[a]] & other[solids.body[b]])


def _required(scene: Scene, phase: Phase, solids: Solids, b: IntArray) -> FloatArray:
    """Metres (P,) asked between the arm and units `b` at the beginning of a phase."""
    asked = clearance(scene, phase)
    late = np.array(phase.t0 + scene.execution.start_tolerance_s)
    extra = [scene.execution.tracking_m + float(uncertainty(scene, phase, name, late)) for name in scene.frames]
    frame = solids.carrier[b] - solids.links
    found: FloatArray = np.where(frame >= 0, asked + np.array(extra)[np.maximum(frame, 0)], asked)
    return found


def _pair(
    prover: Prover, solids: Solids, where: Carriers, units: tuple[int, int], need: float
) -> tuple[float, str] | None:
    """By how much two bodies are nearer than `need`, and in words; None: they are not."""
    one, other = (np.array(solids.pieces[int(solids.body[unit])]) for unit in units)
    row = np.zeros(len(one) * len(other), dtype=np.int64)
    p, r = place(solids, where, row, np.repeat(one, len(other))), place(solids, where, row, np.tile(other, len(one)))
    gap = likely_gaps(p, r)
    first, second = (solids.names[solids.body[unit]] for unit in units)
    for k in np.argsort(gap, kind="stable"):
        if gap[k] - SLACK_M > need:
            return None
        if prover.collider.touch(p, r, int(k)):
            depth = max(0.0, -float(gap[k]))
            return max(0.0, need - float(gap[k])), f"{first} is up to {1e3 * depth:.1f} mm deep in {second}"
        distance, _ = separate(p, r, int(k))
        if not distance - SLACK_M > need:
            return (
                need - distance,
                f"{first} is {1e3 * distance:.2f} mm from {second} where {1e3 * need:.2f} mm are asked",
            )
    return None


def enclosed(
    scene: Scene,
    solids: Solids,
    q: FloatArray,
    t: float,
    exempt: frozenset[tuple[str, str]],
    rides: dict[str, tuple[str, Pose]],
    among: frozenset[str] | None = None,
) -> tuple[str, str] | None:
    """A body of the arm and the mesh whose surface encloses a point of it (a mesh is hollow to FCL and to gaps).

    `rides`: where each body of the surroundings sits by then; `among`: only these of them.
    """
    if all(world.body.surface is None for world in scene.bodies):
        return None
    where = carriers(scene, q[None], np.array([t]))
    points = [(mine, _reference_points(solids, where, mine)) for mine in range(solids.robot_bodies)]
    for world in scene.bodies:
        if world.body.surface is None or (among is not None and world.name not in among):
            continue
        if world.name in solids.names[: solids.robot_bodies]:
            continue  # it is in the gripper
        vertices = world.body.surface[0]
        low, high = vertices.min(0), vertices.max(0)
        carrier = int(solids.carrier[solids.roots[solids.names.index(world.name)]])
        turn, origin = where.rotation[0, carrier], where.position[0, carrier]
        pose = rides[world.name][1]
        c, s = math.cos(pose.yaw), math.sin(pose.yaw)
        yaw = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        for mine, here in points:
            local = ((here - origin) @ turn - pose.position) @ yaw
            # a point outside the box round the surface is outside the surface; NaN is not outside
            near = ~((local < low) | (local > high)).any(-1)
            if pair(solids.names[mine], world.name) in exempt or not near.any():
                continue
            if inside(world.body.surface, local[near]).any():
                return solids.names[mine], world.name
    return None


def _reference_points(solids: Solids, where: Carriers, body: int) -> FloatArray:
    """A point (m, 3) inside each convex piece of a body, world."""
    units = np.array(solids.pieces[body])
    placed = place(solids, where, np.zeros(len(units), dtype=np.int64), units)
    points = placed.centre.copy()
    for k, hull in enumerate(solids.hull[units]):
        if hull >= 0:
            points[k] += placed.axes[k] @ solids.hulls[int(hull)].vertices.mean(0)
    return points
