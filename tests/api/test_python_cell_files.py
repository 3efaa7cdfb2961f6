"""`assur.Cell` of a cell file: it is read and built once, and planned with many tasks."""

from __future__ import annotations

import copy
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest

import assur
from assur.api.python.exchange import planning_task
from assur.scenes.reading import bodies
from assur.scenes.requests import cell_of, validate
from assur.scenes.tasks.kept_cell import KeptCellFile, TaskOfCell
from assur.scenes.text.yaml_text import parse_yaml
from tests.scenes.tasks.test_joining import CELL

Document = dict[str, Any]
TIMES = ("elapsed_s", "first_s")
START: Document = {"joints": {"j1_deg": 20, "j2_deg": 60, "j3_mm": 250, "j4_deg": 0}}
HOME: list[Document] = [{"move": {"to": "home"}}]
FIRST: Document = {"stop": "first", "budget_s": 20, "max_candidates": 200}
HELD = {"holding": {"part": "held", "grasp_mm": [0, 0, 20]}}


def part(name: str, x: float) -> Document:
    return {"name": name, "kind": "bracket", "pose": {"at_mm": [x, 300, 30], "yaw_deg": 10}}


TASKS: dict[str, Document] = {
    "no parts": {"start": START, "steps": HOME, "options": FIRST},
    "a part": {"start": START, "parts": [part("a", 100)], "steps": HOME, "options": FIRST},
    "another part and start": {
        "start": {"joints": {**START["joints"], "j1_deg": 25}},
        "parts": [part("b", 120), part("c", -200)],
        "steps": HOME,
        "options": {**FIRST, "report": "full"},
    },
    "a part in a slot": {
        "start": START,
        "parts": [{"name": "a", "kind": "bracket", "slot": {"box": 1}}],
        "steps": [{"pick": {"part": "a"}}, {"move": {"to": "home"}}],
        "options": FIRST,
    },
    "a part in the gripper": {
        "start": {**START, **HELD},
        "parts": [{"name": "held", "shape": {"box": {"size_mm": [40, 40, 20]}}}],
        "steps": HOME,
        "options": FIRST,
    },
    "a part with another mesh": {
        "start": START,
        "parts": [
            {"name": "m", "shape": {"mesh": {"asset": "bracket", "unit": "mm"}}, "pose": {"at_mm": [0, 300, 30]}}
        ],
        "steps": HOME,
        "options": FIRST,
    },
    "a part that was seen at a time": {
        "start": {**START, "at_s": 0.5},
        "parts": [{"name": "a", "kind": "bracket", "pose": {"frame": "belt", "at_mm": [-300, 0, 10], "at_s": -1.5}}],
        "steps": [{"pick": {"part": "a"}}],
        "options": FIRST,
    },
    "the same, later": {
        "start": {**START, "at_s": 0.75},
        "parts": [{"name": "a", "kind": "bracket", "pose": {"frame": "belt", "at_mm": [-300, 0, 10], "at_s": -1.5}}],
        "steps": [{"pick": {"part": "a"}}],
        "options": FIRST,
    },
    "values of the cell": {
        "start": START,
        "parts": [part("a", 100)],
        "steps": HOME,
        "options": FIRST,
        "set": {"bodies.table.pose.at_mm.0": 360, "frames.belt.conveyor.speed_m_s": 0.1},
    },
}


@pytest.fixture
def document() -> Document:
    """The document of a cell."""
    found: Document = parse_yaml(CELL.encode())[0]
    found["frames"]["belt"]["uncertainty"] = {"speed_mm_s": 1}
    found["bodies"].append({"name": "post", "shape": {"sphere": {"radius_mm": 30}}, "pose": {"at_mm": [0, -400, 60]}})
    return found


def timeless(answer: Any) -> Document:
    return {key: value for key, value in answer.items() if key not in TIMES}


def test_every_task_has_the_answer_of_its_request_in_any_order(document: Document) -> None:
    cell, before = assur.Cell(document), copy.deepcopy(document)
    new = {name: assur.plan(cell.request(**task)) for name, task in TASKS.items()}
    for name in [*TASKS, *reversed(TASKS)]:
        kept = cell.plan(**TASKS[name])
        assert timeless(kept) == timeless(new[name]), name
        assert kept.request == cell.request(**TASKS[name])
        assert kept.planned, (name, kept.sentence)
        assert assur.check(kept.request, kept)["ok"]
    assert document == before


