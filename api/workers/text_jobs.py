"""The texts of scenarios, cells and tasks: what `POST /v1/scenes/parse` has a worker do."""

from __future__ import annotations

from typing import Any

from assur.api.workers.jobs import not_allowed, of_body
from assur.planner.errors import InputError
from assur.scenes.proposals.texts import Texts, with_request_values, with_shift
from assur.scenes.requests import cell_of
from assur.scenes.scenario import Scenario, with_files
from assur.scenes.scenarios import CELLS, scenario_in
from assur.scenes.tasks.places import places_of
from assur.scenes.tasks.task_file import scenario_of_texts

TEXT = (
    'an object with the fields "text", a scenario in YAML, or "cell", a cell in YAML, or both, and, if it likes, '
    '"draw", "set", "move"'
)
"""What the body is."""
NAMES = ("text", "cell")
"""Fields that are texts."""


@of_body(TEXT, "build", "status")
def parse(document: dict[str, Any]) -> dict[str, Any]:
    """What the scenario in {"text": YAML} means: why it exists, and its request with what the shipped files hold that
    it names. With {"cell": YAML} the text is a task of that cell; without a text it is a cell that has no request yet.
    With {"draw": true} also the view of the cell, where the arm stands at its start,
    and where what it shows is written. All faults that show without
    planning are reported now, each with its line.

    With {"set": {PATH: VALUE}}, values of the request, or {"move": {...}}, a body or step that is moved, the texts are
    changed first; the answer has them."""
    given = {"draw": False, **document}
    if not given.keys() <= {*NAMES, "draw", "set", "move"} or not {*NAMES} & document.keys():
        raise not_allowed(document, TEXT)
    for name in NAMES:
        if name in document and not isinstance(given[name], str):
            raise InputError(name, given[name], "a text")
    if not isinstance(given["draw"], bool):
        raise InputError("draw", given["draw"], "true or false")
    texts: Texts = {name: given[name] for name in NAMES if name in given}
    scenario = _scenario_in(texts)
    if "set" in given:
        texts = with_request_values(scenario, texts, given["set"], _scenario_in)
        scenario = _scenario_in(texts)
    with scenario.located():
        cell = cell_of(scenario.request, folder=scenario.folder)
    if "move" in given:
        texts = with_shift(scenario, texts, cell, given["move"], _scenario_in)
        scenario = _scenario_in(texts)
    with scenario.located():
        if "move" in given:
            cell = cell_of(scenario.request, folder=scenario.folder)
        request = with_files(scenario.request, scenario.folder)
    found: dict[str, Any] = {"status": "cell", "about": scenario.about}
    found |= {"status": "parsed", "request": request} if "text" in texts else {}
    found |= texts if {"set", "move"} & given.keys() else {}
    if given["draw"]:
        from assur.scenes.view.document import view_of

        found["view"] = view_of(cell, None)
        found["places"] = places_of(scenario, texts.get("text"), texts.get("cell"))
        if "text" not in texts and "name" not in scenario.request["task"][0]["move"]:  # a cell without positions
            found["view"]["control_points"] = []
    return found


def _scenario_in(texts: Texts) -> Scenario:
    """The scenario of a text, or of a task and a cell, or of a cell alone."""
    path = CELLS / "text"
    text, cell = (None if name not in texts else texts[name].encode("utf-8", "surrogatepass") for name in NAMES)
    return scenario_in(text or b"", path) if cell is None else scenario_of_texts(text, cell, path)
