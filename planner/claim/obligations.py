"""What must keep apart, and how far: attachments and contacts in each phase, and what the whole plan requires."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import count
from operator import itemgetter

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.claim import columns as c
from assur.planner.claim.frames import EMPTY, table_of
from assur.planner.geometry.shapes import Body, Pieces, pieces
from assur.planner.model.attachments import Attachments, at_start
from assur.planner.model.kept import KeptCell
from assur.planner.model.phases import Phase, contact_gap
from assur.planner.model.scene import Scene, bodies_in


@dataclass(frozen=True, eq=False)
class Carriers:
    """Numbers of a claim by the names of a scene, and what is uncertain of bodies before any was gripped.

    `body`, `frame`: the rows of bodies and frames; `flange`: the row of the link that carries tool and part; `seats`
    (B, c.SEAT): those of all bodies; `off` (2 B,): how far, m, each body may be off its seat in every horizontal
    direction, then up or down.
    """

    body: dict[str, int]
    frame: dict[str, int]
    flange: int
    seats: FloatArray
    off: FloatArray


def carriers_of(scene: Scene) -> Carriers:
    """Those of the cell of a scene, with which they are kept."""
    return scene.kept.of(_carriers, scene)


def _carriers(scene: Scene) -> Carriers:
    names, flange = [body.name for body in bodies_in(scene)], scene.robot.links.index("flange")
    body, frame = dict(zip(names, count(), strict=False)), dict(zip(scene.frames, count(), strict=False))
    many, off = len(names), np.zeros(2 * len(names))
    links = [item.link for item in scene.robot.bodies] + [flange] * len(scene.tool.bodies)
    seats: list[tuple[float, ...]] = [(k, link, -1, 0.0, 0.0, 0.0, 0.0) for k, link in enumerate(links)]
    for k, item in enumerate(scene.bodies, start=len(links)):
        pose, within = item.pose, item.uncertainty
        seats.append((k, -1, frame[item.frame], pose.x, pose.y, pose.z, pose.yaw))
        if within.position_m or within.vertical_m or within.yaw_rad:
            off[k], off[many + k] = within.position_m + within.yaw_rad * item.body.radius, within.vertical_m
    return Carriers(body, frame, flange, c.table("seats", seats), off)


@dataclass(frozen=True, eq=False)
class Seats:
    """The seats of all bodies at the start (B, c.SEAT), and the rows of the bodies that a plan may move, by name."""

    rows: FloatArray
    moved: tuple[tuple[str, int], ...]


def seats_of(scene: Scene, carriers: Carriers) -> Seats:
    """Where each body is when the plan begins."""
    attached, rows, parts = at_start(scene), carriers.seats, {step.part for step in scene.task if step.part is not None}
    if attached.held is not None:
        name, rows = attached.held.part, rows.copy()
        rows[carriers.body[name]] = seat_of(scene, carriers, attached, name)
        parts.add(name)
    return Seats(rows, tuple(sorted([(name, carriers.body[name]) for name in parts], key=itemgetter(1))))


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
                others = [number[below] for part, below in phase.handled.supports if part == name]
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
        "contacts": table_of("contacts", contacts),
        "put_down": table_of("put_down", put_down),
        "supports": np.array(supports) if supports else np.empty((0, many)),
    }


def shares_of(scene: Scene, phases: Sequence[Phase]) -> FloatArray:
    """The share (phases, 2 F) that the tool has in the displacement of each frame along its line: at least, at most."""
    many = len(scene.frames)
    found = np.zeros((len(phases), 2 * many))
    if not scene.execution.belt_correction:
        return found
    number = {name: k for k, name in enumerate(scene.frames)}
    for p, phase in enumerate(phases):
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


def distances_of(scene: Scene) -> dict[str, FloatArray]:
    """Pairs of links that must keep apart, required distances of some pairs, and what is required of the whole plan
    but for its begin and end. They are kept with the cell."""
    return scene.kept.of(_distances, scene, scene.options.clearance, scene.execution)


def _distances(scene: Scene) -> dict[str, FloatArray]:
    robot, required, lag = scene.robot, scene.options.clearance, scene.execution.lag
    pairs = np.zeros((len(robot.links), len(robot.links)))
    for pair in robot.self_pairs:
        i, k = map(robot.links.index, pair)
        pairs[i, k] = pairs[k, i] = 1.0
    names, rules = list(carriers_of(scene).body), list[FloatArray]()
    for rule in required.exceptions:
        # a side without names is every body
        sides = [[float(not side or name in side) for name in names] for side in (rule.first, rule.second)]
        if all(map(any, sides)):
            rules.append(np.array([rule.travel_m, rule.near_m, *sides[0], *sides[1]]))
    row = np.zeros((1, c.REQUIRED))
    row[0, : c.REQUIRED_UNTIL] = required.travel_m, required.near_m
    row[0, c.REQUIRED_LATE] = scene.execution.start_tolerance_s
    row[0, c.REQUIRED_TOOL] = robot.links.index("quill" if "quill" in robot.links else "flange")
    row[0, c.REQUIRED_LAG : c.REQUIRED_LAG + len(lag)] = lag
    row[0, c.REQUIRED_NEAREST :] = -1.0
    return {
        "rules": np.array(rules).reshape(-1, c.RULE_SIDE + 2 * len(names)),
        "self_pairs": pairs,
        "required": row,
    }


# Bodies as convex pieces, in their own axes; and the surfaces of those that are meshes.


def solids_in(scene: Scene) -> dict[str, FloatArray]:
    """Those of the bodies of a scene (`solids_of`), kept with its cell."""
    return scene.kept.of_solids(_solids, scene)


def _solids(scene: Scene | KeptCell) -> dict[str, FloatArray]:
    before, bodies = scene.kept.before, bodies_in(scene)
    if before is None:
        return solids_of(bodies, scene.pieces if isinstance(scene, Scene) else pieces(bodies))
    known, bodies = before.of_solids(_solids, before), bodies[len(bodies_in(before)) :]
    own = solids_of(bodies, pieces(bodies))
    own["bodies"][:, c.BODY_PIECE] += len(known["pieces"])
    own["bodies"][:, c.BODY_TRIANGLE] += len(known["triangles"])
    own["pieces"][:, c.PIECE_VERTEX] += len(known["vertices"])
    own["triangles"] = own["triangles"] + float(len(known["pieces"]))
    own["triangles"][:, c.TRIANGLE_VERTEX : c.TRIANGLE_PIECE] += len(known["vertices"]) - len(known["pieces"])
    return {name: np.concatenate((table, own[name])) for name, table in known.items()}


def solids_of(bodies: Sequence[Body], solids: Pieces) -> dict[str, FloatArray]:
    """Bodies, pieces, vertices and triangles. `solids`: the pieces of these bodies. A piece with triangles has their
    corners as its vertices."""
    rows = np.zeros((len(bodies), c.BODY))
    rows[:, c.BODY_PIECE], rows[:, c.BODY_PIECES] = solids.first, solids.count
    pieces, corners = _pieces(solids), list[FloatArray]()
    hulls = solids.hull >= 0
    for k in hulls.nonzero()[0].tolist():
        hull = solids.hulls[solids.hull[k]]
        corners.append(hull.vertices @ solids.rotation[k].T + solids.position[k])
    surfaces = {k: body.cut_surface for k, body in enumerate(bodies) if body.surface is not None}
    numbers = solids.hull.tolist()
    for body, cut in surfaces.items():
        for piece, (own, _) in enumerate(cut, start=int(solids.first[body])):
            corners[numbers[piece]] = own
    if corners:
        pieces[hulls, c.PIECE_VERTICES] = list(map(len, corners))
        pieces[:, c.PIECE_VERTEX] = pieces[:, c.PIECE_VERTICES].cumsum() - pieces[:, c.PIECE_VERTICES]
    triangles = list[FloatArray]()
    for body, cut in surfaces.items():
        for piece, (_, chosen) in enumerate(cut, start=int(solids.first[body])):
            own = np.full((len(chosen), c.TRIANGLE), float(piece))
            own[:, c.TRIANGLE_VERTEX : c.TRIANGLE_PIECE] = chosen + pieces[piece, c.PIECE_VERTEX]
            triangles.append(own)
            rows[body, c.BODY_TRIANGLES] += len(own)
    rows[:, c.BODY_TRIANGLE] = rows[:, c.BODY_TRIANGLES].cumsum() - rows[:, c.BODY_TRIANGLES]
    return {
        "bodies": rows,
        "pieces": pieces,
        "vertices": np.concatenate(corners) if corners else EMPTY["vertices"],
        "triangles": np.concatenate(triangles) if triangles else EMPTY["triangles"],
    }


def _pieces(solids: Pieces) -> FloatArray:
    """The rows of all pieces, without their vertices."""
    found, count = np.zeros((len(solids.shapes), c.PIECE)), len(solids.shapes)
    found[:, c.PIECE_CENTRE : c.PIECE_AXIS] = solids.position
    found[:, c.PIECE_AXIS : c.PIECE_DISC] = solids.rotation[:, :, 2]
    found[:, c.PIECE_DISC], found[:, c.PIECE_BALL] = solids.disc, solids.ball
    long = solids.half != 0.0
    found[:, c.PIECE_EDGES] = np.add.reduce(long, 1)
    edges = solids.rotation.transpose(0, 2, 1) * solids.half[:, :, None]
    order = (~long).argsort(axis=1, kind="stable")  # edges of no length come last
    found[:, c.PIECE_EDGE : c.PIECE_EDGE + 9] = edges[np.arange(count)[:, None], order].reshape(count, 9)
    return found


# Limits of the joints, and for which time: a load changes them.

SHARES = (1e-9, 1e-9, 1e-9, 1e-6)
"""Of half the range, velocity, acceleration and jerk, beyond the limit: rounding of knots on a limit."""


def limits_of(scene: Scene, start: float, phases: Sequence[Phase]) -> FloatArray:
    """The limits (N, c.LIMIT) of a plan: the robot's from `start` on, s, and those that each load lowers, for as long
    as it is held."""
    own, n, jerk = scene.robot.limits, len(scene.robot.joints), scene.options.jerk_limited
    spans = [(own, start, phases[-1].t1)]
    for part, t0, t1 in loads_of(phases):
        limits = scene.limits_with(part)
        if limits is not own:
            spans.append((limits, t0, t1))
    found = np.zeros((len(spans), c.LIMIT))
    found[:, c.LIMIT_JERKS], found[:, c.LIMIT_SHARE : c.LIMIT_LOWER] = jerk, SHARES
    for row, (limits, t0, t1) in zip(found, spans, strict=True):
        row[c.LIMIT_T0], row[c.LIMIT_T1] = t0, t1
        row[c.LIMIT_LOWER :].reshape(-1, c.MOST_JOINTS)[: 4 + jerk, :n] = limits.table[: 4 + jerk]
    return found


def loads_of(phases: Sequence[Phase]) -> list[tuple[str | None, float, float]]:
    """What the gripper holds on the legs of a plan, from when to when, s."""
    found = list[tuple[str | None, float, float]]()
    for phase in phases:
        if phase.step >= 0:
            held = phase.attached.held
            part = None if held is None else held.part
            begin = found.pop()[1] if found and found[-1][0] == part else phase.t0
            found.append((part, begin, phase.t1))
    return found
