"""What is put in the place of what: every replaced function of the planner by module and name.

A function is replaced wherever a loaded module of the planner holds it under any name, and put back afterwards. One
that is no longer there is an error, not a function less.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from benchmarks.compiled import checking, functions, nearest, proving, screening, separation

Wrapped = Callable[["Replacement"], Callable[..., Any]]


class Gone(Exception):
    """The planner has not what was to be replaced."""


@dataclass(frozen=True, slots=True)
class Replacement:
    """`module`, `attribute` (of a class: ``Class.method``) of the original, the `compiled` function, and whether it
    fuses what are many calls in the original. `numbers`: two functions of the same arguments, compiled and original,
    whose answers are compared where the answer itself says little."""

    module: str
    attribute: str
    compiled: Callable[..., Any]
    fused: bool = False
    numbers: tuple[Callable[..., Any], Callable[..., Any]] | None = None

    @property
    def name(self) -> str:
        """Module and name, without the package."""
        return f"{self.module.removeprefix('planner.')}.{self.attribute}"

    @property
    def original(self) -> Callable[..., Any]:
        """What stands there now. Raises `Gone`."""
        owner, name = self.place
        found: Callable[..., Any] = getattr(owner, name)
        return found

    @property
    def place(self) -> tuple[Any, str]:
        """The module or class, and the name in it. Raises `Gone`."""
        try:
            # not by attributes of packages, in which a function may hide a module of the same name
            importlib.import_module(self.module)
            owner: Any = sys.modules[self.module]
            *path, name = self.attribute.split(".")
            for part in path:
                owner = getattr(owner, part)
            getattr(owner, name)
        except (ImportError, AttributeError) as error:
            raise Gone(
                f"{self.module} has no {self.attribute} any more: the experiment must follow the planner"
            ) from error
        return owner, name


REPLACEMENTS: tuple[Replacement, ...] = (
    Replacement("planner.separation", "place", separation.place),
    Replacement("planner.separation", "support", separation.support),
    Replacement("planner.separation", "gaps", separation.gaps),
    Replacement("planner.separation", "centre_normals", separation.centre_normals),
    Replacement("planner.separation", "face_normals", separation.face_normals),
    Replacement("planner.separation", "likely_gaps", separation.likely_gaps),
    Replacement("planner.separation", "rough_gaps", separation.rough_gaps),
    Replacement("planner.separation", "swept_gaps", separation.swept_gaps),
    Replacement("planner.solids", "carriers", functions.carriers),
    Replacement("planner.gjk", "separate", functions.separate),
    Replacement("planner.sweep", "sweep", functions.sweep),
    Replacement("planner.tool_motion", "tool_peak", functions.tool_peak),
    Replacement("planner.robots.scara", "Scara.placements", functions.placements),
    Replacement("planner.robots.scara", "Scara.link_motion", functions.link_motion),
    Replacement("planner.robots.scara", "Scara.point_bounds", functions.point_bounds),
    Replacement("planner.timing.sketch", "Sketch.positions", functions.sketched),
    Replacement("planner.trajectory.hermite", "hulls", functions.hulls),
    Replacement("planner.trajectory.hermite", "powers", functions.powers),
    Replacement("planner.trajectory.extremum", "span", functions.span),
    Replacement("planner.trajectory.trajectory", "Trajectory.evaluate", functions.evaluate),
    Replacement("planner.checker.spline", "Spline.inside", functions.inside),
    Replacement("planner.checker.ranges", "ranges", checking.ranges),
    Replacement("planner.checker.ranges", "Ranges.sweep", checking.sweep),
    Replacement(
        "planner.checker.rows",
        "proved",
        checking.proved,
        fused=True,
        numbers=(checking.numbers, checking.numbers_of_the_original),
    ),
    Replacement("planner.screening", "_screen_group", screening.screen_group, fused=True),
    Replacement("planner.margins", "_nearest", nearest.nearest_of_phase, fused=True),
    Replacement("planner.certificate.proof", "Prover.prove", proving.prove, fused=True),
)


@contextmanager
def replaced(
    some: Sequence[Replacement] = REPLACEMENTS, wrapped: Wrapped = lambda replacement: replacement.compiled
) -> Iterator[None]:
    """While the block runs, the planner calls what `wrapped` makes of each replacement. Raises `Gone`."""
    undone: list[tuple[Any, str, Any]] = []
    for replacement in some:
        replacement.place  # noqa: B018 - all are there before one is touched
    try:
        for replacement in some:
            original, stand_in = replacement.original, wrapped(replacement)
            for owner, name in holders(replacement, original):
                undone.append((owner, name, original))
                setattr(owner, name, stand_in)
        yield
    finally:
        for owner, name, original in reversed(undone):
            setattr(owner, name, original)


def holders(replacement: Replacement, original: Callable[..., Any]) -> list[tuple[Any, str]]:
    """Where the planner holds an original: its class, or every module that has it under some name."""
    if "." in replacement.attribute:
        return [replacement.place]
    found = []
    for title, module in list(sys.modules.items()):
        if title.partition(".")[0] == "planner":
            found += [(module, name) for name, value in list(vars(module).items()) if value is original]
    return found
