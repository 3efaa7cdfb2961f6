"""Every field of the documents has a description with its unit, from one place, and the pages say the same."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Any

import jsonschema_rs
import pytest
import yaml
from pydantic import BaseModel, TypeAdapter
from typer.testing import CliRunner

from assur.api.command_line import app
from assur.scenes.exports.documents import export_schemas
from assur.scenes.requests import KINDS, ik_schema, request_schema, schema_of
from assur.scenes.scenarios import CELLS
from assur.scenes.schema.answer import Answer, Verdict, facts_described
from assur.scenes.schema.cell_file import CELL, TASK
from assur.scenes.schema.described import FILE, description, unit_in_words
from assur.scenes.schema.export import ExportAnswer, TrajectoryVerdict
from assur.scenes.schema.ik import IkAnswer
from assur.scenes.schema.model import Document
from assur.scenes.schema.request import ExecutionDocument, OptionsDocument, RequestDocument
from assur.scenes.schema.robots import NeighbourDocument
from assur.scenes.schema.task_steps import TransferDocument
from assur.scenes.schema.view import ViewDocument
from tests.docs.pages import prose

SENTENCES: dict[str, dict[str, str]] = yaml.safe_load(FILE.read_text(encoding="utf-8"))
ANSWERS: tuple[Any, ...] = (Answer, Verdict, IkAnswer, ExportAnswer, TrajectoryVerdict, ViewDocument)
SCHEMAS: dict[str, dict[str, Any]] = {
    "request": request_schema(),
    **{f"{kind} file": schema_of(kind) for kind in KINDS if kind != "request"},
    "transfer": TransferDocument.model_json_schema(),
    "question of inverse kinematics": ik_schema(),
    "question of an export": export_schemas()[0],
    "question about a trajectory": export_schemas()[1],
    **{str(form): TypeAdapter(form).json_schema() for form in ANSWERS},
}
for _schema in SCHEMAS.values():
    facts_described(_schema.get("$defs", {}))
NO_UNIT = re.compile(
    r"without a unit|unit of|in `unit`|a count|rad or m\b|rad/s|m/s|kg|m or rad\b|m or mm\b|"
    r"[Nn]umber|counted|[Hh]ow many"
)
"""Words by which a number whose key bears no unit says what it is."""


def fields(schema: Any, path: str = "") -> Iterator[tuple[str, str, dict[str, Any]]]:
    """Where, the key and the schema of each property below a schema, references not followed: each is in `$defs`."""
    if isinstance(schema, dict):
        for key, field in schema.get("properties", {}).items():
            yield path, key, field
        for key, part in schema.items():
            yield from fields(part, f"{path}/{key}")
    elif isinstance(schema, list):
        for i, part in enumerate(schema):
            yield from fields(part, f"{path}/{i}")


@pytest.mark.parametrize("name", SCHEMAS)
def test_no_field_is_without_a_sentence_that_has_its_unit(name: str) -> None:
    found = list(fields(SCHEMAS[name]))
    assert len(found) >= 3
    for path, key, field in found:
        told = field.get("description", "")
        assert re.match(r"[A-Z`|].*\.$", told), (path, key, told)
        unit = unit_in_words(key)
        assert unit is None or told.endswith(f" In {unit}."), (path, key, told)


def test_the_request_has_hundreds_of_fields_and_each_quantity_is_described_in_both_units() -> None:
    found = {(path, key): field["description"] for path, key, field in fields(SCHEMAS["request"])}
    assert len(found) > 500
    conveyor = "/$defs/ConveyorDocument"
    assert found[conveyor, "speed_m_s"] == "Speed along the x axis of the frame. In m/s."
    assert found[conveyor, "speed_mm_s"] == "Speed along the x axis of the frame. In mm/s."
    assert found["/$defs/LiftDocument", "mm"] == "Length of the straight part. In mm."


@pytest.mark.parametrize(
    ("key", "unit"),
    [
        ("at_m", "m"),
        ("acceleration_mm_s2", "mm/s²"),
        ("jerk_rad_s3", "rad/s³"),
        ("rate_deg_s", "deg/s"),
        ("budget_ms", "ms"),
        ("mass_kg", "kg"),
        ("inertia_kgm2", "kg·m²"),
        ("m", "m"),
        ("name", None),
        ("items", None),
        ("kg_of_what", None),
    ],
)
def test_the_unit_of_a_key_in_words(key: str, unit: str | None) -> None:
    assert unit_in_words(key) == unit


def numbers(field: dict[str, Any]) -> bool:
    """Whether a field holds a number, or a list of numbers."""
    return field.get("type") in ("number", "integer") or (
        field.get("type") == "array" and numbers(field.get("items", {}))
    )


def test_a_number_whose_key_bears_no_unit_says_what_it_is() -> None:
    for name in ("request", str(Answer)):
        for path, key, field in fields(SCHEMAS[name]):
            if numbers(field) and unit_in_words(key) is None and "enum" not in field:
                assert NO_UNIT.search(field["description"]) or key in ("seed", "max_candidates"), (path, key)


def test_what_has_no_sentence_is_refused_where_its_schema_is_made() -> None:
    class Undescribed(Document):
        length_m: float

    with pytest.raises(KeyError, match=r"Undescribed\.length_m has no sentence in fields\.yaml"):
        Undescribed.model_json_schema()
    assert description(RequestDocument, "task") == SENTENCES["RequestDocument"]["task"]


def test_every_sentence_is_that_of_some_field() -> None:
    every = [(key, field["description"]) for schema in SCHEMAS.values() for _, key, field in fields(schema)]
    used = {(key, told.removesuffix(f" In {unit_in_words(key)}.")) for key, told in every}
    unused = {(model, key) for model, own in SENTENCES.items() for key, said in own.items() if (key, said) not in used}
    assert unused == set()


def plain(cell: str) -> str:
    """A cell of a table without its links and escapes."""
    return re.sub(r"\[([^\]]+)\]\([^)]+\)", r"\1", cell).replace("\\|", "|").strip()


@pytest.mark.parametrize(
    ("page", "start", "end", "model"),
    [
        ("docs/api.md", "## The request\n", "[request.md](request.md) goes", RequestDocument),
        ("docs/api.md", "### `options`", "### `execution`", OptionsDocument),
        ("docs/api.md", "### `execution`", "## The answer", ExecutionDocument),
        ("docs/request.md", "## Other robots", "## Task", NeighbourDocument),
    ],
    ids=lambda value: value.__name__ if isinstance(value, type) else "",
)
def test_the_tables_of_the_pages_say_what_the_schema_says(
    page: str, start: str, end: str, model: type[BaseModel]
) -> None:
    section = prose(page).split(start)[1].split(end)[0]
    rows = re.findall(r"^\| `(\w+)` .*(?<!\\)\| ((?:\\\||[^|])+?) \|$", section, re.MULTILINE)
    assert len(rows) >= 2
    for key, cell in rows:
        assert plain(cell) == SENTENCES[model.__name__][key], key


def test_the_schemas_of_files_take_every_shipped_one_and_refuse_what_the_reader_refuses() -> None:
    assert json.loads(CliRunner().invoke(app, ["schema"]).stdout) == request_schema()
    validators: dict[str, jsonschema_rs.Draft202012Validator] = {}
    for kind in KINDS:
        printed = json.loads(CliRunner().invoke(app, ["schema", kind]).stdout)
        assert printed == (request_schema() if kind == "request" else schema_of(kind))
        validators[kind] = jsonschema_rs.Draft202012Validator(printed)
    files = [yaml.safe_load(path.read_text(encoding="utf-8")) for path in sorted(CELLS.glob("**/*.yaml"))]
    of: dict[str, list[dict[str, Any]]] = {"scenario": [], "cell": [], "task": []}
    for document in files:
        of_file = {CELL: "cell", TASK: "task"}.get(document.get("schema"), "scenario")
        of[of_file].append(document)
        assert validators[of_file].is_valid(document)
    assert min(map(len, of.values())) >= 4
    changes: list[dict[str, Any]] = [{"requst": {}}, {"about": ""}, {"expect": {"status": "maybe"}}, {"request": {}}]
    for change in changes:
        for of_file, documents in of.items():
            assert not validators[of_file].is_valid({**documents[0], **change}), change


POSE = {"at_mm": [0, 0, 0], "yaw_deg": 0}
IN_TASK: list[tuple[dict[str, Any], bool]] = [
    ({"steps": [{"move": {"to": "home"}}]}, True),
    ({"steps": [{"move": {"to": POSE}}]}, True),
    ({"steps": [{"pick": {"part": "a"}}, {"place": {"part": "a", "to": {"slot": {"box": 3}}}}]}, True),
    ({"steps": [{"transfer": {"parts": ["a"], "to": "box", "window_mm": [-1, 1]}}]}, True),
    ({"start": {"tool": "home"}}, True),
    ({"options": {"seed": 3}}, True),
    ({"steps": [{"move": {"too": "home"}}]}, False),
    ({"steps": [{"move": {"to": 3}}]}, False),
    ({"steps": [{"move": {"to": {"slot": {"box": 3}}}}]}, False),
    ({"steps": [{"move": {"to": "home"}, "transfer": {"parts": ["a"], "to": "box"}}]}, False),
    ({"steps": [{"pick": {"part": "a", "dwell_ms": -1}}]}, False),
    ({"steps": [{"transfer": {"parts": []}}]}, False),
    ({"start": {"tool": 3}}, False),
    ({"options": {"seed": 1.5}}, False),
]


@pytest.mark.parametrize(("change", "right"), IN_TASK)
def test_the_schema_of_a_task_has_its_steps_start_and_options(change: dict[str, Any], right: bool) -> None:
    task = {"schema": TASK, "start": {"joints": {"j1_deg": 0}}, "steps": [{"move": {"to": "home"}}], **change}
    assert jsonschema_rs.Draft202012Validator(SCHEMAS["task file"]).is_valid(task) == right
