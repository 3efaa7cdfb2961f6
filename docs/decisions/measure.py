"""``python docs/decisions/measure.py WHAT``: prints the figures that docs/decisions cite.

grid      grids of meeting times against one of 1 ms
knots     motions that were timed, what that and their knots cost, and how many splines break a limit
scores    candidates that seem free by their coarse score, how many of them are, and what a score costs beside the rest
limits    limits that are found in made logs of motion

Each part runs the planner as it is, and beside it the planner with the one choice undone. Counts are the same on every
machine as long as no clock ends a search; times are not.
"""

from __future__ import annotations

import json
import time
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from rich.console import Console
from rich.table import Table

import assur.planner.legs.joint
import assur.planner.legs.meeting
import assur.planner.timing.solver
from assur.planner import Scene, plan
from assur.planner.collision.proof import Prover
from assur.planner.collision.screening import screen
from assur.planner.kernels.candidates import OPTION
from assur.planner.legs.limits import beyond_limits
from assur.planner.model.outcome import Planned
from assur.planner.model.refusal import Reason, Refusal
from assur.planner.robots.facts import Limits
from assur.planner.search.candidates import Population
from assur.planner.search.extension import extended, timed
from assur.planner.search.meeting_options import options
from assur.planner.search.partial_plan import Candidate, TimedCandidate, initial, prepared
from assur.planner.search.rough_score import CoarseScore
from assur.planner.search.tuning import FREE, MOST_OPTIONS, NEARLY_FREE
from assur.planner.search.via_batch import shape_of
from assur.planner.timing import trajectory_of
from assur.planner.trajectory import Trajectory
from assur.scenes.identification.limits import joint_limits
from assur.scenes.identification.recording import JointRecord
from assur.scenes.requests import scene_of
from benchmarks.recorded_motion import KINDS, random_log
from benchmarks.translation import Terms, request

ROOT = Path(__file__).parents[2]
SETS = ("static", "moving_bodies", "moving_goal")
PATIENT_S = 30.0
"""Longest search, s: long enough that a count ends it."""
CANDIDATES = 400
"""The count that does."""
OUT = Console(width=110)


def problems(name: str, limit: int, match: str = "position") -> Iterator[tuple[str, Scene]]:
    """The first problems of a set as scenes, at the clearance of the benchmark, 0."""
    found = json.loads((ROOT / "benchmarks" / "problems" / f"{name}.json").read_text(encoding="utf-8"))
    limits = {key: tuple(value) for key, value in found.items() if key in ("qmin", "qmax", "vmax", "amax", "jmax")}
    terms = Terms(PATIENT_S, "first", "velocity" if match == "velocity" else "position")
    for problem in found["problems"][:limit]:
        document = request(problem, limits, terms)
        document["options"]["max_candidates"] = CANDIDATES
        yield problem["id"], scene_of(document)


@contextmanager
def swapped(owner: Any, name: str, other: Any) -> Iterator[None]:
    """`owner.name` is `other` inside the block."""
    kept = getattr(owner, name)
    setattr(owner, name, other)
    try:
        yield
    finally:
        setattr(owner, name, kept)


def table(*columns: str) -> Table:
    made = Table(box=None, pad_edge=False)
    for i, column in enumerate(columns):
        made.add_column(column, justify="left" if i == 0 else "right")
    return made


def grid(limit: int) -> None:
    """Decision 0007. First plans to moving goals; durations against those of 1 ms, over problems that all solve."""
    found: dict[float, dict[str, float]] = {}
    spent: dict[float, list[float]] = defaultdict(list)
    for step in (0.001, 0.002, 0.004, 0.008, 0.016):
        found[step] = {}
        with swapped(assur.planner.legs.meeting, "GRID_S", step), swapped(assur.planner.legs.joint, "GRID_S", step):
            for problem, scene in problems("moving_goal", limit):
                began = time.perf_counter()
                outcome = plan(scene)
                spent[step].append(time.perf_counter() - began)
                if isinstance(outcome, Planned):
                    found[step][problem] = outcome.plan.trajectory.end
    everywhere = set.intersection(*(set(each) for each in found.values()))
    made = table("grid, ms", "solved", "longer than at 1 ms: quarter, half, three quarters, ms", "planning, median ms")
    for step, each in found.items():
        more = [1e3 * (each[name] - found[0.001][name]) for name in everywhere]
        cost = f"{1e3 * np.median(spent[step]):.1f}"
        quarters = ", ".join(f"{x:.1f}" for x in np.quantile(more, (0.25, 0.5, 0.75))) if more else ""
        made.add_row(f"{1e3 * step:g}", str(len(each)), quarters, cost)
    OUT.print(made)


