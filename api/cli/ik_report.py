"""Joint positions of a pose for people: values and margins in tables, in mm and degrees."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from rich.table import Table

from assur.api.cli.console_report import row, table
from assur.planner.report.number_format import SHOWN_AS

ANGLES = ("yaw_rad", "pitch_rad", "roll_rad")


def everything(answer: dict[str, Any]) -> Iterator[Table | str]:
    """The whole answer for people."""
    yield f"{answer['robot']} at {answer['at_s']:.3f} s"
    yield ""
    yield _tool(answer["tool"])
    yield ""
    if answer["solutions"]:
        yield _solutions(answer["solutions"])
        yield ""
    for solution in answer["solutions"]:
        yield from (f"{_name(solution)}: {collision['detail']}" for collision in solution.get("collisions", ()))
    for mode in answer["unreached"]:
        yield f"{mode['mode']}: {mode['detail']}"
    if answer["solutions"] and not any(solution.get("collisions") for solution in answer["solutions"]):
        looked = "collisions" in answer["solutions"][0]
        yield "no collision at rest" if looked else "collisions are not looked for without a request"
    yield ""
    yield answer["notice"]


def _tool(poses: dict[str, dict[str, Any]]) -> Table:
    """The pose of the tool point in every frame."""
    angles = [key for key in ANGLES if key in next(iter(poses.values()))]
    made = table("tool point in", ">x mm", ">y mm", ">z mm", *(f">{key.removesuffix('_rad')} deg" for key in angles))
    for frame, pose in poses.items():
        row(made, frame, *(_shown("m", x) for x in pose["at_m"]), *(_shown("rad", pose[key]) for key in angles))
    return made


def _solutions(solutions: list[dict[str, Any]]) -> Table:
    """Two rows a solution: its joints, and how far each is from the nearer end of its range."""
    keys = {key: key.rpartition("_") for key in solutions[0]["joints"]}
    joints = [f">{name} {SHOWN_AS[unit][0]}" for name, _, unit in keys.values()]
    parallel = [">parallel"] * (solutions[0]["parallel_margin"] is not None)
    made = table("mode", ">turn", "", *joints, ">singularity", *parallel, ">to edge mm")
    for each in solutions:
        turn = "" if each["turn"] is None else each["turn"]
        margins = [f"{each[key]:.3f}" for key in ("singularity_margin", "parallel_margin") if each[key] is not None]
        row(made, each["mode"], turn, "at", *_row(each["joints"]), *margins, _shown("m", each["reach_m"]))
        row(made, "", "", "to limit", *_row({key: min(each["to_limits"][key]) for key in keys}))
    return made


def _row(values: Mapping[str, float]) -> list[str]:
    return [_shown(key.rpartition("_")[2], value) for key, value in values.items()]


def _shown(unit: str, value: float) -> str:
    return f"{value * SHOWN_AS[unit][1]:z.2f}"


def _name(solution: dict[str, Any]) -> str:
    return solution["mode"] if solution["turn"] is None else f"{solution['mode']}, turn {solution['turn']}"
