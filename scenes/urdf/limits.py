"""Limits of the joints, from the URDF and a joint_limits.yaml; what is in neither is missing, and what is in both and
differs is reported."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from assur.scenes.faults import DocumentError, dotted
from assur.scenes.text.yaml_text import Lines, line_of, parse_yaml
from assur.scenes.urdf.chain import Chain
from assur.scenes.urdf.refusals import Defect, ImportRefused
from assur.scenes.urdf.tree import Bound, Joint

JERK_TIME_S = 0.02
"""Where no jerk is given: the acceleration is reached in this time, as for every shipped robot."""
JERK_SOURCE = "acceleration / 20 ms, for no maker publishes it"
PER = {"velocity": "/s", "acceleration": "/s2", "deceleration": "/s2", "jerk": "/s3"}


@dataclass(frozen=True, slots=True)
class Number:
    """A number of a joint, or both ends of its range, in SI with whose word it is."""

    value: float | list[float]
    status: str
    source: str

    @property
    def single(self) -> float:
        """The number that is no range."""
        return self.value if isinstance(self.value, float) else self.value[0]


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits of one joint in the file's count."""

    range: Number
    velocity: Number
    acceleration: Number
    jerk: Number


def limits_of(
    chain: Chain, given: LimitsFile | None, urdf: str, status: str
) -> tuple[list[Limits | None], list[Defect], list[str]]:
    """The limits of each joint, None where something is missing; all that is missing; and what is to be known of
    numbers that are not taken.

    `urdf`: the name of the URDF; `status`: whose word the numbers are.
    """
    found, lacks, remarks = [], [], [] if given is None else list(given.remarks)
    for joint in chain.joints:
        reader = _Reader(joint, given, urdf, status)
        found.append(reader.read())
        lacks += reader.lacks
        remarks += reader.remarks
    if given is not None:
        own, tree = {joint.name for joint in chain.joints}, chain.tree.joints
        if strange := [name for name in given.joints if name not in tree]:
            remarks.append(f"{given.name}: joints {', '.join(strange[:8])} are not in the URDF; they are not used")
        if still := [name for name in given.joints if name in tree and name not in own]:
            remarks.append(f"{given.name}: joints {', '.join(still[:8])} are not the arm's; they are not used")
    return found, lacks, remarks


