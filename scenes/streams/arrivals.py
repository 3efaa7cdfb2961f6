"""When the parts of a stream come, and where: the same for the same stream and seed, with any other streams."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import count

import numpy as np

from assur.planner.errors import InputError
from assur.scenes.bounds import MAX_ARRIVALS
from assur.scenes.streams.stream import Kind, Stream


@dataclass(frozen=True)
class ArrivingPart:
    """A part of a stream: when its origin is at `x_m`, s, in the frame as the cell file has it; its offset and yaw
    there. `seen_s`: when it passes the line at which it is seen; `known_s`: when that is reported."""

    name: str
    kind: Kind
    time_s: float
    x_m: float
    y_m: float
    yaw_rad: float
    seen_s: float
    known_s: float

    def passes_s(self, x_m: float, speed_m_s: float) -> float:
        """When its origin is at x, s."""
        return self.time_s + (x_m - self.x_m) / speed_m_s


def arrivals(stream: Stream, seed: int, until_s: float) -> tuple[ArrivingPart, ...]:
    """The parts that are known by `until_s`, s, in the order in which they are seen. A longer time only adds parts.

    The first part comes at 0 s, or at random. Parts that would overlap come later. Raises `InputError` for a stream of
    more than `MAX_ARRIVALS`.
    """
    random = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=tuple(stream.name.encode())))
    found = list[ArrivingPart]()
    for number, (time_s, x, y, yaw, kind) in enumerate(_coming(stream, random, until_s), start=1):
        seen_s = time_s + (stream.seen_m - x) / stream.speed_m_s
        known_s = seen_s + stream.latency_s
        if known_s > until_s:
            continue
        if len(found) == MAX_ARRIVALS:
            raise InputError(f"streams.{stream.name}", until_s, f"a time in which at most {MAX_ARRIVALS:,} parts come")
        found.append(ArrivingPart(f"{stream.name}-{number}", kind, time_s, x, y, yaw, seen_s, known_s))
    found.sort(key=lambda part: part.seen_s)
    return tuple(found)


Coming = tuple[float, float, float, float, Kind]
"""When a part comes, s; where: x, y, m, and yaw, rad; its kind."""


def _coming(stream: Stream, random: np.random.Generator, until_s: float) -> Iterator[Coming]:
    """The parts of a stream one after the other: at least those that are seen by `until_s`."""
    shares = np.cumsum([kind.share for kind in stream.kinds])

    def drawn(draw: float) -> Kind:
        return stream.kinds[min(int(np.searchsorted(shares, draw * shares[-1], side="right")), len(shares) - 1)]

    if stream.rows is not None:
        own = {kind.name: kind for kind in stream.kinds}
        for row in stream.rows:
            draw = float(random.random())
            yield row.time_s, row.x_m, row.y_m, row.yaw_rad, drawn(draw) if row.kind is None else own[row.kind]
        return
    x, middle, _ = stream.at_m
    last, before_line_s = dict[float, float](), (stream.seen_m - x) / stream.speed_m_s
    for begins_s in _begins(stream, random):
        if begins_s + before_line_s > until_s:
            return  # batches begin in their order, and parts only come later
        for k in range(stream.count):
            of_lane, of_place, of_yaw, of_kind = random.random(4).tolist()
            lane = stream.lanes_m[min(int(of_lane * len(stream.lanes_m)), len(stream.lanes_m) - 1)]
            time_s = begins_s + k * stream.apart_s
            for other, other_s in last.items():
                if abs(other - lane) < 2.0 * stream.radius_m:
                    time_s = max(time_s, other_s + stream.gap_s)
            last[lane] = time_s
            y = middle + lane + _between(stream.spread_m, of_place)
            yield time_s, x, y, _between(stream.yaw_rad, of_yaw), drawn(of_kind)


def _begins(stream: Stream, random: np.random.Generator) -> Iterator[float]:
    """When the batches of a stream begin, s, in their order."""
    if stream.every_s is not None:
        for number in count():
            early = float(random.uniform(-1.0, 1.0)) * stream.jitter_s
            yield number * stream.every_s + early
    time_s, mean_s = 0.0, stream.mean_s or math.inf
    while True:
        time_s += float(random.exponential(mean_s))
        yield time_s


def _between(limits: tuple[float, float], share: float) -> float:
    return limits[0] + share * (limits[1] - limits[0])
