"""``python -m benchmarks.session_cycle``: a belt-to-nest cell at 60 parts a minute, each motion proved and checked.

A session picks part after part from a belt, and places each in a nest from which it is taken away: `see`, `propose`,
`commit` and `advance`, one cycle after the other. What the arm takes for that is simulated time; what this process
takes is measured. Each proposal is the first plan that is proved, and is checked.
"""

from __future__ import annotations

import gc
import time
from typing import Annotated

import typer

from assur import Session, check
from benchmarks.figures import Document, figure, finish, of_planned, progress
from benchmarks.machine import pin

CYCLES, FEW, FIRST = 500, 20, 10
"""Cycles; those before are not counted: in them the arm comes to its rhythm, and what is kept is made."""
PERIOD_S, SPEED_MM_S = 1.0, 150
"""A part comes so often, on a belt of this speed."""
CELL: Document = {
    "schema": "assur-cell/1",
    "robot": {"model": "mitsubishi-rh-6frh5520", "tool": {"tcp_mm": [0, 0, -100]}},
    "frames": {"belt": {"conveyor": {"at_mm": [0, 350, 50], "speed_mm_s": SPEED_MM_S}}},
    "kinds": {
        "bracket": {"shape": {"box": {"size_mm": [60, 40, 20]}}, "grasp_mm": [0, 0, 10], "dwell_ms": 50},
    },
    "positions": {"home": {"at_mm": [350, 0, 180], "yaw_deg": 0}, "nest": {"at_mm": [330, -120, 60], "yaw_deg": 0}},
    "options": {"stop": "first", "report": "none", "budget_s": 20, "max_candidates": 200, "stay_safe_s": 2},
}  # fmt: skip
START: Document = {"joints": {"j1_deg": 20, "j2_deg": 60, "j3_mm": 300, "j4_deg": 0}}
WINDOW_MM, TAKEN_MS = [-250, 250], 20
"""Where on the belt a part is picked; how soon it is gone from the nest."""


def main(quick: Annotated[bool, typer.Option("--quick", help="Few cycles.")] = False) -> None:
    """Measure the cycle of a session."""
    parameters: Document = {"cycles": FEW if quick else CYCLES, "period_s": PERIOD_S, "pinned": pin()}
    records = measured(parameters["cycles"])
    unplanned = sum(record["status"] != "planned" for record in records.values())
    note = f"{len(records)} cycles, {unplanned} without a plan"

    def ratio(rows: list[Document]) -> float:
        return float(sum(row["simulated_s"] for row in rows) / sum(row["wall_s"] for row in rows))

    figures = [
        figure(
            "simulated time over the time of a session", [records], ratio, "times", (60.0,), at_least=True, note=note
        ),
        figure("propose, with the check of its plan, median", [records], of_planned("propose_s", 0.5), "ms"),
        figure("propose, with the check of its plan, 95 %", [records], of_planned("propose_s", 0.95), "ms"),
        figure("see, commit and advance, median", [records], of_planned("others_s", 0.5), "ms", decimals=2),
    ]
    finish("session_cycle", "cycles of a session from a belt to a nest", quick, parameters, records, figures)


def measured(cycles: int) -> dict[str, Document]:
    """The records of so many cycles. Whether `assur.check` accepts an answer is not in the times: the session has
    its plan checked."""
    session, records = Session(CELL, start=START, refuge="home"), dict[str, Document]()
    for number in progress(range(FIRST + cycles), "cycles"):
        if number == FIRST:
            gc.collect()
            gc.freeze()  # as in a service: what the libraries have made is not looked through again
        part, before_s, began = f"part-{number}", session.clock_s, time.perf_counter()
        along_mm = -SPEED_MM_S * PERIOD_S * number + WINDOW_MM[0]
        session.see(part, kind="bracket", pose={"frame": "belt", "at_mm": [along_mm, 0, 10], "at_s": 0})
        seen = time.perf_counter()
        pick, place = {"part": part, "window_mm": WINDOW_MM}, {"part": part, "to": "nest", "gone_after_ms": TAKEN_MS}
        made = session.propose([{"pick": pick}, {"place": place}])
        proposed = time.perf_counter()
        if made.planned:
            session.commit(made)
            session.advance(made.starts_s)
        done = time.perf_counter()
        if number >= FIRST:
            verdict = check(made.answer.request or {}, made.answer)
            records[f"cycle {number}"] = {
                "status": made.answer["status"],
                "findings": [each["what"] for each in verdict["findings"]],
                "simulated_s": session.clock_s - before_s,
                "propose_s": proposed - seen,
                "others_s": done - proposed + seen - began,
                "wall_s": done - began,
            }
        if not made.planned:
            break
    gc.unfreeze()
    return records


if __name__ == "__main__":
    typer.run(main)
