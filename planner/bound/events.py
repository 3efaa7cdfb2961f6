"""The points of a task, as the bound of its duration sees them: where the flange must be at each, and for how long."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from itertools import product

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval

from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.bound.fastest import EXACT, FREE, KINDS, STATE, soonest
from assur.planner.bound.guided import RATES
from assur.planner.frames.motion import Motion, Pose
from assur.planner.kernels import law_columns as c
from assur.planner.laws import Law
from assur.planner.model.attachments import at_start
from assur.planner.model.phases import yaw_offsets
from assur.planner.model.scene import Move, Pick, Place, Scene, Step, Trace
from assur.planner.robots.facts import Code
from assur.planner.robots.robot import Robot

MOST_TURNS = 8
"""Most turns of a symmetric part that are distinguished; with more, its yaw counts as free."""
ALONG, STOPS, PASSES = range(3)
"""What is required when a point is met: to go along with it, to stand still, or only to be there."""


@dataclass(frozen=True, slots=True)
class Event:
    """The tool at a control point. `point`: in `frame`, that whose way along a conveyor a
    window measures; `poses`: of the flange, one of them (empty: not known); `free`: with any
    yaw; `pitch`, `roll`: of an arm that has them, NaN where they are free. `kind`: ALONG, STOPS or PASSES. `opens`: it
    is not met sooner, s. `before`, `after`: the parts in the gripper (None: none). `traced`: so long, s, the tool goes
    on to the next event, and no less."""

    step: Step
    frame: str
    point: Pose
    poses: tuple[Pose, ...]
    free: bool
    pitch: float
    roll: float
    kind: int
    dwell: float
    opens: float
    before: str | None
    after: str | None
    traced: float = 0.0


def events(scene: Scene) -> tuple[Event, ...]:
    """What must be passed, in order. A path that is traced is two events: its first point, and its last."""
    # what the gripper may hold, by the turns in which a part may have been taken; `loose`: the turn may be any
    attached, loose, found = [at_start(scene)], False, list[Event]()
    to_flange = scene.tool.tcp.inverse()
    for step in scene.task:
        here, target, offsets = attached[0], step.target, yaw_offsets(scene, step)
        frame, point = here.point(scene, step)
        law = scene.frames[frame].law
        free = not isinstance(step, Place) and (
            offsets is None or len(offsets) > MOST_TURNS or (target is not None and target.yaw_free)
        )
        turns = (0.0, 0.5 * math.pi) if free or offsets is None else offsets
        pitch, roll = (math.nan if x is None else x for x in ((target.pitch, target.roll) if target else (0.0, 0.0)))
        window = step.window.time
        opens = max(scene.start.time, law.valid[0], -math.inf if window is None else window[0])
        kind = PASSES if step.via or isinstance(step, Trace) else STOPS if step.match == "position" else ALONG
        if kind == STOPS and not isinstance(step, Move) and not law.is_fixed:
            kind = PASSES  # above the point the tool goes along with it, and stands at the point: nothing holds at both
        after = [here.after(scene, step, turn) for turn in turns]
        spans = [(step.dwell_s, opens, 0.0)]
        if isinstance(step, Trace):
            ends = [step.path.begin, step.path.end]
            spans = [(0.0, opens, step.dwell_s), (0.0, opens + step.dwell_s, 0.0)]
            places = [[Pose(*end, point.yaw + turn).then(to_flange) for turn in turns] for end in ends]
        elif isinstance(step, Place):
            places = [[] if loose else [each.flange(scene, step)[1] for each in attached]]
        elif isinstance(step, Move) and step.via and scene.options.vias_missed:
            places = [[]]  # it is not passed exactly
        else:
            places = [[here.flange(scene, step, turn)[1] for turn in turns]]
        for poses, (dwell, sooner, traced) in zip(places, spans, strict=True):
            if free and poses:
                # with a tool point beside the flange's axis the yaw moves the flange
                one, other = poses
                del poses[math.hypot(one.x - other.x, one.y - other.y) <= ROUNDING_M :]
            tool = tuple(poses), free, pitch, roll, kind
            found.append(Event(step, frame, point, *tool, dwell, sooner, here.part, after[0].part, traced))
        if step.part is not None:
            attached, loose = after, free
    return tuple(found)


ROUNDING_M = 1e-9
"""m. Places that are no farther apart are one."""


def straight_times(scene: Scene, event: Event, before: FloatArray, behind: FloatArray) -> tuple[float, float, float]:
    """The least times, s, that the lift takes for the straight parts before and behind a point that stays at its
    height, in which no other joint may move against it, and for that behind it if the motion ends at rest there.
    `before`, `behind` (3, n): limits of velocity, acceleration and jerk. 0 where the arm has no lift."""
    lift, step = scene.robot.lift, event.step
    if lift is None or not isinstance(step, Pick | Place):
        return 0.0, 0.0, 0.0
    (approach, depart), limits = scene.straight(step), behind[:, lift]
    early = lifted(approach, before[:, lift], stops=step.approach_stop)
    rests = lifted(depart, limits, stops=True) if scene.options.end == "rest" else 0.0
    return early, lifted(depart, limits, stops=step.depart_stop), rests


def lifted(way: float, limits: FloatArray, *, stops: bool) -> float:
    """The least time from rest over a way, to rest again or to any velocity."""
    if not way > 0.0:
        return 0.0
    begin, end = np.zeros((STATE, 1)), np.zeros((STATE, 1))
    end[0], end[KINDS] = way, EXACT if stops else FREE
    return soonest(begin, end, np.zeros(1), np.ascontiguousarray(limits[:, None]), 0.0)


# All joint positions of an arm at a place: its inverse in every working mode, at every full turn.
#
# Near a singularity a joint may be anywhere while the tool is at its place up to rounding: it is not known there (NaN).

LEAST_MARGIN = 1e-3
"""An arm with a smaller singularity margin has no known angles: 1 µm at its end moves them by 0.001 rad."""
MOST = 64
"""Joint positions at one place, at most: with more, none is known of it."""


class Unplaced(Exception):
    """Nothing is known of the joint positions at a place: there are too many, or none."""


def places(
    robot: Robot, modes: tuple[int, ...], x: float, y: float, z: float, yaw: float, pitch: float, roll: float
) -> FloatArray:
    """Joint positions (N, n) within the joints' ranges that put the flange there, in any of the working modes; NaN in
    what an angle that is not given (NaN) leaves open. Raises `Unplaced` where there are none or more than `MOST`."""
    given = [0.0 if math.isnan(angle) else angle for angle in (yaw, pitch, roll)]
    flange, tilts = Motion.still(Pose(x, y, z, given[0])), "pitch" in robot.coordinates
    if tilts:
        flange = flange.with_tilt(np.array(given[1:]))
    found: list[tuple[float, ...]] = []
    for mode in modes:
        if tilts and math.isnan(pitch):
            # whatever the pitch, the hand is in the vertical plane of the arm; behind the base in the last two modes
            turn = math.atan2(y - robot.base.y, x - robot.base.x) - robot.base.yaw + (math.pi if mode >= 2 else 0.0)
            q = [turn, math.nan, math.nan, math.nan, roll]
        else:
            inverse = robot.inverse(flange, mode, 0)
            if inverse.code in (Code.OUT_OF_REACH, Code.INDETERMINATE):
                continue
            known = inverse.margin >= LEAST_MARGIN
            q = np.where((robot.revolute == 0.0) | known, inverse.q, np.nan).tolist()
            if math.isnan(roll) if tilts else math.isnan(yaw) and robot.turns_load:
                q[-1] = math.nan
        choices = [turns_within(robot, k, at) for k, at in enumerate(q)]
        # counted before they are made: joints with 64 turns each have a thousand million positions together
        if len(found) + math.prod(map(len, choices)) > MOST:
            raise Unplaced
        found += product(*choices)
    if not found:
        raise Unplaced
    return np.array(found)


def allowed_modes(robot: Robot, elbow: str, q: FloatArray) -> tuple[int, ...]:
    """Numbers of the working modes in which an arm that starts at q (n,) may meet its points."""
    if elbow == "keep" and robot.dyads == 1:
        return (int(robot.mode_of(q)),)
    return tuple(range(len(robot.modes))) if elbow in ("auto", "keep") else (robot.modes.index(elbow),)


def turns_within(robot: Robot, joint: int, at: float, off: float = 0.0) -> list[float]:
    """Positions of a joint, whole turns from `at`, that are within its range or at most `off` beyond it; NaN stays as
    it is."""
    low, high = (float(edge[joint]) for edge in robot.limits.within)
    slack = 1e-9 * (high - low) + off
    if math.isnan(at):
        return [at]
    if robot.joints[joint].kind != "revolute":
        return [at] if low - slack <= at <= high + slack else []
    first, last = math.ceil((low - slack - at) / math.tau), math.floor((high + slack - at) / math.tau)
    return [at + turn * math.tau for turn in range(first, last + 1)]


# Bounds of how fast a point of a frame moves, over intervals of time, from the tables of its law.

EDGE_S = 1e-9
"""s. So near to the end of a piece an interval counts as touching it: rounding of times."""
JUMP = 1e-9
"""An acceleration that differs by more at the end of a piece, as a share of 1 and its greatest value, jumps: the jerk
has no bound there."""


def climbs(law: Law) -> bool:
    """Whether the height of the frame may change."""
    return law.link is not None or bool(law.row[c.MOVES + 2] > 0.0)


@lru_cache(maxsize=64)
def _curves(law: Law) -> list[tuple[list[FloatArray], FloatArray, BoolArray]]:
    """Of each piece: the coefficients (K, 4) of its velocity, acceleration and jerk by powers of the time since
    its begin, the times at which one of these may turn round, and whose accelerations (4,) jump at its end."""
    pieces, most = law.side[: int(law.row[c.COUNT])], max(1, int(law.row[c.POWERS]))
    found = list[tuple[list[FloatArray], FloatArray, BoolArray]]()
    for number, piece in enumerate(pieces):
        pull = piece[c.POWER :].reshape(4, c.MOST_POWERS)[:, :most].T
        speed = np.vstack([piece[c.RATE : c.CORNER], pull / np.arange(1.0, most + 1.0)[:, None]])
        turns = [
            np.roots(np.polyder(way[::-1], order)).real for way in pull.T if way.any() for order in range(min(3, most))
        ]
        jumps = np.zeros(4, dtype=bool)
        if number + 1 < len(pieces) or law.row[c.PERIOD] > 0.0:
            behind = pieces[(number + 1) % len(pieces), c.POWER :: c.MOST_POWERS]
            off = np.abs(polyval(piece[c.PIECE_END] - piece[c.PIECE_BEGIN], pull) - behind)
            jumps = ~(off <= JUMP * (1.0 + np.abs(behind) + np.abs(pull[0])))
        # what has one power is constant: its derivative is a zero of the same shape
        found.append(([speed, pull, polyder(pull) if most > 1 else 0.0 * pull], np.concatenate([*turns, []]), jumps))
    return found


def rate_bounds(law: Law, arm_m: float, begin: FloatArray, end: FloatArray) -> FloatArray:
    """Bounds (N, 9) as `assur.planner.bound.guided` has them, of a point `arm_m` metres from a frame's axis,
    over [begin, end] (N,), s: of the velocity, acceleration and jerk of the point in the plane, of its height, and of
    the frame's yaw. Infinite: not bounded, as everything is of a link of another arm (R1)."""
    if law.link is not None:
        return np.full((len(begin), RATES), math.inf)
    # what repeats, and what does not accelerate but by sines, has the same bounds at all times
    if law.row[c.PERIOD] > 0.0 or (law.row[c.COUNT] <= 1.0 and not law.row[c.POWERS] > 0.0):
        return np.repeat(_steady_rates(law, arm_m), len(begin), axis=0)
    return _rates(law, arm_m, begin, end)


