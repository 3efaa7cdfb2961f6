"""What follows from a cell alone, made once for all scenes of that cell."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from operator import is_
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from assur.planner.model.scene import Scene

Made = TypeVar("Made")

MOST = 64
"""Values that are kept of one cell. When there are more, all of them are dropped, and made again where needed."""


class KeptCell:
    """Values that follow from robot, tool, frames and bodies of a scene, and from the keys under which they are kept.

    Scenes share one if they have the same four objects; a scene with another object gets a new one (`Scene.kept`).
    Threads may read it at the same time: at worst, both make the same value.
    """

    def __init__(self, facts: tuple[object, ...]) -> None:
        """`facts`: as `facts_of` a scene gives them."""
        self._facts = facts
        self._made: dict[Hashable, Any] = {}

    def fits(self, scene: Scene) -> bool:
        """Whether a scene has the same robot, tool, frames and bodies: the same objects, not equal ones."""
        return all(map(is_, self._facts, facts_of(scene)))

    def of(self, make: Callable[[Scene], Made], scene: Scene, *key: Hashable) -> Made:
        """What `make` makes of a scene of this cell. `key`: what else of the scene it depends on."""
        all_made, place = self._made, (make, *key)  # once: another thread may drop all of them meanwhile
        made: Made | None = all_made.get(place)
        if made is None:
            if len(all_made) >= MOST:
                all_made = self._made = {}
            made = all_made[place] = make(scene)
        return made


def facts_of(scene: Scene) -> tuple[object, ...]:
    """The objects from which all follows that is kept of a cell."""
    return scene.robot, scene.tool, scene.frames, scene.bodies


NOTHING_KEPT = KeptCell((None,))
"""That of no cell: it fits no scene."""
