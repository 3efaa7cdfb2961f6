"""What a plan promises of its joints: limits, start, end, and the reported peaks."""

from __future__ import annotations

import numpy as np

from benchmarks.judge.faults import Violation, beyond
from benchmarks.judge.motion import Motion
from benchmarks.judge.poses import short

SHARE = 1e-6
"""Share of a limit by which a measured value may exceed it."""
START, REST = 1e-8, 1e-8
"""First knot against the start, last knot against rest; rad or m, /s, /s²."""
PEAK_SHARE = 1e-6
"""Error of a peak that an answer reports, as a share of the limit; of a jerk, a thousand times that."""
SAMPLE_S = 1e-3


def joints_kept(motion: Motion) -> list[Violation]:
    """Limits between all knots, start, end and peaks."""
    return [*motion_kept(motion), *_peaks(motion)]


def motion_kept(motion: Motion) -> list[Violation]:
    """Limits, start and end: what an answer promises whose report is short."""
    return [*_limits(motion), *_start(motion), *_end(motion)]


def _blends(motion: Motion) -> bool:
    return bool(motion.request.get("options", {}).get("timing") == "parabolic_blend")


def _limits(motion: Motion) -> list[Violation]:
    arm, found = motion.arm, list[Violation]()
    least, most = motion.extremes(0)
    over = np.maximum(arm.lower - least, most - arm.upper) / np.maximum(arm.upper - arm.lower, 1e-9)
    for j, name in enumerate(arm.names):
        found += beyond("range", name, float(over[j]), SHARE * 1e-2)
    kinds = ("velocity", "acceleration", "jerk")[: 2 if _blends(motion) else 3]
    for number, kind in enumerate(kinds):
        low, high = motion.extremes(number + 1)
        size, limit = np.maximum(-low, high), getattr(motion.arm, kind)
        slack = 2.0 * SHARE if kind == "jerk" else SHARE
        for j, name in enumerate(arm.names):
            found += beyond(kind, name, float(size[j] / limit[j]), 1.0 + slack)
    found += _with_load(motion)
    return found


def _with_load(motion: Motion) -> list[Violation]:
    """Accelerations while a part is carried for which the request's own table leaves a share."""
    rows = motion.request["robot"].get("limits", {}).get("acceleration_by_load")
    if not rows:
        return []
    found = list[Violation]()
    masses, shares = [row["mass_kg"] for row in rows], [row["share"] for row in rows]
    tool = float(motion.request["robot"]["tool"].get("mass_kg", 0.0))
    of_part = {body["name"]: float(body.get("mass_kg", 0.0)) for body in motion.request.get("bodies", [])}
    for t0, t1, part in _carried(motion):
        share = float(np.interp(tool + (0.0 if part is None else of_part[part]), masses, shares))
        t = np.linspace(t0, t1, max(int((t1 - t0) / SAMPLE_S), 2))
        size = np.abs(motion.spline.evaluate(t, 2)).max(axis=0) / (share * motion.arm.acceleration)
        for j, name in enumerate(motion.arm.names):
            found += beyond("acceleration with load", name, float(size[j]), 1.0 + SHARE, t0)
    return found


def _carried(motion: Motion) -> list[tuple[float, float, str | None]]:
    """From when until when which part is in the gripper, the instants of changing hands left out."""
    found = list[tuple[float, float, str | None]]()
    held = motion.request["start"].get("holding", {}).get("part")
    since = motion.start_s
    for phase in motion.phases:
        if phase.stage.handed_over is not None:
            ((kind, given),) = motion.request["task"][phase.stage.handed_over].items()
            found.append((since, phase.stage.t1, held))
            since, held = phase.stage.t1, given["part"] if kind == "pick" else None
    return [*found, (since, motion.end_s, held)]


def carrying(motion: Motion) -> list[tuple[float, float]]:
    """From when until when a part is in the gripper."""
    return [(t0, t1) for t0, t1, part in _carried(motion) if part is not None and t1 > t0]


def _start(motion: Motion) -> list[Violation]:
    """The first knot is the start of the request."""
    start, first, found = motion.request["start"], motion.spline, list[Violation]()
    t0 = np.array([motion.start_s])
    found += beyond("start time", "", abs(motion.start_s - float(start.get("at_s", 0.0))), START)
    if "joints" in start:
        required = motion.arm.values(start["joints"])
        found += beyond("start", "joints", float(np.abs(first.evaluate(t0)[0] - required).max()), START)
    else:
        tool = motion.tool(t0)
        name, pose = motion.cell.seat(start["tool"])
        wanted = motion.cell.frames[name].at(t0).then(pose)
        found += beyond("start", "tool", float(np.linalg.norm(tool.p - wanted.p)), START)
        if "yaw_rad" in start["tool"]:
            found += beyond("start", "yaw", float(np.abs(short(tool.yaw - wanted.yaw)).max()), START)
    for number, key in ((1, "velocity"), (2, "acceleration")):
        given = start.get(key)
        units = ("rad_s", "m_s") if number == 1 else ("rad_s2", "m_s2")
        required = np.zeros(len(motion.arm.names)) if given is None else motion.arm.values(given, units)
        if number == 2 and _blends(motion):
            continue  # it jumps
        off = float(np.abs(motion.spline.evaluate(t0, number)[0] - required).max())
        found += beyond("start", key, off, START * 10.0 ** (2 * (number - 1)))
    return found


def _end(motion: Motion) -> list[Violation]:
    options, end, found = motion.request.get("options", {}), np.array([motion.end_s]), list[Violation]()
    if options.get("end", "rest") == "rest":
        found += beyond("end", "velocity", float(np.abs(motion.spline.evaluate(end, 1)).max()), REST)
        if not _blends(motion):
            size = float(np.abs(motion.spline.evaluate(end, 2)).max())
            found += beyond("end", "acceleration", size, 1e3 * REST)
    if "latest_end_s" in options:
        found += beyond("latest end", "", motion.end_s, float(options["latest_end_s"]) + 1e-8)
    duration = motion.end_s - motion.start_s
    stated = float(motion.answer["duration_s"])
    found += beyond("duration", "", abs(stated - duration), 1e-8)
    bound = motion.answer.get("lower_bound_s")
    if bound is not None:
        found += beyond("lower bound", "", float(bound), duration * (1.0 + 1e-9))
    return found


def _peaks(motion: Motion) -> list[Violation]:
    """The reported peaks of joints are those of the trajectory."""
    found = list[Violation]()
    for number, kind in enumerate(("velocity", "acceleration", "jerk")):
        if kind == "jerk" and _blends(motion):
            continue
        low, high = motion.extremes(number + 1)
        size = np.maximum(-low, high)
        for stated in motion.answer["margins"]["peaks"]:
            j = motion.arm.names.index(stated["joint"])
            off = abs(stated[kind] - size[j]) / getattr(motion.arm, kind)[j]
            found += beyond(
                "peak", f"{kind} of {stated['joint']}", float(off), PEAK_SHARE * (1e3 if kind == "jerk" else 1.0)
            )
    return found
