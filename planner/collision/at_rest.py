"""What is in the way of the arm at one time and posture: the first pair that is too near, or a mesh around it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.collision.bodies import Arrangement
from assur.planner.collision.pairs import certain
from assur.planner.collision.proof import Prover
from assur.planner.geometry.containment import inside
from assur.planner.kernels.intervals import RESERVE_M
from assur.planner.kernels.screening import HIT_A, HIT_B, HIT_GAP, HIT_NEED, HIT_PAIR
from assur.planner.kernels.solids import FIRST, SECOND
from assur.planner.model.attachments import Attachments
from assur.planner.model.deadline import look
from assur.planner.model.phases import Contacts, Phase, pair
from assur.planner.model.refusal import Separation
from assur.planner.model.scene import Scene


@dataclass(frozen=True, slots=True)
class TooNear:
    """Two bodies, by name, how near they are, and the numbers of the pieces of theirs that are."""

    names: tuple[str, str]
    facts: Separation
    units: tuple[int, int]


@dataclass(frozen=True, slots=True)
class Within:
    """A body and the mesh that it is inside of, by name, and a point of the body that is, world."""

    names: tuple[str, str]
    point: tuple[float, float, float]


def closest(
    scene: Scene,
    prover: Prover,
    phase: Phase,
    q: FloatArray,
    contacts: Contacts,
    among: frozenset[str] | None = None,
) -> TooNear | None:
    """The first pair nearer than required at the phase's beginning, where everything is where it is planned; `among`:
    only these bodies of the surroundings, against what hangs on the flange."""
    arrangement = prover.of(phase)
    stands = prover.standing(q, phase.t0)
    pairs = certain(prover.near(phase, stands))
    one, other = (arrangement.body[pairs[:, column].astype(np.int64)] for column in (FIRST, SECOND))
    names = [pair(arrangement.names[a], arrangement.names[b]) for a, b in zip(one, other, strict=True)]
    wanted = np.array([each not in contacts for each in names], dtype=bool)
    if among is not None:
        hanging, named = _hanging(scene, arrangement, among)
        wanted &= hanging[one] & named[other]
    if not wanted.any():
        return None
    found = prover.hits(phase, stands, pairs[wanted], doubted=False).too_near
    if not len(found):
        return None
    hit = found[found[:, HIT_PAIR].argmin()]
    units, gap, need = (int(hit[HIT_A]), int(hit[HIT_B])), float(hit[HIT_GAP]), float(hit[HIT_NEED]) - RESERVE_M
    first, second = (arrangement.names[arrangement.body[unit]] for unit in units)
    touching = bool(prover.touch(arrangement, stands, phase.t0, *units))
    apart = min(gap if touching else max(0.0, gap), need)
    rule, clearance = prover.rule(phase, first, second)
    facts = Separation(touching=touching, gap_m=apart, required_m=need, rule=rule, clearance_m=clearance)
    return TooNear((first, second), facts, units)


def _hanging(scene: Scene, arrangement: Arrangement, among: frozenset[str]) -> tuple[BoolArray, BoolArray]:
    """Which bodies (B,) hang on the flange, and which are of the surroundings and in `among`."""
    links = scene.robot.links
    hangs = np.array([*(link in ("flange", "quill") for link in links), *(False for _ in scene.frames)], dtype=bool)
    named = np.array([name in among for name in arrangement.names], dtype=bool)
    return hangs[arrangement.carrier[arrangement.roots]], named & ~arrangement.of_robot


def enclosed(
    scene: Scene,
    prover: Prover,
    attached: Attachments,
    q: FloatArray,
    t: float,
    contacts: Contacts,
    among: frozenset[str] | None = None,
) -> Within | None:
    """A body of the arm and the mesh whose surface encloses a point of it (a mesh is hollow to FCL and to gaps).

    `attached`: where each body of the surroundings sits by then; `contacts`: pairs that do not count; `among`: only
    these bodies of the surroundings. Raises `OutOfTimeError` where the deadline in force passes.
    """
    if all(world.body.surface is None for world in scene.bodies):
        return None
    arrangement = prover.arrangement(attached)
    carriers = prover.carriers(q, t)
    points = [
        (mine, _reference_points(prover, arrangement, q, t, mine))
        for mine in np.flatnonzero(arrangement.of_robot).tolist()
    ]
    for world in scene.bodies:
        if world.body.surface is None or (among is not None and world.name not in among):
            continue
        number = arrangement.number[world.name]
        if arrangement.of_robot[number]:
            continue  # it is in the gripper
        look()
        low, high = prover.box(world.body.surface[0])
        carrier = carriers[int(arrangement.carrier[arrangement.roots[number]])]
        origin, turn = carrier[:3], carrier[3:].reshape(3, 3)
        pose = attached.pose_of(scene, world.name)[1]
        c, s = math.cos(pose.yaw), math.sin(pose.yaw)
        yaw = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        for mine, here in points:
            local = ((here - origin) @ turn - pose.position) @ yaw
            # a point outside the box round the surface is outside the surface; NaN is not outside
            near = ~((local < low) | (local > high)).any(-1)
            if pair(arrangement.names[mine], world.name) in contacts or not near.any():
                continue
            within = inside(world.body.surface, local[near], look)
            if within.any():
                x, y, z = here[near][within.argmax()].tolist()
                return Within((arrangement.names[mine], world.name), (x, y, z))
    return None


def _reference_points(prover: Prover, arrangement: Arrangement, q: FloatArray, t: float, body: int) -> FloatArray:
    """A point (m, 3) inside each convex piece of a body, world."""
    units = np.array(arrangement.pieces(body))
    points = []
    for unit, posed in zip(units, prover.posed(arrangement, q, t, units), strict=True):
        corners = getattr(arrangement.shape(unit), "vertices", None)
        middle = np.zeros(3) if corners is None else corners.mean(0)
        points.append(posed.position + posed.axes @ middle)
    return np.array(points)
