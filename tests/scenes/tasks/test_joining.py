"""A cell file and a task file make one request; what is wrong is named where it was written."""

from __future__ import annotations

import copy
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from assur.planner.errors import InputError
from assur.scenes import load
from assur.scenes.requests import cell_of, plan_scenario, request_digest
from assur.scenes.scenarios import load_scenario
from assur.scenes.tasks.joining import joined
from assur.scenes.text.yaml_text import parse_yaml

Document = dict[str, Any]

CELL = """
schema: assur-cell/1
robot: {model: mitsubishi-rh-6frh5520, tool: {tcp_mm: [0, 0, -100]}}
frames: {belt: {conveyor: {at_mm: [0, 350, 50], speed_mm_s: 250}}}
kinds:
  bracket:
    shape: {mesh: {asset: bracket, unit: mm}}
    mass_kg: 0.12
    yaw_symmetry: 2
    grasp_mm: [0, 0, 10]
    approach: {mm: 40}
bodies: [{name: table, shape: {box: {size_mm: [300, 300, 50]}}, pose: {at_mm: [350, -200, 25]}}]
positions: {home: {at_mm: [350, 0, 150]}}
slots:
  box:
    {at_mm: [300, -250, 60], step_mm: [80, 60, 20], count: [2, 2, 2], yaw_deg: 90, contact_with: [table], dwell_ms: 60}
options: {clearance_mm: {travel: 5, near: 1}}
"""
TASK = """
schema: assur-task/1
cell: {file: cell.yaml}
start: {joints: {j1_deg: 20, j2_deg: 60, j3_mm: 250, j4_deg: 0}}
parts:
  - {name: a, kind: bracket, pose: {frame: belt, at_mm: [-450, 0, 10]}}
  - {name: b, kind: bracket, pose: {frame: belt, at_mm: [-620, 0, 10]}, mass_kg: 0.2}
  - {name: c, kind: bracket, slot: {box: 2}}
steps:
  - transfer: {parts: [a, b], to: box, window_mm: [-300, 250]}
  - move: {to: home}
options: {seed: 1}
"""
BY_HAND = """
about: The same by hand.
request:
  schema: assur/1
  robot: {model: mitsubishi-rh-6frh5520, tool: {tcp_mm: [0, 0, -100]}}
  start: {joints: {j1_deg: 20, j2_deg: 60, j3_mm: 250, j4_deg: 0}}
  frames: {belt: {conveyor: {at_mm: [0, 350, 50], speed_mm_s: 250}}}
  bodies:
    - {name: table, shape: {box: {size_mm: [300, 300, 50]}}, pose: {at_mm: [350, -200, 25]}}
    - name: a
      shape: {mesh: {asset: bracket, unit: mm}}
      mass_kg: 0.12
      yaw_symmetry: 2
      pose: {frame: belt, at_mm: [-450, 0, 10]}
    - name: b
      shape: {mesh: {asset: bracket, unit: mm}}
      mass_kg: 0.2
      yaw_symmetry: 2
      pose: {frame: belt, at_mm: [-620, 0, 10]}
    - name: c
      shape: {mesh: {asset: bracket, unit: mm}}
      mass_kg: 0.12
      yaw_symmetry: 2
      pose: {at_mm: [380, -250, 60], yaw_deg: 90}
  task:
    - pick:
        {part: a, name: pick-a, window_mm: [-300, 250], grasp_mm: [0, 0, 10], approach: {mm: 40}, dwell_ms: 100,
         depart: {mm: 30}}
    - place:
        {part: a, name: place-a, to: {at_mm: [300, -250, 60], yaw_deg: 90}, approach: {mm: 40}, dwell_ms: 60,
         depart: {mm: 30}, contact_with: [table]}
    - pick:
        {part: b, name: pick-b, window_mm: [-300, 250], grasp_mm: [0, 0, 10], approach: {mm: 40}, dwell_ms: 100,
         depart: {mm: 30}}
    - place:
        {part: b, name: place-b, to: {at_mm: [300, -190, 60], yaw_deg: 90}, approach: {mm: 40}, dwell_ms: 60,
         depart: {mm: 30}, contact_with: [table]}
    - move: {to: {at_mm: [350, 0, 150]}}
  options: {seed: 1, clearance_mm: {travel: 5, near: 1}}
"""


