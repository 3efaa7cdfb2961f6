"""Where the things that a drawing shows are written: the robot, bodies and steps, in a scenario, a task or a cell."""

from __future__ import annotations

from typing import Literal

from typing_extensions import TypedDict

from assur.scenes.faults import dotted
from assur.scenes.scenario import Scenario
from assur.scenes.tasks.origins import OF_CELL, OF_TASK
from assur.scenes.tasks.task_file import TaskScenario
from assur.scenes.text.yaml_text import spans_in


class Place(TypedDict):
    """A thing of a drawing, by its kind and its name (a step: its number), and where it is written: from one character
    to another, as JavaScript counts them, in the posted `text` or `cell`."""

    kind: Literal["robot", "tool", "body", "step"]
    name: str
    written: Literal["text", "cell"]
    begin: int
    end: int


def places_of(scenario: Scenario, text: str | None, cell: str | None) -> list[Place]:
    """Where the things of a scenario are written, whose texts were read before."""
    texts = {"text": text, "cell": cell}
    spans = {name: spans_in(each.encode()) for name, each in texts.items() if each is not None}
    request, found = scenario.request, list[Place]()
    wanted: list[tuple[Literal["robot", "tool", "body", "step"], str, str]] = [
        ("robot", "", "robot"),
        ("tool", "", "robot.tool"),
    ]
    wanted += [("body", body["name"], dotted(("bodies", i))) for i, body in enumerate(request.get("bodies", ()))]
    wanted += [("step", str(i), dotted(("task", i))) for i in range(len(request["task"]))]
    for kind, name, field in wanted:
        written, path = _origin(scenario, field, kind, alone=text is None)
        span = spans.get(written, {}).get(path)
        if span is not None:
            begin, end = (_units(texts[written] or "", at) for at in span)
            found.append({"kind": kind, "name": name, "written": written, "begin": begin, "end": end})
    return found


def _origin(scenario: Scenario, field: str, kind: str, *, alone: bool) -> tuple[Literal["text", "cell"], str]:
    """The text in which a field of the request is written, and its path there."""
    if not isinstance(scenario, TaskScenario):
        return "text", f"request.{field}"
    origin = scenario.joined.origin(f"{field}.move.to" if alone and kind == "step" else field)
    head, _, inside = origin.partition(".")
    return ("cell" if head == OF_CELL else "text"), inside if head in (OF_CELL, OF_TASK) else ""


def _units(text: str, at: int) -> int:
    """How many units of UTF-16 the first characters of a text have."""
    return at + sum(each > "\uffff" for each in text[:at])
