"""``python docs/decisions/measure.py WHAT``: prints the figures that docs/decisions cite.

rows      rows of the certificate as it is, by first order only (C2), and without the combinations of joint rates
contacts  what the approach axis alone would say of the contacts that are proved
grown     pairs further apart than the clearance that FCL refuses when the arm is grown by it
grid      grids of meeting times against one of 1 ms
knots     motions that were timed, what that and their knots cost, and how many splines break a limit
glances   ways that seem free to a glance, how many of them are, and what a glance costs beside timing and screening

Each part runs the planner as it is, and beside it the planner with the one choice undone. Counts are the same on every
machine as long as no clock ends a search; times are not.
"""

from __future__ import annotations

import json
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Annotated, Any

import numpy as np
import typer
from rich.console import Console
from rich.table import Table

import assur.planner.collision.proof
import assur.planner.collision.proof_facts
import assur.planner.legs.joint
import assur.planner.legs.meeting
import assur.planner.timing.solver
from assur.planner import Scene, plan
from assur.planner.collision.gjk import separate
from assur.planner.collision.proof import Prover
from assur.planner.collision.proof_facts import Facts
from assur.planner.collision.rows import Rows
from assur.planner.collision.screening import screen
from assur.planner.collision.support_gaps import rough_gaps
from assur.planner.errors import FaultError
from assur.planner.geometry.shapes import Primitive
from assur.planner.legs.limits import beyond_limits
from assur.planner.model.outcome import Plan, Planned, Reason, Refusal
from assur.planner.model.phases import Phase, phases
from assur.planner.search.beam import MOST_WAYS
from assur.planner.search.extension import carried_gently, outline
from assur.planner.search.meeting_options import options
from assur.planner.search.partial_plan import Outline, Sample, initial, prepared
from assur.planner.search.population import Population
from assur.planner.search.rough_score import Glance
from assur.planner.timing import trajectory_of
from assur.planner.trajectory import Trajectory
from assur.planner.trajectory.sweep import sweep
from assur.scenes.requests import scene_of, shipped, shipped_scenarios
from benchmarks.translation import Manners, request

ROOT = Path(__file__).parents[2]
SETS = ("static", "moving_bodies", "moving_goal")
PATIENT_S = 30.0
"""Longest search, s: long enough that a count ends it."""
CANDIDATES = 400
"""The count that does."""
COARSEST = (0.02, 0.16)
"""Intervals to begin with, s: the planner's own, and longer ones, at which bounds matter more."""
OUT = Console(width=110)


def problems(name: str, limit: int, match: str = "position") -> Iterator[tuple[str, Scene]]:
    """The first problems of a set as scenes, at the clearance of the benchmark, 0."""
    found = json.loads((ROOT / "benchmarks" / "problems" / f"{name}.json").read_text(encoding="utf-8"))
    limits = {key: tuple(value) for key, value in found.items() if key in ("qmin", "qmax", "vmax", "amax", "jmax")}
    manners = Manners(PATIENT_S, "first", "velocity" if match == "velocity" else "position")
    for problem in found["problems"][:limit]:
        document = request(problem, limits, manners)
        document["options"]["max_candidates"] = CANDIDATES
        yield problem["id"], scene_of(document)


def solved(name: str, limit: int) -> Iterator[tuple[str, Scene, Plan]]:
    for problem, scene in problems(name, limit):
        outcome = plan(scene)
        if isinstance(outcome, Planned):
            yield problem, scene, outcome.plan


def shipped_plans(limit: int) -> Iterator[tuple[str, Scene, Plan]]:
    """The shipped scenarios that are planned, with their clearances; the first plan of each."""
    for name in list(shipped_scenarios())[:limit]:
        scene = scene_of(shipped(name).request, folder=shipped(name).folder)
        options = replace(scene.options, stop="first", budget_s=PATIENT_S, max_candidates=CANDIDATES)
        scene = replace(scene, options=replace(options, explain_budget_s=0.0))
        outcome = plan(scene)
        if isinstance(outcome, Planned):
            yield name, scene, outcome.plan


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


def first_order(kept: Callable[..., Any]) -> Callable[..., Any]:
    """Bounds of point motion that know no acceleration: only (C2) is left."""

    def bounds(facts: Facts, *arguments: Any) -> Any:
        speed, acceleration = kept(facts, *arguments)
        return speed, np.full_like(acceleration, np.inf)

    return bounds


