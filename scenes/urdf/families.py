"""Which family of ours a chain of joints is, with its lengths, joint signs and zeros: SCARA, elbow arm, five-axis arm.

Axes and flange are evaluated with all joints at 0. Nothing is fitted: the chain must be of the family to 0.1 µm and
0.1 µrad, and the flanges of both are compared at random states afterwards.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.scenes.reading.arms import CALLED
from assur.scenes.schema.robots import Family
from assur.scenes.urdf.chain import Chain, chain_to, flanges
from assur.scenes.urdf.reader import ROUND_RAD
from assur.scenes.urdf.refusals import Defect, ImportRefused, OfNoFamily, Unsuitable
from assur.scenes.urdf.tree import Tree

SAME_M, SAME_RAD = 1e-7, 1e-7
"""How far what must coincide may be apart: below a tenth of what the flange may be off in the end."""
LEAST_LENGTH_M = 1e-5
MOST_SHOWN = 8
"""Number of joints that are listed if an arm is of no family."""
UP = np.array([0.0, 0.0, 1.0])
FAMILIES = (
    "what can be imported: a SCARA (two or three vertical joints that turn and a vertical lift, in any order), an "
    "elbow arm (one vertical joint, two parallel level ones) and a five-axis arm (one vertical joint, three parallel "
    "level ones, a roll about the hand)"
)


@dataclass(frozen=True, eq=False)
class Kinematics:
    """A chain as an arm of a family.

    `lengths`: SI fields of its document. `signs` and `zeros` of the joints in the file's order; the zero of a lift is
    the height of the flange at the file's 0. `offset` (x, y) of the base axis, m. `order`: the axis order of a SCARA.
    `turn` (3, 3): the flange's frame of the file in ours (`z_down` taken into account), constant.
    """

    family: Family
    lengths: dict[str, float]
    signs: tuple[int, ...]
    zeros: tuple[float, ...]
    offset: tuple[float, float]
    turn: FloatArray
    order: str = ""
    z_down: bool = False


def recognised(chain: Chain) -> Kinematics:
    """The arm of a chain. Raises `Unsuitable` with the reason why it is no arm of ours."""
    axes = chain.axes
    kinds = "".join("r" if axis.turns else "p" for axis in axes)
    upright = [_parallel(axis.direction, UP) for axis in axes]
    if not axes:
        raise Unsuitable("the file", "no moving joint", FAMILIES)
    if not upright[0]:
        tilt = math.degrees(math.acos(min(1.0, abs(float(axes[0].direction @ UP)))))
        what = f"its axis is {tilt:.6g} deg off the vertical of link {chain.base}"
        where = f"joint {chain.joints[0].name}"
        raise Unsuitable(where, what, f"choose --base LINK whose frame has z along it; {FAMILIES}")
    if all(upright) and kinds.count("p") == 1 and kinds.count("r") in (2, 3):
        return _scara(chain, kinds)
    level = [abs(float(axis.direction @ UP)) <= SAME_RAD for axis in axes]
    if kinds == "rrr" and level == [False, True, True]:
        return _elbow(chain)
    if kinds == "rrrrr" and level[:4] == [False, True, True, True]:
        return _five(chain)
    raise Unsuitable("the joints", _in_words(chain, upright, level), FAMILIES)


def _in_words(chain: Chain, upright: list[bool], level: list[bool]) -> str:
    each = []
    for axis, up, flat in zip(chain.axes, upright, level, strict=True):
        tilt = math.degrees(math.asin(min(1.0, abs(float(axis.direction @ UP)))))
        steep = f"{90.0 - tilt:.4g} deg from vertical" if tilt > 45.0 else f"{tilt:.4g} deg from level"
        way = "vertical" if up else "level" if flat else steep
        each.append(f"{way} {'turn' if axis.turns else 'slide'}")
    more = f" and {len(each) - MOST_SHOWN} more" if len(each) > MOST_SHOWN else ""
    message = f"{len(each)} moving joints ({', '.join(each[:MOST_SHOWN])}{more}) are no family of ours"
    if [each[:1], each[1:3]] == [["vertical turn"], ["level turn"] * 2] and len(each) == 4:
        message += "; this is a palletiser with four axes, and no SCARA"
    return message


def _scara(chain: Chain, kinds: str) -> Kinematics:
    lift = kinds.index("p")
    turning = [i for i in range(len(kinds)) if i != lift]
    order = kinds if len(kinds) == 4 else {0: "prrr", 1: "rprr", 2: "rrpr"}[lift]
    axes, tip = chain.axes, _tip(chain)
    a, b, c = (axes[i].point[:2] for i in (*turning, turning[-1])[:3])
    if len(turning) == 2:
        c = tip[:2, 3]
    else:
        _same_place(chain, tip[:2, 3] - c, f"the axis of joint {chain.joints[turning[2]].name}")
    l1, l2 = _length(b - a, "link 1"), _length(c - b, "link 2")
    z_down = float(tip[2, 2]) < 0.0
    upright = tip[:3, :3] @ np.diag([1.0, -1.0, -1.0]) if z_down else tip[:3, :3]
    if not _parallel(upright[:, 2], UP):
        where = f"link {chain.tip}"
        raise Unsuitable(where, "its z axis is not vertical", "choose --tip LINK whose frame has z along the lift")
    heading = math.atan2(*(b - a)[::-1])
    bend = math.atan2(*(c - b)[::-1]) - heading
    signs = [1 if axis.direction[2] > 0 else -1 for axis in axes]
    zeros = [0.0] * len(kinds)
    zeros[turning[0]], zeros[turning[1]] = heading, _principal(bend)
    zeros[lift] = float(tip[2, 3])
    turn = _about_z(-heading - bend) @ upright
    if len(turning) == 3:
        zeros[turning[2]] = _principal(math.atan2(turn[1, 0], turn[0, 0]))
        turn = _about_z(-zeros[turning[2]]) @ turn
    lengths = {"l1_m": l1, "l2_m": l2}
    return Kinematics("scara", lengths, tuple(signs), tuple(zeros), _point(a), turn, order, z_down)


def _elbow(chain: Chain) -> Kinematics:
    plane = _Plane(chain)
    tip = _tip(chain)
    elbow, end = plane.seen(chain.axes[2].point), plane.seen(tip[:3, 3])
    plane.hold_in(tip[:3, 3], f"the flange, link {chain.tip},")
    upper, fore = elbow - plane.shoulder, end - elbow
    l1, l2 = _length(upper, "the upper arm"), _length(fore, "the forearm")
    zeros = plane.zeros([_angle(upper), _angle(fore)])
    turn = plane.frame(_angle(fore)).T @ tip[:3, :3]
    lengths = {"height_m": plane.height, "l1_m": l1, "l2_m": l2}
    return Kinematics("elbow_arm", lengths, plane.signs(2), zeros, plane.offset, turn)


def _five(chain: Chain) -> Kinematics:
    plane = _Plane(chain)
    tip, roll = _tip(chain), chain.axes[4]
    name = chain.joints[4].name
    elbow, wrist = (plane.seen(chain.axes[i].point) for i in (2, 3))
    along = plane.seen(plane.base * [1.0, 1.0, 0.0] + roll.direction)
    if not abs(float(roll.direction @ plane.across)) <= SAME_RAD:
        raise Unsuitable(f"joint {name}", "its axis is not square to the three level axes before it", FAMILIES)
    plane.hold_in(roll.point, f"the axis of joint {name}")
    off = plane.seen(roll.point) - wrist
    aside = float(along[0] * off[1] - along[1] * off[0])
    if not abs(aside) <= SAME_M:
        what = f"its axis passes the pitch axis at {1e3 * abs(aside):.6g} mm; those of our five-axis arm meet"
        raise Unsuitable(f"joint {name}", what, FAMILIES)
    end = plane.seen(tip[:3, 3])
    hand = end - wrist
    beside = np.array([tip[:3, 3] @ plane.across - roll.point @ plane.across, along[0] * hand[1] - along[1] * hand[0]])
    _same_place(chain, beside, f"the axis of joint {name}")
    l3 = _length(hand, "the hand, from the pitch axis to the flange")
    upper, fore = elbow - plane.shoulder, wrist - elbow
    l1, l2 = _length(upper, "the upper arm"), _length(fore, "the forearm")
    zeros = (*plane.zeros([_angle(upper), _angle(fore), _angle(hand)]), 0.0)
    signs = (*plane.signs(3), 1 if float(along @ hand) > 0 else -1)
    turn = plane.frame(_angle(hand)).T @ tip[:3, :3]
    lengths = {"height_m": plane.height, "l1_m": l1, "l2_m": l2, "l3_m": l3}
    return Kinematics("five_axis_arm", lengths, signs, zeros, plane.offset, turn)


class _Plane:
    """The vertical plane of an arm whose links tilt, all joints at 0: through the base axis, square to the level axes.

    It is seen so that the flange is ahead; of two ways that are alike, so that the heading is nearer to the x axis,
    then to the y axis.
    """

    def __init__(self, chain: Chain) -> None:
        self.chain, self.base, second = chain, chain.axes[0].point, chain.axes[1]
        self.level = [axis for axis in chain.axes[1:4] if abs(float(axis.direction @ UP)) <= SAME_RAD]
        for axis, joint in zip(self.level, chain.joints[1:], strict=False):
            if not _parallel(axis.direction, second.direction):
                raise Unsuitable(f"joint {joint.name}", "its axis is not parallel to the level one before it", FAMILIES)
        ahead = np.cross(second.direction, UP)
        ahead /= np.linalg.norm(ahead)
        reach = float((_tip(chain)[:3, 3] - self.base) @ ahead)
        if next((value for value in (reach, *ahead[:2]) if abs(value) > SAME_M), 1.0) < 0.0:
            ahead = -ahead
        self.ahead, self.across = ahead, np.cross(UP, ahead)
        past = float((second.point - self.base) @ ahead)
        if not abs(past) <= SAME_M:
            what = f"its axis passes the axis of joint {chain.joints[0].name} at {1e3 * abs(past):.6g} mm"
            supply = f"in our arms whose links tilt they meet; {FAMILIES}"
            raise Unsuitable(f"joint {chain.joints[1].name}", what, supply)
        self.shoulder = self.seen(second.point)
        self.height = float(second.point[2])
        self.offset = _point(self.base)

    def seen(self, point: FloatArray) -> FloatArray:
        """(distance ahead of the base axis, height) of a point, m."""
        return np.array([(point - self.base) @ self.ahead, point[2]])

    def hold_in(self, point: FloatArray, what: str) -> None:
        """Raises `Unsuitable` for a point that is beside the plane."""
        beside = float((point - self.base) @ self.across)
        if not abs(beside) <= SAME_M:
            supply = f"in our arms it is in one; {FAMILIES}"
            raise Unsuitable(
                what.strip(","), f"{1e3 * abs(beside):.6g} mm beside the vertical plane of the arm", supply
            )

    def signs(self, level: int) -> tuple[int, ...]:
        """Signs of the base joint and of so many level ones: up is positive."""
        first = 1 if self.chain.axes[0].direction[2] > 0 else -1
        return (first, *(1 if axis.direction @ self.across < 0 else -1 for axis in self.level[:level]))

    def zeros(self, angles: list[float]) -> tuple[float, ...]:
        """Zeros of the base joint and of the level ones, whose links are at angles above the horizontal."""
        steps = [angle - before for angle, before in zip(angles, [0.0, *angles], strict=False)]
        return (math.atan2(self.ahead[1], self.ahead[0]), *(_principal(step) for step in steps))

    def frame(self, angle: float) -> FloatArray:
        """Axes (3, 3) of a link at an angle above the horizontal: ahead along it, across, up."""
        along = math.cos(angle) * self.ahead + math.sin(angle) * UP
        return np.stack([along, self.across, np.cross(along, self.across)], axis=1)


def _tip(chain: Chain) -> FloatArray:
    found: FloatArray = chain.places(np.zeros(len(chain.joints)))[chain.tip]
    return found


def _same_place(chain: Chain, off: FloatArray, of: str) -> None:
    """Raises `Unsuitable` for a flange that is not on the axis about which it turns."""
    distance = float(np.hypot(*off))
    if not distance <= SAME_M:
        supply = "choose --tip LINK with its origin on the axis, and give the rest as the tool of a request (tcp_mm)"
        raise Unsuitable(f"link {chain.tip}", f"{1e3 * distance:.6g} mm off {of}", supply)


def _length(way: FloatArray, what: str) -> float:
    length = float(np.hypot(*way))
    if not length >= LEAST_LENGTH_M:
        raise Unsuitable("the joints", f"{what} has no length: two axes are in one line", FAMILIES)
    return length


def _parallel(a: FloatArray, b: FloatArray) -> bool:
    return float(np.linalg.norm(np.cross(a, b))) <= SAME_RAD


def _angle(way: FloatArray) -> float:
    return math.atan2(float(way[1]), float(way[0]))


def _principal(angle: float) -> float:
    found = math.remainder(angle, math.tau)
    return 0.0 if abs(found) < 1e-15 else found


def _about_z(angle: float) -> FloatArray:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def _point(place: FloatArray) -> tuple[float, float]:
    x, y = (float(value) + 0.0 for value in place[:2])
    return x, y


NEARLY_RAD = 5e-3
"""An angle this near to a multiple of a right angle was probably meant to be one: 1.57, 3.14, 4.71."""
MOST_AXES = 5
"""No arm of ours has more."""


# Which chain of a tree is the arm: the first possible flange with which the chain is of a family of ours counts. An arm
# of no family is refused with the reason for that only: limits and meshes do not matter then.


def arm_in(
    tree: Tree, name: str, base: str, wanted: str | None, hinted: tuple[str, ...]
) -> tuple[Chain, Kinematics, list[Defect], list[str]]:
    """The chain from `base` to the flange with the kinematics that it has, the joints that keep it from being an arm
    all the same, and why likelier links are not the flange. `wanted` and `hinted`: links that may be, as in `flanges`.

    Raises `OfNoFamily` for an arm of no family, `ImportRefused` where there is no chain. Both call the file `name`.
    """
    tips = flanges(tree, base, wanted, hinted)
    if not tips:
        raise ImportRefused(name, [Defect("the file", "no joint moves", "a robot's description")])
    beside: tuple[Chain, Kinematics, list[Defect]] | None = None
    failed: list[Defect] = []
    passed: list[str] = []
    for tip in tips:
        chain, lacks = chain_to(tree, base, tip)
        if chain is None:
            raise ImportRefused(name, lacks)
        try:
            kinematics = recognised(chain)
        except Unsuitable as error:
            failed = failed or _kept_from(chain, lacks, error.lack)
            passed.append(f"link {tip} is not taken as the flange: {error.lack.where}: {error.lack.what}")
            continue
        if not lacks:
            return chain, kinematics, [], passed
        beside = beside or (chain, kinematics, lacks)
    if beside is None:
        raise OfNoFamily(name, failed)
    return *beside, passed


def _kept_from(chain: Chain, lacks: list[Defect], lack: Defect) -> list[Defect]:
    """What keeps a chain from being an arm of ours: axes, linkages, angles that were mistyped; or else its gripper."""
    if known := _or_without_gripper(chain, lack):
        return [known]
    on_the_way = {f"joint {joint.name}" for joint in chain.tree.path(chain.base, chain.tip) or []}
    return [lack, *(each for each in lacks if each.where in on_the_way), *_nearly(chain)]


def _or_without_gripper(chain: Chain, lack: Defect) -> Defect | None:
    """What to say of a chain that is an arm of ours but for a gripper at its end; None if it is none.

    What is left out must look like a gripper: it slides, or the rest is an arm with a wrist. No joint there may follow
    one of the arm: then it is a linkage.
    """
    tree, base = chain.tree, chain.base
    for count in range(min(len(chain.joints) - 1, MOST_AXES), 2, -1):
        last = chain.joints[count - 1].child
        after = chain.joints[count].parent
        for tip in dict.fromkeys([after, last]):
            arm, _ = chain_to(tree, base, tip)
            if arm is None:
                continue
            try:
                kinematics = recognised(arm)
            except Unsuitable:
                continue
            dropped = chain.joints[count:]
            wrist = kinematics.family == "five_axis_arm" or (kinematics.family == "scara" and count == 4)
            slides = all(joint.kind == "prismatic" for joint in dropped)
            own = {joint.name for joint in arm.joints}
            moving = [joint for joint in tree.joints.values() if joint.moves and joint.name not in own]
            if not (wrist or slides) or any(joint.mimics in own or joint.name in own for joint in moving):
                return None
            if any(joint.mimics is not None for joint in arm.joints):
                return None
            hold = " ".join(f"--hold {joint.name}=POSITION" for joint in moving if joint.mimics is None)
            what = f"{lack.what}; without a gripper, up to link {tip}, it is {CALLED[kinematics.family]}"
            return Defect(lack.where, what, f"say --tip {tip} {hold}")
    return None


def _nearly(chain: Chain) -> list[Defect]:
    """Angles of joints on the way to the flange that are almost right angles, but too far off to be read as such."""
    found = []
    for joint in chain.tree.path(chain.base, chain.tip) or []:
        for angle in joint.rpy:
            near = round(angle / (math.pi / 2)) * (math.pi / 2)
            off = abs(angle - near)
            if ROUND_RAD < off <= NEARLY_RAD:
                what = f"{angle:.9g} rad is {math.degrees(off):.3g} deg off {math.degrees(near):.0f} deg"
                found.append(Defect(f"joint {joint.name}, origin.rpy", what, f"write {near!r} if that is meant"))
    return found
