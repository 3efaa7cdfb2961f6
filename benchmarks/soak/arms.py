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

from benchmarks.oracle.places import Places, short
from benchmarks.soak.poses import Document, Floats, Poses, pose_in, si
from benchmarks.soak.solids import Solid, solid_of

UPRIGHT = ("scara", "five_bar")
"""Families whose links turn about the vertical only."""
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
    """An arm with its tool at its base. `q` everywhere: joints (..., n) as the maker counts them, rad or m."""

    family: str
    numbers: Document
    signs: Floats
    order: tuple[int, ...]
    base: Poses
    lower: Floats
    upper: Floats
    names: tuple[str, ...]
    bodies: tuple[CarriedBody, ...]
    self_pairs: tuple[tuple[str, str], ...]
    tcp: Poses

    @staticmethod
    def of(document: Document) -> Arm:
        """The arm of a request (`robot`), a shipped one."""
        ((family, given),) = robot_file(document["model"]).items()
        joints = given["joints"]
        ranges = ranges_of(document, joints)
        order = (0, 2, 1, 3) if given.get("axis_order") == "rprr" else tuple(range(len(joints)))
        down, tool = given.get("tool_frame") == "z_down", document["tool"]
        bodies = [_carried(each, each["link"], down) for each in given["bodies"]["value"]]
        bodies += [_carried(each, "flange", down) for each in tool.get("bodies", [])]
        tcp = Poses.of(si(tool, "tcp"), si(tool, "tcp_yaw", 0.0))
        return Arm(
            family=family,
            numbers=given,
            signs=np.array([float(joint.get("sign", 1)) for joint in joints]),
            order=order,
            base=pose_in(document.get("base", {})),
            lower=ranges[:, 0],
            upper=ranges[:, 1],
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
    def height(self) -> float:
        """Of the shoulder of an arm that tilts above its base, m."""
        return float(si(self.numbers, "height"))

    @property
    def lengths(self) -> list[float]:
        """Of the links of an arm that tilts, m; a polar arm has none."""
        of_family = {"elbow_arm": ("l1", "l2"), "polar_arm": (), "five_axis_arm": ("l1", "l2", "l3")}[self.family]
        return [float(si(self.numbers, key)) for key in of_family]

    def places(self, q: Floats) -> dict[str, Places]:
        """Every link's frame in the world, of an arm of any family, at joints (..., n)."""
        if self.tilts:
            return self._tilting(q * self.signs)
        return {name: Places.upright(pose) for name, pose in self.links(q).items()}

    def tool(self, q: Floats) -> Places:
        """The tool point in the world, of an arm of any family, at joints (..., n)."""
        return self.places(q)["flange"].then(Places.upright(self.tcp))

    def links(self, q: Floats) -> dict[str, Poses]:
        """Every link's frame in the world. Raises `ValueError` for an arm that tilts."""
        if self.tilts:
            raise ValueError(f"an arm that the simulation does not know: {self.family}")
        ours = (q * self.signs)[..., list(self.order)]
        lift = ours[..., 2] if ours.shape[-1] > 2 else np.zeros(ours.shape[:-1])
        zero = float(si(self.numbers["joints"][self.order[2]], "zero", 0.0))
        flange_z = self.base.p[2] + zero + lift
        return self._scara(ours, lift, flange_z) if self.family == "scara" else self._five_bar(ours, flange_z)

    def tool_point(self, links: dict[str, Poses]) -> Poses:
        return links["flange"].then(self.tcp)

    def _scara(self, q: Floats, lift: Floats, flange_z: Floats) -> dict[str, Poses]:
        l1, l2 = float(si(self.numbers, "l1")), float(si(self.numbers, "l2"))
        first = self.base.yaw + q[..., 0]
        second = first + q[..., 1]
        fourth = second + q[..., 3] if q.shape[-1] > 3 else second
        raised = lift if self.order[1] == 2 else np.zeros_like(lift)
        base = self.base.p
        x, y = base[0] + l1 * np.cos(first), base[1] + l1 * np.sin(first)
        tip_x, tip_y = x + l2 * np.cos(second), y + l2 * np.sin(second)
        tip = np.stack([tip_x, tip_y, flange_z], axis=-1)
        shoulder = np.stack(np.broadcast_arrays(base[0], base[1], base[2] + raised), axis=-1)
        return {
            "base": self.base.still(first.shape),
            "link1": Poses(np.broadcast_to(shoulder, tip.shape), first),
            "link2": Poses(np.stack([x, y, base[2] + raised], axis=-1), second),
            "quill": Poses(tip, np.zeros_like(first)),
            "flange": Poses(tip, fourth),
        }

    def _five_bar(self, q: Floats, flange_z: Floats) -> dict[str, Poses]:
        separation = float(si(self.numbers, "separation"))
        cranks, couplers = si(self.numbers, "proximal"), si(self.numbers, "distal")
        psi, found, elbows = self.base.yaw, dict[str, Poses](), []
        shape = (*q.shape[:-1], 3)
        for side, name in enumerate(("left", "right")):
            angle = psi + q[..., side]
            across = np.array([0.0, (0.5 if side == 0 else -0.5) * separation, 0.0])
            pivot = self.base.then(Poses.of(across)).p
            found[f"proximal-{name}"] = Poses(np.broadcast_to(pivot, shape), angle)
            along = np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=-1)
            elbows.append(pivot + float(cranks[side]) * along)
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
            found[f"distal-{name}"] = Poses(elbows[side], np.arctan2(way[..., 1], way[..., 0]))
        flange = np.concatenate([tip[..., :2], flange_z[..., None]], axis=-1)
        turn = found["distal-left"].yaw + (q[..., 3] if q.shape[-1] > 3 else 0.0)
        found["base"] = self.base.still(length.shape)
        return {**found, "quill": Poses(flange, np.zeros_like(length)), "flange": Poses(flange, turn)}

    def _tilting(self, q: Floats) -> dict[str, Places]:
        base = Places.upright(self.base.still(q.shape[:-1]))
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

    def corrected(self, q: Floats, shift: Floats) -> Floats:
        """The joints (..., n) that shift the tool of a SCARA by (..., 3), m, and leave its yaw; NaN out of reach."""
        ours = (q * self.signs)[..., list(self.order)].copy()
        l1, l2 = float(si(self.numbers, "l1")), float(si(self.numbers, "l2"))
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


def _flipped(pose: Poses) -> Poses:
    """A pose in a flange frame whose z points down, in one that is upright and has the same x axis."""
    return Poses(pose.p * (1.0, -1.0, -1.0), -pose.yaw)


def _carried(given: Document, link: str, down: bool) -> CarriedBody:
    pose = pose_in(given)
    solid = solid_of(given["shape"])
    return CarriedBody(given["name"], link, solid, _flipped(pose) if down and link == "flange" else pose)


@cache
def robot_file(model: str) -> Any:
    """What the file of a shipped robot says."""
    return yaml.safe_load((ROBOTS / f"{model}.yaml").read_text(encoding="utf-8"))
