"""The command `assur`: what it prints, what it writes, and how it ends."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import httpx
import pytest
from typer.testing import CliRunner

from assur.api.cli import console_report, verdict_report
from assur.api.cli.border import BAD_INPUT, FAULT, INTERRUPTED, PIPE_CLOSED, RIGHT, WRONG
from assur.api.command_line import app
from assur.api.documents import to_json
from assur.api.version import version
from assur.api.workers.jobs import FIRST_PLAN
from assur.planner.relaxation.kinds import ABOUT
from assur.planner.report import number_format
from assur.scenes.catalogue import FOLDER
from assur.scenes.reading.refusal import NOT_PROVED, SEARCH
from assur.scenes.requests import load_scenario, shipped_scenarios, with_options

ROOT = Path(__file__).parents[2]
TIMES = ("elapsed_s", "first_s")


def run(*arguments: str) -> tuple[int, str, str]:
    """Exit code, standard output, standard error."""
    result = CliRunner().invoke(app, list(arguments))
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    return result.exit_code, result.stdout, result.stderr


@pytest.fixture
def small_file(tmp_path: Path) -> Path:
    file = tmp_path / "small.json"
    file.write_text(json.dumps(FIRST_PLAN))
    return file


@pytest.fixture
def far_file(tmp_path: Path) -> Path:
    """A request that no robot of ours reaches."""
    file = tmp_path / "far.json"
    file.write_text(json.dumps({**FIRST_PLAN, "task": [{"move": {"to": {"at_m": [1.5, 0, 0.25]}}}]}))
    return file


def test_a_plan_is_told_in_the_words_of_the_shop_and_checked(small_file: Path) -> None:
    code, output, errors = run("plan", str(small_file))
    assert code == RIGHT
    for word in ("MOVE", "move-1", "duration", "what binds", "smallest clearance", "post", "plan checked", "10218"):
        assert word in output
    assert errors == ""


def test_assumptions_are_one_line_with_their_number_and_listed_when_asked_for(far_file: Path) -> None:
    for file in ("rv-m1", str(far_file)):
        answer = json.loads(run("plan", file, "--json")[1])
        assumptions = answer["assumptions"]
        assert len(assumptions) > 3
        short = run("plan", file)[1].splitlines()
        detailed = run("plan", file, "--details")[1].splitlines()
        about = f"{len(assumptions)} assumptions about the robot and the cell"
        assert f"{about} (--details lists them)" in short
        where = detailed.index(f"{about} (sources: --json):") + 1
        listed = [": ".join(text.split(": ")[:2]) for text in assumptions]
        assert [line.strip() for line in detailed[where : where + len(listed)]] == listed
        assert detailed[where + len(listed)] == ""
        assert not {line.strip() for line in short} & set(listed)
    one, none = (list(console_report.assumed(some, details=False)) for some in (["the robot's data: a"], []))
    assert one == ["1 assumption about the robot and the cell (--details lists it)"]
    assert none == list(console_report.assumed([], details=True)) == []


def test_parts_that_are_taken_away_are_always_listed() -> None:
    taken = ["a: somebody has taken it away 700 ms after place-a put it down", "the robot's data: a"]
    assert list(console_report.assumed(taken, details=False)) == [
        "taken away          a, 700 ms after place-a put it down",
        "2 assumptions about the robot and the cell (--details lists them)",
    ]
    assert list(console_report.assumed(taken, details=True))[1:] == [f"  {each}" for each in taken]


def test_a_part_that_floats_is_a_warning_and_no_refusal(tmp_path: Path) -> None:
    request = load_scenario(ROOT / "scenes" / "cells" / "transfer.yaml").request
    (part,) = (body for body in request["bodies"] if body["name"] == "load")
    x, y, z = part["pose"]["at_mm"]
    file = tmp_path / "cell.json"
    for height in (0, 3):
        part["pose"]["at_mm"] = [x, y, z + height]
        file.write_text(json.dumps(request))
        code, output, _ = run("plan", str(file))
        assert code == RIGHT
        told = [line for line in output.splitlines() if line.startswith("warning ")]
        assert len(told) == (height > 0)
        assert all(line.startswith("warning             load is 3 mm above ") for line in told)


def test_arrivals_of_an_arm_with_five_axes_have_pitch_and_roll_and_others_have_not(small_file: Path) -> None:
    code, output, _ = run("plan", "rv-m1")
    assert code == RIGHT
    above, head, arrival = next(
        lines
        for lines in zip(*(output.splitlines()[k:] for k in range(3)), strict=False)
        if lines[1].startswith("arrival")
    )
    assert "pitch" in above + head
    assert "roll deg" in head
    assert arrival.split()[6:10] == ["-90.0", "20.0", "up", "20.0"]
    assert "pitch" not in run("plan", str(small_file))[1]


def test_a_request_that_is_not_planned_says_why_and_ends_with_one(far_file: Path) -> None:
    code, output, _ = run("plan", str(far_file))
    assert code == WRONG
    assert "not planned" in output
    assert "OUT_OF_REACH" in output
    assert "plan checked" not in output


def test_a_part_that_is_taken_at_a_distance_is_told_and_one_that_touches_is_not() -> None:
    """The fingers of the lab's arm are 4.5 mm from the tube that they take; the cup of the demo touches its part."""
    _, output, _ = run("plan", "lab-arm")
    assert "pick-1       4.50  the tool and the part that it takes" in output
    assert "when it is put down" not in output
    _, output, _ = run("plan", "demo")
    assert "from the tool" not in output


