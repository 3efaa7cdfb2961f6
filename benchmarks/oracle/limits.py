"""What the joints of a shipped robot may do."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchmarks.soak.arms import robot_file
from benchmarks.soak.poses import Document, Floats


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
        np.array([float(_rate(joint, kind)) for joint in given["joints"]]) * float(scales.get(kind, 1.0))
        for kind in ("velocity", "acceleration", "jerk")
    ]
    return Limits(*found)


RATES = {"velocity": "s", "acceleration": "s2", "jerk": "s3"}
UNITS = {"rad": 1.0, "deg": np.pi / 180.0, "m": 1.0, "mm": 1e-3}


def _rate(joint: Document, kind: str) -> float:
    for unit, factor in UNITS.items():
        key = f"{kind}_{unit}_{RATES[kind]}"
        if key in joint:
            value = joint[key]
            return float(value["value"] if isinstance(value, dict) else value) * factor
    raise KeyError(kind)
