"""Marks that show how frames move: arrows on a frame that travels, spokes on one that turns, as flat triangles.

Bodies alone do not show it: the bed of a belt does not move, and a round table looks the same at every angle.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.scenes.view.display_meshes import Mesh
from assur.scenes.view.poses import Track
from assur.scenes.view.quaternions import rotated
from assur.scenes.view.tracks import Tracks

APART_M, BELT_M = 0.1, 0.5
"""Arrows are so far apart, for so far before and behind the frame."""
ARM_M, WIDE_M = 0.02, 0.005
"""Length of each arm of an arrow, and width of it and of a spoke."""
MOST_ARROWS = 200
SPOKES = 12
ABOVE_M = 1e-3
"""Height of marks above their body, so that no two faces are at one place."""
TRAVELS_M, TURNS = 1e-3, 1e-6
"""A frame that moves less has no mark: m, and numbers of quaternions."""


def marks_of(shown: Tracks) -> dict[int, Mesh]:
    """The marks on frames that move, in their frames, by the number of the carrier. Frames of other robots have none:
    their links show how they move."""
    found: dict[int, Mesh] = {}
    for number, track in enumerate(shown.carriers):
        if number <= shown.flange or "/" in track.name or len(track.time) == 1:
            continue
        way = track.position[-1] - track.position[0]
        turns = bool((np.abs(track.rotation[-1] - track.rotation[0]) > TURNS).any())
        disc = _disc_on(shown, number)
        if turns and disc is not None:
            found[number] = _quads(_spokes(*disc))
        elif not turns and float(np.linalg.norm(way)) > TRAVELS_M:
            found[number] = _quads(_arrows(_in_frame(track, way)))
    return found


def _disc_on(shown: Tracks, number: int) -> tuple[float, float] | None:
    """Radius and top, m, of the bodies that sit on a carrier at first and for good, if they lie around its origin; what
    swings beside its pivot shows by itself how it moves."""
    points = [
        shown.meshes[body["mesh"]].vertices + body["seats"][0]["at_m"]
        for body in shown.bodies
        if len(body["seats"]) == 1 and body["seats"][0]["carrier"] == number
    ]
    if not points:
        return None
    low, high = np.concatenate(points).min(0), np.concatenate(points).max(0)
    if not ((low[:2] < 0.0) & (high[:2] > 0.0)).all():
        return None
    return float(np.maximum(-low[:2], high[:2]).max()), float(high[2])


def _in_frame(track: Track, way: FloatArray) -> FloatArray:
    """A way of the world in the axes that the carrier has at first."""
    return rotated(track.rotation[0] * np.array([-1.0, -1.0, -1.0, 1.0]), way)


def _arrows(way: FloatArray) -> FloatArray:
    """Segments (S, 2, 3) of arrows along a way, from as far behind as it goes."""
    length = float(np.linalg.norm(way))
    along = way / length
    aside = np.array([-along[1], along[0], 0.0])
    reach = BELT_M + length
    places = np.linspace(-reach, BELT_M, min(MOST_ARROWS, 1 + round((reach + BELT_M) / APART_M)))
    tips = places[:, None] * along + np.array([0.0, 0.0, ABOVE_M])
    return np.concatenate([np.stack([tips, tips + ARM_M * (side * aside - along)], 1) for side in (-1.0, 1.0)])


def _spokes(radius: float, top: float) -> FloatArray:
    """Segments (S, 2, 3) of spokes near the rim, each fourth of them longer."""
    angles = 2.0 * math.pi * np.arange(SPOKES) / SPOKES
    around = np.stack([np.cos(angles), np.sin(angles), np.zeros(SPOKES)], -1)
    inner = np.where(np.arange(SPOKES) % 3, 0.9, 0.72)[:, None] * radius * around
    found: FloatArray = np.stack([inner, 0.97 * radius * around], 1) + np.array([0.0, 0.0, top + ABOVE_M])
    return found


def _quads(segments: FloatArray) -> Mesh:
    """Flat stripes along segments (S, 2, 3) that are not upright."""
    way = segments[:, 1] - segments[:, 0]
    across = np.stack([-way[:, 1], way[:, 0], np.zeros(len(way))], -1)
    across *= WIDE_M / 2.0 / np.maximum(np.linalg.norm(across, axis=1, keepdims=True), TURNS)
    one, other = segments[:, 0], segments[:, 1]
    vertices = np.stack([one - across, one + across, other + across, other - across], 1).reshape(-1, 3)
    first = 4 * np.arange(len(segments))[:, None]
    faces = np.concatenate([first + np.array(corners) for corners in ((0, 2, 1), (0, 3, 2))])
    return Mesh(vertices, faces)
