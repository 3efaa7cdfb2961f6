"""The tables that rules read: times, the state of the arm, and the parts that are known."""

from __future__ import annotations

from typing import NamedTuple

from assur.planner.arrays import FloatArray
from assur.planner.compiled import types

LANE_BEGIN, LANE_STEP, LANE_ENTERS, LANE_LEAVES, LANE = range(5)
"""Of a lane, s: the first instant of its grid and the time between two; between which it can be met. Each counts from
the instant at which a part passes the lane's mark."""
PLACE_BEGIN, PLACE_STEP, PLACE_LEAVES, PLACE_PERIOD, PLACE_SLOTS, PLACE = range(6)
"""Of a place: the first point of its grid and the difference of two; up to which it can be met; the time between two
slots that pass, s, and how many slots it has. What rests has a period of 0, and its grid counts its slots from 0. What
moves has one slot for each period, and its grid is the time since the slot passed the mark, s."""
RIDE_PICK, RIDE_PLACE, NOMINAL, RIDES = range(4)
"""How long the tool keeps to a part that it picks, and to a slot that it fills, s: down, dwell, up; the mean time of a
cycle."""
ARM_TIME, ARM_PLACE, ARM_WAY, ARM_MODE, ARM_SLOT = range(5)
"""The arm when it is free: since when, s, at which place, where on its grid, in which working mode; from there on one
column for each place: its next free slot."""
PART_LANE, PART_PASSED, PART_PLACE, PART = range(4)
"""A part: its lane, when it passes the lane's mark, s, and the place that it is for. Parts are in the order in which
they were seen."""
UNREACHED = 1e9
"""In place of a time to or from a state that is out of reach, s."""


class Times(NamedTuple):
    """Times without obstacles for P places with U points, L lanes with S instants, and E working modes, s."""

    there: FloatArray  # (P, U, E, L, E, S): from a place to a part
    back: FloatArray  # (L, E, S, P, U, E): from a part to a place
    lanes: FloatArray  # (L, LANE)
    places: FloatArray  # (P, PLACE)
    rides: FloatArray  # (1, RIDES)
    lane_points: FloatArray  # (L, 2, S): where parts are, x and y, m, world
    place_points: FloatArray  # (P, 2, U)


f8, i8 = types.float64, types.int64
F1, F2, F3 = f8[::1], f8[:, ::1], f8[:, :, ::1]
F6 = f8[:, :, :, :, :, ::1]
TIMES = types.NamedTuple((F6, F6, F2, F2, F2, F3, F3), Times)
