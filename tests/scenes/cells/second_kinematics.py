"""The motion of an answer by a second kinematics: SciPy's quintic through the knots, and arms written out here."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import fcl
import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BPoly

from assur.planner.checked import check
from assur.planner.checker import Code
from assur.planner.model.digest import digest
from assur.planner.model.outcome import Plan, Planned
from assur.planner.model.scene import Scene
from assur.planner.pipeline import plan
from assur.scenes.requests import cell_of, plan_cell, scene_of
from assur.scenes.scenarios import shipped

Array = NDArray[np.float64]
Document = dict[str, Any]
L1, L2 = 0.325, 0.225
"""Links of the RH-6FRH5520, m; its J3 is the flange's height above the base."""
VELOCITY = np.array([math.radians(400), math.radians(670), 2.4, math.radians(2500)])
ACCELERATION = np.array([125.64, 210.42, 43.02, 785.34])
"""RH-6FRH5520, the maker's driver."""
INSTANTS = 600


@cache
def answer(name: str) -> Document:
    """The answer to a shipped scenario, planned once."""
    scenario = shipped(name)
    with scenario.located():
        return plan_cell(cell_of(scenario.request, folder=scenario.folder), unstated={"report": "full"})


def changed(name: str, change: Callable[[Document], object] = lambda _: None) -> Document:
    """A scenario's request, changed."""
    request: Document = copy.deepcopy(shipped(name).request)
    change(request)
    return request


def path_of(document: Document) -> BPoly:
    """Joints over time of what has a trajectory: an answer, or a neighbour."""
    knots = document["trajectory"]
    states = np.stack([np.array(knots[key]) for key in ("position", "velocity", "acceleration")], axis=1)
    return BPoly.from_derivatives(np.array(knots["time_s"]), states)


def leg(document: Document, kind: str, step: int) -> tuple[float, float]:
    """From when to when the plan has its one leg of this kind for a step."""
    ((begin, end),) = [(x["from_s"], x["to_s"]) for x in document["legs"] if x["kind"] == kind and x["step"] == step]
    return begin, end


def arrival(document: Document, name: str) -> Document:
    """When and how a control point is met."""
    found: Document = next(x for x in document["arrivals"] if x["control_point"] == name)
    return found


class Motion:
    """An RH-6FRH5520 as it runs, standing still before and after its knots."""

    def __init__(
        self, document: Document, *, base: tuple[float, float, float] = (0.0, 0.0, 0.0), tcp: float = -0.1
    ) -> None:
        self.answer, self.curve = document, path_of(document)
        self.times = np.array(document["trajectory"]["time_s"])
        self.span = float(self.times[0]), float(self.times[-1])
        self.base, self.tcp = base, tcp

    def joints(self, t: Array | float, order: int = 0) -> Array:
        """Joints (..., 4), or a derivative of them."""
        return np.asarray(self.curve(np.clip(t, *self.span), nu=order))

    def elbow(self, t: Array) -> tuple[Array, Array]:
        """Elbow (..., 2) and direction of link 2 in the world."""
        q = self.joints(t)
        first = self.base[2] + q[..., 0]
        at = np.array(self.base[:2]) + L1 * np.stack([np.cos(first), np.sin(first)], axis=-1)
        return at, first + q[..., 1]

    def tool(self, t: Array | float) -> Array:
        """x, y, z, yaw (..., 4) of the tool point in the world."""
        at, angle = self.elbow(np.asarray(t))
        q = self.joints(t)
        x, y = at[..., 0] + L2 * np.cos(angle), at[..., 1] + L2 * np.sin(angle)
        return np.stack([x, y, q[..., 2] + self.tcp, angle + q[..., 3]], axis=-1)

    def rate(self, t: Array | float) -> Array:
        """The time derivative of `tool`."""
        w1, w2, v3, w4 = np.moveaxis(self.joints(t, 1), -1, 0)
        first = self.base[2] + self.joints(t)[..., 0]
        second, w12 = first + self.joints(t)[..., 1], w1 + w2
        x = -L1 * np.sin(first) * w1 - L2 * np.sin(second) * w12
        y = L1 * np.cos(first) * w1 + L2 * np.cos(second) * w12
        return np.stack([x, y, v3, w12 + w4], axis=-1)

    def point(self, t: Array) -> Array:
        """Tool point (..., 3) in the world."""
        return self.tool(t)[..., :3]

    def link_2(self, t: Array) -> Array:
        """Corners (T, 4, 2) of the outline of link 2: 385 x 140 mm, its middle 112.5 mm beyond the elbow."""
        at, angle = self.elbow(t)
        along = np.stack([np.cos(angle), np.sin(angle)], axis=1)[:, None]
        across = np.stack([-np.sin(angle), np.cos(angle)], axis=1)[:, None]
        x, y = np.array([-0.08, 0.305, 0.305, -0.08])[:, None], np.array([-0.07, -0.07, 0.07, 0.07])[:, None]
        return np.asarray(at[:, None] + x * along + y * across)


