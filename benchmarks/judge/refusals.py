"""Whether a refusal that claims a proof is wrong, as far as can be shown.

A proof states that no plan exists. A counterexample contradicts it: joints with which the tool is at the point, an open
interval of the window that is long enough, bodies that are far enough apart, a load that may be carried.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import product

import numpy as np

from benchmarks.judge.arms import Arm, robot_file
from benchmarks.judge.cell import Cell
from benchmarks.judge.faults import Violation
from benchmarks.judge.inverse import TURNS
from benchmarks.judge.poses import Document, Floats, Poses
from benchmarks.judge.solids import Gap
from benchmarks.judge.stages import CONTACT_M, clearance
from benchmarks.judge.when_met import Point, Reach

MISSING = 9e-7
"""A point is met where no more than this is missing, m or rad: the checker lets the tool be a micrometre, or a
microradian, from its point (MEET_M, MEET_RAD), so a plan that ends so near is a plan."""
APART_M = 2e-6
"""Bodies are far enough apart if their distance is larger than required by this: the error of a distance of `coal`."""
OPEN_S = 1e-6
"""A window is open long enough if it is open for this longer than required."""
YAW_RAD, LOAD = 2e-9, 1e-12
"""A yaw is outside a range if it is outside by this, which is more than the checker's own rounding (1e-9 rad); sums of
masses round, too."""
START = 1e-9
"""A start is beyond a range if it is by more than this."""


def contradiction(request: Document, answer: Document) -> list[Violation] | None:
    """What contradicts a proved refusal of a request in SI: nothing, if it is right; None if this reason is not one
    that can be judged."""
    refusal = answer["refusal"]
    judge = JUDGES.get(refusal["reason"])
    return None if judge is None else judge(Reach(Cell.of(request)), refusal)


def _reached(reach: Reach, refusal: Document) -> list[Violation] | None:
    """Of a point out of reach, beyond a range or singular."""
    if refusal["stage"] == "start":
        q, arm = reach.start_joints()[0], reach.arm
        over = float(np.maximum(arm.lower - q, q - arm.upper).max())
        return [] if over > START else [_wrong(refusal, over, "the start is within all ranges")]
    ((_, given),) = reach.request["task"][refusal["step"]].items()
    if "arch" in given and (refusal["facts"].get("arch_top_m") is not None):
        return _arch(reach, refusal, float(given["arch"]["top_m"]))
    point = reach.point(refusal["step"])
    if point is None:
        return None
    missing, when, mode = reach.best(point, refusal["step"])
    if missing > MISSING:
        return []
    return [_wrong(refusal, missing, f"met in mode {mode} at {when:.6f} s")]


def _arch(reach: Reach, refusal: Document, top: float) -> list[Violation]:
    """Of an arch above the range of the lift: how high the tool point comes with the lift at its ends."""
    lift = int(np.argmin(reach.arm.upper - reach.arm.lower))
    q = np.repeat(reach.start_joints(), 2, axis=0)
    q[:, lift] = reach.arm.lower[lift], reach.arm.upper[lift]
    missing = top - float(reach.arm.tool(q).p[:, 2].max())
    return [] if missing > MISSING else [_wrong(refusal, missing, "the lift goes so high")]


def _opens(reach: Reach, refusal: Document) -> list[Violation] | None:
    """Of a window that is missed, or a law that ends: the longest opening."""
    facts = refusal["facts"]
    if refusal["stage"] == "start":
        used = any(frame == refusal["frame"] for frame, _ in reach.cell.seats.values())
        valid = reach.request["frames"][refusal["frame"]].get("valid_s", [-np.inf, np.inf])
        known = valid[0] <= reach.cell.start_s <= valid[1]
        return [_wrong(refusal, 0.0, "the frame bears nothing, or is known")] if known or not used else []
    point = reach.point(refusal["step"])
    if point is None or facts.get("on_arrival"):
        return None
    spans = reach.open(point, refusal["step"])
    longest = max((t1 - t0 for t0, t1 in spans), default=-np.inf)
    if not longest > point.dwell + OPEN_S:
        return []
    return [_wrong(refusal, longest, f"open long enough: {spans[:3]}")]


def _yaw(reach: Reach, refusal: Document) -> list[Violation] | None:
    """Of a forbidden yaw, at the start or of a point in a frame that does not turn."""
    if refusal["facts"].get("on_the_way"):
        return _way_round(reach, refusal)
    if refusal["stage"] == "start":
        yaws = reach.arm.tool(reach.start_joints()).yaw.tolist()
    else:
        point = reach.point(refusal["step"])
        if point is None or point.yaws is None:
            return None
        there = reach.frames[point.frame].at(np.array(reach.cell.start_s)).then(point.pose)
        yaws = [float(there.yaw) + turn for turn in point.yaws]
    ranges = reach.request["robot"]["limits"]["forbidden_yaw_rad"]
    for yaw in yaws:
        inside = max(_inside(yaw, first, last) for first, last in ranges)
        if inside < -YAW_RAD:
            return [_wrong(refusal, inside, f"a yaw of {yaw:.9f} rad is in no range")]
    return []


def _way_round(reach: Reach, refusal: Document) -> list[Violation] | None:
    """Of ranges between the yaw of the start and those of a point: the turns of all joints in which there is none."""
    point = reach.point(refusal["step"])
    arm, start = reach.arm, reach.start_joints()
    if point is None or point.yaws is None or arm.tilts or reach.frames[point.frame].moves:
        return None
    low, high, begin = -np.inf, np.inf, float(_total(arm, start)[0])
    for first, last in reach.request["robot"]["limits"]["forbidden_yaw_rad"]:
        width = (last - first) % (2.0 * np.pi)
        after = begin - (begin - first) % (2.0 * np.pi) + width
        low, high = max(low, after), min(high, after - width + 2.0 * np.pi)
    for tool in reach.tools(point, np.array([reach.cell.start_s])):
        for each in reach.postures(point, tool):
            for turn in TURNS if reach.allowed(each.mode) and each.missing[0] <= MISSING else ():
                q = each.q.copy()
                q[0, arm.order[3]] += turn
                within = bool((q >= arm.lower).all() and (q <= arm.upper).all())
                yaw = float(_total(arm, q)[0])
                if within and low + YAW_RAD < yaw < high - YAW_RAD:
                    return [_wrong(refusal, yaw, f"no range from {begin:.6f} to {yaw:.6f} rad in mode {each.mode}")]
    return []


def _total(arm: Arm, q: Floats) -> Floats:
    """The yaw of a SCARA's tool as a number of turns."""
    ours = (q * arm.signs)[:, list(arm.order)]
    return np.asarray(ours[:, 0] + ours[:, 1] + ours[:, 3] + float(arm.base.yaw + arm.tcp.yaw))


