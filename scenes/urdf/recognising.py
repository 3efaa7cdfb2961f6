"""Which chain of a tree is the arm: of the links that may be its flange the first with which it is of a family of ours.

An arm of no family is refused with what keeps it from being one and nothing else: its limits and meshes do not matter.
"""

from __future__ import annotations

import math

from assur.scenes.urdf.chain import Chain, chain_to, flanges
from assur.scenes.urdf.families import Kinematics, recognised
from assur.scenes.urdf.reader import ROUND_RAD
from assur.scenes.urdf.refusals import ImportRefused, Lack, OfNoFamily, Unsuitable
from assur.scenes.urdf.tree import Tree

NEARLY_RAD = 5e-3
"""An angle this near to a multiple of a right angle was probably meant to be one: 1.57, 3.14, 4.71."""
MOST_AXES = 5
"""No arm of ours has more."""
WORDS = {"scara": "a SCARA", "elbow_arm": "an elbow arm", "five_axis_arm": "a five-axis arm"}


def arm_in(
    tree: Tree, name: str, base: str, wanted: str | None, hinted: tuple[str, ...]
) -> tuple[Chain, Kinematics, list[Lack], list[str]]:
    """The chain from `base` to the flange with the kinematics that it has, the joints that keep it from being an arm
    all the same, and why likelier links are not the flange. `wanted` and `hinted`: links that may be, as in `flanges`.

    Raises `OfNoFamily` for an arm of no family, `ImportRefused` where there is no chain. Both call the file `name`.
    """
    tips = flanges(tree, base, wanted, hinted)
    if not tips:
        raise ImportRefused(name, [Lack("the file", "no joint moves", "a robot's description")])
    beside: tuple[Chain, Kinematics, list[Lack]] | None = None
    failed: list[Lack] = []
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


def _kept_from(chain: Chain, lacks: list[Lack], lack: Lack) -> list[Lack]:
    """What keeps a chain from being an arm of ours: axes, linkages, angles that were mistyped; or else its gripper."""
    if known := _or_without_gripper(chain, lack):
        return [known]
    on_the_way = {f"joint {joint.name}" for joint in chain.tree.path(chain.base, chain.tip) or []}
    return [lack, *(each for each in lacks if each.where in on_the_way), *_nearly(chain)]


def _or_without_gripper(chain: Chain, lack: Lack) -> Lack | None:
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
            what = f"{lack.what}; without a gripper, up to link {tip}, it is {WORDS[kinematics.family]}"
            return Lack(lack.where, what, f"say --tip {tip} {hold}")
    return None


def _nearly(chain: Chain) -> list[Lack]:
    """Angles of joints on the way to the flange that are almost right angles, but too far off to be read as such."""
    found = []
    for joint in chain.tree.path(chain.base, chain.tip) or []:
        for angle in joint.rpy:
            near = round(angle / (math.pi / 2)) * (math.pi / 2)
            off = abs(angle - near)
            if ROUND_RAD < off <= NEARLY_RAD:
                what = f"{angle:.9g} rad is {math.degrees(off):.3g} deg off {math.degrees(near):.0f} deg"
                found.append(Lack(f"joint {joint.name}, origin.rpy", what, f"write {near!r} if that is meant"))
    return found
