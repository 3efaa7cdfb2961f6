"""A robot's file in our form, as text: every number with its status and its source, one body a line."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

from assur.scenes.urdf.families import Kinematics
from assur.scenes.urdf.limits import Limits, Number


@dataclass(frozen=True, eq=False)
class ArmText:
    """What a robot's file says. `stated`: status and source of lengths and zeros; `solids`: those of bodies."""

    name: str
    title: str
    about: str
    kinematics: Kinematics
    joints: tuple[tuple[str, bool, Limits], ...]
    """Name of ours, whether it turns, limits."""
    stated: tuple[str, str]
    solids: tuple[str, str]
    bodies: tuple[dict[str, Any], ...] = ()
    pairs: tuple[tuple[str, str], ...] = ()

    def text(self) -> str:
        """The file."""
        kinematics = self.kinematics
        lines = [f"{kinematics.family}:"]
        lines += [f"  {key}: {_flow(value)}" for key, value in (("name", self.name), ("title", self.title))]
        lines.append(f"  about: {_flow(self.about)}")
        lines += [f"  {key}: {self._fact(round_off(value))}" for key, value in kinematics.lengths.items()]
        if any(abs(value) > 0.0 for value in kinematics.offset):
            lines.append(f"  base_offset_m: {self._fact([round_off(value) for value in kinematics.offset])}")
        if kinematics.family == "scara":
            lines.append(f"  axis_order: {kinematics.order}")
            lines.append(f"  tool_frame: {'z_down' if kinematics.z_down else 'z_up'}")
        lines.append("  joints:")
        for i, (name, turns, limits) in enumerate(self.joints):
            unit = "rad" if turns else "m"
            lines.append(f"    - name: {_flow(name)}")
            if kinematics.signs[i] < 0:
                lines.append("      sign: -1")
            zero = round_off(kinematics.zeros[i])
            if zero != 0.0:
                lines.append(f"      zero_{unit}: {self._fact(zero)}")
            lines.append(f"      range_{unit}: {_number(limits.range)}")
            lines.append(f"      velocity_{unit}_s: {_number(limits.velocity)}")
            lines.append(f"      acceleration_{unit}_s2: {_number(limits.acceleration)}")
            lines.append(f"      jerk_{unit}_s3: {_number(limits.jerk)}")
        status, source = self.solids
        lines += ["  bodies:", f"    status: {status}", f"    source: {_flow(source)}"]
        lines.append("    value:" if self.bodies else "    value: []")
        lines += [f"      - {_flow(body)}" for body in self.bodies]
        lines.append(f"  self_pairs: {_flow([list(pair) for pair in self.pairs])}")
        return "\n".join(lines) + "\n"

    def _fact(self, value: float | list[float]) -> str:
        return _number(Number(value, *self.stated))


def round_off(value: float) -> float:
    """A length or an angle without the rounding of its computation: a picometre, a picoradian."""
    return round(value, 12) + 0.0


def _number(number: Number) -> str:
    return f"{{value: {_flow(number.value)}, status: {number.status}, source: {_flow(number.source)}}}"


def _flow(value: Any) -> str:
    """Plain data as YAML in one line. Every text is in quotes: some are words of YAML (null, true, on)."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {_flow(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(_flow(item) for item in value) + "]"
    if isinstance(value, str):
        return "".join(c if c.isprintable() else f"\\U{ord(c):08x}" for c in json.dumps(value, ensure_ascii=False))
    return repr(float(value)) if isinstance(value, float) else str(value)
