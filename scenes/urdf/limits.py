"""Limits of the joints, from the URDF and a joint_limits.yaml as MoveIt reads it; what is in neither is missing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from assur.scenes.faults import DocumentError
from assur.scenes.text.yaml_text import parse_yaml
from assur.scenes.urdf.chain import Chain
from assur.scenes.urdf.refusals import ImportRefused, Lack
from assur.scenes.urdf.tree import Joint

JERK_TIME_S = 0.02
"""Where no jerk is given: the acceleration is reached in this time, as for every shipped robot."""
JERK_SOURCE = "acceleration / 20 ms, for no maker publishes it"
KEYS = {"velocity": "max_velocity", "acceleration": "max_acceleration", "jerk": "max_jerk"}
"""Keys of a joint in joint_limits.yaml; each counts if has_velocity_limits and so on is not there or true."""
ENDS = ("min_position", "max_position")


@dataclass(frozen=True, slots=True)
class Number:
    """A number of a joint, or both ends of its range, in SI with whose word it is."""

    value: float | list[float]
    status: str
    source: str


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits of one joint in the file's count."""

    range: Number
    velocity: Number
    acceleration: Number
    jerk: Number


def read_limits(content: bytes, name: str) -> dict[str, dict[str, Any]]:
    """The joints of a joint_limits.yaml: what is below `joint_limits`, at the root or below ROS parameters. Raises
    `ImportRefused`, which calls the file `name`."""
    try:
        document, _ = parse_yaml(content)
    except DocumentError as error:
        lack = Lack(f"line {error.line}", str(error.value), f"allowed is {error.allowed}")
        raise ImportRefused(name, [lack]) from error
    ahead = [document]
    while ahead:
        here = ahead.pop(0)
        if isinstance(here, dict):
            found = here.get("joint_limits")
            if isinstance(found, dict) and all(isinstance(joint, dict) for joint in found.values()):
                return found
            ahead += here.values()
    supply = "joint_limits: {JOINT: {has_acceleration_limits: true, max_acceleration: NUMBER}}"
    raise ImportRefused(name, [Lack("the file", "no mapping joint_limits with a mapping for each joint", supply)])


def limits_of(
    chain: Chain, given: dict[str, dict[str, Any]], files: tuple[str, str | None], status: str
) -> tuple[list[Limits | None], list[Lack]]:
    """The limits of each joint, None where something is missing, and all that is missing.

    `given`: of `read_limits`; `files`: names of the URDF and of the file of limits; `status`: whose word they are.
    """
    found, lacks = [], []
    for joint in chain.joints:
        reader = _Reader(joint, given.get(joint.name, {}), files, status)
        found.append(reader.read())
        lacks += reader.lacks
    return found, lacks