def test_a_refusal_says_by_how_much_and_what_was_tried_and_would_help() -> None:
    code, output, errors = run("plan", "behind-the-base-keep")
    assert code == WRONG
    assert errors == ""
    for word in ("JOINT_LIMIT", "proved: no plan exists", "j1 would have to go", "deg", "what would help", "auto"):
        assert word in output


def test_what_would_help_is_tried_where_a_request_says_nothing_of_it(tmp_path: Path, client: httpx.Client) -> None:
    request = load_scenario(ROOT / "scenes" / "cells" / "behind-the-base-keep.yaml").request
    file = tmp_path / "behind.json"
    answers = {}
    for key, value in (("", 0), ("explain_budget_s", 0), ("explain_budget_ms", 0.0), ("explain_budget_ms", 60_000)):
        options = {name: each for name, each in request["options"].items() if not name.startswith("explain_budget")}
        asked = {**request, "options": options | {"budget_s": 10} | ({key: value} if key else {})}
        file.write_text(json.dumps(asked))
        code, output, _ = run("plan", str(file), "--json")
        assert code == WRONG
        answers[key, value] = json.loads(output)
        if not key:
            # over HTTP and in Python nothing is tried that is not asked for; and the request stays the same
            served = client.post("/v1/plans", json=asked).json()
            assert (served["relaxation"], served["tried"]) == (None, [])
            assert served["request_digest"] == answers[key, value]["request_digest"]
    helps = {"what": "elbow", "value": "auto"}
    for stated, answer in answers.items():
        tried = stated[0] == "" or stated[1] > 0
        assert (answer["relaxation"] is not None, answer["tried"] != []) == (tried, tried), stated
        assert not tried or helps.items() <= answer["relaxation"].items()


def test_an_answer_that_is_not_what_the_scenario_expects_is_told_so(tmp_path: Path) -> None:
    shipped = (ROOT / "scenes" / "cells" / "bead-beyond-reach.yaml").read_text(encoding="utf-8")
    file = tmp_path / "cell.yaml"
    file.write_text(shipped.replace("status: not_planned", "status: planned"), encoding="utf-8")
    for form in ((), ("--json",)):
        code, output, errors = run("plan", str(file), *form)
        assert code == WRONG
        assert errors == "assur: not as the file expects: status is not_planned, not planned\n"
        assert "not as the file expects" not in output


