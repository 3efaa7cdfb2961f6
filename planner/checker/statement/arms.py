"""Are the links of a claim's arms where textbooks have them, and do the arms move as plan and request say?

The forward kinematics of each family of arms is here a second time, with complex numbers for planes: (K9) a SCARA,
(K32), (K34) a five-bar, (K25), (H1), (H2) arms that tilt, all of docs/kinematics.md. Both are compared at some vectors
of joint values. World frame, m and rad; (m, n) are m vectors of n joint values.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from assur.planner.arrays import FloatArray
from assur.planner.checker.statement import laws
from assur.planner.checker.statement.differences import SAME, Difference, Four, Topic
from assur.planner.claim import columns as c
from assur.planner.errors import FaultError
from assur.planner.model.outcome import Plan
from assur.planner.model.scene import Scene
from assur.planner.robots.elbow_arm import ElbowArm
from assur.planner.robots.five_axis_arm import FiveAxisArm
from assur.planner.robots.five_bar import FiveBar
from assur.planner.robots.polar_arm import PolarArm
from assur.planner.robots.robot import Robot
from assur.planner.robots.scara import Scara
from assur.planner.trajectory import Trajectory

VECTORS, FEWEST = 24, 6
"""Joint vectors at which links are compared, and how many of them a closed loop must reach. A place is a sum of sines
and cosines of sums of joint values with a handful of coefficients, so six vectors that are in no special position
leave none of them free."""
Complex = NDArray[np.complexfloating[Any, Any]]
SHARES = np.arange(1.0, VECTORS + 1.0)[:, None] * np.sqrt(np.array([2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0])) % 1.0
"""Points (VECTORS, 8) of a cube that is 1 wide: multiples of roots, less whole numbers, spread without any pattern."""
FIVE_BAR = ("base", "proximal-left", "proximal-right", "distal-left", "distal-right", "quill", "flange")


def link_names(robot: Robot) -> tuple[str, ...]:
    """The links of an arm in the order of a claim, in which the outer links of a loop come after both cranks."""
    return FIVE_BAR if isinstance(robot, FiveBar) else robot.links


def link_row(robot: Robot, link: int) -> int:
    """The number in a claim of a link that has this number in the robot's own order."""
    return link_names(robot).index(robot.links[link])


def flange_row(robot: Robot) -> int:
    """The number in a claim of the flange, which carries tool and part."""
    return link_names(robot).index("flange")


def links_agree(scene: Scene, claim: c.Claim) -> Iterator[Difference]:
    """Differences of the links of all arms, of the frames that are links of other arms than the robot, and of the
    motions of these arms."""
    arms: dict[int, tuple[Robot, Trajectory]] = {}
    for name, (robot, path, link), row in _links_of_others(scene, claim):
        arm = int(row[c.FRAME_ARM])
        if arm < 1:
            yield Difference(Topic.LAW, f"{name} is a link of an arm in the request, and not in the claim")
            continue
        other = arms.setdefault(arm, (robot, path))
        if other[0] is not robot or other[1] is not path:
            yield Difference(Topic.LAW, f"{name} is a link of another arm")
        elif row[c.FRAME_LINK] != claim.arms[arm, c.ARM_LINK] + link_row(robot, link):
            yield Difference(Topic.LAW, f"{name} is another link of its arm")
    if sorted(arms) != list(range(1, len(claim.arms))):
        yield Difference(Topic.LINK, f"the claim has {len(claim.arms)} arms, not {1 + len(arms)}")
        return
    for arm, robot in [(0, scene.robot), *((arm, robot) for arm, (robot, _) in arms.items())]:
        yield from _arm_agrees(robot, arm, claim)
    for arm, (robot, path) in arms.items():
        yield from _knots_agree(robot, path, claim, arm)


def _links_of_others(scene: Scene, claim: c.Claim) -> Iterator[tuple[str, tuple[Robot, Trajectory, int], list[float]]]:
    """The frames that are links of other arms: name; robot, motion and link; and the row of the claim."""
    for frame, row in zip(scene.frames.values(), claim.frames.tolist(), strict=False):
        link = laws.link_of(frame.law)
        if link is not None:
            yield frame.name, link, row