def _inside(yaw: float, first: float, last: float) -> float:
    """How far a yaw is inside a range, rad; less than 0: outside."""
    middle, half = (first + last) / 2.0, ((last - first) % (2.0 * np.pi)) / 2.0
    return half - abs((yaw - middle + np.pi) % (2.0 * np.pi) - np.pi)


def _load(reach: Reach, refusal: Document) -> list[Violation] | None:
    """Of a load that is too heavy: tool and part together."""
    if refusal["facts"]["of"] == "max_inertia":
        return None
    given = next(iter(robot_file(reach.request["robot"]["model"]).values()))
    most = float(given["max_load_kg"]["value"]) if "max_load_kg" in given else np.inf
    rows = reach.request["robot"].get("limits", {}).get("acceleration_by_load")
    most = min(most, rows[-1]["mass_kg"]) if rows else most
    masses = {body["name"]: body.get("mass_kg", 0.0) for body in reach.request.get("bodies", [])}
    tool = float(reach.request["robot"]["tool"].get("mass_kg", 0.0))
    mass = tool + float(masses.get(refusal["facts"]["part"], 0.0))
    return [] if mass > most * (1.0 + LOAD) else [_wrong(refusal, mass, f"no more than {most} kg")]


def _wrong(refusal: Document, amount: float, about: str) -> Violation:
    stated = refusal["amount"]
    return Violation("proof", f"{refusal['reason']}: {about}", amount, np.nan if stated is None else float(stated))


# collisions


def _hits(reach: Reach, refusal: Document) -> list[Violation] | None:
    """Of a collision at the start, or at a fixed control point: whether all bodies can be far enough apart."""
    bodies = Bodies(reach)
    if refusal["stage"] == "start":
        one, other = refusal["bodies"]
        links = reach.arm.links(reach.start_joints())
        gap = bodies.gap(one, other, links, {})
        if bodies.meshes(one, other):
            return None
        over = gap - clearance(reach.request, False, one, other)
        return [] if over < APART_M else [_wrong(refusal, gap, f"{one} and {other} are far enough apart")]
    number = refusal["step"]
    point = reach.point(number)
    if any("pick" in step for step in reach.request["task"][:number]):
        return None  # in which turn the part is held is not known
    if point is None or reach.frames[point.frame].moves:
        return None
    t = np.array([reach.cell.start_s])
    for tool in _every_yaw(reach, point, t):
        for mode in dict.fromkeys(each.mode for each in reach.postures(point, tool)):
            if all(bodies.clear(point, number, tool, mode, *where) for where in bodies.places(number)):
                return [_wrong(refusal, 0.0, f"nothing is too near in mode {mode}, yaw {float(tool.yaw[0]):.4f} rad")]
    return []


