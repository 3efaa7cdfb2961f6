"""Distances of solids by `coal`: signed for convex ones; of a mesh, which is its triangles, 0 where it is crossed.

A mesh is a surface to `coal`: what is inside is not seen, and no depth of an overlap is known.
"""

from __future__ import annotations

from typing import Any

import coal
import numpy as np
from numpy.typing import NDArray

from benchmarks.oracle.places import Places
from benchmarks.soak.poses import Document, Floats, Poses, pose_in, si
from benchmarks.soak.solids import solid_of

AXES = {"x": (1, np.pi / 2.0), "y": (0, -np.pi / 2.0)}
"""About which axis, and by how much, what lies along z is turned to lie along x or y."""


class Shape:
    """A shape of a request or a robot's file. `inner`: where the shape of `coal` is in the body's frame; `radius`: of a
    ball about `inner` that holds it, m; `mesh`: whether it is a surface."""

    def __init__(self, document: Document) -> None:
        ((kind, given),) = document.items()
        self.kind, self.mesh, inner = kind, False, Places.at(np.zeros(3))
        if kind == "box":
            x, y, z = (float(v) for v in si(given, "size"))
            self.geometry: Any = coal.Box(x, y, z)
            self.radius = float(np.linalg.norm([x, y, z])) / 2.0
        elif kind == "sphere":
            self.radius = float(si(given, "radius"))
            self.geometry = coal.Sphere(self.radius)
        elif kind in ("cylinder", "capsule"):
            r, axis = float(si(given, "radius")), given.get("axis", "z")
            length = float(si(given, "height" if kind == "cylinder" else "length"))
            self.geometry = coal.Cylinder(r, length) if kind == "cylinder" else coal.Capsule(r, length)
            self.radius = float(np.hypot(r, length / 2.0)) if kind == "cylinder" else r + length / 2.0
            if axis in AXES:
                inner = Places.turned(*AXES[axis])
        elif kind == "mesh":
            triangles = solid_of(document).triangles
            assert triangles is not None
            self.geometry, self.mesh = _surface(triangles), True
            middle = (triangles.min(axis=(0, 1)) + triangles.max(axis=(0, 1))) / 2.0
            self.radius = float(np.linalg.norm(triangles - middle, axis=-1).max() + np.linalg.norm(middle))
        else:
            raise ValueError(f"a shape that the oracle does not know: {kind}")
        self.inner = inner


def _surface(triangles: Floats) -> Any:
    model = coal.BVHModelOBBRSS()
    model.beginModel(len(triangles), 3 * len(triangles))
    for a, b, c in triangles:
        model.addTriangle(a, b, c)
    model.endModel()
    return model


class Gap:
    """The distance of two shapes, m: less than 0 where convex ones overlap, by the least way that would part them."""

    def __init__(self, first: Shape, second: Shape) -> None:
        self._one, self._other = first, second
        self._distance = coal.ComputeDistance(first.geometry, second.geometry)
        self._request, self._result = coal.DistanceRequest(), coal.DistanceResult()
        self._request.enable_signed_distance = not (first.mesh or second.mesh)

    def at(self, a: Places, b: Places) -> float:
        """With both bodies at single places, as `among`."""
        return float(self.among(Places(a.r[None], a.p[None]), Places(b.r[None], b.p[None]), np.zeros(1, dtype=int))[0])

    def among(self, a: Places, b: Places, at: NDArray[np.int_]) -> Floats:
        """At some (K,) of N places of both bodies, (K,) m. Raises `ValueError` where these are not finite: `coal` would
        be silent."""
        one, other = a[at].then(self._one.inner), b[at].then(self._other.inner)
        if not (np.isfinite(one.p).all() and np.isfinite(other.p).all()):
            raise ValueError("a place that is not finite")
        found, place = np.empty(len(at)), coal.Transform3s
        for k in range(len(at)):
            self._result.clear()
            first, second = place(one.r[k], one.p[k]), place(other.r[k], other.p[k])
            found[k] = self._distance(first, second, self._request, self._result)
        return found


def shapes_of(request: Document, robots: dict[str, Document]) -> dict[str, Shape]:
    """Of all bodies of a request by name; `robots`: the files of the shipped robots by the prefix of their bodies."""
    found = {body["name"]: Shape(body["shape"]) for body in request.get("bodies", [])}
    for prefix, given in robots.items():
        found |= {f"{prefix}{body['name']}": Shape(body["shape"]) for body in given["bodies"]["value"]}
    for body in request["robot"]["tool"].get("bodies", []):
        found[body["name"]] = Shape(body["shape"])
    for neighbour in request.get("neighbours", []):
        for body in neighbour["robot"]["tool"].get("bodies", []):
            found[f"{neighbour['name']}/{body['name']}"] = Shape(body["shape"])
    return found


def still(document: Document) -> Places:
    """The place that a document gives by `at_m` and `yaw_rad`."""
    return Places.upright(Poses(pose_in(document).p, pose_in(document).yaw))
