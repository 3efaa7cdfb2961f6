"""Cells with a five-axis arm for the planner's own tests; its links as long as the RV-M1's are said to be."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import box
from assur.planner.model.scene import Follow, Move, Scene, Step, Target
from assur.planner.robots.facts import Limits, RobotBody
from assur.planner.robots.five_axis_arm import FLANGE, LINK4, FiveAxisArm
from assur.planner.robots.tilting import LINK2, LINK3
from tests.planner.cells import cell, solid

HEIGHT, L1, L2, L3 = 0.3, 0.25, 0.16, 0.072
REACH = L1 + L2 + L3
START = (-0.6, 1.2, -1.6, -0.5, 0.3)
"""Elbow up, the hand 0.9 rad below the horizontal."""
DOWN = -math.pi / 2
"""Straight down."""


def five_axis_arm(**changes: Any) -> FiveAxisArm:
    limits = Limits(
        np.array([-2.6, -0.6, -2.2, -1.7, -3.1]),
        np.array([2.6, 1.9, 2.2, 1.7, 3.1]),
        np.array([3.0, 2.5, 3.0, 3.0, 4.0]),
        np.array([25.0, 20.0, 25.0, 25.0, 40.0]),
        np.array([600.0, 500.0, 600.0, 600.0, 900.0]),
    )
    bodies = (
        RobotBody(solid("upper-arm", box(0.24, 0.06, 0.05), 0.12), LINK2),
        RobotBody(solid("forearm", box(0.14, 0.05, 0.04), 0.07), LINK3),
        RobotBody(solid("hand", box(0.05, 0.04, 0.04), 0.02), LINK4),
        RobotBody(solid("face", box(0.02, 0.05, 0.01), -0.011), FLANGE),
    )
    given: dict[str, Any] = {"name": "five", "height": HEIGHT, "l1": L1, "l2": L2, "l3": L3, "limits": limits}
    return FiveAxisArm(**{**given, "bodies": bodies, **changes})


def aim(
    x: float, y: float, z: float, frame: str = "world", pitch: float | None = None, roll: float | None = None
) -> Target:
    """A target; `pitch`, `roll` in rad, free where not given."""
    return Target(frame, Pose(x, y, z), False, pitch, roll)


def goes(target: Target, name: str = "goal", **options: Any) -> Move:
    return Move(name, target, **options)


def follows(target: Target, duration: float = 0.2, name: str = "follow") -> Follow:
    return Follow(name, target, duration)


def five_axis_cell(*task: Step, **more: Any) -> Scene:
    """A scene as `tests.planner.cells.cell` makes it, the elbow staying where it is."""
    return cell(*task, **{"robot": five_axis_arm(), "q": START, "elbow": "keep", **more})