def test_what_a_file_expects_beside_a_plan_changes_no_exit_code(tmp_path: Path) -> None:
    file = tmp_path / "cell.yaml"
    expect = {"status": "planned", "duration_s": {"max": 0.001}}
    file.write_text(json.dumps({"about": "A cell.", "request": FIRST_PLAN, "expect": expect}))
    code, output, errors = run("plan", str(file))
    assert code == RIGHT
    assert "plan checked" in output
    assert errors.startswith("assur: not as the file expects: duration_s is ")


FULL_PLAN = with_options(FIRST_PLAN, {"report": "full"})


@pytest.fixture
def full_file(tmp_path: Path) -> Path:
    """The small request with a full report, in a file."""
    file = tmp_path / "full.json"
    file.write_bytes(to_json(FULL_PLAN))
    return file


def without_times(document: dict[str, Any]) -> bytes:
    """Without what takes time."""
    return to_json({name: value for name, value in document.items() if name not in TIMES})


def test_the_pairs_that_come_nearest_are_listed_on_the_command_line(client: httpx.Client, small_file: Path) -> None:
    told = json.loads(run("plan", str(small_file), "--json")[1])["margins"]
    assert 0 < len(told["travel_pairs"]) <= 4
    assert told["near_pairs"] == []  # nothing is tracked
    assert told["travel_pairs"][0]["gap_m"] == pytest.approx(told["nearest"]["gap_m"], abs=1e-4)
    lines = [line for line in run("plan", str(small_file))[1].splitlines() if line.startswith("  in travel")]
    assert [" and ".join(each["bodies"]) for each in told["travel_pairs"]] == [line.split(", ")[1] for line in lines]
    served = client.post("/v1/plans", json=FIRST_PLAN).json()
    assert served["margins"].keys() == {"nearest", "placed"}
    assert served["margins"]["nearest"] == told["nearest"]
    assert not served.keys() & {"warnings", "lower_bound_s"}


def test_json_is_the_document_that_the_service_answers_with(client: httpx.Client, full_file: Path) -> None:
    code, output, _ = run("plan", str(full_file), "--json")
    answer = client.post("/v1/plans", json=FULL_PLAN)
    assert code == RIGHT
    assert without_times(json.loads(output)) == without_times(answer.json())
    assert list(json.loads(output)) == list(answer.json())
    assert json.loads(run("robots", "--json")[1]) == client.get("/v1/robots").json()
    assert json.loads(run("scenes", "--json")[1]) == client.get("/v1/scenes").json()
    assert json.loads(run("schema")[1]) == client.get("/v1/schema").json()


def test_the_digest_of_a_certificate_is_the_same_on_both_borders(client: httpx.Client, full_file: Path) -> None:
    _, output, _ = run("plan", str(full_file), "--json", "--certificate", "digest")
    answer = client.post("/v1/plans", json=FULL_PLAN, params={"certificate": "digest"})
    assert without_times(json.loads(output)) == without_times(answer.json())


def test_a_plan_that_was_written_is_right_and_a_changed_one_is_wrong(small_file: Path, tmp_path: Path) -> None:
    out = tmp_path / "plan.json"
    assert run("plan", str(small_file), "--out", str(out))[0] == RIGHT
    assert out.read_bytes().endswith(b"}\n")
    for given in ([str(out)], [str(small_file), str(out)]):
        code, output, _ = run("check", *given)
        assert (code, "plan right" in output) == (RIGHT, True)

    held = json.loads(out.read_bytes())
    held["plan"]["trajectory"]["velocity"][1][0] += 0.5
    out.write_text(json.dumps(held))
    for given in ([str(out)], [str(small_file), str(out)]):
        code, output, _ = run("check", *given)
        assert (code, "plan wrong" in output) == (WRONG, True)
    code, output, _ = run("check", str(out), "--json")
    assert (code, json.loads(output)["ok"]) == (WRONG, False)