def written(folder: Path, cell: str = CELL, task: str = TASK) -> Path:
    """The file of a task, with that of its cell."""
    (folder / "cell.yaml").write_text(cell, encoding="utf-8")
    (folder / "task.yaml").write_text(task, encoding="utf-8")
    return folder / "task.yaml"


def documents() -> tuple[Document, Document]:
    """Cell and task as documents."""
    return parse_yaml(CELL.encode())[0], parse_yaml(TASK.encode())[0]


def test_a_task_in_a_cell_means_what_its_request_by_hand_means(tmp_path: Path) -> None:
    (tmp_path / "by-hand.yaml").write_text(BY_HAND, encoding="utf-8")
    request = load(written(tmp_path))
    assert request_digest(request) == request_digest(load(tmp_path / "by-hand.yaml"))
    assert cell_of(request).scene.task[1].name == "place-a"


def test_cell_and_task_are_not_changed() -> None:
    cell, task = documents()
    before = copy.deepcopy((cell, task))
    joined(cell, task)
    assert (cell, task) == before


def test_a_value_that_the_task_sets_is_that_of_the_request() -> None:
    cell, task = documents()
    task["set"] = {"frames.belt.conveyor.speed_m_s": 0.1, "slots.box.at_mm.2": 70, "bodies.table.pose.at_mm.0": 360}
    request = joined(cell, task).request
    assert request["frames"]["belt"]["conveyor"] == {"at_mm": [0, 350, 50], "speed_m_s": 0.1}
    assert request["task"][1]["place"]["to"]["at_m"] == [0.3, -0.25, 0.07]
    assert request["bodies"][0]["pose"]["at_mm"][0] == 360


def places(request: Document) -> list[list[float]]:
    return [step["place"]["to"]["at_m"] for step in request["task"] if "place" in step]


def test_slots_are_filled_along_x_then_y_then_z_and_those_left_are_free_again() -> None:
    cell, task = documents()
    pose = {"frame": "belt", "at_mm": [-450, 0, 10]}
    task["parts"] = [{"name": f"p{k}", "kind": "bracket", "pose": pose} for k in range(8)]
    names = [part["name"] for part in task["parts"]]
    task["steps"] = [{"transfer": {"parts": names, "to": "box"}}]
    at = places(joined(cell, task).request)
    x, y, z = (0.3, 0.38), (-0.25, -0.19), (0.06, 0.08)
    assert at == [[pytest.approx(each) for each in (i, j, k)] for k in z for j in y for i in x]
    # what is picked from a slot leaves it free
    again = {"parts": ["p3"], "to": "box"}
    task["steps"] = [{"transfer": {"parts": names[:4], "to": "box"}}, {"pick": {"part": "p1"}}, {"transfer": again}]
    task["steps"][1:2] = [{"pick": {"part": "p1"}}, {"place": {"part": "p1", "to": {"slot": {"box": 8}}}}]
    at = places(joined(cell, task).request)
    assert at[-2] == pytest.approx([0.38, -0.19, 0.08])
    assert at[-1] == pytest.approx([0.38, -0.25, 0.06])


def test_a_whole_number_may_be_written_with_a_fraction_of_0() -> None:
    cell, task = documents()
    before = joined(cell, task).request
    cell["slots"]["box"]["count"], task["parts"][2]["slot"] = [2.0, 2, 2.0], {"box": 2.0}
    assert joined(cell, task).request == before


def put(path: str, value: object) -> Callable[[Document], None]:
    """A change of a document at a path."""

    def change(document: Document) -> None:
        *above, last = [int(key) if key.isdecimal() else key for key in path.split(".")]
        node: Any = document
        for key in above:
            node = node[key]
        if value is None:
            del node[last]
        else:
            node[last] = value

    return change


def built(cell: Document, task: Document) -> None:
    """Builds the scene of a task; its faults are those of the cell or the task."""
    made = joined(cell, task)
    try:
        cell_of(made.request)
    except InputError as error:
        raise made.relocated(error) from error


