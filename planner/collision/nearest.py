"""Where a plan comes closest to anything: a proved lower bound, within 0.05 mm of a distance that occurs."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import product
from typing import Literal, NamedTuple

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.collision.bodies import Arrangement
from assur.planner.collision.pairs import Pairs, certain
from assur.planner.collision.proof import Prover, Search
from assur.planner.geometry.containment import inside
from assur.planner.kernels.gjk import nearest_to_origin
from assur.planner.kernels.interval_search import NEAREST
from assur.planner.kernels.intervals import DONE, RESERVE_M, STATE_COLUMNS
from assur.planner.kernels.proof import SIDES
from assur.planner.kernels.screening import (
    HIT_A,
    HIT_B,
    HIT_GAP,
    HIT_NEED,
    HIT_PAIR,
    LOWER,
    NEAREST_A,
    NEAREST_B,
    NEAREST_T,
    UPPER,
    sample_distance,
)
from assur.planner.kernels.solids import BALL, DISC, FIRST, HALF, PAIR_COLUMNS, REQUIRED, SECOND, SET, VERTEX, VERTICES
from assur.planner.model.attachments import Attachments
from assur.planner.model.deadline import out_of_time, raise_if_late
from assur.planner.model.outcome import Nearest
from assur.planner.model.phases import Contacts, Phase, pair
from assur.planner.model.refusal import Enclosed, Separation
from assur.planner.model.scene import Scene
from assur.planner.trajectory import Trajectory

Kind = Literal["all", "arm", "placed"]
"""Which pairs count: all; those of the arm, its tool and what it holds; or those without a body of the arm, a part that
was put down and what moves against it."""
INSTANTS = 16
"""Instants of a phase at which a first distance is looked for: the nearer to the smallest, the shorter the search."""
NEARBY_M = 0.05
"""In a cell of many bodies those within this distance, m, of what the arm sweeps come first; if that is less than the
smallest clearance, those within several times as much."""
ROUNDED_M = 1e-9
"""More than a distance of two points is rounded by, m."""
MOST_CALLS = 50
"""Calls of the kernel for one phase: a search that is not over by then, or when the deadline in force passes, has no
lower value but 0."""


def nearest_pairs(prover: Prover, trajectory: Trajectory, phases: tuple[Phase, ...], most: int) -> tuple[Nearest, ...]:
    """The smallest clearance of each of the `most` pairs of the arm, its tool and what it holds that come nearest in
    these phases, nearest first: each is the smallest of all pairs but those before it."""
    found: list[Nearest] = []
    while len(found) < most:
        after = nearest(prover, trajectory, phases, frozenset(pair(*each.bodies) for each in found), of="arm")
        if after is None:
            break
        found.append(after)
    return tuple(found)


def nearest(
    prover: Prover,
    trajectory: Trajectory,
    phases: tuple[Phase, ...],
    without: frozenset[tuple[str, str]] = frozenset(),
    of: Kind = "all",
) -> Nearest | None:
    """The pair and time at which the distance is least over all of a motion. Allowed contacts do not count, nor pairs
    of names (in the order of `pair`) in `without`, nor those of another kind than `of`.

    None: there is nothing to keep apart.
    """
    state = np.zeros(STATE_COLUMNS)
    state[LOWER] = state[UPPER] = np.inf
    where: Phase | None = None
    for phase in phases:
        before = float(state[UPPER])
        _search(prover, trajectory, phase, state, without, of)
        if state[UPPER] < before:
            where = phase
    if where is None:
        return None
    arrangement = prover.of(where)
    one, other = arrangement.body[[int(state[NEAREST_A]), int(state[NEAREST_B])]].tolist()
    upper = float(state[UPPER])
    lower = max(0.0, min(float(state[LOWER]), upper))
    time = min(max(float(state[NEAREST_T]), where.t0), where.t1)  # instants are sums, which round
    return Nearest(lower, time, (arrangement.names[one], arrangement.names[other]), where.kind, upper)


def pairs_of_pieces(arrangement: Arrangement, bodies: Iterable[tuple[int, int]]) -> FloatArray:
    """The pairs (P, PAIR_COLUMNS) of all pieces of pairs of bodies; their required gap is 0."""
    units = [two for one, other in bodies for two in product(arrangement.pieces(one), arrangement.pieces(other))]
    found = np.zeros((len(units), PAIR_COLUMNS))
    found[:, FIRST : SECOND + 1], found[:, SET] = np.array(units).reshape(-1, 2), -1.0
    return found


def nearest_at(
    prover: Prover, arrangement: Arrangement, q: FloatArray, t: float, pairs: FloatArray
) -> tuple[float, tuple[int, int]]:
    """The smallest distance, m, of pairs of pieces (P, PAIR_COLUMNS) at time t with joints q (n,), and the two units
    that have it; infinite: the place of none is known."""
    state = np.zeros(STATE_COLUMNS)
    state[UPPER] = np.inf
    sample_distance(prover.motion(prover.standing(q, t)), arrangement.cell, pairs, t, t, 1, state)
    return float(state[UPPER]), (int(state[NEAREST_A]), int(state[NEAREST_B]))


def _counted(
    arrangement: Arrangement, every: Pairs, without: frozenset[tuple[str, str]], of: Kind
) -> FloatArray:  # fmt: skip
    """The rows of pairs of a kind that may not touch and whose bodies are not in `without`, where all is where it is
    planned."""
    rows = every.rows if of == "all" else every.rows[: every.own] if of == "arm" else every.rows[every.own :]
    if not len(rows):
        return rows
    pairs = certain(rows[rows[:, REQUIRED] >= 0.0])
    if without:
        bodies = arrangement.body[pairs[:, FIRST : SECOND + 1].astype(np.int64)].tolist()
        names = [[arrangement.names[body] for body in two] for two in bodies]
        pairs = pairs[np.array([pair(*two) not in without for two in names], dtype=np.bool_)]
    return pairs


def _search(
    prover: Prover,
    trajectory: Trajectory,
    phase: Phase,
    state: FloatArray,
    without: frozenset[tuple[str, str]],
    of: Kind,
) -> None:
    """Goes on with the search over one phase."""
    every, arrangement, within = prover.pairs_of(phase), prover.of(phase), NEARBY_M
    pairs = counted = _counted(arrangement, every, without, of)
    if not len(counted):
        return
    spline = trajectory.spline
    motion = prover.motion(spline)
    least = prover.behind(phase, spline, every) if every.many else np.zeros((0, SIDES))
    while True:
        # what planes keep further apart than `within` cannot be nearest, if anything is found that is nearer
        within = min(within, float(state[UPPER]))
        if every.many:
            counted[:, REQUIRED] = within
            pairs = prover.not_behind(phase, every, counted, least)
        sample_distance(motion, arrangement.cell, pairs, phase.t0, phase.t1, INSTANTS, state)
        if len(pairs) == len(counted) or state[UPPER] <= within:
            break
        within *= 2
    if not len(pairs):
        return
    search = Search(prover, phase, spline, pairs, prover.exact)
    search.state[1:] = state[1:]
    for _ in range(MOST_CALLS):
        if search.go_on(NEAREST) == DONE:
            break
        if out_of_time():
            search.state[LOWER] = 0.0
            break
    else:
        search.state[LOWER] = 0.0
    state[1:] = search.state[1:]


# Why two pieces are as near as they are: up to four directions, with weights.
#
# Along each direction both pieces have points that are farthest along it; the sums of these points with the weights are
# as near to each other as the pieces. The search is that of `kernels.gjk.separate`, with its balls among the points,
# and directions a little turned: along a normal of a flat side no single point is the farthest.

TURNS = 1e-5 * np.array([[0.61, -0.37, 0.7], [0.37, 0.7, -0.61], [-0.7, 0.61, 0.37], [0.28, 0.55, 0.79]])
"""One of them is added to unit directions. So a checker chooses the same points for edges of 0.5 mm or more,
whatever it rounds."""
ENOUGH_M = 2e-6
"""The search ends when the distance is known to this, m. If it were known better, a direction might become one in which
two points are equally far."""
MEET_M = 1e-9
"""Points this near have no direction, m."""
CHOSEN_M = 1e-9
"""What a direction does not choose by more than this, m, or as a sine, is in the middle, as in a row of a claim."""
ITERATIONS = 200
"""Round bodies converge linearly."""


class Simplex(NamedTuple):
    """`distance_m` of two points; `weights` (4,), and `directions` (4, 3) in the world from the first piece to the
    second; the last ones may have no weight."""

    distance_m: float
    weights: FloatArray
    directions: FloatArray


def chosen_point(arrangement: Arrangement, placed: FloatArray, unit: int, way: FloatArray) -> FloatArray:
    """The point (3,), world, of a unit that is a piece, which is farthest along a unit direction (3,), by the rule of
    the rows `distances` of a claim (`claim.columns`). `placed` (12,): where the unit is.

    This is the rule of the checkers. With another one they would evaluate another point where two points are equally
    far but for rounding.
    """
    row, axes = arrangement.rows[unit], placed[3:].reshape(3, 3)
    local = way @ axes
    first, many = int(row[VERTEX]), int(row[VERTICES])
    if many > 0:
        corners = arrangement.bodies.vertices[first : first + many]
        heights = corners @ local
        here = corners[int(np.argmax(heights >= heights.max() - CHOSEN_M))]
    else:
        edges = zip(row[HALF : HALF + 3].tolist(), local.tolist(), strict=True)
        here = np.array([math.copysign(half, x) if abs(half * x) > CHOSEN_M else 0.0 for half, x in edges])
        across = math.hypot(local[0], local[1])
        if across > CHOSEN_M:
            here[:2] += row[DISC] / across * local[:2]
    return np.asarray(placed[:3] + axes @ here + row[BALL] * way)


def simplex(arrangement: Arrangement, carriers: FloatArray, a: int, b: int, enough_m: float = ENOUGH_M) -> Simplex:
    """That of units a and b, which are pieces, with their carriers (K, 12) where they are, when the distance is known
    to `enough_m`."""
    placed = arrangement.placed(carriers, (a, b))[2]
    axes = np.concatenate([placed[0, unit, 3:12].reshape(3, 3) for unit in (a, b)], axis=1)
    turn = TURNS[np.argmax(np.abs(TURNS @ axes).min(axis=1))]
    points, directions, work = np.zeros((4, 3)), np.zeros((4, 3)), np.empty((3, 4))
    count, between = 0, placed[0, b, :3] - placed[0, a, :3]
    found = Simplex(math.inf, np.zeros(4), directions)
    for _ in range(ITERATIONS):
        length = float(np.linalg.norm(between))
        if count and not length > MEET_M:
            break
        way = (between / length if length > MEET_M else np.zeros(3)) + turn
        way /= np.linalg.norm(way)
        point = chosen_point(arrangement, placed[0, b], b, -way) - chosen_point(arrangement, placed[0, a], a, way)
        # no direction brings the pieces nearer than this, and the point is none that is known
        if count and (length - float(way @ point) <= enough_m or (points[:count] == point).all(axis=1).any()):
            break
        points[count], directions[count] = point, way
        count += 1
        weights = np.zeros(4)
        if nearest_to_origin(points, count, work):
            kept = [k for k in range(count) if work[0, k] > 0.0]
            count, weights[: len(kept)] = len(kept), work[0, kept]
            points[:count], directions[:count] = points[kept], directions[kept]
        else:
            weights = np.linalg.lstsq(np.vstack([points.T, np.ones(4)]), np.array([0.0, 0.0, 0.0, 1.0]), rcond=None)[0]
            weights = np.maximum(weights, 0.0)
            weights /= weights.sum()
        between = weights @ points
        shown = Simplex(float(np.linalg.norm(between)), weights, directions.copy())
        # a step that brings the pieces no nearer is rounded: its points are almost on one line
        if not shown.distance_m < found.distance_m:
            break
        found = shown
        if count == 4:
            break
    return found


# What is in the way of the arm at one time and posture: the first pair that is too near, or a mesh around it.


@dataclass(frozen=True, slots=True)
class TooNear:
    """Two bodies, by name, how near they are, and the numbers of the pieces of theirs that are; of a body inside a mesh
    a `point` that is, world, in place of pieces."""

    names: tuple[str, str]
    facts: Separation | Enclosed
    units: tuple[int, int] = (-1, -1)
    point: tuple[float, float, float] | None = None


def closest(
    scene: Scene,
    prover: Prover,
    phase: Phase,
    q: FloatArray,
    contacts: Contacts,
    among: BoolArray | None = None,
) -> TooNear | None:
    """The first pair nearer than required at the phase's beginning, where everything is where it is planned; `among`:
    only these bodies (B,), against what hangs on the flange."""
    arrangement, stands = prover.of(phase), prover.standing(q, phase.t0)
    pairs = certain(prover.near(phase, stands))
    units = pairs[:, FIRST : SECOND + 1].astype(np.int64).T
    one, other = arrangement.body[units]
    wanted: BoolArray = np.ones(len(pairs), dtype=np.bool_)
    for first, second in contacts:
        a, b = arrangement.number[first], arrangement.number[second]
        wanted &= ~(((one == a) & (other == b)) | ((one == b) & (other == a)))
    if among is not None:
        wrist = scene.robot.links.index("quill" if "quill" in scene.robot.links else "flange")
        wanted &= arrangement.of_robot[one] & (arrangement.carrier[units[0]] >= wrist) & among[other]
    if not wanted.any():
        return None
    found = prover.hits(phase, stands, pairs[wanted], displaced_links=False).too_near
    if not len(found):
        return None
    hit = found[found[:, HIT_PAIR].argmin()]
    near, gap, need = (int(hit[HIT_A]), int(hit[HIT_B])), float(hit[HIT_GAP]), float(hit[HIT_NEED]) - RESERVE_M
    first, second = (arrangement.names[arrangement.body[unit]] for unit in near)
    touching = bool(prover.touch(arrangement, stands, phase.t0, *near))
    apart = min(gap if touching else max(0.0, gap), need)
    rule, clearance = prover.rule(phase, first, second)
    facts = Separation(touching=touching, gap_m=apart, required_m=need, rule=rule, clearance_m=clearance)
    return TooNear((first, second), facts, near)


def enclosed(
    scene: Scene,
    prover: Prover,
    attached: Attachments,
    q: FloatArray,
    t: float,
    contacts: Contacts,
    among: BoolArray | None = None,
) -> TooNear | None:
    """A body of the arm and the mesh whose surface encloses a point of it (a mesh is hollow to FCL and to gaps).

    `attached`: where each body of the surroundings sits by then; `contacts`: pairs that do not count; `among`: only
    these bodies (B,). Raises `OutOfTimeError` where the deadline in force passes.
    """
    if not prover.arrangement.hollow:
        return None
    arrangement = prover.arrangement(attached)
    carriers = prover.carriers(q, t)
    points = [
        (mine, _reference_points(prover, arrangement, q, t, mine))
        for mine in np.flatnonzero(arrangement.of_robot).tolist()
    ]
    counted = ~arrangement.of_robot if among is None else ~arrangement.of_robot & among  # else it is in the gripper
    names = [name for name in prover.arrangement.hollow if counted[arrangement.number[name]]]
    if not names:
        return None
    raise_if_late()
    poses = [attached.pose_of(scene, name)[1] for name in names]
    boxes = [prover.box(prover.arrangement.hollow[name][0]) for name in names]
    on = carriers[arrangement.carrier[arrangement.roots[[arrangement.number[name] for name in names]]]]
    at = on[:, :3] + (on[:, 3:].reshape(-1, 3, 3) @ np.array([pose.position for pose in poses])[:, :, None])[:, :, 0]
    reach = np.linalg.norm(np.abs(np.array(boxes)).max(1), axis=1) + ROUNDED_M
    apart = np.linalg.norm(at[:, None] - np.concatenate([here for _, here in points]), axis=2)
    for k in np.flatnonzero(~(apart > reach[:, None]).all(1)).tolist():  # NaN is not outside
        raise_if_late()
        name, pose, (low, high) = names[k], poses[k], boxes[k]
        surface, origin, turn = prover.arrangement.hollow[name], on[k, :3], on[k, 3:].reshape(3, 3)
        c, s = math.cos(pose.yaw), math.sin(pose.yaw)
        yaw = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        for mine, here in points:
            local = ((here - origin) @ turn - pose.position) @ yaw
            # a point outside the box round the surface is outside the surface; NaN is not outside
            near = ~((local < low) | (local > high)).any(-1)
            if pair(arrangement.names[mine], name) in contacts or not near.any():
                continue
            within = inside(surface, local[near], raise_if_late)
            if within.any():
                x, y, z = here[near][within.argmax()].tolist()
                return TooNear((arrangement.names[mine], name), Enclosed(), point=(x, y, z))
    return None


def _reference_points(prover: Prover, arrangement: Arrangement, q: FloatArray, t: float, body: int) -> FloatArray:
    """A point (m, 3) inside each convex piece of a body, world."""
    units = np.array(arrangement.pieces(body))
    points = []
    for unit, posed in zip(units, prover.posed(arrangement, q, t, units), strict=True):
        corners = getattr(arrangement.shape(unit), "vertices", None)
        middle = np.zeros(3) if corners is None else corners.mean(0)
        points.append(posed.position + posed.axes @ middle)
    return np.array(points)
