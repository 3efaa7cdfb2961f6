"""The RRR dyad: position, velocity and acceleration of 10⁴ dyads, in this project's vector form and three others.

The printed equations of source 000, mended, are the measure; relative and natural coordinates stand beside them. All
run in the same process, one after the other in every round, over the same arrays cut into the same blocks. Before
anything is timed they must come to the same numbers, and every dyad to the code `ASSEMBLED`.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

import numpy as np

from assur.experiments import dyad_forms as forms
from assur.experiments import dyad_race as race
from assur.planner.arrays import FloatArray
from assur.planner.assur.codes import Code
from benchmarks.figures import figure
from benchmarks.section import Document, Item, Records, Section, Summary

BLOCKS = (500, 1000, 2000, 4000, 10_000)
"""Dyads that each formulation is given at once; the last is all of them."""
ALIKE = 4000
"""Largest block at which the bar is taken: above 4,096 the planner's kernel cuts its blocks smaller by itself."""
SAME = 1e-9
"""Largest relative difference between the forms that counts as equal: natural coordinates are iterated to 1e-12 of l²,
and 5 mm from an edge the printed arccos loses three digits."""
ROUNDS, QUICK_ROUNDS = 60, 6
REPEATS = 3
"""Runs of which the fastest counts, in a round: what else runs on the machine only slows down."""
FORMS = ("ours", "printed", "relative", "natural")

Form = Callable[[FloatArray], Any]


def parameters(quick: bool) -> Document:
    rounds = QUICK_ROUNDS if quick else ROUNDS
    return {"dyads": race.BATCHES[-1], "blocks": list(BLOCKS), "rounds": rounds, "repeats": REPEATS, "seed": race.SEED}


def items(parameters: Document) -> list[Item]:
    return [Item("dyad", f"round {i}") for i in range(parameters["rounds"])]


def natural(given: FloatArray) -> Any:
    """Natural coordinates from guesses that are the solution off by half of l1, as in
    `assur.experiments.dyad_timing`."""
    c = race.printed_batch(given).c
    random = np.random.default_rng(race.SEED)
    wanted = c.x, c.y
    guesses = np.stack(wanted) + random.normal(0.0, race.SPREAD * race.L1, (race.STARTS, 2, given.shape[1]))
    return partial(forms.natural_batch, race.columns(given), race.L1, race.L2, guesses, wanted, race.NEAR)


def unlike(given: FloatArray) -> list[str]:
    """What is not the same in all formulations."""
    made = race.kernel(given)
    if not (made.code == Code.ASSEMBLED).all():
        return ["a dyad is not ASSEMBLED"]
    found = []
    printed = race.printed_batch(given)
    truth = np.stack([*printed.phi[1:], *(getattr(printed.c, name) for name in ("x", "y", "xd", "yd", "xdd", "ydd"))])
    w1, a1 = made.rates[0][0], made.rates[1][0]
    (ux, uy), (a, s) = made.u, (given[:6], w1 * w1)
    ours = np.stack(
        [
            *(w1, a1, a[0] + ux, a[1] + uy, a[2] - w1 * uy, a[3] + w1 * ux),
            *(a[4] - a1 * uy - s * ux, a[5] + a1 * ux - s * uy),
        ]
    )
    others = {
        "ours": ours,
        "relative": forms.relative(race.columns(given), race.L1, race.L2, race.SIGMA, forms.ARRAYS)[1:],
        "natural": natural(given)()[0][1:],
    }
    turned = np.arctan2(uy, ux) - printed.phi[0]
    others["ours, angle"] = np.stack([*truth[:-1], truth[-1] + np.sin(turned)])
    for name, values in others.items():
        off = float((np.abs(np.stack(list(values)) - truth) / np.maximum(1.0, np.abs(truth))).max())
        if not off <= SAME:
            found.append(f"{name} differs from the printed equations by {off:.1e}")
    return found


@contextmanager
def measuring(parameters: Document, _group: str) -> Iterator[Callable[[str], Document]]:
    given = race.dyads(parameters["dyads"])
    findings = unlike(given)
    cut: dict[int, list[FloatArray]] = {}
    for block in parameters["blocks"]:
        parts = range(0, parameters["dyads"], block)
        cut[block] = [np.ascontiguousarray(given[:, i : i + block]) for i in parts]
    whole = [natural(part) for part in cut[parameters["blocks"][-1]]]

    def relative(part: FloatArray) -> Any:
        return forms.relative(race.columns(part), race.L1, race.L2, race.SIGMA, forms.ARRAYS)

    ways: dict[str, Form] = {"ours": race.kernel, "printed": race.printed_batch, "relative": relative}

    def measure(_item: str) -> Document:
        ns: dict[str, Document] = {}
        for block, parts in cut.items():
            of_block: Document = {}
            for name, way in ways.items():
                of_block[name] = fastest(partial(each, way, parts), parameters["repeats"]) / parameters["dyads"] * 1e9
            ns[str(block)] = of_block
        slow = fastest(lambda: [run() for run in whole], 1) / parameters["dyads"] * 1e9
        ns[str(parameters["blocks"][-1])]["natural"] = slow
        return {"ns": ns, "findings": findings}

    yield measure


def each(way: Form, parts: list[FloatArray]) -> None:
    """One formulation over all blocks."""
    for part in parts:
        way(part)


def fastest(run: Callable[[], object], repeats: int) -> float:
    """Seconds of the fastest of some runs."""
    best = np.inf
    for _ in range(repeats):
        began = time.perf_counter()
        run()
        best = min(best, time.perf_counter() - began)
    return best


def summary(parameters: Document, records: Records) -> Summary:
    blocks = [str(block) for block in parameters["blocks"]]
    rows = [record["ns"] for record in records.values() if "ns" in record]
    median = {
        block: {name: float(np.median([row[block][name] for row in rows])) for name in rows[0][block]}
        for block in blocks
        if rows
    }
    if not rows:
        return Summary((figure("dyad: ours over the printed equations", records, lambda _: None),))
    best = min((block for block in blocks if int(block) <= ALIKE), key=lambda block: median[block]["printed"])

    def ratio(records: Any) -> float:
        return float(np.median([row["ns"][best]["ours"] / row["ns"][best]["printed"] for row in records]))

    note = f"both in blocks of {int(best):,}, at which the printed equations are fastest"
    figures = [figure("dyad: ours over the printed equations", records, ratio, note=note)]
    for name in FORMS:
        block = blocks[-1] if name == "natural" else best

        def value(records: Any, name: str = name, block: str = block) -> float:
            return float(np.median([row["ns"][block][name] for row in records]))

        figures.append(figure(f"dyad: {name}", records, value, "ns"))
    return Summary(tuple(figures), {"median_ns": median, "block": int(best)})


SECTION = Section("dyad", "the RRR dyad in four formulations", parameters, items, measuring, summary)
