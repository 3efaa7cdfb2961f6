"""`assur.request`: the models that read requests, as typed objects. mypy reads this file, too: a wrong type that it
would no longer see is an error of its own there."""

from __future__ import annotations

import ast
from typing import Any, get_args

import pytest
from pydantic import BaseModel, ValidationError

import assur
from assur import request as builders
from assur.request import (
    Body,
    Box,
    Clearance,
    ClearanceException,
    Conveyor,
    Execution,
    Follow,
    Frame,
    Joints,
    Lag,
    Limits,
    Move,
    Options,
    PlaceInCell,
    Request,
    Robot,
    Shape,
    Start,
    Step,
    Target,
    Tool,
    ToolPose,
    deg,
    mm,
)
from assur.scenes.requests import request_digest, scene_of, shipped_scenarios
from assur.scenes.schema.model import Document
from assur.scenes.schema.request import RequestDocument
from tests.architecture.source_tree import sources

PLAIN: dict[str, Any] = {
    "schema": "assur/1",
    "robot": {
        "model": "mitsubishi-rh-6frh5520",
        "tool": {"tcp_mm": [0, 0, -60]},
        "limits": {"velocity": 0.8, "j4_deg": [-270, 270]},
    },
    "start": {"joints": {"j1_deg": -40, "j2_deg": 90, "j3_mm": 300, "j4_deg": 0}},
    "frames": {"belt": {"conveyor": {"at_mm": [-500, 350, 50], "speed_mm_s": 250}}},
    "bodies": [{"name": "bed", "shape": {"box": {"size_mm": [1400, 200, 50]}}, "pose": {"at_mm": [0, 350, 25]}}],
    "task": [
        {
            "follow": {
                "name": "mark",
                "to": {"frame": "belt", "at_mm": [0, 0, 80], "yaw_free": True},
                "duration_ms": 200,
                "window_mm": [300, 800],
            }
        },
        {"move": {"to": {"at_mm": [350, 0, 150]}}},
    ],
    "options": {
        "stop": "first",
        "budget_s": 10,
        "clearance_mm": {"travel": 5, "near": 2},
        "clearance_exceptions": [{"between": ["bed"], "and": ["link-2"], "clearance_mm": {"travel": 1, "near": 1}}],
    },
    "execution": {"lag": {"j1_deg": 0.02, "j3_mm": 0.05}},
}
BUILT = Request(
    robot=Robot(
        model="mitsubishi-rh-6frh5520",
        tool=Tool(tcp_m=mm(0, 0, -60)),
        limits=Limits(velocity=0.8, j4_rad=deg(-270, 270)),
    ),
    start=Start(joints=Joints(j1_rad=deg(-40), j2_rad=deg(90), j3_m=mm(300), j4_rad=0)),
    frames={"belt": Frame(conveyor=Conveyor(at_m=mm(-500, 350, 50), speed_m_s=mm(250)))},
    bodies=[Body(name="bed", shape=Shape(box=Box(size_m=mm(1400, 200, 50))), pose=PlaceInCell(at_m=mm(0, 350, 25)))],
    task=[
        Step(
            follow=Follow(
                name="mark",
                to=Target(frame="belt", at_m=mm(0, 0, 80), yaw_free=True),
                duration_s=0.2,
                window_m=mm(300, 800),
            )
        ),
        Step(move=Move(to=Target(at_m=mm(350, 0, 150)))),
    ],
    options=Options(
        stop="first",
        budget_s=10,
        clearance_m=Clearance(travel=mm(5), near=mm(2)),
        clearance_exceptions=[
            ClearanceException(between=["bed"], clearance_m=Clearance(travel=mm(1), near=mm(1)), **{"and": ["link-2"]})
        ],
    ),
    execution=Execution(lag=Lag(j1_rad=deg(0.02), j3_m=mm(0.05))),
)


def test_a_built_request_means_the_same_as_a_plain_one() -> None:
    assert request_digest(BUILT.document()) == request_digest(PLAIN)
    assert BUILT.document()["schema"] == "assur/1"
    assert scene_of(BUILT.document()).digest == scene_of(PLAIN).digest


def test_what_is_left_out_is_left_out_of_the_document() -> None:
    document = BUILT.document()
    assert set(document) == set(PLAIN)
    assert set(document["robot"]) == {"model", "tool", "limits"}
    assert document["robot"]["limits"] == {"velocity": 0.8, "j4_rad": deg(-270, 270)}


