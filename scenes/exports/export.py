"""A plan as a file for a controller: on the controller's grid, and proved again on that grid.

The exported motion is the proved motion: the numbers in the file are those of the plan in the export. The checker has
accepted the certificate of this plan for the request in the export.
"""

from __future__ import annotations

import base64
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from assur.planner.errors import InputError
from assur.scenes.bounds import MAX_JSON_BYTES
from assur.scenes.conventions import as_maker, rates_as_maker
from assur.scenes.exports.raised import raised, scale_of
from assur.scenes.numbers import number, optional
from assur.scenes.schema.export import Deviation, ExportAnswer, ExportDocument, JerkProved, JerkRule

if TYPE_CHECKING:
    from assur.planner.arrays import FloatArray
    from assur.planner.checker.verdict import Finding
    from assur.planner.model.outcome import Plan
    from assur.planner.trajectory import Trajectory
    from assur.scenes.exports.handover import Handover
    from assur.scenes.reading.cell import Cell

RECIPES = ("spel", "melfa")
"""Formats that hold no motion, but what a controller needs to make one of its own."""
ENDINGS = {"ros2": "yaml", "ros2-json": "json", "spel": "prg", "melfa": "prg"}
"""How the names of files in a format end, where that is not the format's own name."""
MODEL = "glb"
"""The format that shows the motion in three dimensions: bytes, not text."""
SPARE = 1e-6
"""Share by which a limit is raised above the jerk that is proved against it: for rounding."""
MOST_FINDINGS = 4
"""Number of findings that are reported if a motion is not proved."""
ALLOW_NONZERO = "allow_nonzero_velocity_at_trajectory_end"
"""The parameter of joint_trajectory_controller without which it refuses a motion that does not end at rest."""


@dataclass(frozen=True, eq=False)
class Motion:
    """A motion that is proved: the cell against whose request it is, the plan, notes on it, and how a controller takes
    it over."""

    cell: Cell
    request: dict[str, Any]
    plan: Plan
    facts: dict[str, Any]
    handover: Handover | None = None


def motion_for(
    cell: Cell, request: dict[str, Any], made: Plan, form: str, tick_s: float | None, jerk: JerkRule = "limit"
) -> Motion:
    """The motion of a plan as a file of a format holds it, proved. `request`: that of the cell, with what files hold.

    `jerk`: whether it must keep the robot's limit, or may be proved against a higher one, which is stated.
    Raises `InputError` for a motion that cannot be proved, or that the format cannot hold.
    """
    from assur.scenes.resampling.grid import on_nanoseconds

    trajectory = made.trajectory
    if tick_s is not None and form in RECIPES:
        raise InputError("tick_s", tick_s, f"none: {form} is a recipe, and its controller makes the motion itself")
    if tick_s is not None and form == MODEL:
        raise InputError(
            "tick_s", tick_s, "none: glb has keys where they are needed, 0.1 mm apart from the motion at most"
        )
    if form.startswith("ros2"):
        if trajectory.jumps:
            allowed = "csv: parabolic blends have two knots at one time, which joint_trajectory_controller refuses"
            raise InputError("format", form, allowed)
        trajectory = on_nanoseconds(trajectory)
        if tick_s is not None and abs(tick_s / 1e-9 - round(tick_s / 1e-9)) > 1e-3:
            raise InputError("tick_s", tick_s, "whole nanoseconds, for ROS times are")
    if tick_s is None:
        return _proved(cell, request, made, trajectory, None)
    return _on_ticks(cell, request, made, trajectory, tick_s, jerk)


def _on_ticks(
    cell: Cell, request: dict[str, Any], made: Plan, trajectory: Trajectory, tick_s: float, jerk: JerkRule
) -> Motion:
    """The motion on ticks, proved: within the limits of jerk of the request, where such a motion can be proved; else
    within the robot's own, or with the rule `report` within what it needs."""
    from assur.scenes.resampling.certifying import Refutation, kept_legs, recertified
    from assur.scenes.resampling.grid import on_ticks

    legs, arrivals = kept_legs(made, trajectory)
    base = replace(made, trajectory=trajectory, legs=legs, arrivals=arrivals)
    near = on_ticks(cell.scene, base, tick_s)
    share = _share_of_jerk(cell, made, near)
    if share.max() <= 1.0:
        return _proved(cell, request, made, near, tick_s)
    if jerk == "limit":
        wide = on_ticks(cell.scene, base, tick_s, hold_jerk=True)
        if _share_of_jerk(cell, made, wide).max() <= 1.0:
            proved = recertified(cell.scene, made, wide)
            if not isinstance(proved, Refutation):
                return _motion(cell, request, made, proved, tick_s)
        if scale_of(request) * share.max() > 1.0:
            joint, worst = cell.scene.robot.joints[int(share.argmax())].name, share.max()
            allowed = (
                f"a motion that keeps its limits: between ticks the jerk of {joint} is {worst:.3f} times its "
                f"limit; let it be proved against a higher limit (jerk: report, or --jerk report), try another tick, "
                f"or plan with limits: {{jerk: {0.99 * scale_of(request) / worst:.2f}}}"
            )
            raise InputError("tick_s", tick_s, allowed)
    return _proved(cell, request, made, near, tick_s, float(share.max()) * (1.0 + SPARE))


