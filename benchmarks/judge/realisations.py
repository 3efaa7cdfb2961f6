"""What a request leaves open, realised: R times, at the extremes, inside them, and at the worst corners that arrivals
name.

Every number is a share of what the request allows: from -1 to 1, a vector in the unit disc, or a time from 0 to the
start tolerance.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from benchmarks.judge.cell import Cell
from benchmarks.judge.poses import Document, Floats

SOON, LATE = (0.0, 0.02), (0.98, 1.0)
"""At which shares of a way a correction fades out or sets in at once."""


@dataclass(eq=False)
class PoseErrors:
    """Shares of a frame's or a part's error: `flat` (R, 2) of what is the same in all horizontal directions, the rest
    (R,) with a sign."""

    flat: Floats
    along: Floats
    across: Floats
    up: Floats
    turned: Floats


@dataclass(eq=False)
class Realisations:
    """R runs of a plan: by how much the start is `late`, s (R,); lag of the joints (R, K, n) at `lag_s` (K,), straight
    lines between; shares of the errors of frames, parts and grips by name, of shifts of neighbours (R,) by name; and
    for corrections over which part of the way between two tracking legs the one before fades out, and the one behind
    sets in (R, 2, 2), each from a share of the way to another.
    """

    late: Floats
    lag_s: Floats
    lag: Floats
    frames: dict[str, PoseErrors]
    parts: dict[str, PoseErrors]
    grips: dict[str, PoseErrors]
    shifts: dict[str, Floats]
    ramps: Floats
    corners: list[str] = field(default_factory=list)
    """Of each run the arrival whose worst corner it is; empty: none."""

    @property
    def count(self) -> int:
        return len(self.late)

    def described(self, r: int) -> Document:
        """Run r as plain numbers."""
        poses = {"frames": self.frames, "parts": self.parts, "grips": self.grips}
        return {
            "late_s": float(self.late[r]),
            "lag_s": self.lag_s.tolist(),
            "lag": self.lag[r].tolist(),
            "shifts": {name: float(values[r]) for name, values in self.shifts.items()},
            "ramps": self.ramps[r].tolist(),
            "corner": self.corners[r],
            **{
                kind: {name: {key: np.asarray(getattr(each, key)[r]).tolist() for key in vars(each)} for name, each in
                       table.items()}
                for kind, table in poses.items()
            },
        }  # fmt: skip


def grip_names(request: Document) -> list[str]:
    """Of what is known in another way than by how a part was met: the start's part, and picks that centre theirs."""
    found = ["start"] if "holding" in request["start"] else []
    return found + [f"step {k}" for k, step in enumerate(request["task"]) if "held_within" in step.get("pick", {})]


def drawn(cell: Cell, answer: Document, count: int, rng: np.random.Generator) -> Realisations:
    """`count` runs: half with every share at an end, half with shares inside; the first with everything as planned."""
    request = cell.request
    extreme = np.arange(count) % 2 == 1
    tolerance = float(request.get("execution", {}).get("start_tolerance_s", 0.0))
    until = sorted({arrival["until_s"] for arrival in answer["arrivals"]})
    ends = [answer["start_s"], *until, answer["start_s"] + answer["duration_s"]]
    nodes = np.unique([*ends, *((a + b) / 2.0 for a, b in pairwise(ends))])

    def shares(*shape: int) -> Floats:
        inside = rng.uniform(-1.0, 1.0, (count, *shape))
        ends = np.where(inside < 0.0, -1.0, 1.0)
        found = np.where(extreme.reshape(-1, *([1] * len(shape))), ends, inside)
        found[0] = 0.0
        return found

    def disc() -> Floats:
        angle, size = (
            rng.uniform(0.0, 2.0 * np.pi, count),
            np.where(extreme, 1.0, np.sqrt(rng.uniform(0.0, 1.0, count))),
        )
        size[0] = 0.0
        return np.stack([size * np.cos(angle), size * np.sin(angle)], axis=-1)

    def of_pose() -> PoseErrors:
        return PoseErrors(disc(), shares(), shares(), shares(), shares())

    late = (shares() + 1.0) / 2.0 * tolerance
    late[0] = 0.0
    lag = shares(len(nodes), len(cell.arm.names))
    steady = rng.uniform(0.0, 1.0, count) < 0.5
    lag[steady] = lag[steady][:, :1]  # a lag that stays as it is, in half of the runs
    names = [name for name, given in request.get("frames", {}).items() if "uncertainty" in given]
    ramps = np.sort(rng.uniform(0.0, 1.0, (count, 2, 2)), axis=2)
    ramps[extreme] = np.where(rng.uniform(size=(int(extreme.sum()), 2, 1)) < 0.5, SOON, LATE)
    return Realisations(
        late=late,
        lag_s=nodes,
        lag=lag,
        frames={name: of_pose() for name in names},
        parts={name: of_pose() for name in cell.unknown_of},
        grips={name: of_pose() for name in grip_names(request)},
        shifts={each["name"]: shares() for each in request.get("neighbours", [])},
        ramps=ramps,
        corners=[""] * count,
    )


