"""The arm in a tree: the moving joints from the base to the flange, with everything that is fixed folded into them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from assur.planner.arrays import FloatArray
from assur.scenes.urdf.refusals import Defect
from assur.scenes.urdf.tree import Joint, Tree

UNIT = 1e-6
"""How far the length of an axis may be from 1 without a remark."""


@dataclass(frozen=True, eq=False)
class Axis:
    """A joint axis in the frame of the base, all joints being at 0: whether it turns, a point of it (3,) in m, and its
    direction (3,)."""

    turns: bool
    point: FloatArray
    direction: FloatArray


@dataclass(frozen=True, eq=False)
class Chain:
    """The moving `joints` between the links `base` and `tip` of a tree, from the base on."""

    tree: Tree
    base: str
    tip: str
    joints: tuple[Joint, ...]

    def places(self, q: FloatArray) -> dict[str, FloatArray]:
        """The pose (..., 4, 4) of every link that hangs on the base or stands still with it, in the base's frame, for
        positions (..., n) of the moving joints in the file's count."""
        still = {self.base: np.eye(4), **self.beside}
        found = {link: np.broadcast_to(pose, (*q.shape[:-1], 4, 4)) for link, pose in still.items()}
        for joint in self.tree.all_below(self.base):
            i = self._index.get(joint.name)
            at = q[..., i] if i is not None else np.zeros(q.shape[:-1])
            found[joint.child] = found[joint.parent] @ joint.motion(at)
        return found

    @cached_property
    def _index(self) -> dict[str, int]:
        """The number of each moving joint by its name."""
        return {joint.name: i for i, joint in enumerate(self.joints)}

    @cached_property
    def axes(self) -> tuple[Axis, ...]:
        """The axes of the moving joints, all at 0."""
        places = self.places(np.zeros(len(self.joints)))
        return tuple(
            Axis(joint.kind != "prismatic", places[joint.child][:3, 3], places[joint.child][:3, :3] @ joint.axis)
            for joint in self.joints
        )

    @cached_property
    def beside(self) -> dict[str, FloatArray]:
        """Links above the base and on other branches that fixed joints hold to it: their poses (4, 4) in its frame."""
        found: dict[str, FloatArray] = {self.base: np.eye(4)}
        ahead = [self.base]
        while ahead:
            link = ahead.pop()
            above = self.tree.above(link)
            near = [] if above is None else [(above.parent, above, np.linalg.inv(above.origin))]
            if link != self.base:  # links that are attached to the base itself do not count
                near += [(joint.child, joint, joint.origin) for joint in self.tree.below(link)]
            for other, joint, step in near:
                if joint.kind == "fixed" and other not in found:
                    found[other] = found[link] @ step
                    ahead.append(other)
        del found[self.base]
        return found

    @cached_property
    def movers(self) -> dict[str, frozenset[int]]:
        """Which of the moving joints each link moves with; links that neither hang on the base nor stand still with it
        are not there."""
        found: dict[str, frozenset[int]] = dict.fromkeys((self.base, *self.beside), frozenset())
        for joint in self.tree.all_below(self.base):
            own = {self._index[joint.name]} if joint.name in self._index else frozenset[int]()
            found[joint.child] = found[joint.parent] | own
        return found


def remarks_on(chain: Chain) -> list[str]:
    """Remarks on a chain: axes that are no unit vectors; links that belong to the base, are left out, or have no
    collision shape."""
    links, base = chain.tree.links, chain.base
    found = []
    if long := [f"{each.name} ({each.stretch:.6g})" for each in chain.joints if abs(each.stretch - 1.0) > UNIT]:
        found.append(
            f"axes that are not 1 long: {', '.join(long)}; only their directions are taken, so positions are in rad "
            "and m along them, and nothing is scaled"
        )
    if taken := [link for link in links if link in chain.beside and links[link]]:
        found.append(f"link {base} has the collision shapes of {', '.join(taken)}, which fixed joints hold to it")
    if lost := [link for link in links if link not in chain.movers and links[link]]:
        found.append(
            f"LEFT OUT with their collision shapes: {', '.join(lost)}; no fixed joint holds them to link {base}, and "
            "nothing is kept clear of them: give them as bodies of the request"
        )
    if unseen := [link for link in chain.tree.only_seen if link in chain.movers]:
        shown = ", ".join(unseen[:8])
        found.append(f"no collision shape, only a visual one: {shown}; nothing is kept clear of these links")
    if not any(links[link] for link in chain.movers):
        found.append("no link has a collision shape: NOTHING is kept clear of this arm; add bodies to it")
    return found


def flanges(tree: Tree, base: str, wanted: str | None, hinted: tuple[str, ...]) -> list[str]:
    """Links that may be the flange, the likeliest first: the one that is `wanted`; else those `hinted` at elsewhere,
    the only end of what is fixed to the last moving link, and this link itself."""
    if wanted is not None:
        return [wanted]
    last = _last_moving(tree, base)
    if last is None:
        return []
    group = [last]
    for joint in tree.all_below(last):
        if not joint.moves and joint.parent in group:
            group.append(joint.child)
    ends = [link for link in group if not tree.below(link)]
    likely = [link for link in hinted if link in group]
    return list(dict.fromkeys([*likely, *(ends if len(ends) == 1 else []), last]))


def _last_moving(tree: Tree, base: str) -> str | None:
    """The child of the moving joint behind which most others are; of several the first in the file."""
    best, most = None, 0
    for joint in tree.joints.values():
        path = tree.path(base, joint.child) if joint.moves else None
        count = 0 if path is None else sum(each.moves and each.mimics is None for each in path)
        if count > most:
            best, most = joint.child, count
    return best


def chain_to(tree: Tree, base: str, tip: str) -> tuple[Chain | None, list[Defect]]:
    """The arm from base to tip, and reasons why it is no arm: joints of other kinds, joints that follow others,
    and joints that move and are not in the arm."""
    path = tree.path(base, tip)
    if path is None:
        return None, [Defect(f"link {tip}", f"it does not hang on link {base}", "choose --base and --tip of one chain")]
    lacks = []
    own = {joint.name for joint in path}
    for joint in tree.joints.values():
        where = f"joint {joint.name}"
        if joint.name in own and joint.kind in ("floating", "planar"):
            lacks.append(Defect(where, f"type {joint.kind}", "begin below it with --base LINK"))
        if not joint.moves or tree.path(base, joint.child) is None:
            continue
        if joint.mimics is not None and (joint.name in own or joint.mimics in own):
            what = f"it mimics joint {joint.mimics}: a linkage, and none of our arms has one"
            supply = "only arms without a linkage can be imported; of a palletiser no SCARA can be made"
            lacks.append(Defect(where, what, supply))
        elif joint.mimics is not None:
            what = f"it mimics joint {joint.mimics}, and is not between link {base} and link {tip}"
            lacks.append(Defect(where, what, f"hold both with --hold {joint.mimics}=POSITION"))
        elif joint.name not in own:
            what = f"it moves, and is not between link {base} and link {tip}"
            lacks.append(Defect(where, what, f"hold it with --hold {joint.name}=POSITION, or choose --tip LINK"))
    return Chain(tree, base, tip, tuple(joint for joint in path if joint.moves)), lacks
