"""Profiles of different joints, or of one joint one after another, put together on one clock."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError
from assur.planner.timing.profile import Profile
from assur.planner.timing.writing import COINCIDENT
from assur.planner.trajectory import Trajectory

MEETING_POSITION = 1e-9
"""rad or m. Profiles of one joint meet in the same place up to this, as trajectories do."""

_Part = tuple[float, Profile, int]
"""Offset in s, profile, column in it."""


def combine(
    profiles: Sequence[Profile],
    offsets: Sequence[float],
    duration: float | None = None,
    joints: Sequence[Sequence[int]] | None = None,
) -> Profile:
    """One profile of all joints: profile number k begins `offsets[k]` s after the start.

    Serves arches: the vertical joint goes up, stands, and goes down, while the others go across and overlap with both.
    Before its first, between and after its profiles a joint stands still.

    Arguments: `joints[k]` are the numbers of the joints that profile k moves, in its order; None: profiles take the
    joints one after another, each joint once. A joint may have several profiles if they do not overlap. `duration`
    in s; None: until the last one ends.

    Raises `FaultError` when a joint would have to stand where its profile moves (velocity or acceleration not exactly
    zero), when profiles of one joint overlap or do not meet, when a joint has none, or one ends after `duration`.
    """
    if len(profiles) != len(offsets) or not profiles:
        raise FaultError(f"{len(profiles)} profiles and {len(offsets)} offsets")
    if joints is None:
        counts = [0, *np.cumsum([profile.n for profile in profiles]).tolist()]
        joints = [range(a, b) for a, b in pairwise(counts)]
    ends = [offset + profile.duration for offset, profile in zip(offsets, profiles, strict=True)]
    if duration is None:
        duration = max(ends)
    if not (min(offsets) >= 0 and max(ends) <= duration + COINCIDENT):
        raise FaultError(f"profiles from {min(offsets)} to {max(ends)} s do not fit into 0 to {duration} s")
    parts: dict[int, list[_Part]] = {}
    for profile, offset, numbers in zip(profiles, offsets, joints, strict=True):
        if len(numbers) != profile.n:
            raise FaultError(f"a profile of {profile.n} joints for joints {list(numbers)}")
        for column, joint in enumerate(numbers):
            parts.setdefault(joint, []).append((float(offset), profile, column))
    if sorted(parts) != list(range(len(parts))):
        raise FaultError(f"profiles for joints {sorted(parts)} only")
    rows = [_row(joint, sorted(parts[joint], key=lambda part: part[0]), duration) for joint in range(len(parts))]
    size = max(len(time) for time, _, _ in rows)
    time, phases = np.full((len(rows), size), duration), np.empty((len(rows), size, 6))
    for joint, (begins, coefficients, _) in enumerate(rows):
        time[joint, : len(begins)] = begins
        phases[joint, : len(begins)] = coefficients
        phases[joint, len(begins) :] = coefficients[-1]
    states = np.stack([ends for _, _, ends in rows], -1)
    limits = [np.max([profile.limits[:, k] for _, profile, k in parts[joint]], 0) for joint in range(len(rows))]
    return Profile(
        duration,
        time,
        phases,
        (states[0], states[1], states[2]),
        (states[3], states[4], states[5]),
        np.stack(limits, -1),
    )


def _row(joint: int, parts: list[_Part], duration: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Begins of phases (S,), their coefficients (S, 6) and both end states (6,) of one joint."""
    times, phases = [np.zeros(1)], []
    clock, place = 0.0, float(parts[0][1].start[0][parts[0][2]])
    first = np.array([place, 0.0, 0.0])
    state = first
    for number, (offset, profile, column) in enumerate(parts):
        begin = np.array([s[column] for s in profile.start])
        if not offset >= clock - COINCIDENT:
            raise FaultError(f"joint {joint}: a profile begins at {offset} s, the one before ends at {clock} s")
        if not abs(begin[0] - state[0]) <= MEETING_POSITION:
            raise FaultError(f"joint {joint}: a profile begins at {begin[0]}, the one before ends at {state[0]}")
        if number or offset > 0:
            if state[1:].any() or begin[1:].any():
                raise FaultError(f"joint {joint}: stands still until {offset} s, but is not at rest there")
        else:
            first = begin
        phases.append(np.array([state[0], 0.0, 0.0, 0.0, 0.0, 0.0])[None] if not number else np.zeros((0, 6)))
        phases.append(profile.phases[column])
        times.append(np.minimum(np.maximum(profile.time[column] + offset, clock), duration))
        clock = min(offset + profile.duration, duration)
        state = np.array([s[column] for s in profile.end])
    if clock < duration - COINCIDENT:
        if state[1:].any():
            raise FaultError(f"joint {joint}: stands still from {clock} s, but is not at rest there")
        times.append(np.array([duration]))
        phases.append(np.array([[state[0], 0.0, 0.0, 0.0, 0.0, 0.0]]))
    else:
        times[-1][-1] = duration
    return np.concatenate(times), np.concatenate(phases), np.concatenate([first, state])


def to_trajectory(profile: Profile, start_time: float = 0.0) -> Trajectory:
    """The knots of a profile that begins at `start_time` s, as a trajectory."""
    return Trajectory(*profile.knots(start_time))