def put_corners(found: Realisations, cell: Cell, answer: Document, yaws: Floats) -> None:
    """Makes the last runs the worst corners that the arrivals name, as signs of frames and joints, lateness and a
    direction. `yaws` (A,): of the flange at each arrival, rad.

    A gripped part has the error that was realised at its pick. So each corner is there twice: with the other arrivals
    at their worst, and with all their signs reversed.
    """
    arrivals = answer["arrivals"]
    wanted = [(k, flip) for k, each in enumerate(arrivals) if each.get("error") for flip in (1.0, -1.0)]
    for number, (k, flip) in enumerate(wanted[: found.count - 4]):
        r = found.count - 1 - number
        found.corners[r], found.ramps[r] = arrivals[k]["control_point"], (LATE, SOON)
        for other in [j for j in range(len(arrivals)) if j != k] + [k]:
            if arrivals[other].get("error"):
                _put(found, r, cell, arrivals[other], float(yaws[other]), 1.0 if other == k else flip)


def _put(found: Realisations, r: int, cell: Cell, arrival: Document, yaw: float, sign: float) -> None:
    reported = {each["what"]: float(each["value"]) for each in arrival["error"]["worst"]}
    ((kind, given),) = cell.request["task"][arrival["step"]].items()
    node = int(np.argmin(np.abs(found.lag_s - arrival["until_s"])))
    height = 0.0
    for j, name in enumerate(cell.arm.names):
        if name in reported:
            found.lag[r, node, j] = sign * reported[name]
            if cell.arm.slides[j]:
                height -= reported[name] * cell.lag[j]
    if "late start s" in reported:
        found.late[r] = max(reported["late start s"], 0.0)
    for name, error in found.frames.items():
        for key in ("along", "across", "up", "turned"):
            if f"{name} {key}" in reported:
                getattr(error, key)[r] = sign * reported[f"{name} {key}"]
        height += reported.get(f"{name} up", 0.0) * cell.frames[name].unknown.get("vertical_m", 0.0)
    upwards = sign * (1.0 if height >= 0.0 else -1.0)
    direction = reported.get("direction rad", 0.0)
    towards = sign * np.array([np.cos(direction), np.sin(direction)])
    part = given["part"] if kind == "pick" else None
    about = cell.seat(given["to"])[0] if part is None else cell.seats[part][0]
    if about in found.frames and cell.frames[about].line is None:
        found.frames[about].flat[r] = towards
    if part in found.parts:
        error = found.parts[part]
        error.flat[r], error.up[r], error.turned[r] = towards, upwards, np.sign(error.turned[r] or 1.0)
    if kind == "place":
        # what is held is off against the tool, which is the other way round
        for error in found.grips.values():
            c, s = np.cos(-yaw), np.sin(-yaw)
            error.flat[r] = -np.array([c * towards[0] - s * towards[1], s * towards[0] + c * towards[1]])
            error.up[r], error.turned[r] = -upwards, np.sign(error.turned[r] or 1.0)
