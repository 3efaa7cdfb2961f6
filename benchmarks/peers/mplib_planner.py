"""MPlib: RRTConnect over its own FCL, timed by TOPPRA; run in the environment of the peers.

The arm goes in as URDF with primitives. Goals are all closed-form solutions, which spares MPlib its numerical inverse.
Its trajectory knows limits of velocity and acceleration, none of jerk; it is sampled every 5 ms.
"""

from __future__ import annotations

import tempfile
import time
from importlib.metadata import version
from pathlib import Path
from typing import Any

import mplib
import numpy as np
from mplib import Planner, Pose
from mplib.collision_detection import fcl

from benchmarks.dialogue import Document, answer_lines
from benchmarks.peers.arm import solutions
from benchmarks.translation import A1_M, A2_M, ROBOT_BODIES

STEP_S = 0.005
"""Time between samples of its trajectory."""
JOINTS = ("q1", "q2", "z", "q4")
MIN_POINTS = 2


def urdf(limits: Document) -> str:
    """The problems' arm. Joints q1 and q2 turn, z lifts, q4 turns the quill; its bodies are `ROBOT_BODIES`."""

    def solid(body: Document) -> str:
        ((kind, given),) = body["shape"].items()
        size = {key.removesuffix("_m"): value for key, value in given.items()}
        if kind == "box":
            shape = f'<box size="{" ".join(map(str, size["size"]))}"/>'
        else:
            shape = f'<cylinder radius="{size["radius"]}" length="{size["height"]}"/>'
        at = " ".join(map(str, body["at_m"]))
        return f'<collision><origin xyz="{at}"/><geometry>{shape}</geometry></collision>'

    def link(name: str, body: str = "") -> str:
        inertia = '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
        return f'<link name="{name}"><inertial><mass value="1"/>{inertia}</inertial>{body}</link>'

    def joint(j: int, parent: str, child: str, x: float) -> str:
        kind = "prismatic" if JOINTS[j] == "z" else "revolute"
        bound = f'lower="{limits["qmin"][j]}" upper="{limits["qmax"][j]}" velocity="{limits["vmax"][j]}" effort="1"'
        return (
            f'<joint name="{JOINTS[j]}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
            f'<origin xyz="{x} 0 0"/><axis xyz="0 0 1"/><limit {bound}/></joint>'
        )

    first, second, quill = (solid(body) for body in ROBOT_BODIES)
    return (
        '<?xml version="1.0"?><robot name="scara">'
        + link("base")
        + link("link1", first)
        + link("link2", second)
        + link("lift", quill)
        + link("tool")
        + joint(0, "base", "link1", 0.0)
        + joint(1, "link1", "link2", A1_M)
        + joint(2, "link2", "lift", A2_M)
        + joint(3, "lift", "tool", 0.0)
        + "</robot>"
    )


SRDF = (
    '<?xml version="1.0"?><robot name="scara">'
    + "".join(
        f'<disable_collisions link1="{a}" link2="{b}" reason="Never"/>'
        for a, b in (("link1", "link2"), ("link2", "lift"), ("link1", "lift"))
    )
    + "</robot>"
)
"""The arm cannot reach itself within these limits, and no problem asks."""


class Mplib:
    """The planner with the arm loaded, for one set of limits."""

    def __init__(self, limits: Document) -> None:
        with tempfile.TemporaryDirectory() as folder:
            arm, pairs = Path(folder, "scara.urdf"), Path(folder, "scara.srdf")
            arm.write_text(urdf(limits), encoding="utf-8")
            pairs.write_text(SRDF, encoding="utf-8")
            self.planner = Planner(
                urdf=arm,
                srdf=pairs,
                move_group="tool",
                user_joint_names=list(JOINTS),
                joint_vel_limits=np.array(limits["vmax"]),
                joint_acc_limits=np.array(limits["amax"]),
            )
        self.limits = limits

    def plan(self, problem: Document, budget_s: float) -> dict[str, Any] | None:
        """What `plan_qpos` says among the obstacles of a static problem; None without a goal."""
        world = self.planner.planning_world
        for name in list(world.get_object_names()):
            world.remove_object(name)
        for i, obstacle in enumerate(problem["obstacles"]):
            if obstacle["type"] == "box":
                shape = fcl.Box(np.array(obstacle["size"]))
            else:
                shape = fcl.Cylinder(obstacle["radius"], obstacle["height"])
            half = obstacle["yaw"] / 2
            pose = Pose(np.array(obstacle["pos"]), np.array([np.cos(half), 0.0, 0.0, np.sin(half)]))
            world.add_object(f"obstacle {i}", fcl.CollisionObject(shape, pose))
        goals = solutions(problem["goal"]["pos"], problem["goal"]["yaw"], self.limits)
        if not goals:
            return None
        start, every = np.array(problem["start"]), [np.array(goal) for goal in goals]
        return self.planner.plan_qpos(every, start, planning_time=budget_s, time_step=STEP_S)  # type: ignore[no-any-return]


class Answers:
    """The answering end: the arm is loaded once for each set of limits, outside of the time."""

    def __init__(self) -> None:
        self.loaded: Mplib | None = None

    def __call__(self, question: Document) -> Document:
        limits = question["limits"]
        if self.loaded is None or self.loaded.limits != limits:
            self.loaded = Mplib(limits)
        mplib.set_global_seed(question["seed"] + 1)  # 0 is no seed to OMPL
        began = time.perf_counter()
        try:
            found = self.loaded.plan(question["problem"], question["budget_s"])
        except RuntimeError as error:
            return {"status": "not_planned", "reason": str(error)}
        elapsed = time.perf_counter() - began
        if found is None or found["status"] != "Success" or len(found["time"]) < MIN_POINTS:
            reason = "no goal within the limits" if found is None else str(found["status"])
            return {"status": "not_planned", "reason": reason}
        columns = {"time_s": found["time"]} | {name: found[name] for name in ("position", "velocity", "acceleration")}
        return {
            "status": "planned",
            "first_s": elapsed,
            "duration_s": float(found["duration"]),
            "trajectory": {name: values.tolist() for name, values in columns.items()},
        }


def prepare() -> tuple[Document, Any]:
    """Ready at once: the arm comes with the first question."""
    return {"version": version("mplib")}, Answers()


if __name__ == "__main__":
    answer_lines(prepare)