def joint_by_joint(trajectory: Any, t0: Any, t1: Any, rate_matrix: Any) -> Any:
    """Sums of the bounds of each joint's rate, where the planner bounds the combinations themselves."""
    each = sweep(trajectory, t0, t1, np.eye(trajectory.n))
    size = np.abs(rate_matrix).T
    return replace(each, rate=each.rate @ size, rate_d=each.rate_d @ size)


def proof(scene: Scene, made: Plan) -> tuple[int, bool]:
    """Rows of the proof of a plan, and whether it is whole."""
    prover, count = Prover(scene), 0
    for phase in phases(scene, made.legs, made.arrivals):
        found = prover.prove(phase, made.trajectory)
        if not isinstance(found, Rows):
            return count, False
        count += len(found.t0)
    return count, True


def rows(limit: int) -> None:
    """Decisions 0004 and 0009."""
    variants: dict[str, Any] = {
        "as it is": (Facts, "bounds", Facts.bounds),
        "first order only": (Facts, "bounds", first_order(Facts.bounds)),
        "joint by joint": (assur.planner.collision.proof_facts, "sweep", joint_by_joint),
    }
    found = table("set", "begin with, ms", "proof", "plans", "rows, median", "rows, all", "not proved")
    for name in (*SETS, "shipped scenarios"):
        plans = list(solved(name, limit) if name in SETS else shipped_plans(limit))
        for coarsest in COARSEST:
            for title, change in variants.items():
                with swapped(assur.planner.collision.proof, "COARSEST_S", coarsest), swapped(*change):
                    counts = [proof(scene, made) for _, scene, made in plans]
                whole = [count for count, ok in counts if ok]
                middle = f"{np.median(whole):.0f}" if whole else ""
                cells = (len(counts), middle, sum(whole), len(counts) - len(whole))
                found.add_row(name, f"{1e3 * coarsest:g}", title, *map(str, cells))
    OUT.print(found)


def contacts(limit: int) -> None:
    """Decision 0005. Of every pair that may touch, the least gap along the vertical and along the proved normals."""
    found = table("scenario", "pair", "legs", "along the approach axis, mm", "as proved, mm")
    for name, scene, made in shipped_plans(limit):
        least: dict[tuple[str, str], tuple[float, float, set[str]]] = {}
        prover = Prover(scene)
        for phase in phases(scene, made.legs, made.arrivals):
            for pair, vertical, proved in touching(scene, prover, phase, made):
                one, other, kinds = least.get(pair, (np.inf, np.inf, set()))
                least[pair] = min(one, vertical), min(other, proved), kinds | {str(phase.kind)}
        for pair, (vertical, proved, kinds) in least.items():
            found.add_row(
                name, " / ".join(pair), " ".join(sorted(kinds)), f"{1e3 * vertical:.2f}", f"{1e3 * proved:.2f}"
            )
    OUT.print(found)


def touching(scene: Scene, prover: Prover, phase: Phase, made: Plan) -> Iterator[tuple[tuple[str, str], float, float]]:
    """Of each exempt pair of a phase: gap along the vertical every 20 ms, and gap of the rows, m; least of both."""
    if not (phase.exempt and phase.t1 > phase.t0):
        return
    solids = prover.solids(phase.carried, phase.rides)
    facts = Facts(scene, solids, phase, made.trajectory)
    proved = prover.prove(phase, made.trajectory)
    if not isinstance(proved, Rows):
        raise FaultError(f"{phase.kind} is not proved again")
    edges = np.linspace(phase.t0, phase.t1, 2 + int((phase.t1 - phase.t0) / 0.02))
    table_ = facts.intervals(edges[:-1], edges[1:])
    for first, second in facts.exempt:
        mine = (solids.body[proved.first] == first) & (solids.body[proved.second] == second)
        if not mine.any():
            continue
        a, b = (np.array(solids.pieces[body]) for body in (first, second))
        least = np.inf
        for i in a:
            for j in b:
                row = np.arange(len(table_))
                one, other = np.full(len(row), i), np.full(len(row), j)
                placed = facts.thrice(table_, row, one, other)
                claim = facts.claim(table_, row, one, other, placed, placed.vertical())
                least = min(least, float(np.minimum(claim.gap0, claim.gap1).min()))
        gap = float(np.minimum(proved.gap0[mine], proved.gap1[mine]).min())
        yield (solids.names[first], solids.names[second]), least, gap


