"""Are the links of a claim's arms those of textbooks, and do the arms move as plan and request state it?

The chain of each family of arms is here a second time, by its lengths (docs/kinematics.md): the angles of links are
sums of joint values. The rows of the claim are compared with it. World frame, m and rad; (m, n) are m vectors of n
joint values.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.checker.statement import laws
from assur.planner.checker.statement.differences import Four, Requirements
from assur.planner.checker.verdict import Code
from assur.planner.claim import columns as c
from assur.planner.errors import FaultError
from assur.planner.model.scene import Scene
from assur.planner.robots.five_axis_arm import FiveAxisArm
from assur.planner.robots.five_bar import FiveBar
from assur.planner.robots.robot import Robot
from assur.planner.robots.scara import Scara
from assur.planner.robots.tilting import ElbowArm, PolarArm
from assur.planner.trajectory import Trajectory

COPIED = 1e-12
"""m or rad. The numbers of an arm are copied from the request, so they differ by no more."""
Complex = NDArray[np.complexfloating[Any, Any]]
ORIGIN = (0.0, 0.0, 0.0)
AHEAD, UP = 0, 2
"""Axes of a link."""


class Link(NamedTuple):
    """A link: the number of its parent (-1: the world); its origin in the parent's axes, m, and the axis along which a
    joint slides it; the joints whose sums are its yaw (from the base; None: from the world's x axis), its pitch and its
    roll; and the coupler from whose direction its yaw counts (-1: none)."""

    parent: int
    offset: tuple[float, float, float] = ORIGIN
    slide: tuple[int, int] | None = None
    yaw: tuple[int, ...] | None = ()
    pitch: tuple[int, ...] = ()
    roll: tuple[int, ...] = ()
    coupler: int = -1


class Chain(NamedTuple):
    """L links of an arm with n joints. `origins` in the axes of the parents, m, and `angles`, yaw, pitch and roll in
    the world, rad, (L, 3, 1 + n): a constant, and the share of each joint. `loop`: the numbers of both cranks, their
    lengths, those of both couplers, and the side on which these meet; () for none."""

    parents: IntArray
    couplers: IntArray
    origins: FloatArray
    angles: FloatArray
    loop: tuple[float, ...]


@lru_cache(maxsize=64)
def chain_of(robot: Robot) -> Chain:
    """The chain of an arm by the lengths of the request: (K9) a SCARA, (K32), (K34) a five-bar, (K25), (H1), (H2) arms
    that tilt. Raises `FaultError` for an arm of another family."""
    links, loop = [Link(-1, (robot.base.x, robot.base.y, robot.base.z))], tuple[float, ...]()
    if isinstance(robot, Scara):
        rise, lift = ((UP, 2), None) if robot.arms_rise else (None, (UP, 2))
        end = (robot.l2, 0.0, 0.0)
        links += [Link(0, slide=rise, yaw=(0,)), Link(1, (robot.l1, 0.0, 0.0), yaw=(0, 1))]
        links += [Link(2, end, lift, None), Link(2, end, lift, (0, 1, 3)[: robot.axes - 1])]
    elif isinstance(robot, FiveBar):
        half, (left, right), end = robot.separation / 2.0, robot.proximal, (robot.distal[0], 0.0, 0.0)
        lift = (UP, 2) if robot.axes > 2 else None
        links += [Link(0, (0.0, half, 0.0), yaw=(0,)), Link(0, (0.0, -half, 0.0), yaw=(1,))]
        links += [Link(1, (left, 0.0, 0.0), coupler=0), Link(2, (right, 0.0, 0.0), coupler=1)]
        links += [Link(3, end, lift, None), Link(3, end, lift, (3,) if robot.axes > 3 else (), coupler=0)]
        loop = (1.0, 2.0, *robot.proximal, *robot.distal, 1.0 if robot.assembly == "front" else -1.0)
    elif isinstance(robot, PolarArm | ElbowArm):
        links += [Link(0, (0.0, 0.0, robot.height), yaw=(0,)), Link(1, yaw=(0,), pitch=(1,))]
        if isinstance(robot, PolarArm):
            links += [Link(2, slide=(AHEAD, 2), yaw=(0,), pitch=(1,))] * 2
        else:
            links.append(Link(2, (robot.l1, 0.0, 0.0), yaw=(0,), pitch=(1, 2)))
            wrist = (1, 2, 3) if isinstance(robot, FiveAxisArm) else (1, 2)
            links.append(Link(3, (robot.l2, 0.0, 0.0), yaw=(0,), pitch=wrist))
            if isinstance(robot, FiveAxisArm):
                links.append(Link(4, (robot.l3, 0.0, 0.0), yaw=(0,), pitch=wrist, roll=(4,)))
    else:
        raise FaultError(f"no textbook has the arm {type(robot).__name__}")
    origins, angles = np.zeros((2, len(links), 3, 1 + len(robot.joints)))
    for k, link in enumerate(links):
        origins[k, :, 0] = link.offset
        if link.slide is not None:
            axis, joint = link.slide
            origins[k, axis, 1 + joint] = 1.0
        angles[k, 0, 0] = 0.0 if link.yaw is None or link.coupler >= 0 else robot.base.yaw
        for row, joints in enumerate((link.yaw or (), link.pitch, link.roll)):
            angles[k, row, [1 + joint for joint in joints]] = 1.0
    parents, couplers = (np.array([link[k] for link in links]) for k in (0, -1))
    return Chain(parents, couplers, origins, angles, loop)


def link_names(robot: Robot) -> tuple[str, ...]:
    """The links of an arm in the order of a claim: those of the robot."""
    return robot.links


def flange_row(robot: Robot) -> int:
    """The number in a claim of the flange, which carries tool and part."""
    return robot.links.index("flange")


def require_links(report: Requirements, scene: Scene, claim: c.Claim) -> None:
    """The links of all arms are those of the request, frames that are links of other arms than the robot are such links
    in the claim, and these arms move as the request states it."""
    arms: dict[int, tuple[Robot, Trajectory]] = {}
    for frame, row in zip(scene.frames.values(), claim.frames.tolist(), strict=False):
        of, arm = laws.link_of(frame.law), int(row[c.FRAME_ARM])
        if of is None:
            continue
        robot, path, link = of
        report.require(arm >= 1, Code.LAW, f"{frame.name} is a link of an arm in the request, and not in the claim")
        if arm >= 1:
            other = arms.setdefault(arm, (robot, path))
            same_arm = other[0] is robot and other[1] is path
            report.require(same_arm, Code.LAW, f"{frame.name} is a link of another arm")
            same_link = row[c.FRAME_LINK] == claim.arms[arm, c.ARM_LINK] + link
            report.require(same_link, Code.LAW, f"{frame.name} is another link of its arm")
    if sorted(arms) != list(range(1, len(claim.arms))):
        report.require(False, Code.LINK, f"the claim has {len(claim.arms)} arms, not {1 + len(arms)}")
        return
    _require_chain(report, scene.robot, 0, claim)
    for arm, (robot, path) in arms.items():
        _require_chain(report, robot, arm, claim)
        require_knots(report, robot, path, claim, arm)


def _require_chain(report: Requirements, robot: Robot, arm: int, claim: c.Claim) -> None:
    """The links of an arm are those of its chain, and its loop is as far from singular positions."""
    row, chain, n = claim.arms[arm].astype(int), chain_of(robot), len(robot.joints)
    first, links = int(row[c.ARM_LINK]), claim.links[row[c.ARM_LINK] :][: row[c.ARM_LINKS]]
    if len(links) != len(robot.links) or row[c.ARM_JOINTS] != n or (row[c.ARM_LOOP] >= 0) != bool(chain.loop):
        what = f"{robot.name} has {len(robot.links)} links, {n} joints and {'a' if chain.loop else 'no'} loop"
        report.require(False, Code.LINK, what)
        return
    origins, slides = np.zeros_like(chain.origins), links[:, c.LINK_SLIDE].astype(int)
    origins[:, :, 0] = links[:, c.LINK_OFFSET : c.LINK_SLIDE]
    for k in np.flatnonzero(slides >= 0):
        origins[k, :, 1 + slides[k]] = links[k, c.LINK_AXIS : c.LINK_YAW]
    sums = np.vstack([claim.angles[:, : 1 + n], np.zeros(1 + n)])  # a link that stays upright has no row, -1
    angles = sums[links[:, c.LINK_YAW : c.LINK_COUPLER].astype(int)]
    off = np.maximum(np.abs(origins - chain.origins), np.abs(angles - chain.angles)).max((1, 2))
    same = off <= COPIED
    same &= np.maximum(links[:, c.LINK_PARENT] - first, -1.0) == chain.parents
    same &= links[:, c.LINK_COUPLER] == chain.couplers
    for name, is_same in zip(robot.links, same.tolist(), strict=True):
        report.require(is_same, Code.LINK, f"{name} of {robot.name} is not where the request has it")
    if chain.loop:
        loop = claim.loops[row[c.ARM_LOOP]]
        off = np.abs(loop[: c.LOOP_LEAST] - chain.loop - np.array([first] * 2 + [0.0] * 5))
        report.require((off <= COPIED).all(), Code.LINK, f"the loop of {robot.name} is another")
        far = loop[c.LOOP_LEAST] >= robot.parallel_least
        report.require(far, Code.LINK, f"{robot.name} may come nearer to a singularity of its loop")


def textbook(robot: Robot, q: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Places (L, m, 3), m, and yaw, pitch and roll (L, m, 3), rad, of the links of an arm in the world for joint values
    q (m, n); NaN where its loop does not close. Raises `FaultError` for an arm of another family."""
    chain, ones = chain_of(robot), np.concatenate([np.ones((1, len(q))), q.T])
    local, angles = ((each @ ones).transpose(0, 2, 1) for each in (chain.origins, chain.angles))
    places = _stacked(chain.parents, local, angles)
    if chain.loop:
        lengths = zip((int(crank) for crank in chain.loop[:2]), chain.loop[2:4], strict=True)
        ends = (places[k] + rotated(angles[k], np.array([length, 0.0, 0.0])) for k, length in lengths)
        directions = np.array(_couplers(*(end[:, 0] + 1j * end[:, 1] for end in ends), *chain.loop[4:]))
        angles[:, :, 0] += np.where(chain.couplers[:, None] >= 0, directions[chain.couplers], 0.0)
        places = _stacked(chain.parents, local, angles)
    return places, angles


def _stacked(parents: IntArray, local: FloatArray, angles: FloatArray) -> FloatArray:
    """Places (L, m, 3) of links whose origins are at `local` in the axes of their parents."""
    places = rotated(angles[parents], local)
    places[0] = local[0]
    for k, parent in enumerate(parents[1:].tolist(), start=1):
        places[k] += places[parent]
    return places


def rotated(angles: FloatArray, vectors: FloatArray) -> FloatArray:
    """Rz(yaw) Ry(-pitch) Rx(roll) times vectors (..., 3), for angles (..., 3)."""
    (cy, cp, cr), (sy, sp, sr), (x, y, z) = (each.T for each in (np.cos(angles), np.sin(angles), vectors))
    y, z = cr * y - sr * z, sr * y + cr * z
    x, z = cp * x - sp * z, sp * x + cp * z
    return np.array([cy * x - sy * y, sy * x + cy * y, z]).T


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


def states_at(path: Trajectory, time: float) -> FloatArray:
    """Position, velocity and acceleration (3, n) of the joints at a time: by the quintic that has those of both knots
    (N5). A joint rests before the first knot and behind the last one."""
    within = min(max(time, float(path.time[0])), float(path.time[-1]))
    i = int(np.searchsorted(path.time, within, side="right")) - 1
    if path.time[i] == within:
        return np.array([path.q[i], path.qd[i], path.qdd[i]])
    h, since = float(path.time[i + 1] - path.time[i]), within - float(path.time[i])

    def powers(t: float) -> FloatArray:
        return np.array([[math.perm(k, d) * t ** (k - d) if k >= d else 0.0 for k in range(6)] for d in range(3)])

    knots = np.array([rates[k] for k in (i, i + 1) for rates in (path.q, path.qd, path.qdd)])
    return np.asarray(powers(since) @ np.linalg.solve(np.concatenate([powers(0.0), powers(h)]), knots))


def place_at(robot: Robot, path: Trajectory, link: int, time: float) -> Four:
    """Where link number `link` (in the robot's own order), which stays upright, is at a time."""
    return link_at(robot, states_at(path, time)[0], link)


def link_at(robot: Robot, q: FloatArray, row: int) -> Four:
    """Place and yaw of a link, by its number in a claim, with joints at q (n,); of one that tilts the heading."""
    places, angles = textbook(robot, q[None, :])
    x, y, z = (float(value) for value in places[row, 0])
    return (x, y, z, float(angles[row, 0, 0]))


def hand_shares(robot: Robot) -> FloatArray:
    """The shares (2, n) of the joints in pitch and roll of the flange, which are sums of joint values (H2)."""
    return chain_of(robot).angles[-1, 1:, 1:]


def require_knots(report: Requirements, robot: Robot, path: Trajectory, claim: c.Claim, arm: int) -> None:
    """The arm has the knots of the path, and one before and one behind at most, up to which it does not move."""
    row, n, count = claim.arms[arm], path.n, len(path.time)
    knots = claim.knots[int(row[c.ARM_KNOT]) :][: int(row[c.ARM_KNOTS])]
    first = int(knots[0, 0] < path.time[0])
    own, behind = knots[first : first + count], len(knots) - first - count
    same = (
        behind in (0, 1)
        and bool((own[:, c.KNOT_TIME] == path.time).all())
        and bool((own[:, c.KNOT_Q : c.KNOT_Q + n] == path.q).all())
        and bool((own[:, c.KNOT_QD : c.KNOT_QD + n] == path.qd).all())
        and bool((own[:, c.KNOT_QDD : c.KNOT_QDD + n] == path.qdd).all())
    )
    for k, beside in [(0, 1)] * first + [(-1, -2)] * behind:
        rests = not knots[[k, beside], c.KNOT_QD :].any()
        same = same and rests and np.array_equal(knots[k, c.KNOT_Q :], knots[beside, c.KNOT_Q :])
    whose = "plan" if arm == 0 else "request"
    report.require(same, Code.MOTION, f"the motion of {robot.name} is not that of the {whose}")
