"""The data set of cells with streams: its tables give the parts of the seeds, and its results are those of runs."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer import Typer
from typer.testing import CliRunner

import assur
from assur.scenes.simulation.cell import simulated
from assur.scenes.streams.arrivals import ArrivingPart, arrivals
from assur.scenes.streams.stream import Stream
from benchmarks.flows import FLOWS, flow
from benchmarks.flows.__main__ import main
from benchmarks.flows.data_set import RESULTS, TITLES, write_cell, write_data_set

UNTIL_S = 120.0


def facts(parts: Iterable[ArrivingPart]) -> list[tuple[object, ...]]:
    """All of the parts but their names, which count the rows of a table, in the order of time."""
    found = [(p.time_s, p.x_m, p.y_m, p.yaw_rad, p.seen_s, p.known_s, p.kind.name, p.kind.to) for p in parts]
    return sorted(found)


def streams_of(document: Mapping[str, Any]) -> tuple[Stream, ...]:
    return simulated(dict(document)).streams


@pytest.mark.parametrize("name", FLOWS)
def test_the_tables_of_a_cell_give_the_same_parts_to_the_bit_as_its_seeds(name: str, tmp_path: Path) -> None:
    write_cell(tmp_path, name, (1, 7), UNTIL_S)
    own = streams_of(flow(name))
    for seed in (1, 7):
        of_table = streams_of(assur.load(tmp_path / f"seed-{seed}.json"))
        for stream, table in zip(own, of_table, strict=True):
            parts = arrivals(stream, seed, UNTIL_S)
            assert len(parts) > 30
            assert facts(arrivals(table, 99, UNTIL_S)) == facts(parts)  # whatever the seed of the run
            assert facts(arrivals(table, 99, UNTIL_S)) != facts(arrivals(stream, 99, UNTIL_S))
            assert table.offsets_m == stream.offsets_m
            assert table.rows is not None
            later = replace(
                table, rows=(*table.rows[:-1], replace(table.rows[-1], time_s=table.rows[-1].time_s + 1e-9))
            )
            assert facts(arrivals(later, 99, UNTIL_S)) != facts(parts)


@pytest.mark.parametrize("name", ["belt-to-nest", "two-belts-two-places"])
def test_a_run_with_the_tables_is_the_run_with_the_seed(name: str, tmp_path: Path) -> None:
    write_cell(tmp_path, name, (3,), 18.0)
    found = assur.simulate(assur.load(tmp_path / "seed-3.json"), minutes=0.3, seed=1)["runs"][0]
    assert found["placed"] > 3
    assert found == {**assur.simulate(flow(name), minutes=0.3, seed=3)["runs"][0], "seed": 1}


def test_the_data_set_has_the_results_of_the_runs_and_says_what_they_are(tmp_path: Path) -> None:
    rules = ("look-ahead", "fifo")
    written = write_data_set(tmp_path, minutes=0.2, seeds=(1, 2), names=("upstream-nest",), rules=rules)
    assert [*written] == ["upstream-nest, arrivals", "upstream-nest, look-ahead", "upstream-nest, fifo"]
    with (tmp_path / "results.csv").open(encoding="utf-8") as file:
        rows = [*csv.DictReader(file)]
    assert [(row["rule"], row["seed"]) for row in rows] == [(rule, seed) for rule in rules for seed in "12"]
    for row in rows:
        cell = {**flow("upstream-nest"), "selection": row["rule"]}
        run = assur.simulate(cell, minutes=0.2, seed=int(row["seed"]))["runs"][0]
        assert {key: row[key] for key in RESULTS[2:]} == {key: str(run[key]) for key in RESULTS[2:]}
    stated = json.loads((tmp_path / "parameters.json").read_text(encoding="utf-8"))
    assert (stated["minutes"], stated["seeds"], stated["planning_ms"]) == (0.2, [1, 2], 20.0)
    page = (tmp_path / "README.md").read_text(encoding="utf-8")
    for name in ("cell.yaml", "robot.json", "results.csv", "parameters.json", "seed-K.json", "seed-K-STREAM.csv"):
        assert name in page
    assert all(f"`{title}`" in page for title in TITLES[:4])
    assert (tmp_path / "upstream-nest" / "cell.yaml").is_file()


def test_the_limits_of_the_arm_are_those_that_hold_in_the_cell(tmp_path: Path) -> None:
    for name in ("belt-to-nest", "one-lane"):
        write_cell(tmp_path / name, name, (), 1.0)
    whole, less = (json.loads((tmp_path / n / "robot.json").read_text()) for n in ("belt-to-nest", "one-lane"))
    assert 1e3 * (whole["l1_m"] + whole["l2_m"]) == pytest.approx(550.0)
    for one, other in zip(whole["joints"], less["joints"], strict=True):
        assert other["velocity"] == one["velocity"]
        assert other["acceleration"] == pytest.approx(0.6 * one["acceleration"])
        assert other["jerk"] == pytest.approx(0.8 * one["jerk"])
    assert np.degrees(less["joints"][3]["upper"]) == pytest.approx(180.0)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [(("--only", "three-belts"), "allowed: one of belt-to-nest"), (("--seeds", "0"), "1<=x"), (("--minutes", "0"), "")],
)
def test_a_data_set_that_cannot_be_is_refused(arguments: tuple[str, ...], words: str, tmp_path: Path) -> None:
    app = Typer()
    app.command()(main)
    result = CliRunner(env={"COLUMNS": "200"}).invoke(app, [str(tmp_path / "out"), *arguments])
    assert result.exit_code == 2
    assert words in result.output
    assert not (tmp_path / "out").exists()
