"""What an arm does in the vertical plane that its base turns: the point ζ = ρ + i h of its flange.

ρ is the distance from the base axis (negative on the far side), h the height above the shoulder. Links are terms
l e^{iψ}, in complex numbers; equations K23 to K25 of docs/kinematics.md.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.assur.rrr import Planar
from assur.planner.frames.motion import Motion
from assur.planner.robots.protocol import Sweep

LINKS = ("base", "link1", "link2", "link3", "flange")
BASE, LINK1, LINK2, LINK3, FLANGE = range(5)
TILTING = frozenset((LINK2, LINK3, FLANGE))

Orders = Sequence[FloatArray]
"""A quantity and its time derivatives in order, each (...)."""


@dataclass(frozen=True, slots=True)
class InPlane:
    """Joints 2 and 3 for a motion of (ρ, h): `joints` (orders, ..., 2), `code` and `margin` (...) of their dyad."""

    joints: FloatArray
    code: IntArray
    margin: FloatArray


class InVerticalPlane(ABC):
    """What differs between elbow arm and polar arm; `TiltingArm` has what does not."""

    @property
    @abstractmethod
    def modes(self) -> tuple[str, ...]:
        """Working modes."""

    @property
    @abstractmethod
    def longest(self) -> float:
        """The farthest that the flange can be from the shoulder, m."""

    @property
    @abstractmethod
    def rate_matrix(self) -> FloatArray:
        """(3, 3): the rates that bound point speeds."""

    @abstractmethod
    def _names(self) -> tuple[str, ...]:
        """Names of the joints if none are given."""

    @abstractmethod
    def _kinds(self) -> tuple[str, ...]:
        """Kinds of the joints."""

    @abstractmethod
    def _side(self, mode: int) -> tuple[int, int]:
        """Sign of the radius ρ in a mode, and which assembly of the dyad in the plane it is."""

    @abstractmethod
    def _assembled(self, assembly: int, path: list[Planar]) -> InPlane:
        """Joints 2 and 3 for (ρ, h) and its derivatives."""

    def _inward(self, _flange: Motion, path: list[Planar]) -> list[Planar]:
        """(ρ, h), with derivatives, of the end of the mechanism in the plane, from those of the flange: the same."""
        return path

    @abstractmethod
    def _arms(self, link: int, joints: Orders) -> list[tuple[list[FloatArray], list[FloatArray]]]:
        """The terms l e^{iψ} of ζ of a link's origin: l and ψ with as many derivatives as `joints` (..., n) has."""

    @abstractmethod
    def _tilt(self, link: int, q: FloatArray, /) -> FloatArray:
        """Angle ψ (...) by which a tilting link's x axis is above the horizontal."""

    @abstractmethod
    def _plane_jacobian(self, q: FloatArray) -> FloatArray:
        """(..., 2, 2): rates of (ρ, h) of the flange per rate of joints 2 and 3."""

    @abstractmethod
    def mode_of(self, q: FloatArray) -> IntArray:
        """Working mode number (...) of q; −1 where it is not finite."""

    @abstractmethod
    def _dyad_margin(self, q: FloatArray) -> tuple[FloatArray, IntArray, FloatArray]:
        """Margin (...) of the dyad in the plane, to which of its singularities, and metres left to it."""

    @abstractmethod
    def _plane_bounds(
        self, link: IntArray, distance: FloatArray, sweep: Sweep
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """For points of tilting links, bounds (N,) of |ζ̇|, |ζ̈| and of the horizontal distance from the base axis."""

    def _zeta(self, link: int, joints: Orders) -> list[FloatArray]:
        """ρ, h of a link's origin, (2, ...) for each of the orders of `joints`."""
        total = [np.zeros((2, *joints[0].shape[:-1])) for _ in joints]
        for length, angle in self._arms(link, joints):
            for sum_, term in zip(total, turned(length, angle), strict=True):
                sum_ += term
        return total


def turned(length: Sequence[FloatArray], angle: Sequence[FloatArray]) -> list[FloatArray]:
    """l e^{iψ} as (2, ...) and its derivatives, from those of l and ψ: K20 to K22 read backwards."""
    c, s = np.cos(angle[0]), np.sin(angle[0])
    parts: list[tuple[FloatArray, FloatArray]] = [(length[0], np.zeros_like(length[0]))]
    if len(length) > 1:
        w = angle[1]
        parts.append((length[1], length[0] * w))
    if len(length) > 2:
        dw = angle[2]
        parts.append((length[2] - length[0] * w * w, 2.0 * length[1] * w + length[0] * dw))
    if len(length) > 3:
        along = length[3] - 3.0 * w * (length[1] * w + length[0] * dw)
        across = 3.0 * (length[1] * dw + length[2] * w) + length[0] * (angle[3] - w**3)
        parts.append((along, across))
    return [np.stack([along * c - across * s, along * s + across * c]) for along, across in parts]
