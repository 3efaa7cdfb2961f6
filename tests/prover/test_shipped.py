"""What the prover says of the plans of all shipped scenarios, and how it stands beside the planner."""

from __future__ import annotations

import ast
import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from jsonschema import Draft202012Validator

import assur
from assur.planner.claim.answer import with_answer
from assur.planner.claim.document import document_of
from assur.planner.claim.filling import claim_of, with_plan
from assur.planner.model.claims import NOTHING
from assur.planner.model.digest import digest
from assur.planner.model.phases import phases
from assur.planner.model.scene import bodies_in
from assur.prover import prove as prover
from assur.scenes.bundle import bundle_document
from assur.scenes.requests import check_document
from assur.scenes.scenarios import shipped, shipped_scenarios
from tests.architecture.source_tree import ROOT, imports
from tests.planner.claim.bounds import outside
from tests.planner.claim.reading import read
from tests.prover.bundles import bundle, planned, shown
from tests.scenes.cells.answers import answer

PROVER = ROOT / "prover" / "prove.py"
MOST_LINES = 800
"""Of code: a sceptic reads it in an evening."""


@pytest.mark.parametrize("name", shipped_scenarios())
def test_both_checkers_agree_on_every_plan_that_a_shipped_scenario_has(name: str) -> None:
    if answer(name)["status"] != "planned":
        return
    scenario = shipped(name)
    assert check_document(scenario.request, answer(name), folder=scenario.folder)["ok"]
    right, told = shown(bundle(name))
    assert right, told
    scene, plan = planned(name)
    of_plan, document = phases(scene, plan.legs, plan.arrivals), bundle(name)
    assert [told["plan_digest"], told["request_digest"]] == [plan.certificate.digest, scene.digest]
    alone = next((phase.t0 for phase in of_plan if not phase.robot), of_plan[-1].t1)
    assert told["the robot keeps clear from and until, s"] == [plan.trajectory.start, alone]
    assert told["parts that it put down keep clear until, s"] == of_plan[-1].t1
    assert told["times and intervals at which the tool is where it must be"] == len(document["points"])
    rows = "times and intervals at which "
    assert told[f"{rows}an axis has a direction, or a point a place along one"] == len(document["axes"])
    orders = [told[f"{rows}the {each} of a point is bounded"] for each in ("velocity", "acceleration")]
    assert sum(orders) == len(document["rates"])
    assert told[f"{rows}a sum of joints or a derivative of it is bounded"] == len(document["sums"])
    distances = scene.options.clearance
    least = [distances.travel_m, distances.near_m]
    assert told["distances in travel and near a control point, m"] == least
    every = [x for rule in distances.exceptions for x in (rule.travel_m, rule.near_m)]
    assert told["smallest distance of a pair, m"] == min(least + every)
    assert told["greatest delay of the robot's start, s"] == scene.execution.start_tolerance_s
    assert told["greatest lag of a joint, rad or m"] == max(scene.execution.lag or (0.0,))
    assert (told["limits of each joint, jerk"] == "not limited") is not scene.options.jerk_limited
    meshes = [body for body in bodies_in(scene) if body.surface is not None]
    assert told["bodies from meshes, with what they enclose"] == len(meshes)
    assert told["rows that show it"] > 0 < told["pairs of bodies that keep their distance, counted in each phase"]


@pytest.mark.parametrize("name", shipped_scenarios())
def test_a_bundle_is_the_claim_of_its_plan_and_is_read_as_it_was_written(name: str) -> None:
    if answer(name)["status"] != "planned":
        return
    scene, plan = planned(name)
    base, of_plan = claim_of(scene), phases(scene, plan.legs, plan.arrivals)
    claim = with_answer(base, with_plan(base, plan, of_plan), plan, of_plan, NOTHING)
    document = json.loads(json.dumps(bundle(name), allow_nan=False))
    assert outside(claim) == []
    found, labels = read(document)
    assert document_of(found, labels) == document
    for field, one, other in zip(claim._fields, claim, found, strict=True):
        assert np.array_equal(one, other), field


def test_a_bundle_has_the_form_that_its_schema_says_by_another_validator() -> None:
    schema = json.loads(prover.SCHEMA.read_text())
    Draft202012Validator.check_schema(schema)
    written = json.loads(json.dumps(bundle("demo"), allow_nan=False))
    assert list(Draft202012Validator(schema).iter_errors(written)) == []
    written["rows"][0]["note"] = "believe me"
    assert len(list(Draft202012Validator(schema).iter_errors(written))) == 1


def test_every_term_of_a_bundle_is_explained_in_its_schema() -> None:
    schema = json.loads(prover.SCHEMA.read_text())
    bare: list[str] = []

    def look(part: object, where: str) -> None:
        if isinstance(part, dict):
            if part.get("type") == "object" and not part.get("description") and "$defs" not in part:
                bare.append(where)
            for key, value in part.items():
                look(value, f"{where}.{key}")
        elif isinstance(part, list):
            for k, value in enumerate(part):
                look(value, f"{where}[{k}]")

    look(schema, "schema")
    assert bare == []
    assert len(schema["description"]) > 500


