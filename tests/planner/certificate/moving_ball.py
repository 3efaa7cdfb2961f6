"""A ball on the flange among solids that move: distances in closed form at all times, to hold the prover to."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Motion, Pose
from assur.planner.geometry.shapes import Body, Hull, Piece, box, capsule, cylinder, sphere, support
from assur.planner.laws import Frame, Law, conveyor, keyframes, linear, swing, turntable
from assur.planner.model.outcome import LegKind
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Scene, Tool
from assur.planner.trajectory import Trajectory
from tests.planner.cells import Around, Shape, arm, block, cell, go, rotation, solid
from tests.planner.timing.legs import time_joints

BALL = Pose(0.03, -0.02, -0.05)
"""Where the ball is on the flange."""


def motion(rng: np.random.Generator, legs: int = 2) -> Trajectory:
    """From rest to rest by random joint positions, each passed with a velocity."""
    robot = arm(bare=True)
    limits = robot.limits
    none = np.zeros(4)
    state = (rng.uniform(limits.lower, limits.upper), none, none)
    parts: list[tuple[FloatArray, ...]] = []
    begin = 0.0
    for k in range(legs):
        q = rng.uniform(limits.lower, limits.upper)
        v = none if k == legs - 1 else rng.uniform(-0.3, 0.3, 4) * limits.velocity
        leg = time_joints(*state, q, v, none, limits.velocity, limits.acceleration, limits.jerk, begin=begin)
        assert isinstance(leg, Trajectory)
        knots = leg.time, leg.q, leg.qd, leg.qdd
        parts.append(knots if not parts else tuple(x[1:] for x in knots))
        begin = leg.end
        state = q, v, none
    return Trajectory(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def law(rng: np.random.Generator, kind: str, there: FloatArray, t: float) -> Law:
    """A law of that kind whose frame is near `there` at about time t."""
    x, y, z = (float(v) for v in there)
    yaw = float(rng.uniform(-3, 3))
    if kind == "conveyor":
        return conveyor(Pose(x, y, z, yaw), float(rng.uniform(-0.5, 0.5)), at_time=t)
    if kind == "linear":
        vx, vy, vz = (float(v) for v in rng.uniform(-0.4, 0.4, 3))
        return linear(Pose(x, y, z, yaw), (vx, vy, vz), at_time=t)
    if kind == "turntable":
        return turntable(Pose(x, y, z, yaw), float(rng.uniform(-3, 3)), at_time=t)
    if kind == "swing":
        return swing(Pose(x, y, z, yaw), 0.8, float(rng.uniform(0.4, 2.0)), float(rng.uniform(0, 6)))
    ways = there + rng.normal(size=(5, 3)) * 0.1
    poses = tuple(Pose(float(p[0]), float(p[1]), float(p[2]), yaw + 0.5 * i) for i, p in enumerate(ways))
    return keyframes([-1.0, 0.5, 1.5, 2.5, 8.0], poses)


LAWS = ("world", "conveyor", "linear", "turntable", "swing", "keyframes")
SHAPES = ("box", "sphere", "cylinder", "capsule", "hull")


def shape(kind: str) -> Shape:
    """A solid of some centimetres."""
    known: dict[str, Shape] = {
        "box": box(0.06, 0.1, 0.04),
        "sphere": sphere(0.04),
        "cylinder": cylinder(0.03, 0.08),
        "capsule": capsule(0.02, 0.1),
        "hull": block(0.06, 0.1, 0.04),
    }
    return known[kind]


def outside(piece: Piece, x: FloatArray) -> FloatArray:
    """Distance (T,) of points (T, 3), in the frame of the piece's body, from the piece; 0 inside. Closed forms."""
    local = (x - piece.position) @ piece.rotation
    solid_ = piece.shape
    if isinstance(solid_, Hull):  # a box, as `block` makes them
        half = solid_.vertices.max(0)
        found: FloatArray = np.linalg.norm(np.maximum(np.abs(local) - half, 0.0), axis=1)
        return found
    if solid_.kind == "cylinder":
        across = np.maximum(np.hypot(local[:, 0], local[:, 1]) - solid_.disc, 0.0)
        return np.asarray(np.hypot(across, np.maximum(np.abs(local[:, 2]) - solid_.half[2], 0.0)))
    core = np.linalg.norm(np.maximum(np.abs(local) - np.array(solid_.half), 0.0), axis=1)
    return np.asarray(np.maximum(core - solid_.ball, 0.0))


