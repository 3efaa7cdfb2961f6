"""Whether parts that are put on what came on a stream go into its slots, each once and in the window of the stream."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from benchmarks.judge.faults import Violation, beyond
from benchmarks.judge.poses import Document, Poses, pose_in, si

if TYPE_CHECKING:
    from benchmarks.judge.sessions import Session

PLACE_M = 1e-6
"""How exactly places of documents are the same."""


def slots_kept(session: Session, used: dict[tuple[str, str, int], str]) -> list[Violation]:
    """Parts that are put on what came on a stream: each in a slot of that kind, which the stream's window has then, and
    which no part has been put into before (`used`, of sessions before this one, too)."""
    found, kinds = list[Violation](), {each.name: each.kind for each in session.sightings}
    for plan in session.plans:
        for arrival in plan.motion.answer["arrivals"]:
            given = plan.motion.request["task"][arrival["step"]].get("place", {})
            carrier, until_s = given.get("to", {}).get("body"), float(arrival["until_s"])
            if carrier not in kinds or until_s > plan.until_s:
                continue
            about, there = f"{given['part']} on {carrier}", pose_in(given["to"])
            slots = {
                (name, number): float(np.linalg.norm(at.p - there.p))
                for name, grid in session.document.get("slots", {}).items()
                for number, at in enumerate(slots_of(grid))
                if grid.get("kind") == kinds[carrier]
            }
            slot = min(slots, key=lambda each: slots[each], default=("", 0))
            found += beyond("slot", f"{about}, off any", slots.get(slot, np.inf), PLACE_M, until_s)
            other = used.setdefault((carrier, *slot), given["part"])
            if other != given["part"]:
                found.append(Violation("slot", f"{about}, in that of {other}", 1.0, 0.0, until_s))
            frame, pose = plan.cell.seat(given["to"])
            law = plan.motion.request["frames"][frame]["conveyor"]
            for time in (until_s - float(given["dwell_s"]), until_s):
                x = float(pose_in(law).inverse().then(plan.cell.frames[frame].at(np.array(time)).then(pose)).p[0])
                first, last = _window_of(session, frame, kinds[carrier])
                found += beyond("slot", f"{about}, before the window", first - x, PLACE_M, time)
                found += beyond("slot", f"{about}, behind the window", x - last, PLACE_M, time)
    return found


def slots_of(grid: Document) -> Iterator[Poses]:
    """The slots of a grid one after the other: along x, then along y, then along z."""
    at, step, (nx, ny, nz) = si(grid, "at", (0.0,) * 3), si(grid, "step", (0.0,) * 3), grid.get("count", (1, 1, 1))
    for k, j, i in product(range(nz), range(ny), range(nx)):
        yield Poses.of(at + np.array([i, j, k]) * step, si(grid, "yaw", 0.0))


def _window_of(session: Session, frame: str, kind: str) -> tuple[float, float]:
    """The window of the stream that brings a kind on a frame, m."""
    for stream in session.document["streams"].values():
        if stream["frame"] == frame and kind in (stream.get("kind"), *stream.get("kinds", {})):
            first, last = si(stream, "window")
            return float(first), float(last)
    return np.inf, -np.inf