def code_lines(text: str) -> int:
    """Lines that are neither blank, nor a comment, nor of a docstring."""
    told: set[int] = set()
    for node in ast.walk(ast.parse(text)):
        for part in getattr(node, "body", []) if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) else []:
            if (
                isinstance(part, ast.Expr)
                and isinstance(part.value, ast.Constant)
                and isinstance(part.value.value, str)
            ):
                told |= set(range(part.lineno, (part.end_lineno or part.lineno) + 1))
    lines = enumerate(text.splitlines(), start=1)
    return sum(1 for k, line in lines if line.strip() and not line.strip().startswith("#") and k not in told)


def labels_without_their_code(page: str) -> list[str]:
    """Labels of equations on a page for which the table names no function with the label in its docstring."""
    table = dict(re.findall(r"^\| \((N\d+)\) \|[^|]+\| `([\w.]+)` \|$", page, re.MULTILINE))

    def told(label: str) -> str:
        found: object = prover
        for name in table.get(label, "").split("."):
            found = getattr(found, name, None)
        return (found.__doc__ or "") if callable(found) else ""

    labels = sorted(set(re.findall(r"\bN\d+\b", page)))
    return [label for label in labels if not re.search(rf"\b{label}\b", told(label))]


def test_every_equation_is_explained_and_computed_where_the_page_says() -> None:
    page = (ROOT / "docs" / "bundle.md").read_text(encoding="utf-8")
    text = PROVER.read_text(encoding="utf-8")
    labels = set(re.findall(r"\bN\d+\b", text)) | {f"N{k}" for k in range(1, 16)}
    assert labels == set(re.findall(r"\bN\d+\b", page))
    assert labels_without_their_code(page) == []
    assert labels_without_their_code(page.replace("| `swung` |", "| `spline` |")) == ["N10"]
    assert labels_without_their_code(page + "(N99)") == ["N99"]


def test_every_printed_line_is_explained_on_the_page() -> None:
    page = (ROOT / "docs" / "bundle.md").read_text(encoding="utf-8")
    table = page[page.index("| line | means |") :].partition("\n\n")[0]
    rows = [line.split(" | ")[0].removeprefix("| ") for line in table.splitlines()[2:]]
    assert rows == list(shown(bundle("demo"))[1])


def test_the_digest_of_a_bundle_is_that_of_its_plan_and_only_a_name() -> None:
    document, (scene, plan) = bundle("demo"), planned("demo")
    own = digest(scene.digest, plan.trajectory, plan.legs, plan.arrivals, plan.certificate)
    assert document["plan_digest"] == answer("demo")["certificate"]["digest"] == own
    document["plan_digest"] = "0" * 64
    right, told = shown(document)
    assert (right, told["plan_digest"]) == (True, "0" * 64)


def test_another_normal_may_be_a_proof_too() -> None:
    document = bundle("demo")
    for row in document["rows"]:
        row["normal"] = [x + 1e-6 * (k + 1) for k, x in enumerate(row["normal"])]
    assert shown(document)[0]


def test_the_prover_is_short() -> None:
    assert code_lines(PROVER.read_text(encoding="utf-8")) <= MOST_LINES
    assert code_lines('"""Words."""\n\n# a note\nx = 1\n') == 1
    assert [path.name for path in (ROOT / "prover").glob("*.py") if path.read_text().count("\n") > 2] == ["prove.py"]


def test_the_prover_imports_the_standard_library_and_two_others() -> None:
    found = {name.partition(".")[0] for name, _ in imports(ast.parse(PROVER.read_text(encoding="utf-8")))}
    assert found - set(sys.stdlib_module_names) == {"flint", "jsonschema_rs"}


def test_the_prover_proves_in_a_process_that_has_nothing_of_the_planner(tmp_path: Path) -> None:
    for name in ("prove.py", "bundle.schema.json"):
        (tmp_path / name).write_bytes((ROOT / "prover" / name).read_bytes())
    (tmp_path / "demo.json").write_text(json.dumps(bundle("demo")))
    program = (
        "import sys, pathlib, prove\n"
        "print(prove.prove(pathlib.Path('demo.json').read_bytes())[0], *(m for m in sys.modules if 'assur' in m))"
    )
    told = subprocess.run(
        [sys.executable, "-c", program], cwd=tmp_path, env={"PATH": ""}, capture_output=True, text=True, check=True
    )
    assert told.stdout.split() == ["True"], told.stderr


def test_python_writes_the_same_bundle() -> None:
    scenario = shipped("standard-cycle")
    own = bundle_document(scenario.request, answer("standard-cycle"), folder=scenario.folder)
    assert assur.bundle(dict(scenario.request), answer("standard-cycle")) == own
