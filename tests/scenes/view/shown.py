"""Views of shipped scenarios, made once, and where a view says that bodies are: read as a viewer reads it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from assur.planner.model.scene import Scene
from assur.scenes.reading.cell import Cell
from assur.scenes.requests import cell_of
from assur.scenes.scenarios import shipped
from assur.scenes.view.document import view_of
from assur.scenes.view.packing import unpacked
from tests.scenes.cells.answers import answer

Array = NDArray[np.float64]
Document = dict[str, Any]


@cache
def cell(name: str) -> Cell:
    """The cell of a shipped scenario."""
    scenario = shipped(name)
    return cell_of(scenario.request, folder=scenario.folder)


@cache
def view(name: str) -> Document:
    """The view of the answer to a shipped scenario."""
    return dict(view_of(cell(name), answer(name)))


def scene(name: str) -> Scene:
    """The scene of a shipped scenario."""
    return cell(name).scene


@dataclass(frozen=True)
class Rigid:
    """A pose in the world: position (3,) m and rotation matrix (3, 3)."""

    p: Array
    r: Array

    def of(self, points: Array) -> Array:
        """Points (m, 3) of this frame in the world."""
        return self.p + points @ self.r.T


def matrix(q: Array) -> Array:
    """The rotation of a unit quaternion x, y, z, w."""
    x, y, z, w = q / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def carrier_at(track: Document, t: float) -> Rigid:
    """Where a carrier of a view is at t s since its start: straight lines and shorter arcs between samples."""
    times, places, turns = (unpacked(track[key]) for key in ("time_s", "position_m", "rotation"))
    k = int(np.clip(np.searchsorted(times, t, side="right") - 1, 0, max(0, len(times) - 2)))
    if len(times) == 1:
        return Rigid(places[0], matrix(turns[0]))
    u = float(np.clip((t - times[k]) / (times[k + 1] - times[k]), 0.0, 1.0))
    one, other = turns[k], turns[k + 1] * np.sign(turns[k] @ turns[k + 1] or 1.0)
    angle = np.arccos(min(1.0, one @ other))
    if angle < 1e-9:
        turn = one
    else:
        turn = (np.sin((1 - u) * angle) * one + np.sin(u * angle) * other) / np.sin(angle)
    return Rigid(places[k] + u * (places[k + 1] - places[k]), matrix(turn))


def seat_at(body: Document, t: float) -> Document:
    """The seat of a body of a view at a time."""
    seats: list[Document] = [seat for seat in body["seats"] if seat["from_s"] <= t] or body["seats"][:1]
    return seats[-1]


def drawn(document: Document, body: Document, t: float) -> Array:
    """The vertices (V, 3) of a body of a view in the world at t s since its start."""
    mesh, seat = document["meshes"][body["mesh"]], seat_at(body, t)
    points = np.array(mesh["low_m"]) + unpacked(mesh["vertices"]) * np.array(mesh["step_m"])
    c, s = np.cos(seat["yaw_rad"]), np.sin(seat["yaw_rad"])
    in_carrier = np.array(seat["at_m"]) + points @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]).T
    return carrier_at(document["carriers"][seat["carrier"]], t).of(in_carrier)
