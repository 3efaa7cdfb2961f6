"""`--set PATH=VALUE`: a value of a file from the command line, and what is refused."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from assur.api.cli.border import BAD_INPUT, RIGHT
from assur.api.command_line import app
from assur.api.workers.jobs import FIRST_PLAN
from tests.scenes.tasks.test_joining import CELL, TASK

SMALL_TASK = TASK[: TASK.index("steps:")] + "steps: [{move: {name: away, to: home}}]\noptions: {stop: first, seed: 1}\n"


def run(*arguments: str) -> tuple[int, str, str]:
    """Exit code, standard output, standard error."""
    result = CliRunner().invoke(app, list(arguments))
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    return result.exit_code, result.stdout, result.stderr


@pytest.fixture
def file(tmp_path: Path) -> str:
    """A task file, beside its cell."""
    (tmp_path / "cell.yaml").write_text(CELL, encoding="utf-8")
    (tmp_path / "task.yaml").write_text(SMALL_TASK, encoding="utf-8")
    return str(tmp_path / "task.yaml")


@pytest.fixture
def request_file(tmp_path: Path) -> str:
    """A request in JSON."""
    (tmp_path / "request.json").write_text(json.dumps(FIRST_PLAN), encoding="utf-8")
    return str(tmp_path / "request.json")


def planned(file: str, out: Path, *values: str) -> dict[str, Any]:
    """The request that was planned with these values."""
    code, _, err = run("plan", file, "--out", str(out), *[word for each in values for word in ("--set", each)])
    assert code == RIGHT, err
    request: dict[str, Any] = json.loads(out.read_text())["request"]
    return request


def test_values_of_the_cell_and_of_the_task_are_set_and_the_last_counts(file: str, tmp_path: Path) -> None:
    request = planned(
        file,
        tmp_path / "p.json",
        "options.seed=2",
        "options.seed=3",
        "options.clearance_mm.near=0.5",
        "frames.belt.conveyor.speed_m_s=0.1",
        "parts.b.mass_kg=0.3",
        "start.joints.j2_rad=1.0",
        'steps.away.move.to={"at_mm": [340, 0, 150]}',
    )
    assert request["options"]["seed"] == 3
    assert request["options"]["clearance_mm"] == {"travel": 5, "near": 0.5}
    assert request["frames"]["belt"]["conveyor"] == {"at_mm": [0, 350, 50], "speed_m_s": 0.1}
    assert [body.get("mass_kg") for body in request["bodies"]] == [None, 0.12, 0.3, 0.12]
    assert request["start"]["joints"] == {"j1_deg": 20, "j2_rad": 1.0, "j3_mm": 250, "j4_deg": 0}
    assert request["task"][0]["move"]["to"] == {"at_mm": [340, 0, 150]}


def test_a_plan_is_right_for_the_cell_with_the_same_values_and_for_no_other(request_file: str, tmp_path: Path) -> None:
    plan, values = str(tmp_path / "plan.json"), ("--set", "bodies.post.pose.at_mm=[300, 250, 90]")
    assert run("plan", request_file, "--out", plan, *values)[0] == RIGHT
    assert run("check", request_file, plan, *values)[0] == RIGHT
    code, _, err = run("check", request_file, plan)
    assert code == BAD_INPUT
    there = '"at_m": [0.3, 0.25, 0.1]'
    assert f"PLAN: request.bodies[0].pose.at_mm: got [300, 250, 90]; allowed: what FILE has there: {there};" in err
    assert run("check", plan)[0] == RIGHT
    code, _, err = run("check", plan, "--set", "options.seed=7")
    assert code == BAD_INPUT
    assert "its plan is an answer to another request" in err


IN_TASK = [
    (
        "options.stop=first",
        'options.stop: got "first"; allowed: JSON, such as 3, [1, 2] or true; text in',
    ),
    ("options.stop=first", "as in --set 'options.stop=\"first\"'"),
    ("options.seed=", 'options.seed: got ""; allowed: JSON'),
    ("start.pose.at_mm=-300,0,15", "as in --set 'start.pose.at_mm=[-300, 0, 15]'"),
    ("parts.a.pose.at_mm=(1, 2.5,.5)", "as in --set 'parts.a.pose.at_mm=[1, 2.5, 0.5]'"),
    ("options.seed=+3", "write --set options.seed=3"),
    ("options.seed=007", "write --set options.seed=7"),
    ("robot.tool=True", "write --set robot.tool=true"),
    ("x=NaN", 'x: got "NaN"; allowed: JSON, such as 3, [1, 2] or true; every number must be finite'),
    ("x=1,-Infinity", "every number must be finite"),
    ("x={mm: 30}", "keys are in double quotes"),
    ("options.seed=NaN", 'options.seed: got "NaN"; allowed: JSON'),
    ("options.seed=1e999", 'options.seed: got "1e999"; allowed: JSON'),
    ("options.seed=-1", "options.seed: got -1; allowed: at least 0"),
    ("options.sed=1", "options.sed: got 1; allowed: one of "),
    ("options.sed=1", "did you mean seed?"),
    ("options.seed=null", "options.seed: got null; allowed: a value"),
    ("options.clearance_mm.near=-1", "options.clearance_mm.near: got -1; allowed: at least 0"),
    ("frames.bolt.conveyor.speed_mm_s=1", 'got "bolt"; allowed: one of belt; did you mean belt?'),
    ('frames.belt.conveyor.speed_mm_s="fast"', 'speed_mm_s: got "fast"; allowed: a number'),
    ("frames.belt.conveyor.at_mm.3=1", 'got "3"; allowed: a number from 0 to 2'),
    ("frames.belt.conveyor.at_mm.x.y=1", 'got "x"; allowed: a number from 0 to 2'),
    ("kinds.brackett.mass_kg=1", 'got "brackett"; allowed: one of bracket; did you mean bracket?'),
    ("kinds.bracket.mass_kg=-1", "kinds.bracket.mass_kg: got -1; allowed: at least 0"),
    ("slots.bx.yaw_deg=1", "one of box; did you mean box?"),
    ("slots.box.count=[0,1,1]", "slots.box.count[0]: got 0; allowed: at least 1"),
    ("positions.home.at_mm=[1,2]", "positions.home.at_mm: got [1, 2]; allowed: at least 3 items, not 2"),
    ("positions.hom.at_mm=[1,2,3]", "one of home; did you mean home?"),
    ("bodies.tabel.mass_kg=1", "or the name of an entry: table; did you mean table?"),
    ("bodies.table.mass_kg.x=1", "bodies.table.mass_kg.x: "),
    ('robot.model="rh-6"', 'robot.model: got "rh-6"; allowed: one of '),
    ('robt.model="rh-6"', 'assur: --set robt.model: got "rh-6"; allowed: a path that begins with one of about, bodies'),
    ('robt.model="rh-6"', "start, steps, streams; did you mean robot?"),
    ("request.options.seed=1", "assur: --set request.options.seed: got 1; allowed: a path that begins with one of "),
    ("request.options.seed=1", "start, steps, streams; did you mean options.seed?"),
    ("request=1", "assur: --set request: got 1; allowed: a path that begins with one of "),
    ('expect.status="planned"', 'assur: --set expect.status: got "planned"; allowed: a path that begins with one of '),
    ("task.0.move=1", "assur: --set task.0.move: got 1; allowed: a path that begins with one of "),
    ('cell.file="other.yaml"', 'assur: --set cell.file: got "other.yaml"; allowed: a path that begins with one of '),
    ("parts.z.mass_kg=1", 'got "z"; allowed: a number from 0 to 2, or the name of an entry: a, b, c'),
    ('parts.a.kind="braket"', 'parts.a.kind: got "braket"; allowed: one of the kinds: bracket'),
    ("parts.c.slot.box=9", "parts.c.slot.box: got 9; allowed: the number of a slot, 1 to 8"),
    ('parts.a.pose.frame="bolt"', 'parts.a.pose.frame: got "bolt"; allowed: one of belt, world'),
    ("steps.1.move=1", 'steps.1.move: got "1"; allowed: a number from 0 to 0, or the name of an entry: away'),
    ('steps.away.move.to="hom"', 'steps.away.move.to: got "hom"; allowed: one of the positions: home'),
    ("steps.9.move=1", 'got "9"; allowed: a number from 0 to 0, or the name of an entry: away; a transfer is one step'),
    ("steps=[]", "steps: got []; allowed: at least 1 item"),
    ("start.joints.j9_deg=1", "start.joints.j9_deg: got 1; allowed: one of j1_rad"),
    ("start.joints.j1_rad=100", "start.joints.j1_rad: got 100; allowed: -2.9"),
    ("=1", '--set: got "=1"; allowed: a path, = and a value in JSON, as in --set options.seed=3'),
    ("options", '--set: got "options"; allowed: a path, ='),
    ("options" + ".a" * 40 + "=1", "a path of at most 32 keys"),
]


@pytest.mark.parametrize(("value", "message"), IN_TASK)
def test_a_value_that_cannot_be_is_named_with_its_path(file: str, value: str, message: str) -> None:
    code, out, err = run("plan", file, "--set", value)
    assert (code, out) == (BAD_INPUT, "")
    assert err.startswith("assur: --set")
    assert message in err, err


def test_a_fault_of_a_scenario_or_a_request_that_was_not_set_stays_where_it_is(request_file: str) -> None:
    code, _, err = run("plan", "standard-cycle", "--set", "bodies.0.mass_kg=-1")
    assert code == BAD_INPUT
    assert "--set bodies.0.mass_kg: got -1; allowed: at least 0" in err
    code, _, err = run("plan", request_file, "--set", 'bodies.1.name="post"')
    assert code == BAD_INPUT
    assert '--set bodies.1.name: got "post"; allowed: a name that no other body has' in err
    code, _, err = run("plan", request_file, "--set", 'frames={"belt": {"linear": {}}}')
    assert code == BAD_INPUT
    assert "--set frames.belt.linear.at_m: it is missing" in err or "--set frames" in err


@pytest.mark.parametrize("shown", [True, False], ids=["a scenario", "a request in JSON"])
def test_a_path_that_begins_with_no_field_of_the_request_is_named(request_file: str, *, shown: bool) -> None:
    values = ("--set", "request.options.seed=1", "--set", "expect.status=2")
    code, _, err = run("plan", "demo" if shown else request_file, *values)
    assert code == BAD_INPUT
    first, second = err.splitlines()
    assert first.startswith("assur: --set request.options.seed: got 1; allowed: a path that begins with one of bodies,")
    assert first.endswith("did you mean options.seed?")
    assert second.startswith("assur: --set expect.status: got 2; allowed: a path that begins with one of bodies,")
