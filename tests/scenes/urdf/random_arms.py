"""URDFs of arms of every family with axes at random, in frames that are turned at random, with fixed joints between."""

from __future__ import annotations

import math

import numpy as np
from scipy.spatial.transform import Rotation

from assur.planner.arrays import FloatArray
from tests.scenes.urdf.made import J, urdf

UP = np.array([0.0, 0.0, 1.0])
ORDERS = ("rrpr", "rprr", "prrr", "rrrp", "rrp", "rpr", "prr")


def scara(order: str, seed: int) -> str:
    """A SCARA with its lift in some place; every second one has a flange that looks down."""
    rng = np.random.default_rng(seed)
    base = rng.uniform(-0.3, 0.3, 3)
    points = [base]
    for _ in range(2):
        points.append(points[-1] + _level(rng) * rng.uniform(0.15, 0.4))
    turning = iter(points)
    axes = [
        ("prismatic" if kind == "p" else "revolute", rng.uniform(-1, 1, 3) if kind == "p" else next(turning), UP)
        for kind in order
    ]
    flange = points[2] * [1, 1, 0] + UP * rng.uniform(-0.2, 0.2)
    over = Rotation.from_euler("x", math.pi if seed % 2 else 0.0)
    return _written(rng, axes, flange, Rotation.from_euler("z", rng.uniform(-3, 3)) * over)


def elbow_arm(seed: int) -> str:
    rng = np.random.default_rng(seed)
    base, ahead, across = _plane(rng)
    shoulder = base + UP * rng.uniform(0.1, 0.4)
    elbow = shoulder + _in(rng, ahead)
    axes = [("revolute", base, UP), ("revolute", shoulder, across), ("revolute", elbow, across)]
    return _written(rng, axes, elbow + _in(rng, ahead), Rotation.random(rng=rng))


def five_axis_arm(seed: int) -> str:
    rng = np.random.default_rng(seed)
    base, ahead, across = _plane(rng)
    shoulder = base + UP * rng.uniform(0.1, 0.4)
    elbow = shoulder + _in(rng, ahead)
    wrist = elbow + _in(rng, ahead)
    hand = _in(rng, ahead)
    axes = [("revolute", base, UP), *(("revolute", point, across) for point in (shoulder, elbow, wrist))]
    axes.append(("revolute", wrist, hand / np.linalg.norm(hand)))
    return _written(rng, axes, wrist + hand, Rotation.random(rng=rng))


def _plane(rng: np.random.Generator) -> tuple[FloatArray, FloatArray, FloatArray]:
    """A point of a vertical base axis, and the directions ahead in the arm's plane and across it."""
    ahead = _level(rng)
    return rng.uniform(-0.3, 0.3, 3), ahead, np.cross(UP, ahead)


def _level(rng: np.random.Generator) -> FloatArray:
    turn = rng.uniform(-math.pi, math.pi)
    return np.array([math.cos(turn), math.sin(turn), 0.0])


def _in(rng: np.random.Generator, ahead: FloatArray) -> FloatArray:
    """A way in the plane of `ahead` and the vertical."""
    turn = rng.uniform(-math.pi, math.pi)
    way: FloatArray = rng.uniform(0.1, 0.3) * (math.cos(turn) * ahead + math.sin(turn) * UP)
    return way


def _written(
    rng: np.random.Generator, axes: list[tuple[str, FloatArray, FloatArray]], flange: FloatArray, turn: Rotation
) -> str:
    """The URDF of axes (kind, a point, a direction), all joints at 0. Every joint's frame is turned at random and has
    its origin anywhere on its axis; every second axis counts the other way round; fixed joints are between."""
    joints, before = [], np.eye(4)

    def add(kind: str, point: FloatArray, rotation: Rotation, axis: FloatArray) -> None:
        nonlocal before
        here = np.eye(4)
        here[:3, :3], here[:3, 3] = rotation.as_matrix(), point
        step = np.linalg.inv(before) @ here
        x, y, z = step[:3, 3]
        roll, pitch, yaw = Rotation.from_matrix(step[:3, :3]).as_euler("xyz")
        own = rotation.inv().apply(axis)
        ends = (0.01, 0.2) if kind == "prismatic" else (-2.0, 2.5)
        joints.append(J(kind, (x, y, z), (roll, pitch, yaw), (own[0], own[1], own[2]), ends))
        before = here

    for kind, point, direction in axes:
        if rng.random() < 0.5:
            add("fixed", rng.uniform(-0.2, 0.2, 3), Rotation.random(rng=rng), UP)
        sign = rng.choice([-1.0, 1.0])
        along = np.zeros(3) if kind == "prismatic" else direction * rng.uniform(-0.2, 0.2)
        add(kind, point + along, Rotation.random(rng=rng), sign * direction)
    add("fixed", flange, turn, UP)
    return urdf(*joints)


ARMS: dict[str, str] = {
    **{f"scara {order}, {seed}": scara(order, seed) for order in ORDERS for seed in range(2)},
    **{f"elbow arm, {seed}": elbow_arm(seed) for seed in range(4)},
    **{f"five-axis arm, {seed}": five_axis_arm(seed) for seed in range(4)},
}
