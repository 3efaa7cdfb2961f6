"""Which bodies must stay how far apart in phases of one kind (equation N8), from the tables of the claim.

Errors that two bodies have in common do not part them: the bodies on a belt are off by one error, and a controller that
corrects for it shifts the tool by the same. So a body has a share in each displacement of a frame: all of it on that
frame, the tool as much as the claim says, all else none. What counts of a pair is the greatest difference of both
shares.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.claim import columns as c
from assur.planner.compiled import kernel
from assur.planner.kernels.solids import (
    EARLY,
    FIRST,
    LATE,
    NUMBERS,
    PAIR_COLUMNS,
    REQUIRED,
    ROW,
    SECOND,
    SET,
    TABLE,
)
from assur.planner.kernels.uncertainty import (
    FLAT,
    FLAT_GROWTH,
    SEGMENT,
    SEGMENTS,
    SET_COLUMNS,
    UPRIGHT,
    UPRIGHT_GROWTH,
)

TRAVEL, NEAR, EXCEPTION, CONTACT = range(4)
"""What says how far apart a pair must stay."""

SEATED = f"Tuple(({TABLE}, {NUMBERS}, {ROW}))"
Seated = tuple[FloatArray, IntArray, FloatArray]
"""Of bodies: seats (B, c.SEAT), first units (B,), and radii (B,), m."""
FRAMES = f"Tuple(({NUMBERS}, {ROW}, {TABLE}))"
Frames = tuple[IntArray, FloatArray, FloatArray]
"""Of frames: which stand still for ever, 1 (F,); by how much each may be turned, rad (F,); how late each may be, at
least and at most, s (2, F)."""
DISTANCES = f"Tuple(({TABLE}, {ROW}, {TABLE}, {TABLE}))"
Distances = tuple[FloatArray, FloatArray, FloatArray, FloatArray]
"""Tables of the claim: `self_pairs`, the row of `required`, `rules`, and `displaced`."""
STORY = f"Tuple(({ROW}, {ROW}, {TABLE}, {TABLE}, {TABLE}))"
Story = tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]
"""Tables of the claim for one phase: the rows of `off` and `shares`, `contacts`, `put_down`, and `supports`."""


@kernel(f"void({TABLE}, {TABLE}, {TABLE}, {TABLE}, int64, int64, {ROW})")
def write_set(
    off: FloatArray, least: FloatArray, most: FloatArray, displaced: FloatArray, one: int, other: int, row: FloatArray
) -> None:
    """Writes what two bodies may be displaced against each other, a row of `kernels.uncertainty`. `off` (2, B): how far
    each is off, horizontally and vertically, m; `least`, `most` (D, B): its share in each displacement."""
    row[:], free = 0.0, SEGMENTS
    row[FLAT], row[UPRIGHT] = off[0, one] + off[0, other], off[1, one] + off[1, other]
    for d in range(len(displaced)):
        share = max(abs(most[d, one] - least[d, other]), abs(least[d, one] - most[d, other]))
        amount, growth = share * displaced[d, c.DISPLACED_AMOUNT], share * displaced[d, c.DISPLACED_GROWTH]
        direction, level = displaced[d, c.DISPLACED_DIRECTION : c.DISPLACED_AMOUNT], displaced[d, c.DISPLACED_LEVEL] > 0
        aside = direction[0] != 0.0 or direction[1] != 0.0
        if share > 0.0 and free < SET_COLUMNS and aside and not level:
            row[free], row[free + 1] = amount, growth
            for axis in range(3):
                row[free + 2 + axis] = direction[axis]
            free += SEGMENT
            continue
        # more than there is room for: in every direction
        if level or aside:
            row[FLAT] += amount
            row[FLAT_GROWTH] += growth
        if not level:
            row[UPRIGHT] += amount * abs(direction[2])
            row[UPRIGHT_GROWTH] += growth * abs(direction[2])


@kernel(f"int64({TABLE}, int64, {ROW})")
def number_of(sets: FloatArray, many: int, row: FloatArray) -> int:
    """Which of the first `many` sets a row is; `many` where it is none of them."""
    for k in range(many):
        same = 0
        while same < len(row) and sets[k, same] == row[same]:
            same += 1
        if same == len(row):
            return k
    return many


@kernel(
    f"Tuple(({TABLE}, {NUMBERS}, {TABLE}, int64, int64))({SEATED}, {FRAMES}, {DISTANCES}, {STORY}, boolean, boolean)",
    allocates=True,
)
def pairs_of_phase(
    seated: Seated, frames: Frames, distances: Distances, story: Story, near: bool, robot: bool
) -> tuple[FloatArray, IntArray, FloatArray, int, int]:
    """What must be kept apart in a phase, `near` a control point or not; where it is not of the `robot`, only parts
    that were put down with what passes by.

    Returns (P, PAIR_COLUMNS) pairs of first units, what says how far each must stay apart (P,), and the different sets
    (N, SET_COLUMNS) of displacements. The robot's bodies with all of the surroundings come first, then those within the
    robot: the last two numbers say how many the former are, and both.
    """
    seats, roots, radii = seated
    still, turned, late = frames
    self_pairs, required, rules, displaced = distances
    every, shares, contacts, put_down, supports = story
    many, bodies, count = 0, len(seats), len(still)
    link, frame = seats[:, c.SEAT_LINK].astype(np.int64), seats[:, c.SEAT_FRAME].astype(np.int64)
    moves = np.zeros(bodies, np.bool_)
    off, least, most = np.empty((2, bodies)), np.zeros((len(displaced), bodies)), np.zeros((len(displaced), bodies))
    uncertain = len(displaced) > 0 or every.any() or turned.any()
    for b in range(bodies):
        off[0, b], off[1, b] = every[b], every[bodies + b]
        if link[b] < 0:
            moves[b] = still[frame[b]] == 0
            far = math.hypot(seats[b, c.SEAT_POSE], seats[b, c.SEAT_POSE + 1]) + radii[b]
            off[0, b] += turned[frame[b]] * far
        for d in range(len(displaced)):
            f, tool = int(displaced[d, c.DISPLACED_FRAME]), seats[b, c.SEAT_LINK] >= required[c.REQUIRED_TOOL]
            if frame[b] == f:
                least[d, b] = most[d, b] = 1.0
            elif tool:
                least[d, b] = shares[f] * displaced[d, c.DISPLACED_SHARED]
                most[d, b] = shares[count + f] * displaced[d, c.DISPLACED_SHARED]

    # the bodies of each pair
    arms = int((link >= 0).sum())
    pairs = np.zeros(((arms + len(put_down)) * bodies, PAIR_COLUMNS))
    for a in range(bodies):
        for b in range(bodies):
            if robot and link[a] >= 0 and link[b] < 0:
                pairs[many, FIRST], pairs[many, SECOND], many = a, b, many + 1
    across = many
    for a in range(bodies):
        for b in range(a + 1, bodies):
            within = link[a] >= 0 and link[b] >= 0 and link[a] != link[b]
            if robot and within and self_pairs[link[a], link[b]] > 0.0:
                pairs[many, FIRST], pairs[many, SECOND], many = a, b, many + 1
    own = many
    for k in range(len(put_down)):
        # what does not move against a part, it was proved to stay clear of while it was put down
        part = int(put_down[k, c.PUT_BODY])
        for b in range(bodies):
            passes = link[b] < 0 and frame[b] != frame[part] and (moves[b] or moves[part])
            for before in range(k):
                passes = passes and b != int(put_down[before, c.PUT_BODY])
            if passes and supports[k, b] == 0.0:
                pairs[many, FIRST], pairs[many, SECOND], many = part, b, many + 1

    kinds, sets, different, row = np.empty(many, np.int64), np.empty((many, SET_COLUMNS)), 0, np.empty(SET_COLUMNS)
    for p in range(many):
        one, other, close = int(pairs[p, FIRST]), int(pairs[p, SECOND]), near or p >= own
        pairs[p, REQUIRED] = required[c.REQUIRED_NEAR if close else c.REQUIRED_TRAVEL]
        kinds[p] = NEAR if close else TRAVEL
        for rule in range(len(rules)):  # of those that name a pair the last counts
            side, across_side = rules[rule, c.RULE_SIDE :], rules[rule, c.RULE_SIDE + bodies :]
            if (side[one] > 0.0 and across_side[other] > 0.0) or (side[other] > 0.0 and across_side[one] > 0.0):
                pairs[p, REQUIRED] = rules[rule, c.RULE_NEAR if close else c.RULE_TRAVEL]
                kinds[p] = EXCEPTION
        for k in range(len(contacts)):
            first, second = int(contacts[k, c.CONTACT_BODY]), int(contacts[k, c.CONTACT_BODY + 1])
            if (one == first and other == second) or (one == second and other == first):
                pairs[p, REQUIRED], kinds[p] = -contacts[k, c.CONTACT_DEPTH], CONTACT
        if moves[other]:
            # the robot may start late, and then all else is ahead of it while it moves
            from_s, to_s = 0.0, required[c.REQUIRED_LATE]
            if link[one] < 0:
                from_s, to_s = late[0, frame[one]], late[1, frame[one]]
            pairs[p, EARLY], pairs[p, LATE] = from_s - late[1, frame[other]], to_s - late[0, frame[other]]
        pairs[p, SET] = -1.0
        if uncertain:
            write_set(off, least, most, displaced, one, other, row)
            number = number_of(sets, different, row)
            # with a set, also with an empty one, the coarse score of a motion tries other normals
            if p < across or row.any():
                pairs[p, SET] = number
            if number == different:
                sets[different] = row
                different += 1
        pairs[p, FIRST], pairs[p, SECOND] = roots[one], roots[other]
    return pairs[:many], kinds, sets[:different], across, own
