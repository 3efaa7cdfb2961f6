"""How far a body of the surroundings may be from where it is planned, for the shell that is drawn around it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.model.scene import Scene, WorldBody


@dataclass(frozen=True, slots=True)
class Shell:
    """A body may be off by `horizontal_m` in every horizontal direction, and by `growth_m_s` more for each second since
    the start, and by `vertical_m` up or down. More than that is not asked of a shell: the proof takes the direction of
    each error into account, and this does not."""

    horizontal_m: float = 0.0
    growth_m_s: float = 0.0
    vertical_m: float = 0.0

    @property
    def any(self) -> bool:
        """Whether there is anything that is not known."""
        return self.horizontal_m + self.growth_m_s + self.vertical_m > 0.0


def shell_of(scene: Scene, world: WorldBody) -> Shell:
    """The shell of a body, from what its request says of its frame and of itself; the time by which a frame may be late
    is left out."""
    frame, own = scene.frames[world.frame].uncertainty, world.uncertainty
    far = float(np.hypot(world.pose.x, world.pose.y)) + world.body.radius
    horizontal = frame.position_m + frame.lateral_m + frame.yaw_rad * far
    horizontal += own.position_m + own.yaw_rad * world.body.radius
    return Shell(horizontal, frame.speed_m_s, frame.vertical_m + own.vertical_m)
