"""A stream of a cell as its numbers, checked against the rest of the cell."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from assur.planner.laws.validity import ALWAYS
from assur.scenes.faults import Gathered, Refused, choices
from assur.scenes.reading import bodies
from assur.scenes.schema.cell_file import CellDocument
from assur.scenes.schema.streams import StreamDocument
from assur.scenes.streams.carriers import check_brought, filled, shares_of, slots_for
from assur.scenes.streams.table import Row, rows_of

if TYPE_CHECKING:
    from assur.planner.geometry.shapes import Body
    from assur.scenes.reading.frames import Frames

Range = tuple[float, float]
ALONG_X = (1.0, 0.0, 0.0)
"""The way of a conveyor in its own frame."""
LONGEST_NAME = 48
"""Characters of the name of a stream."""


@dataclass(frozen=True)
class Kind:
    """A kind of parts of a stream: its share of all parts, the slots to which it goes (None: it is a carrier, which has
    slots), its greatest horizontal distance from its origin and its lowest and highest z, m; by how much any of its
    points may be off horizontally and vertically, m. Of a carrier these are distances with all of its slots filled."""

    name: str
    share: float
    to: str | None
    radius_m: float
    heights_m: Range
    off_m: float
    vertical_m: float


@dataclass(frozen=True)
class Stream:
    """Parts that come on a conveyor. Places are in the frame as the cell file has it, which the parts pass along its x
    axis, m, at `speed_m_s`.

    `at_m` (3,): where a part comes. `lanes_m`: offsets along y; `spread_m`: a part is off its lane along y by between
    these. `yaw_rad`: between which its yaw is. `seen_m`: x of the line at which it is seen, and `latency_s` later it is
    known. `window_m`: x at which it may be picked. `every_s`, `jitter_s`, or `mean_s`: between batches of `count` parts
    that are `apart_s` apart, and `gap_m` between two parts of one lane at least; or the `rows` of a table.
    """

    name: str
    frame: str
    speed_m_s: float
    kinds: tuple[Kind, ...]
    at_m: tuple[float, float, float]
    lanes_m: tuple[float, ...]
    spread_m: Range
    yaw_rad: Range
    seen_m: float
    latency_s: float
    window_m: Range
    every_s: float | None
    jitter_s: float
    mean_s: float | None
    count: int
    apart_s: float
    gap_m: float
    rows: tuple[Row, ...] | None

    @property
    def brings_carriers(self) -> bool:
        """Whether its parts have slots: they are filled, and not picked."""
        return self.kinds[0].to is None

    @property
    def radius_m(self) -> float:
        """Of its largest kind."""
        return max(kind.radius_m for kind in self.kinds)

    @property
    def gap_s(self) -> float:
        """Between two parts of one lane at least: they have their gap then, whatever their kinds and their yaw."""
        return (2.0 * self.radius_m + self.gap_m) / self.speed_m_s

    @property
    def least_gap_m(self) -> float | None:
        """How near to each other two parts of one lane may come, whatever their yaw, m; None: a table states it."""
        if self.rows is not None:
            return None
        times = [self.apart_s] if self.count > 1 else []
        batch_s = (self.count - 1) * self.apart_s
        times.append(0.0 if self.every_s is None else self.every_s - 2.0 * self.jitter_s - batch_s)
        return max(self.gap_m, self.speed_m_s * min(times) - 2.0 * self.radius_m)

    @property
    def offsets_m(self) -> Range:
        """Between which the parts are along y of the frame."""
        if self.rows is not None:
            return min(row.y_m for row in self.rows), max(row.y_m for row in self.rows)
        y = self.at_m[1]
        return y + min(self.lanes_m) + self.spread_m[0], y + max(self.lanes_m) + self.spread_m[1]

    @property
    def separate_lanes(self) -> int:
        """How many of its lanes are so far apart that parts may pass side by side."""
        many, last = 0, -math.inf
        for lane in sorted(self.lanes_m):
            if lane - last >= 2.0 * self.radius_m:
                many, last = many + 1, lane
        return many


def streams_of(cell: CellDocument, frames: Frames, faults: Gathered) -> tuple[Stream, ...]:
    """The streams of a cell with these frames. What is wrong with one is in `faults`, at its field."""
    found = list[Stream]()
    solids: dict[str, Body] = {}
    for name, kind in cell.kinds.items():
        with faults.part("kinds", name):
            solids[name] = bodies.solid(name, kind.shape)
    for name, item in cell.streams.items():
        with faults.part("streams", name):
            found.append(_stream(name, item, cell, frames, solids))
    return tuple(found)


def _stream(name: str, item: StreamDocument, cell: CellDocument, frames: Frames, solids: Mapping[str, Body]) -> Stream:
    if len(name) > LONGEST_NAME:
        raise Refused(f"a name of up to {LONGEST_NAME} characters: its parts have this name and a number")
    speed = _speed(item.frame, frames)
    kinds = _kinds(item, cell, solids)
    if kinds[0].to is None and frames.laws[item.frame].uncertainty.speed_m_s > 0.0:
        raise Refused("a conveyor whose speed is certain, for parts with slots: places on them are known then", "frame")
    rows = None if item.csv is None else rows_of(item.csv, tuple(kind.name for kind in kinds))
    if item.lane_m is not None:
        _ordered("lane_m", item.lane_m)
    if item.yaw_rad is not None:
        _ordered("yaw_rad", item.yaw_rad)
    if not item.window_m[0] < item.window_m[1]:
        raise Refused("the least x first, and then a greater one", "window_m")
    made = Stream(
        name=name,
        frame=item.frame,
        speed_m_s=speed,
        kinds=kinds,
        at_m=(item.at_m[0], item.at_m[1], item.at_m[2]),
        lanes_m=tuple(item.lanes_m or (0.0,)),
        spread_m=(0.0, 0.0) if item.lane_m is None else (item.lane_m[0], item.lane_m[1]),
        yaw_rad=(0.0, 0.0) if item.yaw_rad is None else (item.yaw_rad[0], item.yaw_rad[1]),
        seen_m=item.seen.at_m,
        latency_s=item.seen.latency_s,
        window_m=(item.window_m[0], item.window_m[1]),
        every_s=item.every_s,
        jitter_s=item.jitter_s or 0.0,
        mean_s=item.mean_s,
        count=1 if item.batch is None else item.batch.count,
        apart_s=0.0 if item.batch is None else item.batch.apart_s,
        gap_m=item.gap_m or 0.0,
        rows=rows,
    )
    _check_places(made)
    _check_times(made)
    return made


def _speed(name: str, frames: Frames) -> float:
    """The speed of a conveyor. Raises `Refused` for what is none, stands, changes or is known for a time only."""
    along = [each for each, frame in frames.laws.items() if frame.law.way == ALONG_X]
    if name not in along:
        raise Refused(f"the name of a conveyor: {choices(along, name)}", "frame")
    law = frames.laws[name].law
    if law.changes_until > -math.inf or law.valid != ALWAYS:
        raise Refused("a conveyor without changes and valid_s: its speed is the same for the whole run", "frame")
    if not law.numbers.speed > 0.0:
        more = f"{name} has {1e3 * law.numbers.speed:g} mm/s; parts that come the other way need a frame that is turned"
        raise Refused(f"a conveyor with a speed above 0: {more}", "frame")
    return law.numbers.speed


def _kinds(item: StreamDocument, cell: CellDocument, solids: Mapping[str, Body]) -> tuple[Kind, ...]:
    shares = shares_of(item)
    carriers = {grid.kind: name for name, grid in cell.slots.items()}
    found = []
    for name, share in shares.items():
        at = ("kind",) if item.kind is not None else ("kinds", name)
        if name not in cell.kinds:
            raise Refused(f"one of the kinds: {choices(cell.kinds, str(name))}", *at)
        to = slots_for(name, item)
        where = ("to", name) if isinstance(item.to, dict) and to is not None else ("to",)
        if name in carriers:
            if item.to is not None:
                own = f"{name} has slots ({carriers[name]}), so it is filled and not picked"
                raise Refused(f"none: {own}, and it comes in a stream without other kinds", *where)
        elif to is None or to not in cell.slots:
            raise Refused(f"slots for {name}: {choices(cell.slots, str(to))}", *where)
        elif cell.slots[to].kind is not None:
            check_brought(to, cell, where)
        if name not in solids:
            continue  # its shape has a fault of its own
        off = cell.kinds[name].uncertainty
        radius_m, heights_m = filled(name, cell, solids)
        off_m = off.position_m + radius_m * off.yaw_rad
        found.append(Kind(name, share, to, radius_m, heights_m, off_m, off.vertical_m))
    if isinstance(item.to, dict):
        for name in item.to.keys() - shares.keys():
            raise Refused(f"kinds of this stream: {', '.join(map(str, shares))}", "to", name)
    if not found:
        raise Refused("a kind whose shape can be read", "kind" if item.kind is not None else "kinds")
    return tuple(found)


def _ordered(key: str, limits: list[float]) -> None:
    if limits[0] > limits[1]:
        raise Refused("the least first, and then the greatest", key)


def _check_places(made: Stream) -> None:
    """Raises `Refused` where a part is never seen, or seen when it is too late."""
    end = made.window_m[1]
    if made.rows is None and made.seen_m < made.at_m[0]:
        raise Refused(f"{_mm(made.at_m[0])} or more, where the parts come: they pass no line before", "seen", "at_m")
    for row in made.rows or ():
        if row.x_m > made.seen_m:
            allowed = f"a line that each part of the table passes: that of line {row.line} comes at {_mm(row.x_m)}"
            raise Refused(allowed, "seen", "at_m")
    known_m = made.seen_m + made.speed_m_s * made.latency_s
    if known_m >= end:
        late = f"parts are known when they are at {_mm(known_m)}, and their window ends at {_mm(end)}"
        raise Refused(f"a line before the end of the window, by more than the latency: {late}", "seen", "at_m")


def _check_times(made: Stream) -> None:
    """Raises `Refused` for parts that come so often that they overlap."""
    key, time_s = ("every_s", made.every_s) if made.every_s is not None else ("mean_s", made.mean_s)
    if time_s is None:
        return
    lanes = made.separate_lanes
    least_s = made.gap_s * made.count / lanes
    if time_s < least_s:
        gap = f", or have less than the gap of {_mm(made.gap_m)} between them" if made.gap_m > 0.0 else ""
        raise Refused(
            f"{least_s:.4g} s or more: nearer to each other the parts could overlap, whatever their yaw is{gap}", key
        )
    if made.jitter_s > 0.5 * time_s:
        raise Refused(f"at most {0.5 * time_s:g} s, half of every_s: else parts overtake each other", "jitter_s")
    if made.count > 1 and (made.count - 1) * made.apart_s >= time_s:
        raise Refused(f"a batch that is over before the next one: {made.count} parts in {time_s:g} s", "batch")


def _mm(length_m: float) -> str:
    return f"{1e3 * length_m:.6g} mm"
