"""What schemathesis gets in addition to the service's description: refusals that a schema cannot foresee.

Loaded by `benchmarks.contract` as the module of hooks.
"""

from __future__ import annotations

from typing import Any

import jsonschema_rs
import schemathesis

from assur.planner.errors import InputError
from assur.scenes.schema.ik import IkDocument
from assur.scenes.schema.read import read
from assur.scenes.schema.request import OptionsDocument, RequestDocument
from benchmarks.contract_words import AT_MOST, NOT_IN_SCHEMA


def foreseeable(body: Any) -> str | None:
    """The fault of a refused body that keeps the description, if a schema could state the rule; else None: its form is
    right, and what is wrong is a name, a sum, or a place in the cell."""
    if not isinstance(body, dict):
        return None
    readings: list[tuple[Any, Any]] = [(RequestDocument, body)] if "task" in body else []
    readings += [(RequestDocument, body["request"])] if "request" in body else []
    readings += [(OptionsDocument, body["options"])] if body.keys() == {"options"} else []
    if "pose" in body or "joints" in body:
        readings.append((IkDocument, {key: value for key, value in body.items() if key != "request"}))
    for model, document in readings:
        try:
            read(model, document)
        except InputError as error:
            if not any(words in error.allowed for words in NOT_IN_SCHEMA) and not error.allowed.startswith(AT_MOST):
                return str(error)
    return None


def keeps_description(case: Any) -> bool:
    """Whether the body of a case keeps the schema of its operation: not all that is meant to does. False for an
    operation without a body of JSON: the answer of a job that failed is 422 for the body that was posted before, and a
    mesh must have the digest of its address."""
    raw = case.operation.schema.raw_schema
    described = raw["paths"][case.operation.path][case.operation.method]
    content = described.get("requestBody", {}).get("content", {})
    if "application/json" not in content:
        return False
    schema = {**content["application/json"]["schema"], "components": raw["components"]}
    return bool(jsonschema_rs.Draft202012Validator(schema).is_valid(case.body))


@schemathesis.check
def refused_for_what_a_schema_could_say(_: Any, response: Any, case: Any) -> None:
    """A body that keeps the description is refused only for what no schema can say."""
    if response.status_code == 422 and case.meta is not None and case.meta.generation.mode.is_positive:
        fault = foreseeable(case.body) if keeps_description(case) else None
        if fault is not None:
            raise AssertionError(f"A body that keeps the description was refused: {fault[:500]}")