@pytest.mark.parametrize("name", sorted(shipped_scenarios()))
def test_every_shipped_request_is_the_same_when_it_was_built(name: str) -> None:
    document = assur.load(name)
    built = Request.of(document)
    assert request_digest(built.document()) == request_digest(document) == built.digest
    again = Request(**{key: getattr(built, field) for field, key in KEYS.items() if field in built.model_fields_set})
    assert again.digest == built.digest


KEYS = {field: info.alias or field for field, info in Request.model_fields.items()}


def test_a_free_angle_is_one_that_is_left_out() -> None:
    assert Target(at_m=mm(350, 0, 150), pitch_rad="free", roll_rad=0.5).document() == {
        "at_m": mm(350, 0, 150),
        "roll_rad": 0.5,
    }


def test_a_built_request_is_planned_and_checked() -> None:
    request = BUILT.model_copy(update={"task": [BUILT.task[0]]})
    answer = assur.plan(request)
    assert answer.planned, answer.sentence
    assert assur.check(request, answer)["ok"]
    pose = ToolPose(frame="belt", at_m=mm(450, 0, 80), yaw_rad=deg(90))
    plain = {"frame": "belt", "at_mm": [450, 0, 80], "yaw_deg": 90}
    assert assur.ik(request, pose=pose, at_s=0.5) == assur.ik(request.document(), pose=plain, at_s=0.5)


