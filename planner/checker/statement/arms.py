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
Three = tuple[float, float, float]
ORIGIN = (0.0, 0.0, 0.0)
AHEAD, UP = 0, 2
"""Axes of a link."""


class Link(NamedTuple):
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

    def angles(self, base: float) -> list[tuple[float, tuple[int, ...]]]:
        """Yaw, pitch and roll: a constant, rad, and the joints that are added. `base`: the yaw of the arm's base. What
        counts from a coupler has its direction in addition."""
        yaw = 0.0 if self.yaw is None or self.coupler >= 0 else base
        return [(yaw, self.yaw or ()), (0.0, self.pitch), (0.0, self.roll)]


class Chain(NamedTuple):
    """The links of an arm. `loop`: the numbers of both cranks, their lengths, those of both couplers, and the side on
    which these meet; () for none. `angles`: of each link (`Link.angles`)."""

    links: tuple[Link, ...]
    loop: tuple[float, ...]
    angles: list[list[tuple[float, tuple[int, ...]]]]


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
    return Chain(tuple(links), loop, [link.angles(robot.base.yaw) for link in links])


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
    row, chain, n = claim.arms[arm].astype(int).tolist(), chain_of(robot), len(robot.joints)
    first, links = row[c.ARM_LINK], claim.links[row[c.ARM_LINK] :][: row[c.ARM_LINKS]].tolist()
    if len(links) != len(robot.links) or row[c.ARM_JOINTS] != n or (row[c.ARM_LOOP] >= 0) != bool(chain.loop):
        what = f"{robot.name} has {len(robot.links)} links, {n} joints and {'a' if chain.loop else 'no'} loop"
        report.require(False, Code.LINK, what)
        return
    sums = [*claim.angles[:, : 1 + n].tolist(), [0.0] * (1 + n)]  # a link that stays upright has no row, -1
    for name, link, angles, own in zip(robot.links, chain.links, chain.angles, links, strict=True):
        axis, joint = link.slide or (-1, -1)
        same = max(own[c.LINK_PARENT] - first, -1.0) == link.parent and own[c.LINK_COUPLER] == link.coupler
        same = same and own[c.LINK_SLIDE] == joint and _are_near(own[c.LINK_OFFSET : c.LINK_SLIDE], link.offset)
        along = [float(k == axis) for k in range(3)]
        same = same and (joint < 0 or _are_near(own[c.LINK_AXIS : c.LINK_YAW], along))
        for number, (constant, joints) in zip(own[c.LINK_YAW :], angles, strict=False):
            shares = [float(k in joints) for k in range(n)]
            same = same and _are_near(sums[int(number)], [constant, *shares])
        report.require(same, Code.LINK, f"{name} of {robot.name} is not where the request has it")
    if chain.loop:
        loop = claim.loops[row[c.ARM_LOOP]].tolist()
        pairs = list(zip(loop[: c.LOOP_LEAST], chain.loop, strict=True))
        near = [abs(x - y - (first if k < 2 else 0.0)) <= COPIED for k, (x, y) in enumerate(pairs)]
        report.require(all(near), Code.LINK, f"the loop of {robot.name} is another")
        far = loop[c.LOOP_LEAST] >= robot.parallel_least
        report.require(far, Code.LINK, f"{robot.name} may come nearer to a singularity of its loop")


def _are_near(stated: list[float], required: Sequence[float]) -> bool:
    return stated == required or all(abs(x - y) <= COPIED for x, y in zip(stated, required, strict=True))


def textbook(robot: Robot, q: Sequence[float]) -> list[tuple[Three, Three]]:
    """The place, m, and yaw, pitch and roll, rad, of each link of an arm in the world for joint values; NaN where its
    loop does not close. Raises `FaultError` for an arm of another family."""
    chain, found, couplers = chain_of(robot), list[tuple[Three, Three]](), list[float]()
    for link, turns in zip(chain.links, chain.angles, strict=True):
        local = list(link.offset)
        if link.slide is not None:
            local[link.slide[0]] += q[link.slide[1]]
        yaw, pitch, roll = [rad + sum([q[k] for k in joints]) if joints else rad for rad, joints in turns]
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
    within = min(max(time, float(path.time[0])), float(path.time[-1]))
    i = int(np.searchsorted(path.time, within, side="right")) - 1
    if path.time[i] == within:
        return path.knots[i, 1:].reshape(3, path.n)
    h, since = float(path.time[i + 1] - path.time[i]), within - float(path.time[i])

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
    flange, joints = chain_of(robot).links[-1], range(len(robot.joints))
    return np.array([[float(k in own) for k in joints] for own in (flange.pitch, flange.roll)])


@lru_cache(maxsize=c.MOST_JOINTS)
def knot_columns(n: int) -> IntArray:
    """The columns of the knots of an arm with n joints in a claim: times, positions, velocities and accelerations."""
    return np.array([c.KNOT_TIME, *(k + j for k in (c.KNOT_Q, c.KNOT_QD, c.KNOT_QDD) for j in range(n))])


def require_knots(report: Requirements, robot: Robot, path: Trajectory, claim: c.Claim, arm: int) -> None:
    """The arm has the knots of the path, and one before and one behind at most, up to which it does not move."""
    row, count = claim.arms[arm], len(path.time)
    knots = claim.knots[int(row[c.ARM_KNOT]) :][: int(row[c.ARM_KNOTS])]
    first = int(knots[0, 0] < path.time[0])
    behind = len(knots) - first - count
    own = knots[first : first + count].take(knot_columns(path.n), 1)
    same = behind in (0, 1) and bool((own == path.knots).all())
    for k, beside in [(0, 1)] * first + [(-1, -2)] * behind:
        rests = not knots[[k, beside], c.KNOT_QD :].any()
        same = same and rests and np.array_equal(knots[k, c.KNOT_Q :], knots[beside, c.KNOT_Q :])
    whose = "plan" if arm == 0 else "request"
    report.require(same, Code.MOTION, f"the motion of {robot.name} is not that of the {whose}")
