"""The tables of docs/api.md and docs/conventions.md are whole: keys, reasons, codes, defaults, signs of the code."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import fields
from typing import Any, get_args

import pytest

from assur.planner.frames.motion import Pose
from assur.planner.model.outcome import LegKind
from assur.planner.model.refusal import Facts
from assur.scenes import check, load, plan
from assur.scenes.catalogue import arm_named
from assur.scenes.reading.arms import WITH_QUILL
from assur.scenes.requests import request_schema, robots
from assur.scenes.schema.request import ExecutionDocument, OptionsDocument
from assur.scenes.units import si_key, twin_of
from tests.docs.pages import PAGES, ROOT, blocks, prose, spans, text

API = "docs/api.md"
REQUEST = "docs/request.md"


def words(page: str) -> set[str]:
    """Every name in code on a page."""
    code = [*spans(page), *(block.text for block in blocks(page))]
    return {word for text in code for word in re.findall(r"[A-Za-z_]\w*", text)}


WORDS = words(API)


def keys_of_requests() -> set[str]:
    """SI keys of every document in a request."""
    schema = request_schema()
    documents = [schema, *schema["$defs"].values()]
    every = {key for document in documents for key in document.get("properties", {})}
    return {key for key in every if si_key(key) is None}


def keys_of(document: Any) -> Iterator[str]:
    """Every key of an answer."""
    if isinstance(document, dict):
        for key, value in document.items():
            yield key
            yield from keys_of(value)
    elif isinstance(document, list) and document:
        yield from keys_of(document[0])


def test_every_key_of_a_request_is_explained() -> None:
    keys = keys_of_requests()
    assert "clearance_m" in keys
    shown = WORDS | words(REQUEST)
    assert {key for key in keys if not {key, twin_of(key)} & shown} == set()


@pytest.fixture(scope="module")
def planned() -> dict[str, Any]:
    request = load("standard-cycle")
    request["options"] |= {"stop": "first", "budget_s": 60, "report": "full"}
    return plan(request)


def refused() -> dict[str, Any]:
    request = load("standard-cycle")
    request["task"] = [{"move": {"to": {"at_mm": [1500, 0, 250]}}}]
    request["options"]["report"] = "full"
    return plan(request)


COLUMNS = {"first", "first_piece", "second", "second_piece", "t0_s", "t1_s", "normal", "names"}
"""Of the certificate in full: docs/guarantees.md says what a row is."""
EXPLAINED_IN_WORDS = {
    *("velocity_ratio", "acceleration_ratio", "jerk_ratio", "joint", "jerk"),  # "per joint with their shares"
    *("stage", "interval_s", "count", "least", "most", "unit", "detail", "amount"),  # of the census and the refusal
}


@pytest.mark.parametrize("status", ["planned", "not_planned"])
def test_every_key_of_an_answer_is_explained(status: str, planned: dict[str, Any]) -> None:
    answer = planned if status == "planned" else refused()
    assert answer["status"] == status
    assert set(keys_of(answer)) - WORDS - COLUMNS - EXPLAINED_IN_WORDS == set()


def test_every_key_that_the_table_of_the_answer_names_is_there(planned: dict[str, Any]) -> None:
    table = prose(API).split("## The answer")[1].split("Kinds of leg")[0]
    there = {"planned": planned, "not planned": refused()}
    rows = re.findall(r"^\| (`[^|]*) \| (planned|not planned|both) \|", table, re.MULTILINE)
    assert len(rows) > 15
    for names, of in rows:
        for key in re.findall(r"`(\w+)`", names):
            for status in there if of == "both" else [of]:
                assert key in there[status], (key, status)


def test_every_key_of_a_verdict_is_explained(planned: dict[str, Any]) -> None:
    request = load("standard-cycle")
    request["options"] |= {"stop": "first", "budget_s": 60, "report": "full"}
    assert check(request, planned)["ok"]
    planned = {**planned, "arrivals": planned["arrivals"][1:]}
    verdict = check(request, planned)
    assert not verdict["ok"]
    assert set(keys_of(verdict)) - WORDS == set()


def test_the_kinds_of_leg_are_whole() -> None:
    kinds = prose(API).split("Kinds of leg: ")[1].split("\n\n")[0]
    assert re.findall(r"`([A-Z_]+)`", kinds) == [str(kind) for kind in LegKind]


def test_the_kinds_of_facts_are_whole() -> None:
    table = prose(API).split("| facts (`kind`) | hold |")[1].split("\n\n")[0]
    kinds = {next(f.default for f in fields(facts) if f.name == "kind") for facts in get_args(Facts)}
    assert set(re.findall(r"^\| `(\w+)` \|", table, re.MULTILINE)) == kinds


@pytest.mark.parametrize(
    ("heading", "document"), [("options", OptionsDocument()), ("execution", ExecutionDocument())], ids=str
)
def test_the_defaults_that_are_shown_are_the_documents_own(heading: str, document: Any) -> None:
    section = prose(API).split(f"### `{heading}`")[1].split("\n##")[0]
    rows = dict(re.findall(r"^\| `(\w+)` \| ([^|]+) \|", section, re.MULTILINE))
    assert set(rows) == set(type(document).model_fields)
    for key, shown in rows.items():
        value = getattr(document, key)
        written = (
            {None: "none", True: "true", False: "false"}.get(value) if value is None or value in (True, False) else None
        )
        if key == "clearance_m":
            written = f"{value.travel:g}, {value.near:g}"
        elif value == []:
            written = "[]"
        elif isinstance(value, str):
            written = f"`{value}`"
        elif type(value) in (int, float):
            written = f"{value:g}"
        assert shown == written, key


def test_the_table_of_joint_conventions_is_that_of_the_catalogue() -> None:
    found = re.findall(
        r"^\| `([\w-]+)` \| ([\w ]+) \| ([+ -]+) \| (\d+) \| (.+?) to (.+?) \| (.+?) to (.+?) \|$",
        prose("docs/conventions.md"),
        re.MULTILINE,
    )
    without_lift = re.findall(r"^\| `([\w-]+)` \| ([\w ]+) \| ([+ -]+) \|$", prose("docs/conventions.md"), re.MULTILINE)
    assert [row[0] for row in found] == [robot["model"] for robot in robots() if robot["family"] in WITH_QUILL]
    assert [row[0] for row in without_lift] == [
        robot["model"] for robot in robots() if robot["family"] not in WITH_QUILL
    ]
    for model, names, signs in without_lift:
        arm = arm_named(model)
        assert names.split() == [joint.name for joint in arm.conventions]
        assert [f"{sign}1" for sign in signs.split()] == [f"{joint.sign:+d}" for joint in arm.conventions]
    for model, names, signs, zero, low, high, lowest, highest in found:
        arm = arm_named(model)
        lift = next(i for i, joint in enumerate(arm.conventions) if joint.kind == "prismatic")
        assert names.split() == [joint.name for joint in arm.conventions]
        assert [f"{sign}1" for sign in signs.split()] == [f"{joint.sign:+d}" for joint in arm.conventions]
        assert float(zero) == 1e3 * arm.zero_m
        ends = sorted(arm.conventions[lift].sign * float(end) for end in (low, high))
        place = arm.conventions.places[lift]
        limits = [1e3 * arm.limits.lower[place], 1e3 * arm.limits.upper[place]]
        assert ends == pytest.approx(limits)
        assert [float(lowest), float(highest)] == pytest.approx([float(zero) + end for end in limits])


def test_the_table_of_solids_is_that_of_the_catalogue() -> None:
    section = prose(REQUEST).split("| arm | its solids")[1].split("\n\n")[0]
    table = {
        arm: re.findall(r"`([\w-]+)`", names) for arm, names in re.findall(r"^\| (.+?) \| (.+) \|$", section, re.M)
    }
    rest = table.pop("the SCARAs, but for the next two")
    shown = {arm.strip("`"): names for arm, names in table.items()}
    assert list(shown)[:2] == ["benchmark-scara", "lab-scara"]
    for robot in robots():
        arm = arm_named(robot["model"])
        there = [rider.body.name for rider in arm.robot(Pose(), arm.limits).bodies]
        assert robot["family"] == "scara" or robot["model"] in shown
        assert there == shown.pop(robot["model"], rest), robot["model"]
    assert shown == {}


def test_the_arms_that_readme_names_are_those_of_the_catalogue() -> None:
    table = prose("README.md").split("| arm | in the catalogue")[1].split("\n\n")[0]
    rows = re.findall(r"^\| (.+?) \| (.+?) \|$", table, re.MULTILINE)
    there = {robot["model"]: robot["family"] for robot in robots()}
    scaras = [model for model, family in there.items() if family == "scara"]
    first, *others = (cell for _, cell in rows)
    assert first.startswith("eight")
    assert len(scaras) == 8
    assert set(re.findall(r"`([\w-]+)`", first)) <= set(scaras)
    assert {name for cell in others for name in re.findall(r"`([\w-]+)`", cell)} == set(there) - set(scaras)


CITED = re.compile(r"\bequations? ((?:[A-Z]\d{1,2}(?:, | and | to )?)+)")
NUMBERED = re.compile(r"\(([A-Z]\d{1,2})\)")


def cited(text: str) -> set[str]:
    """Numbers of equations that a module cites: those after the word, and all of kinematics."""
    named = {number for found in CITED.findall(text) for number in re.findall(r"[A-Z]\d+", found)}
    return named | set(re.findall(r"\bK\d{1,2}\b", text))


def test_every_equation_that_the_code_cites_stands_on_a_page_once() -> None:
    shown = [number for page in PAGES if page.startswith("docs/") for number in NUMBERED.findall(text(page))]
    for tree in ("planner", "scenes", "experiments"):
        for module in sorted((ROOT / tree).rglob("*.py")):
            assert cited(module.read_text(encoding="utf-8")) <= set(shown), module
    kinematics = re.findall(r"\(([A-Z]\d{1,2})\)(?: \|)?$", text("docs/kinematics.md"), re.MULTILINE)
    assert len(kinematics) == len(set(kinematics)) > 80


def test_an_equation_that_stands_nowhere_is_found() -> None:
    assert cited("as in equation Q7") == {"Q7"}
    assert cited("equations F1, F2 and P5; K13") == {"F1", "F2", "P5", "K13"}
    assert cited("(equations T4 to T5).") == {"T4", "T5"}
