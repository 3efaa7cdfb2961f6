"""Seven cells, and streams of parts that arrive in them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Pose
from assur.planner.laws.kinds import conveyor, fixed
from assur.planner.robots.robot import Robot
from assur.planner.selection import columns as c
from assur.planner.selection.columns import Times
from assur.planner.selection.times import CycleTerms, Lane, Place, times_of
from assur.scenes.requests import cell_of

BELT_M, PART_M = 0.05, 0.01
"""Height of belts and places, and of the tool's point in a part on them, m."""
TCP_M, STRAIGHT_M = -0.1, 0.03
STRAIGHT_S, DWELL_PICK_S, DWELL_PLACE_S = 0.0563, 0.10, 0.08
"""Down, or up: half of its ramp is within the travel."""
APART_M = 0.06
"""Between two parts in a lane, at least."""
LATENCY_S = 0.08
"""From the camera line until a part is known."""
LONGEST_BATCH, IN_BATCH_S = 5, 0.15


@dataclass(frozen=True)
class Belt:
    """A belt along the world's x that is at `y`, m: speed, m/s; offsets of its lanes, m; its share of all parts."""

    y: float
    speed: float = 0.2
    lanes: tuple[float, ...] = (0.0,)
    share: float = 1.0


@dataclass(frozen=True)
class Cell:
    """Belts; places (x, y), m, and the share of the parts for each; the window of every belt along x, m; the carton
    belt that replaces a place: speed, m/s, pitch, m, window, m; how far the camera line is before the window, m."""

    belts: tuple[Belt, ...] = (Belt(0.35),)
    places: tuple[tuple[float, float], ...] = ((0.30, -0.23),)
    shares: tuple[float, ...] = (1.0,)
    window: tuple[float, float] = (-0.25, 0.25)
    carton: tuple[float, float, tuple[float, float]] | None = None
    camera: float = 0.4

    def at_speed(self, speed: float) -> Cell:
        """The first belt has this speed, m/s, and the others keep their ratio to it."""
        ratio = speed / self.belts[0].speed
        return replace(self, belts=tuple(replace(belt, speed=belt.speed * ratio) for belt in self.belts))

    @property
    def lanes(self) -> list[tuple[Belt, float]]:
        return [(belt, offset) for belt in self.belts for offset in belt.lanes]

    @property
    def weights(self) -> FloatArray:
        """The share of each lane and each place (L, P)."""
        return np.outer([belt.share / len(belt.lanes) for belt, _ in self.lanes], self.shares)


FIVE, THREE = (-0.12, -0.06, 0.0, 0.06, 0.12), (-0.06, 0.0, 0.06)
CELLS = {
    "one lane": Cell(),
    "downstream nest": Cell((Belt(0.33, lanes=FIVE),), ((0.40, -0.05),), window=(-0.3, 0.3)),
    "upstream nest": Cell((Belt(0.33, lanes=FIVE),), ((-0.40, -0.05),), window=(-0.3, 0.3)),
    "carton": Cell((Belt(0.33, lanes=THREE),), ((0.0, -0.33),), window=(-0.3, 0.3), carton=(0.06, 0.05, (-0.25, 0.25))),
    "two belts": Cell(
        (Belt(0.35, lanes=(-0.04, 0.04), share=0.5), Belt(-0.35, 0.1, (-0.04, 0.04), 0.5)), ((0.40, 0.0),)
    ),
    "mixed parts": Cell(
        (Belt(0.33, lanes=THREE),), ((0.42, -0.05), (-0.42, -0.05), (0.1, -0.38)), (0.4, 0.4, 0.2), (-0.3, 0.3)
    ),
    "two belts, two places": Cell(
        (Belt(0.35, lanes=THREE, share=0.5), Belt(-0.35, lanes=THREE, share=0.5)),
        ((0.42, 0.0), (-0.42, 0.0)),
        (0.5, 0.5),
        (-0.3, 0.3),
    ),
}


@cache
def arm() -> Robot:
    """The SCARA of all cells."""
    document = {
        "schema": "assur/1",
        "robot": {
            "model": "mitsubishi-rh-6frh5520",
            "tool": {"tcp_m": [0.0, 0.0, TCP_M]},
            "limits": {"acceleration": 0.6, "jerk": 0.8, "j4_deg": [-180, 180]},
        },
        "start": {"elbow": "left", "tool": {"at_m": [0.3, 0.1, 0.2], "yaw_rad": 0.0}},
        "task": [{"move": {"to": {"at_m": [0.3, 0.1, 0.25]}}}],
    }
    return cell_of(document).scene.robot


@cache
def tables(cell: Cell) -> Times:
    """The times of a cell, with the elbow that is faster on average."""
    lanes = [
        Lane(conveyor(Pose(0.0, belt.y, BELT_M), belt.speed), Pose(0.0, offset, PART_M), _time(cell.window, belt.speed))
        for belt, offset in cell.lanes
    ]
    point = (Pose(0.0, 0.0, PART_M),)
    places = [Place(fixed(Pose(x, y, BELT_M)), point) for x, y in cell.places]
    if cell.carton:
        speed, pitch, window = cell.carton
        at = Pose(*cell.places[0], BELT_M)
        places = [Place(conveyor(at, speed), point, pitch / speed, _time(window, speed))]
    tcp = Pose(0.0, 0.0, TCP_M)
    handling = CycleTerms(tcp, STRAIGHT_M, 2 * STRAIGHT_S + DWELL_PICK_S, 2 * STRAIGHT_S + DWELL_PLACE_S)
    both = [times_of(arm(), (mode,), lanes, places, handling, cell.weights) for mode in (0, 1)]
    return min(both, key=lambda times: float(times.rides[0, c.NOMINAL]))


def _time(window: tuple[float, float], speed: float) -> tuple[float, float]:
    return window[0] / speed, window[1] / speed


@dataclass(frozen=True, eq=False)
class Stream:
    """Parts (N, PART) in the order in which they pass the camera line, and when each is known (N,), s."""

    parts: FloatArray
    known: FloatArray

    def first(self, many: int) -> Stream:
        return Stream(self.parts[:many], self.known[:many])


def stream(cell: Cell, load: float, seconds: float, seed: int) -> Stream:
    """Parts that arrive at random times for so many seconds, `load` parts in each mean cycle. The same seed draws the
    same numbers for every rule, load and speed."""
    times, rng = tables(cell), np.random.default_rng(seed)
    count = int(6 * seconds) + 50
    gaps, of_lane, of_place = rng.exponential(1.0, count), rng.random(count), rng.random(count)
    t = np.cumsum(gaps) * times.rides[0, c.NOMINAL] / load
    t = t[t < seconds]
    weights, speeds = cell.weights, np.array([belt.speed for belt, _ in cell.lanes])
    lane = np.searchsorted(np.cumsum(weights.sum(1)) / weights.sum(), of_lane[: len(t)] * 0.999999)
    place = np.searchsorted(np.cumsum(cell.shares) / sum(cell.shares), of_place[: len(t)] * 0.999999)
    line, last = cell.window[0] - cell.camera, dict[int, float]()
    for i, number in enumerate(lane.tolist()):
        t[i] = max(t[i], last.get(number, -np.inf) + APART_M / speeds[number])
        last[number] = t[i]
    order = np.argsort(t, kind="stable")
    t, lane, place = t[order], lane[order], place[order]
    return Stream(np.column_stack((lane, t - line / speeds[lane], place)).astype(np.float64), t + LATENCY_S)