def test_an_answer_without_a_plan_is_written_too_and_is_nothing_to_check(far_file: Path, tmp_path: Path) -> None:
    out = tmp_path / "plan.json"
    assert run("plan", str(far_file), "--out", str(out))[0] == WRONG
    assert json.loads(out.read_bytes())["plan"]["status"] == "not_planned"
    code, output, _ = run("check", str(far_file), str(out))
    assert code == RIGHT
    assert output.startswith("refusal right: no plan exists")


def test_a_refusal_is_checked_against_a_scenario_and_a_forged_one_is_wrong(tmp_path: Path) -> None:
    out = tmp_path / "plan.json"
    assert run("plan", "behind-the-base-keep", "--out", str(out))[0] == WRONG
    assert run("check", "behind-the-base-keep", str(out))[0] == RIGHT
    document = json.loads(out.read_bytes())
    document["plan"]["refusal"]["amount"] *= 2
    out.write_text(json.dumps(document))
    code, output, _ = run("check", "behind-the-base-keep", str(out))
    assert code == WRONG
    assert output.startswith("refusal wrong")


def test_an_answer_is_no_request_and_a_plan_of_another_robot_is_told_as_such(small_file: Path, tmp_path: Path) -> None:
    out = tmp_path / "answer.json"
    code, output, _ = run("plan", str(small_file), "--json")
    assert code == RIGHT
    out.write_text(output)
    code, _, errors = run("plan", str(out))
    assert code == BAD_INPUT
    assert "this is an answer, not a request" in errors
    code, _, errors = run("check", "rv-m1", str(out))
    assert code == BAD_INPUT
    assert errors.startswith("assur: plan.trajectory.joint_names: ")
    assert "this plan belongs to another request" in errors


def test_a_bare_request_in_yaml_is_told_where_to_put_it(tmp_path: Path) -> None:
    file = tmp_path / "bare.yaml"
    file.write_text(json.dumps(FIRST_PLAN, indent=1))  # JSON is YAML
    code, _, errors = run("plan", str(file))
    assert code == BAD_INPUT
    assert errors.startswith("assur: line 1: request: it is missing")
    assert "put it under request:" in errors
    whole = json.dumps({"about": "A cell.", "request": FIRST_PLAN}, indent=1)
    file.write_text(whole)
    assert run("plan", str(file))[0] == RIGHT


def test_amounts_have_sensible_digits() -> None:
    assert number_format.amount(1.27e-9, "m") == "less than 0.001 mm"
    assert number_format.amount(5.06, "s") == "5.06 s"
    assert number_format.amount(0.0506, "s") == "50.6 ms"
    assert number_format.amount(0.0, "m") == "0 mm"
    assert number_format.amount(1.5, "m") == "1,500 mm"
    assert number_format.amount(-0.25, "rad") == "-14.3 deg"
    assert number_format.amount(None, "m") == ""
    assert [number_format.number(x, 4) for x in (359934.3, 446.907, 9999.6, -20.0)] == [
        "359,900",
        "446.9",
        "10,000",
        "-20",
    ]


LINE = {"stage": "screening", "reason": "BODY_COLLISION", "step": 0, "bodies": ["cup", "bar"], "count": 1}
LINE |= {"interval_s": None, "least": 0.002, "most": 0.002, "unit": "m", "detail": "cup would hit bar"}


def printed(parts: Any) -> str:
    """The text of an answer's parts on a console."""
    console = console_report.console()
    with console.capture() as text:
        for part in parts:
            console.print(part)
    return text.get()


def shown(parts: Any) -> list[str]:
    """What is printed, line by line, with single spaces."""
    return [" ".join(row.split()) for row in printed(parts).splitlines()]


