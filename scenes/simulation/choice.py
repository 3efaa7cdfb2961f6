"""The choice of the next part: tables of times of a cell, and what is known at a moment as their rows."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from assur.planner.errors import FaultError, InputError
from assur.planner.frames.motion import Pose
from assur.planner.laws import kinds as laws
from assur.planner.selection.names import Rule
from assur.scenes.faults import Refused, within
from assur.scenes.reading.bodies import resolve
from assur.scenes.reading.frames import placed
from assur.scenes.schema.normal import normal
from assur.scenes.schema.read import read
from assur.scenes.schema.shapes import PlaceInCell
from assur.scenes.streams.arrivals import ArrivingPart
from assur.scenes.streams.stream import Stream
from assur.scenes.tasks.grids import counts, pose_of_slot
from assur.scenes.tasks.request_of_task import HANDLING

if TYPE_CHECKING:
    from assur.planner.arrays import FloatArray
    from assur.planner.robots.robot import Robot
    from assur.planner.selection.columns import Times
    from assur.planner.selection.next_part import Choice, KnownPart
    from assur.planner.selection.times import CycleTerms, Lane, Place
    from assur.scenes.reading.cell import Surroundings
    from assur.scenes.reading.robots import RobotWithTool
    from assur.scenes.schema.cell_file import CellDocument
    from assur.scenes.schema.request import OptionsDocument

Document = dict[str, Any]
LANE_M = 0.06
"""Parts of a stream whose offsets differ by less count as in one lane of the tables, m."""
MOST_POINTS = 12
"""Slots of a grid that the tables have at most; a slot between two of them counts as the one before."""
AUTO, KEEP = "auto", "keep"
WINDOW = "window_m"


@dataclass(frozen=True, eq=False)
class Chooser:
    """Ranks the parts that may be next. `elbow`: the working mode in which the arm begins; None: the only one.
    `streams`: those of parts that are picked. `lanes`: for each lane of the tables its stream and its y in the frame;
    `begins_s`: of each lane the time at which its frame is where the cell has it. `grids`: names of the places of the
    tables, the refuge last; `counts`: how many slots each grid has."""

    rule: Rule
    times: Times
    robot: Robot
    modes: tuple[int, ...]
    elbow: str | None
    streams: Mapping[str, Stream]
    lanes: tuple[tuple[str, float], ...]
    begins_s: tuple[float, ...]
    grids: tuple[str, ...]
    counts: dict[str, int]

    @property
    def orders_little(self) -> bool:
        """Whether the parts come in one lane, and go to one grid."""
        one = len(self.streams) == 1 and len(self.counts) == 1
        return one and all(s.offsets_m[1] - s.offsets_m[0] <= LANE_M for s in self.streams.values())

    @property
    def nominal_s(self) -> float:
        """The mean time of a cycle, without obstacles, s."""
        from assur.planner.selection import columns as c

        return float(self.times.rides[0, c.NOMINAL])

    def lane_of(self, stream: str, y_m: float) -> int:
        """The nearest lane of a stream."""
        own = [k for k, (name, _) in enumerate(self.lanes) if name == stream]
        return min(own, key=lambda k: abs(self.lanes[k][1] - y_m))

    def ranked(
        self,
        now_s: float,
        place: str | None,
        slot: int,
        q: Sequence[float],
        slots: Mapping[str, int],
        known: Sequence[tuple[str, ArrivingPart]],
    ) -> tuple[Choice, ...]:
        """The parts that are known, with the names of their streams, best first, for an arm with joints `q` that is
        free at `now_s` after it has filled a slot of a grid (None: it is in the refuge, or near). `slots`: the number,
        from 0, of the next free one of each grid."""
        from assur.planner.selection.next_part import FreeArm, next_part

        mode = 0
        if len(self.modes) > 1:
            mode = self.modes.index(int(self.robot.mode_of(np.array(q))))
        number = len(self.grids) - 1 if place is None else self.grids.index(place)
        way = 0.0 if place is None else float(self.point(place, slot))
        points = [self.point(grid, slots.get(grid, 0)) for grid in self.grids[:-1]]
        rows = [self.known(stream, part) for stream, part in known]
        return next_part(now_s, FreeArm(number, way, mode, (*points, 0)), rows, self.times, self.rule)

    def known(self, stream: str, part: ArrivingPart) -> KnownPart:
        """A part of a stream, as the tables have it."""
        from assur.planner.selection.next_part import KnownPart

        lane = self.lane_of(stream, part.y_m)
        passed_s = part.passes_s(0.0, self.streams[stream].speed_m_s) - self.begins_s[lane]
        return KnownPart(part.name, lane, passed_s, self.grids.index(part.kind.to))

    def point(self, grid: str, slot: int) -> int:
        """The point of the tables for a slot of a grid, which counts from 0."""
        many = self.counts[grid]
        return slot % many if many <= MOST_POINTS else slot % many * MOST_POINTS // many


def chooser_of(
    cell: CellDocument, options: OptionsDocument, streams: Sequence[Stream], around: Surroundings, refuge: str
) -> Chooser:
    """Makes the tables. Raises `Refused` at the window of a stream, or at slots, that no working mode which is allowed
    reaches."""
    from assur.planner.selection import columns as c
    from assur.planner.selection.times import times_of

    given = around.given
    if given is None:
        raise FaultError("a cell that has been checked has no robot")
    robot = given.robot
    carriers = {kind.name: stream for stream in streams for kind in stream.kinds if stream.brings_carriers}
    streams = [stream for stream in streams if not stream.brings_carriers]
    grids = tuple(dict.fromkeys(kind.to for stream in streams for kind in stream.kinds if kind.to is not None))
    slots = {name: normal(cell.slots[name].document()) for name in grids}
    many = {name: math.prod(counts(slots[name])) for name in grids}
    lanes, lane_rows, begins = _lanes(cell, streams, around)
    places = _places(cell, streams, carriers, slots, around, refuge)
    terms, shares = _terms(cell, streams, slots, options, given), _shares(streams, lane_rows, grids)
    names = robot.modes
    if options.elbow not in (AUTO, KEEP, *names):
        raise Refused(f"one of {AUTO}, {KEEP}, {', '.join(names)}", "options", "elbow")
    wanted = range(len(names)) if options.elbow in (AUTO, KEEP) else [names.index(options.elbow)]
    allowed = [tuple(wanted)] if options.elbow == AUTO else [(mode,) for mode in wanted]

    def tables(lanes: Sequence[Lane], places: Sequence[Place], shares: FloatArray) -> dict[tuple[int, ...], Times]:
        made = {}
        for modes in allowed:
            with suppress(InputError), warnings.catch_warnings(), np.errstate(invalid="ignore"):
                warnings.simplefilter("ignore", RuntimeWarning)  # a mean of what no mode reaches is NaN
                made[modes] = times_of(robot, modes, lanes, places, terms, shares)
        return made

    found = tables(lanes, places, shares)
    if not found:
        for stream in streams:
            own = [k for k, (name, _) in enumerate(lane_rows) if name == stream.name]
            if not tables([lanes[k] for k in own], places[-1:], np.ones((len(own), 1))):
                raise Refused(
                    "a window with two points, 10 mm apart, that the arm reaches", "streams", stream.name, WINDOW
                )
        raise Refused("windows that the arm reaches in one working mode, or `elbow: auto`", "options", "elbow")
    lacks = {modes: _unreached(times) for modes, times in found.items()}
    right = {modes: times for modes, times in found.items() if lacks[modes] is None}
    if not right:
        number, point = next(lack for lack in lacks.values() if lack is not None)
        if number == len(grids):
            raise Refused("a position that the arm reaches in the working mode in which it reaches the slots", "refuge")
        slot = 1 + (point if many[grids[number]] <= MOST_POINTS else point * many[grids[number]] // MOST_POINTS)
        lacks_slot = f"number {slot} of {grids[number]} is out of its reach"
        kind = slots[grids[number]].get("kind")
        if kind is not None:
            raise Refused(
                f"a window in which the arm reaches slots; {lacks_slot}", "streams", carriers[kind].name, WINDOW
            )
        raise Refused(f"slots that the arm reaches; {lacks_slot}", "slots", grids[number], "at_m")
    modes, times = min(right.items(), key=lambda each: float(each[1].rides[0, c.NOMINAL]))
    elbow = names[modes[0]] if len(names) > 1 else None
    named = {stream.name: stream for stream in streams}
    return Chooser(cell.selection, times, robot, modes, elbow, named, lane_rows, begins, (*grids, refuge), many)


def _unreached(times: Times) -> tuple[int, int] | None:
    """The first place, and the first point of its grid, that no travel leads to."""
    from assur.planner.selection import columns as c

    least = times.back.min(axis=(0, 1, 2, 5))
    for p, row in enumerate(times.places):
        for point in range(min(int(row[c.PLACE_SLOTS]), least.shape[1])):
            if least[p, point] >= c.UNREACHED:
                return p, point
    return None


def _lanes(
    cell: CellDocument, streams: Sequence[Stream], around: Surroundings
) -> tuple[list[Lane], tuple[tuple[str, float], ...], tuple[float, ...]]:
    """The lanes of the tables; of each its stream and its y in the frame, and when its frame is where the cell has
    it."""
    from assur.planner.selection.times import Lane

    lanes, rows, begins = list[Lane](), list[tuple[str, float]](), list[float]()
    for stream in streams:
        law, kind = around.frames.laws[stream.frame].law, cell.kinds[stream.kinds[0].name]
        first, last = stream.offsets_m
        begin = law.numbers.at_time
        window = tuple(begin + x / stream.speed_m_s for x in stream.window_m)
        for y in np.linspace(first, last, 1 + math.ceil((last - first) / LANE_M - 1e-9)).tolist():
            x, aside, up = kind.grasp_m or (0.0, 0.0, 0.0)
            lanes.append(Lane(law, Pose(x, y + aside, stream.at_m[2] + up), (window[0], window[1])))
            rows.append((stream.name, y))
            begins.append(begin)
    return lanes, tuple(rows), tuple(begins)


def _shares(streams: Sequence[Stream], lanes: Sequence[tuple[str, float]], grids: Sequence[str]) -> FloatArray:
    """The shares of the parts of each lane for each place; nothing is for the refuge."""
    found = np.zeros((len(lanes), len(grids) + 1))
    for stream in streams:
        own = [k for k, (name, _) in enumerate(lanes) if name == stream.name]
        for kind in stream.kinds:
            found[own, grids.index(kind.to)] += kind.share / sum(each.share for each in stream.kinds) / len(own)
    return found


def _places(
    cell: CellDocument,
    streams: Sequence[Stream],
    carriers: Mapping[str, Stream],
    slots: Mapping[str, Any],
    around: Surroundings,
    refuge: str,
) -> list[Place]:
    """The slots of each grid as the tables have them, and the refuge. `carriers`: the streams of kinds with slots."""
    from assur.planner.selection.times import Place

    found = []
    for name, grid in slots.items():
        many = math.prod(counts(grid))
        kind = next(kind.name for stream in streams for kind in stream.kinds if kind.to == name)
        grasp = placed(cell.kinds[kind].grasp_m or [0.0, 0.0, 0.0], 0.0)
        points = range(many) if many <= MOST_POINTS else [k * many // MOST_POINTS for k in range(MOST_POINTS)]
        own = [pose_of_slot(grid, 1 + k) for k in points]
        with within("slots", name):
            stream = carriers.get(grid.get("kind"))
            poses = [_at_rest(each, around) if stream is None else _in_window(each, stream, around) for each in own]
        found.append(Place(laws.fixed(Pose()), tuple(pose.then(grasp) for pose in poses)))
    with within("positions", refuge):
        stated = cell.positions[refuge].document()
        pose: Document = {key: stated[key] for key in ("frame", "body", "at_m", "yaw_rad") if key in stated}
        found.append(Place(laws.fixed(Pose()), (_at_rest(pose, around),)))
    return found


def _in_window(slot: Mapping[str, Any], stream: Stream, around: Surroundings) -> Pose:
    """A slot of a carrier in the world, in the middle of the window and of the lanes of its stream: the tables have no
    places that come at any time."""
    carrier = Pose(0.0, _middle(stream.offsets_m), stream.at_m[2], _middle(stream.yaw_rad))
    on_it = replace(carrier.then(placed(slot["at_m"], slot["yaw_rad"])), x=_middle(stream.window_m))
    return around.frames.laws[stream.frame].law.numbers.pose.then(on_it)


def _middle(limits: tuple[float, float]) -> float:
    return 0.5 * (limits[0] + limits[1])


def _at_rest(place: Mapping[str, Any], around: Surroundings) -> Pose:
    """A pose of the cell in the world. Raises `Refused` where it is in a frame that moves."""
    item: PlaceInCell = read(PlaceInCell, dict(place))
    frame, pose = resolve(item, item.yaw_rad, around.frames, around.places)
    law = around.frames.laws[frame].law
    if not law.is_fixed:
        raise Refused("a frame at rest", "body" if item.frame is None else "frame")
    return law.numbers.pose.then(pose)


def _terms(
    cell: CellDocument,
    streams: Sequence[Stream],
    slots: Mapping[str, Any],
    options: OptionsDocument,
    given: RobotWithTool,
) -> CycleTerms:
    """What all cycles have in common, of the kinds and slots on average."""
    from assur.planner.selection.times import CycleTerms

    kinds = {kind.name: kind.to for stream in streams for kind in stream.kinds if kind.to is not None}
    picks, puts = list[tuple[float, float, float]](), list[tuple[float, float, float]]()
    for name, grid in kinds.items():
        own = normal(cell.kinds[name].document())
        picks.append(_handling(own, HANDLING))
        puts.append(_handling(slots[grid], own, HANDLING))
    rides = []
    for found in (picks, puts):
        down, dwell, up = np.mean(found, axis=0).tolist()
        rides.append(_straight_s(given, down) + dwell + _straight_s(given, up))
    above = float(np.mean([found[0] for found in picks + puts]))
    return CycleTerms(given.tool.tcp, above, rides[0], rides[1], options.singularity_margin)


def _handling(*stated: Mapping[str, Any]) -> tuple[float, float, float]:
    """Approach, m, dwell, s, and depart, m: of the first that states it."""

    def first(key: str) -> Any:
        return next(each[key] for each in stated if key in each)

    return first("approach")["m"], first("dwell_s"), first("depart")["m"]


def _straight_s(given: RobotWithTool, length_m: float) -> float:
    """How long the tool takes for a straight part, s: the half of a motion from rest to rest that is twice as long."""
    from assur.planner.timing.solver import Solver, TimingRefusal

    robot = given.robot
    if robot.lift is None or length_m == 0.0:
        return 0.0
    solver = Solver(*robot.limits.table[2:, [robot.lift]].tolist())
    found = solver.shortest(([0.0], [0.0], [0.0]), ([2.0 * length_m], [0.0], [0.0]))
    return 0.0 if isinstance(found, TimingRefusal) else 0.5 * found
