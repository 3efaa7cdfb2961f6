"""What the checker does with each field of a planned answer. docs/api.md ("The verdict") has the same table, and a test
requires that it has every field of the schema.

A field includes all fields below it, except those that are listed themselves.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

VERIFIED = (
    "schema",
    "status",
    "duration_s",
    "start_s",
    "trajectory",
    "legs",
    "arrivals",
    "contacts",
    "load",
    "certificate",
    "margins",
    "assumptions",
    "seed",
    "request_digest",
    "notice",
)
"""Verified in both directions: any other value is a finding, up to named tolerances."""
ONE_SIDE = (
    "certificate.t0_s",
    "certificate.t1_s",
    "certificate.first",
    "certificate.first_piece",
    "certificate.second",
    "certificate.second_piece",
    "certificate.normal",
    "certificate.shift0_s",
    "certificate.shift1_s",
    "legs.kind",
    "arrivals.trace.slowest_m_s",
    "arrivals.trace.fastest_m_s",
    "arrivals.trace.error_m",
    "arrivals.grip_m",
    "arrivals.support_m",
    "margins.travel_pairs",
    "margins.near_pairs",
)
"""True, but another value might be, too: rows are a proof, and others may be one; an ARCH is one, and a MOVE as well;
bounds are bounds, and may be wider; pairs are so near, and may be nearer at another time."""
RECOMPUTED = ("lower_bound_s",)
"""Computed again from the request by the same code (`planner.bound`), and not proved; a larger value is a finding."""
PROVED_AND_RECOMPUTED = ("arrivals.error",)
"""No smaller than what is proved, and computed again by the code that the planner uses; another value is a finding."""
NOT_CHECKED = (
    "arrivals.window_left_s",
    "census",
    "cut_by_clock",
    "elapsed_s",
    "first_s",
    "legs.note",
    "legs.route",
    "margins.binds",
    "margins.busiest",
    "margins.helps",
    "warnings",
)
"""Notes: only their form is verified. They state what was tried, how long it took, and remarks on the plan
(`planner.report.notes`)."""
PLACES = (VERIFIED, ONE_SIDE, RECOMPUTED, PROVED_AND_RECOMPUTED, NOT_CHECKED)


def not_checked(answer: object) -> tuple[str, ...]:
    """The notes that an answer has, by their paths."""
    return present(answer, NOT_CHECKED)


def present(answer: object, paths: Iterable[str]) -> tuple[str, ...]:
    """Those of the fields, given by their paths, that an answer has and that are not null."""
    return tuple(path for path in paths if _has(answer, path.split(".")))


def _has(inside: Any, keys: list[str]) -> bool:
    if not keys:
        return inside is not None
    if isinstance(inside, list):
        return any(_has(item, keys) for item in inside)
    return isinstance(inside, dict) and keys[0] in inside and _has(inside[keys[0]], keys[1:])
