"""The tables of a claim: every column is named here, once, with its unit, its meaning, and what it may hold.

Import this module as one name (`from assur.planner.claim import columns as c`). Every table is a C-ordered float64
array; one row is one thing. Indices are whole numbers in these tables; -1 means none. Units are m, s, rad and their
quotients. The world's z axis points up. A pose (x, y, z, yaw) maps a point v to (x, y, z) + Rz(yaw) v. Times are s of
the clock of a robot that starts on time. docs/bundle.md defines the terms; a proof bundle is the same claim as JSON.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from assur.planner.arrays import FloatArray

MOST_JOINTS = 8
"""Joints for which the tables have columns."""
MOST_POWERS = 12
"""Powers of time in the acceleration of a law."""
MOST_EDGES = 6
"""Edges of a convex piece."""

# An arm. Arm 0 is the robot; the others are neighbours.
ARM_LINK, ARM_LINKS = 0, 1  # first row in `links`, and how many
ARM_JOINTS = 2  # number of joints
ARM_KNOT, ARM_KNOTS = 3, 4  # first row in `knots`, and how many
ARM_ANGLE, ARM_ANGLES = 5, 6  # first row in `angles`, and how many
ARM_LOOP = 7  # row in `loops`
ARM = 8

# A knot of a joint motion: between two knots the motion is the quintic that has these values at both.
KNOT_TIME = 0
KNOT_Q, KNOT_QD, KNOT_QDD = 1, 1 + MOST_JOINTS, 1 + 2 * MOST_JOINTS  # position, velocity, acceleration of each joint
KNOT = 1 + 3 * MOST_JOINTS

# An angle of a chain: a constant plus the sum of shares of the joints. Links with the same angle refer to one row.
ANGLE_CONSTANT, ANGLE_SHARE = 0, 1
ANGLE = 1 + MOST_JOINTS

# A link of an arm.
LINK_PARENT = 0  # row of the parent in `links`
LINK_OFFSET = 1  # (3) origin in the parent's axes
LINK_SLIDE, LINK_AXIS = 4, 5  # the joint that slides it, and (3) along which axis of the parent
LINK_YAW, LINK_PITCH, LINK_ROLL = 8, 9, 10  # rows in `angles`, all in the world; pitch and roll -1: it stays upright
LINK_COUPLER = 11  # which coupler of the loop its yaw counts from
LINK = 12

# A closed loop of five bars.
LOOP_CRANK, LOOP_LENGTH = 0, 2  # rows in `links` of both cranks, and their lengths
LOOP_COUPLER = 4  # lengths of both couplers
LOOP_SIDE = 6  # side on which the couplers meet, 1 or -1
LOOP_LEAST = 7  # least sine between the couplers
LOOP_BETWEEN = 8  # row in `angles` of the second crank's yaw less the first one's
LOOP = 9

# A frame: a link of another arm, or a law of motion.
FRAME_ARM, FRAME_LINK = 0, 1  # arm, and row in `links`, if it is a link of another arm
FRAME_POSE, FRAME_RATE = 2, 6  # (4) pose and its rate when its first piece begins
FRAME_PIECE, FRAME_PIECES = 10, 11  # first row in `laws`, and how many
FRAME_WAVE, FRAME_WAVES = 12, 13  # first row in `waves`, and how many
FRAME_SHIFT = 14  # (2) by how much its motion may be late, at least and at most
FRAME_YAW = 16  # by how much it may be turned about its origin
FRAME_PERIOD = 17  # 0: none; else its pieces last one period, and at t + period the frame is (18: 4) further on. Its
# last piece may end later than one period after its first begins, but counts until then. Where two periods meet, pose
# and rate differ by 1e-9 at most. Before the first piece begins there is no motion, as without a period
FRAME_STEP = 18
FRAME = 22

# A piece of a law: its time, and the acceleration of x, y, z and yaw as powers of the time since its begin.
LAW_BEGIN, LAW_END, LAW_POWER = 0, 1, 2
LAW = 2 + 4 * MOST_POWERS

# A sine that is added to a coordinate of a frame: amplitude * sin(rate * time + phase).
WAVE_COORDINATE, WAVE_AMPLITUDE, WAVE_RATE, WAVE_PHASE = range(4)
WAVE = 4

# A displacement of a frame that is uncertain.
DISPLACED_FRAME = 0
DISPLACED_LEVEL, DISPLACED_DIRECTION = 1, 2  # 1: any horizontal direction; else (3) its direction
DISPLACED_AMOUNT, DISPLACED_GROWTH = 5, 6  # its greatest size, and how fast that grows
DISPLACED_SHARED = 7  # whether the tool has a share in it
DISPLACED = 8

# A body.
BODY_PIECE, BODY_PIECES = 0, 1  # first row in `pieces`, and how many
BODY_TRIANGLE, BODY_TRIANGLES = 2, 3  # first row in `triangles`, and how many; none: its pieces fill it
BODY = 4

# A convex piece: centre (or the hull of its vertices) + sum of s_i edge_i, s_i from -1 to 1, + disc + ball.
PIECE_CENTRE, PIECE_AXIS = 0, 3  # (3) in the body's axes; (3) the axis that the disc is perpendicular to
PIECE_DISC, PIECE_BALL = 6, 7  # radii
PIECE_VERTEX, PIECE_VERTICES = 8, 9  # first row in `vertices`, and how many
PIECE_EDGES, PIECE_EDGE = 10, 11  # how many edges, and (3 each) the edges
PIECE = 11 + 3 * MOST_EDGES

# A triangle of the surface of a mesh: rows in `vertices`, anticlockwise seen from outside, and the piece that holds it.
TRIANGLE_VERTEX, TRIANGLE_PIECE = 0, 3
TRIANGLE = 4

# A body at a pose (x, y, z, yaw) on a link of arm 0 or on a frame. The other one is -1.
SEAT_BODY, SEAT_LINK, SEAT_FRAME, SEAT_POSE = 0, 1, 2, 3
SEAT = 7

# An interval with constant attachments and allowed contacts.
PHASE_T0, PHASE_T1 = 0, 1
PHASE_NEAR = 2  # which distance is required: 1 near a control point, 0 in travel
PHASE_ROBOT = 3  # whether the robot's bodies must keep apart from others
PHASE = 4

# Two bodies that may touch in a phase, and how deep.
CONTACT_PHASE, CONTACT_BODY, CONTACT_DEPTH = 0, 1, 3
CONTACT = 4

# A part that was put down. `supports` has a 1 in the columns of the bodies that it may touch, in the same row.
PUT_PHASE, PUT_BODY = 0, 1
PUT = 2

# Other required distances for some pairs. From RULE_SIDE on a column for each body: 1 if it is on the first side;
# then the same for the second side.
RULE_TRAVEL, RULE_NEAR, RULE_SIDE = 0, 1, 2

# What is required of the whole plan (one row).
REQUIRED_TRAVEL, REQUIRED_NEAR = 0, 1  # distances in travel and near a control point
REQUIRED_UNTIL = 2  # the phases last until then at least
REQUIRED_LATE = 3  # greatest lateness of the robot's start
REQUIRED_SINCE = 4  # the time from which displacements of frames grow
REQUIRED_TOOL = 5  # first link that has a share in displacements
REQUIRED_LAG = 6  # how far each joint may be off its value
REQUIRED_NEAREST = 6 + MOST_JOINTS  # a second distance, which pairs with a body on a link keep if nothing is uncertain,
# contacts left out; and one for pairs of two bodies on frames, a part that was put down being one (negative: nothing is
# claimed; LIMITLESS: there is no such pair)
REQUIRED_PLACED = REQUIRED_NEAREST + 1
REQUIRED = REQUIRED_PLACED + 1

# Limits of the joints for a time.
LIMIT_T0, LIMIT_T1, LIMIT_JERKS = 0, 1, 2  # its time, and whether the jerk has a limit
LIMIT_SHARE = 3  # (4) by which share position range, velocity, acceleration, jerk may be exceeded
LIMIT_LOWER, LIMIT_UPPER = 7, 7 + MOST_JOINTS
LIMIT_VELOCITY = LIMIT_UPPER + MOST_JOINTS
LIMIT_ACCELERATION, LIMIT_JERK = LIMIT_VELOCITY + MOST_JOINTS, LIMIT_VELOCITY + 2 * MOST_JOINTS
LIMIT = LIMIT_JERK + MOST_JOINTS

# Where the tool is at an instant or along an interval.
POINT_T0, POINT_T1, POINT_FRAME, POINT_LINK = range(4)
POINT_TOOL, POINT_TARGET = 4, 8  # (4) poses on the link and on the frame
POINT_MIDDLE, POINT_HEIGHT = 12, 13  # middle of the heights, and half their range (-1: the height is at its target)
POINT_POSITION, POINT_YAW = 14, 15  # greatest errors; yaw -1: nothing is claimed of it
POINT_RATE = 16  # (2) greatest errors of the velocity and of the yaw's rate; -1: nothing is claimed
POINT = 18

# The velocity of a point of a link as a frame has it (order 1; frame -1: the world), or its acceleration in the world
# (order 2, frame -1): how long that vector is, from LEAST to MOST. Here, in axes and in sums: where a motion jumps, an
# instant is in the piece that begins there, and an interval has both of its ends in its own pieces.
RATE_T0, RATE_T1, RATE_LINK, RATE_POINT, RATE_FRAME, RATE_ORDER, RATE_LEAST, RATE_MOST = 0, 1, 2, 3, 6, 7, 8, 9
RATE = 10

# Bounds of a scalar product. Its first vector is an axis of a link, or, if PLACE is 1, the way from the origin of OTHER
# to a point of that link. Its second vector is a direction of OTHER: another link of arm 0, or the world (-1).
AXIS_T0, AXIS_T1, AXIS_LINK, AXIS_PLACE, AXIS_ON = 0, 1, 2, 3, 4
AXIS_OTHER, AXIS_DIRECTION, AXIS_LOW, AXIS_HIGH = 7, 8, 11, 12
AXIS = 13

# Bounds of a sum of shares of the joints of arm 0 (order 0), or of its derivative of that order (1, 2, 3), at a time of
# its motion.
SUM_T0, SUM_T1, SUM_ORDER, SUM_SHARE = 0, 1, 2, 3
SUM_LOW, SUM_HIGH = SUM_SHARE + MOST_JOINTS, SUM_SHARE + MOST_JOINTS + 1
SUM = SUM_HIGH + 1

# A guide: the tool is within MOST of A + s (B - A), where A and B are points of two frames, and s goes evenly from one
# share to the other over the interval. At an instant both shares are the same.
GUIDE_T0, GUIDE_T1, GUIDE_LINK, GUIDE_TOOL = 0, 1, 2, 3
GUIDE_FRAME, GUIDE_FROM, GUIDE_TO = 6, 8, 11  # both frames; (3) A in the first; (3) B in the second
GUIDE_SHARE, GUIDE_MOST = 14, 16  # (2) s at both ends; m (less than 0: never kept)
GUIDE = 17

# Two bodies are no farther apart than MOST at an instant, if nothing is uncertain. Up to four directions (from the
# first to the second), each with the weight of the points of both pieces that are farthest along it (of the second:
# farthest the other way): the sums of these points with these weights are so near. Weights are not negative; their sum
# is 1 (within 1e-9, and they are divided by it). PIECE counts from the first piece of its body, as in rows. Directions
# have any length, and choose points, no more: every point of a piece would do. With a unit direction, where an edge is
# perpendicular to it within 1e-9 m, or the disc within a sine of 1e-9, their middle counts; of vertices the first one
# that no other exceeds by 1e-9 m. The time is in the phase, ends included.
DISTANCE_TIME, DISTANCE_PHASE, DISTANCE_BODY, DISTANCE_PIECE, DISTANCE_MOST = 0, 1, 2, 4, 6
DISTANCE_WEIGHT, DISTANCE_DIRECTION = 7, 11
DISTANCE = 23

# How far the tool may be from its point at an instant, whatever the claim leaves uncertain. How far it is if nothing is
# uncertain counts, too, but not how it is turned then: YAW is what uncertain things turn, and on a link that tilts, lag
# turns nothing. The time is in the phase, ends included.
ERROR_TIME, ERROR_PHASE, ERROR_FRAME, ERROR_LINK = range(4)
ERROR_TOOL, ERROR_TARGET = 4, 8  # (4) poses on the link and on the frame
ERROR_OFF = 12  # by how much the point may be off its place in every horizontal direction, up or down, and turned
ERROR_ARM = 15  # how far a yaw moves what counts, m for each rad
ERROR_FAR, ERROR_FLAT, ERROR_UP, ERROR_YAW = 16, 17, 18, 19  # greatest distance; horizontally; up or down; yaw
ERROR = 20

# A row of the proof: where to look for it. Nothing in a row has to be believed.
ROW_T0, ROW_T1, ROW_S0, ROW_S1 = range(4)  # its time, and how far the second body is ahead of the clock
ROW_BODY, ROW_PIECE, ROW_NORMAL = 4, 6, 8  # both bodies; a piece of each (-1: the box that holds all); (3) the normal
# A row of one body: the second body and its piece are -1, its s0 and s1 are 0. Over its interval the first body is
# behind a plane with this normal. For each pair of its phase that needs no time differences, and whose other body B is
# on a frame that never moves, it counts as a row for all pieces of B if the plane that touches the box of B, less what
# is required (N8), is beyond the first body. Such a row is never wrong; it may show no pair. None is in `gap_rows`.
ROW = 11


class Claim(NamedTuple):
    """All tables of a claim. Tables are shared between claims: nobody writes to them."""

    arms: FloatArray
    knots: FloatArray
    angles: FloatArray
    links: FloatArray
    loops: FloatArray
    frames: FloatArray
    laws: FloatArray
    waves: FloatArray
    displaced: FloatArray
    bodies: FloatArray
    pieces: FloatArray
    vertices: FloatArray
    triangles: FloatArray
    seats: FloatArray
    phases: FloatArray
    seated: FloatArray  # (phases, bodies): the row in `seats` of each body
    off: FloatArray  # (phases, 2 bodies): how far each body may be off its seat, horizontally; then up or down
    shares: FloatArray  # (phases, 2 frames): least share of the tool in each frame's displacement; then the greatest
    contacts: FloatArray
    put_down: FloatArray
    supports: FloatArray  # (put_down, bodies)
    rules: FloatArray
    self_pairs: FloatArray  # (links of arm 0, the same): 1 if bodies on both links must keep apart
    required: FloatArray
    limits: FloatArray
    points: FloatArray
    rates: FloatArray
    axes: FloatArray
    sums: FloatArray
    guides: FloatArray
    distances: FloatArray
    errors: FloatArray
    rows: FloatArray
    gap_rows: FloatArray  # with the columns of `rows`: where to look for the second distance


FARTHEST_M, SEATED_M, LAST_S = 100.0, 1e4, 1e7
"""Greatest size in a body or an arm, m; greatest place in a frame, which a conveyor that has run for long takes with it
(`planner.laws.law.FARTHEST_PLACE_M`), m; greatest time, s. The bounds of rounding hold for no more."""
LATEST_S = 1e5
"""Until when motions of frames without a period, and those of other arms, are stated, s."""
FASTEST, GREATEST, LIMITLESS = 1e6, 1e9, 1e300
"""Greatest place and rate of a frame; any other number; a limit that does not bind."""

BOUNDS: tuple[tuple[str, int, int, float, float | str], ...] = (
    ("arms", ARM_JOINTS, 1, 1, "joints"),
    ("arms", ARM_LOOP, 1, -1, "loops"),
    ("knots", KNOT_TIME, 1, -LAST_S, LAST_S),
    ("knots", KNOT_Q, MOST_JOINTS, -1e3, 1e3),
    ("knots", KNOT_QD, 2 * MOST_JOINTS, -GREATEST, GREATEST),
    ("angles", 0, ANGLE, -1e3, 1e3),
    ("links", LINK_OFFSET, 3, -FARTHEST_M, FARTHEST_M),
    ("links", LINK_AXIS, 3, -1.5, 1.5),
    ("links", LINK_COUPLER, 1, -1, "flag"),
    ("loops", LOOP_LENGTH, 4, -FARTHEST_M, FARTHEST_M),
    ("loops", LOOP_SIDE, 1, -1.0, 1.0),
    ("loops", LOOP_LEAST, 1, 1e-6, 1.0),
    ("loops", LOOP_BETWEEN, 1, 0, "angles"),
    ("frames", FRAME_ARM, 1, -1, "arms"),
    ("frames", FRAME_LINK, 1, -1, "links"),
    ("frames", FRAME_POSE, 8, -FASTEST, FASTEST),
    ("frames", FRAME_SHIFT, 2, -LAST_S, LAST_S),
    ("frames", FRAME_YAW, 1, 0.0, GREATEST),
    ("frames", FRAME_PERIOD, 1, 0.0, LAST_S),
    ("frames", FRAME_STEP, 4, -FASTEST, FASTEST),
    ("laws", LAW_BEGIN, 2, -LATEST_S, LATEST_S),
    ("laws", LAW_POWER, 4 * MOST_POWERS, -LIMITLESS, LIMITLESS),
    ("waves", WAVE_COORDINATE, 1, 0, "coordinates"),
    ("waves", WAVE_AMPLITUDE, 3, -GREATEST, GREATEST),
    ("displaced", DISPLACED_FRAME, 1, 0, "frames"),
    ("displaced", DISPLACED_LEVEL, 1, 0, "flag"),
    ("displaced", DISPLACED_SHARED, 1, 0, "flag"),
    ("displaced", DISPLACED_DIRECTION, 3, -GREATEST, GREATEST),
    ("displaced", DISPLACED_AMOUNT, 2, 0.0, GREATEST),
    ("pieces", PIECE_CENTRE, 6, -FARTHEST_M, FARTHEST_M),
    ("pieces", PIECE_DISC, 2, 0.0, FARTHEST_M),
    ("pieces", PIECE_EDGES, 1, 0, "edges"),
    ("pieces", PIECE_EDGE, 3 * MOST_EDGES, -FARTHEST_M, FARTHEST_M),
    ("vertices", 0, 3, -FARTHEST_M, FARTHEST_M),
    ("triangles", TRIANGLE_VERTEX, 3, 0, "vertices"),
    ("triangles", TRIANGLE_PIECE, 1, 0, "pieces"),
    ("seats", SEAT_BODY, 1, 0, "bodies"),
    ("seats", SEAT_LINK, 1, -1, "own links"),
    ("seats", SEAT_FRAME, 1, -1, "frames"),
    ("seats", SEAT_POSE, 4, -SEATED_M, SEATED_M),
    ("phases", PHASE_T0, 2, -LAST_S, LAST_S),
    ("phases", PHASE_NEAR, 2, 0, "flag"),
    ("seated", 0, -1, 0, "seats"),
    ("off", 0, -1, 0.0, GREATEST),
    ("shares", 0, -1, -GREATEST, GREATEST),
    ("contacts", CONTACT_PHASE, 1, 0, "phases"),
    ("contacts", CONTACT_BODY, 2, 0, "bodies"),
    ("contacts", CONTACT_DEPTH, 1, 0.0, GREATEST),
    ("put_down", PUT_PHASE, 1, 0, "phases"),
    ("put_down", PUT_BODY, 1, 0, "bodies"),
    ("supports", 0, -1, 0, "flag"),
    ("rules", RULE_TRAVEL, 2, 0.0, GREATEST),
    ("rules", RULE_SIDE, -1, 0, "flag"),
    ("self_pairs", 0, -1, 0, "flag"),
    ("required", REQUIRED_TRAVEL, 2, 0.0, GREATEST),
    ("required", REQUIRED_UNTIL, 1, -LAST_S, LAST_S),
    ("required", REQUIRED_LATE, 1, 0.0, LAST_S),
    ("required", REQUIRED_SINCE, 1, -LAST_S, LAST_S),
    ("required", REQUIRED_TOOL, 1, 0, "own links"),
    ("required", REQUIRED_LAG, MOST_JOINTS, 0.0, 1e3),
    ("required", REQUIRED_NEAREST, 2, -1.0, LIMITLESS),
    ("limits", LIMIT_T0, 2, -GREATEST, GREATEST),
    ("limits", LIMIT_JERKS, 1, 0, "flag"),
    ("limits", LIMIT_SHARE, 4, 0.0, 1.0),
    ("limits", LIMIT_LOWER, 5 * MOST_JOINTS, -LIMITLESS, LIMITLESS),
    ("points", POINT_T0, 2, -LAST_S, LAST_S),
    ("points", POINT_FRAME, 1, 0, "frames"),
    ("points", POINT_LINK, 1, 0, "own links"),
    ("points", POINT_TOOL, 4, -FARTHEST_M, FARTHEST_M),
    ("points", POINT_TARGET, 4, -SEATED_M, SEATED_M),
    ("points", POINT_MIDDLE, 1, -GREATEST, GREATEST),
    ("points", POINT_HEIGHT, 1, -1.0, GREATEST),
    ("points", POINT_POSITION, 1, 0.0, GREATEST),
    ("points", POINT_YAW, 3, -1.0, GREATEST),
    ("rates", RATE_T0, 2, -LAST_S, LAST_S),
    ("rates", RATE_LINK, 1, 0, "own links"),
    ("rates", RATE_POINT, 3, -FARTHEST_M, FARTHEST_M),
    ("rates", RATE_FRAME, 1, -1, "frames"),
    ("rates", RATE_ORDER, 1, 1, "orders"),
    ("rates", RATE_LEAST, 2, 0.0, GREATEST),
    ("axes", AXIS_T0, 2, -LAST_S, LAST_S),
    ("axes", AXIS_LINK, 1, 0, "own links"),
    ("axes", AXIS_PLACE, 1, 0, "flag"),
    ("axes", AXIS_ON, 3, -FARTHEST_M, FARTHEST_M),
    ("axes", AXIS_OTHER, 1, -1, "own links"),
    ("axes", AXIS_DIRECTION, 3, -1.5, 1.5),
    ("axes", AXIS_LOW, 2, -GREATEST, GREATEST),
    ("sums", SUM_T0, 2, -LAST_S, LAST_S),
    ("sums", SUM_ORDER, 1, 0, "derivatives"),
    ("sums", SUM_SHARE, MOST_JOINTS, -1e3, 1e3),
    ("sums", SUM_LOW, 2, -GREATEST, GREATEST),
    ("guides", GUIDE_T0, 2, -LAST_S, LAST_S),
    ("guides", GUIDE_LINK, 1, 0, "own links"),
    ("guides", GUIDE_TOOL, 3, -FARTHEST_M, FARTHEST_M),
    ("guides", GUIDE_FRAME, 2, 0, "frames"),
    ("guides", GUIDE_FROM, 6, -SEATED_M, SEATED_M),
    ("guides", GUIDE_SHARE, 2, 0.0, 1.0),
    ("guides", GUIDE_MOST, 1, -GREATEST, GREATEST),
    ("distances", DISTANCE_TIME, 1, -LAST_S, LAST_S),
    ("distances", DISTANCE_PHASE, 1, 0, "phases"),
    ("distances", DISTANCE_BODY, 2, 0, "bodies"),
    ("distances", DISTANCE_PIECE, 2, 0, "pieces"),
    ("distances", DISTANCE_MOST, 1, 0.0, GREATEST),
    ("distances", DISTANCE_WEIGHT, 4, 0.0, 1.5),
    ("distances", DISTANCE_DIRECTION, 12, -GREATEST, GREATEST),
    ("errors", ERROR_TIME, 1, -LAST_S, LAST_S),
    ("errors", ERROR_PHASE, 1, 0, "phases"),
    ("errors", ERROR_FRAME, 1, 0, "frames"),
    ("errors", ERROR_LINK, 1, 0, "own links"),
    ("errors", ERROR_TOOL, 4, -FARTHEST_M, FARTHEST_M),
    ("errors", ERROR_TARGET, 4, -SEATED_M, SEATED_M),
    ("errors", ERROR_OFF, 8, 0.0, GREATEST),
    ("rows", ROW_T0, 4, -LAST_S, LAST_S),
    ("rows", ROW_BODY, 1, 0, "bodies"),
    ("rows", ROW_BODY + 1, 1, -1, "bodies"),
    ("rows", ROW_NORMAL, 3, -GREATEST, GREATEST),
    ("gap_rows", ROW_T0, 4, -LAST_S, LAST_S),
    ("gap_rows", ROW_BODY, 2, 0, "bodies"),
    ("gap_rows", ROW_NORMAL, 3, -GREATEST, GREATEST),
)
"""What columns may hold: table, first column, how many (-1: all that follow), least and greatest number. A name in
place of the greatest: these are indices of that table's rows, or one of `RANGES`."""
RANGES = {
    "flag": 2.0,
    "joints": MOST_JOINTS + 1.0,
    "edges": MOST_EDGES + 1.0,
    "coordinates": 4.0,
    "orders": 3.0,
    "derivatives": 4.0,
}
"""Columns of these kinds hold whole numbers below this."""
WIDTHS = {
    "arms": ARM,
    "knots": KNOT,
    "angles": ANGLE,
    "links": LINK,
    "loops": LOOP,
    "frames": FRAME,
    "laws": LAW,
    "waves": WAVE,
    "displaced": DISPLACED,
    "bodies": BODY,
    "pieces": PIECE,
    "vertices": 3,
    "triangles": TRIANGLE,
    "seats": SEAT,
    "phases": PHASE,
    "contacts": CONTACT,
    "put_down": PUT,
    "required": REQUIRED,
    "limits": LIMIT,
    "points": POINT,
    "rates": RATE,
    "axes": AXIS,
    "sums": SUM,
    "guides": GUIDE,
    "distances": DISTANCE,
    "errors": ERROR,
    "rows": ROW,
    "gap_rows": ROW,
}
"""Number of columns of each table whose width does not depend on the claim."""


def table(name: str, rows: Sequence[Sequence[float]]) -> FloatArray:
    """Rows as the table of this name, (rows, WIDTHS[name])."""
    return np.array(rows, dtype=float).reshape(-1, WIDTHS[name])
