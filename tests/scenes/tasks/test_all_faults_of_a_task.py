"""All faults of a cell and a task are reported at once, each where it was written and once."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import assur
from assur.scenes import load
from assur.scenes.faults import NOTHING, DocumentError
from assur.scenes.scenarios import load_scenario
from assur.scenes.tasks.joining import joined
from assur.scenes.tasks.kept_cell import KeptCellFile
from tests.changed import GONE, changed
from tests.scenes.tasks.test_joining import documents, written

Document = dict[str, Any]


def faults_of(cell: Document, task: Document) -> dict[str, Any]:
    """Field → value of each fault that is reported with these changes of the cell and the task."""
    of_cell, of_task = documents()
    with pytest.raises(DocumentError) as caught:
        KeptCellFile(of_cell).plan(changed(of_task, task)) if not cell else joined(
            changed(of_cell, cell), changed(of_task, task)
        )
    found = [each["field"] for each in caught.value.errors]
    assert len(found) == len(set(found))
    return {each["field"]: each.get("value", NOTHING) for each in caught.value.errors}


POSE = {"frame": "bolt", "at_mm": [0, 0, 0]}
TOGETHER: dict[str, tuple[Document, Document, Document]] = {
    "names and forms of a task": (
        {},
        {"parts[0].kind": "brakket", "start.joints.j1_deg": "20", "options.seed": 1.5, "steps[1].move.to": "hme"},
        {"parts[0].kind": "brakket", "start.joints.j1_deg": "20", "options.seed": 1.5, "steps[1].move.to": "hme"},
    ),
    "frames beside them": (
        {},
        {"parts[0].kind": "brakket", "parts[0].pose": POSE, "parts[1].pose": POSE, "parts[1].mass_kg": -1},
        {
            "parts[0].kind": "brakket",
            "parts[0].pose.frame": "bolt",
            "parts[1].pose.frame": "bolt",
            "parts[1].mass_kg": -1,
        },
    ),
    "within one step": (
        {},
        {"steps[1]": {"move": {"to": POSE, "via": 3}}, "steps[0].transfer.to": "bx"},
        {"steps[1].move.via": 3, "steps[1].move.to.frame": "bolt", "steps[0].transfer.to": "bx"},
    ),
    "a transfer and what follows it": (
        {},
        {"steps[0].transfer": {"parts": ["a", "b"]}, "steps[1].move.to": {"frame": "bolt"}},
        {"steps[0].transfer.to": NOTHING, "steps[1].move.to.frame": "bolt"},
    ),
    "cell and task": (
        {"frames.belt.conveyor.speed_mm_s": "fast", "bodies[0].pose": POSE, "slots.box.count": [2, 2]},
        {"parts[2].slot": {"bx": 2}, "steps[1].move.to": "hme", "start": GONE},
        {
            "cell.frames.belt.conveyor.speed_mm_s": "fast",
            "cell.bodies[0].pose.frame": "bolt",
            "cell.slots.box.count": [2, 2],
            "task.parts[2].slot": {"bx": 2},
            "task.steps[1].move.to": "hme",
            "task.start": NOTHING,
        },
    ),
    "what only follows from a fault is none": (
        {"kinds.bracket.yaw_symmetry": -1, "positions.home.at_mm": [0, 0], "slots.box.count": [0, 1, 1]},
        {},
        {
            "cell.kinds.bracket.yaw_symmetry": -1,
            "cell.positions.home.at_mm": [0, 0],
            "cell.slots.box.count[0]": 0,
        },
    ),
    "nor is a name of a part whose name cannot be read": (
        {"robot.tool.tcp_mm": [0, 0]},
        {"parts[0].name": 3},
        {"cell.robot.tool.tcp_mm": [0, 0], "task.parts[0].name": 3},
    ),
}


@pytest.mark.parametrize("name", TOGETHER)
def test_faults_are_reported_together_where_they_were_written(name: str) -> None:
    cell, task, expected = TOGETHER[name]
    assert faults_of(cell, task) == expected


def test_a_wrong_value_of_slots_is_reported_once_for_all_parts(tmp_path: Path) -> None:
    path = written(tmp_path)
    text = (tmp_path / "cell.yaml").read_text(encoding="utf-8")
    (tmp_path / "cell.yaml").write_text(text.replace("contact_with: [table]", "contact_with: [tbl]"), encoding="utf-8")
    scenario = load_scenario(path)
    with pytest.raises(DocumentError) as caught, scenario.located():
        assur.plan(scenario.request)
    assert [each["field"] for each in caught.value.errors] == ["cell.yaml: slots.box.contact_with[0]"]


def test_of_a_cell_alone_all_faults_are_reported() -> None:
    cell, _ = documents()
    wrong = {"bodies[0].pose.frame": "bolt", "slots.box.dwell_ms": -1, "robot.model": "nobody"}
    with pytest.raises(assur.InputError) as caught:
        assur.Cell(changed(cell, wrong))
    assert {each["field"]: each["value"] for each in caught.value.errors} == wrong


def test_in_files_each_fault_has_its_line(tmp_path: Path) -> None:
    path = written(tmp_path)
    for file, old, new in (("cell.yaml", "speed_mm_s: 250", "speed_mm_s: fast"), ("task.yaml", "to: home", "to: hme")):
        text = (tmp_path / file).read_text(encoding="utf-8")
        (tmp_path / file).write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(DocumentError) as caught:
        load(path)
    assert {(each["field"], each["line"]) for each in caught.value.errors} == {
        ("cell.yaml: frames.belt.conveyor.speed_mm_s", 4),
        ("steps[1].move.to", 11),
    }
