"""Which link of ours carries what a link of the file carries.

A link of the file moves with some of the joints. If a link of ours moves with the same ones, it carries its solids as
they are. If one differs by a single joint that turns about the vertical (the carriage between a lift and a wrist, a
column that turns below a lift), it carries solids of revolution about that joint's axis, which contain them at every
angle of the joint.
"""

from __future__ import annotations

from dataclasses import dataclass

from assur.scenes.schema.robots import Family
from assur.scenes.urdf.families import Kinematics


@dataclass(frozen=True, slots=True)
class Carrier:
    """A link of ours by `name`; `about`: the number of the file's joint about whose axis solids are revolved, if they
    are."""

    name: str
    about: int | None = None


def frames_of(family: Family, order: str, count: int) -> dict[str, frozenset[int]]:
    """Which joints, in the file's order, each link of ours moves with."""
    if family == "scara":
        lift = order.index("p") if count == 4 else min(order.index("p"), 2)
        first, second, *wrist = [i for i in range(count) if i != lift]
        arms = {lift} if order in ("rprr", "prrr") else set()
        both = {first, second}
        return {
            "base": frozenset(),
            "link1": frozenset({first} | arms),
            "link2": frozenset(both | arms),
            "flange": frozenset(both | {lift, *wrist}),
        }
    names = ("base", "link1", "link2", "link3", "link4", "flange")[: count + 1]
    return {name: frozenset(range(i)) for i, name in enumerate(names)}


def carrier_of(movers: frozenset[int], kinematics: Kinematics, count: int) -> Carrier | None:
    """The carrier of a link that moves with some joints; None if there is none."""
    frames = frames_of(kinematics.family, kinematics.order, count)
    for name, own in frames.items():
        if own == movers:
            return Carrier(name)
    if kinematics.family != "scara":
        return None
    lift = kinematics.order.index("p")
    if movers == frames["flange"] - {count - 1 if lift != 3 else count - 2} and count == 4 and lift in movers:
        return Carrier("quill", count - 1 if lift != 3 else count - 2)
    for name, own in frames.items():
        more = movers ^ own
        if len(more) == 1 and lift not in more:
            return Carrier(name, next(iter(more)))
    return None


JOINED: dict[Family, tuple[tuple[str, str], ...]] = {
    "scara": (("base", "link1"), ("link1", "link2"), ("link2", "quill"), ("quill", "flange")),
    "elbow_arm": (("base", "link1"), ("link1", "link2"), ("link2", "link3"), ("link3", "flange"), ("base", "link2")),
    "five_axis_arm": (
        ("base", "link1"),
        ("base", "link2"),
        ("link1", "link2"),
        ("link2", "link3"),
        ("link3", "link4"),
        ("link4", "flange"),
    ),
}
"""Pairs of our links that overlap by construction, as in the shipped arms."""


def self_pairs(
    family: Family, carried: dict[str, set[str]], off: frozenset[frozenset[str]] | None, names: tuple[str, ...]
) -> list[tuple[str, str]]:
    """Pairs of our links that can meet. `carried`: the file's links on each of ours; `off`: pairs of the file's links
    that an SRDF disables, None without one; `names`: our links in order.

    The flange carries tool and part as well, which an SRDF does not know: its pairs stay. Another pair is left out
    if all pairs of the file's links on it are disabled, or, without an SRDF, if the links are joined.
    """
    found = []
    joined = {frozenset(pair) for pair in JOINED[family]}
    for i, one in enumerate(names):
        for other in names[i + 1 :]:
            pair = frozenset((one, other))
            if one == "quill" or (other == "flange" and pair in joined):
                continue
            both = carried.get(one, set()), carried.get(other, set())
            if other == "flange" or off is None or not (both[0] and both[1]):
                if pair not in joined:
                    found.append((one, other))
                continue
            if any(frozenset((a, b)) not in off for a in both[0] for b in both[1]):
                found.append((one, other))
    return found
