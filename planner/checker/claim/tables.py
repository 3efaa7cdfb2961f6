"""The tables that the checker computes from a claim, as named tuples, and their columns; import it as one name.

A *carrier* is a link or a frame: what bodies sit on. Links come first, then frames.
"""

from __future__ import annotations

from typing import NamedTuple

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.claim import columns as c
from assur.planner.claim.columns import Claim
from assur.planner.compiled import types

ULP = 2.0**-52
SLACK = 1e-9
"""The one slack, in m, rad, m/s, rad/s, m/s² or as a pure number. It is taken off each gap and each error that is
claimed, for the rounding of its own sums. What motions round by is bounded for each carrier (`Geometry.rounds`)."""
DEEPEST = 24
"""Halvings of one interval, after which it is refused."""
INSTANTS, INTERVALS = 6, 3
"""How many instants, and intervals, are kept of each carrier. One row needs four and two."""
NOT_GIVEN, TOO_WIDE, KNOWN, NOT_KEPT = range(4)
"""Of a carrier over a time: its motion is not given; its loop may come apart on an interval of this length; known; not
computed yet, or replaced since."""
POWERS, LAW_POWERS = 6, c.MOST_POWERS + 2
"""Coefficients of a quintic, and of a coordinate of a law."""
TOUCHED = LAW_POWERS + 1
"""Where `Scratch.work` counts pieces of motions."""
CURVE_BEGIN, CURVE_END, CURVE_DEGREE, CURVE_POWER = range(4)
CURVE, LAW_ERROR = CURVE_POWER + POWERS * c.MOST_JOINTS, CURVE_POWER + 4 * LAW_POWERS
LAW_CURVE = LAW_ERROR + 5
"""Pieces of laws have room for the errors of one coordinate."""
CARRIER_ARM, CARRIER_FRAME, CARRIER_UPRIGHT, CARRIER_FIXED, CARRIER_FIRST, CARRIER = range(6)
"""Arm and frame (-1: none), whether it turns about the vertical only, whether it never moves; the first link of its
arm, or itself."""
ROUND_PLACE, ROUND_TURN, ROUNDS = 0, 1, 6
"""By how much a place (m) and a column of the rotation (rad) round; the same for rates and second derivatives follows,
two columns for each order."""
SOLID_CENTRE, SOLID_AXIS, SOLID_DISC, SOLID_BALL = 0, 3, 6, 7
SOLID_VERTEX, SOLID_VERTICES, SOLID_EDGES, SOLID_EDGE = 8, 9, 10, 11
SOLID_REACH, SOLID_SIZE, SOLID = 29, 30, 31
"""A piece in the axes of its carrier, with the columns of `pieces`; its greatest distance (m) from the carrier's
vertical axis, and from its origin."""
PAIR_PHASE, PAIR_A, PAIR_B, PAIR_DISTANCE, PAIR_EARLY, PAIR_LATE = range(6)
PAIR_VARIES, PAIR_TOUCHES, PAIR_CERTAIN, PAIR_NEEDED, PAIR = range(6, 11)
"""Two bodies that must keep apart in a phase, and how far, m (less than 0: how deep they may touch); from which time to
which the second is ahead of the clock, s; whether what is required depends on the interval (lag, corrections), so that
an interval that is too long decides nothing; whether they may touch; whether nothing is uncertain; whether rows must
show the distance."""
SIDE_SOLID, SIDE_CARRIER, SIDE_SEAT, SIDES = 0, 1, 2, 3
OBJECT_NORMAL, OBJECT_PAIR, OBJECT_PLANE, OBJECT = 2 * SIDES, 2 * SIDES + 3, 2 * SIDES + 4, 2 * SIDES + 5
"""What a row is about: solid, carrier and seat of both sides, one behind the other; a unit normal; the row in `pairs`
(-1: no pair needs it); the phase of a row of one body (-1: it has two, or is not within one phase)."""
WORK, HALVINGS, DEPTH, FAILED, PAIRS, ROWS, AMOUNT, VARIES, STATE = range(9)
"""Numbers of a check: work that is left; halvings of rows, and the deepest; the row that failed; how many pairs must
keep apart, and how many rows they need; by how much what failed last exceeds what is claimed (NaN: no number);
more than 0: what is required of pairs depends on the interval."""


class Geometry(NamedTuple):
    """What is computed of a claim before anything is checked."""

    curves: FloatArray  # CURVE_... and powers of each joint, of all arms one behind the other
    spans: FloatArray  # (arms, 2): first row in `curves`, and how many
    laws: FloatArray  # CURVE_... and powers of x, y, z, yaw; LAW_ERROR
    carriers: FloatArray  # CARRIER_...
    on: FloatArray  # (frames, 1): carrier of a frame
    rounds: FloatArray  # (carriers, ROUNDS)
    solids: FloatArray  # SOLID_...
    vertices: FloatArray  # (vertices of all seats, 3): in the axes of their carrier
    first: FloatArray  # (seats, 2): first row in `solids` and in `vertices`
    times: FloatArray  # (1, 2): from when to when motions of frames are evaluated


class Scratch(NamedTuple):
    """Where jets are computed and kept."""

    jets: FloatArray  # (slots, carriers, 12, 6): place, then the columns of the rotation
    known: FloatArray  # (slots, carriers, 3): from, to, and what is known
    turns: FloatArray  # (angles, 2, 6): cosine and sine
    four: FloatArray  # (2, 2, 6): cosine and sine of both couplers; or x, y, z, yaw of a frame
    joints: FloatArray  # (joints, 6)
    vectors: FloatArray  # (4, 3, 6): vectors of the tool and of frames
    way: FloatArray  # (3,): coordinates of a vector of a carrier
    work: FloatArray  # powers of one coordinate; the last number counts pieces of motions that were evaluated
    next_slot: FloatArray  # (carriers, 2): the slot that is replaced next, of instants and of intervals


class Proof(NamedTuple):
    """What must keep apart, and the rows that show it."""

    rows: FloatArray  # the table of rows
    numbers: IntArray  # (bodies,): a number for each body that is on a link or was put down; -1
    table: IntArray  # (phases, numbered bodies, bodies): the row in `pairs`; -1
    pairs: FloatArray  # PAIR_...
    objects: FloatArray  # (rows, OBJECT)
    order: IntArray  # (rows,): rows by begin and end
    links: IntArray  # (.., 2): of the rows of a pair, in the order of begins: the row, and the next link; -1
    heads: IntArray  # (pairs,): the first link of each pair; -1
    state: FloatArray  # (STATE,)


f8, i8 = types.float64, types.int64
F1, F2, F3, F4 = f8[::1], f8[:, ::1], f8[:, :, ::1], f8[:, :, :, ::1]
I1, I2, I3 = i8[::1], i8[:, ::1], i8[:, :, ::1]
JET, BALL = types.UniTuple(f8, 6), types.UniTuple(f8, 2)
CLAIM = types.NamedUniTuple(F2, len(Claim._fields), Claim)
GEOMETRY = types.NamedUniTuple(F2, len(Geometry._fields), Geometry)
SCRATCH = types.NamedTuple((F4, F3, F3, F3, F2, F3, F1, F1, F2), Scratch)
PROOF = types.NamedTuple((F2, I1, I3, F2, F2, I1, I2, I1, F1), Proof)
