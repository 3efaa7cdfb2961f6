"""What the command line was pointed at: a scenario file, a bare request, a shipped scenario, a plan."""

from __future__ import annotations

import json
import math
import os
import sys
from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from assur.api.web.settings import Settings
from assur.planner.errors import InputError
from assur.scenes.bounds import MAX_LOG_BYTES, MAX_PLAN_FILE_BYTES
from assur.scenes.faults import NOTHING, WHOLE, DocumentError, choices, likeliest
from assur.scenes.files import is_file, is_json, json_in, json_of
from assur.scenes.meshes import use_folder
from assur.scenes.motion_log import MotionLog, load_log
from assur.scenes.plan_file import PlanFile, in_request, is_plan_file, plan_file_in
from assur.scenes.requests import (
    RobotFile,
    Scenario,
    cell_of,
    load_robot,
    load_scenario,
    models,
    parse_json,
    plan_cell,
    shipped,
    shipped_robot,
    shipped_scenarios,
    unmet,
)
from assur.scenes.scenario import set_in_request, with_files
from assur.scenes.set_values import GIVEN, Changed
from assur.scenes.tasks.next_task import EndState, checked_end
from assur.scenes.units import si_key, twin_of

if TYPE_CHECKING:
    from assur.scenes.reading.cell import Cell


STANDARD = "-"
"""Names standard input where a file is read, and standard output where one is written."""

SET = (
    "Set a value of FILE by its path: --set options.seed=3. VALUE is JSON. May be repeated; the last counts. In a task "
    "file, paths that begin with start, parts, steps or options are its own; all others are those of its cell."
)
Values = Annotated[list[str] | None, typer.Option("--set", metavar="PATH=VALUE", help=SET)]
"""The option of all commands that take a cell."""

AFTER = "FILE is a task without a start: it begins where the plan in this file ends."
After = Annotated[Path | None, typer.Option("--continue", help=AFTER)]
"""The option of the commands that plan a task, or take it with its plan."""

UNSTATED = {"explain_budget_s": 2.0, "report": "full"}
"""Options of a request that does not state them: `assur plan` explains and reports more than other callers need."""


@dataclass(frozen=True)
class Target:
    """A request to plan: its `name` for people, the document, the folder below which it may name files (None: it may
    not), and the scenario, or the plan file, that it came from, if it came from one."""

    name: str
    request: Any
    folder: Path | None
    scenario: Scenario | None = None
    plan_file: PlanFile | None = None
    changed: Changed | None = None
    """The request with the values that were set in it, where no scenario knows them."""

    @property
    def title(self) -> str:
        """What the cell is called: what a plan file says, else the name."""
        return self.name if self.plan_file is None else self.plan_file.title or self.name

    @property
    def about(self) -> str:
        """Why the cell exists, or nothing."""
        source = self.scenario or self.plan_file
        return "" if source is None else source.about

    @property
    def starts_at_a_pose(self) -> bool:
        """Whether its start is a pose of the tool, so that reading it takes the kernels."""
        start = self.request.get("start") if isinstance(self.request, dict) else None
        return isinstance(start, dict) and "tool" in start

    @cached_property
    def cell(self) -> Cell:
        """The request, read, and nothing planned. Raises `InputError`, with the line in a scenario's file."""
        use_folder(Settings.of_meshes(os.environ).folder_of_meshes())
        with self._located():
            return cell_of(self.request, folder=self.folder)

    @property
    def whole(self) -> Any:
        """The request with what the files hold that it names. Raises `InputError`, as `cell` does."""
        with self._located():
            return self.request if self.folder is None else with_files(self.request, self.folder)

    def plan(self) -> dict[str, Any]:
        """The answer, with its certificate in full. Raises `InputError`, with the line in a scenario's file."""
        cell = self.cell
        with self._located():
            answer = plan_cell(cell, unstated=UNSTATED)
        return answer if self.scenario is None else self.scenario.answered(answer)

    def _located(self) -> AbstractContextManager[None]:
        if self.changed is not None:
            return self.changed.located()
        if self.plan_file is not None:
            return in_request()
        return nullcontext() if self.scenario is None else self.scenario.located()

    def with_values(self, given: Mapping[str, object]) -> Target:
        """The same with values that are set by their paths, and faults of them at `GIVEN`. Raises `InputError`."""
        if not given:
            return self
        if self.scenario is not None:
            scenario = self.scenario.with_values(given)
            return replace(self, request=scenario.request, scenario=scenario)
        if not isinstance(self.request, dict):
            return self  # no request: refused where it is read
        changed = set_in_request(self.request, given)
        return replace(self, request=changed.document, changed=changed)

    def unmet(self, answer: dict[str, Any]) -> list[str]:
        """What of the scenario's `expect` the answer does not hold."""
        return [] if self.scenario is None else unmet(self.scenario.expect, answer)


