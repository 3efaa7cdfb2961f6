"""Are the links of a claim's arms those of textbooks, and do the arms move as plan and request state it?

The chain of each family of arms is here a second time, by its lengths (docs/kinematics.md): the angles of links are
sums of joint values. The rows of the claim are compared with it. World frame, m and rad.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from assur.planner.arrays import FloatArray
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
Three = tuple[float, float, float]
ORIGIN = (0.0, 0.0, 0.0)
AHEAD, UP = 0, 2
"""Axes of a link."""


class ChainLink(NamedTuple):
    """A link: the number of its parent (-1: the world); its origin in the parent's axes, m, and the axis along which a
    joint slides it; the joints whose sums are its yaw (from the base; None: from the world's x axis), its pitch and its
    roll; and the coupler from whose direction its yaw counts (-1: none)."""

    parent: int
    offset: Three = ORIGIN
    slide: tuple[int, int] | None = None
    yaw: tuple[int, ...] | None = ()
    pitch: tuple[int, ...] = ()
    roll: tuple[int, ...] = ()
    coupler: int = -1


class Chain(NamedTuple):
    """The links of an arm. `loop`: the numbers of both cranks, their lengths, those of both couplers, and the side on
    which these meet; () for none. `rows` (L, c.LINK): as in a claim, without angles. `angles` (L, 3, 1 + n): of yaw,
    pitch and roll the constant, rad, and the share of each joint; a yaw that counts from a coupler has its direction in
    addition."""

    links: tuple[ChainLink, ...]
    loop: tuple[float, ...]
    rows: FloatArray
    angles: FloatArray


@lru_cache(maxsize=64)
def chain_of(robot: Robot) -> Chain:
    """The chain of an arm by the lengths of the request: (K9) a SCARA, (K32), (K34) a five-bar, (K25), (H1), (H2) arms
    that tilt. Raises `FaultError` for an arm of another family."""
    links, loop = [ChainLink(-1, (robot.base.x, robot.base.y, robot.base.z))], tuple[float, ...]()
    if isinstance(robot, Scara):
        rise, lift = ((UP, 2), None) if robot.arms_rise else (None, (UP, 2))
        end = (robot.l2, 0.0, 0.0)
        links += [ChainLink(0, slide=rise, yaw=(0,)), ChainLink(1, (robot.l1, 0.0, 0.0), yaw=(0, 1))]
        links += [ChainLink(2, end, lift, None), ChainLink(2, end, lift, (0, 1, 3)[: robot.axes - 1])]
    elif isinstance(robot, FiveBar):
        half, (left, right), end = robot.separation / 2.0, robot.proximal, (robot.distal[0], 0.0, 0.0)
        lift = (UP, 2) if robot.axes > 2 else None
        links += [ChainLink(0, (0.0, half, 0.0), yaw=(0,)), ChainLink(0, (0.0, -half, 0.0), yaw=(1,))]
        links += [ChainLink(1, (left, 0.0, 0.0), coupler=0), ChainLink(2, (right, 0.0, 0.0), coupler=1)]
        links += [ChainLink(3, end, lift, None), ChainLink(3, end, lift, (3,) if robot.axes > 3 else (), coupler=0)]
        loop = (1.0, 2.0, *robot.proximal, *robot.distal, 1.0 if robot.assembly == "front" else -1.0)
    elif isinstance(robot, PolarArm | ElbowArm):
        links += [ChainLink(0, (0.0, 0.0, robot.height), yaw=(0,)), ChainLink(1, yaw=(0,), pitch=(1,))]
        if isinstance(robot, PolarArm):
            links += [ChainLink(2, slide=(AHEAD, 2), yaw=(0,), pitch=(1,))] * 2
        else:
            links.append(ChainLink(2, (robot.l1, 0.0, 0.0), yaw=(0,), pitch=(1, 2)))
            wrist = (1, 2, 3) if isinstance(robot, FiveAxisArm) else (1, 2)
            links.append(ChainLink(3, (robot.l2, 0.0, 0.0), yaw=(0,), pitch=wrist))
            if isinstance(robot, FiveAxisArm):
                links.append(ChainLink(4, (robot.l3, 0.0, 0.0), yaw=(0,), pitch=wrist, roll=(4,)))
    else:
        raise FaultError(f"no textbook has the arm {type(robot).__name__}")
    rows, angles = np.zeros((len(links), c.LINK)), np.zeros((len(links), 3, 1 + len(robot.joints)))
    for link, row, turns in zip(links, rows, angles, strict=True):
        row[c.LINK_PARENT], row[c.LINK_COUPLER], row[c.LINK_SLIDE] = link.parent, link.coupler, -1.0
        row[c.LINK_OFFSET : c.LINK_SLIDE] = link.offset
        if link.slide is not None:
            row[c.LINK_AXIS + link.slide[0]], row[c.LINK_SLIDE] = 1.0, link.slide[1]
        turns[0, 0] = 0.0 if link.yaw is None or link.coupler >= 0 else robot.base.yaw
        for turn, joints in zip(turns, (link.yaw or (), link.pitch, link.roll), strict=True):
            for joint in joints:
                turn[1 + joint] = 1.0
    return Chain(tuple(links), loop, rows, angles)


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
    row, chain, n = claim.arms[arm].astype(int).tolist(), chain_of(robot), len(robot.joints)
    first, links = row[c.ARM_LINK], claim.links[row[c.ARM_LINK] :][: row[c.ARM_LINKS]]
    if len(links) != len(robot.links) or row[c.ARM_JOINTS] != n or (row[c.ARM_LOOP] >= 0) != bool(chain.loop):
        what = f"{robot.name} has {len(robot.links)} links, {n} joints and {'a' if chain.loop else 'no'} loop"
        report.require(False, Code.LINK, what)
        return
    sums = np.zeros((len(claim.angles) + 1, 1 + n))  # a link that stays upright has no row, -1
    sums[:-1] = claim.angles[:, : 1 + n]
    off = np.abs(links - chain.rows)
    off[:, c.LINK_PARENT] = np.abs(np.maximum(links[:, c.LINK_PARENT] - first, -1.0) - chain.rows[:, c.LINK_PARENT])
    off[chain.rows[:, c.LINK_SLIDE] < 0.0, c.LINK_AXIS : c.LINK_YAW] = 0.0  # nothing slides
    turns = sums[links[:, c.LINK_YAW : c.LINK_COUPLER].astype(int)]
    off[:, c.LINK_YAW : c.LINK_COUPLER] = np.abs(turns - chain.angles).max(2)
    for name, same in zip(robot.links, np.asarray((off <= COPIED).all(1)).tolist(), strict=True):
        if not same:
            report.require(False, Code.LINK, f"{name} of {robot.name} is not where the request has it")
    if chain.loop:
        loop = claim.loops[row[c.ARM_LOOP]].tolist()
        pairs = list(zip(loop[: c.LOOP_LEAST], chain.loop, strict=True))
        near = [abs(x - y - (first if k < 2 else 0.0)) <= COPIED for k, (x, y) in enumerate(pairs)]
        report.require(all(near), Code.LINK, f"the loop of {robot.name} is another")
        far = loop[c.LOOP_LEAST] >= robot.parallel_least
        report.require(far, Code.LINK, f"{robot.name} may come nearer to a singularity of its loop")


def textbook(robot: Robot, q: Sequence[float]) -> list[tuple[Three, Three]]:
    """The place, m, and yaw, pitch and roll, rad, of each link of an arm in the world for joint values; NaN where its
    loop does not close. Raises `FaultError` for an arm of another family."""
    chain, found, couplers = chain_of(robot), list[tuple[Three, Three]](), list[float]()
    for link, (yaw, pitch, roll) in zip(chain.links, (chain.angles @ (1.0, *q)).tolist(), strict=True):
        local = list(link.offset)
        if link.slide is not None:
            local[link.slide[0]] += q[link.slide[1]]
        if link.coupler >= 0:
            couplers = couplers or _couplers(found, chain.loop)
            yaw += couplers[link.coupler]
        x, y, z = local
        if link.parent >= 0:
            (x, y, z), angles = found[link.parent]
            u, v, w = rotated(angles, local)
            x, y, z = x + u, y + v, z + w
        found.append(((x, y, z), (yaw, pitch, roll)))
    return found


def rotated(angles: Three, vector: Sequence[float]) -> Three:
    """Rz(yaw) Ry(-pitch) Rx(roll) times a vector."""
    (yaw, pitch, roll), (x, y, z) = angles, vector
    if pitch != 0.0 or roll != 0.0:
        (c, s), (v, w) = (math.cos(roll), math.sin(roll)), (math.cos(pitch), math.sin(pitch))
        y, z = c * y - s * z, s * y + c * z
        x, z = v * x - w * z, w * x + v * z
    c, s = math.cos(yaw), math.sin(yaw)
    return (c * x - s * y, s * x + c * y, z)


def _couplers(links: Sequence[tuple[Three, Three]], loop: Sequence[float]) -> list[float]:
    """Directions from the ends of both cranks to where the couplers meet: to the left of the line from the first end to
    the second (side 1) or to its right (-1). NaN where they do not meet."""
    ends = list[complex]()
    for crank, length in zip(loop[:2], loop[2:4], strict=True):
        place, angles = links[int(crank)]
        x, y, _ = rotated(angles, (length, 0.0, 0.0))
        ends.append(complex(place[0] + x, place[1] + y))
    (one, two), (a, b, side) = ends, loop[4:]
    apart = abs(two - one)
    cosine = (apart**2 + a**2 - b**2) / (2.0 * apart * a) if apart > 0.0 else math.nan
    if not abs(cosine) <= 1.0:
        return [math.nan, math.nan]
    first = cmath.phase(two - one) + side * math.acos(cosine)
    return [first, cmath.phase(one + cmath.rect(a, first) - two)]


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
    times, within = path.knots[:, 0], min(max(time, path.start), path.end)
    i = int(times.searchsorted(within, "right")) - 1
    begin = float(times[i])
    if begin == within:
        return path.knots[i, 1:].reshape(3, -1)
    h, since = float(times[i + 1]) - begin, within - begin

    def powers(t: float) -> FloatArray:
        return np.array([[math.perm(k, d) * t ** (k - d) if k >= d else 0.0 for k in range(6)] for d in range(3)])

    knots = np.array([rates[k] for k in (i, i + 1) for rates in (path.q, path.qd, path.qdd)])
    return np.asarray(powers(since) @ np.linalg.solve(np.concatenate([powers(0.0), powers(h)]), knots))


def place_at(robot: Robot, path: Trajectory, link: int, time: float) -> Four:
    """Where link number `link` (in the robot's own order), which stays upright, is at a time."""
    return link_at(robot, states_at(path, time)[0].tolist(), link)


def link_at(robot: Robot, q: Sequence[float], row: int) -> Four:
    """Place and yaw of a link, by its number in a claim, with joints at q; of one that tilts the heading."""
    (x, y, z), (yaw, _, _) = textbook(robot, q)[row]
    return (x, y, z, yaw)


def hand_shares(robot: Robot) -> FloatArray:
    """The shares (2, n) of the joints in pitch and roll of the flange, which are sums of joint values (H2)."""
    return np.asarray(chain_of(robot).angles[-1, 1:, 1:])


def require_knots(report: Requirements, robot: Robot, path: Trajectory, claim: c.Claim, arm: int) -> None:
    """The arm has the knots of the path, and one before and one behind at most, up to which it does not move."""
    row, required = claim.arms[arm], path.knots
    knots = claim.knots[int(row[c.ARM_KNOT]) :][: int(row[c.ARM_KNOTS])]
    first = int(knots[0, 0] < required[0, 0])
    behind = len(knots) - first - len(required)
    own = knots[first : first + len(required)]
    states, stated = (each[:, 1:].reshape(len(each), 3, -1) for each in (required, own))
    same = behind in (0, 1) and bool((own[:, c.KNOT_TIME] == required[:, 0]).all())
    same = same and bool((stated[:, :, : path.n] == states).all())
    for k, beside in [(0, 1)] * first + [(-1, -2)] * behind:
        same = same and bool((knots[k, c.KNOT_Q :] == knots[beside, c.KNOT_Q :]).all())
        same = same and not (knots[k, c.KNOT_QD :].any() or knots[beside, c.KNOT_QD :].any())
    if not same:
        whose = "plan" if arm == 0 else "request"
        report.require(False, Code.MOTION, f"the motion of {robot.name} is not that of the {whose}")
