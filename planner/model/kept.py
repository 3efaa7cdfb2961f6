"""What follows from a cell alone, made once for all scenes of that cell."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from operator import is_
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from assur.planner.laws.law import Frame
    from assur.planner.model.load import Tool
    from assur.planner.model.scene import Scene, WorldBody
    from assur.planner.robots.robot import Robot

Made = TypeVar("Made")

MOST = 64
"""Values that are kept of one cell. When there are more, all of them are dropped, and made again where needed."""


class KeptCell:
    """Values that follow from robot, tool, frames and bodies of a scene, and from the keys under which they are kept.

    Scenes share one if they have the same four objects; a scene with another object gets a new one (`Scene.kept`).
    `before`: that of the same cell without the last of its bodies, from which some values are made sooner. Threads may
    read it at the same time: at worst, both make the same value.
    """

    def __init__(
        self,
        robot: Robot,
        tool: Tool,
        frames: dict[str, Frame],
        bodies: tuple[WorldBody, ...],
        before: KeptCell | None = None,
    ) -> None:
        self.robot, self.tool, self.frames, self.bodies, self.before = robot, tool, frames, bodies, before
        self._made: dict[Hashable, Any] = {}
        self._with: tuple[tuple[WorldBody, ...], dict[Hashable, Any]] = ((), {})

    @property
    def kept(self) -> KeptCell:
        """Itself: what needs no more of a scene than the cell takes one for the other."""
        return self

    def fits(self, scene: Scene) -> bool:
        """Whether a scene has the same robot, tool, frames and bodies: the same objects, not equal ones."""
        return self.bodies is scene.bodies and self._is_around(scene)

    def begins(self, scene: Scene) -> bool:
        """Whether a scene has the same, and further bodies behind these."""
        return (
            self._is_around(scene)
            and len(self.bodies) <= len(scene.bodies)
            and all(map(is_, self.bodies, scene.bodies))
        )

    def _is_around(self, scene: Scene) -> bool:
        return self.robot is scene.robot and self.tool is scene.tool and self.frames is scene.frames

    def of(self, make: Callable[[Any], Made], scene: Scene | KeptCell, *key: Hashable) -> Made:
        """What `make` makes of a scene of this cell. `key`: what else of the scene it depends on."""
        all_made, place = self._made, (make, *key)  # once: another thread may drop all of them meanwhile
        made: Made | None = all_made.get(place)
        if made is None:
            if len(all_made) >= MOST:
                all_made = self._made = {}
            made = all_made[place] = make(scene)
        return made

    def of_solids(self, make: Callable[[Any], Made], scene: Scene | KeptCell) -> Made:
        """As `of`, for what depends on the solids of the bodies, and neither on their names nor on where they are: what
        was made of the same solids behind the cell `before` is taken again."""
        before = self.before
        if before is None:
            return self.of(make, scene)
        added, (last, all_made) = scene.bodies[len(before.bodies) :], before._with
        if len(added) != len(last) or not all(map(_are_alike, added, last)):
            last, all_made = before._with = added, {}
        made: Made | None = all_made.get(make)
        if made is None:
            made = all_made[make] = make(scene)
        return made


def _are_alike(one: WorldBody, other: WorldBody) -> bool:
    """Whether two bodies have the same solid: the same objects."""
    return one.body.pieces is other.body.pieces and one.body.surface is other.body.surface


class _NoCell(KeptCell):
    """That of no cell: it fits no scene."""

    def __init__(self) -> None:
        self.before = None

    def fits(self, scene: Scene) -> bool:  # noqa: ARG002 - none
        return False

    def begins(self, scene: Scene) -> bool:  # noqa: ARG002 - none
        return False


NOTHING_KEPT = _NoCell()