def ball_at(path: Trajectory, t: FloatArray) -> FloatArray:
    """Where the middle of the ball is, (T, 3)."""
    p, yaw = arm(bare=True).forward(path.evaluate(np.clip(t, path.start, path.end)))
    c, s = np.cos(yaw), np.sin(yaw)
    return np.asarray(p + np.stack([c * BALL.x - s * BALL.y, s * BALL.x + c * BALL.y, 0 * c + BALL.z], -1))


def in_body(moved: Motion, pose: Pose, x: FloatArray) -> FloatArray:
    """World points (T, 3) in the frame of a body at `pose` in a frame that has `moved`."""
    here = moved.at(pose)
    c, s = np.cos(here.yaw), np.sin(here.yaw)
    d = x - here.p
    return np.stack([c * d[:, 0] + s * d[:, 1], -s * d[:, 0] + c * d[:, 1], d[:, 2]], -1)


@dataclass
class Encounter:
    """A motion, and one body that the ball comes near to."""

    path: Trajectory
    around: Around
    frames: tuple[Frame, ...]

    @property
    def law(self) -> Law:
        return next((each.law for each in self.frames if each.name == self.around.frame), STILL)

    def apart(self, t: FloatArray) -> FloatArray:
        """Distance (T,) of the ball's middle from the body."""
        x = in_body(self.law.motion(t), self.around.pose, ball_at(self.path, t))
        return np.asarray(np.min([outside(piece, x) for piece in self.around.body.pieces], axis=0))

    def nearest(self) -> tuple[float, float]:
        """Least distance of the ball's middle, and its time: every 0.1 ms, then every 0.1 µs about the least."""
        t = np.arange(self.path.start, self.path.end, 1e-4)
        t = np.append(t, self.path.end)
        best = float(t[np.argmin(self.apart(t))])
        fine = np.clip(np.linspace(best - 1e-4, best + 1e-4, 2001), self.path.start, self.path.end)
        gaps = self.apart(fine)
        return float(gaps.min()), float(fine[np.argmin(gaps)])

    def scene(self, radius: float, **changes: Any) -> Scene:
        tool = Tool(Pose(), (solid("ball", sphere(radius), BALL.x, BALL.y, BALL.z),))
        return cell(
            go(0.3, 0.0),
            bodies=(self.around,),
            frames=self.frames,
            robot=arm(bare=True),
            tool=tool,
            **changes,
        )

    def phase(self, **changes: Any) -> Phase:
        facts: dict[str, Any] = {"kind": LegKind.MOVE, "step": 0}
        facts |= {"t0": self.path.start, "t1": self.path.end, **changes}
        return Phase(**facts)


STILL = linear(Pose(), (0.0, 0.0, 0.0))


def encounter(seed: int, kind: str, how: str, pieces: int = 1) -> Encounter:
    """A body of that kind, moved by that law, 6 cm or so beside the ball's way at some time."""
    rng = np.random.default_rng(seed)
    path = motion(rng)
    t = float(rng.uniform(path.start, path.end))
    way = rng.normal(size=3)
    there = ball_at(path, np.array([t]))[0] + 0.11 * way / np.linalg.norm(way)
    parts = []
    for k in range(pieces):
        offset = rng.normal(size=3) * (0.0 if pieces == 1 else 0.05)
        turn = rotation(rng) if rng.random() < 0.7 else np.eye(3)
        parts.append(Piece(shape(kind if k == 0 else str(rng.choice(SHAPES))), offset, turn))
    body = Body("thing", tuple(parts))
    if how == "world":
        x, y, z = (float(v) for v in there)
        return Encounter(path, Around(body, "world", Pose(x, y, z, float(rng.uniform(-3, 3)))), ())
    frame = Frame("moving", law(rng, how, there, t))
    return Encounter(path, Around(body, "moving", Pose(0.02, 0.01, 0.0, float(rng.uniform(-3, 3)))), (frame,))


def true_gap(scene: Scene, path: Trajectory, n: FloatArray, t: FloatArray, first: tuple[str, int]) -> FloatArray:
    """Gap (T,) along n from the ball to the piece `first` of a body around, with nothing of the planner's prover."""
    name, number = first
    around = scene.index[name]
    moved = scene.frames[around.frame].law.motion(t).at(around.pose)
    x = ball_at(path, t) @ n
    radius = scene.tool.bodies[0].pieces[0].shape.ball  # type: ignore[union-attr]
    found = []
    for k in range(len(t)):
        c, s = math.cos(moved.yaw[k]), math.sin(moved.yaw[k])
        local = np.array([c * n[0] + s * n[1], -s * n[0] + c * n[1], n[2]])
        pieces = around.body.pieces if number < 0 else (around.body.pieces[number],)
        found.append(float(moved.p[k] @ n) - max(support(piece, -local) for piece in pieces))
    return np.array(found) - x - radius