FAULTS: list[tuple[str, str, object, str, str]] = [
    ("cell", "schema", "assur/1", "cell.schema", "'assur-cell/1'"),
    ("cell", "robot", None, "cell.robot", "a mapping of fields, which must be given"),
    ("cell", "robot.model", "rh-6", "cell.robot.model", "one of "),
    ("cell", "kinds.bracket.shape.mesh.asset", "brackt", "cell.kinds.bracket.shape.mesh.asset", "one of "),
    ("cell", "kinds.bracket.colour", "red", "cell.kinds.bracket.colour", "one of "),
    ("cell", "kinds.bracket.shape", None, "cell.kinds.bracket.shape", ""),
    ("cell", "kinds.bracket.grasp_mm", [0, 0], "cell.kinds.bracket.grasp_mm", "at least 3 items, not 2"),
    ("cell", "slots.box.count", [0, 2, 1], "cell.slots.box.count[0]", "at least 1"),
    ("cell", "slots.box.frame", "bolt", "cell.slots.box.frame", "one of belt, world; did you mean belt?"),
    ("cell", "slots.box.contact_with", ["tabel"], "cell.slots.box.contact_with[0]", "the name of a body"),
    ("cell", "slots.home", {"at_mm": [0, 0, 0]}, "cell.slots.home", "a name that no position has"),
    ("cell", "positions.home.frame", "bolt", "cell.positions.home.frame", "one of belt, world"),
    ("cell", "frames.belt.conveyor.speed_mm_s", "fast", "cell.frames.belt.conveyor.speed_mm_s", "a number"),
    ("cell", "options.clearance_mm.near", -1, "cell.options.clearance_mm.near", "at least 0"),
    ("cell", "task", [], "cell.task", "one of "),
    ("task", "schema", "assur-task/2", "task.schema", "'assur-task/1'"),
    ("task", "robot", {}, "task.robot", "one of "),
    ("task", "start", None, "task.start", "the state at the start, which must be given"),
    ("task", "start.joints.j9_deg", 1, "task.start.joints.j9_deg", ""),
    ("task", "parts.0.kind", "braket", "task.parts[0].kind", "one of the kinds: bracket; did you mean bracket?"),
    ("task", "parts.0.kind", None, "task.parts[0]", "exactly one of kind, shape"),
    ("task", "parts.0.pose.frame", "bolt", "task.parts[0].pose.frame", "one of belt, world; did you mean belt?"),
    ("task", "parts.0.pose.pitch_deg", 5, "task.parts[0].pose.pitch_deg", "0: a step picks a, and parts stay upright"),
    ("task", "parts.0.pose.at_s", "now", "task.parts[0].pose.at_s", "a number"),
    ("task", "parts.2.pose", {"at_s": 1}, "task.parts[2].slot", "at most one of pose, slot"),
    ("cell", "slots.box.at_s", 1, "cell.slots.box.at_s", "one of "),
    ("cell", "positions.home.at_s", 1, "cell.positions.home.at_s", "one of "),
    ("task", "parts.0.slot", {"box": 1}, "task.parts[0].slot", "at most one of pose, slot"),
    ("task", "parts.1.name", "a", "task.parts[1].name", "a name that no other body has"),
    ("task", "parts.0.name", "table", "task.parts[0].name", "a name that no other body has"),
    ("task", "parts.2.slot", {"bx": 1}, "task.parts[2].slot", "the name of slots: box; did you mean box?"),
    ("task", "parts.2.slot", {"box": 9}, "task.parts[2].slot.box", "the number of a slot, 1 to 8"),
    ("task", "parts.2.slot", {"box": 0}, "task.parts[2].slot.box", "at least 1"),
    ("task", "steps", [], "task.steps", "at least 1 item, not 0"),
    ("task", "steps.0.transfer.parts", ["a", "d"], "task.steps[0].transfer.parts[1]", "the name of a body"),
    ("task", "steps.0.transfer.to", "boxes", "task.steps[0].transfer.to", "one of the positions and slots: box, home"),
    ("task", "steps.0.transfer.windwo_mm", [0, 1], "task.steps[0].transfer.windwo_mm", "one of "),
    (
        "task",
        "steps.0.transfer.dwell_ms",
        50,
        "task.steps[0].transfer.dwell_ms",
        "one of gone_after_s/gone_after_ms, parts, to, window_m/window_mm, window_s/window_ms; dwell_ms is stated by "
        "the cell: kinds.KIND.dwell_ms or slots.SLOTS.dwell_ms",
    ),
    ("task", "steps.0.transfer.window_mm", [250, -300], "task.steps[0].transfer.window_mm", "two ends"),
    ("task", "steps.1.move.to", "hom", "task.steps[1].move.to", "one of the positions: home; did you mean home?"),
    ("task", "steps.1.move.to", "box", "task.steps[1].move.to", "one of the positions: home"),
    ("task", "steps.1.move.to", 3, "task.steps[1].move.to", "a mapping of fields"),
    ("task", "steps.1.move", {"to": {"slot": {"box": 9}}}, "task.steps[1].move.to.slot.box", "the number of a slot"),
    ("task", "steps.1.move", {"to": {"slot": 3}}, "task.steps[1].move.to.slot", "the name of slots and a number"),
    ("task", "steps.1.move", {"to": {"slot": {3: 1}}}, "task.steps[1].move.to.slot", "the name of slots and a number"),
    (
        "task",
        "steps.1.move",
        {"to": {"slot": {"box": 1}, "yaw_deg": 90}},
        "task.steps[1].move.to.yaw_deg",
        "none: a slot",
    ),
    ("task", "steps.0.move", {"to": "home"}, "task.steps[0].move", "none: a step is one thing"),
    ("cell", "frames.belt.conveyor.speed_mm_s", 2**60, "cell.frames.belt.conveyor.speed_mm_s", "a whole number"),
    ("task", "steps.1", {"mvoe": {}}, "task.steps[1]", "exactly one of move, follow, trace, pick, place"),
    (
        "task",
        "steps.1",
        {"place": {"part": "c", "to": "box"}},
        "task.steps[1].place.part",
        "the part that is held",
    ),
    ("task", "options.clearance_m", {"travel": 1, "near": 1}, "task.options.clearance_m", "none: the cell states it"),
    ("task", "options.sed", 1, "task.options.sed", "one of "),
    ("task", "steps.0.transfer.parts", ["a", "a"], "task.steps[0].transfer.parts[1]", "a part that is not in the list"),
    ("task", "set", {"frames.bolt.conveyor.speed_mm_s": 1}, "task.set.frames.bolt.conveyor.speed_mm_s", "one of belt"),
    ("task", "set", {"slots.bx.yaw_deg": 1}, "task.set.slots.bx.yaw_deg", "one of box; did you mean box?"),
    ("task", "set", {"robot.limits.acceleration": 7}, "task.set.robot.limits.acceleration", "at most 1"),
    ("task", "set", {"robt.model": "x"}, "task.set.robt.model", "a path that begins with one of "),
    (
        "task",
        "set",
        {"frames.belt": {"linear": {}}},
        "task.set.frames.belt.linear.velocity_m_s",
        "velocity_m_s or velocity_mm_s",
    ),
    ("task", "set", {"robot.limits.j9_deg": [0, 1]}, "task.set.robot.limits.j9_deg", ""),
    ("task", "set", {"kinds.bracket.shape.mesh.asset": "brackt"}, "task.set.kinds.bracket.shape.mesh.asset", "one of "),
    ("task", "set", {"slots.box.at_mm.2": "low"}, "task.set.slots.box.at_mm.2", "a number"),
    ("task", "set", [1], "task.set", "a mapping of fields"),
]