def _share_of_jerk(cell: Cell, made: Plan, trajectory: Trajectory) -> FloatArray:
    """The greatest share of its limit of jerk that each joint uses, (n,), with the load that is carried then."""
    from assur.planner.model.phases import phases
    from assur.scenes.resampling.certifying import kept_legs
    from assur.scenes.resampling.measured import ratios

    of_plan = phases(cell.scene, *kept_legs(made, trajectory))
    return np.asarray(ratios(cell.scene, of_plan, trajectory)[2])


def _proved(
    cell: Cell, request: dict[str, Any], made: Plan, trajectory: Trajectory, tick_s: float | None, factor: float = 1.0
) -> Motion:
    """A motion, proved against `factor` times the limits of jerk of the request.

    Raises `InputError` for one that cannot be proved.
    """
    from assur.scenes.resampling.certifying import Refutation, recertified

    given = cell
    if factor > 1.0:
        request = raised(request, factor)
        cell = cell_in(request)
    proved = recertified(cell.scene, made, trajectory)
    if isinstance(proved, Refutation):
        other = "" if tick_s is None else "; try a shorter tick, or none: then the points are the knots of the plan"
        allowed = f"one that can be proved; the checker says: {in_words(proved.findings)}{other}"
        raise InputError("plan", "this motion", allowed)
    return _motion(cell, request, made, proved, tick_s, factor, given)


def _motion(
    cell: Cell,
    request: dict[str, Any],
    made: Plan,
    proved: Plan,
    tick_s: float | None,
    factor: float = 1.0,
    given: Cell | None = None,
) -> Motion:
    """A proved motion with its deviations and jerks. `given`: the cell of the original request, if its limits of jerk
    were raised by `factor`."""
    from assur.scenes.resampling.measured import deviation

    trajectory, own = proved.trajectory, (given or cell).scene.robot.limits.jerk
    low, high = trajectory.extrema(3)
    off, of_maker = deviation(made.trajectory, trajectory), cell.conventions.places
    offs: list[Deviation] = [
        {"joint": joint.name, "at_most": number(x)}
        for joint, x in zip(cell.conventions, off[of_maker].tolist(), strict=True)
    ]
    facts = {
        "knots": len(trajectory.time),
        "start_s": number(trajectory.start),
        "duration_s": number(trajectory.duration),
        "tick_s": tick_s,
        "shortest_step_s": number((trajectory.time[1:] - trajectory.time[:-1]).min()),
        "deviation": offs,
        "jerk": jerk_proved(cell, np.maximum(high, -low), own, jumps=trajectory.jumps),
        "jerk_raised": number(factor),
        "ends_moving": not trajectory.rest_at_end,
        "warnings": [] if given is None or factor == 1.0 else _exceeding(given, made, trajectory),
        "request_digest": cell.scene.digest,
        "certificate_digest": proved.certificate.digest,
    }
    return Motion(cell, request, proved, facts)


def jerk_proved(cell: Cell, highest: FloatArray, own: FloatArray, *, jumps: bool) -> list[JerkProved]:
    """The `highest` jerk of each joint (n,), the limit of the cell, against which it is proved, and `own`, that of the
    request. `jumps`: the acceleration may jump, and the jerk has no bound."""
    limits = cell.scene.robot.limits.jerk
    return [
        {
            "joint": joint.name,
            "unit": "rad/s³" if joint.unit == "rad" else "m/s³",
            "highest": None if jumps else optional(highest[i] + 0.0),
            "limit": number(limits[i]),
            "of_request": number(own[i]),
        }
        for joint, i in zip(cell.conventions, cell.conventions.places.tolist(), strict=True)
    ]


def _exceeding(cell: Cell, made: Plan, trajectory: Trajectory) -> list[str]:
    """By how much joints exceed the limits of jerk of a request, in words; empty where none does."""
    share = _share_of_jerk(cell, made, trajectory)[cell.conventions.places]
    off = [
        f"{joint.name} by {100 * (x - 1):.2g} %"
        for joint, x in zip(cell.conventions, share.tolist(), strict=True)
        if x > 1.0
    ]
    return [f"between ticks the jerk exceeds the limit of the request: {', '.join(off)}"] if off else []


def cell_in(request: dict[str, Any]) -> Cell:
    """The cell of a request in which no file is named."""
    from assur.scenes.reading.cell import cell_of
    from assur.scenes.requests import validate

    return cell_of(request, validate(request))