@lru_cache(maxsize=64)
def _steady_rates(law: Law, arm_m: float) -> FloatArray:
    """Bounds (1, 9) of a point whose bounds are the same at all times."""
    return _rates(law, arm_m, np.zeros(1), np.zeros(1))


def _rates(law: Law, arm_m: float, begin: FloatArray, end: FloatArray) -> FloatArray:
    """Bounds (N, 9) from the tables of a law."""
    most, curves, repeats = np.zeros((3, 4, len(begin))), _curves(law), law.row[c.PERIOD] > 0.0
    for number, (curve, turns, jumps) in enumerate(curves):
        first, last = law.side[number, [c.PIECE_BEGIN, c.PIECE_END]]
        low = np.maximum(begin, first - EDGE_S) if number else begin
        high = np.minimum(end, last + EDGE_S) if number + 1 < len(curves) else end
        if repeats:
            low, high = np.full((2, len(begin)), [[first], [last]])
        among = low <= high
        instants = np.concatenate([[low - first, high - first], np.clip(turns[:, None], low - first, high - first)])
        for order, powers in enumerate(curve):
            size = np.abs(polyval(instants, powers)).max(axis=1)
            most[order] = np.where(among, np.maximum(most[order], size), most[order])
        over = repeats | ((begin <= last + EDGE_S) & (end >= last - EDGE_S))
        most[2] = np.where(jumps[:, None] & over, math.inf, most[2])
    for wave in law.side[int(law.row[c.WAVE]) :][: int(law.row[c.WAVES])]:
        most[:, int(wave[c.WAVE_COORDINATE])] += np.abs(
            wave[c.WAVE_AMPLITUDE] * wave[c.WAVE_RATE] ** np.arange(1.0, 4.0)[:, None]
        )
    plane, height, (w, dw, ddw) = np.hypot(most[:, 0], most[:, 1]), most[:, 2], most[:, 3]
    if w.any():
        plane += arm_m * np.array([w, dw + w**2, ddw + 3.0 * w * dw + w**3])
    return np.ascontiguousarray(np.concatenate([plane, height, most[:, 3]]).T)
