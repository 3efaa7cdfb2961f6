"""An answer as a viewer plays it: the tracks of its motion, and what it states, as one document."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.model.attachments import Attachments
from assur.planner.model.outcome import LegKind
from assur.planner.model.phases import Phase, phases
from assur.planner.model.scene import Scene
from assur.planner.trajectory import Trajectory
from assur.scenes.answer import NOTICE
from assur.scenes.conventions import Conventions, as_maker, rates_as_maker
from assur.scenes.reading.cell import Cell
from assur.scenes.reading.plan import motion_of
from assur.scenes.schema import view as document
from assur.scenes.view.answer_form import answer_in
from assur.scenes.view.display_meshes import Display, displays, written
from assur.scenes.view.packing import floats, words
from assur.scenes.view.poses import STEP_S
from assur.scenes.view.thinning import needed_of_curves
from assur.scenes.view.tracks import Tracks, tracks

if TYPE_CHECKING:
    from assur.scenes.view.distances import ClosestPair

MOVING_S, STILL_S = 3.0, 1.0
"""Duration of a view without a motion, s: where frames move, and where nothing moves."""
UNPLANNED = {"status": "not_planned"}
"""What is there of an answer before anything was planned."""
SKETCHED_S = 0.01
"""Time between sampled poses of frames in a view without an answer, s: it is drawn while its text is written."""


def view_of(cell: Cell, given: object | None) -> document.ViewDocument:
    """The view of an answer to the request of a cell, as the answer states it: `check` judges whether it is true.
    `given` None: nothing was planned yet, and the arm stands at its start. Raises `DocumentError` below "plan"."""
    # the planner's libraries come with the first view, not with this module
    from assur.scenes.view.distances import distances

    answer: dict[str, Any] = UNPLANNED if given is None else answer_in(given, cell.scene)
    scene, motion = cell.scene, _motion_in(answer)
    refusal, census = answer.get("refusal") or {}, answer.get("census", {})
    if motion is None:
        trajectory, of_plan = _at_rest(scene, refusal)
        step_s = SKETCHED_S if given is None else STEP_S
        shown, active = tracks(scene, trajectory, of_plan, step_s=step_s), tuple[Phase, ...]()
    else:
        trajectory, legs, arrivals = motion_of(motion, cell.conventions)
        of_plan = phases(scene, legs, arrivals)
        shown, active = tracks(scene, trajectory, of_plan, arrivals), tuple(each for each in of_plan if each.robot)
    start, made = shown.start, displays(shown.meshes)
    pairs = distances(scene, trajectory, active, _stated_times(answer, motion))
    planned = answer["status"] == "planned"
    found: Any = {
        **drawn_part(shown, made),
        "status": "planned" if planned else "not_planned",
        "candidate": motion is not None and not planned,
        "moves": motion is not None,
        "curves": None if motion is None else _curves(cell, trajectory, active, motion, start),
        "distances": _distances(shown, pairs),
        "legs": [] if motion is None else [shown_leg(leg, active, start) for leg in motion["legs"]],
        "held": shown_held(answer, start),
        "contacts": [
            {"names": list(each["bodies"]), "from_s": each["from_s"] - start, "to_s": each["to_s"] - start}
            for each in answer.get("contacts", ())
        ],
        "refusal": None if planned or given is None else _refusal(answer, refusal, motion, start),
        "census": [
            {"reason": line["reason"], "count": line["count"], "detail": line["detail"]}
            for line in census.get("lines", ())
        ],
        "candidates": census.get("candidates", 0),
        "request_digest": scene.digest,
        "notice": answer.get("notice", NOTICE),
    }
    return cast("document.ViewDocument", found)


def drawn_part(shown: Tracks, made: Sequence[Display]) -> Any:
    """What a view has of tracks: carriers, bodies on them, control points and the tool."""
    start = shown.start
    return {
        "schema": "assur-view/1",
        "start_s": start,
        "lasts_s": shown.end - start,
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
        "bodies": shown.bodies,
        "control_points": shown.points,
        "tool": {
            "carrier": shown.flange,
            "at_m": [shown.tcp.x, shown.tcp.y, shown.tcp.z],
            "yaw_rad": shown.tcp.yaw,
            "time_s": floats(shown.tool_time - start),
            "path_m": floats(shown.tool_path),
        },
        "reduced": [
            {
                "body": name,
                "triangles": display.triangles,
                "shown": len(display.mesh.faces),
                "off_m": display.off_m,
            }
            for name, display in ((body["name"], made[body["mesh"]]) for body in shown.bodies)
            if display.reduced
        ],
    }


def _motion_in(answer: dict[str, Any]) -> dict[str, Any] | None:
    """What of an answer moves: the plan, or the best candidate of a refusal."""
    return answer if answer["status"] == "planned" else answer.get("best_candidate")


def _at_rest(scene: Scene, refusal: dict[str, Any]) -> tuple[Trajectory, tuple[Phase, ...]]:
    """The arm at rest, for a refusal without a motion: at the start, or where the bodies overlap that it names."""
    moves = any(not frame.law.is_fixed for frame in scene.frames.values())
    start, end = scene.start.time, scene.start.time + (MOVING_S if moves else STILL_S)
    overlap = _overlap(scene, refusal)
    q, of_plan = scene.start.q, tuple[Phase, ...]()
    if overlap is not None:
        q, attached = overlap
        of_plan = (Phase(start, end, LegKind.WAIT, 0, attached, robot=False),)
    still = np.zeros((2, len(q)))
    return Trajectory(np.array([start, end]), np.array([q, q]), still, still), of_plan


def _overlap(scene: Scene, refusal: dict[str, Any]) -> tuple[FloatArray, Attachments] | None:
    """Joints and attachments where the bodies overlap that a refusal names; None: it names none that do."""
    from assur.planner.feasibility.necessary import met_posture

    witness = refusal.get("witness") or {}
    for way in witness["ways"] if witness.get("kind") == "met" else ():
        if way["bodies"] == refusal["bodies"] and way["mode"] is not None:
            found = met_posture(scene, refusal["step"], way["mode"], way["turn_rad"], way["place"])
            if found is not None:
                return found
    return None


def _stated_times(answer: dict[str, Any], motion: dict[str, Any] | None) -> tuple[float, ...]:
    """The times, s, for which an answer states a distance or an overlap."""
    margins = answer.get("margins") or {}
    stated = [margins[key] for key in ("nearest", "placed") if margins.get(key)]
    stated += [*margins.get("travel_pairs", ()), *margins.get("near_pairs", ())]
    at = None if motion is None else motion.get("at_s")
    return (*(each["time_s"] for each in stated), *(() if at is None else (at,)))


def _curves(
    cell: Cell, trajectory: Trajectory, active: tuple[Phase, ...], motion: dict[str, Any], start: float
) -> document.ShownCurves:
    scene, conventions = cell.scene, cell.conventions
    shown = curves(scene, trajectory)
    joints = rates_as_maker(shown.joints, conventions)
    joints[:, 0] = as_maker(shown.joints[:, 0], conventions)
    return {
        "names": [joint.name for joint in conventions],
        "units": ["rad" if joint.kind == "revolute" else "m" for joint in conventions],
        "time_s": floats(shown.time - start),
        "joints": floats(joints),
        "tool": floats(shown.tool),
        "knots_s": floats(np.unique(motion["trajectory"]["time_s"]) - start),
        "limits": _limits(scene, active, conventions, start),
    }


def _limits(
    scene: Scene, active: tuple[Phase, ...], conventions: Conventions, start: float
) -> list[document.ShownLimits]:
    """The limits of the joints over these phases; phases with the same limits share an entry."""
    spans, last = list[document.ShownLimits](), None
    for phase in active:
        limits = phase.attached.limits(scene)
        if limits is last:
            spans[-1]["to_s"] = phase.t1 - start
            continue
        ends = as_maker(np.stack([limits.lower, limits.upper]), conventions)
        most = np.stack([limits.velocity, limits.acceleration, limits.jerk])
        rates = np.abs(rates_as_maker(most, conventions)).tolist()
        spans.append(
            {
                "from_s": phase.t0 - start,
                "to_s": phase.t1 - start,
                "lower": ends.min(0).tolist(),
                "upper": ends.max(0).tolist(),
                "velocity": rates[0],
                "acceleration": rates[1],
                "jerk": rates[2] if scene.options.jerk_limited else None,
            }
        )
        last = limits
    return spans


def _distances(shown: Tracks, pairs: tuple[ClosestPair, ...]) -> document.ShownDistances | None:
    if not pairs:
        return None
    number = {body["name"]: k for k, body in enumerate(shown.bodies)}
    return {
        "time_s": floats([each.time - shown.start for each in pairs]),
        "gap_m": floats([each.gap_m for each in pairs]),
        "required_m": floats([each.required_m for each in pairs]),
        "bodies": words([[number[name] for name in each.bodies] for each in pairs]),
        "points_m": floats([each.points for each in pairs]),
    }


def shown_held(answer: dict[str, Any], start: float) -> list[document.ShownSpan]:
    """When the gripper holds which part."""
    return [
        {"names": [load["part"]], "from_s": load["from_s"] - start, "to_s": load["to_s"] - start}
        for load in answer.get("load", {}).get("carried", ())
        if load["part"] is not None
    ]


def shown_leg(leg: dict[str, Any], active: tuple[Phase, ...], start: float) -> document.ShownLeg:
    """A leg, its times counted from `start`."""
    return {
        "kind": leg["kind"],
        "step": leg["step"],
        "from_s": leg["from_s"] - start,
        "to_s": leg["to_s"] - start,
        "note": leg.get("note", ""),
        "near": any(phase.near and phase.t0 <= leg["from_s"] and leg["to_s"] <= phase.t1 for phase in active),
    }


def _refusal(
    answer: dict[str, Any], refusal: dict[str, Any], motion: dict[str, Any] | None, start: float
) -> document.ShownRefusal:
    best = motion or {}
    at, bodies = best.get("at_s"), best.get("bodies") or refusal.get("bodies") or []
    relaxation = answer.get("relaxation")
    return {
        "reason": answer["reason"],
        "proved": answer["proved"],
        "sentence": answer["sentence"],
        "met": bodies if len(bodies) == 2 else None,
        "at_s": None if at is None else at - start,
        "helps": None if relaxation is None else f"{relaxation['what']}: {relaxation['value']}",
    }


ORDERS = 4
"""Position, velocity, acceleration, jerk."""
PER_PIECE, MOST_SAMPLES = 24, 40_000
"""Samples of each piece of the spline before thinning, and largest number of them in all."""
OFF = 0.002
"""Allowed error of a drawn curve, as a fraction of its limit (of a position: of its range) ..."""
MOST_KEPT = 1_500
"""... unless that needs more samples than this: then the allowed error is doubled, as often as necessary."""


@dataclass(frozen=True, eq=False)
class Curves:
    """`joints` (T, 4, n): position and three derivatives in the planner's convention, SI; `tool` (T, 2): speed, m/s,
    and acceleration, m/s², of the tool point; at times (T,), s. A time occurs twice where a curve jumps."""

    time: FloatArray
    joints: FloatArray
    tool: FloatArray


def curves(scene: Scene, trajectory: Trajectory) -> Curves:
    """The curves of a whole trajectory, with both sides of each knot."""
    edges, c = trajectory.edges, trajectory.coefficients
    many = max(3, min(PER_PIECE, MOST_SAMPLES // max(1, len(c))))
    share = np.linspace(0.0, 1.0, many)
    tau = share[None, :] * np.diff(edges)[:, None]
    time = (edges[:-1, None] + tau).ravel()
    joints = np.empty((*tau.shape, ORDERS, trajectory.n))
    factor = np.ones(6)
    powers = np.arange(6)
    for order in range(ORDERS):
        of = np.where(powers >= order, factor, 0.0)
        terms = tau[..., None] ** np.maximum(powers - order, 0) * of
        joints[..., order, :] = np.einsum("pmk,pnk->pmn", terms, c)
        factor = factor * (powers - order)
    flat = joints.reshape(-1, ORDERS, trajectory.n)
    flange = scene.robot.link_motion(len(scene.robot.links) - 1, *(flat[:, order].copy() for order in range(ORDERS)))
    tool = flange if scene.robot.tilting else flange.at(scene.tool.tcp)
    rates = np.stack([np.linalg.norm(tool.v, axis=-1), np.linalg.norm(tool.a, axis=-1)], -1)
    limits = scene.robot.limits
    spans = np.concatenate([limits.upper - limits.lower, limits.velocity, limits.acceleration, limits.jerk])
    values = np.concatenate([flat.reshape(len(time), -1), rates], -1)
    peaks = np.maximum(np.abs(rates).max(0), 1e-6)
    allowed = OFF * np.concatenate([spans, peaks])
    kept = needed_of_curves(time, values, allowed)
    while len(kept) > MOST_KEPT:
        allowed = 2.0 * allowed
        kept = needed_of_curves(time, values, allowed)
    return Curves(time[kept], flat[kept], rates[kept])
