"""What comes after a plan begins in its end: the same state to the bit, parts and slots as the plan left them."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

import assur
from assur.api.command_line import app
from assur.api.python.answer import Answer
from assur.api.workers.answer_parts import part_of, parts_wanted
from assur.planner.errors import InputError
from assur.request import Move, Step, Target
from assur.scenes.faults import DocumentError
from assur.scenes.plan_file import PlanFile
from assur.scenes.requests import cell_of
from assur.scenes.tasks.next_task import end_state
from assur.scenes.text.yaml_text import parse_yaml
from tests.changed import changed

Document = dict[str, Any]

CELL = """
schema: assur-cell/1
robot: {model: mitsubishi-rh-6frh5520, tool: {tcp_mm: [0, 0, -100]}}
frames:
  belt: {conveyor: {at_mm: [0, 350, 50], speed_mm_s: 150}, uncertainty: {speed_mm_s: 2}}
  lane: {fixed: {frame: belt, at_mm: [0, -40, 0]}}
  shelf: {fixed: {at_mm: [300, -230, 60]}}
kinds:
  bracket: {shape: {box: {size_mm: [60, 40, 20]}}, mass_kg: 0.12, yaw_symmetry: 2, grasp_mm: [0, 0, 10]}
bodies:
  - {name: table, shape: {box: {size_mm: [260, 200, 10]}}, pose: {at_mm: [360, -200, 45]}}
  - {name: mark, shape: {sphere: {radius_mm: 5}}, pose: {frame: lane, at_mm: [-2000, 0, 0]}}
positions: {home: {at_mm: [350, 0, 180]}}
slots:
  box: {frame: shelf, step_mm: [75, 60, 0], at_mm: [0, 0, 0], count: [2, 1, 1], contact_with: [table]}
"""
TASK = """
schema: assur-task/1
cell: {file: cell.yaml}
start: {joints: {j1_deg: 20, j2_deg: 60, j3_mm: 300, j4_deg: 0}}
parts:
  - {name: a, kind: bracket, pose: {frame: belt, at_mm: [-300, 0, 10]}}
  - {name: b, kind: bracket, pose: {frame: belt, at_mm: [-700, 0, 10]}, uncertainty: {yaw_deg: 1}}
