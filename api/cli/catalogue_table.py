"""Robots as tables for people: a row per joint, or a row per number with its status."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from rich.table import Table

from assur.api.cli.console_report import row, table
from assur.planner.report.number_format import SHOWN_AS, number

MARKS = {
    "vendor_config": " c",
    "third_party": " t",
    "disputed": " d",
    "measured": " m",
    "estimated": " e",
    None: " ?",
}
"""Marks behind a number that is not the maker's own word; `LEGEND` explains them."""
LEGEND = (
    "c: a maker's configuration file, perhaps a placeholder; t: second hand; d: disputed; m: measured;\n"
    "e: estimated; ?: no status is stated; no mark: the maker's own, or exact by definition\n"
    "unit: of the range; speed, acceleration and jerk are the same per s, s2 and s3\n"
    "reach: from the axis of the first joint to that of the flange, arm straight"
)
NUMBERS = ("lower", "upper", "velocity", "acceleration", "jerk", "zero", "zero_angle")
"""Numbers of a joint; the zero of a lifting one, the zero angle of one that turns."""
LOADS = ("rated_load", "max_load", "max_inertia", "acceleration_by_load")
OF_ARM = ("separation", "proximal", "distal", "l1", "l2", "l3", "height", "base_offset", *LOADS)


def catalogue(robots: list[dict[str, Any]]) -> Table:
    """The robots, a row per joint, in mm, degrees and seconds, each number marked with its status."""
    made = table("robot", ">reach", ">max load", "joint", "unit", ">range", ">speed", ">acceleration", ">jerk")
    for robot in robots:
        load = robot.get("max_load")
        of_robot = [robot["model"], _reach(robot)]
        of_robot.append("" if load is None else f"{load['value']:g} {load['unit']}{_mark(load)}")
        for joint in robot["joints"]:
            lower, upper = joint["lower"], joint["upper"]
            extent = f"{number(_shop(lower)[0], 4)} .. {number(_shop(upper)[0], 4)}{_mark(lower)}"
            rates = (joint[kind] for kind in ("velocity", "acceleration", "jerk"))
            shown = (number(_shop(rate)[0], 4) + _mark(rate) for rate in rates)
            row(made, *of_robot, joint["name"], _shop(lower)[1], extent, *shown)
            of_robot = ["", "", ""]
    return made


def sources(robot: dict[str, Any]) -> Table:
    """Every number of a robot as it was written, with its status and source."""
    made = table("of", "number", ">value", "unit", "status", "source")
    for of, name, quantity in _quantities(robot):
        value = quantity["value"]
        shown = ", ".join(f"{x:g}" for x in (value if isinstance(value, list) else [value]))
        row(made, of, name, shown, quantity["unit"], quantity["status"] or "", quantity["source"] or "")
    solids = robot["solids"]
    if solids["each"]:
        count = f"{len(solids['each'])} solids"
        row(made, robot["model"], count, "", "", solids["status"] or "", solids["source"] or "")
    return made


def _quantities(robot: dict[str, Any]) -> Iterator[tuple[str, str, dict[str, Any]]]:
    for name in OF_ARM:
        if name in robot:
            yield robot["model"], name, robot[name]
    for joint in robot["joints"]:
        for name in NUMBERS:
            if name in joint:
                yield joint["name"], name, joint[name]


def _shop(quantity: dict[str, Any]) -> tuple[float, str]:
    """A length or an angle of a robot, or its rate, in mm or degrees, and which of them; of two sides the left one."""
    name, factor = SHOWN_AS[quantity["unit"].partition("_")[0]]
    value = quantity["value"]
    return (value[0] if isinstance(value, list) else value) * factor, name


def _mark(quantity: dict[str, Any]) -> str:
    return MARKS.get(quantity["status"], "")


def _reach(robot: dict[str, Any]) -> str:
    """How far the flange comes from the shoulder: all links, or, of an arm that extends, its longest extent."""
    links = [robot[key] for key in ("proximal", "distal", "l1", "l2", "l3") if key in robot]
    links = links or [robot["joints"][-1]["upper"]]
    marks = "".join(sorted({_mark(link) for link in links}))
    return f"{number(sum(_shop(link)[0] for link in links), 4)} mm{marks}"
