"""An answer as a viewer plays it: the tracks of its motion, and what it says, as one document."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.model.attachments import Attachments
from assur.planner.model.outcome import LegKind
from assur.planner.model.phases import Phase, phases
from assur.planner.model.scene import Scene
from assur.scenes.answer import NOTICE
from assur.scenes.conventions import Conventions, as_maker, rates_as_maker
from assur.scenes.reading.cell import Cell
from assur.scenes.reading.plan import motion_of
from assur.scenes.schema import view as document
from assur.scenes.view.answer_form import answer_in
from assur.scenes.view.display_meshes import displays, written
from assur.scenes.view.packing import floats, words

if TYPE_CHECKING:
    from assur.planner.tracks.tracks import Tracks

STANDS_S = 3.0
"""For how long frames are shown where nothing was planned, s."""
STILL_S = 1.0
"""The same where nothing moves."""


def view_of(cell: Cell, given: object) -> document.ViewDocument:
    """The view of an answer to the request of a cell. What the answer says is shown as it is said; whether it is so,
    the checker knows. Raises `DocumentError` below "plan"."""
    # the planner's libraries come with the first view, not with this module
    from assur.planner.tracks.tracks import standing, tracks

    answer = answer_in(given, cell.scene)
    scene, motion = cell.scene, _motion_in(answer)
    refusal, census = answer.get("refusal") or {}, answer.get("census", {})
    also = [each["time_s"] for each in _nearest_said(answer)]
    if motion is None:
        moves = any(not frame.law.is_fixed for frame in scene.frames.values())
        lasts, met = STANDS_S if moves else STILL_S, _met(scene, refusal)
        q, attached = (scene.start.q, None) if met is None else met
        end = scene.start.time + lasts
        sits = () if attached is None else (Phase(scene.start.time, end, LegKind.WAIT, 0, attached, robot=False),)
        shown = tracks(scene, standing(scene, lasts, q), sits)
        legs: list[dict[str, Any]] = []
    else:
        trajectory, of_plan, arrivals = motion_of(motion, cell.conventions)
        at = _instant(motion)
        also += [] if at is None else [at]
        shown = tracks(scene, trajectory, phases(scene, of_plan, arrivals), arrivals, tuple(also))
        legs = motion["legs"]
    start, made = shown.start, displays(shown.meshes)
    planned = answer["status"] == "planned"
    return {
        "schema": "assur-view/1",
        "status": "planned" if planned else "not_planned",
        "candidate": motion is not None and not planned,
        "start_s": start,
        "lasts_s": shown.end - start,
        "moves": motion is not None,
        "carriers": [
            {
                "name": track.name,
                "time_s": floats(track.time - start),
                "position_m": floats(track.position),
                "rotation": floats(track.rotation),
            }
            for track in shown.carriers
        ],
        "meshes": [written(display.mesh) for display in made],
        "bodies": _bodies(shown),
        "control_points": _points(shown),
        "tool": {
            "carrier": shown.flange,
            "at_m": [shown.tcp.x, shown.tcp.y, shown.tcp.z],
            "yaw_rad": shown.tcp.yaw,
            "time_s": floats(shown.tool_time - start),
            "path_m": floats(shown.tool_path),
        },
        "curves": _curves(shown, cell.conventions, motion, blended=scene.options.blended),
        "distances": _distances(shown),
        "legs": [_leg(leg, shown) for leg in legs],
        "held": [
            {"names": [load["part"]], "from_s": load["from_s"] - start, "to_s": load["to_s"] - start}
            for load in answer.get("load", {}).get("carried", ())
            if load["part"] is not None
        ],
        "contacts": [
            {"names": list(each["bodies"]), "from_s": each["from_s"] - start, "to_s": each["to_s"] - start}
            for each in answer.get("contacts", ())
        ],
        "refusal": None if planned else _refusal(answer, refusal, motion, start),
        "census": [
            {"reason": line["reason"], "count": line["count"], "detail": line["detail"]}
            for line in census.get("lines", ())
        ],
        "candidates": census.get("candidates", 0),
        "reduced": [
            {
                "body": body.name,
                "triangles": made[body.mesh].triangles,
                "shown": len(made[body.mesh].mesh.faces),
                "off_m": made[body.mesh].off_m,
            }
            for body in shown.bodies
            if made[body.mesh].triangles != len(made[body.mesh].mesh.faces)
        ],
        "request_digest": scene.digest,
        "notice": answer.get("notice", NOTICE),
    }


def _motion_in(answer: dict[str, Any]) -> dict[str, Any] | None:
    """What of an answer moves: the plan, or the best candidate of a refusal."""
    return answer if answer["status"] == "planned" else answer.get("best_candidate")


def _met(scene: Scene, refusal: dict[str, Any]) -> tuple[FloatArray, Attachments] | None:
    """Where the arm and all bodies are when those meet that a refusal names; None: at the start, or nowhere."""
    from assur.planner.feasibility.met_posture import met_posture

    witness = refusal.get("witness") or {}
    for way in witness["ways"] if witness.get("kind") == "met" else ():
        if way["bodies"] == refusal["bodies"] and way["mode"] is not None:
            found = met_posture(scene, refusal["step"], way["mode"], way["turn_rad"], way["place"])
            if found is not None:
                return found
    return None


def _nearest_said(answer: dict[str, Any]) -> list[dict[str, Any]]:
    margins = answer.get("margins") or {}
    nearest = [margins[key] for key in ("nearest", "placed") if margins.get(key)]
    return [*nearest, *margins.get("travel_pairs", ()), *margins.get("near_pairs", ())]


def _instant(motion: dict[str, Any]) -> float | None:
    at = motion.get("at_s")
    return None if at is None else float(at)


def _bodies(shown: Tracks) -> list[document.ShownBody]:
    return [
        {
            "name": body.name,
            "kind": body.kind,
            "mesh": body.mesh,
            "seats": [
                {
                    "from_s": seat.time - shown.start,
                    "carrier": seat.carrier,
                    "at_m": [seat.pose.x, seat.pose.y, seat.pose.z],
                    "yaw_rad": seat.pose.yaw,
                }
                for seat in body.seats
            ],
            "unknown": {
                "horizontal_m": body.shell.horizontal_m,
                "growth_m_s": body.shell.growth_m_s,
                "vertical_m": body.shell.vertical_m,
            }
            if body.shell.any
            else None,
        }
        for body in shown.bodies
    ]


def _points(shown: Tracks) -> list[document.ShownPoint]:
    return [
        {
            "name": point.name,
            "step": point.step,
            "kind": point.kind,
            "carrier": point.carrier,
            "at_m": [point.pose.x, point.pose.y, point.pose.z],
            "yaw_rad": point.pose.yaw,
            "time_s": None if point.time is None else point.time - shown.start,
            "until_s": None if point.until is None else point.until - shown.start,
            "path_m": None if point.path is None else floats(point.path),
        }
        for point in shown.points
    ]


def _curves(
    shown: Tracks, conventions: Conventions, motion: dict[str, Any] | None, *, blended: bool
) -> document.ShownCurves | None:
    if shown.curves is None or motion is None:
        return None
    start, counted = shown.start, shown.curves
    spans = list[document.ShownLimits]()
    for span in shown.limits:
        limits = span.limits
        ends = as_maker(np.stack([limits.lower, limits.upper]), conventions)
        most = np.stack([limits.velocity, limits.acceleration, limits.jerk])
        rates = np.abs(rates_as_maker(most, conventions)).tolist()
        spans.append(
            {
                "from_s": span.start - start,
                "to_s": span.end - start,
                "lower": ends.min(0).tolist(),
                "upper": ends.max(0).tolist(),
                "velocity": rates[0],
                "acceleration": rates[1],
                "jerk": None if blended else rates[2],
            }
        )
    joints = rates_as_maker(counted.joints, conventions)
    joints[:, 0] = as_maker(counted.joints[:, 0], conventions)
    return {
        "names": [joint.name for joint in conventions],
        "units": ["rad" if joint.kind == "revolute" else "m" for joint in conventions],
        "time_s": floats(counted.time - start),
        "joints": floats(joints),
        "tool": floats(counted.tool),
        "knots_s": floats(np.unique(motion["trajectory"]["time_s"]) - start),
        "limits": spans,
    }


def _distances(shown: Tracks) -> document.ShownDistances | None:
    found = shown.distances
    if not found:
        return None
    number = {body.name: k for k, body in enumerate(shown.bodies)}
    return {
        "time_s": floats([each.time - shown.start for each in found]),
        "gap_m": floats([each.gap_m for each in found]),
        "required_m": floats([each.required_m for each in found]),
        "bodies": words([[number[name] for name in each.bodies] for each in found]),
        "points_m": floats([each.points for each in found]),
    }


def _leg(leg: dict[str, Any], shown: Tracks) -> document.ShownLeg:
    near = any(first <= leg["from_s"] and leg["to_s"] <= last for first, last in shown.near)
    return {
        "kind": leg["kind"],
        "step": leg["step"],
        "from_s": leg["from_s"] - shown.start,
        "to_s": leg["to_s"] - shown.start,
        "note": leg.get("note", ""),
        "near": near,
    }


def _refusal(
    answer: dict[str, Any], refusal: dict[str, Any], motion: dict[str, Any] | None, start: float
) -> document.ShownRefusal:
    at, bodies = None if motion is None else _instant(motion), refusal.get("bodies") or []
    if motion is not None and motion.get("bodies"):
        bodies = motion["bodies"]
    relaxation = answer.get("relaxation")
    return {
        "reason": answer["reason"],
        "proved": answer["proved"],
        "sentence": answer["sentence"],
        "met": bodies if len(bodies) == 2 else None,
        "at_s": None if at is None else at - start,
        "helps": None if relaxation is None else f"{relaxation['what']}: {relaxation['value']}",
    }