def _arm_agrees(robot: Robot, arm: int, claim: c.Claim) -> Iterator[Difference]:
    names, row = link_names(robot), claim.arms[arm]
    if row[c.ARM_LINKS] != len(names) or row[c.ARM_JOINTS] != len(robot.joints):
        yield Difference(Topic.LINK, f"{robot.name} has {len(names)} links and {len(robot.joints)} joints")
        return
    lower, upper = robot.limits.lower, robot.limits.upper
    q = lower + SHARES[:, : len(lower)] * (upper - lower)
    places, angles = textbook(robot, q)
    stated_places, stated_angles = _chain(claim, arm, q)
    closes = np.isfinite(places[-1]).all(axis=1)
    if not closes.sum() >= FEWEST:
        yield Difference(Topic.LINK, f"{robot.name} closes at too few joint vectors to compare its links")
        return
    apart = np.abs(stated_places - places)[:, closes].max(axis=(1, 2))
    turned = np.abs(np.remainder(stated_angles - angles + math.pi, math.tau) - math.pi)[:, closes].max(axis=(1, 2))
    for name, off in zip(names, np.maximum(apart, turned).tolist(), strict=True):
        if not off <= SAME:
            yield Difference(Topic.LINK, f"{name} of {robot.name} is up to {off:.2g} m or rad from its place")
    if row[c.ARM_LOOP] >= 0.0:
        loop = claim.loops[int(row[c.ARM_LOOP])]
        if not loop[c.LOOP_LEAST] >= robot.parallel_least:
            yield Difference(Topic.LINK, f"{robot.name} may come nearer to a singularity of its loop")