def test_the_census_is_a_table_with_a_row_for_each_kind_of_refusal() -> None:
    document = {"candidates": 7, "refused": 1, "lines": [LINE, {**LINE, "count": 3, "most": 0.004}]}
    first, second, _, *rows = shown(console_report.census(document, planned=False))
    assert first == "7 candidates, 1 refused; a candidate may be refused for several bodies"
    assert second.startswith("6 candidates were not refused: they end before the last step")
    assert rows == ["1 1 screening cup would hit bar 2 mm", "3 1 screening cup would hit bar 2 mm to 4 mm"]
    told = shown(console_report.census({**document, "refused": 4}, planned=True))
    assert told[0] == "7 candidates, 4 refused"
    assert not any("the other" in sentence for sentence in told)
    for beyond, said in ((0, []), (1, ["and 1 more kind of refusal"]), (2, ["and 2 more kinds of refusal"])):
        kinds = [LINE] * (console_report.CENSUS_LINES + beyond)
        told = shown(console_report.census({**document, "lines": kinds}, planned=True))
        assert [line for line in told if line.startswith("and ")] == said
    at_times = [{**LINE, "interval_s": span} for span in ([0.5, 0.5], [0.1, 0.75], [0.1, None])]
    *_, once, between, unknown = shown(console_report.census({**document, "lines": at_times}, planned=True))
    assert once.endswith("bar 0.500 2 mm")
    assert between.endswith("bar 0.100 and 0.750 2 mm")
    assert unknown.endswith("bar 2 mm")


def test_what_was_examined_before_any_candidate_stands_under_its_own_heading() -> None:
    before = {**LINE, "stage": "inverse", "detail": "j4 would have to go beyond its limit", "count": 15}
    told = shown(console_report.census({"candidates": 9, "refused": 0, "lines": [before]}, planned=True))
    assert told[0] == "9 candidates, 0 refused"
    assert "before any candidate" in told[1]
    assert told[3].startswith("15 1 inverse j4 would have to go beyond its limit")
    mixed = shown(console_report.census({"candidates": 9, "refused": 1, "lines": [before, LINE]}, planned=True))
    assert [any("before any" in line for line in mixed[:k]) for k in (3, 4)] == [False, True]


def test_a_point_that_stands_is_met_at_rest_and_no_zero_has_a_sign(small_file: Path) -> None:
    answer = json.loads(run("plan", str(small_file), "--json")[1])
    answer["arrivals"][0] |= {"at_m": [-1e-9, -0.0, 0.2], "yaw_rad": -1e-9}
    answer["lower_bound_s"] = 0.0
    end = answer["legs"][-1]["to_s"]
    answer["margins"]["nearest"] = {"gap_m": 0.01, "time_s": end + 0.1, "bodies": ["a", "b"], "phase": "WAIT"}
    text = printed(console_report.planned(answer))
    assert "met, at rest" in text
    assert "matched" not in text
    assert "-0.0" not in text
    assert "no bound is known" in text
    assert "(standstill after the end)" in text
    for rate in answer["trajectory"]["velocity"]:
        rate[0] = 1.0
    assert "matched" in printed(console_report.planned(answer))


def test_what_was_tried_in_vain_is_listed_without_what_is_no_change() -> None:
    answer = {"reason": "OUT_OF_REACH", "proved": False, "sentence": "", "relaxation": None}
    spent = {**answer, "explain_budget_spent": True}
    told = list(console_report.not_planned({**spent, "tried": ["window: removed"]}))
    assert told[-3:] == [
        "what would not help, each tried by itself:",
        "  another window  removed",
        "  the time for trying changes was over (explain_budget_s): others were not tried",
    ]
    assert "larger explain_budget_s" in shown(console_report.not_planned({**spent, "tried": []}))[-1]
    tried = ["without: gate", "pair clearance: cup and bar: travel 0 mm, near 0 mm", "without: post", "new: 1"]
    told = list(console_report.not_planned({**answer, "tried": tried, "explain_budget_spent": False}))
    assert told[-5:] == [
        "what would not help, each tried by itself:",
        "  leaving out a body or robot  gate",
        "                               post",
        "  less clearance of one pair   cup and bar: travel 0 mm, near 0 mm",
        "  new                          1",
    ]