def _every_yaw(reach: Reach, point: Point, t: Floats) -> list[Poses]:
    """Where the tool may be at the point, also where its yaw is free."""
    if point.yaws is not None or len(reach.arm.names) < 4:
        return reach.tools(point, t)
    there = reach.frames[point.frame].at(t).then(point.pose)
    return [there.moved(0.0, yaw) for yaw in np.linspace(0.0, 2.0 * np.pi, 72, endpoint=False)]


class Bodies:
    """The bodies of a request, where they stand, and those of its arm."""

    def __init__(self, reach: Reach) -> None:
        self.reach, self.cell, self.shapes = reach, reach.cell, reach.cell.shapes

    def meshes(self, one: str, other: str) -> bool:
        return self.shapes[one].mesh or self.shapes[other].mesh

    def gap(self, one: str, other: str, links: dict[str, Poses], held: dict[str, Poses]) -> float:
        """Of two bodies at the start's time, m; `links`: of one posture (1,); `held`: the part in the flange."""
        places = [self._at(name, links, held) for name in (one, other)]
        return Gap(self.shapes[one], self.shapes[other]).at(places[0][0], places[1][0])

    def _at(self, name: str, links: dict[str, Poses], held: dict[str, Poses]) -> Poses:
        if name in held:
            return links["flange"].then(held[name])
        if name in self.cell.carried:
            return links[self.cell.carried[name].link].then(self.cell.carried[name].pose)
        frame, pose = self.cell.seats[name]
        return self.cell.frames[frame].at(np.array([self.cell.start_s])).then(pose)

    def places(self, number: int) -> list[tuple[float, bool, str, bool]]:
        """What the arm must go through at a step: height above the point, whether the distances of `near` are required,
        which contacts are allowed (`grip`, `rest` or none), and whether the part is held."""
        ((kind, given),) = self.cell.request["task"][number].items()
        if kind == "move":
            return [(0.0, False, "", False)]
        if kind == "follow":
            return [(0.0, True, "", False)]
        _, up, off = self.reach.heights(given)
        found = [(0.0, True, "grip", False), (0.0, True, "rest", True), (up, False, "", False)]
        return [*found, (off, False, "", True)] if number + 1 < len(self.cell.request["task"]) else found

    def clear(
        self, point: Point, number: int, tool: Poses, mode: str, height: float, near: bool, touch: str, holds: bool
    ) -> bool:
        """Whether the robot is clear of all fixed bodies with the tool there, so much higher, in this mode."""
        cell, held = self.cell, dict[str, Poses]()
        (posture,) = (each for each in self.reach.postures(point, tool, height) if each.mode == mode)
        ((_, given),) = cell.request["task"][number].items()
        part, links, to_flange = given.get("part"), cell.arm.links(posture.q), cell.arm.tcp.inverse()
        # the wrist has the yaw that is tried, in whatever turn that is
        links["flange"] = tool.moved((0.0, 0.0, height)).then(to_flange)
        if not all(np.isfinite(each.p).all() for each in links.values()):
            return False
        if holds and part is not None:
            held = {part: tool.then(to_flange).inverse().then(self._at(part, links, {}))}
        rest = given.get("contact_with", [])
        for one, other in product((*cell.carried, *held), cell.seats):
            if other in held or cell.frames[cell.seats[other][0]].moves:
                continue
            required = clearance(cell.request, near, one, other)
            gripped = touch == "grip" and one in cell.tool_bodies and other == part
            if gripped or (touch == "rest" and one == part and other in rest):
                required = -CONTACT_M - float(given.get("contact_tolerance_m", 0.0))
            if self.gap(one, other, links, held) < required + APART_M:
                return False
        return True


JUDGES: dict[str, Callable[[Reach, Document], list[Violation] | None]] = {
    "OUT_OF_REACH": _reached,
    "JOINT_LIMIT": _reached,
    "NEAR_SINGULARITY": _reached,
    "NEAR_PARALLEL_SINGULARITY": _reached,
    "WINDOW_MISSED": _opens,
    "LAW_ENDS": _opens,
    "FORBIDDEN_YAW": _yaw,
    "LOAD_LIMIT": _load,
    "START_IN_COLLISION": _hits,
    "CONTROL_POINT_IN_COLLISION": _hits,
}
