"""The arm of a catalogue entry: its numbers in SI, in the planner's order and frames."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np

from assur.planner.geometry.shapes import AXES, Body, Piece, Primitive, box, cylinder
from assur.planner.robots.five_bar import PARALLEL_LEAST
from assur.planner.robots.protocol import Limits, RobotBody
from assur.scenes.catalogue.arm import (
    AT_FLANGE,
    LINKS,
    WITH_QUILL,
    Arm,
    FiveBarArm,
    JointConvention,
    in_order,
    limits_of,
    order_of,
)
from assur.scenes.catalogue.entry import Axis, Entry, FiveBarEntry, Number
from assur.scenes.units import TWIN_UNITS, to_si


def si(number: Number) -> float:
    """A number of the catalogue in SI."""
    return float(to_si(number.value, number.unit)) if number.unit in TWIN_UNITS else float(number.value)  # type: ignore[arg-type]


def attached(
    name: str, shape: Primitive, at: Sequence[float], yaw: float = 0.0, axis: Literal["x", "y", "z"] = "z"
) -> Body:
    """A body of one primitive at a pose in its carrier's frame; `axis`: along which the primitive's z lies."""
    c, s = np.cos(yaw), np.sin(yaw)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return Body(name, (Piece(shape, np.array(at), turn @ AXES[axis]),))


def arm_of(entry: Entry) -> Arm:
    """The arm of a catalogue entry."""
    kinds, rise, zero = [axis.kind for axis in entry.axes], False, 0.0
    own: tuple[int | None, ...] = (None,) * len(kinds)
    if entry.family == "scara":
        own, rise = order_of(kinds)
    if entry.family in WITH_QUILL:
        lift = entry.axes[kinds.index("prismatic")]
        zero = 0.0 if lift.zero is None else si(lift.zero)
    bodies = []
    for solid in entry.solids:
        size = [x / 1000 for x in solid.size]
        lower = 0.0 if solid.link in AT_FLANGE else zero
        at = (solid.at[0] / 1000, solid.at[1] / 1000, solid.at[2] / 1000 - lower)
        shape = box(*size) if solid.kind == "box" else cylinder(*size)
        bodies.append(RobotBody(attached(solid.name, shape, at), LINKS[entry.family].index(solid.link)))
    conventions = tuple(
        JointConvention(axis.name, axis.kind, axis.sign, place) for axis, place in zip(entry.axes, own, strict=True)
    )
    shared: dict[str, Any] = {
        "name": entry.model,
        "conventions": conventions,
        "limits": in_order(_limits(entry.axes), conventions),
        "zero_m": zero,
        "bodies": tuple(bodies),
        "self_pairs": entry.self_pairs,
        "assumptions": entry.assumptions(),
        "family": entry.family,
    }
    lengths = {name: si(number) for name, number in entry.lengths()}
    if isinstance(entry, FiveBarEntry):
        return FiveBarArm(
            separation=lengths["separation"],
            proximal=(lengths["l1"], lengths["l1"]),
            distal=(lengths["l2"], lengths["l2"]),
            assembly="front",
            parallel_least=PARALLEL_LEAST,
            **shared,
        )
    return Arm(**shared | lengths, arms_rise=rise, z_down=entry.tool_frame == "z_down")


def _limits(axes: tuple[Axis, ...]) -> Limits:
    return limits_of(
        [(si(axis.lower), si(axis.upper)) for axis in axes],
        [axis.sign for axis in axes],
        [[si(getattr(axis, name)) for axis in axes] for name in ("velocity", "acceleration", "jerk")],
    )