def apart(one: Array, other: Array) -> Array:
    """By how much an edge normal of either rectangle (T, 4, 2) separates the two: a lower bound of their distance."""
    gaps = []
    for corners in (one, other):
        for k in (0, 1):
            edge = corners[:, k + 1] - corners[:, k]
            normal = np.stack([-edge[:, 1], edge[:, 0]], axis=1) / np.linalg.norm(edge, axis=1)[:, None]
            a, b = (np.einsum("tij,tj->ti", each, normal) for each in (one, other))
            gaps += [b.min(1) - a.max(1), a.min(1) - b.max(1)]
    return np.asarray(np.max(gaps, axis=0))


def turn(axis: str, angle: float) -> Array:
    """A turn about an axis, (4, 4)."""
    found, i, j = np.eye(4), ("xyz".index(axis) + 1) % 3, ("xyz".index(axis) + 2) % 3
    c, s = math.cos(angle), math.sin(angle)
    found[[i, j], [i, j]], found[i, j], found[j, i] = c, -s, s
    return found


def shift(x: float, y: float, z: float) -> Array:
    """A shift, (4, 4)."""
    found = np.eye(4)
    found[:3, 3] = x, y, z
    return found


def chain(name: str, q: Array) -> dict[str, Array]:
    """Link frames of a cell's arm, from the maker's joint values and the numbers of the catalogue."""
    if name in ("elbow-arm", "rv-m1"):
        turret = shift(0, 0, 0.3) @ turn("z", q[0])
        upper = turret @ turn("y", -q[1])
        fore = upper @ shift(0.25, 0, 0) @ turn("y", -q[2])
        found = {"base": np.eye(4), "link1": turret, "link2": upper, "link3": fore}
        if name == "elbow-arm":
            return found | {"flange": fore @ shift(0.232, 0, 0)}
        hand = fore @ shift(0.16, 0, 0) @ turn("y", -q[3])
        return found | {"link4": hand, "flange": hand @ shift(0.072, 0, 0) @ turn("x", q[4])}
    if name == "polar-arm":
        turret = shift(0, 0, 0.4) @ turn("z", q[0])
        guide = turret @ turn("y", -q[1])
        ram = guide @ shift(q[2], 0, 0)
        return {"base": np.eye(4), "link1": turret, "link2": guide, "link3": ram, "flange": ram}
    if name == "lab-arm":
        column = turn("z", q[0]) @ shift(0, 0, q[1])
        second = column @ shift(0.22, 0, 0) @ turn("z", q[2])
        return {"flange": second @ shift(0.2, 0, 0) @ turn("z", q[3])}
    assert name == "z-down"
    second = turn("z", q[0]) @ shift(0.25, 0, 0) @ turn("z", q[1])
    return {"flange": second @ shift(0.2, 0, 0.3 - q[2]) @ turn("z", -q[3]) @ np.diag([1.0, -1.0, -1.0, 1.0])}


def closest(name: str) -> float:
    """FCL's least distance, over many instants, of the arm's bodies from the cell's and from each other."""
    scene, path = scene_of(shipped(name).request), path_of(answer(name))
    knots, least = answer(name)["trajectory"]["time_s"], np.inf
    arm = [(scene.robot.links[item.link], item.body.pieces[0]) for item in scene.robot.bodies]
    assert {link for link, _ in arm} <= set(chain(name, path(0.0)))
    for t in np.linspace(knots[0], knots[-1], INSTANTS):
        frames = chain(name, path(t))
        placed = [(link, _placed(piece, frames[link][:3, :3], frames[link][:3, 3])) for link, piece in arm]
        for body in scene.bodies:
            motion = scene.frames[body.frame].law.motion(np.array(t)).at(body.pose)
            other = _placed(body.body.pieces[0], turn("z", float(motion.yaw))[:3, :3], motion.p)
            least = min(least, *(_gap(one, other) for _, one in placed))
        for i, (first, one) in enumerate(placed):
            for second, other in placed[i + 1 :]:
                if (first, second) in scene.robot.self_pairs:
                    least = min(least, _gap(one, other))
    return least


def _placed(piece: Any, turned: Array, at: Any) -> Any:
    x, y, z = (2 * h for h in piece.shape.half)
    shapes = {
        "box": lambda: fcl.Box(x, y, z),
        "cylinder": lambda: fcl.Cylinder(piece.shape.disc, z),
        "capsule": lambda: fcl.Capsule(piece.shape.ball, z),
    }
    pose = fcl.Transform(turned @ piece.rotation, turned @ piece.position + at)
    return fcl.CollisionObject(shapes[str(piece.shape.kind)](), pose)


def _gap(one: Any, other: Any) -> float:
    return float(fcl.distance(one, other, fcl.DistanceRequest(), fcl.DistanceResult()))


@cache
def proof(name: str) -> tuple[Scene, Plan]:
    """A cell's scene and plan."""
    scene = scene_of(shipped(name).request)
    outcome = plan(scene)
    assert isinstance(outcome, Planned)
    return scene, outcome.plan


def forged(name: str, **columns: Any) -> set[Code]:
    """What the checker finds when columns of the proof are others and its digest fits; false rows cover nothing."""
    scene, honest = proof(name)
    other = replace(honest.certificate, **columns)
    parts = (scene.digest, honest.trajectory, honest.legs, honest.arrivals, other)
    verdict = check(scene, replace(honest, certificate=replace(other, digest=digest(*parts))))
    return {finding.code for finding in verdict.findings}
