"""Robots in files: those that are shipped, by name, and a user's own. Both are one kind of document, read alike."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from assur.planner.errors import FaultError, InputError
from assur.scenes.bounds import MAX_YAML_BYTES
from assur.scenes.faults import DocumentError, dotted, likeliest, located, raised_as, within
from assur.scenes.files import below, empty, with_meshes
from assur.scenes.not_requests import refuse_but
from assur.scenes.robot_facts import assumptions, listed
from assur.scenes.schema.read import read
from assur.scenes.schema.robots import FAMILIES, Arm, ArmDocument, Family
from assur.scenes.text.yaml_text import parse_yaml, with_line

if TYPE_CHECKING:
    from assur.scenes.reading.arms import BuiltArm

FOLDER = Path(__file__).parent / "robots"
"""The shipped robots."""
ENDINGS = (".yaml", ".yml")
WHOLE = ("scenario", "request")
"""How errors call a document as a whole."""


@dataclass(frozen=True, eq=False)
class RobotFile:
    """The content of a robot's file: the document, with the mesh files that it names in their place, and its arm."""

    document: dict[str, Any]
    family: Family
    arm: Arm

    def built(self) -> BuiltArm:
        """The arm for the planner. Raises `DocumentError` at the field that has no meaning."""
        from assur.scenes.reading.arms import built

        with located(self.document), within(self.family):
            return built(self.family, self.arm)

    @cached_property
    def assumptions(self) -> tuple[str, ...]:
        """A sentence for each number that the maker does not publish."""
        return assumptions(self.family, self.document[self.family])

    def listed(self) -> dict[str, Any]:
        """The arm as plain data, each number with unit, status and source."""
        return listed(self.family, self.document[self.family])


@lru_cache(maxsize=1)
def models() -> tuple[str, ...]:
    """Names of the shipped robots."""
    return tuple(sorted(path.stem for path in FOLDER.glob("*.yaml")))


@lru_cache(maxsize=32)
def shipped_robot(model: str) -> RobotFile:
    """A shipped robot, read once. Raises `InputError` for a name that is none; no other file is ever opened."""
    if model not in models():
        raise InputError("robot.model", model, f"one of {likeliest(model, models())}")
    return _robot_file(parse_yaml((FOLDER / f"{model}.yaml").read_bytes())[0])


@lru_cache(maxsize=32)
def arm_named(model: str) -> BuiltArm:
    """A shipped robot for the planner, built once. Raises `InputError` for a name that is none."""
    return shipped_robot(model).built()


def robots() -> list[dict[str, Any]]:
    """Every shipped robot as plain data, each number with unit, status and source."""
    return [shipped_robot(model).listed() for model in models()]


def load_robot(path: Path) -> RobotFile:
    """The robot in a user's YAML file; mesh files that it names must lie below its folder.

    Raises `DocumentError` with the name of the file, the field and the line, or `OSError` for a file that is not there.
    """
    try:
        allowed = f"a robot: YAML with one of {', '.join(FAMILIES)}"
        with path.open("rb") as file:
            data = file.read(MAX_YAML_BYTES + 1)
        refuse_but("a robot's file", data, path, allowed)
        document, lines = parse_yaml(data)
        if document is None:
            raise empty(path, allowed)
        with raised_as(lambda error: with_line(error, lines)):
            found = _robot_file(with_meshes(document, path.parent))
            found.built()
    except DocumentError as error:
        own = (*WHOLE, path.name)
        raise error.relocated(lambda field: path.name if field in own else f"{path.name}: {field}") from error
    return found


def _robot_file(document: Any) -> RobotFile:
    given = read(ArmDocument, document).written_out()
    if given is None:
        raise FaultError("a document without an arm was taken for one")
    return RobotFile(document, *given)


def with_robots(request: Any, folder: Path) -> Any:
    """The request with the content of each robot's file in place of its name; the files must be below `folder`."""
    if not isinstance(request, dict):
        return request
    found = {**request, "robot": _with_robot(request["robot"], ("robot",), folder)} if "robot" in request else request
    neighbours = request.get("neighbours")
    if isinstance(neighbours, list):
        others = [
            {**other, "robot": _with_robot(other["robot"], ("neighbours", i, "robot"), folder)}
            if isinstance(other, dict) and "robot" in other
            else other
            for i, other in enumerate(neighbours)
        ]
        found = {**found, "neighbours": others}
    return found


def _with_robot(robot: Any, path: tuple[str | int, ...], folder: Path) -> Any:
    if not isinstance(robot, dict) or not isinstance(robot.get("file"), str) or {"model", *FAMILIES} & robot.keys():
        return robot  # nothing to put in, or a document that its model refuses
    file = below(folder, robot["file"], dotted((*path, "file")), ENDINGS, MAX_YAML_BYTES)
    return {**{key: value for key, value in robot.items() if key != "file"}, **load_robot(file).document}
