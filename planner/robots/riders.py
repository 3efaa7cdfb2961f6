"""What every arm checks of what it is made of: joint names, bodies on its links, pairs of links."""

from __future__ import annotations

from assur.planner.errors import InputError
from assur.planner.geometry.shapes import LARGEST_M, SMALLEST_M
from assur.planner.robots.facts import Joint, Limits, RobotBody
from assur.planner.robots.planar import upright


def joints_of(names: tuple[str, ...], kinds: tuple[str, ...], limits: Limits) -> tuple[Joint, ...]:
    """The joints. Raises `InputError` unless the names are different and, as the limits, as many as the kinds."""
    count = len(kinds)
    if not (len(names) == len(set(names)) == count):
        raise InputError("robot.joint_names", names, f"{count} different names")
    if len(limits.lower) != count:
        raise InputError("robot.limits", len(limits.lower), f"{count} joints")
    return tuple(Joint(*pair) for pair in zip(names, kinds, strict=True))


def check_riders(links: tuple[str, ...], bodies: tuple[RobotBody, ...], pairs: tuple[tuple[str, str], ...]) -> None:
    """Raises `InputError` for a body on a link, or a pair of links, that the arm has not, and for a body on the link
    `quill`, which is never turned, that would look different if it were."""
    for body in bodies:
        if body.link not in range(len(links)):
            raise InputError(f"robot.bodies {body.body.name}", body.link, f"a link number below {len(links)}")
        if links[body.link] == "quill" and not all(upright(piece) for piece in body.body.pieces):
            raise InputError(f"robot.bodies {body.body.name}", "quill", "solids of revolution about the quill")
    for pair in pairs:
        if not set(pair) <= set(links):
            raise InputError("robot.self_pairs", pair, f"pairs out of {links}")


def check_lengths(**lengths: float) -> None:
    """Raises `InputError` for a link that is not from 10 µm to 50 m long, naming it."""
    for name, length in lengths.items():
        if not SMALLEST_M <= length <= LARGEST_M:
            raise InputError(name, length, f"a length from {SMALLEST_M} to {LARGEST_M} m")
