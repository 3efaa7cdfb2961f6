"""OMPL's RRTConnect with an FCL world of ours as its checker; run in the environment of the peers.

Goals are all closed-form solutions. The path is simplified, then driven straight from point to point, stopping at each:
a phase over each piece, timed by Ruckig under the joint limits of velocity, acceleration and jerk, which is the least
that makes a path something an arm can follow.
"""

from __future__ import annotations

import time
from importlib.metadata import version
from itertools import pairwise
from typing import Any

import fcl
import numpy as np
import ruckig
from ompl import base, geometric, util

from benchmarks.dialogue import Document, answer_lines
from benchmarks.peers.arm import solutions
from benchmarks.translation import A1_M, A2_M, ROBOT_BODIES, Terms, request

RESOLUTION = 0.001
"""Share of the space's extent (14 rad) between states that OMPL checks along a motion: at most 9 mm of the tool. At its
default, ten times as much, one path in six goes through an edge."""


def geometry_of(body: Document) -> Any:
    """A box or an upright cylinder as `fcl` has it: static problems have no others."""
    ((kind, given),) = body["shape"].items()
    if kind == "box":
        return fcl.Box(*given["size_m"])
    return fcl.Cylinder(given["radius_m"], given["height_m"])


def placed(c: float, s: float, at: Any) -> Any:
    """Where a body is that is turned about the vertical, by cosine and sine."""
    return fcl.Transform(np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]), np.array(at))


class World:
    """The obstacles of a static problem at their places, and the three bodies of the arm."""

    def __init__(self, problem: Document, limits: Document) -> None:
        self.request = fcl.CollisionRequest()
        self.arm = [fcl.CollisionObject(geometry_of(body)) for body in ROBOT_BODIES]
        self.obstacles = []
        for body in request(problem, limits, Terms())["bodies"]:
            yaw = body["pose"]["yaw_rad"]
            where = placed(np.cos(yaw), np.sin(yaw), body["pose"]["at_m"])
            self.obstacles.append(fcl.CollisionObject(geometry_of(body), where))

    def free(self, q: list[float]) -> bool:
        """Whether the arm touches nothing."""
        c1, s1 = np.cos(q[0]), np.sin(q[0])
        c2, s2 = np.cos(q[0] + q[1]), np.sin(q[0] + q[1])
        elbow = np.array([A1_M * c1, A1_M * s1, 0.0])
        links = (
            (c1, s1, np.zeros(3)),
            (c2, s2, elbow),
            (1.0, 0.0, elbow + np.array([A2_M * c2, A2_M * s2, q[2]])),
        )
        for body, spelt, (c, s, origin) in zip(self.arm, ROBOT_BODIES, links, strict=True):
            along, _, up = spelt["at_m"]
            body.setTransform(placed(c, s, origin + np.array([along * c, along * s, up])))
            for obstacle in self.obstacles:
                if fcl.collide(body, obstacle, self.request, fcl.CollisionResult()):
                    return False
        return True


def path(problem: Document, limits: Document, budget_s: float) -> tuple[list[list[float]], float] | None:
    """The points of a simplified path, and the seconds until there was any path."""
    began = time.perf_counter()
    world = World(problem, limits)
    space = base.RealVectorStateSpace(4)
    bounds = base.RealVectorBounds(4)
    for j in range(4):
        bounds.setLow(j, limits["qmin"][j])
        bounds.setHigh(j, limits["qmax"][j])
    space.setBounds(bounds)
    setup = geometric.SimpleSetup(space)
    setup.setStateValidityChecker(lambda state: world.free([state[j] for j in range(4)]))
    information = setup.getSpaceInformation()
    information.setStateValidityCheckingResolution(RESOLUTION)
    start = space.allocState()
    for j in range(4):
        start[j] = problem["start"][j]
    setup.setStartState(start)
    goal = base.GoalStates(information)
    for q in solutions(problem["goal"]["pos"], problem["goal"]["yaw"], limits):
        state = space.allocState()
        for j in range(4):
            state[j] = q[j]
        goal.addState(state)
    if not goal.getStateCount():
        return None
    setup.setGoal(goal)
    setup.setPlanner(geometric.RRTConnect(information))
    setup.solve(budget_s)
    if not setup.haveExactSolutionPath():
        return None
    first = time.perf_counter() - began
    setup.simplifySolution(max(0.01, budget_s - first))
    found = setup.getSolutionPath()
    states = [found.getState(i) for i in range(found.getStateCount())]
    return [[float(state[j]) for j in range(4)] for state in states], first


def stopping(points: list[list[float]], limits: Document) -> Document:
    """The trajectory from point to point, at rest at each; knots wherever a jerk changes."""
    rows: list[tuple[float, Any, Any, Any]] = [(0.0, np.array(points[0]), np.zeros(4), np.zeros(4))]
    now = 0.0
    for a, b in pairwise(points):
        origin, way = np.array(a), np.array(b) - np.array(a)
        if not np.abs(way).max() > 1e-9:
            continue
        phase = ruckig.InputParameter(1)
        phase.target_position = [1.0]
        for kind, name in (("vmax", "max_velocity"), ("amax", "max_acceleration"), ("jmax", "max_jerk")):
            least = min(limit / abs(d) for limit, d in zip(limits[kind], way, strict=True) if d)
            setattr(phase, name, [least * (1 - 1e-6)])
        driven = ruckig.Trajectory(1)
        if ruckig.Ruckig(1).calculate(phase, driven) != ruckig.Result.Working:
            raise RuntimeError("Ruckig has no motion from rest to rest")
        profile = driven.profiles[0][0]
        switches = sorted({round(t, 12) for t in [*np.cumsum(profile.t), driven.duration] if t > 1e-6})
        for t in switches:
            s, sd, sdd = (values[0] for values in driven.at_time(t))
            rows.append((now + t, origin + s * way, sd * way, sdd * way))
        rows[-1] = (now + driven.duration, np.array(b), np.zeros(4), np.zeros(4))
        now += driven.duration
    time_s, *columns = zip(*rows, strict=True)
    names = ("position", "velocity", "acceleration")
    made = {name: [row.tolist() for row in column] for name, column in zip(names, columns, strict=True)}
    return {"time_s": list(time_s), **made}


def answer(question: Document) -> Document:
    """The answer to one problem: status, times, trajectory."""
    util.RNG.setSeed(question["seed"] + 1)  # 0 is no seed to OMPL
    began = time.perf_counter()
    found = path(question["problem"], question["limits"], question["budget_s"])
    if found is None:
        return {"status": "not_planned", "reason": "no path in the budget"}
    points, first = found
    trajectory = stopping(points, question["limits"])
    return {
        "status": "planned",
        "path_s": first,
        "first_s": time.perf_counter() - began,
        "duration_s": trajectory["time_s"][-1],
        "trajectory": trajectory,
    }


def prepare() -> tuple[Document, Any]:
    """Warm: one problem that has nothing in its way."""
    util.setLogLevel(util.LOG_NONE)
    return {"version": version("ompl")}, answer


if __name__ == "__main__":
    answer_lines(prepare)
