"""Where the links of arms of all families are, from the robots' files (`scenes/robots`), maker's joints in, world out.

Frames and signs are those of docs/conventions.md, and of K31 and H4 of docs/kinematics.md. A belt correction is worked
out exactly: the tool axis is shifted, the elbow stays on its side, and the tool keeps its yaw.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray

from benchmarks.judge.poses import Document, Floats, Poses, pose_in, short, si
from benchmarks.judge.solids import Solid, solid_of

UPRIGHT = ("scara", "five_bar")
"""Families whose links turn about the vertical only."""
FAMILIES = (*UPRIGHT, "elbow_arm", "polar_arm", "five_axis_arm")
ROBOTS = Path(__file__).resolve().parents[2] / "scenes" / "robots"


@dataclass(frozen=True, eq=False)
class CarriedBody:
    """A solid of the robot: on which link, and its pose there (...)."""

    name: str
    link: str
    solid: Solid
    pose: Poses


@dataclass(frozen=True, eq=False)
class Arm:
    """An arm with its tool at its base. `q` everywhere: joints (..., n) as the maker counts them, rad or m; `velocity`,
    `acceleration` and `jerk`: what they may do, without a sign."""

    family: str
    numbers: Document
    signs: Floats
    order: tuple[int, ...]
    base: Poses
    lower: Floats
    upper: Floats
    velocity: Floats
    acceleration: Floats
    jerk: Floats
    names: tuple[str, ...]
    bodies: tuple[CarriedBody, ...]
    self_pairs: tuple[tuple[str, str], ...]
    tcp: Poses

    @staticmethod
    def of(document: Document) -> Arm:
        """The arm of a request (`robot`): a shipped one, or one that the request writes out."""
        family, given = family_of(document)
        joints, scales = given["joints"], document.get("limits", {})
        ranges = ranges_of(document, joints)
        order = (0, 2, 1, 3) if given.get("axis_order") == "rprr" else tuple(range(len(joints)))
        down, tool = given.get("tool_frame") == "z_down", document["tool"]
        own = given["bodies"]
        bodies = [_carried(each, each["link"], down) for each in (own["value"] if isinstance(own, dict) else own)]
        bodies += [_carried(each, "flange", down) for each in tool.get("bodies", [])]
        tcp = Poses.of(si(tool, "tcp"), si(tool, "tcp_yaw", 0.0))
        rates = {key: float(scales.get(key, 1.0)) * np.array([rate(joint, key) for joint in joints]) for key in RATES}
        return Arm(
            family=family,
            numbers=given,
            signs=np.array([float(joint.get("sign", 1)) for joint in joints]),
            order=order,
            base=pose_in(document.get("base", {})),
            lower=ranges[:, 0],
            upper=ranges[:, 1],
            **rates,
            names=tuple(joint["name"] for joint in joints),
            bodies=tuple(bodies),
            self_pairs=tuple((first, second) for first, second in given["self_pairs"]),
            tcp=_flipped(tcp) if down else tcp,
        )

    @property
    def tilts(self) -> bool:
        """Whether links leave the vertical."""
        return self.family not in UPRIGHT

    @property
    def turns(self) -> bool:
        """Whether the arm has a yaw of its own: an upright one with a wrist."""
        return not self.tilts and len(self.names) > 3

    @property
    def slides(self) -> NDArray[np.bool_]:
        """Which joints slide."""
        return self.upper - self.lower < 0.5

    def named(self, values: Floats, units: tuple[str, str] = ("rad", "m")) -> dict[str, float]:
        """Values of all joints as a request states them, with the units of a turning and of a sliding one."""
        each = zip(self.names, self.slides, values, strict=True)
        return {f"{name}_{units[int(slides)]}": float(value) for name, slides, value in each}

    def values(self, document: Document, units: tuple[str, str] = ("rad", "m")) -> Floats:
        """What a request states of all joints, the other way round."""
        return np.array([next(document[f"{n}_{u}"] for u in units if f"{n}_{u}" in document) for n in self.names])

    def length(self, key: str) -> float:
        """A length of the robot's file, m."""
        return float(si(self.numbers, key))

    @property
    def lengths(self) -> list[float]:
        """Of the links of an arm that tilts, m; a polar arm has none."""
        of_family = {"elbow_arm": ("l1", "l2"), "polar_arm": (), "five_axis_arm": ("l1", "l2", "l3")}[self.family]
        return [self.length(key) for key in of_family]

    @property
    def zero(self) -> float:
        """The height of the flange of an upright arm above its base with the lift at 0, m."""
        return float(si(self.numbers["joints"][self.order[2]], "zero", 0.0))

    def links(self, q: Floats) -> dict[str, Poses]:
        """Every link's frame in the world."""
        ours = q * self.signs
        if self.tilts:
            return self._tilting(ours)
        ours = ours[..., list(self.order)]
        lift = ours[..., 2] if ours.shape[-1] > 2 else np.zeros(ours.shape[:-1])
        flange_z = self.base.p[2] + self.zero + lift
        return self._scara(ours, lift, flange_z) if self.family == "scara" else self._five_bar(ours, flange_z)

    def tool(self, q: Floats) -> Poses:
        """The tool point in the world."""
        return self.links(q)["flange"].then(self.tcp)

    def _scara(self, q: Floats, lift: Floats, flange_z: Floats) -> dict[str, Poses]:
        l1, l2 = self.length("l1"), self.length("l2")
        first = self.base.yaw + q[..., 0]
        second = first + q[..., 1]
        fourth = second + q[..., 3] if q.shape[-1] > 3 else second
        base = self.base.p
        shoulder_z = np.broadcast_to(base[2] + (lift if self.order[1] == 2 else 0.0), first.shape)
        x, y = base[0] + l1 * np.cos(first), base[1] + l1 * np.sin(first)
        tip = np.stack([x + l2 * np.cos(second), y + l2 * np.sin(second), flange_z], axis=-1)
        shoulder = np.stack(np.broadcast_arrays(base[0], base[1], shoulder_z), axis=-1)
        return {
            "base": self.base.still(first.shape),
            "link1": Poses.of(shoulder, first),
            "link2": Poses.of(np.stack([x, y, shoulder_z], axis=-1), second),
            "quill": Poses.of(tip),
            "flange": Poses.of(tip, fourth),
        }

    def _five_bar(self, q: Floats, flange_z: Floats) -> dict[str, Poses]:
        separation = self.length("separation")
        cranks, couplers = si(self.numbers, "proximal"), si(self.numbers, "distal")
        psi, found, elbows = self.base.yaw, dict[str, Poses](), []
        for side, name in enumerate(("left", "right")):
            angle = psi + q[..., side]
            across = np.array([0.0, (0.5 if side == 0 else -0.5) * separation, 0.0])
            found[f"proximal-{name}"] = Poses.of(self.base.points(across), angle)
            elbows.append(found[f"proximal-{name}"].points((float(cranks[side]), 0.0, 0.0)))
        between = elbows[1] - elbows[0]
        length = np.hypot(between[..., 0], between[..., 1])
        left, right = float(couplers[0]), float(couplers[1])
        part = (length**2 + left**2 - right**2) / (2.0 * length)
        off = np.sqrt(left**2 - part**2)  # NaN where the couplers do not meet
        if self.numbers["assembly"] == "back":
            off = -off
        unit = between / length[..., None]
        across = np.stack([-unit[..., 1], unit[..., 0], np.zeros_like(length)], axis=-1)
        tip = elbows[0] + part[..., None] * unit + off[..., None] * across
        for side, name in enumerate(("left", "right")):
            way = tip - elbows[side]
            found[f"distal-{name}"] = Poses.of(elbows[side], np.arctan2(way[..., 1], way[..., 0]))
        flange = np.concatenate([tip[..., :2], flange_z[..., None]], axis=-1)
        turn = found["distal-left"].yaw + (q[..., 3] if q.shape[-1] > 3 else 0.0)
        return {
            **found,
            "base": self.base.still(length.shape),
            "quill": Poses.of(flange),
            "flange": Poses.of(flange, turn),
        }

    def _tilting(self, q: Floats) -> dict[str, Poses]:
        base = self.base.still(q.shape[:-1])
        turret = base.then(Poses.of((0.0, 0.0, self.length("height")), q[..., 0]))
        second = turret.then(Poses.turned(1, -q[..., 1]))
        found = {"base": base, "link1": turret, "link2": second}
        if self.family == "polar_arm":
            ram = second.then(Poses.of(q[..., 2, None] * np.array([1.0, 0.0, 0.0])))
            return {**found, "link3": ram, "flange": ram}
        third = second.then(Poses.of((self.lengths[0], 0.0, 0.0))).then(Poses.turned(1, -q[..., 2]))
        end = third.then(Poses.of((self.lengths[1], 0.0, 0.0)))
        found["link3"] = third
        if self.family == "elbow_arm":
            return {**found, "flange": end}
        hand = end.then(Poses.turned(1, -q[..., 3]))
        flange = hand.then(Poses.of((self.lengths[2], 0.0, 0.0))).then(Poses.turned(0, q[..., 4]))
        return {**found, "link4": hand, "flange": flange}

    def corrected(self, q: Floats, shift: Floats) -> Floats:
        """The joints (..., n) that shift the tool of a SCARA by (..., 3), m, and leave its yaw; NaN out of reach.

        Raises `ValueError` for an arm of another family."""
        if self.family != "scara":
            raise ValueError(f"a belt correction of an arm that has none: {self.family}")
        ours = (q * self.signs)[..., list(self.order)].copy()
        l1, l2 = self.length("l1"), self.length("l2")
        one, both = self.base.yaw + ours[..., 0], self.base.yaw + ours[..., 0] + ours[..., 1]
        x = l1 * np.cos(one) + l2 * np.cos(both) + shift[..., 0]
        y = l1 * np.sin(one) + l2 * np.sin(both) + shift[..., 1]
        cosine = (x**2 + y**2 - l1**2 - l2**2) / (2.0 * l1 * l2)
        inside = np.abs(cosine) <= 1.0
        elbow = np.copysign(np.arccos(np.where(inside, cosine, np.nan)), np.sin(ours[..., 1]))
        elbow = ours[..., 1] + short(elbow - ours[..., 1])
        shoulder = np.arctan2(y, x) - np.arctan2(l2 * np.sin(elbow), l1 + l2 * np.cos(elbow))
        turn = short(shoulder - one)
        if ours.shape[-1] > 3:
            ours[..., 3] -= turn + elbow - ours[..., 1]
        ours[..., 0] += turn
        ours[..., 1] = elbow
        ours[..., 2] += shift[..., 2]
        back = np.empty_like(q)
        back[..., list(self.order)] = ours
        return back * self.signs


