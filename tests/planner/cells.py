"""Cells for the planner's own tests: a SCARA like the benchmark's, its tools, and small builders of what stands around.

The flange of `arm` is between 50 and 250 mm high and reaches from 50 mm (folded) to 600 mm (stretched).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.collision.bodies import Bodies
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import AXES, Body, Hull, Piece, Primitive, box, capsule, cylinder, sphere
from assur.planner.laws import Frame, Law, Uncertainty, conveyor, fixed, linear, swing, turntable
from assur.planner.model.attachments import AT_START
from assur.planner.model.refusal import Refusal
from assur.planner.model.scene import (
    Clearance,
    Execution,
    Follow,
    Move,
    Options,
    Pick,
    Place,
    Scene,
    Start,
    Step,
    Target,
    Tool,
)
from assur.planner.model.scene import WorldBody as Around
from assur.planner.robots.facts import Limits, RobotBody
from assur.planner.robots.robot import Robot
from assur.planner.robots.scara import BASE, LINK1, LINK2, QUILL, Scara
from tests.planner.second_solids import Placed, carriers, place

WORLD = Frame("world", fixed(Pose()))
Shape = Primitive | Hull


def limits(j4: float = 2 * math.pi) -> Limits:
    """The benchmark's: rad and m."""
    return Limits(
        lower=np.array([-2.3038, -2.6179, 0.05, -j4]),
        upper=np.array([2.3038, 2.6179, 0.25, j4]),
        velocity=np.array([7.8, 9.4, 2.0, 40.0]),
        acceleration=np.array([50.0, 80.0, 25.0, 300.0]),
        jerk=np.array([1000.0, 1600.0, 500.0, 6000.0]),
    )


def solid(name: str, shape: Shape, x: float = 0.0, y: float = 0.0, z: float = 0.0, along: str = "z") -> Body:
    """A body of one piece."""
    return Body(name, (Piece(shape, np.array([x, y, z]), AXES[along]),))


def arm(
    *, bare: bool = False, column: float = 0.0, j4: float = 2 * math.pi, base: Pose | None = None, axes: int = 4
) -> Scara:
    """325 + 275 mm. `bare`: without bodies; `column`: radius of a column that the quill can hit."""
    bodies: tuple[RobotBody, ...] = (
        RobotBody(solid("link-1", box(0.405, 0.08, 0.06), 0.1625, 0.0, 0.30), LINK1),
        RobotBody(solid("link-2", box(0.355, 0.08, 0.06), 0.1375, 0.0, 0.36), LINK2),
        RobotBody(solid("quill", cylinder(0.012, 0.31), 0.0, 0.0, 0.155), QUILL),
    )
    pairs: tuple[tuple[str, str], ...] = ()
    if column:
        bodies = (*bodies, RobotBody(solid("column", cylinder(column, 0.27), 0.0, 0.0, 0.135), BASE))
        pairs = (("base", "quill"), ("base", "flange"), ("base", "link2"))
    full = limits(j4)
    cut = Limits(*(x[:axes] for x in (full.lower, full.upper, full.velocity, full.acceleration, full.jerk)))
    more: dict[str, Any] = {} if bare else {"bodies": bodies, "self_pairs": pairs}
    return Scara(name="test", l1=0.325, l2=0.275, axes=axes, limits=cut, base=base or Pose(), **more)


BARE = Tool(Pose())
CUP = Tool(Pose(0.0, 0.0, -0.06), (solid("cup", cylinder(0.015, 0.06), 0.0, 0.0, -0.03),), 0.4)
CRANKED = Tool(Pose(0.08, 0.03, -0.06), (solid("cup", cylinder(0.01, 0.06), 0.08, 0.03, -0.03),), 0.4)
"""A tool whose point is beside the flange's axis."""


def at(x: float, y: float, z: float = 0.1, yaw: float = 0.0, frame: str = "world") -> Target:
    return Target(frame, Pose(x, y, z, yaw))


def go(
    x: float, y: float, z: float = 0.1, yaw: float = 0.0, frame: str = "world", name: str = "goal", **options: Any
) -> Move:
    return Move(name, at(x, y, z, yaw, frame), **options)


def frame(name: str, law: Law, position: float = 0.0, speed: float = 0.0) -> Frame:
    return Frame(name, law, Uncertainty(position, speed))


def stands(
    name: str,
    shape: Shape,
    x: float = 0.0,
    y: float = 0.0,
    z: float = 0.0,
    yaw: float = 0.0,
    frame: str = "world",
    **more: Any,
) -> Around:
    """A body of one piece, its centre where it is said."""
    return Around(solid(name, shape), frame, Pose(x, y, z, yaw), **more)


def cell(
    *task: Step,
    bodies: tuple[Around, ...] = (),
    frames: tuple[Frame, ...] = (),
    q: tuple[float, ...] = (0.3, 1.2, 0.2, 0.0),
    qd: tuple[float, ...] | None = None,
    qdd: tuple[float, ...] | None = None,
    time: float = 0.0,
    robot: Robot | None = None,
    tool: Tool = BARE,
    execution: Execution = Execution(),
    carry: float | None = None,
    **options: Any,
) -> Scene:
    """A scene; without other `options` the first plan of at most 400 candidates, in any working mode."""
    none = (0.0,) * len(q)
    start = Start(time, np.array(q), np.array(qd or none), np.array(qdd or none))
    chosen: dict[str, Any] = {
        "seed": 1,
        "budget_s": 60.0,
        "max_candidates": 400,
        "stop": "first",
        "report": "full",
        "elbow": "auto",
        **options,
    }
    laws = {each.name: each for each in (WORLD, *frames)}
    return Scene(
        robot or arm(),
        tool,
        start,
        laws,
        bodies,
        task,
        Options(**chosen),
        execution,
        carry,
    )


