"""Runs of a cell with several seeds, and what they come to."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator
from itertools import combinations
from typing import TYPE_CHECKING, Any, NamedTuple

from assur.scenes.session.executed import worst
from assur.scenes.session.session import number
from assur.scenes.simulation.leg_times import of_runs
from assur.scenes.simulation.words import PARTS, bottleneck

if TYPE_CHECKING:
    from assur.scenes.session.recorded import Record

Document = dict[str, Any]
SIMULATION = "assur-simulation/1"
"""Version of the document."""
MOST_MINUTES, MOST_SEEDS, MOST_SEED = 24.0 * 60.0, 1_000, 2**32
LEAST_MINUTES = 0.01
CONFIDENCE = 0.95
EMPTY = 0.05
"""From this share of a run on, the time until its first part is put down is noted."""
MOST_PLANNING_MS = 60_000.0
Watch = Callable[[int, float], None]
"""Is given the number of a run, from 0, and the simulated time in it, s."""


class Arguments(NamedTuple):
    """Of a simulation: the length of each run, min; the first seed, and how many; how long planning takes, ms."""

    minutes: float
    seed: int
    seeds: int
    planning_ms: float


def arguments(minutes: object, seed: object, seeds: object, planning_ms: object) -> Arguments:
    """The arguments of a simulation. Raises `InputError` that names the first that is not right."""
    return Arguments(
        number("minutes", minutes, LEAST_MINUTES, MOST_MINUTES),
        whole("seed", seed, 0, MOST_SEED),
        whole("seeds", seeds, 1, MOST_SEEDS),
        number("planning_ms", planning_ms, 0.0, MOST_PLANNING_MS),
    )


def nothing(run: int, now_s: float) -> None:
    """Watches nothing."""


class Simulation:
    """Runs of one cell. Each call of `run` makes them; what is complete when it is interrupted stays."""

    def __init__(self, cell: Document, minutes: object, seed: object, seeds: object, planning_ms: object) -> None:
        """Raises `InputError` naming the argument, or the field of the cell."""
        from assur.scenes.simulation.cell import simulated

        self.minutes, self.first, self.count, self.planning_ms = arguments(minutes, seed, seeds, planning_ms)
        self.until_s = 60.0 * self.minutes
        self.given, self.cell = cell, simulated(cell)
        self.runs: list[Document] = []

    def with_cell(self, cell: Document) -> Simulation:
        """The same runs of another cell. Raises `InputError`, at the field of the cell."""
        return Simulation(cell, self.minutes, self.first, self.count, self.planning_ms)

    @property
    def rates(self) -> list[float]:
        """Parts a minute of each run."""
        return [run["parts_per_minute"] for run in self.runs]

    @property
    def complete(self) -> bool:
        """Whether all runs went to their end."""
        return all(run["simulated_s"] == self.until_s for run in self.runs) and len(self.runs) == self.count

    def run(self, watch: Watch = nothing, record: Record | None = None) -> None:
        """Makes the runs, one after the other. If something is raised meanwhile, the run until then is kept. `record`
        gets the calls of the first one. Raises `InputError` before the first run for a seed with which a stream brings
        nothing in the time."""
        from assur.scenes.simulation.run import Run, coming_parts

        for seed in range(self.first, self.first + self.count):
            coming_parts(self.cell, seed, self.until_s)
        for k in range(len(self.runs), self.count):
            run = Run(self.cell, self.first + k, self.until_s, self.planning_ms, record if k == 0 else None)
            try:
                while not run.over:
                    run.step()
                    watch(k, min(run.session.clock_s, self.until_s))
            finally:
                now_s = min(run.session.clock_s, self.until_s)
                if now_s > 0.0:
                    self.runs.append({"seed": self.first + k, **run.tally.figures(now_s)})

    @property
    def document(self) -> Document:
        """What the runs come to."""
        rates = self.rates
        total_s = sum(run["simulated_s"] for run in self.runs)
        waiting, refusals = Counter[str](), Counter[str]()
        for run in self.runs:
            waiting.update(run["waiting_s"])
            refusals.update(run["refusals"])
        cycles = [(run["placed"], run["cycle_s"]) for run in self.runs if run["cycle_s"] is not None]
        many = sum(placed for placed, _ in cycles)
        low_high = interval(rates, 1.0 / self.minutes)
        found = {
            "schema": SIMULATION,
            "minutes": self.until_s / 60.0,
            "planning_ms": self.planning_ms,
            "selection": self.cell.chooser.rule,
            "elbow": self.cell.chooser.elbow,
            "complete": self.complete,
            "parts_per_minute": sum(rates) / len(rates) if rates else 0.0,
            "interval": None if low_high is None else [max(0.0, low_high[0]), low_high[1]],
            **{key: sum(run[key] for run in self.runs) for key in PARTS},
            "cycle_s": sum(placed * cycle for placed, cycle in cycles) / many if many else None,
            "table_cycle_s": float(self.cell.chooser.nominal_s),
            "moving": sum(run["moving"] * run["simulated_s"] for run in self.runs) / total_s if total_s else 0.0,
            "waiting": {reason: time_s / total_s for reason, time_s in waiting.most_common()},
            "legs": of_runs(self.runs, total_s) if total_s else [],
            "worst_pick_error": worst(run["worst_pick_error"] for run in self.runs),
            "refusals": dict(refusals.most_common()),
            "examples": {k: text for run in reversed(self.runs) for k, text in run["examples"].items()},
            **{key: sum(run[key] for run in self.runs) for key in ("plans", "checked")},
            "notes": [*self._notes(sum(p * c for p, c in cycles) / many if many else self.cell.chooser.nominal_s)],
            "runs": self.runs,
        }
        return found | {"bottleneck": bottleneck(found)}

    def _notes(self, cycle_s: float) -> Iterator[str]:
        yield from (*self.cell.heights, *self.cell.room)
        first_s = [run["first_placed_s"] for run in self.runs if run["first_placed_s"] is not None]
        if first_s and (mean_s := sum(first_s) / len(first_s)) > EMPTY * self.until_s:
            yield (
                f"a run begins with an empty cell, and its first part is put down after {mean_s:.3g} s of "
                f"{self.until_s:.4g} s: a longer run gives more parts a minute, and other shares of waits"
            )
        for stream in self.cell.chooser.streams.values():
            needed_m = stream.speed_m_s * (cycle_s + stream.latency_s) + 2.0 * stream.radius_m
            there_m = stream.window_m[0] - stream.seen_m
            if there_m < needed_m:
                yield (
                    f"{stream.name}: the line at which parts are seen is {1e3 * there_m:.0f} mm before the window. "
                    f"Until a part is known, clear of what is not seen, and a cycle is over, it goes "
                    f"{1e3 * needed_m:.0f} mm: the line is too near to know in time which part is next"
                )
        for one, other in combinations(self.cell.streams, 2):
            least_m = one.radius_m + other.radius_m
            if one.frame == other.frame and _apart(one.offsets_m, other.offsets_m) < least_m:
                yield (
                    f"{one.name} and {other.name} come in the same lane of {one.frame}: neither knows the other, "
                    f"so their parts may lie inside each other. One stream with the kinds of both keeps them apart"
                )
        if self.cell.chooser.orders_little:
            yield "parts in one lane for one grid of slots: in which order they are taken hardly matters"


def _apart(one: tuple[float, float], other: tuple[float, float]) -> float:
    """How far two ranges are apart; less than 0 where they overlap."""
    return max(one[0] - other[1], other[0] - one[1])


def interval(rates: list[float], step: float = 0.0) -> list[float] | None:
    """The 95 % interval of the mean over seeds (Student's t); None for fewer than two. `step`: by how much a rate
    changes with one part. Rates are known no better than to that, also where all of them are the same."""
    if len(rates) < 2:
        return None
    from scipy.special import stdtrit

    mean = sum(rates) / len(rates)
    spread = math.sqrt(sum((rate - mean) ** 2 for rate in rates) / (len(rates) - 1) + step**2 / 12.0)
    half = float(stdtrit(len(rates) - 1, 0.5 + 0.5 * CONFIDENCE)) * spread / math.sqrt(len(rates))
    return [mean - half, mean + half]


def whole(field: str, value: object, least: int, most: int) -> int:
    """A whole number between two bounds. Raises `InputError` for anything else."""
    from assur.planner.errors import InputError

    if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= most:
        raise InputError(field, value, f"a whole number, {least} to {most}")
    return value