@pytest.mark.parametrize("name", [name for name in TASKS if name != "values of the cell"])
def test_what_is_read_and_built_of_a_task_is_what_its_request_would_be(document: Document, name: str) -> None:
    kept = KeptCellFile(document)
    for _ in range(2):
        made = kept.joined({"schema": "assur-task/1", **TASKS[name]})
        task = TaskOfCell(kept, made)
        request, whole = task.read(), validate(made.request)
        assert request is not None, "it was read as a whole"
        assert request == whole
        assert (request.digest, request.surroundings, request.cell) == (whole.digest, whole.surroundings, whole.cell)
        around = task.around(request)
        assert around is not None, "it was built as a whole"
        scene, other = cell_of(made.request, task=task).scene, cell_of(made.request).scene
        assert scene.bodies is next(iter(around.values())).bodies
        for table in ("table", "first", "count", "hull"):
            found, expected = getattr(scene.pieces, table), getattr(other.pieces, table)
            assert found.tobytes() == expected.tobytes()
            assert not found.flags.writeable
        assert [body.name for body in scene.bodies] == [body.name for body in other.bodies]


def test_only_the_parts_of_a_task_are_built(document: Document, monkeypatch: pytest.MonkeyPatch) -> None:
    made, solid = list[str](), bodies.solid

    def counted(name: str, shape: Any) -> Any:
        made.append(name)
        return solid(name, shape)

    monkeypatch.setattr(bodies, "solid", counted)
    cell = assur.Cell({**document, "about": "A cell that no other test has."})
    first = cell.plan(**TASKS["a part"])
    made.clear()
    cell.plan(**TASKS["another part and start"])
    assert made == ["b", "c"]
    cell.plan(**{**TASKS["another part and start"], "start": START})
    assert made == ["b", "c"], "the same parts are kept"
    assert timeless(cell.plan(**TASKS["a part"])) == timeless(first)
    assert made == ["b", "c", "a"]


FAULTS: list[tuple[Document, str, str]] = [
    ({"start": None}, "start", "must be given"),
    ({"steps": None}, "steps", "must be given"),
    ({"steps": []}, "steps", "at least 1 item"),
    ({"start": {"joints": {**START["joints"], "j1_deg": 200}}}, "start.joints.j1_deg", "-170 to 170"),
    (
        {"start": {**START, "holding": {"part": "no", "grasp_mm": [0, 0, 0]}}},
        "start.holding.part",
        "the name of a body",
    ),
    ({"parts": [part("table", 0)]}, "parts[0].name", "a name that no other body has"),
    ({"parts": [part("a", 0), part("a", 50)]}, "parts[1].name", "a name that no other body has"),
    ({"parts": [{**part("a", 0), "kind": "x"}]}, "parts[0].kind", "one of the kinds: bracket"),
    ({"parts": [{**part("a", 0), "mass_kg": -1}]}, "parts[0].mass_kg", "at least 0"),
    (
        {"parts": [{**part("a", 0), "pose": {"frame": "bolt", "at_mm": [0, 0, 0]}}]},
        "parts[0].pose.frame",
        "one of belt",
    ),
    (
        {"parts": [{**part("a", 0), "pose": {"at_mm": [float("nan"), 0, 0]}}]},
        "parts[0].pose.at_mm[0]",
        "a finite number",
    ),
    ({"parts": [{"name": "a", "kind": "bracket"}]}, "parts[0].pose", "a pose: only the part"),
    (
        {"parts": [{"name": f"p{k}", "kind": "bracket", "slot": {"box": 1}} for k in range(2)]},
        "parts[1].slot.box",
        "free",
    ),
    ({"steps": [{"move": {"to": "hom"}}]}, "steps[0].move.to", "one of the positions: home"),
    ({"options": {"seed": 1.5}}, "options.seed", "a whole number"),
    ({"options": {"clearance_mm": {"travel": 1, "near": 1}}}, "options.clearance_mm", "none: the cell states it"),
    ({"set": {"frames.bolt.linear": 1}}, "set.frames.bolt.linear", "one of belt"),
    ({"set": {"robot.limits.acceleration": 7}}, "set.robot.limits.acceleration", "at most 1"),
    ({"set": {"bodies.table.shape.box.size_mm": [1, 2]}}, "set.bodies.table.shape.box.size_mm", "at least 3 items"),
    ({"task": HOME}, "task", "no task: this is a cell file"),
]


