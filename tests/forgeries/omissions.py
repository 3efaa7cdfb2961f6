"""Claims that state less than the request requires: what is changed, in the claim of which case, and what the
difference is about."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

from assur.planner.checker.verdict import Code
from assur.planner.claim import columns as c
from assur.planner.claim.columns import Claim
from tests.planner.checker.statement.cases import Case, copied

Change = Callable[[Case], Claim]
Rows = Callable[[Case], Any]
Named = Mapping[str, Callable[[Case, str], int]]


class Omission(NamedTuple):
    """A claim that states less, of a case."""

    name: str
    case: str
    code: Code
    change: Change


def changed(case: Case, table: str, row: Any, column: Any, value: Any) -> Claim:
    """The claim with other numbers in some rows and columns. `value` may be a function of the old ones."""
    claim = copied(case.claim)
    numbers = getattr(claim, table)
    numbers[row, column] = value(numbers[row, column]) if callable(value) else value
    return claim


def plus(amount: float) -> Callable[[Any], Any]:
    """A number that is larger by this."""
    return lambda old: old + amount


def times(factor: float) -> Callable[[Any], Any]:
    """A number that is so many times as large."""
    return lambda old: old * factor


def less(case: Case, table: str, row: Any) -> Claim:
    """The claim without some rows of a table."""
    return case.claim._replace(**{table: np.delete(getattr(case.claim, table), row, axis=0)})


ROWS: Named = {
    "bodies": Case.body,
    "frames": Case.frame,
    "phases": Case.phase,
    "pieces": Case.piece,
    "shares": Case.phase,
}
COLUMNS: Named = {"off": Case.body, "shares": Case.frame}
"""What names rows and columns of a table."""


def named(case: Case, names: Named, table: str, place: Any) -> Any:
    """Rows or columns of a table: as they are, those that a function finds, or that of what has a name."""
    if isinstance(place, str):
        return names[table](case, place)
    return place(case) if callable(place) else place


def put(table: str, row: Any, column: Any, value: Any) -> Change:
    """Puts other numbers into some rows and columns."""
    return lambda k: changed(k, table, named(k, ROWS, table, row), named(k, COLUMNS, table, column), value)


def drop(table: str, row: Any) -> Change:
    """Leaves out some rows of a table."""
    return lambda k: less(k, table, named(k, ROWS, table, row))


def more(case: Case, table: str, *rows: Any) -> Claim:
    """The claim with more rows of a table."""
    return case.claim._replace(**{table: np.concatenate([getattr(case.claim, table), np.array(rows, dtype=float)])})


def touching(case: Case, phase: int, one: str, other: str) -> Claim:
    """The claim with one more contact."""
    return more(case, "contacts", (phase, case.body(one), case.body(other), 1e-4))


def seated(case: Case, phase: int, body: str, column: Any, value: Any) -> Claim:
    """The claim in which a body has a seat of its own in one phase, with other numbers in some columns."""
    k = case.body(body)
    row = case.claim.seats[int(case.claim.seated[phase, k])].copy()
    row[column] = value(row[column]) if callable(value) else value
    return changed(case, "seated", phase, k, len(case.claim.seats))._replace(seats=np.vstack([case.claim.seats, row]))


def seat_of(case: Case, phase: int, other: int, body: str) -> Claim:
    """The claim in which a body has the seat in one phase that it has in another."""
    k = case.body(body)
    return changed(case, "seated", phase, k, case.claim.seated[other, k])


def shifted(case: Case, name: str, seconds: float) -> Claim:
    """The claim in which a frame does everything some time later."""
    claim, k = copied(case.claim), case.frame(name)
    row = claim.frames[k]
    row[c.FRAME_POSE : c.FRAME_RATE] -= seconds * row[c.FRAME_RATE : c.FRAME_PIECE]
    wave, waves = int(row[c.FRAME_WAVE]), int(row[c.FRAME_WAVES])
    claim.waves[wave : wave + waves, c.WAVE_PHASE] -= claim.waves[wave : wave + waves, c.WAVE_RATE] * seconds
    first, count = int(row[c.FRAME_PIECE]), int(row[c.FRAME_PIECES])
    if count > 1:
        claim.laws[first : first + count, c.LAW_BEGIN : c.LAW_END + 1] += seconds
    return claim


def inner_ends_later(case: Case, name: str, seconds: float) -> Claim:
    """The claim in which the pieces of a law but the first begin later."""
    claim, row = copied(case.claim), case.claim.frames[case.frame(name)]
    first, last = int(row[c.FRAME_PIECE]), int(row[c.FRAME_PIECE] + row[c.FRAME_PIECES])
    claim.laws[first + 1 : last, c.LAW_BEGIN] += seconds
    claim.laws[first : last - 1, c.LAW_END] += seconds
    return claim


def without_pieces(case: Case, name: str) -> Claim:
    """The claim in which a frame that moves by pieces of a polynomial does not move."""
    claim, row = copied(case.claim), case.claim.frames[case.frame(name)]
    first, count = int(row[c.FRAME_PIECE]), int(row[c.FRAME_PIECES])
    claim.frames[case.frame(name), c.FRAME_PIECES] = 0.0
    claim.frames[claim.frames[:, c.FRAME_PIECE] > first, c.FRAME_PIECE] -= count
    return claim._replace(laws=np.delete(claim.laws, range(first, first + count), axis=0))


def in_one_piece(case: Case, name: str) -> Claim:
    """The claim in which the first piece of a law lasts for very long."""
    row = int(case.claim.frames[case.frame(name), c.FRAME_PIECE])
    claim = changed(case, "laws", row, c.LAW_END, 9e4)
    claim.frames[case.frame(name), c.FRAME_PIECES] = 1.0
    return claim


def first_power(case: Case, name: str) -> Claim:
    """The claim with another acceleration of a frame: the first number that is not zero."""
    row = int(case.claim.frames[case.frame(name), c.FRAME_PIECE])
    powers = np.flatnonzero(case.claim.laws[row, c.LAW_POWER :])
    return changed(case, "laws", row, c.LAW_POWER + int(powers[0]), times(1.001))


def displaced(frame: str, which: int) -> Rows:
    """The row of a displacement of a frame."""
    return lambda k: int(np.flatnonzero(k.claim.displaced[:, c.DISPLACED_FRAME] == k.frame(frame))[which])


def edge(case: Case, body: str, value: Any) -> Claim:
    """The claim with another first edge of a body."""
    return changed(case, "pieces", case.piece(body), slice(c.PIECE_EDGE, c.PIECE_EDGE + 3), value)


def longer(amount: float) -> Callable[[Any], Any]:
    """An edge that is longer by this."""
    return lambda old: old * (1.0 + amount / np.linalg.norm(old))


def triangles_of(case: Case, body: str) -> slice:
    """The rows of the triangles of a body."""
    row = case.claim.bodies[case.body(body)].astype(int)
    return slice(row[c.BODY_TRIANGLE], row[c.BODY_TRIANGLE] + row[c.BODY_TRIANGLES])


def no_surface(case: Case, body: str) -> Claim:
    """The claim in which the pieces of a body fill it."""
    return changed(case, "bodies", case.body(body), c.BODY_TRIANGLES, 0.0)


def turned_triangle(case: Case, body: str) -> Claim:
    """The claim in which a triangle of a mesh is seen from inside."""
    rows = triangles_of(case, body)
    return changed(case, "triangles", rows.start, [0, 1], lambda old: old[..., ::-1])


def spoken_twice(case: Case, body: str) -> Claim:
    """The claim that has a triangle of a mesh twice, in place of the next one."""
    rows = triangles_of(case, body)
    return changed(case, "triangles", rows.start + 1, slice(None), case.claim.triangles[rows.start])


def moved_vertex(case: Case, body: str) -> Claim:
    """The claim in which a corner of a mesh is elsewhere."""
    vertex = int(case.claim.triangles[triangles_of(case, body).start, 0])
    return changed(case, "vertices", vertex, 2, plus(1e-5))


def knots_of(arm: int, which: int) -> Rows:
    """The row of a knot of an arm."""
    return lambda k: int(k.claim.arms[arm, c.ARM_KNOT]) + which


def all_knots(arm: int) -> Rows:
    """The rows of all knots of an arm."""
    return lambda k: slice(*np.cumsum(k.claim.arms[arm, c.ARM_KNOT : c.ARM_KNOTS + 1]).astype(int).tolist())


def more_knots(case: Case) -> Claim:
    """The claim in which the robot jumps at its end."""
    end = int(case.claim.arms[0, c.ARM_KNOTS])
    knots = case.claim.knots[:end].copy()
    knots[-1] = knots[-2]
    knots[-1, c.KNOT_Q] += 0.1
    return case.claim._replace(knots=np.concatenate([knots, case.claim.knots[end:]]))


def support_of_its_own(case: Case) -> Claim:
    """The claim in which a part that was put down has two rows, one of which allows it to touch one body more."""
    supports = np.zeros(len(case.claim.bodies))
    supports[case.body("bar")] = 1.0
    claim = case.claim._replace(supports=np.vstack([supports, case.claim.supports]))
    return claim._replace(put_down=np.vstack([claim.put_down[-1], claim.put_down]))


def angle_of(link: int, which: int = c.LINK_YAW) -> Rows:
    """The row of an angle of a link of the robot."""
    return lambda k: int(k.claim.links[link, which])


def high_points(case: Case) -> Any:
    """The rows of points above which the tool may be for some time."""
    rows = case.claim.points
    return (rows[:, c.POINT_HEIGHT] >= 0.0) & (rows[:, c.POINT_T1] > rows[:, c.POINT_T0])


def tracked_points(case: Case) -> Any:
    """The rows of points that last for some time."""
    return case.claim.points[:, c.POINT_T1] > case.claim.points[:, c.POINT_T0] + 0.01


def outer_ends(case: Case) -> Any:
    """The rows of points that state how high the tool is at an instant."""
    return (case.claim.points[:, c.POINT_HEIGHT] >= 0.0) & (case.claim.points[:, c.POINT_T0] == case.claim.points[:, 1])


def sums(order: int, *, lasting: bool) -> Rows:
    """The rows of sums of an order, at instants or over intervals."""

    def found(case: Case) -> Any:
        rows = case.claim.sums
        return (rows[:, c.SUM_ORDER] == order) & ((rows[:, c.SUM_T1] > rows[:, c.SUM_T0]) == lasting)

    return found


def one_chord(case: Case, first: int, last: int) -> Claim:
    """The claim in which one chord is stated in place of some that follow each other."""
    rows = case.claim.guides
    row = rows[first].copy()
    row[[c.GUIDE_T1, c.GUIDE_SHARE + 1]] = rows[last - 1, [c.GUIDE_T1, c.GUIDE_SHARE + 1]]
    row[c.GUIDE_TO : c.GUIDE_SHARE] = rows[last - 1, c.GUIDE_TO : c.GUIDE_SHARE]
    return case.claim._replace(guides=np.concatenate([rows[:first], row[None, :], rows[last:]]))


def other_times(case: Case, first: int, last: int, amount: float) -> Claim:
    """The claim in which some guides, one behind the other, meet at later times."""
    claim = changed(case, "guides", slice(first, last), c.GUIDE_T1, plus(amount))
    claim.guides[first + 1 : last + 1, c.GUIDE_T0] += amount
    return claim


def back_and_forth(case: Case) -> Claim:
    """The claim in which a straight leg goes on, back and on again."""
    rows = case.claim.guides
    shares = [rows[4, c.GUIDE_SHARE + 1], rows[3, c.GUIDE_SHARE]]
    claim = changed(case, "guides", 3, c.GUIDE_SHARE + 1, shares[0])
    claim.guides[4, [c.GUIDE_SHARE, c.GUIDE_SHARE + 1]] = shares
    claim.guides[5, c.GUIDE_SHARE] = shares[1]
    return claim


def aside(case: Case, row: int, far: float) -> Claim:
    """The claim in which two chords of a path meet aside from it."""
    claim = changed(case, "guides", row, c.GUIDE_TO + 2, plus(far))
    claim.guides[row + 1, c.GUIDE_FROM + 2] += far
    return claim


DEMO, FLOW, LAWS = "demo, more uncertain", "dense-flow, more uncertain", "demo, all laws"
WAYS, TILTS = "demo, straight ways", "rv-m1, straight way"
T = Code
RULE = c.RULE_SIDE

TABLE: tuple[tuple[str, str, Code, Change], ...] = (
    # what may touch
    ("a contact more", DEMO, T.CONTACT, lambda k: touching(k, k.phase("APPROACH"), "cup", "bar")),
    ("a contact in travel", DEMO, T.CONTACT, lambda k: touching(k, k.phase("MOVE"), "cup", "part")),
    ("a grip after the part is held", DEMO, T.CONTACT, lambda k: touching(k, k.phase("DEPART"), "cup", "part")),
    ("a contact too deep", DEMO, T.CONTACT, put("contacts", 0, c.CONTACT_DEPTH, plus(1e-5))),
    ("a support that is none", "demo", T.CONTACT, lambda k: touching(k, k.phase("DEPART"), "part", "dial-post")),
    ("a put-down part not kept clear", DEMO, T.CONTACT, lambda k: less(drop_supports(k, -1), "put_down", -1)),
    ("a support in a row of its own", DEMO, T.CONTACT, support_of_its_own),
    ("one support more", DEMO, T.CONTACT, lambda k: changed(k, "supports", -1, k.body("bar"), 1.0)),
    # which distance
    ("travel 1 % smaller", DEMO, T.DISTANCE, put("required", 0, c.REQUIRED_TRAVEL, times(0.99))),
    ("near 1 % smaller", DEMO, T.DISTANCE, put("required", 0, c.REQUIRED_NEAR, times(0.99))),
    ("an exception dropped", DEMO, T.DISTANCE, drop("rules", -1)),
    ("a smaller exception", DEMO, T.DISTANCE, put("rules", 0, c.RULE_NEAR, times(0.99))),
    ("an exception of others", DEMO, T.DISTANCE, lambda k: changed(k, "rules", 0, RULE + k.body("cup"), 0.0)),
    ("an exception more", DEMO, T.DISTANCE, lambda k: more(k, "rules", [0.0] * 2 + [1.0] * 2 * len(k.claim.bodies))),
    ("near in place of travel", DEMO, T.DISTANCE, put("phases", "MOVE", c.PHASE_NEAR, 1.0)),
    ("no pair of links", DEMO, T.DISTANCE, put("self_pairs", slice(None), slice(None), 0.0)),
    ("a robot that does not count", DEMO, T.DISTANCE, put("phases", 0, c.PHASE_ROBOT, 0.0)),
    ("distances end early", DEMO, T.DISTANCE, put("required", 0, c.REQUIRED_UNTIL, plus(-0.1))),
    ("no standstill", DEMO, T.PHASE, lambda k: without_phase(k, -2)),
    ("a phase 1 ms shorter", DEMO, T.PHASE, put("phases", -3, c.PHASE_T1, plus(-1e-3))),
    ("no lateness at the end", DEMO, T.PHASE, lambda k: without_phase(k, -1)),
    # where bodies are
    ("attached late", DEMO, T.SEAT, lambda k: seat_of(k, k.phase("DEPART"), k.phase("FOLLOW"), "part")),
    ("attached early", DEMO, T.SEAT, lambda k: seat_of(k, k.phase("FOLLOW"), k.phase("DEPART"), "part")),
    ("put down early", DEMO, T.SEAT, lambda k: seat_of(k, k.phase("FOLLOW", 1), k.phase("DEPART", 1), "part")),
    ("10 µm off when held", DEMO, T.SEAT, lambda k: seated(k, k.phase("DEPART"), "part", 3, plus(1e-5))),
    ("10 µm off on the dial", DEMO, T.SEAT, lambda k: seated(k, k.phase("DEPART", 1), "part", 3, plus(1e-5))),
    ("turned when held", DEMO, T.SEAT, lambda k: seated(k, k.phase("DEPART"), "part", 6, plus(1.0))),
    ("on another frame", DEMO, T.SEAT, lambda k: seated(k, k.phase("DEPART", 1), "part", c.SEAT_FRAME, 0.0)),
    ("a body elsewhere", DEMO, T.SEAT, lambda k: seated(k, k.phase("MOVE"), "belt-bed", 3, plus(1e-5))),
    ("a tool on the quill", FLOW, T.SEAT, lambda k: seated(k, k.phase("MOVE"), "finger-front", c.SEAT_LINK, 3.0)),
    # what is uncertain
    (
        "half the growth of an error",
        DEMO,
        T.UNCERTAINTY,
        put("displaced", displaced("belt", 0), c.DISPLACED_GROWTH, times(0.5)),
    ),
    ("an error dropped", FLOW, T.UNCERTAINTY, drop("displaced", displaced("belt", 1))),
    (
        "an error along another line",
        FLOW,
        T.UNCERTAINTY,
        put("displaced", displaced("belt", 0), [2, 3, 4], [0.0, 1.0, 0.0]),
    ),
    (
        "a shared error that no encoder reads",
        FLOW,
        T.UNCERTAINTY,
        put("displaced", displaced("belt", 1), c.DISPLACED_SHARED, 1.0),
    ),
    ("no error of a yaw", FLOW, T.UNCERTAINTY, put("frames", "belt", c.FRAME_YAW, 0.0)),
    ("no error of a body", FLOW, T.UNCERTAINTY, put("off", slice(None), "before", 0.0)),
    ("no error of a held part", FLOW, T.UNCERTAINTY, put("off", slice(4, None), "part", 0.0)),
    ("all of an error on the way", FLOW, T.UNCERTAINTY, put("shares", "MOVE", "belt", 1.0)),
    (
        "no share of an error when tracking",
        FLOW,
        T.UNCERTAINTY,
        lambda k: changed(k, "shares", k.phase("FOLLOW"), len(k.claim.frames) + k.frame("belt"), 0.0),
    ),
    ("an error that links share", FLOW, T.UNCERTAINTY, put("required", 0, c.REQUIRED_TOOL, 2.0)),
    ("one of two errors along a line", LAWS, T.UNCERTAINTY, drop("displaced", displaced("mast", 0))),
    ("errors grow later", DEMO, T.UNCERTAINTY, put("required", 0, c.REQUIRED_SINCE, 1.0)),
    ("no lateness", DEMO, T.UNCERTAINTY, put("required", 0, c.REQUIRED_LATE, 0.0)),
    ("no lag of a joint", DEMO, T.UNCERTAINTY, put("required", 0, c.REQUIRED_LAG + 2, 0.0)),
    (
        "no lateness of a neighbour",
        "two-robots, start uncertain",
        T.UNCERTAINTY,
        put("frames", slice(None), [c.FRAME_SHIFT, c.FRAME_SHIFT + 1], 0.0),
    ),
    # motions
    ("a belt 1 ms late", DEMO, T.LAW, lambda k: shifted(k, "belt", 1e-3)),
    ("a belt 1 % faster", DEMO, T.LAW, put("frames", "belt", c.FRAME_RATE, times(1.01))),
    ("a dial 1 ms late", DEMO, T.LAW, lambda k: shifted(k, "dial", 1e-3)),
    ("a gate 1 ms late", DEMO, T.LAW, lambda k: shifted(k, "gate", 1e-3)),
    ("a gate that swings less", DEMO, T.LAW, put("waves", 0, c.WAVE_AMPLITUDE, times(0.99))),
    ("a frame that does not move", DEMO, T.LAW, put("frames", "belt", [*range(6, 10), c.FRAME_PIECES], 0.0)),
    ("an indexer that does not move", LAWS, T.LAW, lambda k: without_pieces(k, "star")),
    ("poses that are not reached", LAWS, T.LAW, lambda k: without_pieces(k, "round")),
    ("an indexer 1 ms late", LAWS, T.LAW, lambda k: shifted(k, "star", 1e-3)),
    ("a screw that turns more", LAWS, T.LAW, put("frames", "cart", 8, plus(1e-3))),
    (
        "a belt that slows down 1 ms late",
        "demo, belt that slows down",
        T.LAW,
        lambda k: inner_ends_later(k, "belt", 1e-3),
    ),
    ("another acceleration between poses", "loader", T.LAW, lambda k: first_power(k, list(k.scene.frames)[1])),
    ("an indexer in one piece", LAWS, T.LAW, lambda k: in_one_piece(k, "star")),
    ("a law with a hole in time", "loader", T.LAW, put("laws", 0, c.LAW_END, plus(-1e-3))),
    ("a neighbour's knot 1 µrad off", "two-robots", T.MOTION, put("knots", knots_of(1, 3), c.KNOT_Q, plus(1e-6))),
    ("a neighbour 1 ms late", "two-robots", T.MOTION, put("knots", all_knots(1), 0, plus(1e-3))),
    (
        "another link of a neighbour",
        "two-robots",
        T.LAW,
        lambda k: changed(k, "frames", 3, c.FRAME_LINK, k.claim.frames[2, c.FRAME_LINK]),
    ),
    ("a frame that is no neighbour's link", "two-robots", T.LAW, put("frames", 3, [0, 1], -1.0)),
    ("a frame on the robot", DEMO, T.LAW, put("frames", "belt", [0, 1], 0.0)),
    ("the robot's knot 1 µrad off", DEMO, T.MOTION, put("knots", 3, c.KNOT_Q, plus(1e-6))),
    ("a knot more", DEMO, T.MOTION, more_knots),
    ("a knot less", DEMO, T.MOTION, put("arms", 0, c.ARM_KNOTS, plus(-3.0))),
    # bodies and arms
    ("a body less", DEMO, T.SOLID, drop("bodies", -1)),
    ("a body twice", DEMO, T.SOLID, lambda k: changed(k, "bodies", 0, slice(None), k.claim.bodies[1])),
    ("a box 10 µm smaller", DEMO, T.SOLID, lambda k: edge(k, "belt-bed", longer(-1e-5))),
    ("an edge less", DEMO, T.SOLID, put("pieces", "belt-bed", c.PIECE_EDGES, 2.0)),
    ("a thinner capsule", DEMO, T.SOLID, put("pieces", "bar", c.PIECE_BALL, plus(-1e-5))),
    ("a capsule along another axis", DEMO, T.SOLID, lambda k: edge(k, "bar", lambda old: old[..., ::-1])),
    ("a smaller disc", DEMO, T.SOLID, put("pieces", "dial-plate", c.PIECE_DISC, plus(-1e-5))),
    ("a disc across another axis", DEMO, T.SOLID, put("pieces", "dial-plate", [3, 4, 5], [1.0, 0.0, 0.0])),
    ("a solid 10 µm aside", DEMO, T.SOLID, put("pieces", "cup", 2, plus(1e-5))),
    (
        "a hull without a corner",
        "demo",
        T.SOLID,
        lambda k: changed(k, "pieces", k.claim.pieces[:, c.PIECE_VERTICES] > 0.0, c.PIECE_VERTICES, plus(-1.0)),
    ),
    ("a mesh without its surface", DEMO, T.SOLID, lambda k: no_surface(k, "part")),
    ("a triangle turned round", DEMO, T.SOLID, lambda k: turned_triangle(k, "part")),
    ("a triangle twice", DEMO, T.SOLID, lambda k: spoken_twice(k, "part")),
    ("a corner of a mesh 10 µm off", DEMO, T.SOLID, lambda k: moved_vertex(k, "part")),
    ("a triangle less", DEMO, T.SOLID, put("bodies", "part", c.BODY_TRIANGLES, plus(-1.0))),
    (
        "a triangle in another piece",
        DEMO,
        T.SOLID,
        lambda k: changed(k, "triangles", triangles_of(k, "part").start, c.TRIANGLE_PIECE, plus(1.0)),
    ),
    ("a link 10 µm longer", DEMO, T.LINK, put("links", 2, c.LINK_OFFSET, plus(1e-5))),
    ("a link that does not turn", DEMO, T.LINK, put("angles", angle_of(2), c.ANGLE_SHARE + 1, 0.0)),
    ("a base turned by 10 µrad", DEMO, T.LINK, put("angles", angle_of(1), 0, plus(1e-5))),
    ("a quill that sinks", DEMO, T.LINK, put("links", 3, c.LINK_AXIS + 2, -1.0)),
    ("a link of another parent", DEMO, T.LINK, put("links", 3, c.LINK_PARENT, 1.0)),
    ("a loop that closes behind", "five-bar", T.LINK, put("loops", 0, c.LOOP_SIDE, times(-1.0))),
    ("a longer coupler", "five-bar", T.LINK, put("loops", 0, c.LOOP_COUPLER, plus(1e-5))),
    ("a loop nearer to singular", "five-bar", T.LINK, put("loops", 0, c.LOOP_LEAST, times(0.9))),
    (
        "a hand that rolls the other way",
        "rv-m1",
        T.LINK,
        put("angles", angle_of(5, c.LINK_ROLL), c.ANGLE_SHARE + 4, -1.0),
    ),
    # limits, points, rates, axes
    ("a higher velocity", DEMO, T.LIMIT, put("limits", 0, c.LIMIT_VELOCITY, times(1.001))),
    ("a higher jerk", DEMO, T.LIMIT, put("limits", 0, c.LIMIT_JERK + 3, times(1.001))),
    ("no limit of the jerk", DEMO, T.LIMIT, put("limits", 0, c.LIMIT_JERKS, 0.0)),
    ("a range 1e-6 wider", DEMO, T.LIMIT, put("limits", 0, c.LIMIT_UPPER + 1, plus(1e-6))),
    ("more beyond the limits", DEMO, T.LIMIT, put("limits", 0, [3, 4, 5, 6], 1e-3)),
    ("limits that end early", DEMO, T.LIMIT, put("limits", 0, c.LIMIT_T1, plus(-0.5))),
    ("no limits with a load", "heavy-casting", T.LIMIT, drop("limits", -1)),
    ("limits with a load 1 ms late", "heavy-casting", T.LIMIT, put("limits", 1, 0, plus(1e-3))),
    ("a point less", DEMO, T.POINT, drop("points", 2)),
    ("a point farther off", DEMO, T.POINT, put("points", 0, c.POINT_POSITION, times(1.001))),
    ("a target 10 µm aside", DEMO, T.POINT, put("points", 0, c.POINT_TARGET, plus(1e-5))),
    ("another tool point", DEMO, T.POINT, put("points", slice(None), c.POINT_TOOL + 2, plus(1e-5))),
    ("no velocity", DEMO, T.POINT, put("points", slice(None), [16, 17], -1.0)),
    ("no yaw", DEMO, T.POINT, put("points", slice(None), c.POINT_YAW, -1.0)),
    ("an approach aside", DEMO, T.POINT, put("points", high_points, c.POINT_POSITION, times(10.0))),
    ("a depart 1 mm higher", DEMO, T.POINT, put("points", high_points, c.POINT_HEIGHT, plus(1e-3))),
    ("tracking 1 ms shorter", DEMO, T.POINT, put("points", tracked_points, 1, plus(-1e-3))),
    ("a part pulled harder", "belt-to-belt", T.RATE, put("rates", 1, c.RATE_MOST, times(1.01))),
    ("a pull less", "belt-to-belt", T.RATE, drop("rates", -1)),
    ("no forbidden yaw", "hose-on-gripper", T.YAW, drop("axes", 0)),
    ("a narrower forbidden yaw", "hose-on-gripper, lag", T.YAW, put("axes", 0, c.AXIS_HIGH, plus(1e-4))),
    # straight legs
    ("a guide less", WAYS, T.GUIDE, drop("guides", 5)),
    ("a wider line", WAYS, T.GUIDE, put("guides", 5, c.GUIDE_MOST, times(1.001))),
    ("a line 1 µm aside", WAYS, T.GUIDE, put("guides", slice(None), c.GUIDE_TO + 1, plus(1e-6))),
    ("a line from elsewhere", WAYS, T.GUIDE, put("guides", 0, c.GUIDE_FROM, plus(1e-6))),
    ("a line to another frame", WAYS, T.GUIDE, put("guides", 3, c.GUIDE_FRAME + 1, plus(1.0))),
    ("a line of another link", WAYS, T.GUIDE, put("guides", 3, c.GUIDE_LINK, plus(-1.0))),
    ("a line that goes back", WAYS, T.GUIDE, back_and_forth),
    ("a line that is not gone to its end", WAYS, T.GUIDE, put("guides", -1, 15, times(0.99))),
    ("a line with a gap", WAYS, T.GUIDE, put("guides", 3, c.GUIDE_SHARE + 1, plus(-1e-6))),
    ("a line that ends early", WAYS, T.GUIDE, put("guides", -1, c.GUIDE_T1, plus(-1e-3))),
    # paths and traces
    ("a corner that is cut", "circular-legs", T.GUIDE, lambda k: one_chord(k, 10, 40)),
    ("a path 2 µm aside", "circular-legs", T.GUIDE, lambda k: aside(k, 20, 2e-6)),
    ("a wider path", "circular-legs", T.GUIDE, put("guides", 5, c.GUIDE_MOST, times(1.6))),
    ("half a chord", "circular-legs", T.GUIDE, put("guides", 5, c.GUIDE_SHARE + 1, 0.5)),
    ("a trace 1 ms late", "bead-on-belt", T.GUIDE, lambda k: other_times(k, 200, 210, 1e-3)),
    ("a trace that cuts an arc", "bead-on-belt", T.GUIDE, lambda k: one_chord(k, 300, 306)),
    ("a trace 1 µm aside", "bead-on-belt", T.GUIDE, lambda k: aside(k, 300, 1e-6)),
    ("a lead-in 20 µm aside", "bead-on-belt", T.GUIDE, lambda k: aside(k, 10, 2e-5)),
    ("a lead-out in one chord", "bead-on-belt", T.GUIDE, lambda k: one_chord(k, len(k.claim.guides) - 20, -1)),
    ("a slower trace", "bead-on-belt", T.RATE, put("rates", -1, c.RATE_LEAST, times(0.999))),
    ("a faster trace", "bead-on-belt", T.RATE, put("rates", -1, c.RATE_MOST, times(1.001))),
    ("a trace in another frame", "bead-on-belt", T.RATE, put("rates", -1, c.RATE_FRAME, 0.0)),
    ("a trace with any yaw", "bead-on-belt", T.POINT, put("points", 0, c.POINT_YAW, -1.0)),
    # outer ends of straight parts
    ("a shorter approach", WAYS, T.POINT, put("points", outer_ends, c.POINT_MIDDLE, plus(-1e-3))),
    ("no stop above", WAYS, T.POINT, put("points", outer_ends, slice(16, 18), -1.0)),
    # joints
    ("a wait in motion", "shutter", T.JOINTS, put("sums", 2, c.SUM_HIGH, plus(1e-6))),
    ("a wait that ends early", "shutter", T.JOINTS, put("sums", 2, c.SUM_T1, plus(-1e-3))),
    ("no rest", WAYS, T.JOINTS, put("sums", 1, c.SUM_LOW, -1.0)),
    ("no rest of a joint", WAYS, T.JOINTS, drop("sums", 1)),
    ("a via at which it stops", WAYS, T.JOINTS, put("sums", -1, c.SUM_LOW, 0.0)),
    # pitch and roll
    ("a pitch farther off", TILTS, T.JOINTS, put("sums", slice(None), c.SUM_HIGH, plus(1e-5))),
    ("another pitch", TILTS, T.JOINTS, put("sums", sums(0, lasting=False), slice(11, 13), plus(1e-5))),
    ("a pitch that changes", TILTS, T.JOINTS, put("sums", sums(1, lasting=False), 12, 1e-5)),
    ("a roll of other joints", TILTS, T.JOINTS, put("sums", slice(None), c.SUM_SHARE + 4, 0.5)),
    ("a way that leaves its chord", TILTS, T.JOINTS, drop("sums", -1)),
    ("a way beyond its end", TILTS, T.JOINTS, put("sums", -2, c.SUM_HIGH, plus(1e-5))),
    # arches and a yaw that is kept
    ("a lower arch", "standard-cycle", T.ARCH, put("axes", 0, c.AXIS_LOW, plus(-1e-5))),
    ("an arch without height", "standard-cycle", T.ARCH, drop("axes", 1)),
    (
        "an arch that goes down first",
        "standard-cycle",
        T.ARCH,
        put("sums", sums(1, lasting=True), c.SUM_LOW, plus(-0.5)),
    ),
    ("an arch no way up", "standard-cycle", T.ARCH, drop("sums", 3)),
    ("no top", "standard-cycle", T.ARCH, drop("sums", sums(0, lasting=False))),
    ("a yaw that is not kept", WAYS, T.DIRECTION, drop("axes", 0)),
    ("a yaw that may be opposite", WAYS, T.DIRECTION, drop("axes", 1)),
    ("another yaw at first", WAYS, T.DIRECTION, put("axes", 0, c.AXIS_HIGH, 1e-5)),
    # errors
    ("an error less", FLOW, T.ERROR, drop("errors", 0)),
    ("a larger error", FLOW, T.ERROR, put("errors", 1, c.ERROR_FAR, plus(1e-6))),
    ("a larger error of the yaw", FLOW, T.ERROR, put("errors", 1, c.ERROR_YAW, plus(1e-6))),
    ("a part that is exact", FLOW, T.ERROR, put("errors", 1, c.ERROR_OFF, 0.0)),
    ("an error in another phase", FLOW, T.ERROR, put("errors", 1, c.ERROR_PHASE, plus(1.0))),
    ("an error at another time", FLOW, T.ERROR, put("errors", 1, c.ERROR_TIME, plus(1e-3))),
    ("an error in another frame", FLOW, T.ERROR, put("errors", 1, c.ERROR_FRAME, plus(1.0))),
    ("an error of another point", FLOW, T.ERROR, put("errors", 1, c.ERROR_TARGET, plus(1e-6))),
    ("an error of another place", FLOW, T.ERROR, put("errors", 1, c.ERROR_TOOL, plus(1e-6))),
    # vias that are missed
    ("a via farther off", "parabolic-blend", T.POINT, put("points", 0, c.POINT_POSITION, plus(1e-6))),
)
OMISSIONS = tuple(Omission(*each) for each in TABLE)


def drop_supports(case: Case, row: int) -> Case:
    """The case with a row less in the table that belongs to `put_down`."""
    return Case(case.request, case.scene, case.plan, less(case, "supports", row))


def without_phase(case: Case, phase: int) -> Claim:
    """The claim without a phase, and without all that is of it."""
    count = len(case.claim.phases)
    gone = phase % count
    found = {name: np.delete(getattr(case.claim, name), gone, axis=0) for name in ("phases", "seated", "off", "shares")}
    put_down = case.claim.put_down[:, c.PUT_PHASE]
    for name, of in (("put_down", put_down), ("supports", put_down), ("contacts", case.claim.contacts[:, 0])):
        rows = getattr(case.claim, name)[of != gone]
        if name != "supports":
            rows = rows.copy()
            rows[:, 0] -= rows[:, 0] > gone
        found[name] = rows
    return case.claim._replace(**found)


def any_share(case: Case) -> Claim:
    """The claim in which the tool may have any share in the error of any frame, in all phases."""
    count = len(case.claim.frames)
    claim = changed(case, "shares", slice(None), slice(0, count), 0.0)
    claim.shares[:, count:] = 1.0
    return claim


MORE: tuple[tuple[str, str, Change], ...] = (
    ("a larger distance", DEMO, put("required", 0, c.REQUIRED_TRAVEL, times(1.01))),
    ("no contact", DEMO, drop("contacts", slice(None))),
    ("a smaller tolerance", DEMO, put("points", 0, c.POINT_POSITION, times(0.5))),
    ("a lower limit", DEMO, put("limits", 0, c.LIMIT_VELOCITY, times(0.99))),
    ("a thicker body", DEMO, put("pieces", "bar", c.PIECE_BALL, plus(1e-3))),
    ("more that is uncertain", FLOW, put("displaced", displaced("belt", 0), 5, plus(1e-3))),
    ("a pair of links more", DEMO, put("self_pairs", [1, 2], [2, 1], 1.0)),
    ("travel in place of near", DEMO, put("phases", "FOLLOW", c.PHASE_NEAR, 0.0)),
    ("any share of an error", FLOW, any_share),
    ("distances that are kept longer", DEMO, put("required", 0, c.REQUIRED_UNTIL, plus(1.0))),
    ("a lower approach", DEMO, put("points", high_points, c.POINT_HEIGHT, plus(-1e-3))),
)
"""Changes with which a claim states more than is required."""
