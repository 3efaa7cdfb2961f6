"""How near an arm comes to singular positions, and in which working mode it is: rows of `axes`.

Each function gives rows with what they are called for people.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.claim.points import Rows
from assur.planner.legs.least_margins import instants, least_margins
from assur.planner.model.claims import Claims
from assur.planner.model.outcome import TRACKING, Arrival, LegKind, Plan
from assur.planner.model.scene import Move, Scene
from assur.planner.robots.chain import AHEAD, LEFT, Bend

MARGIN = 1e-3
"""By how much a singularity margin may be missed between the instants at which a planner evaluates it, 1 ms apart; and
by how much a least margin that is stated may be off, either way."""
SIGN = 1e-9
"""By how much a number may have the other sign in a working mode: rounding, where a position is singular."""
ANY = 1e3
"""In place of a bound that does not bind."""
ORIGIN = (0.0, 0.0, 0.0)


class Postures:
    """The numbers of an arm from which margins and working modes follow, and the mode that a scene requires."""

    def __init__(self, scene: Scene) -> None:
        self._scene, chain, asked = scene, scene.robot.chain, scene.options.elbow
        self._bends, self._signs, self._couplers = chain.bends, chain.signs, list[tuple[Bend, int]]()
        if chain.loop is not None:
            first, second = [k for k, link in enumerate(chain.links) if link.coupler >= 0][:2]
            self._couplers.append((Bend(second, first, LEFT), int(chain.loop.side)))
        self._mode = None if asked == "auto" else scene.robot.modes.index(asked) if asked != "keep" else -1
        if asked == "keep":
            self._mode = int(scene.robot.mode_of(scene.start.q))

    def of_plan(self, plan: Plan) -> Rows:
        """What a request asks: the working mode of control points that are met, and the margin where the tool is guided
        or matches a velocity."""
        found, least, kept = Rows(), self._scene.options.singularity_margin - MARGIN, set[int]()
        if least > 0.0:
            for arrival, t0, t1 in guided(self._scene, plan):
                mode = self._mode
                if mode is None:
                    mode = int(self._scene.robot.mode_of(plan.trajectory.evaluate(arrival.time)))
                for bend, sign in self._signed(mode):
                    found.append((arrival.control_point, _beyond(bend, t0, t1, sign, least)))
                kept.add(arrival.step)
        if self._mode is not None:
            for arrival in plan.arrivals:
                # rows of a margin have the signs of the mode, too
                if arrival.missed_by is None and arrival.step not in kept:
                    found += self._in_mode(arrival, self._mode)
        return found

    def of_answer(self, plan: Plan, claims: Claims) -> Rows:
        """What an answer states: working modes of arrivals, and the least margins of all of the motion, with an instant
        at which each is reached."""
        found, robot, path = Rows(), self._scene.robot, plan.trajectory
        for arrival, name in zip(plan.arrivals, claims.modes or (), strict=False):
            mode = robot.modes.index(name) if name in robot.modes else None
            # what a request asks has rows already
            if mode is not None and (mode != self._mode or arrival.missed_by is not None):
                found += self._in_mode(arrival, mode)
        if claims.singularity is None and claims.parallel is None:
            return found
        first = int(robot.mode_of(path.q[0]))
        serial = [] if first < 0 else list(zip(self._bends, self._signs[first], strict=True))
        stated = (("singularity", claims.singularity, serial), ("parallel", claims.parallel, self._couplers))
        for (name, said, bends), own in zip(stated, least_margins(robot, path, instants(path)[0]), strict=True):
            if said is None or said[0] is None:
                continue
            least, reached = said[0] - MARGIN, said[0] + MARGIN
            if least > 0.0:
                # a number that is never 0 keeps its sign
                found += [(name, _beyond(bend, path.start, path.end, sign, least)) for bend, sign in bends]
            if own is not None and bends:
                t = own[1]
                nearest = min((bend for bend, _ in bends), key=lambda bend: abs(self._value(bend, plan, t)))
                size = reached * (nearest.length or 1.0)
                found.append((name, _row(nearest, t, t, -size, size)))
        return found

    def _in_mode(self, arrival: Arrival, mode: int) -> Rows:
        """The signs of a working mode when an arrival begins. What never is 0 tells no modes apart."""
        return [
            (arrival.control_point, _beyond(bend, arrival.time, arrival.time, sign, -SIGN))
            for k, (bend, sign) in enumerate(self._signed(mode)[: len(self._bends)])
            if len({signs[k] for signs in self._signs}) > 1
        ]

    def _signed(self, mode: int) -> list[tuple[Bend, int]]:
        """All numbers with their signs in a working mode (-1: none, and no rows)."""
        own = [] if mode < 0 else list(zip(self._bends, self._signs[mode], strict=True))
        return own + self._couplers

    def _value(self, bend: Bend, plan: Plan, t: float) -> float:
        p, r = self._scene.robot.placements(plan.trajectory.evaluate(np.array([t])))
        along: FloatArray = r[0, bend.other] @ np.array(bend.along)
        if bend.length > 0.0:
            return float((p[0, bend.link] - p[0, bend.other]) @ along) / bend.length
        return float(r[0, bend.link] @ np.array(AHEAD) @ along)


def guided(scene: Scene, plan: Plan) -> Iterator[tuple[Arrival, float, float]]:
    """Where an arm must keep its singularity margin: legs that track a point, straight legs, legs along a path, and the
    instant at which the velocity of a moving point is matched."""
    for arrival in plan.arrivals:
        step = scene.task[arrival.step]
        straight = isinstance(step, Move) and step.leg == "cartesian"
        legs = [leg for leg in plan.legs if leg.step == arrival.step]
        if straight:
            legs = [leg for leg in legs if leg.kind is not LegKind.WAIT and leg.t1 <= arrival.time]
        else:
            legs = [leg for leg in legs if leg.kind in TRACKING]
        yield from ((arrival, leg.t0, leg.t1) for leg in legs)
        matches = isinstance(step, Move) and step.match == "velocity" and not step.via
        if not legs and matches and step.target and not scene.frames[step.target.frame].law.is_fixed:
            yield arrival, arrival.time, arrival.time


def _beyond(bend: Bend, t0: float, t1: float, sign: int, least: float) -> tuple[float, ...]:
    """A number has this sign over [t0, t1], and no smaller size than `least`."""
    size = least * (bend.length or 1.0)
    return _row(bend, t0, t1, *((size, ANY) if sign > 0 else (-ANY, -size)))


def _row(bend: Bend, t0: float, t1: float, low: float, high: float) -> tuple[float, ...]:
    on = ORIGIN if bend.length > 0.0 else AHEAD
    return (t0, t1, bend.link, float(bend.length > 0.0), *on, bend.other, *bend.along, low, high)