@pytest.mark.parametrize(("change", "field", "allowed"), FAULTS)
def test_a_fault_of_a_task_names_its_field(document: Document, change: Document, field: str, allowed: str) -> None:
    cell = assur.Cell(document)
    for _ in range(2):
        with pytest.raises(assur.InputError) as caught:
            cell.plan(**{"start": START, "steps": HOME, "options": FIRST, **change})
        assert caught.value.field == field, str(caught.value)
        assert allowed in caught.value.allowed, str(caught.value)
        cell.plan(**TASKS["no parts"])


@pytest.mark.parametrize(
    ("change", "field", "first"),
    [
        ({"robot": {"model": "rh-6", "tool": {"tcp_mm": [0, 0, 0]}}}, "cell.robot.model", False),
        ({"colour": "red"}, "colour", True),
        ({"slots": {"home": {"at_mm": [0, 0, 0]}}}, "cell.slots.home", False),
        ({"bodies": [{"name": "t", "shape": {"sphere": {"radius_mm": 1}}}]}, "cell.bodies[0].pose", False),
        (
            {"frames": {"belt": {"conveyor": {"at_mm": [0, 0, 0], "speed_mm_s": "x"}}}},
            "frames.belt.conveyor.speed_mm_s",
            True,
        ),
    ],
)
def test_a_fault_of_the_cell_names_its_field(document: Document, change: Document, field: str, first: bool) -> None:
    with pytest.raises(assur.InputError) as caught:  # noqa: PT012 - the first or the second call
        cell = assur.Cell({**document, **change})
        assert not first
        cell.plan(start=START, steps=HOME)
    assert caught.value.field == field, str(caught.value)


def test_a_request_takes_no_parts_and_no_steps(document: Document) -> None:
    cell = assur.Cell(assur.Cell(document).request(**TASKS["no parts"]))
    given: Document
    for given in ({"parts": []}, {"steps": []}, {"options": {}}):
        with pytest.raises(assur.InputError, match=f"{next(iter(given))}: .*this is a request"):
            cell.plan(**given)


def test_a_cell_is_loaded_from_its_file_with_what_it_names(tmp_path: Path) -> None:
    (tmp_path / "bracket.stl").write_bytes((Path(bodies.__file__).parents[1] / "assets/bracket.stl").read_bytes())
    text = CELL.replace("mesh: {asset: bracket, unit: mm}", "mesh: {file: bracket.stl, unit: mm}")
    (tmp_path / "cell.yaml").write_text(text, encoding="utf-8")
    document = assur.load(tmp_path / "cell.yaml")
    assert document["kinds"]["bracket"]["shape"]["mesh"].keys() == {"data", "format", "unit"}
    assert assur.Cell(document).plan(**TASKS["a part"]).planned
    (tmp_path / "cell.yaml").write_text(text.replace("speed_mm_s: 250", "speed_mm_s: x"), encoding="utf-8")
    with pytest.raises(assur.InputError, match=r"line 4: frames\.belt\.conveyor\.speed_mm_s"):
        assur.load(tmp_path / "cell.yaml")


def test_threads_share_a_cell(document: Document) -> None:
    cell = assur.Cell(document)
    alone = {name: timeless(assur.plan(cell.request(**task))) for name, task in TASKS.items()}
    with ThreadPoolExecutor(4) as pool:
        names = list(TASKS) * 3
        for name, answer in zip(names, pool.map(lambda name: cell.plan(**TASKS[name]), names), strict=True):
            assert timeless(answer) == alone[name], name


@pytest.mark.parametrize("cell", [3, "cell.yaml", []])
def test_what_is_no_cell_is_refused(document: Document, cell: Any) -> None:
    answer = assur.plan(assur.load("demo"))
    with pytest.raises(assur.InputError, match=r"^cell: got .*an assur\.Cell, or the document of a cell"):
        answer.next_task([], cell=cell)
    with pytest.raises(assur.InputError, match=r"^cell: got .*an assur\.Cell, or the document of a cell"):
        planning_task("0" * 64, {"steps": []}, "full", None, None, cell)
    assert planning_task("0" * 64, {"steps": []}, "full", None, None, assur.Cell(document)).method == "POST"
