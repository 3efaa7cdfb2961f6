"""What must keep apart, and how far: attachments and contacts in each phase, and what the whole plan requires."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.claim import columns as c
from assur.planner.laws import EXACT
from assur.planner.model.attachments import Attachments, at_start
from assur.planner.model.clearance import contact_gap
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Scene


@dataclass(frozen=True, eq=False)
class Carriers:
    """Numbers of a claim by the names of a scene, and what is uncertain of bodies before any was gripped.

    `body`, `frame`: the rows of bodies and frames; `flange`: the row of the link that carries tool and part; `off`
    (2 B,): how far, m, each body may be off its seat in every horizontal direction, then up or down.
    """

    body: dict[str, int]
    frame: dict[str, int]
    flange: int
    off: FloatArray


def carriers_of(scene: Scene, names: Sequence[str]) -> Carriers:
    """Those of a cell with bodies of these names, in the order of a claim."""
    number, many = {name: k for k, name in enumerate(names)}, len(names)
    off = np.zeros(2 * many)
    for item in scene.bodies:
        if item.uncertainty != EXACT:
            k, within = number[item.name], item.uncertainty
            off[k], off[many + k] = within.position_m + within.yaw_rad * item.body.radius, within.vertical_m
    return Carriers(
        body=number,
        frame={name: k for k, name in enumerate(scene.frames)},
        flange=scene.robot.links.index("flange"),
        off=off,
    )


@dataclass(frozen=True, eq=False)
class Seats:
    """The seats of all bodies at the start (B, c.SEAT), and the rows of the bodies that a plan may move, by name."""

    rows: FloatArray
    moved: tuple[tuple[str, int], ...]


def seats_of(scene: Scene, carriers: Carriers) -> Seats:
    """Where each body is when the plan begins."""
    robot, attached = scene.robot, at_start(scene)
    links = [item.link for item in robot.bodies] + [carriers.flange] * len(scene.tool.bodies)
    rows: list[tuple[float, ...]] = [(k, link, -1, 0.0, 0.0, 0.0, 0.0) for k, link in enumerate(links)]
    rows += [seat_of(scene, carriers, attached, item.name) for item in scene.bodies]
    parts = {step.part for step in scene.task if step.part is not None}
    if attached.held is not None:
        parts.add(attached.held.part)
    moved = sorted((carriers.body[part], part) for part in parts)
    return Seats(c.table("seats", rows), tuple((part, k) for k, part in moved))


def seat_of(scene: Scene, carriers: Carriers, attached: Attachments, name: str) -> tuple[float, ...]:
    """The seat of a body around the robot, or in its gripper."""
    if attached.held is not None and attached.held.part == name:
        link, frame, pose = carriers.flange, -1, attached.held.in_flange
    else:
        on, pose = attached.pose_of(scene, name)
        link, frame = -1, carriers.frame[on]
    return carriers.body[name], link, frame, pose.x, pose.y, pose.z, pose.yaw


def phases_of(scene: Scene, carriers: Carriers, seats: Seats, phases: Sequence[Phase]) -> dict[str, FloatArray]:
    """Phases, seats, what is uncertain of bodies and frames, contacts that are allowed, and parts that were put
    down."""
    many, number = len(carriers.body), carriers.body
    seated, off = np.empty((len(phases), many)), np.empty((len(phases), 2 * many))
    seated[:], off[:] = np.arange(many), carriers.off
    contacts, put_down, supports = list[tuple[float, ...]](), list[tuple[float, ...]](), list[FloatArray]()
    rows = {tuple(seats.rows[k].tolist()): k for _, k in seats.moved}
    begin, attached = len(seats.rows) - len(rows), at_start(scene)
    now = [k for _, k in seats.moved]
    for p, phase in enumerate(phases):
        if phase.attached is not attached:
            attached, now = phase.attached, []
            for name, _ in seats.moved:
                now.append(rows.setdefault(seat_of(scene, carriers, attached, name), begin + len(rows)))
        for (_, k), row in zip(seats.moved, now, strict=True):
            seated[p, k] = row
        for name, within in phase.handled.within:
            k = number[name]
            off[p, k] = within.position_m + within.yaw_rad * scene.index[name].body.radius
            off[p, many + k] = within.vertical_m
            if name != attached.part:
                put_down.append((p, k))
                others = [number[x] for pair in phase.handled.supports if name in pair for x in pair if x != name]
                supports.append(_chosen(others, many))
        for one, other in sorted(phase.contacts):
            if one in number and other in number:
                contacts.append((p, *sorted((number[one], number[other])), -contact_gap(phase)))
    added = list(rows)[len(seats.moved) :]
    return {
        "phases": np.array([(phase.t0, phase.t1, phase.near, phase.robot) for phase in phases], dtype=float),
        "seats": np.concatenate((seats.rows, added)) if added else seats.rows,
        "seated": seated,
        "off": off,
        "shares": shares_of(scene, phases),
        "contacts": c.table("contacts", contacts),
        "put_down": c.table("put_down", put_down),
        "supports": np.array(supports, dtype=float).reshape(len(supports), many),
    }


def shares_of(scene: Scene, phases: Sequence[Phase]) -> FloatArray:
    """The share (phases, 2 F) that the tool has in the displacement of each frame along its line: at least, at most."""
    many, number = len(scene.frames), {name: k for k, name in enumerate(scene.frames)}
    found = np.zeros((len(phases), 2 * many))
    for p, phase in enumerate(phases if scene.execution.belt_correction else ()):
        shares = dict.fromkeys(phase.corrected, (0.0, 1.0))
        if phase.tracked is not None:
            always = 1.0 if scene.corrects_all(phase.tracked) else 0.0
            shares = {phase.tracked: (always, 1.0)} if scene.corrects(phase.tracked) else {}
        for name, (least, most) in shares.items():
            found[p, number[name]], found[p, many + number[name]] = least, most
    return found


def _chosen(numbers: Sequence[int], count: int) -> FloatArray:
    """1 for each of `count` things that is chosen."""
    row = np.zeros(count)
    row[list(numbers)] = 1.0
    return row


def distances_of(scene: Scene, carriers: Carriers) -> dict[str, FloatArray]:
    """Pairs of links that must keep apart, required distances of some pairs, and what is required of the whole plan
    but for its end."""
    robot, required, lag = scene.robot, scene.options.clearance, scene.execution.lag
    pairs = np.zeros((len(robot.links), len(robot.links)))
    for pair in robot.self_pairs:
        i, k = map(robot.links.index, pair)
        pairs[i, k] = pairs[k, i] = 1.0
    names, rules = list(carriers.body), list[FloatArray]()
    for rule in required.exceptions:
        # a side without names is every body
        sides = [[float(not side or name in side) for name in names] for side in (rule.first, rule.second)]
        if all(map(any, sides)):
            rules.append(np.array([rule.travel_m, rule.near_m, *sides[0], *sides[1]]))
    row = np.zeros((1, c.REQUIRED))
    row[0, : c.REQUIRED_UNTIL] = required.travel_m, required.near_m
    row[0, c.REQUIRED_LATE], row[0, c.REQUIRED_SINCE] = scene.execution.start_tolerance_s, scene.start.time
    row[0, c.REQUIRED_TOOL] = robot.links.index("quill" if "quill" in robot.links else "flange")
    row[0, c.REQUIRED_LAG : c.REQUIRED_LAG + len(lag)] = lag
    row[0, c.REQUIRED_NEAREST :] = -1.0
    return {
        "rules": np.array(rules).reshape(-1, c.RULE_SIDE + 2 * len(names)),
        "self_pairs": pairs,
        "required": row,
    }
