"""Frames of a document as time laws."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from assur.planner import laws
from assur.planner.errors import FaultError
from assur.planner.laws import ALWAYS, Change, Frame, Law, Pose, PoseUncertainty, Uncertainty
from assur.planner.laws.law import FARTHEST_WAY_M, way
from assur.planner.model.deadline import raise_if_late
from assur.planner.model.scene import WORLD
from assur.scenes.faults import FAULTS, FollowsError, Gathered, Refused, choices, within
from assur.scenes.schema.frames import (
    FrameDocument,
    IndexerDocument,
    KeyframesDocument,
    SwingDocument,
    UncertaintyDocument,
)
from assur.scenes.schema.in_parts import Unread
from assur.scenes.schema.model import Document, PoseDocument, PoseUncertaintyDocument

Valid = tuple[float, float]


def placed(at_m: list[float], yaw_rad: float) -> Pose:
    """The pose at a point of three coordinates."""
    x, y, z = at_m
    return Pose(x, y, z, yaw_rad)


def pose_of(document: PoseDocument) -> Pose:
    """The pose that a document spells."""
    return placed(document.at_m, document.yaw_rad)


def pose_uncertainty(document: PoseUncertaintyDocument) -> PoseUncertainty:
    """How far a part may be from its pose."""
    return PoseUncertainty(**vars(document))


def uncertainty(document: UncertaintyDocument, law: Law) -> Uncertainty:
    """How far a frame may be from its law. Raises `Refused` for a lateral error of a frame that has no line."""
    if document.lateral_m > 0.0 and law.way is None:
        raise Refused(
            "0: only a conveyor or a linear frame has a side (others: position_m)", "uncertainty", "lateral_m"
        )
    return Uncertainty(**vars(document))


def knows(law: Law, t: float) -> bool:
    """Whether a law is known at a time, s."""
    return law.valid[0] <= t <= law.valid[1]


def known_from(law: Law) -> str:
    """The time span, in words, in which a law is known."""
    ends = zip(("from", "to"), law.valid, strict=True)
    return "known " + " ".join(f"{word} {end:g} s" for word, end in ends if math.isfinite(end))


def _posed(make: Callable[..., Law], *fields: str) -> Callable[[Any, Valid], Law]:
    """The law that `make` makes of the pose of a document and these fields of it."""

    def law(d: Any, valid: Valid) -> Law:
        return make(pose_of(d), *[_plain(getattr(d, name)) for name in fields], valid=valid)

    return law


def _plain(value: Any) -> Any:
    """A list of numbers, or of changes of a speed, as the planner has it; a number as it is."""
    if not isinstance(value, list):
        return value
    return tuple([Change(*vars(each).values()) if isinstance(each, Document) else each for each in value])


def _indexer(d: IndexerDocument, valid: Valid) -> Law:
    if d.step_rad is not None:
        return laws.indexer(pose_of(d), d.step_rad, d.move_s, d.dwell_s, "turn", d.start_s, valid=valid)
    if d.step_m is not None:
        return laws.indexer(pose_of(d), d.step_m, d.move_s, d.dwell_s, "travel", d.start_s, valid=valid)
    raise FaultError("an indexer without a step passed its model")


def _swing(d: SwingDocument, valid: Valid) -> Law:
    return laws.swing(placed(d.pivot_m, d.yaw_rad), d.amplitude_rad, d.period_s, d.phase_rad, valid=valid)


def _keyframes(d: KeyframesDocument, valid: Valid) -> Law:
    if d.repeat != (d.ends == "periodic"):
        raise Refused("periodic with repeat: true, which implies it, and else clamped or natural", "ends")
    return laws.keyframes(tuple(p.time_s for p in d.points), tuple(pose_of(p) for p in d.points), d.ends, valid=valid)


LAWS: dict[str, Callable[[Any, Valid], Law]] = {
    "fixed": _posed(laws.fixed),
    "linear": _posed(laws.linear, "velocity_m_s", "at_s"),
    "conveyor": _posed(laws.conveyor, "speed_m_s", "changes", "at_s"),
    "turntable": _posed(laws.turntable, "rate_rad_s", "rise_m_s", "changes", "at_s"),
    "indexer": _indexer,
    "swing": _swing,
    "oscillation": _posed(laws.oscillation, "direction", "amplitude_m", "period_s", "phase_rad"),
    "keyframes": _keyframes,
}
"""Key of a frame's law in a document → the law."""
STATED = tuple(key for key in LAWS if key != "keyframes")
"""Laws that state one pose of their frame."""


