"""Arms of all families, upright or with links that tilt, and what their joints may do.

The upright ones are those of the simulation (`benchmarks.soak.arms`); the others are written from docs/conventions.md
and from K31 and H4 of docs/kinematics.md.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchmarks.oracle.places import Places
from benchmarks.soak.arms import Arm, Carried, ranges_of, robot_file
from benchmarks.soak.poses import Document, Floats, Poses, pose_in, si
from benchmarks.soak.solids import solid_of

TILTING = ("elbow_arm", "polar_arm", "five_axis_arm")


@dataclass(frozen=True, eq=False)
class TiltingArm:
    """An elbow arm, a polar arm or an arm with five axes where it stands; its tool point is the flange. `lengths`:
    of the links, m, and `height` of the shoulder above the base, m. q everywhere: joints (..., n), rad or m."""

    family: str
    lengths: tuple[float, ...]
    height: float
    base: Poses
    lower: Floats
    upper: Floats
    names: tuple[str, ...]
    bodies: tuple[Carried, ...]
    self_pairs: tuple[tuple[str, str], ...]
    signs: Floats
    tcp: Poses

    @staticmethod
    def of(document: Document) -> TiltingArm:
        """The arm of a request (`robot`), a shipped one."""
        ((family, given),) = robot_file(document["model"]).items()
        joints = given["joints"]
        ranges = ranges_of(document, joints)
        bodies = [Carried(b["name"], b["link"], solid_of(b["shape"]), pose_in(b)) for b in given["bodies"]["value"]]
        bodies += [
            Carried(b["name"], "flange", solid_of(b["shape"]), pose_in(b)) for b in document["tool"].get("bodies", [])
        ]
        keys = {"elbow_arm": ("l1", "l2"), "polar_arm": (), "five_axis_arm": ("l1", "l2", "l3")}[family]
        return TiltingArm(
            family,
            tuple(float(si(given, key)) for key in keys),
            float(si(given, "height")),
            pose_in(document.get("base", {})),
            ranges[:, 0],
            ranges[:, 1],
            tuple(joint["name"] for joint in joints),
            tuple(bodies),
            tuple((first, second) for first, second in given["self_pairs"]),
            np.ones(len(joints)),
            Poses.of(),
        )

    def links(self, q: Floats) -> dict[str, Places]:
        """Every link's frame in the world."""
        base = Places.upright(
            Poses(np.broadcast_to(self.base.p, (*q.shape[:-1], 3)), np.full(q.shape[:-1], self.base.yaw))
        )
        turret = base.then(Places.at([0.0, 0.0, self.height])).then(Places.turned(2, q[..., 0]))
        second = turret.then(Places.turned(1, -q[..., 1]))
        found = {"base": base, "link1": turret, "link2": second}
        if self.family == "polar_arm":
            ram = second.then(Places.at(q[..., 2, None] * np.array([1.0, 0.0, 0.0])))
            return {**found, "link3": ram, "flange": ram}
        third = second.then(Places.at([self.lengths[0], 0.0, 0.0])).then(Places.turned(1, -q[..., 2]))
        end = third.then(Places.at([self.lengths[1], 0.0, 0.0]))
        found["link3"] = third
        if self.family == "elbow_arm":
            return {**found, "flange": end}
        hand = end.then(Places.turned(1, -q[..., 3]))
        flange = hand.then(Places.at([self.lengths[2], 0.0, 0.0])).then(Places.turned(0, q[..., 4]))
        return {**found, "link4": hand, "flange": flange}


@dataclass(frozen=True, eq=False)
class Limits:
    """What joints may do, as the request narrows it: velocities, accelerations and jerks (n,), without a sign."""

    velocity: Floats
    acceleration: Floats
    jerk: Floats


def arm_of(document: Document) -> Arm | TiltingArm:
    """The arm of a request (`robot`), a shipped one of any family."""
    ((family, _),) = robot_file(document["model"]).items()
    return TiltingArm.of(document) if family in TILTING else Arm.of(document)


def limits_of(document: Document) -> Limits:
    """The limits of a request's robot."""
    ((_, given),) = robot_file(document["model"]).items()
    scales = document.get("limits", {})
    found = [
        np.array([float(_rate(joint, kind)) for joint in given["joints"]]) * float(scales.get(kind, 1.0))
        for kind in ("velocity", "acceleration", "jerk")
    ]
    return Limits(*found)


def world_links(arm: Arm | TiltingArm, q: Floats) -> dict[str, Places]:
    """Every link's frame in the world, as places, at joints (..., n)."""
    found = {}
    for name, place in arm.links(q).items():
        found[name] = place if isinstance(place, Places) else Places.upright(place)
    return found


RATES = {"velocity": "s", "acceleration": "s2", "jerk": "s3"}
UNITS = {"rad": 1.0, "deg": np.pi / 180.0, "m": 1.0, "mm": 1e-3}


def _rate(joint: Document, kind: str) -> float:
    for unit, factor in UNITS.items():
        key = f"{kind}_{unit}_{RATES[kind]}"
        if key in joint:
            value = joint[key]
            return float(value["value"] if isinstance(value, dict) else value) * factor
    raise KeyError(kind)
