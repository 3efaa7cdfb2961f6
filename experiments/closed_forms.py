"""Closed forms of an arm with tilting links against transforms, Jacobians by transforms, and the planner's dyads."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from assur.experiments.differential import determinant
from assur.experiments.printed_forms import Frames, jacobian
from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError
from assur.planner.frames.motion import Motion
from assur.planner.robots.facts import Code, principal
from assur.planner.robots.robot import Robot

CLEAR = 0.05
"""Errors are reported for states with at least this singularity margin, the default of requests."""
SHARE = 1e-3
"""m: a closed form that puts the flange farther than this from its target has missed it."""


@dataclass(frozen=True, eq=False)
class Arm:
    """The same arm twice: the planner's `robot`, standing at the origin, and the source's, whose joints are the
    planner's plus `offset` (n,). `closed` gives the source's joints of points (N, 3) in a working mode, `frames` its
    transforms; `product` the determinant of its Jacobian in factors; `slides`: which joints are prismatic."""

    robot: Robot
    offset: FloatArray
    closed: Callable[[FloatArray, str], FloatArray]
    frames: Callable[[FloatArray], Frames]
    product: Callable[[FloatArray], FloatArray]
    slides: tuple[bool, ...]


@dataclass(frozen=True, eq=False)
class Comparison:
    """`numbers` for JSON; for each target (N,) its singularity `margin`, and the largest difference, over all modes,
    of a joint of the closed form from the dyads' (`apart`, rad or m)."""

    numbers: dict[str, Any]
    margin: FloatArray
    apart: FloatArray


def compare(arm: Arm, p: FloatArray, v: FloatArray) -> Comparison:
    """Over targets `p` (N, 3), m, that move with `v` (N, 3), m/s, in every working mode."""
    robot, none = arm.robot, np.zeros(len(p))
    still = np.zeros_like(p)
    target = Motion.of(p, v, still, still, none, none, none, none)
    far, apart, rates, det, margin = (np.zeros(len(p)) for _ in range(5))
    for mode, name in enumerate(robot.modes):
        ours = robot.inverse(target, mode, 1)
        if not (ours.code == Code.ASSEMBLED).all():
            raise FaultError(f"{robot.name}: a target that is out of reach in mode {name}")
        margin = ours.margin
        q = arm.closed(p, name)
        frames = arm.frames(q)
        far = np.maximum(far, np.linalg.norm(frames[-1][..., :3, 3] - p, axis=-1))
        apart = np.maximum(apart, differences(q - arm.offset - ours.q, arm.slides).max(-1))
        own = jacobian(frames, arm.slides)
        qd = np.linalg.solve(own, v[..., None])[..., 0]
        rates = np.maximum(rates, np.abs(qd - ours.qd).max(-1) / np.abs(ours.qd).max(-1))
        product = arm.product(q)
        for found in (np.linalg.det(own), determinant(robot, q - arm.offset)):
            det = np.maximum(det, np.abs(found - product))
    clear = margin > CLEAR
    numbers = {
        "targets": len(p),
        "modes": list(robot.modes),
        "closed_form_by_transforms_off_target_m": float(far.max()),
        "closed_form_minus_dyads_rad_m": float(apart.max()),
        "closed_form_minus_dyads_where_margin_above_0.05_rad_m": float(apart[clear].max()),
        "closed_form_minus_dyads_times_margin_rad_m": float((apart * margin).max()),
        "inverse_jacobian_minus_dyads_relative_where_margin_above_0.05": float(rates[clear].max()),
        "inverse_jacobian_minus_dyads_relative_times_margin_squared": float((rates * margin**2).max()),
        "determinant_by_transforms_and_by_planner_minus_product": float(det.max()),
    }
    return Comparison(numbers, margin, apart)


def differences(values: FloatArray, slides: Sequence[bool]) -> FloatArray:
    """|values| (..., n), of turning joints up to whole turns."""
    return np.where(np.array(slides), np.abs(values), np.abs(principal(values)))


def missed(arm: Arm, joints: FloatArray, p: FloatArray) -> FloatArray:
    """How far (N,), m, the flange is from p (N, 3) with the source's joints (N, n); NaN where there are none."""
    return np.asarray(np.linalg.norm(arm.frames(joints)[-1][..., :3, 3] - p, axis=-1))


def singular(arm: Arm, cases: dict[str, tuple[float, ...]]) -> dict[str, dict[str, Any]]:
    """The determinant by transforms, the planner's margin and its name for it, at the planner's joints of each case."""
    found = {}
    for name, joints in cases.items():
        q = np.array(joints)
        found[name] = {
            "determinant": float(np.linalg.det(jacobian(arm.frames(q + arm.offset), arm.slides))),
            "margin": float(arm.robot.margin(q)),
            "code": Code(int(arm.robot.singularity(q))).name,
        }
    return found
