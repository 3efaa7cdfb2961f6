"""The page of a run: its view is the motion of the plans as far as they were executed, and its numbers are counted."""

from __future__ import annotations

import html
import json
import re
import shlex
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from assur.planner.errors import InputError
from assur.scenes.reading.plan import motion_of
from assur.scenes.report.run_charts import by_minutes, histogram, over_time
from assur.scenes.report.run_report import DOES, run_report
from assur.scenes.requests import cell_of
from assur.scenes.session.executed import LoggedPlan, executed_plans
from assur.scenes.session.log import read_log
from assur.scenes.view.packing import unpacked
from assur.scenes.view.run import ExecutedPlan, run_view
from tests.api.test_session_log import recorded

Document = dict[str, Any]
LEG = {"leg": "travel to the part", "count": 4, "mean_s": 0.5, "share": 0.1, "binds": {"velocity of j1": 3}}
TRIAL = {
    "what": "no dwell & no wait",
    "set": {"kinds.a.dwell_ms": 0},
    "table_percent": 5.0,
    "percent": 4.0,
    "interval": None,
    "gain": None,
    "parts_per_minute": 30.0,
    "fault": None,
}
FOUND: Document = {
    "bottleneck": "Parts & belts are a bottleneck.",
    "waiting": {"bodies": 0.25, "planning": 1e-5},
    "notes": [],
    "helps": [TRIAL],
    "parts_per_minute": 30.25,
    "interval": [29.0, 31.5],
    "known": 9,
    "picked": 5,
    "missed": 3,
    "runs": [{"seed": 4, "legs": [LEG], "known": 5, "missed": 2, "remaining": 1}, {"seed": 5, "legs": []}],
}


@pytest.fixture(scope="module")
def events(tmp_path_factory: pytest.TempPathFactory) -> list[Document]:
    path = tmp_path_factory.mktemp("log") / "run.mcap"
    recorded(path)
    return list(read_log(path)[1])


@pytest.fixture(scope="module")
def plans(events: list[Document]) -> list[LoggedPlan]:
    return executed_plans(events)[0]


@pytest.fixture(scope="module")
def view(plans: list[LoggedPlan]) -> Document:
    made = [ExecutedPlan(cell_of(each.request), each.answer, each.starts_s, each.until_s) for each in plans]
    return dict(run_view(made))


def test_plans_follow_each_other_up_to_the_end_of_the_clock(events: list[Document], plans: list[LoggedPlan]) -> None:
    assert [each.until_s for each in plans[:-1]] == [each.starts_s for each in plans[1:]]
    assert plans[-1].until_s == events[-1]["arguments"]["to_s"]
    assert sum(len(each.handled("pick")) for each in plans) == 2
    picked = [time for each in plans for time in each.handled("pick")]
    assert all(each.starts_s < time < each.until_s for each in plans for time in each.handled("pick"))
    assert picked == sorted(picked)


def test_the_view_is_the_motion_of_the_plans(plans: list[LoggedPlan], view: Document) -> None:
    start = plans[0].starts_s
    assert view["lasts_s"] == pytest.approx(plans[-1].until_s - start)
    carrier = view["carriers"][view["tool"]["carrier"]]
    times = unpacked(carrier["time_s"])
    places = unpacked(carrier["position_m"])
    scene = cell_of(plans[0].request).scene
    for plan in plans:
        motion, _, _ = motion_of(plan.answer, cell_of(plan.request).conventions)
        for t in [t for t in plan.answer["trajectory"]["time_s"] if plan.starts_s <= t <= plan.until_s]:
            positions, _ = scene.robot.placements(motion.state(t)[0])
            shown = [np.interp(t - start, times, places[:, axis]) for axis in range(3)]
            assert np.abs(np.array(shown) - positions[scene.robot.links.index("flange")]).max() < 2e-4


def test_parts_are_where_the_plans_have_them(plans: list[LoggedPlan], view: Document) -> None:
    bodies, names = {each["name"]: each for each in view["bodies"]}, [each["name"] for each in view["carriers"]]
    belt, flange = names.index("belt"), view["tool"]["carrier"]
    for number, name in enumerate("ab"):
        carriers = [seat["carrier"] for seat in bodies[name]["seats"]]
        times = [seat["from_s"] for seat in bodies[name]["seats"]]
        assert carriers[:2] == [belt, flange]
        assert times == sorted(times)
        assert times[1] == pytest.approx(plans[number + 1].handled("pick")[0] - plans[0].starts_s)
        assert bodies[name]["kind"] == "part"
    assert bodies["a"]["gone_s"] == pytest.approx(plans[3].starts_s - plans[0].starts_s)
    assert bodies["b"]["gone_s"] is None


def test_legs_and_what_is_held_end_where_a_plan_is_left(plans: list[LoggedPlan], view: Document) -> None:
    legs = view["legs"]
    for one, other in pairwise(legs):
        assert one["to_s"] <= other["from_s"] + 1e-6
    assert legs[-1]["to_s"] <= view["lasts_s"] + 1e-9
    assert [span["names"] for span in view["held"]] == [["a"], ["b"]]
    assert {view["control_points"][leg["step"]]["step"] for leg in legs} <= set(range(len(view["control_points"])))
    assert [point["step"] for point in view["control_points"]] == list(range(len(view["control_points"])))
    assert {leg["step"] for leg in legs} == set(range(len(view["control_points"])))  # none of a step that was replaced


