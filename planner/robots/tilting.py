"""Arms whose links tilt: a base that turns, and a mechanism of two joints in a vertical plane (and, maybe, a wrist).

The base is an RPR dyad in the horizontal plane: angle φ1 and radius ρ of the tool point. What is left is the point
(ρ, h), h the height above the shoulder, in the plane that the base turns; an RRR dyad there makes the elbow arm, an RPR
dyad the polar arm. In complex numbers, ζ = ρ + i h in the plane and p = p_b + ρ e(φ1) + (height + h) ẑ, equations K23
to K31 of docs/kinematics.md. Sources: 002 (both arms), 003 (elbow arm).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.planner.frames.motion import Motion
from assur.planner.robots.chain import Link
from assur.planner.robots.robot import Robot

BASE, LINK1, LINK2, LINK3, FLANGE = range(5)


@dataclass(frozen=True, eq=False, kw_only=True)
class TiltingArm(Robot):
    """The facts that elbow, polar and five-axis arm share.

    Link frames: `base` at the base origin; `link1` at the shoulder, turned by φ1, upright; `link2` at the shoulder and
    `link3`, `flange` where the arm says, turned by φ1 and then tilted: x ahead along the link, y level, so that all
    frames have the base's axes where all angles are 0.

    Argument: `height` of the shoulder above the base origin, m. Raises `InputError` for what is not one. The rest:
    `Robot`.
    """

    links: ClassVar[tuple[str, ...]] = ("base", "link1", "link2", "link3", "flange")

    height: float

    def __post_init__(self) -> None:
        if not np.isfinite(self.height):
            raise InputError("robot.height", self.height, "a finite number")
        super().__post_init__()

    @property
    def _shoulder(self) -> tuple[Link, ...]:
        """The links that these arms share: base, the one that turns, and the first that tilts."""
        return (
            Link(-1, (self.base.x, self.base.y, self.base.z)),
            Link(BASE, (0.0, 0.0, self.height), (0,)),
            Link(LINK1, turns=(0,), tilts=(1,)),
        )

    def in_plane(self, flange: Motion, mode: int) -> tuple[FloatArray, FloatArray]:
        """Radius ρ and height h (...) of the flange in the vertical plane of the arm, from the shoulder, K23; in a mode
        in which the base is turned away ρ is negative."""
        away = flange.p - self.base.position
        radius = np.hypot(away[..., 0], away[..., 1])
        return (-radius if self.modes[mode].startswith("back") else radius), away[..., 2] - self.height
