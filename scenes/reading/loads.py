"""What an arm may carry, from its document and the request's limits; and what an answer says of what is not known."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

from assur.planner.model.load import LoadLimits, Tool
from assur.planner.model.scene import WorldBody
from assur.planner.robots.robot import Robot
from assur.scenes.faults import Refused, within
from assur.scenes.schema.robots import Arm, LoadShare
from assur.scenes.schema.stated import Stated, value_of

Shares = tuple[tuple[float, float], ...]


def load_limits(arm: Arm, *, wrist: bool) -> LoadLimits:
    """What an arm may carry. `wrist`: its last joint turns the flange about the vertical. Raises `Refused` at the field
    at fault."""
    rated, maximum, inertia = (
        None if fact is None else value_of(fact) for fact in (arm.rated_load_kg, arm.max_load_kg, arm.max_inertia_kgm2)
    )
    if rated is not None and maximum is not None and not rated <= maximum:
        raise Refused(f"a rated load up to max_load_kg, {maximum:g} kg", *_at("rated_load_kg", arm.rated_load_kg))
    if inertia is not None:
        at = _at("max_inertia_kgm2", arm.max_inertia_kgm2)
        if not wrist:
            raise Refused("no maximum inertia: this arm has no fourth joint that turns the flange", *at)
        if not inertia > 0.0:
            raise Refused("a positive number", *at)
    table, shares = arm.acceleration_by_load, Shares()
    if table is not None:
        with within(*_at("acceleration_by_load", table)):
            shares = _shares(value_of(table))
    return LoadLimits(rated, maximum, inertia, shares)


def replaced(known: LoadLimits, rows: list[LoadShare] | None) -> LoadLimits:
    """The limits with the table of a request, if it gives one, in place of the arm's own. Raises `Refused`."""
    if rows is None:
        return known
    with within("acceleration_by_load"):
        return replace(known, shares=_shares(rows))


def _shares(rows: list[LoadShare]) -> Shares:
    for i, (before, row) in enumerate(pairwise(rows), start=1):
        if not before.mass_kg < row.mass_kg:
            raise Refused(f"masses that increase, so more than {before.mass_kg:g} kg", i, "mass_kg")
        if not row.share <= before.share:
            raise Refused(f"shares that do not increase with the mass, so up to {before.share:g}", i, "share")
    return tuple((row.mass_kg, row.share) for row in rows)


def _at(field: str, fact: object) -> tuple[str, ...]:
    return (field, "value") if isinstance(fact, Stated) else (field,)


def assumptions_of(robot: Robot, known: LoadLimits, tool: Tool, parts: list[WorldBody]) -> tuple[str, ...]:
    """What is not known of what the arm may carry, and does carry with these parts, and what that means for a plan."""
    found, missing, axis = list[str](), [], robot.joints[-1].name
    if known.rated_kg is None and not known.shares:
        missing.append("rated load (accelerations are not scaled with the load)")
    if known.most_kg is None:
        missing.append("maximum load (no mass is refused)")
    if robot.turns_load and known.max_inertia_kgm2 is None:
        missing.append(f"maximum inertia about {axis} (none is refused)")
    if missing:
        found.append(f"{robot.name}: not known {'is the' if len(missing) == 1 else 'are'} {', '.join(missing)}")
    if known.nothing_known:
        return tuple(found)
    heaviest = (tool.mass_kg or 0.0) + max((part.mass_kg or 0.0 for part in parts), default=0.0)
    if known.rated_kg is not None and not known.shares and heaviest > known.rated_kg:
        found.append(
            f"{robot.name}: above the rated load of {known.rated_kg:g} kg accelerations and jerks have the share rated "
            "load / load, for the maker's table (acceleration_by_load) is not given"
        )
    silent = ["the tool"] * (tool.mass_kg is None) + [part.name for part in parts if part.mass_kg is None]
    if silent:
        found.append(f"mass_kg is not stated of {', '.join(silent)}: it counts as 0 kg")
    without_shape = tool.mass_kg and not tool.bodies and tool.inertia_kgm2 is None
    if robot.turns_load and known.max_inertia_kgm2 is not None and without_shape:
        found.append("the tool has a mass and no bodies: for its inertia the mass counts at the tool point")
    return tuple(found)