steps: [{transfer: {parts: [a], to: box}}, {move: {to: home}}]
options: {seed: 1, stop: first, max_candidates: 100, budget_s: 20}
"""
LISTED = "parts: [{name: b, kind: bracket}]\n"
NEXT = (
    TASK.split("start:", maxsplit=1)[0]
    + LISTED
    + "steps: [{transfer: {parts: [b], to: box}}]\n"
    + TASK[TASK.index("options:") :]
)


def read(text: str) -> Document:
    document, _ = parse_yaml(text.encode())
    return dict(document)


@cache
def planned(steps: str = "") -> Answer:
    """The answer to the task, or to another with these steps."""
    task = read(TASK)
    if steps:
        task["steps"] = read(f"steps: {steps}")["steps"]
    answer = assur.Cell(read(CELL)).plan(**fields(task))
    assert answer.planned, answer.sentence
    return answer


def fields(task: Document) -> Document:
    return {key: task[key] for key in ("start", "parts", "steps", "options")}


def then(answer: Answer, document: Document) -> Answer:
    """The answer to what comes after `answer`."""
    return assur.Cell(read(CELL)).plan(**document) if "steps" in document else assur.plan(document)


def test_state_and_clock_of_the_next_plan_are_the_same_to_the_bit() -> None:
    before = planned()
    after = then(before, before.next_task([{"move": {"to": {"at_mm": [300, 200, 150]}}}]))
    assert after.planned
    first, last = after["trajectory"], before["trajectory"]
    assert first["time_s"][0] == last["time_s"][-1]
    for key in ("position", "velocity", "acceleration"):
        assert first[key][0] == last[key][-1]


@pytest.mark.parametrize(
    ("argument", "field"),
    [
        ({"steps": [{"place": {"part": "a", "to": {"slot": {"box": 10**400}}}}]}, "steps[0].place.to.slot.box"),
        ({"set": {"options.seed": 10**400}}, "set.options.seed"),
    ],
)
def test_a_number_that_no_document_has_is_named_below_its_argument(argument: Document, field: str) -> None:
    with pytest.raises(InputError) as refused:
        assur.Cell(read(CELL)).request(**fields(read(TASK)) | argument)
    assert refused.value.field == field


@pytest.mark.parametrize(
    ("steps", "parts", "field"),
    [
        (None, (), "steps"),
        ("move", (), "steps"),
        ({"move": {"to": "home"}}, (), "steps"),
        ([3], (), "steps[0]"),
        ([], (), "steps"),
        ([{"move": {"to": "home"}}], None, "parts"),
        ([{"move": {"to": "home"}}], ["a"], "parts[0]"),
        ([{"move": {"to": "home"}}], [{"kind": "bracket"}], "parts[0].name"),
    ],
)
def test_what_is_no_list_of_steps_or_parts_is_refused(steps: Any, parts: Any, field: str) -> None:
    with pytest.raises(InputError) as refused:
        planned().next_task(steps, parts=parts)
    assert refused.value.field == field


def test_steps_may_be_built_of_classes() -> None:
    step = Step(move=Move(to=Target(at_m=[0.3, 0.2, 0.15])))
    of = planned()
    for before in (of, Answer(of.document, of.request)):
        assert then(before, before.next_task([step])).planned


def test_a_filled_slot_stays_filled_and_a_part_keeps_its_kind() -> None:
    """The slots sit in a frame that is fixed in the world, in which the answer has the place."""
    task = planned().next_task([{"transfer": {"parts": ["b"], "to": "box"}}])
    assert [part["name"] for part in task["parts"]] == ["a", "b"]
    assert task["parts"][0]["slot"] == {"box": 1}
    assert "pose" not in task["parts"][0]
    assert task["parts"][0]["kind"] == "bracket"
    after = then(planned(), task)
    assert after.planned, after.sentence
    assert assur.check(after.request or {}, after)["ok"]
    arrival = next(each for each in after.arrivals if each["control_point"] == "place-b")
    assert arrival["at_m"][:2] == pytest.approx([0.375, -0.23])
    with pytest.raises(InputError, match=r"steps\[0\]\.transfer\.to.*slots with one that is free: all 2 are taken"):
        after.next_task(
            [{"transfer": {"parts": ["c"], "to": "box"}}],
            parts=[{"name": "c", "kind": "bracket", "pose": {"frame": "belt", "at_mm": [-1200, 0, 10]}}],
        )


@pytest.mark.parametrize(
    "other", [{"yaw_deg": 90}, {"pitch_deg": 90}, {"roll_rad": 0.5}, {"at_s": 0.5}], ids=lambda other: next(iter(other))
)
def test_a_part_at_the_point_of_a_slot_that_lies_otherwise_keeps_its_pose(other: Document) -> None:
    pose = {"frame": "shelf", "at_mm": [0, 0, 0], **other}
    task = read(TASK) | {"parts": [{"name": "a", "kind": "bracket", "pose": pose}], "steps": [{"move": {"to": "home"}}]}
    before = assur.Cell(read(CELL)).plan(**fields(task))
    assert before.planned, before.sentence
    assert before.next_task([{"move": {"to": "home"}}])["parts"] == task["parts"]


def test_slots_that_are_set_elsewhere_do_not_take_a_part_along(folder: Path) -> None:
    """Moved by one step, the first slot is where the second was."""
    cell, steps = assur.Cell(read(CELL)), [{"move": {"to": "home"}}]
    before = cell.plan(**fields(read(TASK)), set={"slots.box.at_mm": [75, 0, 0]})
    assert before.planned, before.sentence
    task = before.next_task(steps)
    assert task["parts"][0]["slot"] == {"box": 1}
    assert cell.request(**task)["bodies"][2]["pose"]["at_m"] == [0.075, 0.0, 0.0]
    (folder / "next.yaml").write_text(NEXT.replace("steps:", "set: {slots.box.at_mm: [0, 100, 0]}\nsteps:"))
    for given in ((), ("--set", "slots.box.at_mm=[0, 100, 0]")):
        code, output, held = run(folder, more=given)
        assert code in (0, 1), output
        pose = next(body["pose"] for body in held["request"]["bodies"] if body["name"] == "a")
        assert pose == {"frame": "shelf", "at_m": [0.0, 0.0, 0.0], "yaw_rad": 0.0}


def test_slots_on_a_body_that_is_elsewhere_now_do_not_take_a_part_along(folder: Path) -> None:
    text = CELL.replace(
        "{frame: shelf, step_mm: [75, 60, 0], at_mm: [0, 0, 0]",
        "{body: table, step_mm: [75, 60, 0], at_mm: [-60, -30, 15]",
    )
    before = assur.Cell(read(text)).plan(**fields(read(TASK)))
    assert before.planned, before.sentence
    before.save(folder / "plan.json")
    home = NEXT.replace("{transfer: {parts: [b], to: box}}", "{move: {to: home}}")
    (folder / "next.yaml").write_text(home)
    place = pytest.approx([0.3, -0.23, 0.06])
    for shift in ("at_mm: [360, -200, 45]", "at_mm: [360, -180, 45]"):
        (folder / "cell.yaml").write_text(text.replace("at_mm: [360, -200, 45]", shift))
        code, output, held = run(folder)
        assert code == 0, output
        pose = next(body["pose"] for body in held["request"]["bodies"] if body["name"] == "a")
        if "-200" in shift:
            assert pose["body"] == "table"
        else:
            assert pose["at_m"] == place


@pytest.mark.parametrize("of", ["frame: none", "body: none"])
def test_slots_of_nothing_are_refused_where_they_are_used(folder: Path, of: str) -> None:
    (folder / "cell.yaml").write_text(CELL.replace("box: {frame: shelf", f"box: {{{of}"))
    code, output, _ = run(folder)
    assert code == 2
    assert f"cell.yaml: slots.box.{of.partition(':')[0]}" in output


def test_more_slots_than_may_be_are_refused_at_once(folder: Path) -> None:
    (folder / "cell.yaml").write_text(CELL.replace("count: [2, 1, 1]", "count: [10000, 10000, 10000]"))
    code, output, _ = run(folder)
    assert code == 2
    assert "cell.yaml: slots.box.count" in output
    assert "at most 10,000 slots in all" in output


@pytest.mark.parametrize(("path", "value"), [("start.joints.j1_deg", "40"), ("start.at_s", "0"), ("parts", "[]")])
def test_what_is_of_the_plan_is_not_set(folder: Path, path: str, value: str) -> None:
    code, output, _ = run(folder, more=("--set", f"{path}={value}"))
    assert code == 2
    assert f"--set {path}: got {value}" in output
    assert "it is that of the plan" in output


def test_what_a_plan_proves_of_a_part_that_it_put_down_is_how_well_it_is_known() -> None:
    task, before = planned().next_task([{"move": {"to": "home"}}]), planned()
    error = next(each for each in before.arrivals if each["control_point"] == "place-a")["error"]
    assert error is not None
    assert error["horizontal_m"] > 0.0
    assert task["parts"][0]["uncertainty"] == {
        "position_m": error["horizontal_m"],
        "vertical_m": error["vertical_m"],
        "yaw_rad": error["yaw_rad"],
    }


def test_what_rides_on_a_belt_of_uncertain_speed_is_known_less_well_by_the_time_of_the_plan() -> None:
    """Also in a frame that is fixed in the belt. A body of the cell is changed by `set`."""
    before = planned()
    task, off_m = before.next_task([{"move": {"to": "home"}}]), 0.002 * before.duration_s
    b = task["parts"][1]
    assert b["uncertainty"] == {"position_m": off_m, "vertical_m": 0.0, "yaw_rad": pytest.approx(0.0174532925)}
    assert b["pose"] == {"frame": "belt", "at_mm": [-700, 0, 10]}
    assert task["set"] == {"bodies.mark.uncertainty": {"position_m": off_m, "vertical_m": 0.0, "yaw_rad": 0.0}}
    second = then(before, task)
    again = second.next_task([{"move": {"to": "home"}}])
    assert again["set"]["bodies.mark.uncertainty"]["position_m"] == off_m + 0.002 * second.duration_s


def test_what_rides_on_a_lift_of_uncertain_speed_is_known_less_well_up_and_down() -> None:
    cell = read(CELL)
    lift = {"at_mm": [0, -500, 0], "velocity_mm_s": [0, 30, 40]}
    cell["frames"]["lift"] = {"linear": lift, "uncertainty": {"speed_mm_s": 5}}
    box = {"box": {"size_mm": [60, 40, 20]}}
    cell["bodies"].append({"name": "load", "shape": box, "pose": {"frame": "lift", "at_mm": [0, 0, 0]}})
    steps = [{"move": {"to": "home"}}]
    before = assur.Cell(cell).plan(**fields(read(TASK)) | {"parts": [], "steps": steps})
    assert before.planned, before.sentence
    known, off_m = before.next_task(steps)["set"]["bodies.load.uncertainty"], 0.005 * before.duration_s
    assert known["position_m"] == pytest.approx(0.6 * off_m)
    assert known["vertical_m"] == pytest.approx(0.8 * off_m)


def test_of_a_part_with_a_time_the_error_counts_from_that_time_and_not_twice() -> None:
    task = read(TASK)
    task["parts"][1]["pose"] = {"frame": "belt", "at_mm": [-700, 0, 10], "at_s": -1.0}
    before = assur.Cell(read(CELL)).plan(**fields(task))
    after = before.next_task([{"transfer": {"parts": ["b"], "to": "box"}}])
    assert after["parts"][1] == task["parts"][1]
    b = next(body for body in cell_of(assur.Cell(read(CELL)).request(**after)).scene.bodies if body.name == "b")
    assert b.uncertainty.position_m == pytest.approx(0.002 * (before.duration_s + 1.0), rel=1e-12)


def test_a_part_with_a_time_that_was_put_back_is_known_as_the_plan_proves_and_not_from_its_time() -> None:
    """Its time is later than the end: from it to the next start the belt may have gone less than in the plan."""
    task = read(TASK)
    pose = {"frame": "belt", "at_mm": [0, 0, 10], "at_s": 2.0}
    task["parts"] = [{"name": "a", "kind": "bracket", "pose": pose}]
    back = {"frame": "belt", "at_mm": [-300, 0, 10], "yaw_deg": 0}
    task["steps"] = [{"pick": {"part": "a"}}, {"place": {"part": "a", "to": back}}]
    before = assur.Cell(read(CELL)).plan(**fields(task))
    assert before.planned, before.sentence
    error, part = before.arrivals[-1]["error"], before.next_task([{"move": {"to": "home"}}])["parts"][0]
    assert error is not None
    assert part["pose"] == {"frame": "belt", "at_m": [-0.3, 0.0, 0.01], "yaw_rad": 0.0}
    assert part["uncertainty"]["position_m"] == error["horizontal_m"] + 0.002 * before.duration_s


def test_a_part_that_the_gripper_holds_is_held_as_it_was_gripped() -> None:
    before = planned("[{pick: {part: a}}]")
    task = before.next_task([{"place": {"part": "a", "to": "box"}}])
    holding, error = task["start"]["holding"], before.arrivals[0]["error"]
    assert error is not None
    assert holding["part"] == "a"
    assert holding["within"]["position_m"] == error["horizontal_m"]
    assert holding["grasp_yaw_rad"] == before.arrivals[0]["yaw_offset_rad"]
    assert holding["grasp_m"] == pytest.approx([0.0, 0.0, 0.01], abs=1e-15)
    assert not task["parts"][0].keys() & {"pose", "slot"}
    after = then(before, task)
    assert after.planned, after.sentence
    assert assur.check(after.request or {}, after)["ok"]


@pytest.mark.parametrize("put_down", [True, False])
def test_a_body_of_the_cell_that_a_plan_moved_is_not_back_at_its_place_in_silence(put_down: bool) -> None:
    cell = read(CELL)
    lid = {"name": "lid", "shape": {"box": {"size_mm": [60, 40, 20]}}, "mass_kg": 0.1, "pose": {"at_mm": [330, 60, 60]}}
    cell["bodies"].append(lid)
    place = {"part": "lid", "to": {"at_mm": [330, -230, 60], "yaw_deg": 0}, "contact_with": ["table"]}
    steps = [{"pick": {"part": "lid", "grasp_mm": [0, 0, 10]}}, *([{"place": place}] if put_down else [])]
    before = assur.Cell(cell).plan(**fields(read(TASK)) | {"parts": [], "steps": steps})
    assert before.planned, before.sentence
    with pytest.raises(InputError, match=r"cell\.bodies\[2\]\.name: .*no step of the plan handles"):
        before.next_task([{"move": {"to": "home"}}])


def test_after_a_request_comes_a_request() -> None:
    of = planned()
    before = Answer(of.document, of.request)
    request = before.next_task([{"move": {"to": {"at_mm": [300, 200, 150]}}}])
    assert request["schema"] == "assur/1"
    assert request["robot"] == read(CELL)["robot"]
    bodies = {body["name"]: body for body in request["bodies"]}
    assert bodies["a"]["pose"] == {"frame": "shelf", "at_m": [0.0, 0.0, 0.0], "yaw_rad": 0.0}
    assert bodies["mark"]["uncertainty"]["position_m"] == 0.002 * before.duration_s
    assert bodies["table"] == read(CELL)["bodies"][0]
    after = then(before, request)
    assert after.planned
    assert after["trajectory"]["position"][0] == before["trajectory"]["position"][-1]
    with pytest.raises(InputError, match="parts of a request are bodies"):
        before.next_task([{"move": {"to": {"at_mm": [300, 200, 150]}}}], parts=[{"name": "c"}])


@pytest.mark.parametrize("kind", ["cell file", "request"])
def test_what_comes_after_a_plan_of_a_file_is_planned_in_a_cell(tmp_path: Path, kind: str) -> None:
    of = planned()
    loaded = assur.load_answer(of.save(tmp_path / "plan.json"))
    cell = assur.Cell(read(CELL) if kind == "cell file" else of.request or {})
    task = loaded.next_task([{"move": {"to": {"at_mm": [300, 200, 150]}}}], cell=cell)
    assert task == loaded.next_task([{"move": {"to": {"at_mm": [300, 200, 150]}}}], cell=cell.document)
    after = cell.plan(**task)
    assert after.planned, after.sentence
    assert after["trajectory"]["position"][0] == of["trajectory"]["position"][-1]
    request = loaded.next_task([{"move": {"to": {"at_mm": [300, 200, 150]}}}])
    assert (after.request or {})["options"] == request["options"]
    bodies = {body["name"]: body for body in (after.request or {})["bodies"]}
    assert {name: cell_of(request).places[name] for name in bodies} == dict(cell_of(after.request).places)


@pytest.mark.parametrize("kind", ["cell file", "request"])
@pytest.mark.parametrize(
    ("path", "value", "before"),
    [
        ("frames.belt.conveyor.speed_mm_s", 160, '"speed_mm_s": 150'),
        ("frames.lane.fixed.at_mm", [0, -50, 0], '"at_mm": [0, -40, 0]'),
        ("frames.shelf.fixed.yaw_deg", 1, "nothing"),
        ("robot.tool.tcp_mm", [0, 0, -90], '"tcp_mm": [0, 0, -100]'),
        ("neighbours[+]", "its own plan", "nothing"),
    ],
)
def test_a_plan_of_another_cell_is_refused_at_the_value_that_differs(
    kind: str, path: str, value: Any, before: str
) -> None:
    of = planned()
    own = read(CELL) if kind == "cell file" else of.request or {}
    if path == "neighbours[+]":
        robot = {**own["robot"], "base": {"at_mm": [0, 5000, 0]}}
        path, value = "neighbours[0]", {"name": "other", "robot": robot, "trajectory": of["trajectory"]}
        other = {**own, "neighbours": [value]}
    else:
        other = changed(own, {path: value})
    with pytest.raises(InputError) as refused:
        of.next_task([{"move": {"to": {"at_mm": [300, 200, 150]}}}], cell=other)
    assert refused.value.field == ("cell." if kind == "cell file" else "") + path
    assert refused.value.value == value
    assert refused.value.allowed == f"what the request of the plan has there: {before}"


def test_a_plan_that_is_not_right_is_not_continued() -> None:
    of = planned()
    wrong, short = copy.deepcopy(of.document), copy.deepcopy(of.document)
    wrong["trajectory"]["position"][-1][0] += 1e-3
    short["certificate"] = {key: short["certificate"][key] for key in ("digest", "rows", "covers")}
    for document, field in ((wrong, "plan"), (short, "plan.certificate")):
        with pytest.raises(InputError) as refused:
            Answer(document, of.request).next_task([{"move": {"to": {"at_mm": [300, 200, 150]}}}])
        assert refused.value.field == field


def _no_error(answer: Document) -> None:
    del answer["arrivals"][0]["error"]


@pytest.mark.parametrize(
    ("change", "field"),
    [
        (lambda answer: answer.update(status="not_planned"), "plan"),
        (lambda answer: answer.update(request_digest="sha256:0"), "plan.request_digest"),
        (lambda answer: answer.pop("trajectory"), "plan.trajectory"),
        (lambda answer: answer["trajectory"]["position"][-1].append(0.0), "plan.trajectory.position"),
        (_no_error, "plan.arrivals[0].error"),
        (lambda answer: answer.update(legs=[]), "plan.legs"),
        (lambda answer: answer["legs"][-1].update(step=9), "plan.legs"),
    ],
)
def test_an_answer_without_an_end_is_refused(change: Callable[[Document], object], field: str) -> None:
    answer = copy.deepcopy(planned().document)
    change(answer)
    with pytest.raises(InputError) as refused:
        end_state(planned().request or {}, answer)
    assert refused.value.field.startswith(field)


@pytest.mark.parametrize("kept", ["legs", "trajectory,arrivals", "schema,trajectory,legs,arrivals"])
def test_what_fields_leave_out_of_an_answer_is_named(kept: str) -> None:
    part, request = part_of(planned().document, parts_wanted(kept, None)), planned().request or {}
    motion = ["trajectory", "legs", "arrivals"]
    calls: list[tuple[list[str], Callable[[], object]]] = [
        (["schema", *motion, "certificate"], lambda: assur.check(request, part)),
        (motion, lambda: Answer(part, request).next_task([{"move": {"to": {"at_mm": [300, 200, 150]}}}])),
    ]
    for needed, call in calls:
        left = {f"plan.{key}" for key in needed if key not in part} or {"plan.certificate"}
        with pytest.raises(DocumentError) as refused:
            call()
        faults = (refused.value, *refused.value.more)
        assert {each.field for each in faults} == left
        assert all(
            each.allowed.endswith("`fields` selects parts of an answer, it must list this one, too") for each in faults
        )


def test_a_trajectory_of_which_fields_leave_something_out_is_named() -> None:
    part = part_of(planned().document, parts_wanted("trajectory.time_s,legs,arrivals", None))
    with pytest.raises(DocumentError, match="`fields` selects parts of an answer") as refused:
        Answer(part, planned().request).next_task([{"move": {"to": {"at_mm": [300, 200, 150]}}}])
    assert refused.value.field == "plan.trajectory.joint_names"


@pytest.mark.parametrize("placed", [True, False])
def test_nothing_follows_a_plan_at_whose_end_the_arm_may_be_shifted(*, placed: bool) -> None:
    """By belt correction: the next plan would not know by how much."""
    steps: list[Document] = [{"pick": {"part": "a"}}, {"move": {"to": "home"}}]
    steps[1:1] = [{"place": {"part": "a", "to": {"slot": {"box": 1}}}}] if placed else []
    cell = assur.Cell({**read(CELL), "execution": {"belt_correction": True}})
    answer = cell.plan(**fields(read(TASK) | {"steps": steps}))
    assert answer.planned, answer.sentence
    goes = [{"move": {"to": {"at_mm": [300, 200, 180]}}}]
    if placed:
        assert cell.plan(**answer.next_task(goes)).planned
        return
    with pytest.raises(InputError, match="behind a point on belt, belt_correction may have shifted the arm") as refused:
        answer.next_task(goes)
    assert refused.value.field == "plan"


# ---- on the command line -------------------------------------------------------------------------------------------


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    before = planned()
    (tmp_path / "cell.yaml").write_text(CELL)
    (tmp_path / "next.yaml").write_text(NEXT)
    (tmp_path / "plan.json").write_text(json.dumps(PlanFile(before.request or {}, before.document).document))
    return tmp_path


def run(
    folder: Path, file: str = "next.yaml", plan: str = "plan.json", more: tuple[str, ...] = ()
) -> tuple[int, str, Document]:
    files = ["--continue", str(folder / plan), "--out", str(folder / "out.json")]
    made = CliRunner().invoke(app, ["plan", str(folder / file), *files, *more])
    out = folder / "out.json"
    return made.exit_code, " ".join(made.output.split()), json.loads(out.read_text()) if out.is_file() else {}


def test_a_task_file_continues_a_plan_file(folder: Path) -> None:
    """Its parts are those of the plan: here all that is known of `b` is that it was on the belt."""
    code, output, held = run(folder)
    assert code == 0, output
    last = planned()["trajectory"]
    assert held["plan"]["trajectory"]["position"][0] == last["position"][-1]
    assert held["plan"]["start_s"] == last["time_s"][-1]
    bodies = {body["name"]: body for body in held["request"]["bodies"]}
    assert bodies["a"]["pose"] == {"frame": "shelf", "yaw_rad": 0.0, "at_m": [0.0, 0.0, 0.0]}
    assert bodies["b"]["pose"] == {"frame": "belt", "at_mm": [-700, 0, 10]}
    place = held["request"]["task"][1]["place"]
    assert place["to"]["at_m"] == [0.075, 0.0, 0.0]


def test_a_plan_that_continues_another_is_checked_with_its_task(folder: Path) -> None:
    code, output, _ = run(folder)
    assert code == 0, output

    def called(command: str, *more: str, after: str = "plan.json") -> tuple[int, str]:
        files = [str(folder / "next.yaml"), str(folder / "out.json"), "--continue", str(folder / after)]
        made = CliRunner().invoke(app, [command, *files, *more])
        return made.exit_code, " ".join(made.output.split())

    assert called("check")[0] == 0
    out = ("--out", str(folder / "report.html"))
    assert called("report", *out)[0] == 0
    assert (folder / "report.html").stat().st_size > 0
    # another first plan, or another value, is another request
    first, last = (planned()["trajectory"]["time_s"][-1], json.loads((folder / "out.json").read_text())["plan"])
    code, output = called("check", after="out.json")
    assert code == 2
    at_s = last["trajectory"]["time_s"][-1]
    assert f'PLAN: request.start.at_s: got {first}; allowed: what FILE has there: "at_s": {at_s}' in output
    code, output = called("check", "--set", "options.seed=2")
    assert code == 2
    assert 'PLAN: request.options.seed: got 1; allowed: what FILE has there: "seed": 2; this file' in output
    code, output = called("report", "--out", str(folder / "plan.json"))
    assert (code, "another file than those" in output) == (2, True)
    held = json.loads((folder / "out.json").read_text())
    held["plan"]["trajectory"]["position"][3][0] += 1e-3
    (folder / "out.json").write_text(json.dumps(held))
    assert called("check")[0] == called("report", *out)[0] == 1
    alone = CliRunner().invoke(app, ["check", str(folder / "next.yaml"), str(folder / "out.json")])
    assert alone.exit_code == 2
    assert "--continue of plan, check or report" in " ".join(alone.output.split())


def test_values_that_were_set_for_the_plan_are_set_again(folder: Path) -> None:
    faster = {"frames.belt.conveyor.speed_mm_s": 240, "robot.limits": {"acceleration": 0.9}}
    before = assur.Cell(read(CELL)).plan(**fields(read(TASK)), set=faster)
    assert before.planned, before.sentence
    before.save(folder / "plan.json")
    sets = [part for path, value in faster.items() for part in ("--set", f"{path}={json.dumps(value)}")]
    code, output, held = run(folder, more=tuple(sets))
    assert code == 0, output
    assert held["plan"]["trajectory"]["position"][0] == before["trajectory"]["position"][-1]
    files = [str(folder / "next.yaml"), str(folder / "out.json"), "--continue", str(folder / "plan.json")]
    checked = CliRunner().invoke(app, ["check", *files, *sets])
    assert checked.exit_code == 0, checked.output
    for less in ((), tuple(sets[:2])):
        code, output, _ = run(folder, more=less)
        assert code == 2
        assert "what the request of the plan has there" in output


def test_a_part_that_is_listed_without_a_place_is_known_no_better_than_before(folder: Path) -> None:
    task = read(TASK) | {"steps": [{"move": {"to": "home"}}]}
    far = {"name": "c", "kind": "bracket", "pose": {"at_mm": [330, 60, 60]}, "uncertainty": {"position_mm": 5}}
    task["parts"].append(far)
    before = assur.Cell(read(CELL)).plan(**fields(task))
    assert before.planned, before.sentence
    before.save(folder / "plan.json")
    (folder / "next.yaml").write_text(
        NEXT.replace(LISTED, LISTED.replace("name: b", "name: c")).replace(
            "{transfer: {parts: [b], to: box}}", "{move: {to: home}}"
        )
    )
    code, output, held = run(folder)
    assert code == 0, output
    bodies = {body["name"]: body for body in held["request"]["bodies"]}
    assert bodies["c"]["uncertainty"] == far["uncertainty"]


ALIKE = CELL.replace(
    "bodies:", "  tray: {shape: {box: {size_m: [0.06, 0.04, 0.02]}}, grasp_mm: [0, 0, 12]}\nbodies:", 1
)
"""A second kind of the same shape."""
ASKED = 'got "b"; allowed: a part that `parts` list with its kind, which states the grasp and is not in the plan: '


@pytest.mark.parametrize(
    ("steps", "cell", "given", "field", "kinds"),
    [
        ("{transfer: {parts: [b], to: box}}", CELL, (), "line 4: steps[0].transfer.parts[0]", "bracket}]; its"),
        ("{move: {to: home}}, {pick: {part: b}}", CELL, (), "line 4: steps[1].pick.part", "bracket}]; its"),
        ("{transfer: {parts: [b], to: box}}", ALIKE, (), "steps[0].transfer", "bracket}], of one of the kinds of its"),
        (
            "{move: {to: home}}",
            CELL,
            ("--set", 'steps.0={"pick": {"part": "b"}}'),
            "--set steps.0.pick.part",
            "bracket",
        ),
        (
            "{pick: {part: b}}",
            CELL.replace("grasp_mm: [0, 0, 10]", "dwell_ms: 50"),
            (),
            "steps[0].pick.part",
            "bracket",
        ),
        (
            "{pick: {part: b}}",
            CELL.replace(", grasp_mm: [0, 0, 10]", ""),
            ("--set", "kinds.bracket.grasp_yaw_deg=90"),
            "steps[0].pick.part",
            "bracket",
        ),
    ],
)
def test_a_part_of_the_plan_that_is_picked_is_listed_with_its_kind(
    folder: Path, steps: str, cell: str, given: tuple[str, ...], field: str, kinds: str
) -> None:
    """Else it would be picked at its middle."""
    (folder / "cell.yaml").write_text(cell)
    (folder / "next.yaml").write_text(NEXT.replace(LISTED, "").replace("{transfer: {parts: [b], to: box}}", steps))
    code, output, held = run(folder, more=given)
    assert code == 2
    assert f"{field}" in output
    assert f"{ASKED}write parts: [{{name: b, kind: {kinds}" in output
    assert not held


@pytest.mark.parametrize(
    ("listed", "message"),
    [
        (
            "kind: bracket",
            "line 4: parts[0].mass_kg: it is missing; allowed: a number, which must be given: the plan has 0.9,",
        ),
        (
            "kind: bracket, mass_kg: 0.9",
            "parts[0].yaw_symmetry: it is missing; allowed: a number, which must be given: the",
        ),
        ("kind: bracket, mass_kg: 0.9, yaw_symmetry: 1", ""),
        ("kind: bracket, mass_kg: 0.8, yaw_symmetry: 2", ""),
        ("kind: bracket, pose: {frame: belt, at_mm: [-690, 5, 10]}", ""),
        (
            "kind: long, mass_kg: 0.9, yaw_symmetry: 1",
            'parts[0].kind: got "long"; allowed: the shape that b has in the plan',
        ),
        ("shape: {box: {size_mm: [60, 40, 21]}}", "parts[0].shape: got "),
        ("kind: other", 'parts[0].kind: got "other"; allowed: one of the kinds: bracket, long'),
        (
            "kind: bracket, mass_kg: 0.9, yaw_symmetry: 1, uncertainty: {position_mm: 0}",
            'parts[0].uncertainty: got "an object with 1 field"; allowed: none without a place',
        ),
    ],
)
@pytest.mark.parametrize("of_file", [True, False])
def test_a_part_of_a_plan_is_not_another_part_because_it_is_listed(
    folder: Path, listed: str, message: str, of_file: bool
) -> None:
    """The plan has a part of 0.9 kg that is not the same when it is turned, unlike others of its kind."""
    cell = CELL.replace("bodies:", "  long: {shape: {box: {size_mm: [80, 40, 20]}}, grasp_mm: [0, 0, 10]}\nbodies:", 1)
    (folder / "cell.yaml").write_text(cell)
    text = TASK.replace("uncertainty: {yaw_deg: 1}", "mass_kg: 0.9, yaw_symmetry: 1")
    before = assur.Cell(read(cell)).plan(**fields(read(text)))
    if of_file:
        (folder / "plan.json").write_text(json.dumps(PlanFile(before.request or {}, before.document).document))
        (folder / "next.yaml").write_text(NEXT.replace("kind: bracket", listed))
        code, output, held = run(folder)
        assert code == (2 if message else 0), output
        assert message in output
        assert message or held["plan"]["status"] == "planned"
        return
    task = read(NEXT.replace("kind: bracket", listed))
    if not message:
        assert assur.Cell(read(cell)).plan(**before.next_task(task["steps"], parts=task["parts"])).planned
        return
    with pytest.raises(InputError) as refused:
        before.next_task(task["steps"], parts=task["parts"])
    assert refused.value.field in message


CRUMB = CELL.replace(
    "bodies:", "  crumb: {shape: {box: {size_mm: [10, 10, 10]}}, mass_kg: 0.001, grasp_mm: [0, 0, 10]}\nbodies:", 1
)


@pytest.mark.parametrize("path", ["parts.b.kind", "parts.0.kind", "parts[0].kind"])
def test_a_part_of_a_plan_is_not_another_part_because_its_kind_is_set(folder: Path, path: str) -> None:
    (folder / "cell.yaml").write_text(CRUMB)
    code, output, held = run(folder, more=("--set", f'{path}="crumb"'))
    assert (code, held) == (2, {})
    assert f'--set {path}: got "crumb"; allowed: the shape that b has in the plan' in output


@pytest.mark.parametrize("listed", [[], [{"name": "b", "kind": "bracket"}]])
@pytest.mark.parametrize(
    ("change", "key"), [({"shape": {"box": {"size_mm": [10, 10, 10]}}}, "shape"), ({"mass_kg": 0.001}, "mass_kg")]
)
def test_the_parts_of_a_plan_stay_what_they_are_in_a_cell_with_other_kinds(
    listed: list[Document], change: Document, key: str
) -> None:
    """Also those that nobody picks."""
    other = read(CELL)
    other["kinds"]["bracket"] |= change
    with pytest.raises(InputError) as refused:
        planned().next_task([{"move": {"to": "home"}}], parts=listed, cell=assur.Cell(other))
    assert refused.value.field == (
        f"cell.kinds.bracket.{key}" if not listed else "parts[0].kind" if key == "shape" else "parts[0].mass_kg"
    )


@pytest.mark.parametrize(
    ("steps", "cell"),
    [
        ("{pick: {part: b, grasp_mm: [0, 0, 10]}}", CELL),
        ("{pick: {part: b}}", CELL.replace(", grasp_mm: [0, 0, 10]", "")),
        ("{pick: {part: b}}", CELL.replace("[60, 40, 20]", "[60, 40, 21]")),
        ("{pick: {part: other}}", CELL),
    ],
)
def test_no_kind_is_required_of_a_part_whose_grasp_no_kind_states(folder: Path, steps: str, cell: str) -> None:
    (folder / "cell.yaml").write_text(cell)
    (folder / "next.yaml").write_text(NEXT.replace(LISTED, "").replace("{transfer: {parts: [b], to: box}}", steps))
    _, output, _ = run(folder, more=("--set", "options.max_candidates=1"))
    assert ASKED not in output
    assert ("steps[0].pick.part" in output) is ("other" in steps)


def test_what_comes_after_an_answer_of_a_file_lists_the_kind_of_a_part_that_is_picked(tmp_path: Path) -> None:
    """An answer of `assur.Cell` knows the kinds of its parts, one of a file does not."""
    before, steps = planned(), [{"transfer": {"parts": ["b"], "to": "box"}}]
    assert {part["name"]: part["kind"] for part in before.next_task(steps)["parts"]} == {"a": "bracket", "b": "bracket"}
    read_again = assur.load_answer(before.save(tmp_path / "plan.json"))
    with pytest.raises(
        InputError, match=r"^steps\[0\]\.transfer\.parts\[0\]: got 'b'; allowed: a part that `parts` list"
    ):
        read_again.next_task(steps, cell=assur.Cell(read(CELL)))
    task = read_again.next_task(steps, cell=assur.Cell(read(CELL)), parts=[{"name": "b", "kind": "bracket"}])
    assert then(before, task).planned


def test_a_place_that_the_task_states_counts_more_than_that_of_the_plan(folder: Path) -> None:
    seen = LISTED.replace("}]", ", pose: {frame: belt, at_mm: [-690, 5, 10]}}]")
    (folder / "next.yaml").write_text(NEXT.replace(LISTED, seen))
    code, output, held = run(folder)
    assert code == 0, output
    bodies = {body["name"]: body for body in held["request"]["bodies"]}
    assert bodies["b"]["pose"]["at_mm"] == [-690, 5, 10]
    assert "uncertainty" not in bodies["b"]


@pytest.mark.parametrize(
    ("file", "text", "message"),
    [
        ("next.yaml", TASK, "line 4: start"),
        ("next.yaml", NEXT.replace("steps:", "stepz:"), "line 5: stepz"),
        ("next.yaml", "about: none\nrequest: {}\n", "allowed: assur-task/1: a task file begins where a plan ends"),
        ("cell.yaml", CELL.replace("speed_mm_s: 150", "speed_mm_s: 160"), "belt.conveyor.speed_mm_s: got 160;"),
        ("cell.yaml", CELL.replace("-100]", "-90]"), "cell.yaml: robot.tool.tcp_mm: got [0, 0, -90]; allowed: "),
        ("plan.json", "{}", "--continue: schema"),
        ("plan.json", "[", "--continue"),
    ],
)
def test_what_cannot_continue_is_refused_with_its_place(folder: Path, file: str, text: str, message: str) -> None:
    (folder / file).write_text(text)
    code, output, held = run(folder)
    assert code == 2
    assert message in output
    assert not held


def test_a_plan_that_the_checker_refuses_is_not_continued(folder: Path) -> None:
    held = json.loads((folder / "plan.json").read_text())
    held["plan"]["trajectory"]["position"][-1][0] += 1e-3
    (folder / "plan.json").write_text(json.dumps(held))
    code, output, made = run(folder)
    assert code == 2
    assert "--continue: plan: got" in output
    assert "assur check" in output
    assert not made
    held["plan"]["certificate"] = {key: held["plan"]["certificate"][key] for key in ("digest", "rows", "covers")}
    (folder / "plan.json").write_text(json.dumps(held))
    code, output, _ = run(folder)
    assert code == 2
    assert "--continue: plan.certificate" in output


def goes_on(folder: Path, gone_after_ms: int, text: str) -> str:
    """What `assur plan` prints of a task that is refused, which continues a plan whose part `a` is taken away."""
    steps = f"[{{transfer: {{parts: [a], to: box, gone_after_ms: {gone_after_ms}}}}}, {{move: {{to: home}}}}]"
    planned(steps).save(folder / "plan.json")
    (folder / "next.yaml").write_text("schema: assur-task/1\ncell: {file: cell.yaml}\n" + text)
    code, output, _ = run(folder)
    assert code == 2
    return output


FULL = "parts: [{name: d, kind: bracket, slot: {box: 2}}, {name: b, kind: bracket}]\n"


@pytest.mark.parametrize(
    ("text", "field", "allowed"),
    [
        (
            "parts: [{name: b, kind: bracket}]\nsteps: [{pick: {part: b}}, {place: {part: b, to: {slot: {box: 1}}}}]\n",
            "line 4: steps[1].place.to.slot: ",
            "a slot that is free: a is in it; it is taken away at {at} s, after the end of the plan, ",
        ),
        (
            FULL + "steps: [{transfer: {parts: [b], to: box}}]\n",
            "line 4: steps[0].transfer.to: ",
            "slots with one that is free: all 2 are taken, by d, a (until {at} s); ",
        ),
        (
            "parts: [{name: d, kind: bracket, slot: {box: 1}}]\nsteps: [{move: {to: home}}]\n",
            "assur: part of the plan that is continued, a: slot.box: ",
            "a slot that is free: d is in it",
        ),
    ],
)
def test_a_slot_whose_part_is_not_yet_gone_says_when_it_is(folder: Path, text: str, field: str, allowed: str) -> None:
    output = goes_on(folder, 60_000, text)
    held = json.loads((folder / "plan.json").read_text())["plan"]
    (until,) = [each["until_s"] for each in held["arrivals"] if each["step"] == 1]
    assert field in output
    assert f"allowed: {allowed.format(at=f'{until + 60:.3f}')}" in output


@pytest.mark.parametrize(
    ("text", "field", "allowed"),
    [
        ("steps: [{pick: {part: a}}]\n", "line 3: steps[0].pick.part: ", "a part that is there: "),
        ("steps: [{transfer: {parts: [b, a], to: box}}]\n", "steps[0].transfer.parts[1]: ", "a part that is there: "),
        (
            "parts: [{name: a, kind: bracket}]\nsteps: [{pick: {part: a}}]\n",
            "line 3: parts[0].name: ",
            "a part with a place, where it is seen: ",
        ),
    ],
)
def test_a_part_that_was_taken_away_is_refused_as_such(folder: Path, text: str, field: str, allowed: str) -> None:
    output = goes_on(folder, 0, text if "b, a" not in text else LISTED + text)
    held = json.loads((folder / "plan.json").read_text())["plan"]
    (until,) = [each["until_s"] for each in held["arrivals"] if each["step"] == 1]
    words = f'got "a"; allowed: {allowed}the plan has placed a, and it was taken away at {until:.3f} s'
    assert f"{field}{words}" in output


@pytest.mark.parametrize("kind", ["cell file", "request"])
def test_in_python_a_part_that_was_taken_away_is_refused_as_well(kind: str) -> None:
    of = planned("[{transfer: {parts: [a], to: box, gone_after_ms: 0}}, {move: {to: home}}]")
    cell = assur.Cell(read(CELL) if kind == "cell file" else of.request or {})
    with pytest.raises(InputError, match="the plan has placed a, and it was taken away at") as refused:
        of.next_task([{"pick": {"part": "a"}}], cell=cell)
    assert (refused.value.field, refused.value.value) == ("steps[0].pick.part", "a")


def test_a_body_of_the_cell_does_not_take_the_place_of_a_part_of_the_plan(folder: Path) -> None:
    (folder / "cell.yaml").write_text(CELL.replace("name: mark", "name: b"))
    code, output, made = run(folder)
    assert code == 2
    assert 'cell.yaml: bodies[1].name: got "b"; allowed: a name that no body of another shape has in the plan' in output
    assert not made


def test_a_task_without_a_start_begins_where_a_plan_ends_or_is_refused(folder: Path) -> None:
    made = CliRunner().invoke(app, ["plan", str(folder / "next.yaml")])
    assert made.exit_code == 2
    assert "line 1: start: it is missing; allowed: the state at the start, which must be given" in " ".join(
        made.output.split()
    )
    for file in ("plan.json", "none.yaml"):
        code, output, _ = run(folder, file)
        assert code == 2
        assert "with --continue a task file (YAML) that exists" in output
    code, output, _ = run(folder, plan="none.json")
    assert code == 2
    assert "--continue" in output