def test_every_kind_of_change_has_words() -> None:
    kinds = {kind for about in ABOUT.values() for kind in about}
    assert kinds <= console_report.CHANGED.keys()
    assert {"budget", "contact tolerance", "straight part"} <= console_report.CHANGED.keys()


@pytest.mark.parametrize("note", ["1 via point", "2 via points later", "direct"])
def test_a_leg_says_by_how_many_vias_it_goes_and_an_arrival_its_yaw(small_file: Path, note: str) -> None:
    answer = json.loads(run("plan", str(small_file), "--json")[1])
    answer["legs"][0]["note"] = note
    answer["arrivals"][0]["yaw_rad"] = 0.5
    text = printed(console_report.planned(answer))
    assert text.splitlines()[1].rstrip().endswith(f"  {note}")
    assert "yaw deg" in text
    assert "28.6" in text


def test_the_robots_are_listed_in_one_system_of_units() -> None:
    _, output, _ = run("robots")
    rows = [" ".join(line.split()) for line in output.splitlines()]
    assert "mitsubishi-rh-6frh5520 550 mm 6 kg t j1 deg -170 .. 170 400 7,199 c 359,900 e" in rows
    assert "z mm 50 .. 250 2,000 25,000 500,000" in rows
    assert "rad" not in output
    assert "e+" not in output


def test_the_lists_name_everything() -> None:
    _, output, _ = run("scenes")
    for name in shipped_scenarios():
        assert name in output
    _, output, _ = run("robots")
    for name in ("mitsubishi-rh-6frh5520", "mitsubishi-rh-6crh6020", "fanuc-sr-3ia"):
        assert name in output


def test_one_robot_is_shown_number_by_number_wherever_its_file_is(tmp_path: Path) -> None:
    text = (FOLDER / "fanuc-sr-3ia.yaml").read_text()
    file = tmp_path / "mine.yaml"
    file.write_text(text)
    assert run("robots", str(file)) == run("robots", "fanuc-sr-3ia")
    file.write_text(
        text.replace("name: fanuc-sr-3ia", "name: mine").replace(
            "{value: 720, status: third_party", "{value: 700, status: vendor"
        )
    )
    code, output, _ = run("robots", str(file))
    rows = [" ".join(line.split()) for line in output.splitlines()]
    assert code == RIGHT
    assert "mine 400 mm t 3 kg t j1 deg -142 .. 142 t 700 7,200 e 360,000 e" in rows
    assert "j1 velocity 700 deg_s vendor the maker's catalogue, second hand" in rows
    assert "mine 4 solids estimated by eye from the arm's lengths; no drawing at hand" in rows
    (robot,) = json.loads(run("robots", str(file), "--json")[1])["robots"]
    assert robot["joints"][0]["velocity"] == {
        "value": 700,
        "unit": "deg_s",
        "status": "vendor",
        "source": "the maker's catalogue, second hand",
    }
    five_bar = run("robots", "mitsubishi-rp-5ah")[1]
    assert "460 mm d t" in five_bar
    assert "260, 260" in five_bar


def test_a_robot_that_is_not_there_or_not_right_is_one_line(tmp_path: Path) -> None:
    code, output, errors = run("robots", "fanuc-sr3ia")
    assert (code, output, errors.count("\n")) == (BAD_INPUT, "", 1)
    assert "did you mean fanuc-sr-3ia?" in errors
    errors = run("robots", "mitsubishi-rh6")[2]
    assert errors.endswith("; did you mean mitsubishi-rh-6crh6020 or mitsubishi-rh-6frh5520?\n")
    assert "did you mean" not in run("robots", "nosuch")[2]
    file = tmp_path / "mine.yaml"
    file.write_text((FOLDER / "fanuc-sr-3ia.yaml").read_text().replace("l1_mm: {value: 200,", "l1_mm: {value: far,"))
    code, output, errors = run("robots", str(file))
    assert (code, output, errors.count("\n")) == (BAD_INPUT, "", 1)
    assert errors == 'assur: line 10: mine.yaml: scara.l1_mm.value: got "far"; allowed: a number\n'


