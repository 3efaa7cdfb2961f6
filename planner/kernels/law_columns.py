"""Columns of the tables of laws: a row for each law, and a side table with its pieces and its sines.

A law gives x, y, z and yaw of a frame. On a piece of time, with u the time since its begin (F0):

    x(t) = pose + rate u + Σ a_k u^(k+2) / ((k+1) (k+2)),   k = 0, 1, ...

so that Σ a_k u^k is the acceleration; sines of the clock are added to that. Units are m, rad and s.
"""

from __future__ import annotations

MOST_POWERS = 12
"""Powers of an acceleration for which a piece has room."""

LINKED = 0
"""1: the frame is a link of another robot, and its row has the columns below `LINK`."""
FIRST, LAST = 1, 2
"""Times between which the law is known, s. Nothing is extrapolated."""
BEGIN, COUNT = 3, 4
"""First row and number of pieces. The first piece holds before its begin, too, and the last one after its end, except
in a law that repeats."""
POWERS = 5
"""The greatest number of powers in any piece."""
WAVE, WAVES = 6, 7
"""First row and number of sines."""
MOVES, TURNS = 8, 11
"""Whether x, y, z and yaw may change (4; the last one is `TURNS`)."""
COS, SIN = 12, 13
"""Cosine and sine of a yaw that does not change."""
START, PERIOD = 14, 15
"""When a period begins, and how long it is; 0: the law does not repeat. Pieces of one that does count from there."""
STEP = 16
"""By how much x, y, z and yaw have gone on after a period (4)."""
WHOLE = 20
"""Whether the yaw goes on by whole turns, which place nothing."""
LINE, AXIS = 21, 24
"""Unit vector of the only line along which the frame travels (3; zeros: it has none), and its greatest coordinate."""
SLACK = 25
"""What is added to bounds, for rounding: of speed, acceleration, yaw rate and yaw acceleration (4)."""
LINK = 29
"""Number of the link. `BEGIN` and `COUNT` are then the first row of its run of numbers (`laws.trajectory_of`), and its
number of pieces."""
LAW_COLUMNS = 30

PIECE_BEGIN, PIECE_END = 0, 1
"""The time of a piece."""
POSE, RATE = 2, 6
"""x, y, z and yaw, and their rates, at its begin (4 each)."""
CORNER, CORNERS = 10, 4
"""Times since the begin at which the acceleration or the jerk of a coordinate is zero; between two of them velocity and
acceleration are monotonic. Infinite: none."""
POWER = 14
"""Accelerations of x, y, z and yaw: `MOST_POWERS` numbers each."""
PIECE_COLUMNS = POWER + 4 * MOST_POWERS

WAVE_COORDINATE, WAVE_AMPLITUDE, WAVE_RATE, WAVE_PHASE = range(4)
"""A sine, as a row of the same table: amplitude sin(rate t + phase) is added to a coordinate."""
