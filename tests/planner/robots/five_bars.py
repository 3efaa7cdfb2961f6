"""Five-bars for the tests: one like the RP-5AH, one like nothing else, and random states of them."""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Pose
from assur.planner.robots.facts import Limits
from assur.planner.robots.five_bar import FiveBar

BASES = (Pose(), Pose(0.4, -0.7, 0.2, 2.5))
LENGTHS = {
    "even": (0.085, (0.2, 0.2), (0.26, 0.26)),
    "short": (0.085, (0.2, 0.2), (0.16, 0.16)),
    "odd": (0.12, (0.17, 0.22), (0.28, 0.24)),
    "one axis": (0.0, (0.2, 0.2), (0.26, 0.26)),
}
"""Distance of the crank axes, cranks, couplers, m."""

MANY, ROUNDS = 20_000, 100
"""Of places drawn, until there are enough."""


def five_bar(lengths: str = "even", *, axes: int = 4, base: Pose = BASES[0], assembly: str = "front") -> FiveBar:
    """A five-bar with wide limits and without bodies."""
    upper = np.array([3.5, 3.5, 0.4, 6.4])[:axes]
    lower = np.array([-3.5, -3.5, 0.1, -6.4])[:axes]
    rates = (np.full(axes, 7.0), np.full(axes, 100.0), np.full(axes, 5000.0))
    separation, proximal, distal = LENGTHS[lengths]
    limits = Limits(lower, upper, *rates)
    return FiveBar(
        name="five",
        separation=separation,
        proximal=proximal,
        distal=distal,
        axes=axes,
        limits=limits,
        base=base,
        assembly=assembly,
    )


def states(rng: np.random.Generator, robot: FiveBar, mode: int, size: int, serial: float = 0.1) -> FloatArray:
    """q (size, n) in `mode` with margins of at least `serial` and the robot's own parallel one, angles principal.

    Places are drawn and solved by the laws of cosines, without the robot's inverse: modes with little room need it.
    """
    found: list[FloatArray] = []
    places: list[FloatArray] = []
    half, (al, ar), (bl, br) = robot.separation / 2, robot.proximal, robot.distal
    p = rng.uniform(-0.6, 0.6, (MANY, 2))
    for _ in range(ROUNDS):
        q = np.zeros((len(p), len(robot.joints)))
        with np.errstate(invalid="ignore"):
            for k, (side, a, b, right) in enumerate(((half, al, bl, mode // 2), (-half, ar, br, mode % 2))):
                d = p - np.array([0.0, side])
                far = np.hypot(d[:, 0], d[:, 1])
                inner = np.arccos((a * a + far**2 - b * b) / (2 * a * far))
                q[:, k] = np.arctan2(d[:, 1], d[:, 0]) + (-inner if right else inner)
            q[:, :2] = np.angle(np.exp(1j * q[:, :2]))
            good = (robot.margin(q) > serial) & (robot.parallel_margin(q) > robot.parallel_least)
            good &= np.hypot(*(robot.forward(q)[0][:, :2] - _world(robot, p)).T) < 1e-6  # not the other assembly
        found.append(q[good])
        if sum(map(len, found)) >= size:
            break
        places.append(p[good])
        known = np.concatenate(places)
        p = rng.uniform(-0.6, 0.6, (MANY, 2))
        if len(known) and good.sum() < MANY / 10:
            p = rng.choice(known, MANY) + rng.normal(0.0, 0.01, (MANY, 2))  # a small room: look there
    q = np.concatenate(found)[:size]
    assert len(q) == size
    if len(robot.joints) > 2:
        q[:, 2] = rng.uniform(0.1, 0.4, size)
    if len(robot.joints) > 3:
        q[:, 3] = rng.uniform(-3.1, 3.1, size)
    return q


def _world(robot: FiveBar, p: FloatArray) -> FloatArray:
    c, s = np.cos(robot.base.yaw), np.sin(robot.base.yaw)
    return np.asarray(np.array([robot.base.x, robot.base.y]) + p @ np.array([[c, s], [-s, c]]))