@pytest.mark.parametrize(("which", "path", "value", "field", "allowed"), FAULTS)
def test_what_is_wrong_is_named_where_it_was_written(
    which: str, path: str, value: object, field: str, allowed: str
) -> None:
    cell, task = documents()
    put(path, value)(cell if which == "cell" else task)
    with pytest.raises(InputError) as caught:
        built(cell, task)
    assert caught.value.field == field, str(caught.value)
    assert caught.value.allowed.startswith(allowed), str(caught.value)


def test_places_that_are_not_stated_are_the_origin() -> None:
    cell, task = documents()
    cell["slots"]["box"].pop("at_mm")
    cell["positions"]["home"] = {}
    task["parts"][0]["pose"] = {"frame": "belt"}
    request = joined(cell, task).request
    assert request["bodies"][-1]["pose"]["at_m"] == pytest.approx([0.08, 0.0, 0.0])
    stated = copy.deepcopy(request)
    stated["bodies"][-3]["pose"]["at_mm"] = stated["task"][-1]["move"]["to"]["at_mm"] = [0, 0, 0]
    assert request_digest(request) == request_digest(stated)


def test_a_part_has_the_time_of_its_pose() -> None:
    cell, task = documents()
    task["parts"][0]["pose"]["at_s"] = 0.4
    assert cell_of(joined(cell, task).request).scene.index["a"].pose.x == pytest.approx(-0.55)


