"""Whether a plan has the shape of a plan, so that everything after may compute with it without surprise."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.verdict import Code, Finding
from assur.planner.model.outcome import Leg, LegKind, Plan, Route, covered
from assur.planner.model.scene import Scene

REALS = ("t0", "t1")
INDICES = ("first", "first_piece", "second", "second_piece")


def form(scene: Scene, plan: Plan) -> list[Finding]:
    """What of knots, legs, arrivals and certificate is missing, not finite, of the wrong kind or shape."""
    findings = _knots(plan.trajectory, len(scene.robot.joints), blended=scene.options.blended)
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
        missed = getattr(arrival, "missed_by", None)
        if missed is not None:
            joints = getattr(missed, "joints", None)
            of_joints = joints if isinstance(joints, tuple) and len(joints) == len(scene.robot.joints) else (None,)
            optional += [x if _finite(x) else math.nan for x in (*of_joints, getattr(missed, "distance_m", None))]
        named = isinstance(getattr(arrival, "control_point", None), str)
        if not (named and all(x is None or _finite(x) for x in optional)):
            findings.append(Finding(Code.FORM, f"arrival {i} has something that is not a finite number"))
    return findings + _certificate(plan.certificate, blended=scene.options.blended)


def _knots(knots: Any, joints: int, *, blended: bool) -> list[Finding]:
    """Times increase; with parabolic blends, and only then, two knots may share one where the acceleration jumps."""
    time: Any = getattr(knots, "time", None)
    if not (_reals(time, 1) and len(time) >= 2):
        return [Finding(Code.FORM, "knots need at least two finite times")]
    findings = []
    jumps: Any = getattr(knots, "jumps", None)
    if jumps is not blended:
        asked = "parabolic_blend" if blended else "jerk_limited"
        findings.append(
            Finding(Code.FORM, f"jumps in acceleration are said to be {jumps!r:.20}, the timing is {asked}")
        )
    if not blended and not bool((time[1:] > time[:-1]).all()):
        k = int(np.argmin(time[1:] > time[:-1])) + 1
        back = float(time[k - 1] - time[k])
        findings.append(Finding(Code.FORM, "times of knots must increase", back, "s", f"knot {k}"))
    for name in ("q", "qd", "qdd"):
        states: Any = getattr(knots, name, None)
        if not (_reals(states, 2) and states.shape == (len(time), joints)):
            findings.append(Finding(Code.FORM, f"{name} must be {len(time)} × {joints} finite numbers"))
    if blended and not findings:
        findings += _doubled(time, knots.q, knots.qd)
    return findings


def _doubled(time: FloatArray, q: FloatArray, qd: FloatArray) -> list[Finding]:
    """Of knots at one time there are two, which agree in all but their acceleration."""
    step = time[1:] - time[:-1]
    pair = np.flatnonzero(step == 0)
    if not bool((step >= 0).all() and time[-1] > time[0]):
        k = int(np.argmin(step)) + 1
        return [Finding(Code.FORM, "times of knots must not decrease", float(-step.min()), "s", f"knot {k}")]
    if bool((np.diff(pair) == 1).any()):
        return [Finding(Code.FORM, "no more than two knots may share a time", where=f"{time[pair[0]]:.6g} s")]
    apart = (q[pair] != q[pair + 1]).any(1) | (qd[pair] != qd[pair + 1]).any(1)
    if bool(apart.any()):
        k = int(pair[np.argmax(apart)])
        off = float(max(np.abs(q[k] - q[k + 1]).max(), np.abs(qd[k] - qd[k + 1]).max()))
        what = "position or velocity jumps between two knots at one time"
        return [Finding(Code.FORM, what, off, "1, 1/s", f"{time[k]:.6g} s")]
    return []


def _leg(leg: Any, steps: int) -> bool:
    if not (isinstance(leg, Leg) and _index(leg.step, steps) and _finite(leg.t0) and _finite(leg.t1)):
        return False
    kind: Any = leg.kind
    return isinstance(kind, LegKind) and (leg.route is None or isinstance(leg.route, Route))


def _certificate(certificate: Any, *, blended: bool) -> list[Finding]:
    if getattr(certificate, "covers", None) != covered(blended=blended):
        return [Finding(Code.FORM, f"the certificate must say that it covers {', '.join(covered(blended=blended))}")]
    names: Any = getattr(certificate, "names", None)
    texts = isinstance(names, tuple) and all(isinstance(name, str) for name in names)
    if not (texts and len(set(names)) == len(names)):
        return [Finding(Code.FORM, "the certificate's names must be different texts")]
    t0: Any = getattr(certificate, "t0", None)
    rows = len(t0) if isinstance(t0, np.ndarray) and t0.ndim == 1 else -1
    findings = []
    for name in REALS:
        column: Any = getattr(certificate, name, None)
        if not (_reals(column, 1) and len(column) == rows):
            findings.append(Finding(Code.FORM, f"certificate column {name} must be {max(rows, 0)} finite numbers"))
    for name in INDICES:
        column = getattr(certificate, name, None)
        if not (isinstance(column, np.ndarray) and column.dtype.kind == "i" and column.shape == (rows,)):
            findings.append(Finding(Code.FORM, f"certificate column {name} must be {max(rows, 0)} integers"))
    normal: Any = getattr(certificate, "normal", None)
    if not (_reals(normal, 2) and normal.shape == (rows, 3)):
        findings.append(Finding(Code.FORM, f"certificate column normal must be {max(rows, 0)} × 3 finite numbers"))
    return findings


def _reals(column: Any, dimensions: int) -> bool:
    if not (isinstance(column, np.ndarray) and column.dtype == np.float64 and column.ndim == dimensions):
        return False
    return bool(np.isfinite(column).all())


def _finite(value: Any) -> bool:
    return isinstance(value, float | int | np.floating | np.integer) and bool(math.isfinite(value))


def _index(value: Any, count: int) -> bool:
    return isinstance(value, int | np.integer) and not isinstance(value, bool) and bool(0 <= value < count)