class _Reader:
    """What is known of one joint."""

    def __init__(self, joint: Joint, file: LimitsFile | None, urdf: str, status: str) -> None:
        self.joint, self.urdf, self.status = joint, urdf, status
        self.given: dict[str, Any] = {} if file is None else file.joints.get(joint.name, {})
        self._file = file
        self.file = "" if file is None else file.name
        self.unit = "m" if joint.kind == "prismatic" else "rad"
        self.lacks: list[Defect] = []
        self.remarks: list[str] = []

    def read(self) -> Limits | None:
        self._keys()
        ends, velocity, acceleration = self._range(), self._required("velocity"), self._required("acceleration")
        deceleration, jerk = self._rate("deceleration"), self._rate("jerk")
        if ends is None or velocity is None or acceleration is None or self.lacks:
            return None
        if deceleration is not None and deceleration.single < acceleration.single:
            lower = f"{deceleration.source}, which is lower than the acceleration"
            acceleration = replace(deceleration, source=lower)
        if jerk is None:
            jerk = Number(float(f"{acceleration.single / JERK_TIME_S:.12g}"), "estimated", JERK_SOURCE)
        return Limits(ends, velocity, acceleration, jerk)

    def _keys(self) -> None:
        """Every key of the file is known, or refused, or reported."""
        unused = []
        for key in self.given:
            if key in NO_LIMITS:
                unused.append(key)
            elif key not in KNOWN:
                what = f"{key[:40]!r} in {self.file}{self._line(key)} is not known, and may be a limit"
                supply = f"known are {', '.join(KNOWN)}; correct it, or remove it if it is no limit"
                self.lacks.append(Defect(f"joint {self.joint.name}", what, supply))
        if unused:
            self._remark(unused[0], f"{', '.join(unused)} {'is' if len(unused) == 1 else 'are'} not taken")

    def _line(self, key: str) -> str:
        return "" if self._file is None else f", line {self._file.line(self.joint.name, key)},"

    def _remark(self, key: str, what: str) -> None:
        self.remarks.append(f"{self.file}{self._line(key)} joint {self.joint.name}: {what}")

    def _lack(self, what: str, key: str, example: str) -> None:
        supply = f"give it in --joint-limits as joint_limits.{self.joint.name}.{key}{example}"
        self.lacks.append(Defect(f"joint {self.joint.name}", what, supply))

    def _on(self, switch: str) -> bool | None:
        """Whether a switch of the file is on, as it is where it is not written; None if it is neither on nor off."""
        on = self.given.get(switch, True)
        if isinstance(on, bool):
            return on
        what = f"{switch} is {str(on)[:40]!r} in {self.file}, and neither true nor false"
        lack = Defect(f"joint {self.joint.name}", what, f"write joint_limits.{self.joint.name}.{switch}: true or false")
        if lack not in self.lacks:
            self.lacks.append(lack)
        return None

    def _named(self, key: str, kind: str) -> float | None:
        """A number of the file of limits; None where it is not given or switched off."""
        switch = f"has_{kind}_limits"
        on = self._on(switch)
        if key not in self.given:
            if self.given.get(switch) is True and kind in KINDS[1:]:
                self._lack(f"{switch} is true in {self.file}, and {key} is not given", key, f" ({self.unit}, s)")
            return None
        if not on:
            if on is False:
                self._remark(key, f"{key} is switched off by {switch}, and not taken")
            return None
        value = self.given[key]
        if isinstance(value, bool) or not isinstance(value, int | float):
            self._lack(f"{key} is {str(value)[:40]!r} in {self.file}, and no number", key, f" ({self.unit}, s)")
            return None
        return float(value)

    def _end(self, key: str) -> float | None:
        """An end of the range in the file of limits; one that is given and switched off at once is refused, for MoveIt
        takes it all the same."""
        switch = "has_position_limits"
        if self.given.get(key) is not None and self.given.get(switch) is False:
            what = f"{switch} is false in {self.file}, and {key} is given"
            self._lack(what, key, f", and {switch}: true; or remove {key}, and the URDF's end is taken")
            return None
        return self._named(key, "position")

    def _range(self) -> Number | None:
        """Both ends, each by itself as MoveIt takes them: the file's of limits, or else the URDF's; then the soft limit
        of the file, where it is narrower."""
        joint, unit = self.joint, self.unit
        ends: list[float] = []
        sources: dict[str, list[str]] = {}
        bounds: tuple[Bound, Bound] = ("lower", "upper")
        urdf, file = f"{self.urdf}, joint {joint.name}, ", f"{self.file}, joint_limits.{joint.name}."
        for key, soft, bound, inward in zip(ENDS, SOFT, bounds, (1.0, -1.0), strict=True):
            own = None if joint.kind == "continuous" else joint.bounds.get(bound)
            given = self._end(key)
            if given is None and own is None:
                if not self.lacks:
                    turns = "it turns without end (type continuous)"
                    what = turns if joint.kind == "continuous" else "no limit in the URDF"
                    self._lack(f"{what}, and our arms have ranges", "min_position", f" and max_position ({unit})")
                return None
            if given is not None and own is not None and inward * given < inward * own.value:
                self._looser(key, given, own.source, own.value)
            end, source, name = (given, file, key) if given is not None else (own.value, urdf, own.source)  # type: ignore[union-attr]
            narrower = self._named(soft, "soft")
            if narrower is not None and inward * narrower > inward * end:
                end, source, name = narrower, file, soft
            ends.append(end)
            sources.setdefault(source, []).append(name)
        if self.lacks:
            return None
        lower, upper = ends
        found = Number(ends, self.status, "; ".join(where + ", ".join(keys) for where, keys in sources.items()))
        if not lower < upper:
            what = f"its range is {lower:g} to {upper:g} {unit}"
            self._lack(what, "min_position", f" and max_position ({unit}), the first below the second")
            return None
        return found

    def _looser(self, key: str, value: float, source: str, own: float) -> None:
        self._remark(key, f"{key} {value:g} takes the place of the URDF's {source} {own:g}, which is narrower")

    def _required(self, kind: Bound) -> Number | None:
        """A number that every joint needs."""
        before = len(self.lacks)
        found = self._rate(kind)
        if found is None and len(self.lacks) == before:
            self._lack(f"no limit.{kind} in the URDF", f"max_{kind}", f" ({self.unit}{PER[kind]})")
        return found

    def _rate(self, kind: Bound) -> Number | None:
        """A number of the file of limits, or else of the URDF; None where neither has it, or it is not above 0. A
        deceleration may be below 0, as some planners of ROS require."""
        key, own, before = f"max_{kind}", self.joint.bounds.get(kind), len(self.lacks)
        value = self._named(key, kind)
        if value is None and (own is None or len(self.lacks) > before):
            return None
        if value is None and own is not None:
            if own.value > 0.0:
                return Number(own.value, self.status, f"{self.urdf}, joint {self.joint.name}, {own.source}")
            self._lack(f"{own.source} is {own.value:g} in the URDF", key, f" ({self.unit}{PER[kind]})")
            return None
        value = abs(value or 0.0) if kind == "deceleration" else value or 0.0
        if not value > 0.0:
            self._lack(f"{key} is {value:g} in {self.file}", key, f", a number above 0 ({self.unit}{PER[kind]})")
            return None
        if own is not None and 0.0 < own.value < value:
            self._looser(key, value, own.source, own.value)
        return Number(value, self.status, f"{self.file}, joint_limits.{self.joint.name}.{key}")