@dataclass(frozen=True, eq=False)
class Frames:
    """The frames of a cell: those with a `law` of their own, by name, and those that are fixed on one of them, each
    with its pose there. What sits in one of these sits in the frame with the law, and shares its uncertainty."""

    laws: dict[str, Frame]
    fixed_on: dict[str, tuple[str, Pose]]
    unread: set[str] = field(default_factory=set)
    """Frames and neighbours that have a fault."""

    def __iter__(self) -> Iterator[str]:
        """All names."""
        yield from self.laws
        yield from self.fixed_on

    def placed(self, name: str, pose: Pose) -> tuple[str, Pose]:
        """The frame with a law, and the pose in it, for a pose in the frame `name`. Raises `Refused` at `frame` for a
        name of none."""
        if name in self.laws:
            return name, pose
        if name.partition("/")[0] in self.unread:
            raise FollowsError
        if name not in self.fixed_on:
            raise Refused(f"one of {choices(list(self), name)}", "frame")
        below, carrier = self.fixed_on[name]
        return below, carrier.then(pose)

    def riding(self, name: str, pose: Pose, at_s: float) -> Pose:
        """The pose in a frame with a law of what rides on it, and is at `pose` in the frame as the request writes it
        when the clock is `at_s`. Raises `Refused` at `at_s` where the frame has no such pose, or is not known then."""
        law = self.laws[name].law
        if law.link is not None or law.kind not in STATED:
            raise Refused(f"none: {name} states no single pose; frames that do are {', '.join(STATED)}", "at_s")
        if not knows(law, at_s):
            raise Refused(f"a time at which {name} is known; it is {known_from(law)}", "at_s")
        if law.is_fixed:
            return pose
        gone = way(law, math.hypot(pose.x, pose.y), at_s, at_s)
        if gone > FARTHEST_WAY_M:
            raise Refused(f"a time until which it goes {FARTHEST_WAY_M:g} m at most; it goes {gone:g} m", "at_s")
        motion = law.motion(np.array(at_s))
        x, y, z = motion.p.tolist()
        back = Pose(x, y, z, float(motion.yaw)).inverse().then(law.numbers.pose)
        return Pose(back.x, back.y, back.z, math.remainder(back.yaw, math.tau)).then(pose)


STILL = Frame(WORLD, laws.fixed(Pose()))
"""The frame that does not move."""


def frames_of(frames: Mapping[str, FrameDocument | Unread], faults: Gathered) -> Frames:
    """The frames, `world` among them. `faults` gets what a law refuses, and what leads to no frame."""
    found = Frames({WORLD: STILL}, {})
    for name, item in frames.items():
        raise_if_late()
        if isinstance(item, Unread):
            found.unread.add(name)
            continue
        try:
            if name == WORLD:
                raise Refused(f"another name: {WORLD} is the frame that does not move")
            if _below(item) is None:
                found.laws[name] = _frame(name, item)
            else:
                _check_fixed(item, frames)
        except FAULTS as error:
            found.unread.add(name)
            faults.add(error, "frames", name)
    for name in frames:
        if name not in found.laws and name not in found.unread:
            try:
                found.fixed_on[name] = _fixed_on(name, frames, found)
            except FAULTS as error:
                found.unread.add(name)
                faults.add(error, "frames")
    return found


def _below(item: FrameDocument) -> str | None:
    """The frame on which a frame is fixed; None: it has a law of its own."""
    return None if item.fixed is None or item.fixed.frame == WORLD else item.fixed.frame


def _check_fixed(item: FrameDocument, frames: Collection[str]) -> None:
    below = _below(item)
    if below not in frames:
        raise Refused(f"one of {choices([WORLD, *frames], str(below))}", "fixed", "frame")
    if item.uncertainty != UncertaintyDocument():
        raise Refused(f"no uncertainty: the frame goes with {below} and has its uncertainty", "uncertainty")
    if item.valid_s is not None:
        raise Refused(f"no valid_s: the frame is known as long as {below} is", "valid_s")


def _fixed_on(name: str, frames: Mapping[str, FrameDocument | Unread], known: Frames) -> tuple[str, Pose]:
    """The frame with a law that carries the frame `name`, directly or over others, and its pose there."""
    raise_if_late()
    pose, way = Pose(), [name]
    while way[-1] not in known.laws:
        item = frames[way[-1]]
        if way[-1] in known.unread or isinstance(item, Unread):
            raise FollowsError
        fixed = item.fixed
        if fixed is None or fixed.frame is None:
            raise FaultError(f"frame {way[-1]} without a law is not fixed on another")
        if fixed.frame in way:
            loop = " on ".join([*way[way.index(fixed.frame) :], fixed.frame])
            raise Refused(f"a frame that is not fixed on this one: {loop}", way[-1], "fixed", "frame")
        pose = pose_of(fixed).then(pose)
        way.append(fixed.frame)
    return way[-1], pose


def _frame(name: str, item: FrameDocument) -> Frame:
    valid = ALWAYS
    if item.valid_s is not None:
        valid = (item.valid_s[0], item.valid_s[1])
        if not valid[0] < valid[1]:
            raise Refused("two times, the first before the second", "valid_s")
    for key, law in LAWS.items():
        spelt = getattr(item, key)
        if spelt is not None:
            with within(key):
                known = law(spelt, valid)
            return Frame(name, known, uncertainty(item.uncertainty, known))
    raise FaultError(f"frame {name} without a law passed its model")


DRIVES = {"conveyor": "a belt with a servo drive", "turntable": "a dial of 500 mm with a servo drive"}
"""Whose acceleration and jerk are taken where the changes of a law state none."""


def assumptions_of(frames: Mapping[str, FrameDocument]) -> tuple[str, ...]:
    """What an answer says of accelerations and jerks that changes of speed leave to their defaults."""
    found = []
    for name, item in frames.items():
        for law, drive in DRIVES.items():
            spelt = getattr(item, law)
            if spelt is None or not spelt.changes:
                continue
            for key in ("acceleration_m_s2", "jerk_m_s3", "acceleration_rad_s2", "jerk_rad_s3"):
                silent = [c for c in spelt.changes if key in type(c).model_fields and key not in c.model_fields_set]
                if silent:
                    quantity, unit, power = key.rsplit("_", 2)
                    value = f"{getattr(silent[0], key):g} {unit}/s^{power[1:]}"
                    found.append(f"{name}: {quantity} of its changes {value}, assumed where none is given: {drive}")
    return tuple(found)
