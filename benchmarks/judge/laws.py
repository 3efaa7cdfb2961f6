"""Planned poses of frames, and their poses with realised uncertainties (docs/request.md)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from benchmarks.judge.arms import Arm
from benchmarks.judge.poses import Document, Floats, Poses, pose_in
from benchmarks.judge.spline import Spline

UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, eq=False)
class Frame:
    """A frame: its pose at times (...), the unit vector along which it travels (None: it has no line), what is not
    known of it, and whether it moves. `shift_s`: by how much its whole motion may be late or early, s."""

    at: Callable[[Floats], Poses]
    line: Floats | None
    unknown: Document
    moves: bool
    shift_s: float = 0.0


def frames_of(request: Document) -> dict[str, Frame]:
    """All frames of a request, the links of its neighbours among them."""
    found = {"world": Frame(lambda t: Poses.of().still(np.shape(t)), None, {}, False)}
    for name, given in request.get("frames", {}).items():
        ((kind, law),) = [each for each in given.items() if each[0] not in ("uncertainty", "valid_s")]
        if kind == "fixed" and law.get("frame", "world") != "world":
            continue
        at, line = LAWS[kind](law)
        found[name] = Frame(at, line, given.get("uncertainty", {}), kind != "fixed")
    for neighbour in request.get("neighbours", []):
        _add_neighbour(neighbour, found)
    return found


def seat(request: Document, frames: dict[str, Frame], pose: Document) -> tuple[str, Poses]:
    """The frame with a law of its own, and the pose in it, of a pose in a frame that may be fixed in another."""
    name, inner = pose.get("frame", "world"), pose_in(pose)
    while name not in frames:
        law = request["frames"][name]["fixed"]
        name, inner = law.get("frame", "world"), pose_in(law).then(inner)
    return name, inner


def seat_then(request: Document, frames: dict[str, Frame], pose: Document) -> tuple[str, Poses]:
    """As `seat`, of a pose with `at_s`: a place in the frame as it is written, where a body is at that time."""
    name, inner = seat(request, frames, pose)
    if name == "world":
        return name, inner
    ((_, law),) = [each for each in request["frames"][name].items() if each[0] not in ("uncertainty", "valid_s")]
    written = Poses.of(law["pivot_m"], law.get("yaw_rad", 0.0)) if "pivot_m" in law else pose_in(law)
    return name, frames[name].at(np.array(float(pose["at_s"]))).inverse().then(written).then(inner)


def drift(request: Document, frames: dict[str, Frame], pose: Document) -> float:
    """How far a body may have gone beside its frame's law between the time of its pose and the start, m."""
    if "at_s" not in pose:
        return 0.0
    name, start = seat(request, frames, pose)[0], float(request["start"].get("at_s", 0.0))
    return float(frames[name].unknown.get("speed_m_s", 0.0)) * abs(start - float(pose["at_s"]))


def _add_neighbour(neighbour: Document, found: dict[str, Frame]) -> None:
    arm, given = Arm.of(neighbour["robot"]), Spline.of(neighbour["trajectory"])
    time = given.time + (neighbour.get("starts_at_s", given.time[0]) - given.time[0])
    spline = Spline(time, given.coefficients)

    def link(name: str) -> Callable[[Floats], Poses]:
        def at(t: Floats) -> Poses:
            inside = np.clip(t, time[0], time[-1]).reshape(-1)
            q = spline.evaluate(inside).reshape(*t.shape, -1)
            return arm.links(q)[name]

        return at

    for name in arm.links(spline.evaluate(time[:1])[0]):
        shift = float(neighbour.get("start_uncertainty_s", 0.0)) if name != "base" else 0.0
        found[f"{neighbour['name']}/{name}"] = Frame(link(name), None, {}, name != "base", shift)


Made = tuple[Callable[[Floats], Poses], Floats | None]


def _fixed(law: Document) -> Made:
    pose = pose_in(law)
    return (lambda t: pose.still(np.shape(t))), None


def _straight(pose: Poses, along: Floats, travel: Callable[[Floats], Floats]) -> Callable[[Floats], Poses]:
    return lambda t: pose.moved(travel(t)[..., None] * along)


def _linear(law: Document) -> Made:
    velocity, since = np.array(law["velocity_m_s"], dtype=np.float64), float(law.get("at_s", 0.0))
    speed = float(np.linalg.norm(velocity))
    line = velocity / speed if speed > 0.0 else None
    along = np.zeros(3) if line is None else line
    return _straight(pose_in(law), along, lambda t: speed * (t - since)), line


def _conveyor(law: Document) -> Made:
    pose, since = pose_in(law), float(law.get("at_s", 0.0))
    line = np.array([np.cos(pose.yaw), np.sin(pose.yaw), 0.0])
    travel = _driven(law["speed_m_s"], law.get("changes", []), ("speed_m_s", "acceleration_m_s2", "jerk_m_s3"))
    return _straight(pose, line, lambda t: travel(t) - travel(np.array(since))), line


