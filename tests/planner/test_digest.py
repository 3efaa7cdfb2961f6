"""The digest changes with everything that is said, and with nothing else."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

import numpy as np

from assur.planner.frames.motion import Pose
from assur.planner.laws.law import PoseUncertainty
from assur.planner.model.arrival_error import ArrivalError, Cause, Share
from assur.planner.model.digest import digest
from assur.planner.model.outcome import Arrival, Certificate, Course, Leg, LegKind, Missed, Route, Traced
from assur.planner.trajectory import Trajectory
from tests.planner.trajectory.changed import changed as changed_path

KNOTS = Trajectory(np.array([0.0, 1.0]), np.zeros((2, 3)), np.zeros((2, 3)), np.zeros((2, 3)))
LEGS = (Leg(LegKind.WAIT, 0, 0.0, 0.5, Route(Course.FOR_BODIES)), Leg(LegKind.MOVE, 0, 0.5, 1.0))
ARRIVALS = (Arrival(0, "there", 1.0, 1.0, Pose(1.0, 2.0, 3.0, 0.1), True, 0.0, None, 0.25),)
ROWS = Certificate(
    names=("a", "b"),
    t0=np.array([0.0, 1.0]),
    t1=np.array([1.0, 2.0]),
    first=np.array([0, 1]),
    first_piece=np.array([0, -1]),
    second=np.array([1, 0]),
    second_piece=np.array([-1, 2]),
    normal=np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]),
)


def of(**changes: Any) -> str:
    given: dict[str, Any] = {
        "scene_digest": "scene",
        "trajectory": KNOTS,
        "legs": LEGS,
        "arrivals": ARRIVALS,
        "certificate": ROWS,
    }
    return digest(**{**given, **changes})


def test_the_same_things_have_the_same_digest() -> None:
    same = Trajectory(*(np.array(getattr(KNOTS, name).tolist()) for name in ("time", "q", "qd", "qdd")))
    assert of(trajectory=same) == of()
    assert of(certificate=replace(ROWS, digest="whatever it was")) == of()
    assert len(of()) == 64


def test_minus_zero_is_zero() -> None:
    """Which of the two a number is does not survive every way of writing it down."""
    negative = Trajectory(KNOTS.time, -KNOTS.q, KNOTS.qd, KNOTS.qdd)
    assert of(trajectory=negative) == of()
    assert of(legs=(replace(LEGS[0], t0=-0.0), LEGS[1])) == of()


def test_every_number_and_every_word_counts() -> None:
    seen = {of(), of(scene_digest="other"), of(legs=LEGS[:1]), of(arrivals=())}
    for name in ("time", "q", "qd", "qdd"):
        values = getattr(KNOTS, name).copy()
        values.flat[-1] += 1e-15 if name != "time" else 1e-12
        seen.add(of(trajectory=changed_path(KNOTS, **{name: values})))
    changed: dict[str, Any] = {"kind": LegKind.ARCH, "step": 1, "t0": 0.1, "t1": 0.6, "route": None}
    assert set(changed) == {field.name for field in fields(Leg)}
    seen |= {of(legs=(replace(LEGS[0], **{name: value}), LEGS[1])) for name, value in changed.items()}
    for route in (Route(Course.ARCH), Route(Course.FOR_BODIES, 1), Route(Course.FOR_BODIES, after_wait=True)):
        seen.add(of(legs=(replace(LEGS[0], route=route), LEGS[1])))
    seen.add(of(legs=(replace(LEGS[0], route=Route(Course.FOR_BODIES, later=True)), LEGS[1])))
    arrived: dict[str, Any] = {
        "step": 1,
        "control_point": "here",
        "time": 0.9,
        "until": 1.1,
        "pose": Pose(1.0, 2.0, 3.0, 0.2),
        "matched": False,
        "yaw_offset": 0.1,
        "along_m": 0.0,
        "window_left_s": None,
        "pitch": 0.0,
        "roll": 0.0,
        "missed_by": Missed((0.1, 0.2, 0.3), 0.01),
        "error": ArrivalError(0.1, PoseUncertainty(0.1), (Share(Cause.LAG, 0.1, 0.0),), (("late start s", 0.1),)),
        "trace": Traced(0.2, 0.1, 0.1, 1e-6),
        "grip_m": 0.001,
        "support_m": 0.001,
    }
    assert set(arrived) == {field.name for field in fields(Arrival)}
    seen |= {of(arrivals=(replace(ARRIVALS[0], **{name: value}),)) for name, value in arrived.items()}
    columns = [field.name for field in fields(Certificate) if field.name not in ("names", "digest", "covers")]
    shifts = {"shift0": np.zeros(len(ROWS)), "shift1": np.ones(len(ROWS))}
    for name in columns:
        values = (shifts[name] if name in shifts else getattr(ROWS, name)).copy()
        values.flat[-1] += 1
        changed_columns: dict[str, Any] = {**(shifts if name in shifts else {}), name: values}
        seen.add(of(certificate=replace(ROWS, **changed_columns)))
    seen.add(of(certificate=replace(ROWS, names=("a", "c"))))
    seen.add(of(certificate=replace(ROWS, covers=ROWS.covers[:-1])))
    seen.add(of(trajectory=changed_path(KNOTS, jumps=True)))
    assert len(seen) == 4 + 4 + 4 + len(changed) + len(arrived) + len(columns) + 3


def test_words_do_not_run_into_each_other() -> None:
    assert of(certificate=replace(ROWS, names=("ab", "c"))) != of(certificate=replace(ROWS, names=("a", "bc")))
    assert of(certificate=replace(ROWS, names=("a", "b", ""))) != of(certificate=replace(ROWS, names=("a", "b")))