class _Reader:
    """What is known of one joint."""

    def __init__(self, joint: Joint, given: dict[str, Any], files: tuple[str, str | None], status: str) -> None:
        self.joint, self.given, (self.urdf, self.file), self.status = joint, given, files, status
        self.lacks: list[Lack] = []

    def read(self) -> Limits | None:
        ends, velocity, acceleration = self._range(), self._rate("velocity"), self._rate("acceleration")
        jerk = None if acceleration is None else self._jerk(acceleration)
        if ends is None or velocity is None or acceleration is None or jerk is None or self.lacks:
            return None
        return Limits(ends, velocity, acceleration, jerk)

    def _lack(self, what: str, key: str, example: str) -> None:
        supply = f"give it in --joint-limits as joint_limits.{self.joint.name}.{key}{example}"
        self.lacks.append(Lack(f"joint {self.joint.name}", what, supply))

    def _of_urdf(self, value: float, what: str) -> Number:
        return Number(value, self.status, f"{self.urdf}, joint {self.joint.name}, {what}")

    def _of_file(self, value: float, what: str) -> Number:
        return Number(value, self.status, f"{self.file}, joint_limits.{self.joint.name}.{what}")

    def _named(self, key: str, switch: str) -> float | None:
        """A number of the file of limits; None where it is not given or switched off."""
        value, unit = self.given.get(key), "rad" if self.joint.kind != "prismatic" else "m"
        on = self.given.get(switch, True)
        if not isinstance(on, bool):
            what = f"{switch} is {str(on)[:40]!r} in {self.file}, and neither true nor false"
            lack = Lack(
                f"joint {self.joint.name}", what, f"write joint_limits.{self.joint.name}.{switch}: true or false"
            )
            if lack not in self.lacks:
                self.lacks.append(lack)
            return None
        if value is None or not on:
            return None
        if isinstance(value, bool) or not isinstance(value, int | float):
            self._lack(f"{key} is {str(value)[:40]!r} in {self.file}, and no number", key, f" ({unit}, s)")
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
        return self._named(key, switch)

    def _range(self) -> Number | None:
        """Both ends, each by itself as MoveIt takes them: the file's of limits, or else the URDF's."""
        joint, unit = self.joint, "m" if self.joint.kind == "prismatic" else "rad"
        own = [None if joint.kind == "continuous" else end for end in (joint.lower, joint.upper)]
        ends: list[float] = []
        sources: dict[str, list[str]] = {}
        for key, said, end in zip(ENDS, joint.ends, own, strict=True):
            given = self._end(key)
            if given is None and end is None:
                if not self.lacks:
                    turns = "it turns without end (type continuous)"
                    what = turns if joint.kind == "continuous" else "no limit in the URDF"
                    self._lack(f"{what}, and our arms have ranges", "min_position", f" and max_position ({unit})")
                return None
            ends.append(given if given is not None else end or 0.0)
            urdf, file = f"{self.urdf}, joint {joint.name}, ", f"{self.file}, joint_limits.{joint.name}."
            where = urdf if given is None else file
            sources.setdefault(where, []).append(said if given is None else key)
        if self.lacks:
            return None
        lower, upper = ends
        found = Number(ends, self.status, "; ".join(where + ", ".join(keys) for where, keys in sources.items()))
        if not lower < upper:
            what = f"its range is {lower:g} to {upper:g} {unit}"
            self._lack(what, "min_position", f" and max_position ({unit}), the first below the second")
            return None
        return found

    def _rate(self, kind: str) -> Number | None:
        key, unit = KEYS[kind], "m" if self.joint.kind == "prismatic" else "rad"
        unit += "/s" if kind == "velocity" else "/s2"
        before = len(self.lacks)
        value = self._named(key, f"has_{kind}_limits")
        if value is not None:
            if not value > 0.0:
                self._lack(f"{key} is {value:g} in {self.file}", key, f", a number above 0 ({unit})")
                return None
            return self._of_file(value, key)
        if len(self.lacks) > before:
            return None
        if kind == "velocity":
            value = self.joint.velocity
            if value is not None and value > 0.0:
                return self._of_urdf(value, "limit.velocity")
            what = "no limit.velocity" if value is None else f"limit.velocity is {value:g}"
            self._lack(f"{what} in the URDF", key, f" ({unit})")
        else:
            self._lack("no acceleration, which no URDF has", key, f" ({unit})")
        return None

    def _jerk(self, acceleration: Number) -> Number | None:
        key, before = KEYS["jerk"], len(self.lacks)
        value = self._named(key, "has_jerk_limits")
        if value is None:
            if len(self.lacks) > before:
                return None
            return Number(float(f"{_single(acceleration.value) / JERK_TIME_S:.12g}"), "estimated", JERK_SOURCE)
        if not value > 0.0:
            self._lack(f"{key} is {value:g} in {self.file}", key, ", a number above 0")
            return None
        return self._of_file(value, key)


def _single(value: float | list[float]) -> float:
    return value if isinstance(value, float) else value[0]


def unused(chain: Chain, given: dict[str, dict[str, Any]]) -> list[str]:
    """Joints of a file of limits that the arm has not."""
    names = {joint.name for joint in chain.tree.joints.values()}
    return [name for name in given if name not in names]