def models_of(annotation: Any) -> set[type[BaseModel]]:
    """Every model that is named anywhere in an annotation."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return {annotation}
    return {model for part in get_args(annotation) for model in models_of(part)}


def parts_of(model: type[BaseModel]) -> set[type[BaseModel]]:
    """The models that stand somewhere in the document of `model`, itself among them."""
    found, ahead = set(), {model}
    while ahead:
        here = ahead.pop()
        found.add(here)
        ahead |= {part for field in here.model_fields.values() for part in models_of(field.annotation)} - found
    return found


def test_there_is_a_builder_for_every_part_of_a_request() -> None:
    there = {getattr(builders, name) for name in builders.__all__}
    parts = parts_of(RequestDocument)
    assert len(parts) > 50
    stated = {part for part in parts if part.__name__.startswith("Stated[")}
    assert {part.__name__ for part in parts - stated - there} == {"RequestDocument"}
    assert {each.__name__ for each in there if isinstance(each, type) and each not in parts} == {"Request", "Stated"}


def test_what_type_checkers_are_told_of_keywords_is_what_the_models_have() -> None:
    told = {}
    for source in sources("scenes"):
        for node in ast.walk(source.tree):
            if isinstance(node, ast.ClassDef):
                for line in ast.walk(node):
                    if (
                        isinstance(line, ast.FunctionDef)
                        and line.name == "__init__"
                        and line.args.kwarg
                        and ("ByName" in map(ast.unparse, node.bases))
                    ):
                        told[node.name] = [argument.arg for argument in line.args.kwonlyargs]
    models = {part.__name__: part for part in parts_of(RequestDocument) if part.model_config.get("extra") == "allow"}
    assert told == {name: list(model.model_fields) for name, model in models.items()}


def test_units_are_those_of_the_documents() -> None:
    assert mm(250) == 0.25
    assert mm(-500, 350, 50) == [-0.5, 0.35, 0.05]
    assert deg(180) == pytest.approx(3.141592653589793, abs=0)
    assert deg(-270, 270) == [-deg(270), deg(270)]


def test_a_value_that_is_not_allowed_is_refused_where_it_is_written() -> None:
    with pytest.raises(ValidationError, match="at_m"):
        Conveyor(at_m=mm(0, 350), speed_m_s=0.25)
    with pytest.raises(ValidationError, match="speed_m_s"):
        Conveyor(at_m=mm(0, 350, 50), speed_m_s="0.25")  # type: ignore[arg-type]
    with pytest.raises(ValidationError, match="speed"):
        Conveyor(at_m=mm(0, 350, 50), speed=0.25)  # type: ignore[call-arg]
    with pytest.raises(ValidationError, match="j1_rad"):
        Joints(j1_rad="17")  # type: ignore[arg-type]
    with pytest.raises(ValidationError, match="velocity"):
        Limits(velocity=2.0)
    with pytest.raises(ValidationError, match="stop"):
        Options(stop="now")  # type: ignore[arg-type]
    with pytest.raises(ValidationError, match="allowed: exactly one of move, follow, trace, pick, place"):
        Step()
    with pytest.raises(ValidationError, match="allowed: at most one of frame, body"):
        Target(frame="belt", body="part", at_m=mm(0, 0, 0))
    with pytest.raises(ValidationError, match="frozen"):
        BUILT.options.seed = 3


def test_a_plain_document_that_is_not_right_is_refused_at_its_field() -> None:
    with pytest.raises(assur.InputError, match=r"robot\.tool\.tcp_mm"):
        Request.of({**PLAIN, "robot": {**PLAIN["robot"], "tool": {"tcp_mm": [0, 0]}}})


@pytest.mark.parametrize("document", [None, [], "demo", {}, {"status": "planned"}])
def test_what_is_no_request_is_refused(document: object) -> None:
    with pytest.raises(assur.InputError):
        Request.of(document)


def test_the_parts_of_a_document_are_documents() -> None:
    assert isinstance(BUILT.robot, Document)
    assert BUILT.robot.tool.document() == {"tcp_m": [0.0, 0.0, -0.06]}


def test_a_copy_with_changes_is_checked_as_a_new_one_is() -> None:
    changed = BUILT.model_copy(update={"options": Options(stop="budget", budget_s=3.0)})
    assert changed.document()["options"] == {"stop": "budget", "budget_s": 3.0}
    assert {**changed.document(), "options": None} == {**BUILT.document(), "options": None}
    for update, field in (
        ({"optons": Options()}, "optons"),
        ({"options": {"stop": "last"}}, "options.stop"),
        ({"task": []}, "task"),
        ({"schema_": "assur/2"}, "schema"),
        ({"robot": None}, "robot"),
    ):
        with pytest.raises(ValidationError) as caught:
            BUILT.model_copy(update=update)
        assert ".".join(map(str, caught.value.errors()[0]["loc"])) == field


def test_parts_and_values_by_name_are_checked_too_and_a_digest_is_never_that_of_before() -> None:
    conveyor = Conveyor(at_m=mm(0, 350, 50), speed_m_s=mm(250))
    assert conveyor.model_copy(update={"speed_m_s": 0.1}).document() == {**conveyor.document(), "speed_m_s": 0.1}
    with pytest.raises(ValidationError):
        conveyor.model_copy(update={"speed_mm_s": 100})
    with pytest.raises(ValidationError):
        conveyor.model_copy(update={"speed_m_s": float("nan")})
    joints = Joints(j1_rad=0.1, j2_rad=0.2)
    assert joints.model_copy(update={"j2_rad": 0.3}).document() == {"j1_rad": 0.1, "j2_rad": 0.3}
    with pytest.raises(ValidationError):
        joints.model_copy(update={"j2_rad": "0.3"})
    exception = ClearanceException(between=["bed"], clearance_m=Clearance(travel=0, near=0), **{"and": ["post"]})
    assert exception.model_copy(update={"and_": ["rail"]}).document()["and"] == ["rail"]
    target = Target(frame="belt", at_m=mm(0, 0, 80), yaw_rad=0)
    with pytest.raises(ValidationError, match="at most one of frame, body"):
        target.model_copy(update={"body": "bed"})
    before = BUILT.digest
    changed = BUILT.model_copy(update={"options": Options(seed=7)})
    assert changed.digest == request_digest(changed.document()) != before
    assert BUILT.model_copy() == BUILT


@pytest.mark.parametrize("certificate", ["none", "", None, True])
def test_another_certificate_than_those_that_there_are_is_refused_before_anything_is_planned(certificate: Any) -> None:
    with pytest.raises(assur.InputError, match=r"certificate: got .*; allowed: full or digest"):
        assur.plan(PLAIN, certificate=certificate)


@pytest.mark.parametrize(
    ("given", "field", "said"),
    [
        ({"about": "why", "request": PLAIN}, "request", "this is a scenario; its part `request` is the request"),
        ({"request": PLAIN}, "request", "this is a document with a request in it"),
        ({"schema": "assur-plan/1", "request": PLAIN, "plan": {}}, "schema", "this is a plan file; its part `request`"),
        ({"schema": "assur/1", "status": "planned"}, "status", "this is an answer, not a request"),
        ("demo", "request", "assur.load reads the one in a file or of a shipped scenario"),
        ("cell.yaml", "request", "assur.load reads the one in a file or of a shipped scenario"),
        ([PLAIN], "request", "a mapping of fields"),
    ],
)
def test_what_is_no_request_is_refused_as_what_it_is(given: Any, field: str, said: str) -> None:
    for call in (assur.plan, request_digest):
        with pytest.raises(assur.InputError) as caught:
            call(given)
        assert (caught.value.field, said in caught.value.allowed) == (field, True)
