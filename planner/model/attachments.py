"""What the gripper holds and where each part sits, after any number of steps of a task: one value, one rule."""

from __future__ import annotations

from dataclasses import dataclass
from operator import itemgetter

from assur.planner.errors import InputError
from assur.planner.frames.motion import Pose
from assur.planner.model.scene import WORLD, Follow, Move, Pick, Place, Scene, Step, Trace
from assur.planner.robots.facts import Limits


@dataclass(frozen=True, slots=True)
class Held:
    """The part in the gripper and the pose of its frame in the flange frame."""

    part: str
    in_flange: Pose


@dataclass(frozen=True, slots=True)
class Attachments:
    """`held`: the part in the gripper. `placed`: the parts that do not sit where they did at the start, by name, with
    the frame and the pose in which they sit now. A held part counts as sitting where it was taken from."""

    held: Held | None = None
    placed: tuple[tuple[str, str, Pose], ...] = ()

    @property
    def part(self) -> str | None:
        """The name of the part in the gripper."""
        return None if self.held is None else self.held.part

    def limits(self, scene: Scene) -> Limits:
        """The joints' limits with what the gripper holds."""
        return scene.limits_with(self.part)

    def pose_of(self, scene: Scene, name: str) -> tuple[str, Pose]:
        """Frame of a body of the surroundings, and its pose in it."""
        for part, frame, pose in self.placed:
            if part == name:
                return frame, pose
        body = scene.index[name]
        return body.frame, body.pose

    def frame(self, scene: Scene, step: Step) -> str:
        """The frame in which the control point of a step is."""
        return self.pose_of(scene, step.part)[0] if isinstance(step, Pick) else step.target.frame

    def point(self, scene: Scene, step: Step) -> tuple[str, Pose]:
        """Frame and pose of what a step is about: of the part, for a pick or a place, else of the target."""
        return self.pose_of(scene, step.part) if isinstance(step, Pick) else (step.target.frame, step.target.pose)

    def flange(self, scene: Scene, step: Step, yaw_offset: float = 0.0) -> tuple[str, Pose]:
        """Frame, and pose in it, that the flange takes when the control point of `step` is met, the tool being turned
        by `yaw_offset` about the vertical axis of the part or of the target.

        Raises `InputError` for a place of a part that is not held.
        """
        frame, pose = self.point(scene, step)
        to_flange = scene.tool.tcp.inverse()
        if isinstance(step, Pick):
            return frame, pose.then(_grasp(step, yaw_offset)).then(to_flange)
        if isinstance(step, Place):
            if self.held is None or self.part != step.part:
                raise InputError("task", step.part, "a place only of the part that an earlier pick holds")
            return frame, pose.then(self.held.in_flange.inverse())
        return frame, Pose(pose.x, pose.y, pose.z, pose.yaw + yaw_offset).then(to_flange)

    def after(self, scene: Scene, step: Step, yaw_offset: float = 0.0) -> Attachments:
        """The attachments once `step` was done, the tool having been turned by `yaw_offset` at its control point."""
        match step:
            case Pick():
                in_flange = scene.tool.tcp.then(_grasp(step, yaw_offset).inverse())
                return Attachments(Held(step.part, in_flange), self.placed)
            case Place():
                here, start = (step.to.frame, step.to.pose), scene.index[step.part]
                others = [each for each in self.placed if each[0] != step.part]
                back = here == (start.frame, start.pose)
                return Attachments(
                    None, tuple(sorted(others if back else [*others, (step.part, *here)], key=itemgetter(0)))
                )
            case Move() | Follow() | Trace():
                return self

    def without(self, scene: Scene, part: str) -> Attachments:
        """The attachments once a part that was put down was taken away: it is `far_away` from the robot."""
        others = [each for each in self.placed if each[0] != part]
        return Attachments(self.held, tuple(sorted([*others, (part, WORLD, far_away(scene))], key=itemgetter(0))))

    def has_gone(self, scene: Scene, part: str) -> bool:
        """Whether a part was taken away."""
        return scene.clears and (part, WORLD, far_away(scene)) in self.placed


FAR_M = 100.0
"""How far below or above the origin of the world parts are that were taken away, m: as far as a place can be."""


def far_away(scene: Scene) -> Pose:
    """Where, in the world, parts are that were taken away: on the other side of the origin than the robot."""
    return Pose(z=-FAR_M if scene.robot.base.z >= 0.0 else FAR_M)


AT_START = Attachments()
"""An empty gripper, every part where it was."""


def at_start(scene: Scene) -> Attachments:
    """What the gripper holds when the plan begins, every other part where it is."""
    holding = scene.start.holding
    if holding is None:
        return AT_START
    return Attachments(Held(holding.part, scene.tool.tcp.then(holding.grasp.inverse())))


def _grasp(step: Pick, yaw_offset: float) -> Pose:
    """Tool point in the part's frame when the part is taken turned by `yaw_offset` about its own vertical axis."""
    return Pose(yaw=yaw_offset).then(step.grasp)