def raising(error: BaseException) -> Any:
    def raise_it(*_: object, **__: object) -> None:
        raise error

    return raise_it


def test_a_fault_of_ours_is_one_line_and_exit_code_three(small_file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("assur.api.cli.inputs.plan_cell", raising(ZeroDivisionError("what\nwas said")))
    code, output, errors = run("plan", str(small_file))
    assert (code, output, errors.count("\n")) == (FAULT, "", 1)
    assert "ZeroDivisionError" in errors
    assert "what" not in errors


def test_a_plan_that_its_own_checker_refuses_is_not_given(
    small_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    refused = {"ok": False, "findings": [{"what": "the gap is not there", "detail": ""}], "notice": ""}
    monkeypatch.setattr("assur.scenes.requests.check_plan", lambda *_, **__: refused)
    code, output, errors = run("plan", str(small_file), "--out", str(tmp_path / "plan.json"))
    assert (code, output) == (FAULT, "")
    assert "the gap is not there" in errors
    assert not (tmp_path / "plan.json").exists()


def test_an_interrupted_command_ends_quietly(small_file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("assur.api.cli.inputs.plan_cell", raising(KeyboardInterrupt()))
    assert run("plan", str(small_file)) == (INTERRUPTED, "", "assur: interrupted\n")


def process(*arguments: str, **environment: str) -> subprocess.CompletedProcess[bytes]:
    command = [sys.executable, "-m", "assur.api.command_line", *arguments]
    given = {**os.environ, **environment}
    return subprocess.run(command, cwd=ROOT, env=given, capture_output=True, timeout=120, check=False)


@pytest.mark.slow
def test_a_terminal_that_knows_ascii_only_gets_everything_all_the_same(small_file: Path) -> None:
    run = process("plan", str(small_file), PYTHONIOENCODING="ascii", LC_ALL="C", TERM="dumb")
    assert run.returncode == RIGHT, run.stderr
    assert b"plan checked" in run.stdout
    assert b"\x1b" not in run.stdout
    assert run.stderr == b""


def test_a_reader_that_closes_the_pipe_gets_no_traceback() -> None:
    command = f"{sys.executable} -m assur.api.command_line schema | head -c 10; exit ${{PIPESTATUS[0]}}"
    run = subprocess.run(["bash", "-c", command], cwd=ROOT, capture_output=True, timeout=60, check=False)
    assert len(run.stdout) == 10
    assert run.stderr == b""
    assert run.returncode in (RIGHT, PIPE_CLOSED)


@pytest.mark.slow
@pytest.mark.parametrize("command", [("robots",), ("robots", "--json"), ("plan", "demo")])
def test_a_reader_that_is_gone_is_no_request_that_was_not_planned(command: tuple[str, ...]) -> None:
    here, there = os.pipe()
    os.close(here)
    with os.fdopen(there, "wb") as closed:
        whole = [sys.executable, "-m", "assur.api.command_line", *command]
        run = subprocess.run(whole, cwd=ROOT, stdout=closed, stderr=subprocess.PIPE, timeout=120, check=False)
    assert (run.returncode, run.stderr) == (PIPE_CLOSED, b"")


def test_the_version_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    assert run("--version") == (RIGHT, f"assur {version()}\n", "")
    monkeypatch.setattr("assur.api.version.metadata.version", {"assur": "1.2.3"}.__getitem__)
    assert run("--version") == (RIGHT, "assur 1.2.3\n", "")


def test_a_misspelt_scenario_is_answered_with_the_one_that_was_meant() -> None:
    code, _, errors = run("plan", "demoo")
    assert code == BAD_INPUT
    assert errors.endswith("; did you mean demo?\n")
    code, _, errors = run("plan", "qqqq")
    assert code == BAD_INPUT
    assert "did you mean" not in errors


def test_text_that_is_no_json_is_told_with_line_and_column(tmp_path: Path) -> None:
    file = tmp_path / "broken.json"
    file.write_text('{"schema": "assur/1",\n "robot": }')
    code, _, errors = run("plan", str(file))
    assert (code, errors) == (
        BAD_INPUT,
        'assur: broken.json: got "no value, at line 2, column 11"; allowed: a request or a plan file, as JSON; '
        "a value there: an object, a list, text in quotes, a number, true, false or null\n",
    )


@pytest.mark.parametrize(
    ("command", "allowed"), [("plan", "a scenario: YAML with about"), ("robots", "a robot: YAML with one of scara")]
)
@pytest.mark.parametrize("text", ["", " \n\n", "# to do\n", "null\n"])
def test_an_empty_file_of_yaml_is_reported_as_empty_by_its_name(
    tmp_path: Path, command: str, allowed: str, text: str
) -> None:
    (tmp_path / "none.yaml").write_text(text)
    code, output, errors = run(command, str(tmp_path / "none.yaml"))
    assert (code, output) == (BAD_INPUT, "")
    assert errors.startswith(f'assur: none.yaml: got "an empty file"; allowed: {allowed}')


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("plan", "nowhere.yaml"), b"assur: FILE: got "),
        (("plan", "bad.json"), b"assur: robot.model: got "),
        (("plan", "bad.yaml"), b"assur: line 2: request.robot.model: got "),
        (("check", "small.json", "bad.json"), b"assur: plan.robot: got "),
        (("check", "bad.json", "bad.json"), b"assur: robot.model: got "),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, tuple) else "",
)
def test_bad_input_ends_with_two_and_a_line_for_each_fault_before_anything_is_compiled(
    tmp_path: Path, small_file: Path, arguments: tuple[str, ...], said: bytes
) -> None:
    bad = json.dumps({**FIRST_PLAN, "robot": {**FIRST_PLAN["robot"], "model": "no-robot"}})
    (tmp_path / "bad.json").write_text(bad)
    (tmp_path / "bad.yaml").write_text(f"about: bad\nrequest: {bad}\n")
    files = (str(tmp_path / name) if "." in name else name for name in arguments)
    run = process(*files, NUMBA_CACHE_DIR=str(tmp_path / "kernels"))
    assert (run.returncode, run.stdout) == (BAD_INPUT, b"")
    assert run.stderr.startswith(said)
    assert all(line.startswith(b"assur: ") for line in run.stderr.splitlines())
    assert not (tmp_path / "kernels").exists()