def target(text: str, values: list[str] | None = None, after: Path | None = None) -> Target:
    """What `text` names: a file (a scenario or a task in YAML, a request in JSON, or a plan file, whose request
    counts), - for a request or a plan file on standard input, else a shipped scenario. `values`: ``PATH=VALUE`` each,
    which are set in it. `after`: the plan file where it begins, which is then a task file.

    Raises `InputError`, or `OSError` for a file that cannot be read.
    """
    given = set_values(values)
    return _target(text).with_values(given) if after is None else _continued(text, after, given)


def set_values(texts: list[str] | None) -> dict[str, object]:
    """Values that are set, by their paths, from ``PATH=VALUE`` each, where VALUE is JSON; the last of a path counts.
    Raises `InputError`."""
    found: dict[str, object] = {}
    for text in texts or ():
        path, mark, value = text.partition("=")
        if not (mark and path.strip()):
            raise InputError("--set", text, "a path, = and a value in JSON, as in --set options.seed=3")
        try:
            read = parse_json(value.encode("utf-8", "surrogatepass"))
        except InputError as error:
            allowed = f"JSON, such as 3, [1, 2] or true; {_meant(path, value)}"
            raise InputError(f"{GIVEN}{path}", value, allowed) from error
        found.pop(path, None)
        found[path] = read
    return found


def _meant(path: str, value: str) -> str:
    """What was probably meant by a value that is no JSON, as it has to be written."""
    if value.startswith("{"):
        return f"""keys are in double quotes, as in --set '{path}={{"mm": 30}}'"""
    if value.lower() in ("true", "false"):
        return f"write --set {path}={value.lower()}"
    parts = [part.strip() for part in value.strip("()[] ").split(",")]
    try:
        numbers = [f"{float(part):.12g}" for part in parts]
    except ValueError:
        return f"text in double quotes, as in --set '{path}={json.dumps(value)}'"
    if not all(math.isfinite(float(number)) for number in numbers):
        return "every number must be finite"
    if len(numbers) == 1:
        return f"write --set {path}={numbers[0]}"
    return f"a list is in brackets, as in --set '{path}=[{', '.join(numbers)}]'"


def _continued(text: str, after: Path, given: Mapping[str, object]) -> Target:
    """The task in a file that begins where the plan in the plan file `after` ends, with values that are `given`: the
    cell with them is that of the plan."""
    path = Path(text)
    if text == STANDARD or not is_file(path) or is_json(path):
        raise InputError("FILE", text, "with --continue a task file (YAML) that exists")
    scenario = load_scenario(path, _end_of(after), given)
    return Target(scenario.name, scenario.request, scenario.folder, scenario)


def _target(text: str) -> Target:
    path = Path(text)
    if text != STANDARD and not is_file(path):
        if text not in shipped_scenarios():
            known = choices(shipped_scenarios(), text)
            raise InputError("FILE", text, f"a file that exists, or a shipped scenario (`assur scenes`): {known}")
        scenario = shipped(text)
    elif text == STANDARD or is_json(path):
        return _json_target(path)
    else:
        scenario = load_scenario(path)
    return Target(scenario.name, scenario.request, scenario.folder, scenario)


def _end_of(path: Path) -> EndState:
    """The state in which the plan in a plan file ends; the plan is checked. Raises `InputError` that names --continue,
    or `OSError`."""
    try:
        held = plan_file_in(json_file(path, "--continue", "a plan file"))
        with in_request():
            return checked_end(held.request, held.plan)
    except InputError as error:
        if error.field == "--continue":
            raise
        raise InputError(f"--continue: {error.field}", error.value, error.allowed) from error


def _json_target(path: Path) -> Target:
    document = json_file(path, "FILE", "a request or a plan file")
    name = "standard input" if str(path) == STANDARD else path.stem
    if is_plan_file(document):
        held = plan_file_in(document)
        return Target(name, held.request, None, plan_file=held)
    return Target(name, document, None if str(path) == STANDARD else path.parent)


def robot_named(text: str) -> RobotFile:
    """The robot that `text` names: one in a file, else a shipped one.

    Raises `InputError`, or `OSError` for a file that cannot be read.
    """
    path = Path(text)
    if is_file(path):
        return load_robot(path)
    if text not in models():
        raise InputError("ROBOT", text, f"a file that exists, or a shipped robot: {likeliest(text, models())}")
    return shipped_robot(text)


