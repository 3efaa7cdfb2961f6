"""Whether the next task states of the parts of a plan what it has to, and nothing else than the plan.

The request of a plan has the shape of a part, its mass and its symmetry, not its kind. So a part that is not listed
would be picked as a part without a kind is, at its middle; and one that is listed has all of its kind.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

from assur.scenes.faults import DocumentError, choices, fault, written_key
from assur.scenes.schema.normal import normal
from assur.scenes.set_values import GIVEN
from assur.scenes.tasks.origins import OF_TASK, within_document
from assur.scenes.tasks.request_of_task import GRASP, HANDLED

Document = dict[str, Any]
NUMBER = re.compile(r"\[(\d+)\]")
"""A number in a path, in brackets."""
PLACES = ("pose", "slot")
"""Fields that say where a part is."""
OF_KIND = ("shape", "mass_kg", "yaw_symmetry")
"""What a part has of its kind, if it does not state it, and a plan of the part."""


def check_same_bodies(
    request: Document, before: Mapping[str, Document], task: Document, given: Mapping[str, object]
) -> None:
    """Raises `DocumentError` where a body of the plan has another shape, mass or symmetry in the `request` that
    follows. `before`: the bodies of the plan by their names; `task`: as it was written; `given`: values of it that were
    set, by their paths. A part that the task lists with a place is a new one. What the list states counts, but for its
    shape.

    Faults are at the list (`OF_TASK`), at what was `GIVEN`, or at the body in the request.
    """
    listed = {part["name"]: (number, part) for number, part in enumerate(task.get("parts", ()))}
    for i, body in enumerate(request["bodies"]):
        name = body["name"]
        number, part = listed.get(name, (None, {}))
        if name not in before or part.keys() & {*PLACES}:
            continue
        here, there = _of_kind(body), _of_kind(before[name])
        for key in OF_KIND:
            if here.get(key) == there.get(key) or (key != "shape" and written_key(part, key) is not None):
                continue
            if key == "shape":
                allowed = f"the shape that {name} has in the plan, or a place at which this part is seen"
            else:
                shown = (repr(each.get(key, "none")) for each in (there, here))
                allowed = "a number, which must be given: the plan has {}, the kind {}".format(*shown)
            own = f"parts.{name}.", f"parts.{number}."
            path = next((path for path in given if NUMBER.sub(r".\1", path).startswith(own)), None)
            if path is not None:
                raise DocumentError(f"{GIVEN}{path}", given[path], allowed)
            if number is None:
                raise fault(request, ("bodies", i, key), allowed)
            with within_document(OF_TASK):
                raise fault(task, ("parts", number, "kind" if key == "shape" and "kind" in part else key), allowed)


def _of_kind(body: Document) -> Document:
    """What a body has of its kind or states itself, in SI."""
    return {"yaw_symmetry": 1} | {key: value for key, value in normal(body).items() if key in OF_KIND}


def check_kinds_of_picked(kinds: Mapping[str, Document], steps: object, known: Mapping[str, Document]) -> None:
    """Raises `DocumentError` for one of the `known` parts, which the task of these steps does not list, where a step
    picks it and a kind of its shape states the grasp. A part whose shape is that of no kind has none."""
    for field, name, own in _picked(steps):
        part = known.get(name, {})
        if "kind" in part or "shape" not in part:
            continue
        shape = normal(part["shape"])
        found = [kind for kind, of in kinds.items() if normal(of["shape"]) == shape and _states_pick(of, own)]
        if found:
            others = f", of one of the kinds of its shape: {choices(found, found[0])}" if len(found) > 1 else ""
            allowed = (
                f"a part that `parts` list with its kind, which states the grasp and is not in the plan: "
                f"write parts: [{{name: {name}, kind: {found[0]}}}]{others}; its place is that of the plan"
            )
            raise DocumentError(field, name, allowed)


def check_there(steps: object, away: Mapping[str, str]) -> None:
    """Raises `DocumentError` where a step picks a part that was taken away. `away`: that it was, in words, by the names
    of those parts that the task does not list."""
    for field, name, _ in _picked(steps):
        if name in away:
            raise DocumentError(field, name, f"a part that is there: {away[name]}")


def _states_pick(kind: Document, own: Document) -> bool:
    """Whether a pick has something of its grasp, approach, dwell or depart of the kind."""
    return any(written_key(kind, key) and not written_key(own, key) for key in (*GRASP, *HANDLED))


def _picked(steps: object) -> Iterator[tuple[str, str, Document]]:
    """The field of each name of a part that is picked, the name, and the pick or the transfer. What has another form is
    refused where the steps are read."""
    for i, step in enumerate(steps if isinstance(steps, list) else ()):
        for key, own in step.items() if isinstance(step, dict) else ():
            if not isinstance(own, dict):
                continue
            if key == "pick" and isinstance(own.get("part"), str):
                yield f"steps[{i}].pick.part", own["part"], own
            if key == "transfer" and isinstance(own.get("parts"), list):
                names = [(k, name) for k, name in enumerate(own["parts"]) if isinstance(name, str)]
                yield from ((f"steps[{i}].transfer.parts[{k}]", name, own) for k, name in names)
