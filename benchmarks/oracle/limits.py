"""What the joints of a shipped robot may do."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchmarks.soak.arms import robot_file
from benchmarks.soak.poses import Document, Floats, si


@dataclass(frozen=True, eq=False)
class Limits:
    """What joints may do, as the request narrows it: velocities, accelerations and jerks (n,), without a sign."""

    velocity: Floats
    acceleration: Floats
    jerk: Floats


def limits_of(document: Document) -> Limits:
    """The limits of a request's robot."""
    ((_, given),) = robot_file(document["model"]).items()
    scales = document.get("limits", {})
    found = [
        np.array([rate(joint, kind) for joint in given["joints"]]) * float(scales.get(kind, 1.0))
        for kind in ("velocity", "acceleration", "jerk")
    ]
    return Limits(*found)


RATES = {"velocity": "_s", "acceleration": "_s2", "jerk": "_s3"}
"""Ends of the keys of rates, behind the unit of the joint's position."""


def rate(joint: Document, kind: str) -> float:
    """The velocity, acceleration or jerk that a joint in a robot's file may have, in SI."""
    end = RATES[kind]
    return float(si({key.removesuffix(end): value for key, value in joint.items() if key.endswith(end)}, kind))