def in_words(findings: tuple[Finding, ...]) -> str:
    """The first findings, in words."""
    sentences = [f"{each.what} ({each.where})" if each.where else each.what for each in findings[:MOST_FINDINGS]]
    more = len(findings) - MOST_FINDINGS
    return "; ".join(sentences) + (f"; and {more} more" if more > 0 else "")


def statement(motion: Motion) -> list[str]:
    """Short lines that describe an export; text files begin with them."""
    from assur.scenes.answer import NOTICE
    from assur.scenes.exports import handover

    facts, conventions = motion.facts, motion.cell.conventions
    jerks = []
    for joint, peak in zip(conventions, facts["jerk"], strict=True):
        if peak["highest"] is None:
            jerks.append(f"{joint.name} has no bound")
            continue
        more = "" if peak["limit"] == peak["of_request"] else f" (planned with {peak['of_request']:.6g})"
        jerks.append(f"{joint.name} {peak['highest']:.6g} of {peak['limit']:.6g} {joint.unit}/s3{more}")
    off = [
        f"{joint.name} {x['at_most']:.2g} {joint.unit}"
        for joint, x in zip(conventions, facts["deviation"], strict=True)
    ]
    grid = "knots of the plan" if facts["tick_s"] is None else f"ticks of {1e3 * facts['tick_s']:g} ms"
    lines = [
        f"{facts['knots']} points at {grid}, {1e3 * facts['shortest_step_s']:.6g} ms apart at the least",
        f"starts at {facts['start_s']:.9g} s of the cell's clock, lasts {facts['duration_s']:.9g} s",
        f"highest jerk and the limit that it is proved against: {', '.join(jerks)}",
        f"deviates from the plan by at most: {', '.join(off)}",
        "quintic between points: any other interpolation is another motion, and is not proved",
        f"request {facts['request_digest']}",
        f"certificate {facts['certificate_digest']}",
        NOTICE,
    ]
    if facts["ends_moving"]:
        lines.insert(2, f"does not end at rest: joint_trajectory_controller takes it only with {ALLOW_NONZERO}: true")
    over = [] if motion.handover is None else handover.statement(motion.handover, facts["start_s"])
    return [*facts["warnings"], *over, *lines]


def exported(
    cell: Cell, request: dict[str, Any], made: Plan, options: ExportDocument, handover: Handover
) -> ExportAnswer:
    """The export of a plan that has been read; `request`: that of the cell, with what files hold in it.

    Raises `InputError` for a motion that cannot be proved, or that the format cannot hold.
    """
    from assur.scenes.answer import NOTICE, proved_document

    motion = motion_for(cell, request, made, options.format, options.tick_s, options.jerk)
    motion = replace(motion, handover=handover)
    file, notes = _file(motion, options.format)
    return {
        "schema": "assur/1",
        "format": options.format,
        "encoding": "base64" if options.format == MODEL else "text",
        "file": file,
        "statement": notes + statement(motion),
        **motion.facts,  # type: ignore[typeddict-item]
        "request": motion.request,
        "plan": proved_document(motion.cell, motion.plan),
        "ending": ENDINGS.get(options.format, options.format),
        "notice": NOTICE,
    }


def _file(motion: Motion, form: str) -> tuple[str, list[str]]:
    """The file of a motion in a format, as text or in base64, and the first notes, which are about this format."""
    from assur.scenes.exports import glb, motion_text, recipe

    if form == MODEL:
        model = glb.model_of(motion)
        return base64.b64encode(model.data).decode("ascii"), glb.statement(model)
    text: dict[str, Callable[[Motion], str]] = {
        "csv": motion_text.csv_text,
        "ros2": motion_text.ros2_yaml,
        "ros2-json": motion_text.ros2_json,
        "spel": partial(recipe.recipe, recipe.SPEL),
        "melfa": partial(recipe.recipe, recipe.MELFA),
    }
    file = text[form](motion)
    if form.startswith("ros2") and len(file.encode()) > MAX_JSON_BYTES:  # check-trajectory reads no longer ones
        raise InputError("format", form, f"csv, or a longer tick: the file would have more than {MAX_JSON_BYTES} bytes")
    return file, list(recipe.NOTES) if form in RECIPES else []


def file_bytes(made: ExportAnswer | dict[str, Any]) -> bytes:
    """What is written into a file of an export."""
    file = str(made["file"])
    return base64.b64decode(file) if made["encoding"] == "base64" else file.encode()


def columns(motion: Motion) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Times (K,) and q, q̇, q̈ (K, n) as the maker counts the joints, rad or m; what runs before comes first."""
    trajectory, conventions = motion.plan.trajectory, motion.cell.conventions
    time, q, qd, qdd = trajectory.time, trajectory.q, trajectory.qd, trajectory.qdd
    if motion.handover is not None and motion.handover.before is not None:
        own = (time, q, qd, qdd)
        time, q, qd, qdd = (np.concatenate(pair) for pair in zip(motion.handover.before, own, strict=True))
    return time, as_maker(q, conventions), rates_as_maker(qd, conventions), rates_as_maker(qdd, conventions)