def robot_in_place(text: str, cell: Cell | None) -> dict[str, Any]:
    """The robot that `text` names (`robot_named`), with tool point and base of the robot of `cell`, if there is one."""
    document: Any = {} if cell is None else cell.document
    own = document.get("robot", {})
    tool = {key: value for key, value in own.get("tool", {"tcp_mm": [0, 0, 0]}).items() if key.startswith("tcp")}
    base = {"base": own["base"]} if "base" in own else {}
    return {**robot_named(text).document, "tool": tool, **base}


def joints_in(text: str) -> dict[str, float]:
    """Joint values with their units, from ``j1_deg=17,j2_deg=68,j3_mm=250``. Raises `InputError`."""
    allowed = "joints with their units and values, as in j1_deg=17,j2_deg=68,j3_mm=250"
    found: dict[str, float] = {}
    for part in text.split(","):
        name, _, value = (word.strip() for word in part.partition("="))
        try:
            number = float(value)
        except ValueError as error:
            raise InputError("--joints", part, allowed) from error
        if name in found:
            raise InputError("--joints", part, f"{name} once")
        found[name] = number
    return found


OPTIONS = {"at_m": "--at-mm", "yaw_rad": "--yaw-deg", "pitch_rad": "--pitch-deg", "roll_rad": "--roll-deg"}
"""Options of `ik` by the key of the pose that each gives."""


@contextmanager
def named_as_options() -> Iterator[None]:
    """An error in the question of `ik` names the option that is wrong, as it is written there."""
    try:
        yield
    except InputError as error:
        about, _, key = error.field.partition(".")
        si = (si_key(key) or (key,))[0]
        if about == "joints" and error.value is NOTHING:
            allowed = f"all joints, {key} (or {twin_of(key)}) among them, as in j1_deg=17,j2_deg=68,j3_mm=250"
            raise InputError("--joints", NOTHING, allowed) from error
        if about == "pose" and si in OPTIONS and error.value is NOTHING:
            of, axis = OPTIONS[si], si.removesuffix("_rad")
            allowed = f"a number, which must be given: the joints are found for a pose with its {axis}"
            raise InputError(of, NOTHING, allowed) from error
        if about == "pose" and (si in OPTIONS or key == "frame"):
            raise InputError(OPTIONS.get(si, f"--{key}"), error.value, error.allowed) from error
        raise


def log_file(path: Path) -> MotionLog:
    """The recorded motion in a file. Raises `InputError`, with the line, or `OSError`."""
    if not is_file(path):
        raise InputError("LOG", str(path), "a file that exists")
    return load_log(path)


def text_file(path: Path, name: str) -> str:
    """The text in the file that was given as `name`. Raises `InputError`, with the line, or `OSError`."""
    if not is_file(path):
        raise InputError(name, str(path), "a file that exists")
    with path.open("rb") as file:
        data = file.read(MAX_LOG_BYTES + 1)
    if len(data) > MAX_LOG_BYTES:
        raise InputError(name, f"more than {MAX_LOG_BYTES} bytes", f"at most {MAX_LOG_BYTES} bytes")
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise DocumentError(name, f"byte {error.start} of the file", "text in UTF-8", line) from None


def json_file(path: Path, name: str, what: str) -> Any:
    """The document in the JSON file (-: on standard input) that was given as `name`, which should hold `what`.

    Raises `InputError` or `OSError`.
    """
    if str(path) != STANDARD and not is_file(path):
        raise InputError(name, str(path), "a file that exists, or - for standard input")
    allowed = f"{what}, as JSON"
    try:
        if str(path) != STANDARD:
            return json_in(path, allowed)
        return json_of(sys.stdin.buffer.read(MAX_PLAN_FILE_BYTES + 1), "standard input", allowed)
    except InputError as error:
        if error.field != WHOLE:
            raise  # it names the file, or the field in it
        raise InputError(name, error.value, allowed if error.allowed == "JSON" else error.allowed) from error


def given_options(options: dict[str, Any]) -> dict[str, Any]:
    """The options that were given."""
    return {key: value for key, value in options.items() if value is not None}


def pairs_in(option: str, texts: list[str] | None, allowed: str) -> dict[str, str]:
    """What an option that may be repeated says, ``NAME=VALUE`` each. Raises `InputError`."""
    found: dict[str, str] = {}
    for text in texts or ():
        name, mark, value = text.partition("=")
        if not (mark and name and value) or name in found:
            raise InputError(option, text, f"{allowed}, each name once")
        found[name] = value
    return found