def _chain(claim: c.Claim, arm: int, q: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Places and angles (L, m, 3) of the links of an arm of the claim; yaw, pitch and roll are sums of joint values."""
    row = claim.arms[arm].astype(int)
    first, loop = int(row[c.ARM_LINK]), int(row[c.ARM_LOOP])
    links = claim.links[first : first + row[c.ARM_LINKS]]
    sums = claim.angles[:, :1] + claim.angles[:, c.ANGLE_SHARE : c.ANGLE_SHARE + q.shape[1]] @ q.T
    rows = links[:, [c.LINK_YAW, c.LINK_PITCH, c.LINK_ROLL]].astype(int)
    angles = np.where(rows[:, :, None] >= 0, sums[rows], 0.0).transpose(0, 2, 1)
    slides = links[:, c.LINK_SLIDE].astype(int)
    travel = np.where(slides[:, None] >= 0, q.T[slides], 0.0)
    local = (
        links[:, None, c.LINK_OFFSET : c.LINK_SLIDE]
        + travel[:, :, None] * links[:, None, c.LINK_AXIS : c.LINK_AXIS + 3]
    )
    parents = np.maximum(links[:, c.LINK_PARENT].astype(int) - first, -1)  # -1: none
    places = _stacked(parents, local, angles)
    if loop >= 0:
        numbers = claim.loops[loop]
        cranks = numbers[c.LOOP_CRANK : c.LOOP_CRANK + 2].astype(int) - first
        lengths = numbers[c.LOOP_LENGTH : c.LOOP_LENGTH + 2]
        ahead = np.array([1.0, 0.0, 0.0])
        ends = [places[k] + rotated(angles[k], n * ahead) for k, n in zip(cranks, lengths, strict=True)]
        one, two = (end[:, 0] + 1j * end[:, 1] for end in ends)
        directions = _couplers(one, two, *numbers[c.LOOP_COUPLER : c.LOOP_SIDE + 1].tolist())
        couplers = links[:, c.LINK_COUPLER].astype(int)
        angles[:, :, 0] += np.where(couplers[:, None] >= 0, np.array(directions)[couplers], 0.0)
        places = _stacked(parents, local, angles)
    return places, angles


def _stacked(parents: FloatArray, local: FloatArray, angles: FloatArray) -> FloatArray:
    """Places (L, m, 3) of links whose origins are at `local` in the axes of their parents."""
    steps = rotated(angles[parents], local)
    places = np.zeros_like(local)
    for k, parent in enumerate(parents.tolist()):
        places[k] = local[k] if parent < 0 else places[parent] + steps[k]
    return places


def rotated(angles: FloatArray, vectors: FloatArray) -> FloatArray:
    """Rz(yaw) Ry(-pitch) Rx(roll) times vectors (..., 3), for angles (..., 3)."""
    (cy, cp, cr), (sy, sp, sr) = np.moveaxis(np.cos(angles), -1, 0), np.moveaxis(np.sin(angles), -1, 0)
    x, y, z = np.moveaxis(vectors, -1, 0)
    y, z = cr * y - sr * z, sr * y + cr * z
    x, z = cp * x - sp * z, sp * x + cp * z
    return np.stack([cy * x - sy * y, sy * x + cy * y, z], axis=-1)


def _couplers(one: Complex, two: Complex, a: float, b: float, side: float) -> tuple[FloatArray, FloatArray]:
    """Directions (m,) from two points (m,) to where circles of radii a and b about them meet: to the left of the line
    from the first point to the second (side 1) or to its right (-1). NaN where they do not meet."""
    apart = np.abs(two - one)
    with np.errstate(invalid="ignore"):
        opening = np.arccos((apart**2 + a**2 - b**2) / (2.0 * apart * a))
    first = np.angle(two - one) + side * opening
    return first, np.angle(one + a * np.exp(1j * first) - two)


class Limb(NamedTuple):
    """Two links of an arm from its base to one point, in a plane: how far their foot is `across` the base's axis, and
    their lengths, all m; `turn`: 1 where the first is turned counter-clockwise from the way to the point, else -1.
    `hand`: how far behind the point the flange is, m. `front`: -1 for a loop that is assembled at the back, else 1."""

    across: float
    first: float
    second: float
    turn: float
    hand: float = 0.0
    front: float = 1.0


def limbs(robot: Robot, mode: str) -> list[Limb]:
    """The limbs of an arm in a working mode; none of an arm that has a ram in their place.

    Raises `FaultError` for an arm of another family.
    """
    words = mode.split("-")
    if isinstance(robot, Scara):
        return [Limb(0.0, robot.l1, robot.l2, 1.0 if mode == "left" else -1.0)]
    if isinstance(robot, FiveBar):
        turns, front = [1.0 if word == "left" else -1.0 for word in words], 1.0 if robot.assembly == "front" else -1.0
        feet = (robot.separation / 2.0, -robot.separation / 2.0)
        lengths = zip(robot.proximal, robot.distal, strict=True)
        return [Limb(at, *each, turn, 0.0, front) for at, each, turn in zip(feet, lengths, turns, strict=True)]
    if isinstance(robot, PolarArm):
        return []
    if not isinstance(robot, ElbowArm):
        raise FaultError(f"no textbook has the arm {type(robot).__name__}")
    turn = 1.0 if (words[-1] == "up") is not (words[0] == "back") else -1.0
    return [Limb(0.0, robot.l1, robot.l2, turn, robot.l3 if isinstance(robot, FiveAxisArm) else 0.0)]


def textbook(robot: Robot, q: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Places (L, m, 3) and yaw, pitch and roll (L, m, 3) of the links, in the order of `link_names`.

    Raises `FaultError` for an arm of another family.
    """
    zero, psi = np.zeros(len(q)), robot.base.yaw
    foot, rows = complex(robot.base.x, robot.base.y) + zero, list[tuple[Any, ...]]()
    z = robot.base.z + zero

    def link(at: Complex, height: FloatArray, *angles: FloatArray) -> None:
        rows.append((at.real, at.imag, height, *angles, *(zero,) * (3 - len(angles))))

    def e(angle: FloatArray) -> Complex:
        return np.asarray(np.exp(1j * angle))

    link(foot, z, zero + psi)
    if isinstance(robot, Scara):
        one = psi + q[:, 0]
        two = one + q[:, 1]
        arms, hand = z + q[:, 2] * robot.arms_rise, foot + robot.l1 * e(one) + robot.l2 * e(two)
        link(foot, arms, one)
        link(foot + robot.l1 * e(one), arms, two)
        link(hand, z + q[:, 2], zero)
        link(hand, z + q[:, 2], two + q[:, 3] if robot.axes == 4 else two)
    elif isinstance(robot, FiveBar):
        (left, right), half = robot.proximal, 0.5j * robot.separation * e(zero + psi)
        one, five = psi + q[:, 0], psi + q[:, 1]
        elbows = foot + half + left * e(one), foot - half + right * e(five)
        two, three = _couplers(*elbows, *robot.distal, 1.0 if robot.assembly == "front" else -1.0)
        hand, height = elbows[0] + robot.distal[0] * e(two), z + q[:, 2] if robot.axes > 2 else z
        link(foot + half, z, one)
        link(foot - half, z, five)
        link(elbows[0], z, two)
        link(elbows[1], z, three)
        link(hand, height, zero)
        link(hand, height, two + q[:, 3] if robot.axes > 3 else two)
    elif isinstance(robot, PolarArm | ElbowArm):
        heading = psi + q[:, 0]

        def tilted(zeta: Complex, *angles: FloatArray) -> None:  # a point ρ + i h of the arm's vertical plane
            link(foot + zeta.real * e(heading), z + robot.height + zeta.imag, heading, *angles)

        tilted(0j * zero, zero)
        tilted(0j * zero, q[:, 1])
        if isinstance(robot, PolarArm):
            for _ in ("link3", "flange"):
                tilted(q[:, 2] * e(q[:, 1]), q[:, 1])
        else:
            two, three = q[:, 1], q[:, 1] + q[:, 2]
            elbow = robot.l1 * e(two)
            tilted(elbow, three)
            if isinstance(robot, FiveAxisArm):
                four = three + q[:, 3]
                tilted(elbow + robot.l2 * e(three), four)
                tilted(elbow + robot.l2 * e(three) + robot.l3 * e(four), four, q[:, 4])
            else:
                tilted(elbow + robot.l2 * e(three), three)
    else:
        raise FaultError(f"no textbook has the arm {type(robot).__name__}")
    table = np.array(rows).transpose(0, 2, 1)
    return table[:, :, :3], table[:, :, 3:]


def states_at(path: Trajectory, time: float) -> FloatArray:
    """Position, velocity and acceleration (3, n) of the joints at a time: by the quintic that has those of both knots
    (N5). A joint rests before the first knot and behind the last one."""
    within = min(max(time, float(path.time[0])), float(path.time[-1]))
    i = min(int(np.searchsorted(path.time, within, side="right")), len(path.time) - 1) - 1
    while not path.time[i + 1] > path.time[i]:
        i -= 1  # the acceleration jumps at the last knot
    h, since = float(path.time[i + 1] - path.time[i]), within - float(path.time[i])

    def powers(t: float) -> FloatArray:
        return np.array([[math.perm(k, d) * t ** (k - d) if k >= d else 0.0 for k in range(6)] for d in range(3)])

    knots = np.array([rates[k] for k in (i, i + 1) for rates in (path.q, path.qd, path.qdd)])
    return np.asarray(powers(since) @ np.linalg.solve(np.concatenate([powers(0.0), powers(h)]), knots))


def place_at(robot: Robot, path: Trajectory, link: int, time: float) -> Four:
    """Where link number `link` (in the robot's own order), which stays upright, is at a time."""
    return link_at(robot, states_at(path, time)[0], link_row(robot, link))


def link_at(robot: Robot, q: FloatArray, row: int) -> Four:
    """Place and yaw of a link, by its number in a claim, with joints at q (n,); of one that tilts the heading."""
    places, angles = textbook(robot, q[None, :])
    x, y, z = (float(value) for value in places[row, 0])
    return (x, y, z, float(angles[row, 0, 0]))


def hand_shares(robot: Robot) -> FloatArray:
    """The shares (2, n) of the joints in pitch and roll of the flange, which are sums of joint values (H2)."""
    angles = textbook(robot, np.vstack([np.zeros(len(robot.joints)), np.eye(len(robot.joints))]))[1][-1, :, 1:]
    return np.asarray((angles[1:] - angles[0]).T)


def motion_agrees(scene: Scene, plan: Plan, claim: c.Claim) -> Iterator[Difference]:
    """Differences of the motion of the robot, which has the knots of the plan."""
    yield from _knots_agree(scene.robot, plan.trajectory, claim, 0)


def _knots_agree(robot: Robot, path: Trajectory, claim: c.Claim, arm: int) -> Iterator[Difference]:
    """The arm has the knots of the path, and one before and one behind at most, up to which it does not move."""
    row, n = claim.arms[arm], len(robot.joints)
    knots = claim.knots[int(row[c.ARM_KNOT]) :][: int(row[c.ARM_KNOTS])]
    first = int(knots[0, 0] < path.time[0])
    own = knots[first : first + len(path.time)]
    same = len(own) == len(path.time) and len(knots) - first - len(own) <= 1
    for column, values in ((c.KNOT_Q, path.q), (c.KNOT_QD, path.qd), (c.KNOT_QDD, path.qdd)):
        same = same and np.array_equal(own[:, column : column + n], values)
    same = same and np.array_equal(own[:, c.KNOT_TIME], path.time)
    for k, beside in [(0, 1)] * first + [(-1, -2)] * (len(knots) - first - len(own)):
        rests = not knots[[k, beside], c.KNOT_QD :].any()
        same = same and rests and np.array_equal(knots[k, c.KNOT_Q :], knots[beside, c.KNOT_Q :])
    if not same:
        whose = "plan" if arm == 0 else "request"
        yield Difference(Topic.MOTION, f"the motion of {robot.name} is not that of the {whose}")