def ranges_of(document: Document, joints: list[Document]) -> Floats:
    """The ranges (n, 2) of joints of a robot's file, rad or m, as a request (`robot`) narrows them."""
    ranges = np.array([si(joint, "range") for joint in joints])
    for name, limit in document.get("limits", {}).items():
        for j, joint in enumerate(joints):
            if name in (f"{joint['name']}_rad", f"{joint['name']}_m"):
                ranges[j] = limit
    return ranges


RATES = {"velocity": "_s", "acceleration": "_s2", "jerk": "_s3"}
"""Ends of the keys of rates, behind the unit of the joint's position."""


def rate(joint: Document, kind: str) -> float:
    """The velocity, acceleration or jerk that a joint in a robot's file may have, in SI."""
    end = RATES[kind]
    return float(si({key.removesuffix(end): value for key, value in joint.items() if key.endswith(end)}, kind))


def tilt(links: dict[str, Poses]) -> tuple[Floats, Floats]:
    """Pitch and roll (...) of an arm with five axes, from the rotation of its flange against its turret (H9)."""
    m = links["link1"].inverse().then(links["flange"]).r
    return np.arctan2(m[..., 2, 0], m[..., 0, 0]), np.arctan2(-m[..., 1, 2], m[..., 1, 1])


def _flipped(pose: Poses) -> Poses:
    """A pose in a flange frame whose z points down, in one that is upright and has the same x axis."""
    return Poses.of(pose.p * (1.0, -1.0, -1.0), -pose.yaw)


def _carried(given: Document, link: str, down: bool) -> CarriedBody:
    pose = pose_in(given)
    solid = solid_of(given["shape"])
    return CarriedBody(given["name"], link, solid, _flipped(pose) if down and link == "flange" else pose)


def family_of(document: Document) -> tuple[str, Document]:
    """The family of a request's robot, and what its file or the request says of it."""
    if "model" in document:
        ((family, given),) = robot_file(document["model"]).items()
        return family, given
    return next((key, document[key]) for key in FAMILIES if key in document)


@cache
def robot_file(model: str) -> Any:
    """What the file of a shipped robot says."""
    return yaml.safe_load((ROBOTS / f"{model}.yaml").read_text(encoding="utf-8"))
