"""``python -m benchmarks.proofs``: plans of random cells before both checkers; exit 1 if they do not agree."""

from __future__ import annotations

import signal
import statistics
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.progress import Progress

from benchmarks.checker_refusals import SECOND, codes_of, keep, objections
from benchmarks.judge.campaigns import ELBOW, own_seed
from benchmarks.judge.product import checked, planned, shown
from benchmarks.random_requests.random_cells import KINDS, random_cell

CONSOLE, PROGRESS = Console(width=140), Console(stderr=True)


@dataclass(eq=False)
class Agreement:
    """`shown`: plans that both checkers accept; `differ`: cells with a plan that a checker refuses, and its reason;
    `times`: of a bundle and its proof, s."""

    shown: int = 0
    refused: Counter[str] = field(default_factory=Counter)
    differ: list[tuple[str, int, str]] = field(default_factory=list)
    plans: int = 0
    times: list[float] = field(default_factory=list)


def agreements(plans: int, seed: int, out: Path | None = None) -> Iterator[Agreement]:
    """Cells of all kinds in turn, until `plans` have a plan: after each what was found so far."""
    found, number = Agreement(), 0
    while found.plans < plans:
        kind = list(KINDS)[number % len(KINDS)]
        own = own_seed(seed, number // len(KINDS))
        number += 1
        judged(found, kind, own, out)
        yield found


def judged(found: Agreement, kind: str, seed: int, out: Path | None = None) -> None:
    """Plans a random cell, and runs both checkers. If one of them refuses a plan, in the search or at the end, the
    request is written to `out`. Raises `ValueError` for a request that is at fault in anything but
    `ELBOW`, and `InputError` for an answer that no bundle can state."""
    request = random_cell(kind, seed)
    answer, fault = planned(request)
    if answer is None:
        if fault != ELBOW:
            raise ValueError(f"{kind}, seed {seed}: bad input in {fault}")
        found.refused[ELBOW] += 1
        return
    findings, refusal = list[Any](), ""
    if answer["status"] == "planned":
        found.plans += 1
        findings = checked(request, answer) or []
        began = time.perf_counter()
        refusal = shown(request, answer)
        found.times.append(time.perf_counter() - began)
        found.shown += not (findings or refusal)
    else:
        found.refused[str(answer["reason"])] += 1
    codes = codes_of(answer, findings) + [SECOND] * bool(refusal)
    if codes:
        found.differ.append((kind, seed, "; ".join([*codes, refusal])))
        if out is not None:
            keep(out, f"{kind}-{seed}", request, {"second": refusal, **objections(answer, findings)})


def main(
    plans: Annotated[int, typer.Option(min=1, help="Plans to judge.")] = 1000,
    seed: Annotated[int, typer.Option(min=0, help="Another seed makes other cells.")] = 0,
    out: Annotated[Path, typer.Option(help="Where requests whose plans are refused are written.")] = Path("out/proofs"),
) -> None:
    """Plan random cells, and run both checkers on each plan."""
    found = Agreement()
    # also where a shell that started this in the background has it ignored
    signal.signal(signal.SIGINT, signal.default_int_handler)
    with Progress(console=PROGRESS) as progress:
        task = progress.add_task("plans", total=plans)
        try:
            for found in agreements(plans, seed, out):
                progress.update(task, completed=found.plans)
        except KeyboardInterrupt:
            PROGRESS.print("interrupted: what was judged until then")
    if not found.plans:
        raise typer.Exit(1)
    CONSOLE.print(
        f"{found.plans} plans, {found.shown} accepted by both checkers; the second took"
        f" {statistics.median(found.times):.2f} s (median), {max(found.times):.2f} s at most"
    )
    CONSOLE.print(f"refused by a checker: {len(found.differ)}")
    for kind, own, refusal in found.differ:
        CONSOLE.print(f"{kind}, seed {own}: {refusal}")
    if found.differ:
        raise typer.Exit(1)


if __name__ == "__main__":
    typer.run(main)