PART = box(0.06, 0.04, 0.02)


def belt_and_dial(*after: Step, bodies: tuple[Around, ...] = (), fold: int = 1, **changes: Any) -> Scene:
    """Pick a part from a running belt, place it on a turning dial; `after` that, what else there is to do."""
    frames = (
        frame("belt", conveyor(Pose(0.0, 0.40, 0.05), 0.25)),
        frame("dial", turntable(Pose(0.34, -0.2, 0.06), math.radians(60))),
    )
    around = (
        stands("belt-bed", box(1.4, 0.3, 0.05), 0.0, 0.40, 0.025),
        Around(solid("part", PART), "belt", Pose(-0.30, 0.0, 0.01, 0.5), 0.12, fold),
        Around(solid("dial-plate", cylinder(0.2, 0.01)), "dial", Pose(z=-0.005)),
        *bodies,
    )
    task = (
        Pick("pick", "part", Pose(z=0.01), 0.03, 0.08, 0.04),
        Place("place", "part", Target("dial", Pose(0.12, 0.0, 0.01)), 0.02, 0.06, 0.03),
        *after,
    )
    options: dict[str, Any] = {"clearance": Clearance(0.004, 0.001), "singularity_margin": 0.1, "tool": CUP}
    return cell(*task, bodies=around, frames=frames, **{**options, **changes})


def table_to_table(*after: Step, shape: Shape = PART, fold: int = 1, **changes: Any) -> Scene:
    """Pick a part from a table, place it on another."""
    around = (
        stands("left-table", box(0.2, 0.2, 0.04), 0.25, 0.30, 0.02),
        stands("right-table", box(0.2, 0.2, 0.04), 0.35, -0.25, 0.02),
        Around(solid("part", shape), "world", Pose(0.25, 0.30, 0.05, 0.5), 0.12, fold),
    )
    task = (
        Pick("pick", "part", Pose(z=0.01), 0.03, 0.05, 0.04),
        Place("place", "part", Target("world", Pose(0.35, -0.25, 0.05, -0.4)), 0.03, 0.05, 0.03),
        *after,
    )
    options: dict[str, Any] = {"clearance": Clearance(0.004, 0.0005), "tool": CUP}
    return cell(*task, bodies=around, **{**options, **changes})


def block(x: float, y: float, z: float, offset: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Hull:
    """A box as a hull; `offset`: where its middle is from its origin."""
    signs = np.array([[a, b, c] for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)], dtype=np.float64)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = np.array([f for a, b, c, d in quads for f in ((a, b, c), (a, c, d))])
    return Hull(signs * np.array([x, y, z]) / 2 + np.array(offset), faces)


def mesh_box(name: str, x: float, y: float, z: float, wall: float = 0.002) -> Body:
    """A hollow box as a mesh is kept: thin hulls that cover its surface, and the surface itself."""
    hull = block(x, y, z)
    walls = []
    for axis, size in enumerate((x, y, z)):
        for side in (-1.0, 1.0):
            sizes = [x, y, z]
            sizes[axis] = wall
            centre = np.zeros(3)
            centre[axis] = side * (size - wall) / 2
            walls.append(Piece(block(sizes[0], sizes[1], sizes[2]), centre))
    vertices, faces = hull.vertices.copy(), hull.faces.copy()
    vertices.flags.writeable = faces.flags.writeable = False
    return Body(name, tuple(walls), (vertices, faces))


def rotation(rng: np.random.Generator) -> FloatArray:
    """A turn in space, drawn evenly."""
    q = rng.normal(size=4)
    w, x, y, z = q / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def placed(pieces: list[tuple[Piece, Piece]]) -> tuple[Placed, Placed]:
    """Pairs of pieces as they are in the world, in the form in which the planner handles them."""
    bodies = tuple(
        Around(Body(f"{side}{i}", (piece,)))
        for i, both in enumerate(pieces)
        for side, piece in zip("ab", both, strict=True)
    )
    scene = cell(go(0.3, 0.0), bodies=bodies, robot=arm(bare=True))
    arrangement = Bodies(scene)(AT_START)
    where = carriers(scene, np.zeros((1, 4)), np.zeros(1))
    # a hull has a bounding box of its own: the unit of the piece itself is the last one
    units: IntArray = np.array([arrangement.pieces(k)[-1] for k in range(len(bodies))], dtype=np.int64)
    row = np.zeros(len(pieces), dtype=np.int64)
    return place(arrangement, where, row, units[::2]), place(arrangement, where, row, units[1::2])


__all__ = [
    "BARE",
    "CRANKED",
    "CUP",
    "PART",
    "Around",
    "Follow",
    "arm",
    "at",
    "belt_and_dial",
    "block",
    "capsule",
    "cell",
    "frame",
    "go",
    "limits",
    "linear",
    "mesh_box",
    "placed",
    "rotation",
    "solid",
    "sphere",
    "stands",
    "swing",
    "table_to_table",
]


def amount_of(refusal: Refusal | None) -> float:
    """What a refusal says is missing; NaN where there is no number."""
    return math.nan if refusal is None or refusal.amount is None else refusal.amount.value


def unit_of(refusal: Refusal | None) -> str:
    """The unit of that."""
    return "" if refusal is None or refusal.amount is None else refusal.amount.unit
