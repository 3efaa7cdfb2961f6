"""Plans that were executed one after the other, as one motion that a viewer plays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from assur.planner.model.phases import phases
from assur.planner.trajectory import Trajectory
from assur.scenes.answer import NOTICE
from assur.scenes.reading.plan import motion_of
from assur.scenes.schema import view as document
from assur.scenes.view.display_meshes import Mesh, displays
from assur.scenes.view.document import drawn_part, shown_held, shown_leg
from assur.scenes.view.tracks import drawn, shown_bodies, shown_points

if TYPE_CHECKING:
    from assur.planner.model.outcome import Arrival
    from assur.planner.model.phases import Phase
    from assur.scenes.reading.cell import Cell

Document = dict[str, Any]
SAME_S = 1e-9
"""Times that differ by less are one."""


@dataclass(frozen=True, eq=False)
class ExecutedPlan:
    """A plan: the cell of its request, and its answer; executed from `starts_s` until `until_s`, s."""

    cell: Cell
    answer: Document
    starts_s: float
    until_s: float


class _Shown:
    """The plan of an answer, as far as it is executed."""

    def __init__(self, plan: ExecutedPlan) -> None:
        self.plan, self.scene = plan, plan.cell.scene
        self.motion, legs, arrivals = motion_of(plan.answer, plan.cell.conventions)
        self.arrivals: tuple[Arrival, ...] = tuple(each for each in arrivals if each.until <= plan.until_s)
        of_plan = phases(self.scene, legs, arrivals)
        self.phases: tuple[Phase, ...] = tuple(each for each in of_plan if each.t0 < plan.until_s)

    def knots(self) -> Trajectory:
        """The knots from the start up to the end, which are further knots where there is none: the pieces between are
        the same polynomials."""
        begin, end, own = self.plan.starts_s, self.plan.until_s, self.motion
        inside = own.edges[(own.edges > begin + SAME_S) & (own.edges < end - SAME_S)]
        times = np.array([begin, *inside.tolist(), end])
        states = [own.state(min(time, own.end)) for time in times.tolist()]
        return Trajectory(times, *(np.array([state[k] for state in states]) for k in range(3)))


def run_view(plans: Sequence[ExecutedPlan]) -> document.ViewDocument:
    """The view of plans that follow each other in one cell; parts are drawn from when a plan has them."""
    every = [_Shown(plan) for plan in plans]
    scene, start, end = every[0].scene, plans[0].starts_s, plans[-1].until_s
    bodies, meshes, points = _Bodies(), list[Mesh](), list[document.ShownPoint]()
    legs, held = list[document.ShownLeg](), list[document.ShownSpan]()
    for each in every:
        plan = each.plan
        steps = {leg["step"] for leg in plan.answer["legs"] if leg["from_s"] < plan.until_s}
        # the plan that follows replaces the steps that were not begun
        own = [point for point in shown_points(each.scene, each.arrivals, start) if point["step"] in steps]
        bodies.add(each, meshes, start)
        numbers = {point["step"]: len(points) + k for k, point in enumerate(own)}
        points += [{**point, "step": numbers[point["step"]]} for point in own]
        for leg in plan.answer["legs"]:
            if leg["from_s"] < plan.until_s:
                made = shown_leg(leg, each.phases, start)
                legs.append({**made, "step": numbers[made["step"]], "to_s": min(made["to_s"], plan.until_s - start)})
        for span in shown_held(plan.answer, start):
            if span["from_s"] < plan.until_s - start:
                held.append({**span, "to_s": min(span["to_s"], plan.until_s - start)})
    shown = drawn(
        scene, _joined([each.knots() for each in every]), end, tuple(meshes), bodies.found(end - start), points
    )
    found: Any = {
        **drawn_part(shown, displays(shown.meshes)),
        "status": "planned",
        "candidate": False,
        "moves": True,
        "curves": None,
        "distances": None,
        "legs": legs,
        "held": held,
        "contacts": [],
        "refusal": None,
        "census": [],
        "candidates": 0,
        "request_digest": scene.digest,
        "notice": NOTICE,
    }
    return cast("document.ViewDocument", found)


def _joined(parts: list[Trajectory]) -> Trajectory:
    """One trajectory: where one ends and the next begins there is one knot, that of the next."""
    arrays = [[getattr(part, key)[: None if part is parts[-1] else -1] for part in parts] for key in KNOTS]
    return Trajectory(*(np.concatenate(each) for each in arrays))


KNOTS = ("time", "q", "qd", "qdd")
"""Arrays of a trajectory."""


class _Bodies:
    """The bodies of all plans by their names: where each is in one plan after the other, and when it is no longer."""

    def __init__(self) -> None:
        self._bodies: dict[str, document.ShownBody] = {}
        self._last: dict[str, float] = {}

    def add(self, each: _Shown, meshes: list[Mesh], start: float) -> None:
        """Adds those of a plan; `meshes` gets the ones that are new."""
        plan = each.plan
        own, found = shown_bodies(each.scene, each.phases, start)
        numbers = [_number(mesh, meshes) for mesh in own]
        for body in found:
            seats = [{**seat, "from_s": max(seat["from_s"], plan.starts_s - start)} for seat in body["seats"]]
            self._last[body["name"]] = plan.until_s - start
            known = self._bodies.get(body["name"])
            made: Any = {**body, "mesh": numbers[body["mesh"]], "seats": seats}
            if known is not None:
                kind = "part" if "part" in (known["kind"], body["kind"]) else known["kind"]
                made |= {"seats": [*known["seats"], *seats], "kind": kind}
            self._bodies[body["name"]] = made

    def found(self, end: float) -> list[document.ShownBody]:
        """All bodies, seats that are the same one after the other once. `end`: of all plans, s since the
        start."""
        made = []
        for name, body in self._bodies.items():
            seats = list[document.ShownSeat]()
            for seat in body["seats"]:
                if not seats or {**seats[-1], "from_s": 0.0} != {**seat, "from_s": 0.0}:
                    seats.append(seat)
            gone_s = body["gone_s"]
            if self._last[name] < end and gone_s is None:
                gone_s = self._last[name]
            made.append(cast("document.ShownBody", {**body, "seats": seats, "gone_s": gone_s}))
        return made


def _number(mesh: Mesh, meshes: list[Mesh]) -> int:
    """The number of a mesh among others, to which it is added if it is new."""
    same = (mesh.vertices.tobytes(), mesh.faces.tobytes())
    for number, other in enumerate(meshes):
        if (other.vertices.tobytes(), other.faces.tobytes()) == same:
            return number
    meshes.append(mesh)
    return len(meshes) - 1
