"""The cells with streams as a data set: cells, arrivals of each seed as CSV, and what the rules reach."""

from __future__ import annotations

import csv
import json
import shutil
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

import assur
from assur.planner.errors import FaultError
from assur.planner.robots.scara import Scara
from assur.planner.selection.names import RULES
from assur.scenes.simulation.cell import SimulatedCell, simulated
from assur.scenes.streams.arrivals import arrivals
from benchmarks.flows import FLOWS, FOLDER, flow
from benchmarks.machine import commit, machine

Document = dict[str, Any]
TITLES = ("time_s", "x_m", "y_m", "yaw_rad", "kind")
OF_TABLE = ("frame", "kind", "kinds", "at_mm", "seen", "to", "window_mm")
"""Fields of a stream of these cells that stay when its parts come from a table."""
RESULTS = ("cell", "rule", "seed", "parts_per_minute", "known", "picked", "placed", "missed", "cycle_s", "moving")
"""Columns of the results: those behind the rule are fields of a run."""
PLANNING_MS = 20.0


def write_data_set(
    out: Path, *, minutes: float, seeds: Iterable[int], names: Sequence[str] = FLOWS, rules: Sequence[str] = RULES
) -> Iterator[str]:
    """Writes the folder, which the README in it describes; gives what is written next. `minutes`: of each run."""
    seeds = [*seeds]
    out.mkdir(parents=True, exist_ok=True)
    shutil.copy(FOLDER / "README.md", out / "README.md")
    stated = {"minutes": minutes, "seeds": seeds, "planning_ms": PLANNING_MS, "rules": [*rules]}
    _write_json(out / "parameters.json", {**stated, **commit(), "machine": machine()})
    for name in names:
        yield f"{name}, arrivals"
        write_cell(out / name, name, seeds, 60.0 * minutes)
    with (out / "results.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, RESULTS, extrasaction="ignore", lineterminator="\n")
        table.writeheader()
        for name, rule in ((name, rule) for name in names for rule in rules):
            yield f"{name}, {rule}"
            cell = {**flow(name), "selection": rule}
            for seed in seeds:
                (run,) = assur.simulate(cell, minutes=minutes, seed=seed, planning_ms=PLANNING_MS)["runs"]
                table.writerow({"cell": name, "rule": rule, **run})


def write_cell(folder: Path, name: str, seeds: Iterable[int], until_s: float) -> None:
    """The cell as it is published; its robot; and for each seed the parts that are known by `until_s`, s: a table for
    each stream, and the cell with these tables in place of random numbers."""
    folder.mkdir(parents=True, exist_ok=True)
    shutil.copy(FOLDER / f"{name}.yaml", folder / "cell.yaml")
    written = flow(name)
    cell = simulated(written)
    _write_json(folder / "robot.json", robot_of(cell))
    for seed in seeds:
        streams = {}
        for stream in cell.streams:
            file = f"seed-{seed}-{stream.name}.csv"
            with (folder / file).open("w", newline="", encoding="utf-8") as text:
                table = csv.writer(text, lineterminator="\n")
                table.writerow(TITLES)
                parts = sorted(arrivals(stream, seed, until_s), key=lambda part: part.time_s)
                table.writerows([p.time_s, p.x_m, p.y_m, p.yaw_rad, p.kind.name] for p in parts)
            own = written["streams"][stream.name]
            streams[stream.name] = {key: own[key] for key in OF_TABLE if key in own} | {"csv": {"file": file}}
        _write_json(folder / f"seed-{seed}.json", {**written, "streams": streams})


def robot_of(cell: SimulatedCell) -> Document:
    """The links and the limits of the arm of a cell: m and rad, and the same per s, s² and s³."""
    robot = cell.chooser.robot
    if not isinstance(robot, Scara):
        raise FaultError(f"{robot.name}: the cells of the data set have a SCARA")
    rows = zip(robot.joints, robot.limits.table.T.tolist(), strict=True)
    keys = ("lower", "upper", "velocity", "acceleration", "jerk")
    joints = [{"name": joint.name, **dict(zip(keys, limits, strict=True))} for joint, limits in rows]
    return {"model": robot.name, "l1_m": robot.l1, "l2_m": robot.l2, "joints": joints}


def _write_json(file: Path, document: Document) -> None:
    file.write_text(json.dumps(document, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
