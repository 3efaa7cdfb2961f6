"""The robots that are shipped as a table for people, each number marked with what vouches for it."""

from __future__ import annotations

from typing import Any

from rich.table import Table

from assur.api.amounts import SHOWN_AS, number
from assur.api.words import row, table

MARKS = {"vendor_config": " c", "third_party": " t", "disputed": " d", "estimated": " e"}
"""Marks behind a number of the catalogue that is not the maker's own word; `LEGEND` explains them."""
LEGEND = (
    "c: a maker's configuration file, perhaps a placeholder; t: second hand; d: disputed; e: estimated; else as told\n"
    "unit: of the range; speed, acceleration and jerk are the same per s, s2 and s3\n"
    "reach: from the axis of the first joint to that of the flange, arm straight"
)


def catalogue(robots: list[dict[str, Any]]) -> Table:
    """The robots, a row per joint, in mm, degrees and seconds, each number marked with its status."""
    made = table("robot", ">reach", ">payload", "joint", "unit", ">range", ">speed", ">acceleration", ">jerk")
    for robot in robots:
        payload = robot.get("payload")
        of_robot = [robot["model"], _reach(robot)]
        of_robot.append("" if payload is None else f"{payload['value']:g} {payload['unit']}{_mark(payload)}")
        for joint in robot["joints"]:
            lower, upper = joint["lower"], joint["upper"]
            extent = f"{number(_shop(lower)[0], 4)} .. {number(_shop(upper)[0], 4)}{_mark(lower)}"
            rates = (joint[kind] for kind in ("velocity", "acceleration", "jerk"))
            shown = (number(_shop(rate)[0], 4) + _mark(rate) for rate in rates)
            row(made, *of_robot, joint["name"], _shop(lower)[1], extent, *shown)
            of_robot = ["", "", ""]
    return made


def _shop(quantity: dict[str, Any]) -> tuple[float, str]:
    """A length or an angle of the catalogue, or its rate, in mm or degrees, and which of them."""
    name, factor = SHOWN_AS[quantity["unit"].partition("_")[0]]
    return quantity["value"] * factor, name


def _mark(quantity: dict[str, Any]) -> str:
    return MARKS.get(quantity["status"], "")


def _reach(robot: dict[str, Any]) -> str:
    """How far the flange comes from the shoulder: all links, or, of an arm that extends, its longest extent."""
    links = [robot[key] for key in ("l1", "l2", "l3") if key in robot] or [robot["joints"][-1]["upper"]]
    marks = "".join(sorted({_mark(link) for link in links}))
    return f"{number(sum(_shop(link)[0] for link in links), 4)} mm{marks}"
