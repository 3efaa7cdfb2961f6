"""An arm as a tree of links whose angles are sums of joint values: how a claim states it, whatever its family."""

from __future__ import annotations

from typing import NamedTuple

AHEAD, LEFT, UP = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
"""Axes of a link."""
Vector = tuple[float, float, float]


class Link(NamedTuple):
    """A link frame. Its origin is at `offset` (m, in the axes of the link number `parent`; -1: the world), moved by the
    joint of `slide` along an axis of the parent. Its yaw is the sum of the joints `turns`, counted from the yaw of the
    base, from the coupler number `coupler`, or (`fixed`) from the world's x axis. A link that tilts is then pitched by
    the sum of the joints `tilts` (up is positive) and rolled about its x axis by that of `rolls`; None: it stays
    upright."""

    name: str
    parent: int
    offset: Vector = (0.0, 0.0, 0.0)
    turns: tuple[int, ...] = ()
    tilts: tuple[int, ...] | None = None
    rolls: tuple[int, ...] = ()
    slide: tuple[int, Vector] | None = None
    coupler: int = -1
    fixed: bool = False


class Loop(NamedTuple):
    """Two couplers that close a chain. They begin at the ends of both `cranks` (numbers of links, of these `lengths`,
    m) and meet at their own lengths `couplers`, m, on the side `side` of the line from the first end to the second (1:
    to the left, seen from above). The sine of the angle between them is `least` at least."""

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


class Chain(NamedTuple):
    """All links of an arm, each behind its parent and behind the cranks of its coupler; and its loop, if it has one.

    The singularity margin is the least size of the `bends`; `signs` are theirs in each working mode, in their order.
    """

    links: tuple[Link, ...]
    bends: tuple[Bend, ...]
    signs: tuple[tuple[int, ...], ...]
    loop: Loop | None = None
