"""An arm as a tree of links whose angles are sums of joint values, and as rows of numbers, whatever its family."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.claim import columns as c
from assur.planner.errors import FaultError

AHEAD, LEFT, UP = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
"""Axes of a link."""
Vector = tuple[float, float, float]


class Link(NamedTuple):
    """A link frame. Its origin is at `offset` (m, in the axes of the link number `parent`; -1: the world), moved by the
    joint of `slide` along an axis of the parent. Its yaw is the sum of the joints `turns`, counted from the yaw of the
    base, from the coupler number `coupler`, or (`fixed`) from the world's x axis. A link that tilts is then pitched by
    the sum of the joints `tilts` (up is positive) and rolled about its x axis by that of `rolls`; None: it stays
    upright."""

    parent: int
    offset: Vector = (0.0, 0.0, 0.0)
    turns: tuple[int, ...] = ()
    tilts: tuple[int, ...] | None = None
    rolls: tuple[int, ...] = ()
    slide: tuple[int, Vector] | None = None
    coupler: int = -1
    fixed: bool = False


class Loop(NamedTuple):
    """Two couplers that close a chain. Both cranks turn about axes that the base has. The couplers begin at the ends of
    both `cranks` (numbers of links, of these `lengths`, m) and meet at their own lengths `couplers`, m, on the side
    `side` of the line from the first end to the second (1: to the left, seen from above). The sine of the angle between
    them is `least` at least."""

    cranks: tuple[int, int]
    lengths: tuple[float, float]
    couplers: tuple[float, float]
    side: float
    least: float


class Bend(NamedTuple):
    """A number that is 0 in a singular position and whose sign tells working modes apart: the x axis of link number
    `link` (or, for a `length` that is not 0, m, the way to its origin from that of link `other`, divided by the length)
    times the axis `along` of link `other`."""

    link: int
    other: int
    along: Vector
    length: float = 0.0


NO_SLIDE = (-1.0, 0.0, 0.0, 0.0)


class Rows(NamedTuple):
    """A chain as rows of the tables `links`, `angles` and `loops` of a claim, numbered from 0. `apart` (2,): from the
    axis of the loop's first crank to that of its second one, m, horizontally in the world."""

    links: FloatArray
    angles: FloatArray
    loops: FloatArray
    apart: FloatArray


class Chain(NamedTuple):
    """All links of an arm, each behind its parent and behind the cranks of its coupler; and its loop, if it has one.

    The singularity margin is the least size of the `bends`; `signs` are theirs in each working mode, in their order.
    """

    links: tuple[Link, ...]
    bends: tuple[Bend, ...]
    signs: tuple[tuple[int, ...], ...]
    loop: Loop | None = None

    def rows(self, yaw: float) -> Rows:
        """The rows of an arm with this yaw of its base, and `c.MOST_JOINTS` joints at most. Raises `FaultError` for a
        loop whose cranks turn about axes of another link than the base."""
        links, loops, apart = list[tuple[float, ...]](), list[tuple[float, ...]](), np.zeros(2)
        known = dict[tuple[float, ...], int]()

        def angle(constant: float, joints: tuple[int, ...]) -> int:
            key = (constant, *(float(joint in joints) for joint in range(c.MOST_JOINTS)))
            return known.setdefault(key, len(known))

        for link in self.links:
            counted = angle(0.0 if link.fixed or link.coupler >= 0 else yaw, link.turns)
            tilts = (-1, -1) if link.tilts is None else (angle(0.0, link.tilts), angle(0.0, link.rolls))
            slide = NO_SLIDE if link.slide is None else (link.slide[0], *link.slide[1])
            links.append((link.parent, *link.offset, *slide, counted, *tilts, link.coupler))
        made = np.array(links)
        if self.loop is not None:
            one, other = (self.links[crank] for crank in self.loop.cranks)
            if not one.parent == other.parent == 0:
                raise FaultError(f"a loop whose cranks turn on links {one.parent} and {other.parent}")
            x, y = (b - a for a, b in zip(one.offset[:2], other.offset[:2], strict=True))
            apart = np.array([math.cos(yaw) * x - math.sin(yaw) * y, math.sin(yaw) * x + math.cos(yaw) * y])
            between = known_between(known, [int(made[crank, c.LINK_YAW]) for crank in self.loop.cranks], 0)
            loops.append((*(x for part in self.loop[:3] for x in part), *self.loop[3:], between))
        return Rows(c.table("links", links), c.table("angles", list(known)), c.table("loops", loops), apart)


def known_between(known: dict[tuple[float, ...], int], yaws: list[int], start: int) -> int:
    """The row of the angle between two cranks whose yaws are these rows, added to the angles `known` of an arm, which
    begin at row `start`."""
    angles = list(known)
    one, other = (angles[yaw - start] for yaw in yaws)
    return known.setdefault(tuple(b - a for a, b in zip(one, other, strict=True)), start + len(known))
