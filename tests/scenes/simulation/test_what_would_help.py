"""What would help: which changes a cell can have, what each gives, and that its values give the same figure again."""

from __future__ import annotations

import json
from typing import Any

import pytest

import assur
from assur.planner.errors import FaultError, InputError
from assur.scenes.set_values import with_values
from assur.scenes.simulation.cell import simulated
from assur.scenes.simulation.changes import changes_of
from assur.scenes.simulation.helps import PROVED, Helps
from assur.scenes.simulation.run import Run
from assur.scenes.simulation.simulate import Simulation
from assur.scenes.simulation.table_run import table_rate
from tests.refused import refused_at
from tests.scenes.simulation.test_simulation import cell

Document = dict[str, Any]
MINUTES = 0.3


def slow(**changes: Any) -> Document:
    """More parts than the arm can take, because it dwells for long."""
    return cell({"mean_s": None, "every_s": 0.7}, kinds=_with("kinds", "soap", {"dwell_ms": 900}), **changes)


def _with(field: str, name: str, more: Document) -> Document:
    return {name: {**cell()[field][name], **more}}


def _values(document: Document) -> dict[str, Document]:
    return {change.what: change.values for change in changes_of(simulated(document), document)}


def test_a_change_that_helps_is_a_gain_and_its_values_give_its_figure_again() -> None:
    found = assur.simulate(slow(), minutes=MINUTES, seeds=2, helps=True)
    best = found["helps"][0]
    assert (best["what"], best["set"]) == ("no dwell", {"kinds.soap.dwell_ms": 0})
    assert best["gain"]
    assert best["percent"] == pytest.approx(100.0 * (best["parts_per_minute"] / found["parts_per_minute"] - 1.0))
    assert 0.0 < best["interval"][0] <= best["percent"]
    proved = [row for row in found["helps"] if row["percent"] is not None]
    assert len(proved) <= PROVED
    assert found["helps"][: len(proved)] == sorted(proved, key=lambda row: -row["percent"])
    for row in proved:
        assert row["table_percent"] > 0.0
        values = json.loads(json.dumps(row["set"]))
        again = assur.simulate(with_values(slow(), values), minutes=MINUTES, seeds=2)
        assert again["parts_per_minute"] == row["parts_per_minute"]
    assert {key: each for key, each in found.items() if key != "helps"} == assur.simulate(
        slow(), minutes=MINUTES, seeds=2
    )


def test_where_the_arm_takes_every_part_nothing_is_a_gain() -> None:
    few = cell({"mean_s": None, "every_s": 4})
    for row in assur.simulate(few, minutes=MINUTES, seeds=2, helps=True)["helps"]:
        assert row["table_percent"] <= 0.0
        assert (row["percent"], row["gain"]) == (None, None)


def test_with_one_seed_nothing_is_called_a_gain() -> None:
    best = assur.simulate(slow(), minutes=MINUTES, helps=True)["helps"][0]
    assert best["percent"] > 20.0
    assert (best["interval"], best["gain"]) == (None, None)


@pytest.mark.parametrize("options", [{}, {"elbow": "auto"}])
def test_a_run_without_plans_takes_about_as_many_parts_as_one_with_plans(options: Document) -> None:
    document = cell(options={**cell()["options"], **options})
    simulation = Simulation(document, 0.5, 1, 2, 20.0)
    simulation.run()
    for run in simulation.runs:
        rate = table_rate(simulation.cell, run["seed"], 30.0, 20.0)
        assert rate == table_rate(simulated(document), run["seed"], 30.0, 20.0)
        assert abs(rate - run["parts_per_minute"]) * 0.5 <= 2.0
        assert rate * 0.5 <= run["known"]


