"""What the operations of the service take, as components of its description.

They are the JSON Schemas by which a document is read, changed so that generators of clients and of tests can use them.
What a request over HTTP may never have is left out, names of what is shipped are listed, joints that turn and joints
that lift are two components, and that at most one of two keys may be given is stated by `AT_MOST_ONE`.
"""

from __future__ import annotations

import json
from typing import Any

from assur.scenes.catalogue import models
from assur.scenes.exports.documents import export_schemas
from assur.scenes.meshes.assets import asset_names
from assur.scenes.requests import BUDGETS, ik_schema, request_schema, schema_of
from assur.scenes.units import TWIN_UNITS, any_unit, twin_of

AT_MOST_ONE = "x-at-most-one"
"""Keyword of a component: pairs of keys; at most one of each pair may be given. In JSON Schema each pair is a rule with
`not`; generators of tests write out all combinations of such rules, and give up above 64."""
REQUEST = {"$ref": "#/components/schemas/Request", "description": "The request."}
NEVER = {"MeshDocument": "file", "RobotDocument": "file", "NeighbourDocument": "plan"}
"""Fields that name files, which a request over HTTP may not: component to key."""


def request_components(marks: dict[str, Any], most_budget_s: float) -> dict[str, Any]:
    """The components by name. `marks`: fields of a body with a request and a plan that may be a plan file;
    `most_budget_s`: largest budget that the service gives, s."""
    request, question, export, trajectory = request_schema(), ik_schema(), *export_schemas()
    cell, task = schema_of("cell"), schema_of("task")
    of_all = (request, question, export, trajectory, cell, task)
    parts = {name: part for of in of_all for name, part in of.pop("$defs", {}).items()}
    del task["properties"]["cell"]  # the address names it
    task["required"] = ["start", "steps"]
    for of_plan, needed in ((export, ["request", "plan"]), (trajectory, ["request"])):
        of_plan["properties"]["request"] = REQUEST
        of_plan["properties"]["plan"] = {
            "$ref": "#/components/schemas/PlannedAnswer",
            "description": "Its planned answer.",
        }
        of_plan["properties"] |= marks if of_plan is export else {}
        of_plan["required"] = [*needed, *of_plan.get("required", [])]
    question["properties"]["request"] = REQUEST
    question["allOf"].append({"oneOf": [{"required": ["request"]}, {"required": ["robot"]}]})
    del request["$schema"], request["$id"], cell["$schema"], task["$schema"]
    found = {
        **parts,
        "Request": request,
        "Cell": cell,
        "Task": task,
        "IkQuestion": question,
        "ExportQuestion": export,
        "TrajectoryQuestion": trajectory,
        "SceneQuestion": {
            "type": "object",
            "title": "SceneQuestion",
            "description": "Options in place of those of the scenario; if left out, those of the scenario",
            "properties": {"options": {"$ref": "#/$defs/OptionsDocument", "description": "How to search."}},
            "additionalProperties": False,
        },
    }
    for name, key in NEVER.items():
        _forget(found[name], key)
    for name in ("PlanFileDocument", "CellReference"):
        del found[name]
    _name(found["RobotDocument"]["properties"]["model"], list(models()))
    _name(found["MeshDocument"]["properties"]["asset"], list(asset_names()))
    _limit_budgets(found["OptionsDocument"]["properties"], most_budget_s)
    _split_joints(found)
    for field in (field for part in found.values() for field in part.get("properties", {}).values()):
        for pattern, named in field.pop("patternProperties", {}).items():
            field |= {"additionalProperties": named, "propertyNames": {"pattern": pattern}}
    for part in found.values():
        # of joints by name: generators of clients take one type of value; the limits in SI are the narrowest
        part.pop("patternProperties", None)
        _tell_pairs(part)
        _tell_defaults(part)
    return {name: _moved({**part, "title": name}) for name, part in found.items()}  # a generated class is called so


def _forget(part: dict[str, Any], key: str) -> None:
    """Leaves out a property of a component, which is one of several keys; exactly one of them is needed."""
    del part["properties"][key]
    for rule in part["allOf"]:
        rule["oneOf"] = [option for option in rule.get("oneOf", ()) if option != {"required": [key]}]
    part["allOf"] = [rule for rule in part["allOf"] if rule.get("oneOf") != [] or len(rule) > 1]


def _name(field: dict[str, Any], names: list[str]) -> None:
    field.pop("pattern")
    field["enum"] = names


def _limit_budgets(options: dict[str, Any], most_budget_s: float) -> None:
    for name in BUDGETS:
        for key, factor in ((name, 1), (str(twin_of(name)), 1000)):
            options[key]["maximum"] = min(options[key]["maximum"], most_budget_s * factor)
        options[name]["default"] = min(options[name]["default"], most_budget_s)


def _split_joints(found: dict[str, Any]) -> None:
    """A joint has all its quantities in rad, or all in m; which of them, its arm says. Two components say that with
    fewer combinations than one."""
    joint = found["JointDocument"]
    for name, other in (("TurningJoint", "m"), ("LiftingJoint", "rad")):
        strange = {key for key in joint["properties"] if (unit := any_unit(key)) and _base(unit) == other}
        kept = {key: field for key, field in joint["properties"].items() if key not in strange}
        rules = [
            {"oneOf": [option for option in rule["oneOf"] if not strange & set(option["required"])]}
            for rule in joint["allOf"]
            if "oneOf" in rule
        ]
        pairs = [rule for rule in joint["allOf"] if "not" in rule and not strange & set(rule["not"]["required"])]
        found[name] = {**joint, "title": name, "properties": kept, "allOf": rules + pairs}
    both = [{"$ref": f"#/$defs/{name}"} for name in ("TurningJoint", "LiftingJoint")]
    found["JointDocument"] = {"description": joint["description"], "oneOf": both}


def _base(unit: str) -> str:
    """The unit of the joint's position: `rad` of `deg_s2`."""
    return TWIN_UNITS.get(unit, unit).partition("_")[0]


def _tell_pairs(part: dict[str, Any]) -> None:
    """Moves the rules that say that two keys exclude each other from `allOf` to `AT_MOST_ONE`."""
    rules = part.pop("allOf", [])
    pairs = [rule["not"]["required"] for rule in rules if "not" in rule]
    if pairs:
        part[AT_MOST_ONE] = pairs
    rules = [rule for rule in rules if "not" not in rule]
    if rules:
        part["allOf"] = rules


def _tell_defaults(part: dict[str, Any]) -> None:
    """Says in words what is taken if a quantity that has two keys is left out: a generated client would send the
    default of one key beside the other."""
    for key, field in part.get("properties", {}).items():
        if twin_of(key) in part["properties"] and "default" in field:
            silent = f"If left out in both units: {json.dumps(field.pop('default'))}."
            field["description"] = f"{field['description']} {silent}"


def _moved(schema: Any) -> Any:
    """`schema` with its references pointing at the components of the description."""
    if isinstance(schema, dict):
        return {
            key: value.replace("#/$defs/", "#/components/schemas/") if key == "$ref" else _moved(value)
            for key, value in schema.items()
        }
    return [_moved(item) for item in schema] if isinstance(schema, list) else schema