def grown(limit: int) -> None:
    """Decision 0006."""
    found = table("set", "clearance, mm", "pairs beyond it, within twice it", "refused all the same")
    for name in SETS:
        for clearance in (0.002, 0.008):
            far, refused = 0, 0
            for _, scene, made in solved(name, limit):
                counts = near_pairs(scene, made, clearance)
                far, refused = far + counts[0], refused + counts[1]
            share = f"{refused} ({100 * refused / far:.0f} %)" if far else "0"
            found.add_row(name, f"{1e3 * clearance:g}", str(far), share)
    OUT.print(found)


def near_pairs(scene: Scene, made: Plan, clearance: float) -> tuple[int, int]:
    """Poses every 5 ms: pairs from one to two clearances apart, and those of them that touch with the arm grown."""
    prover = Prover(scene)
    solids = prover.solids(None, ())
    a, b = prover.asked(solids)
    phase = phases(scene, made.legs, made.arrivals)[0]
    facts = Facts(scene, solids, phase, made.trajectory)
    t = np.arange(made.trajectory.start, made.trajectory.end, 0.005)
    at = facts.intervals(t, t)
    where = replace(at.where, position=at.where.position[: len(t)], rotation=at.where.rotation[: len(t)])
    shapes = {id(shape): larger(shape, clearance) for shape in solids.shapes if isinstance(shape, Primitive)}
    fat: Any = SimpleNamespace(shapes=[shapes.get(id(shape), shape) for shape in solids.shapes], names=solids.names)
    fat.body = solids.body
    far = refused = 0
    for row, k in np.argwhere(rough_gaps(solids, where, a, b) < 2 * clearance):
        one, other = facts.thrice(at, np.array([row]), a[[k]], b[[k]]).middle()
        distance, normal = separate(one, other, 0)
        if normal is None or not clearance < distance < 2 * clearance:
            continue
        far += 1
        refused += prover.collider.touch(replace(one, solids=fat), other, 0)
    return far, refused


def larger(shape: Primitive, by: float) -> Primitive:
    """The primitive of the same kind that holds the shape grown by `by`: what a library without sums can be given."""
    half = tuple(h + by if h > 0 else 0.0 for h in shape.half)
    if shape.kind == "capsule":
        half = shape.half
    disc = shape.disc + by if shape.disc > 0 else 0.0
    return Primitive(shape.kind, (half[0], half[1], half[2]), disc, shape.ball + by if shape.ball > 0 else 0.0)


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

    def checked(scene: Scene, step: int, path: Trajectory) -> Refusal | None:
        found = beyond_limits(scene, step, path)
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


def glances(limit: int) -> None:
    """Decision 0012: the first ways that are drawn from the start of each problem, all of them timed and screened."""
    made = table("set", "drawn", "free", "seem free", "of these free", "free but seem not", "a way, glance : the rest")
    for name in SETS:
        free, seem, both, drawn, cost = 0, 0, 0, 0, []
        for _, scene in problems(name, limit):
            prover, chain, rng = Prover(scene), initial(scene), np.random.default_rng(0)
            meeting = prepared(scene, chain, 0.0, None, tuple(range(len(scene.robot.modes))))
            ways = () if isinstance(meeting, Refusal) else options(scene, chain, [(0.0, meeting)], MOST_WAYS)
            if not ways:
                continue
            population = Population(scene, chain, ways, Glance(prover, chain, ways), rng, adaptive=False)
            prospects = population.freedom.drawn(rng, DRAWN, population.shares)
            began = time.perf_counter()
            bad, _ = population.glance(prospects, rng)
            glanced = time.perf_counter()
            really = np.zeros(DRAWN, dtype=bool)
            for i in range(DRAWN):
                option = ways[int(prospects.option[i])]
                way = outline(scene, chain, option.meeting, Sample(0.0, option.branch, prospects.shape(i)), None)
                if isinstance(way, Outline) and screen(prover, [way])[0].refusal is None:
                    really[i] = not isinstance(carried_gently(scene, way), Refusal)
            cost.append((time.perf_counter() - glanced) / (glanced - began))
            drawn, free, seem = drawn + DRAWN, free + int(really.sum()), seem + int((bad == 0).sum())
            both += int((really & (bad == 0)).sum())
        shares = (f"{100 * share:.0f} %" for share in (free / drawn, seem / drawn, both / max(1, seem)))
        made.add_row(name, str(drawn), *shares, f"{free - both}", f"1 : {np.median(cost):.0f}")
    OUT.print(made)


DRAWN = 96
"""Ways that are drawn of each problem."""
WHAT = {"rows": rows, "contacts": contacts, "grown": grown, "grid": grid, "knots": knots, "glances": glances}


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
