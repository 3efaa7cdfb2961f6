"""A request with a higher limit of jerk: a motion on a coarse grid is proved against this limit, which is reported."""

from __future__ import annotations

from typing import Any

from assur.scenes.catalogue import shipped_robot
from assur.scenes.schema.robots import FAMILIES

JERKS = ("jerk_rad_s3", "jerk_m_s3", "jerk_deg_s3", "jerk_mm_s3")


def scale_of(request: dict[str, Any], rate: str = "jerk") -> float:
    """The scale that a request sets for the robot's own limits of a rate: velocity, acceleration or jerk."""
    return float((request["robot"].get("limits") or {}).get(rate, 1.0))


def raised(request: dict[str, Any], factor: float) -> dict[str, Any]:
    """The request with `factor` (above 1) times the jerks; it must contain the content of its files.

    A scale of the jerk below 1 is raised; beyond that the arm is written out, with higher jerks.
    """
    robot = dict(request["robot"])
    limits = dict(robot.get("limits") or {})
    scale = scale_of(request) * factor
    limits["jerk"] = min(1.0, scale)
    robot["limits"] = limits
    if scale > 1.0:
        if "model" in robot:
            robot.update(shipped_robot(robot.pop("model")).document)
        family = next(name for name in FAMILIES if name in robot)
        joints = [_raised(joint, scale) for joint in robot[family]["joints"]]
        robot[family] = {**robot[family], "joints": joints}
    return {**request, "robot": robot}


def _raised(joint: dict[str, Any], factor: float) -> dict[str, Any]:
    found = dict(joint)
    for key in JERKS:
        if key in found:
            fact = found[key]
            found[key] = {**fact, "value": factor * fact["value"]} if isinstance(fact, dict) else factor * fact
    return found
