"""The shapes of all bodies of a request, by which the oracle measures distances (`soak.solids.Gap`)."""

from __future__ import annotations

from benchmarks.oracle.places import Places
from benchmarks.soak.poses import Document, Poses, pose_in
from benchmarks.soak.solids import Shape, shape_of, solid_of


def shapes_of(request: Document, robots: dict[str, Document]) -> dict[str, Shape]:
    """Of all bodies of a request by name; `robots`: the files of the shipped robots by the prefix of their bodies."""
    found = {body["name"]: shape_of(solid_of(body["shape"])) for body in request.get("bodies", [])}
    for prefix, given in robots.items():
        found |= {f"{prefix}{body['name']}": shape_of(solid_of(body["shape"])) for body in given["bodies"]["value"]}
    for body in request["robot"]["tool"].get("bodies", []):
        found[body["name"]] = shape_of(solid_of(body["shape"]))
    for neighbour in request.get("neighbours", []):
        for body in neighbour["robot"]["tool"].get("bodies", []):
            found[f"{neighbour['name']}/{body['name']}"] = shape_of(solid_of(body["shape"]))
    return found


def still(document: Document) -> Places:
    """The place that a document gives by `at_m` and `yaw_rad`."""
    return Places.upright(Poses(pose_in(document).p, pose_in(document).yaw))