def test_a_grid_that_is_full_takes_no_part() -> None:
    cell, task = documents()
    cell["slots"]["box"]["count"] = [1, 1, 1]
    task["parts"][2]["slot"] = {"box": 1}
    with pytest.raises(InputError, match=r"task\.steps\[0\]\.transfer\.to: got 'box'.*all 1 are taken"):
        joined(cell, task)


@pytest.mark.parametrize(
    ("cell", "task", "message"),
    [
        (
            CELL.replace("speed_mm_s: 250", "speed_mm_s: fast"),
            TASK,
            r"line 4: cell\.yaml: frames\.belt\.conveyor\.speed",
        ),
        (CELL.replace("[300, -250, 60]", "[300, -250]"), TASK, r"line 16: cell\.yaml: slots\.box\.at_mm: .*3 items"),
        (CELL, TASK.replace("frame: belt", "frame: bolt"), r"line 6: parts\[0\]\.pose\.frame: got 'bolt'"),
        (CELL, TASK.replace("to: home", "to: away"), r"line 11: steps\[1\]\.move\.to: got 'away'"),
        (CELL, TASK.replace("cell.yaml", "cel.yaml"), r"line 3: cell\.file: got 'cel\.yaml'.*does not exist"),
        (
            CELL,
            TASK.replace("cell.yaml", "/cells/cell.yaml"),
            r"line 3: cell\.file: got '/cells/cell\.yaml'.*as in cell\.yaml, and an absolute one is refused",
        ),
        (CELL, TASK.replace("cell.yaml", "../cell.yaml"), r"line 3: cell\.file: .*leads out of that folder is refused"),
        (CELL, TASK.replace("{file: cell.yaml}", "cell.yaml"), r"line 3: cell: got 'cell\.yaml'.*\{file: cell\.yaml\}"),
        ("# nothing\n", TASK, r"cell\.yaml: got 'an empty file'"),
        (
            CELL.replace("assur-cell/1", "assur/1"),
            TASK,
            r"line 2: cell\.yaml: schema: got 'assur/1'; allowed: 'assur-cell/1'",
        ),
        (CELL, CELL, r"line 2: schema: got 'assur-cell/1'; allowed: .*a task file"),
        ("robot: [", TASK, r"cell\.yaml: .*"),
        (
            CELL,
            TASK + "set:\n  slots.box.yaw_deg: 0\n  frames.belt.conveyor.speed_mm_s: fast\n",
            r"line 15: set\.frames\.belt\.conveyor\.speed_mm_s: got 'fast'; allowed: a number",
        ),
    ],
)
def test_a_fault_has_its_file_and_its_line(tmp_path: Path, cell: str, task: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        plan_scenario(load_scenario(written(tmp_path, cell, task)))


@pytest.mark.parametrize("text", [CELL, TASK])
def test_a_cell_or_a_task_alone_is_no_request(text: str) -> None:
    with pytest.raises(InputError, match=r"schema: got 'assur-(cell|task)/1'; allowed: assur/1: .*assur\.load"):
        cell_of(parse_yaml(text.encode())[0])


def test_files_that_a_cell_names_are_below_its_own_folder(tmp_path: Path) -> None:
    inside = tmp_path / "cells"
    inside.mkdir()
    (inside / "arm.yaml").write_bytes((Path(load.__code__.co_filename).parent / "robots/elbow-arm.yaml").read_bytes())
    cell = CELL.replace("model: mitsubishi-rh-6frh5520", "file: arm.yaml")
    (inside / "cell.yaml").write_text(cell, encoding="utf-8")
    task = tmp_path / "task.yaml"
    task.write_text(TASK.replace("cell.yaml", "cells/cell.yaml"), encoding="utf-8")
    assert "elbow_arm" in load_scenario(task).request["robot"]


def test_a_part_that_is_transferred_again_has_steps_of_other_names() -> None:
    cell, task = documents()
    task["steps"] = [{"transfer": {"parts": ["a"], "to": "box"}}] * 2
    steps = joined(cell, task).request["task"]
    names = [next(iter(step.values()))["name"] for step in steps]
    assert names == ["pick-a", "place-a", "pick-a-2", "place-a-2"]
    assert cell_of(joined(cell, task).request).scene.task[3].name == "place-a-2"


def test_of_a_document_of_another_kind_nothing_else_is_said() -> None:
    with pytest.raises(InputError) as refusal:
        joined(documents()[1], documents()[1])
    assert str(refusal.value) == "cell.schema: got 'assur-task/1'; allowed: 'assur-cell/1'"