def test_the_page_has_the_figures_of_the_run_and_fetches_nothing(
    events: list[Document], plans: list[LoggedPlan]
) -> None:
    values = {"kinds.a.yaw_deg": [-5, 5], "options.elbow": "<auto>"}
    page = run_report(events, title="A <run>", about="Brackets & a belt.", version="1", found=FOUND, values=values)
    assert "A &lt;run&gt; - assur" in page
    assert "Brackets &amp; a belt." in page
    assert "Parts &amp; belts are a bottleneck." in page
    assert "All 2 runs together: 30.2 parts a minute (95 % interval 29.0 to 31.5); 5 of 9 parts were picked" in page
    assert "This page shows the run with seed 4." in page
    assert "The arm waits for bodies to pass, 25.0 % of the time." in page
    assert "velocity of j1 (3 of 4)" in page
    assert "What would help, over 2 runs<" in page
    assert "<td>no dwell &amp; no wait</td>" in page
    assert "<li>no dwell &amp; no wait: --set kinds.a.dwell_ms=0</li>" in page
    assert "Values that were set in the cell" in page
    shown = re.findall("<li>(--set .*?)</li>", page)
    set_again = dict(shlex.split(html.unescape(each))[1].split("=") for each in shown)
    assert {path: json.loads(value) for path, value in set_again.items()} == values
    placed, lasts_s = sum(len(each.handled("place")) for each in plans), plans[-1].until_s - plans[0].starts_s
    assert f"{60 * placed / lasts_s:.1f} parts a minute" in page
    assert f"<dd>2, {placed}</dd>" in page
    assert "<dt>missed</dt><dd>2</dd>" in page
    assert not re.findall(r"(?:src|href)=|url\(", page)
    begun = json.loads(re.findall(r'id="view">(.*?)</script>', page)[0].replace("\\u003c", "<"))
    assert begun["schema"] == "assur-view/1"


def test_the_page_of_a_log_has_all_legs_and_the_worst_error_of_a_pick(
    events: list[Document], plans: list[LoggedPlan]
) -> None:
    page = run_report(events, title="run", about="", version="1")
    assert "What would help" not in page
    assert "Values that were set" not in page
    shown = re.findall(r"<tr><td>([a-z ]+)</td><td[^>]*>([\d.]+)</td><td[^>]*>([\d.]+) %</td>", page)
    assert [name for name, _, _ in shown][:5] == [
        "travel to the part", "approach of the part", "dwell at the part", "depart from the part", "travel to the slot"
    ]  # fmt: skip
    legs = [leg for plan in plans for leg, _, _ in plan.legs()]
    time_s = sum(leg["to_s"] - leg["from_s"] for leg in legs)
    lasts_s = plans[-1].until_s - plans[0].starts_s
    assert sum(float(share) for _, _, share in shown) == pytest.approx(100.0 * time_s / lasts_s, abs=0.5)
    errors = [
        arrival["error"]["position_m"]
        for plan in plans
        for arrival in plan.answer["arrivals"]
        if "pick" in plan.request["task"][arrival["step"]] and arrival["until_s"] < plan.until_s
    ]
    assert len(errors) == 2
    assert max(errors) > 0.0
    assert f"<dt>worst error of a pick</dt><dd>{1e3 * max(errors):.2f} mm, " in page


def test_a_session_without_a_motion_has_no_page(events: list[Document]) -> None:
    with pytest.raises(InputError, match="a session whose clock was advanced"):
        run_report(events[:3], title="run", about="", version="1")


def test_a_page_plays_from_a_time_of_the_run_on(events: list[Document], plans: list[LoggedPlan]) -> None:
    page = run_report(events, title="run", about="", version="1", from_s=plans[2].starts_s + 0.01)
    begun = json.loads(re.findall(r'id="view">(.*?)</script>', page)[0].replace("\\u003c", "<"))
    assert begun["start_s"] == plans[2].starts_s
    for wrong in (-1.0, 1e6, float("nan")):
        with pytest.raises(InputError, match="from_s: "):
            run_report(events, title="run", about="", version="1", from_s=wrong)


def test_a_line_of_the_chart_is_a_minute(plans: list[LoggedPlan]) -> None:
    chart = by_minutes([(0.0, 30.0, "run-pick"), (50.0, 70.0, "run-wait")], 0.0, 90.0, DOES)
    widths = [float(each) for each in re.findall(r'<rect class="run-\w+".*?width="([\d.]+)"', chart)]
    assert len(widths) == 3  # what goes on over a full minute has two parts
    assert widths[1] == pytest.approx(widths[2], rel=1e-3)
    assert widths[0] == pytest.approx(3 * widths[1], rel=1e-3)
    assert chart.count(" min</text>") == 2
    assert "to a part, 0.00 to 30.00 s" in chart


def test_throughput_and_cycles_count_each_event_once() -> None:
    every = [float(t) for t in range(0, 600, 2)]
    heights = [float(y) for _, y in re.findall(r"([\d.]+),([\d.]+)", over_time(every, 0.0, 600.0).split("points=")[1])]
    assert max(heights) - min(heights) < 6.0  # 30 a minute everywhere
    chart = histogram([1.0, 1.0, 2.0])
    counts = [int(each) for each in re.findall(r": (\d+)</title>", chart)]
    assert (sum(counts), counts[0], counts[-1]) == (3, 2, 1)
    assert "none" in histogram([])