def knots(limit: int) -> None:
    """Decision 0008."""
    seconds: dict[str, list[float]] = {"timed": [], "knots": []}
    beyond = {"rates": 0, "positions": 0}

    def counted(name: str, kept: Callable[..., Any]) -> Callable[..., Any]:
        def inner(*arguments: Any) -> Any:
            began = time.perf_counter()
            result = kept(*arguments)
            seconds[name].append(time.perf_counter() - began)
            return result

        return inner

    def checked(scene: Scene, step: int, path: Trajectory, limits: Limits) -> Refusal | None:
        found = beyond_limits(scene, step, path, limits)
        if found is not None:
            beyond["positions" if found.reason is Reason.JOINT_LIMIT else "rates"] += 1
        return found

    solver, joint = assur.planner.timing.solver.Solver, assur.planner.legs.joint
    made = table("set", "timed", "each, µs", "splines", "each, µs", "break a rate limit", "leave a joint's range")
    for name in SETS:
        for each in seconds.values():
            each.clear()
        beyond.update(rates=0, positions=0)
        with (
            swapped(solver, "raw_profile", counted("timed", solver.raw_profile)),
            swapped(joint, "trajectory_of", counted("knots", trajectory_of)),
            swapped(joint, "beyond_limits", checked),
        ):
            for _, scene in problems(name, limit):
                plan(scene)
        cells = [cell for each in seconds.values() for cell in (str(len(each)), f"{1e6 * np.median(each):.0f}")]
        made.add_row(name, *cells, *(str(count) for count in beyond.values()))
    OUT.print(made)


def scores(limit: int) -> None:
    """Decision 0012: the first candidates that are drawn for each problem, all of them timed and screened."""
    made = table(
        "set", "drawn", "free", "seem free", "of these free", "free but seem not", "a candidate, score : the rest"
    )
    for name in SETS:
        free, seem, both, drawn, cost = 0, 0, 0, 0, []
        for _, scene in problems(name, limit):
            prover, chain, rng = Prover(scene), initial(scene), np.random.default_rng(0)
            found = prepared(scene, chain, 0.0, None, tuple(range(len(scene.robot.modes))))
            met = [meeting for meeting in found if not isinstance(meeting, Refusal)]
            ways = options(scene, chain, met)[:MOST_OPTIONS]
            if not ways:
                continue
            population = Population(scene, chain, ways, CoarseScore(prover, chain, ways), rng)
            rows = population.freedom.drawn(rng, DRAWN, population.shares)
            began = time.perf_counter()
            bad, _ = population.score(rows, rng)
            may = bad <= NEARLY_FREE
            bad[may] = np.maximum(bad[may], population.score.finely(rows[may])[0])
            seems = bad <= FREE
            scored = time.perf_counter()
            really = np.zeros(DRAWN, dtype=bool)
            for i in range(DRAWN):
                option = ways[int(rows[i, OPTION])]
                way = timed(scene, chain, Candidate(option, shape_of(rows[i])), None)
                if isinstance(way, TimedCandidate) and screen(prover, way).refusal is None:
                    really[i] = not isinstance(extended(scene, way), Refusal)
            cost.append((time.perf_counter() - scored) / (scored - began))
            drawn, free, seem = drawn + DRAWN, free + int(really.sum()), seem + int(seems.sum())
            both += int((really & seems).sum())
        shares = (f"{100 * share:.0f} %" for share in (free / drawn, seem / drawn, both / max(1, seem)))
        made.add_row(name, str(drawn), *shares, f"{free - both}", f"1 : {np.median(cost):.0f}")
    OUT.print(made)


def limits(limit: int) -> None:
    """Decision 0018."""
    limits_in(KINDS, limit)


def limits_in(kinds: Sequence[str], limit: int) -> None:
    """Limits in made logs of these kinds; how many are identified, how wrong they are, and how much is said that is
    untrue."""
    made = table("log", "joints", *(f"{rate}: {what}" for rate in RATES for what in ("identified", "worst", "untrue")))
    for kind in kinds:
        joints = 0
        off: dict[str, list[float]] = {rate: [] for rate in RATES}
        untrue = dict.fromkeys(RATES, 0)
        for seed in range(limit):
            truth, at, readings = random_log(kind, seed)
            records = [JointRecord(at, column) for column in readings.T]
            for i, record in enumerate(records):
                found, joints = joint_limits(record, records[:i] + records[i + 1 :]), joints + 1
                for rate in RATES:
                    estimate, right = getattr(found, rate), float(getattr(truth, rate)[i])
                    if estimate.status == "identified":
                        off[rate].append(abs(estimate.value / right - 1))
                        untrue[rate] += abs(estimate.value - right) > estimate.error
                    elif estimate.status == "lower_bound":
                        untrue[rate] += estimate.value > right
        cells = [
            cell
            for rate in RATES
            for cell in (str(len(off[rate])), f"{100 * max(off[rate], default=0):.2g} %", str(untrue[rate]))
        ]
        made.add_row(kind, str(joints), *cells)
    OUT.print(made)


DRAWN = 96
"""Candidates that are drawn of each problem."""
RATES = ("acceleration", "jerk")
WHAT = {"grid": grid, "knots": knots, "scores": scores, "limits": limits}


def main(
    what: Annotated[str, typer.Argument(help=", ".join(WHAT))],
    limit: Annotated[int, typer.Option(min=1, help="Problems of each set, or scenarios, to look at.")] = 40,
) -> None:
    """Print the figures that docs/decisions cite."""
    if what not in WHAT:
        raise typer.BadParameter("one of " + ", ".join(WHAT), param_hint="WHAT")
    WHAT[what](limit)


if __name__ == "__main__":
    typer.run(main)
