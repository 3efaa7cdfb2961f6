"""Whether a plan has the shape of a plan, so that everything after may compute with it without surprise."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from planner.checker.verdict import Code, Finding
from planner.outcome import Leg, LegKind, Plan
from planner.scene import Scene

REALS = ("t0", "t1", "gap0", "gap1", "speed", "acceleration")
INDICES = ("first", "first_piece", "second", "second_piece")


def form(scene: Scene, plan: Plan) -> list[Finding]:
    """What of knots, legs, arrivals and certificate is missing, not finite, of the wrong kind or shape."""
    findings = _knots(plan.trajectory, len(scene.robot.joints))
    for name in ("legs", "arrivals"):
        if not isinstance(getattr(plan, name, None), tuple):
            return [*findings, Finding(Code.FORM, f"{name} must be a tuple")]
    for i, leg in enumerate(plan.legs):
        if not _leg(leg, len(scene.task)):
            findings.append(Finding(Code.FORM, f"leg {i} is not a leg of this task: {leg!r:.100}"))
    arrival: Any
    for i, arrival in enumerate(plan.arrivals):
        pose = getattr(arrival, "pose", None)
        numbers = [getattr(pose, name, None) for name in ("x", "y", "z", "yaw")]
        numbers += [getattr(arrival, name, None) for name in ("time", "until", "yaw_offset")]
        step = getattr(arrival, "step", None)
        if not (all(map(_finite, numbers)) and _index(step, len(scene.task))):
            findings.append(Finding(Code.FORM, f"arrival {i} is not an arrival of this task: {arrival!r:.100}"))
        optional = [getattr(arrival, name, None) for name in ("along_m", "window_left_s", "pitch", "roll")]
        named = isinstance(getattr(arrival, "control_point", None), str)
        if not (named and all(x is None or _finite(x) for x in optional)):
            findings.append(Finding(Code.FORM, f"arrival {i} has something that is not a finite number"))
    return findings + _certificate(plan.certificate)


def _knots(knots: Any, joints: int) -> list[Finding]:
    time: Any = getattr(knots, "time", None)
    if not (_reals(time, 1) and len(time) >= 2):
        return [Finding(Code.FORM, "knots need at least two finite times")]
    findings = []
    if not bool((time[1:] > time[:-1]).all()):
        k = int(np.argmin(time[1:] > time[:-1])) + 1
        back = float(time[k - 1] - time[k])
        findings.append(Finding(Code.FORM, "times of knots must increase", back, "s", f"knot {k}"))
    for name in ("q", "qd", "qdd"):
        states: Any = getattr(knots, name, None)
        if not (_reals(states, 2) and states.shape == (len(time), joints)):
            findings.append(Finding(Code.FORM, f"{name} must be {len(time)} × {joints} finite numbers"))
    return findings


def _leg(leg: Any, steps: int) -> bool:
    if not (isinstance(leg, Leg) and _index(leg.step, steps) and _finite(leg.t0) and _finite(leg.t1)):
        return False
    kind: Any = leg.kind
    return isinstance(kind, LegKind) and isinstance(getattr(leg, "note", None), str)


def _certificate(certificate: Any) -> list[Finding]:
    names: Any = getattr(certificate, "names", None)
    texts = isinstance(names, tuple) and all(isinstance(name, str) for name in names)
    if not (texts and len(set(names)) == len(names)):
        return [Finding(Code.FORM, "the certificate's names must be different texts")]
    t0: Any = getattr(certificate, "t0", None)
    rows = len(t0) if isinstance(t0, np.ndarray) and t0.ndim == 1 else -1
    findings = []
    for name in REALS:
        column: Any = getattr(certificate, name, None)
        # An infinite bound is a true one; an infinite time or gap is not.
        if not (_reals(column, 1, infinite=name in REALS[4:]) and len(column) == rows):
            findings.append(Finding(Code.FORM, f"certificate column {name} must be {max(rows, 0)} finite numbers"))
    for name in INDICES:
        column = getattr(certificate, name, None)
        if not (isinstance(column, np.ndarray) and column.dtype.kind == "i" and column.shape == (rows,)):
            findings.append(Finding(Code.FORM, f"certificate column {name} must be {max(rows, 0)} integers"))
    normal: Any = getattr(certificate, "normal", None)
    if not (_reals(normal, 2) and normal.shape == (rows, 3)):
        findings.append(Finding(Code.FORM, f"certificate column normal must be {max(rows, 0)} × 3 finite numbers"))
    return findings


def _reals(column: Any, dimensions: int, *, infinite: bool = False) -> bool:
    if not (isinstance(column, np.ndarray) and column.dtype == np.float64 and column.ndim == dimensions):
        return False
    return bool((column >= 0).all()) if infinite else bool(np.isfinite(column).all())


def _finite(value: Any) -> bool:
    return isinstance(value, float | int | np.floating | np.integer) and bool(math.isfinite(value))


def _index(value: Any, count: int) -> bool:
    return isinstance(value, int | np.integer) and not isinstance(value, bool) and bool(0 <= value < count)