def test_values_are_set_in_the_units_in_which_they_are_written() -> None:
    found = _values(cell())
    assert found["the elbow is free"] == {"options.elbow": "auto"}
    assert found["belt is slower, with as many parts a minute"] == {"frames.belt.conveyor.speed_mm_s": 112.5}
    assert found["soap is seen 200 mm further upstream"] == {"streams.soap.seen.at_mm": -800}
    assert found["soap is seen 400 mm further upstream"] == {
        "streams.soap.seen.at_mm": -1000,
        "streams.soap.at_mm": [-1000, 0, 15],
    }
    even = found["soap comes at even times"]["streams.soap"]
    assert even == {"every_s": 1.5, **{k: v for k, v in cell()["streams"]["soap"].items() if k != "mean_s"}}
    frames = {"belt": {"conveyor": {"at_m": [0, 0.35, 0.05], "speed_m_s": 0.15}}}
    in_si = _values(cell({"mean_s": None, "every_s": 2, "jitter_s": 0.5}, frames=frames))
    assert in_si["belt is faster, with as many parts a minute"] == {"frames.belt.conveyor.speed_m_s": 0.1875}
    assert in_si["soap comes at even times"] == {"streams.soap.jitter_s": 0}


def test_what_a_cell_cannot_have_is_no_change() -> None:
    table = {"csv": {"text": "time_s,x_mm,y_mm\n0,-900,0\n2,-900,0\n"}}
    own = dict.fromkeys(("mean_s", "lane_mm", "yaw_deg"))
    options = {**cell()["options"], "elbow": "auto"}
    kinds = _with("kinds", "soap", {"dwell_s": 0})
    found = _values(cell({**own, **table}, options=options, kinds=kinds))
    assert not {what for what in found if "dwell" in what or "elbow" in what or "seen" in what or "even" in what}
    slots = _with("slots", "box", {"dwell_ms": 50})
    assert _values(cell(kinds=kinds, slots=slots))["no dwell"] == {"slots.box.dwell_ms": 0}
    assert "selection: look-ahead" not in found


def test_slots_go_straight_across_the_belt_with_what_they_lie_on() -> None:
    what = "box is on the other side of the belt"
    shipped = _values(cell())[what]
    assert shipped == {"slots.box.at_mm": [255, 865, 65], "bodies.box-bottom.pose.at_mm": [300, 900, 45]}
    trials = Helps(Simulation(cell(), 0.1, 1, 1, 20.0))
    trials.run()
    assert what not in {row["what"] for row in trials.document["helps"]}  # it is out of reach
    turned = {"frames": {**cell()["frames"], "rack": {"fixed": {"at_mm": [0, 0, 0], "yaw_deg": 90}}}}
    slots = {"box": {"frame": "rack", "at_mm": [-235, -300, 65]}}
    assert what not in _values(cell(slots=slots, **turned))
    on_body = {"box": {"body": "box-bottom", "at_mm": [-45, -35, 20], "step_mm": [90, 70, 0], "count": [2, 2, 1]}}
    assert _values(cell(slots=on_body))[what] == {"bodies.box-bottom.pose.at_mm": [300, 900, 45]}


def test_a_trial_that_ends_with_an_error_has_its_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    step = Run.step

    def refused(own: Run) -> None:
        if own._cell.kept.file.written["kinds"]["soap"]["dwell_ms"] == 0:
            raise FaultError("the checker refuses the motion")
        step(own)

    monkeypatch.setattr(Run, "step", refused)
    trials = Helps(made := Simulation(slow(), MINUTES, 1, 2, 20.0))
    made.run()
    trials.run()
    assert trials.document["complete"]
    (row,) = [row for row in trials.document["helps"] if row["what"] == "no dwell"]
    assert (row["fault"], row["percent"], row["gain"]) == ("the checker refuses the motion", None, None)
    assert row["table_percent"] > 20.0


def test_interrupted_trials_have_what_there_is() -> None:
    trials = Helps(made := Simulation(slow(), MINUTES, 1, 1, 20.0))
    made.run()
    shares = list[float]()

    def watch(_: str, share: float) -> None:
        shares.append(share)
        if share > 0.1:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        trials.run(watch)
    assert shares == sorted(shares)
    found = trials.document
    assert made.complete
    assert not found["complete"]  # trials are missing
    assert len(found["helps"]) > 5
    assert all(row["percent"] is None for row in found["helps"])


def test_helps_is_true_or_false() -> None:
    with refused_at("helps", "True or False"):
        assur.simulate(cell(), minutes=MINUTES, helps="yes")  # type: ignore[arg-type]
    with pytest.raises(InputError):
        assur.simulate(cell(), minutes=0.02, helps=True)
