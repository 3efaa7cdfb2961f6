"""A request as the judge reads it: places and supports of bodies, and which pairs of bodies count when."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np

from benchmarks.judge.arms import Arm, CarriedBody
from benchmarks.judge.laws import Frame, drift, frames_of, seat, seat_then
from benchmarks.judge.poses import Document, Floats, Poses, pose_in, si
from benchmarks.judge.solids import Shape, Solid, shape_of, solid_of, tilted
from benchmarks.judge.stages import CONTACT_M, TRACKING, Pair, Stage, clearance


@dataclass(frozen=True, eq=False)
class Cell:
    """`seats`: frame and pose of each body that is not held at the start; `solids` of all bodies by name; `carried`:
    the robot's; `unknown_of`: what is not known of parts."""

    request: Document
    arm: Arm
    frames: dict[str, Frame]
    seats: dict[str, tuple[str, Poses]]
    solids: dict[str, Solid]
    carried: dict[str, CarriedBody]
    unknown_of: dict[str, Document]
    lag: Floats

    @staticmethod
    def of(request: Document) -> Cell:
        """The cell of a request in SI. Raises `ValueError` for a shape that the judge does not know."""
        arm, frames = Arm.of(request["robot"]), frames_of(request)
        carried = {each.name: each for each in arm.bodies}
        solids = {each.name: each.solid for each in arm.bodies}
        seats: dict[str, tuple[str, Poses]] = {}
        for neighbour in request.get("neighbours", []):
            for each in Arm.of(neighbour["robot"]).bodies:
                name = f"{neighbour['name']}/{each.name}"
                solids[name], seats[name] = each.solid, (f"{neighbour['name']}/{each.link}", each.pose)
        for body in request.get("bodies", []):
            solids[body["name"]] = _solid(body)
            if "pose" in body and "body" in body["pose"]:
                below, pose = seats[body["pose"]["body"]]
                seats[body["name"]] = below, pose.then(pose_in(body["pose"]))
            elif "at_s" in body.get("pose", {}):
                seats[body["name"]] = seat_then(request, frames, body["pose"])
            elif "pose" in body:
                seats[body["name"]] = seat(request, frames, body["pose"])
        lag = request.get("execution", {}).get("lag", {})
        amounts = np.array([lag.get(f"{name}_rad", lag.get(f"{name}_m", 0.0)) for name in arm.names])
        unknown = {}
        for body in request.get("bodies", []):
            own, far = body.get("uncertainty", {}), drift(request, frames, body.get("pose", {}))
            if own or far:
                unknown[body["name"]] = own | {"position_m": own.get("position_m", 0.0) + far}
        return Cell(request, arm, frames, seats, solids, carried, unknown, amounts)

    @cached_property
    def shapes(self) -> dict[str, Shape]:
        """All bodies by name, as `Gap` measures distances."""
        return {name: shape_of(solid) for name, solid in self.solids.items()}

    @property
    def start_s(self) -> float:
        return float(self.request["start"].get("at_s", 0.0))

    @property
    def corrected(self) -> bool:
        return bool(self.request.get("execution", {}).get("belt_correction", False))

    @property
    def tool_bodies(self) -> list[str]:
        return [body["name"] for body in self.request["robot"]["tool"].get("bodies", [])]

    def seat(self, pose: Document) -> tuple[str, Poses]:
        """Frame with a law, and pose in it, of a target."""
        if "body" in pose:
            frame, below = self.seats[pose["body"]]
            return frame, below.then(pose_in(pose))
        return seat(self.request, self.frames, pose)

    @property
    def held(self) -> tuple[str, Poses] | None:
        """The part in the gripper at the start, and its planned pose in the flange."""
        given = self.request["start"].get("holding")
        return None if given is None else (given["part"], self.arm.tcp.then(grasp_of(given).inverse()))

    def grasped(self, pick: Document, arrival: Document) -> Poses:
        """A picked part's planned pose in the flange."""
        return self.arm.tcp.then(grasp_of(pick, arrival["yaw_offset_rad"]).inverse())

    def tracked_spans(self, answer: Document) -> list[tuple[str, float, float]]:
        """The frames that steps track, from when until when."""
        spans: list[tuple[str, float, float]] = []
        moved: dict[str, str] = {}
        for number, step in enumerate(self.request["task"]):
            ((kind, given),) = step.items()
            legs = [leg for leg in answer["legs"] if leg["step"] == number and leg["kind"] in TRACKING]
            if kind == "pick":
                name = moved.get(given["part"]) or self.seats[given["part"]][0]
            else:
                name = self.seat(given["to"])[0]
            if kind == "place":
                moved[given["part"]] = name
            if legs:
                spans.append((name, legs[0]["from_s"], legs[-1]["to_s"]))
        return spans

    def resting_on(
        self,
        part: str,
        frame: str,
        pose: Poses,
        names: list[str] | None,
        time: float,
        seats: dict[str, str],
        poses: dict[str, Poses],
    ) -> list[str]:
        """The supports of a part: the named bodies, or those under it whose top is at its bottom."""
        if names is not None:
            return names
        solid, found = self.solids[part], []
        there = self.frames[frame].at(np.array(time)).then(pose)
        for name, carrier in seats.items():
            if name == part:
                continue
            other = self.frames[carrier].at(np.array(time)).then(poses[name])
            delta = other.p - there.p
            above = abs(float(delta[2]) + self.solids[name].height + solid.height) <= CONTACT_M
            if above and float(np.hypot(delta[0], delta[1])) <= solid.radius + self.solids[name].radius:
                found.append(name)
        return found

    def pairs(self, stage: Stage, held: str | None, seats: dict[str, str]) -> list[Pair]:
        """All pairs of bodies that count in a stage, with `held` in the gripper, the others on the frames `seats`."""
        found = []
        ours = [*self.carried] + ([] if held is None else [held])
        for one, other in product(ours, seats):
            found.append(self._pair(stage, one, other))
        links = {name: each.link for name, each in self.carried.items()} | ({} if held is None else {held: "flange"})
        for first, second in self.arm.self_pairs:
            for one, other in product(ours, ours):
                if links[one] == first and links[other] == second:
                    found.append(self._pair(stage, one, other))
        for part, supports in stage.placed.items():
            for other, frame in seats.items():
                moves = self.frames[frame].moves or self.frames[seats[part]].moves
                if other != part and other not in supports and frame != seats[part] and moves:
                    found.append(Pair(part, other, clearance(self.request, True, part, other)))
        return found

    def _pair(self, stage: Stage, one: str, other: str) -> Pair:
        if frozenset((one, other)) in stage.contacts:
            return Pair(one, other, -stage.deep_m, contact=True)
        return Pair(one, other, clearance(self.request, stage.near, one, other))


def _solid(body: Document) -> Solid:
    """The solid of a body in the frame of its pose, which stays upright."""
    pose, upright = body.get("pose", {}), solid_of(body["shape"])
    pitch, roll = float(si(pose, "pitch", 0.0)), float(si(pose, "roll", 0.0))
    return tilted(upright, pitch, roll) if pitch or roll else upright


def grasp_of(given: Document, turn: float = 0.0) -> Poses:
    """The tool point in the frame of the part that a pick, or the start, has in the gripper; with the part turned."""
    return Poses.of(yaw=turn).then(Poses.of(given["grasp_m"], given.get("grasp_yaw_rad", 0.0)))