# A joint_limits.yaml, as MoveIt and ros2_control read it: its joints, and what of it is not taken.

KINDS = ("position", "velocity", "acceleration", "deceleration", "jerk")
"""What a joint may have limits of; those of a kind count if has_KIND_limits is not there or true."""
ENDS = ("min_position", "max_position")
SOFT = ("soft_lower_limit", "soft_upper_limit")
"""Ends of a range as in a URDF's safety_controller; they count if has_soft_limits is not there or true."""
KNOWN = (*(f"has_{kind}_limits" for kind in (*KINDS, "soft")), *ENDS, *(f"max_{kind}" for kind in KINDS[1:]), *SOFT)
"""Keys of a joint that are taken."""
NO_LIMITS = ("has_effort_limits", "max_effort", "angle_wraparound", "k_position", "k_velocity")
"""Keys of a joint that no plan depends on."""
NOT_OF_THE_ARM = ("default_velocity_scaling_factor", "default_acceleration_scaling_factor", "cartesian_limits")
"""Keys beside joint_limits whose meaning is known: shares of a motion, and limits of a tool."""
LIMITING = {"limit", "limits", "min", "max", *KINDS, "joint", "joints"}
"""Words of a key that may be of limits of joints."""


@dataclass(frozen=True)
class LimitsFile:
    """What is below `joint_limits` in a file, by joint and key; `remarks`: what else is in it, with its line."""

    name: str
    joints: dict[str, dict[str, Any]]
    remarks: tuple[str, ...]
    path: tuple[str, ...]
    lines: Lines

    def line(self, joint: str, key: str) -> int:
        """The line of a key of a joint."""
        return line_of(dotted((*self.path, joint, key)), self.lines)


def read_limits(content: bytes, name: str) -> LimitsFile:
    """The limits in a joint_limits.yaml: what is below `joint_limits`, at the root or below ROS parameters. Raises
    `ImportRefused`, which calls the file `name`."""
    try:
        document, lines = parse_yaml(content)
    except DocumentError as error:
        lack = Defect(f"line {error.line}", str(error.value), f"allowed is {error.allowed}")
        raise ImportRefused(name, [lack]) from error
    found: list[tuple[str, ...]] = []
    ahead: list[tuple[tuple[str, ...], Any]] = [((), document)]
    while ahead:
        path, here = ahead.pop(0)
        if isinstance(here, dict):
            for key, value in here.items():
                if (
                    key == "joint_limits"
                    and isinstance(value, dict)
                    and all(isinstance(j, dict) for j in value.values())
                ):
                    found.append((*path, key))
                else:
                    ahead.append(((*path, key), value))
    if not found:
        supply = "joint_limits: {JOINT: {has_acceleration_limits: true, max_acceleration: NUMBER}}"
        raise ImportRefused(name, [Defect("the file", "no mapping joint_limits with a mapping for each joint", supply)])
    if len(found) > 1:
        where = ", ".join(f"line {line_of(dotted(path), lines)}" for path in found)
        what = f"{len(found)} mappings joint_limits ({where})"
        raise ImportRefused(name, [Defect("the file", what, "leave the one of this arm")])
    (path,) = found
    lacks, remarks = _beside(document, path, lines)
    if lacks:
        raise ImportRefused(name, lacks)
    joints = document
    for key in path:
        joints = joints[key]
    return LimitsFile(name, joints, tuple(f"{name}, {remark}" for remark in remarks), path, lines)


def _beside(document: Any, path: tuple[str, ...], lines: Lines) -> tuple[list[Defect], list[str]]:
    """What is beside the way to joint_limits: refused if it may be limits of joints, else reported."""
    lacks: list[Defect] = []
    remarks: list[str] = []
    for depth, step in enumerate(path):
        for key in document:
            if key == step:
                continue
            line = line_of(dotted((*path[:depth], key)), lines)
            if key in NOT_OF_THE_ARM:
                remarks.append(f"line {line}: {key} is not taken: it is no limit of the arm's joints")
            elif LIMITING & set(key.lower().split("_")):
                what = f"{key!r} is not known, and may be limits of joints"
                lacks.append(Defect(f"line {line}", what, "put it below joint_limits, or remove it"))
            else:
                remarks.append(f"line {line}: {key!r} is not read")
        document = document[step]
    return lacks, remarks