def test_check_names_what_of_a_refusal_nobody_looked_at(far_file: Path, tmp_path: Path) -> None:
    out = tmp_path / "answer.json"
    run("plan", str(far_file), "--out", str(out))
    document = json.loads(out.read_text())
    document["plan"]["relaxation"] = {"what": "dwell", "value": "300 ms", "duration_s": 1.0}
    out.write_text(json.dumps(document))
    code, output, _ = run("check", str(out))
    assert code == RIGHT
    assert "not checked" in output
    told = {line.split()[0]: line.split(maxsplit=1)[1] for line in output.splitlines() if len(line.split()) > 1}
    assert told["relaxation"] == "a change that is proposed; whether it helps is not verified here"
    verdict = json.loads(run("check", str(out), "--json")[1])
    assert set(verdict["not_checked"]) <= told.keys()
    assert "relaxation" in verdict["not_checked"]
    del document["plan"]["relaxation"]
    out.write_text(json.dumps(document))
    assert "proposed" not in run("check", str(out))[1]


def test_every_field_that_may_be_unchecked_is_told_in_words() -> None:
    of_bodies = {"refusal.amount", "refusal.facts.gap_m", "refusal.facts.least_m"}
    assert verdict_report.NOTES.keys() == {*SEARCH, *NOT_PROVED} | of_bodies