def _turntable(law: Document) -> Made:
    pose, since, rise = pose_in(law), float(law.get("at_s", 0.0)), float(law.get("rise_m_s", 0.0))
    keys = ("rate_rad_s", "acceleration_rad_s2", "jerk_rad_s3")
    turn = _driven(law["rate_rad_s"], law.get("changes", []), keys)

    def at(t: Floats) -> Poses:
        return pose.moved(rise * (t - since)[..., None] * UP, turn(t) - turn(np.array(since)))

    return at, None


def _driven(speed: float, changes: list[Document], keys: tuple[str, str, str]) -> Callable[[Floats], Floats]:
    """The travel of what is driven at `speed` and whose speed changes by S-curves; 0 at the first change, or at 0 s.

    Each change is pieces of constant jerk: over the time that jerk needs, at most, to reach the acceleration, over as
    long as the acceleration needs for the rest, and over the first time again.
    """
    if not changes:
        return lambda t: speed * np.asarray(t)
    rows = []  # begin, travel, speed, acceleration, jerk
    travel, now, v = 0.0, float(changes[0]["at_s"]), float(speed)
    for change in changes:
        target, most, jerk = (float(change[key]) for key in keys)
        wait = float(change["at_s"]) - now
        rows.append((now, travel, v, 0.0, 0.0))
        travel, now = travel + v * wait, now + wait
        delta, sign = abs(target - v), float(np.sign(target - v))
        rise = min(most / jerk, float(np.sqrt(delta / jerk)))
        level = max(delta / (jerk * rise) - rise, 0.0) if rise > 0.0 else 0.0
        peak = sign * jerk * rise
        for lasts, a, j in ((rise, 0.0, sign * jerk), (level, peak, 0.0), (rise, peak, -sign * jerk)):
            rows.append((now, travel, v, a, j))
            travel += v * lasts + a * lasts**2 / 2.0 + j * lasts**3 / 6.0
            v += a * lasts + j * lasts**2 / 2.0
            now += lasts
    rows.append((now, travel, v, 0.0, 0.0))
    table = np.array([(rows[0][0] - 1e6, -1e6 * speed, speed, 0.0, 0.0), *rows])

    def at(t: Floats) -> Floats:
        row = table[np.clip(np.searchsorted(table[:, 0], t, side="right") - 1, 0, None)]
        tau = t - row[..., 0]
        return np.asarray(row[..., 1] + tau * (row[..., 2] + tau * (row[..., 3] / 2.0 + tau * row[..., 4] / 6.0)))

    return at


def _indexer(law: Document) -> Made:
    pose, move, since = pose_in(law), float(law["move_s"]), float(law.get("start_s", 0.0))
    period = move + float(law["dwell_s"])
    line = np.array([np.cos(pose.yaw), np.sin(pose.yaw), 0.0])

    def gone(t: Floats) -> Floats:
        whole = np.floor((t - since) / period)
        u = np.clip((t - since - whole * period) / move, 0.0, 1.0)
        return np.asarray(whole + u**4 * (35.0 - 84.0 * u + 70.0 * u**2 - 20.0 * u**3))

    if "step_m" in law:
        return _straight(pose, line, lambda t: law["step_m"] * gone(t)), None
    return (lambda t: pose.moved(0.0, law["step_rad"] * gone(t))), None


def _swing(law: Document) -> Made:
    pivot = Poses.of(law["pivot_m"], law.get("yaw_rad", 0.0))
    rate, phase = 2.0 * np.pi / law["period_s"], law.get("phase_rad", 0.0)
    return (lambda t: pivot.moved(0.0, law["amplitude_rad"] * np.sin(rate * t + phase))), None


def _oscillation(law: Document) -> Made:
    along = np.array(law["direction"], dtype=np.float64)
    along /= np.linalg.norm(along)
    rate, phase = 2.0 * np.pi / law["period_s"], law.get("phase_rad", 0.0)
    return _straight(pose_in(law), along, lambda t: law["amplitude_m"] * np.sin(rate * t + phase)), None


def _keyframes(law: Document) -> Made:
    points, repeat = law["points"], law.get("repeat", False)
    time = np.array([point["time_s"] for point in points], dtype=np.float64)
    values = np.array([[*point["at_m"], point.get("yaw_rad", 0.0)] for point in points], dtype=np.float64)
    turn = values[-1, 3] - values[0, 3] if repeat else 0.0
    values[:, 3] -= turn * (time - time[0]) / (time[-1] - time[0])
    if repeat:
        values[-1] = values[0]
    ends = "periodic" if repeat else law.get("ends", "clamped")
    spline, period = CubicSpline(time, values, bc_type=ends), time[-1] - time[0]

    def at(t: Floats) -> Poses:
        inside = time[0] + (t - time[0]) % period if repeat else np.clip(t, time[0], time[-1])
        found = spline(inside)
        return Poses.of(found[..., :3], found[..., 3] + turn * (t - time[0]) / period)

    return at, None


LAWS: dict[str, Callable[[Document], Made]] = {
    "fixed": _fixed,
    "linear": _linear,
    "conveyor": _conveyor,
    "turntable": _turntable,
    "indexer": _indexer,
    "swing": _swing,
    "oscillation": _oscillation,
    "keyframes": _keyframes,
}
