"""Is each leg a phase of the claim, with the bodies where they are, and no contact that is not allowed?

A phase may state more than is required: fewer contacts, more uncertainty, the distance of travel in place of `near`.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.statement.differences import SAME
from assur.planner.checker.statement.holding import Stage, displaced
from assur.planner.checker.statement.statement import Statement, at_most, same
from assur.planner.checker.verdict import Code
from assur.planner.claim import columns as c
from assur.planner.model.claims import Claims
from assur.planner.model.outcome import Contact, LegKind, Nearest
from assur.planner.model.scene import Pick, Place


def require_phases(statement: Statement) -> None:
    """The phases are the stages of the plan; first their number and times, without which nothing else is compared."""
    stages, phases, claim = statement.stages, statement.claim.phases.tolist(), statement.claim
    if [row[: c.PHASE_NEAR] for row in phases] != [list(stage.when) for stage in stages]:
        statement.require(False, Code.PHASE, "the phases are not the legs of the plan and what comes behind them")
        return
    names = list(statement.bodies)
    _require_seats(statement, names)
    _require_contacts(statement, names)
    for stage, (_, _, near, robot), shares in zip(stages, phases, claim.shares.tolist(), strict=True):
        statement.require_all(
            Code.DISTANCE,
            stage.when,
            (near == 0.0 or (near == 1.0 and stage.near), "the smaller distance, near a control point, is stated"),
            (robot == 1.0 or not stage.robot, "the robot need not keep clear in the claim"),
        )
        # the tool may have any share in the error of a frame that belt correction may give it
        for number, frame in enumerate(statement.frames):
            least, most = stage.shares.get(frame, (0.0, 0.0))
            if not (shares[number] <= least and shares[len(statement.frames) + number] >= most):
                what = f"the tool may have another share in the error of {frame}"
                statement.require(False, Code.UNCERTAINTY, what, stage.when)


def _require_seats(statement: Statement, names: list[str]) -> None:
    """Each body is fixed to its link or frame, at its pose, and as much of it is uncertain as is required."""
    seats, off = _required_seats(statement)
    stages, stated = statement.stages, statement.seats
    if (stated == seats).all() and (statement.claim.off >= off).all():
        return
    apart, known = np.abs(stated - seats), statement.claim.off >= off - SAME
    apart[:, :, -1] = np.abs(np.remainder(apart[:, :, -1] + math.pi, math.tau) - math.pi)
    same_seats = (apart <= SAME).all(2)
    for phase, body in np.argwhere(~same_seats).tolist():
        what = f"{names[body]} is fixed to something else, or at another pose"
        statement.require(False, Code.SEAT, what, stages[phase].when)
    for phase, column in np.argwhere(~known).tolist():
        what = f"{names[column % len(names)]} may be farther off than the claim states"
        statement.require(False, Code.UNCERTAINTY, what, stages[phase].when)


def _required_seats(statement: Statement) -> tuple[FloatArray, FloatArray]:
    """The seat of each body in each stage, (P, B, 7), and by how much each may be off it: (P, 2 B), horizontally, and
    then up or down, m. One row for all stages if no part is handled."""
    scene, stages, flange, holding = statement.scene, statement.stages, statement.flange, statement.scene.start.holding
    parts = {step.part for step in scene.task if step.part is not None}
    parts |= set() if holding is None else {holding.part}
    if not parts:
        return statement.given.seats
    # parts that are handled have others, phase by phase
    all_seats, all_off = (each.repeat(len(stages), 0) for each in statement.given.seats)
    for part in parts:
        k, body = statement.bodies[part], scene.index[part].body
        for p, stage in enumerate(stages):
            frame, at = statement.place(part, stage.handed, stage.gone)
            all_seats[p, k] = (k, flange, -1.0, *at) if frame is None else (k, -1.0, statement.frames[frame], *at)
            all_off[p, k :: len(statement.bodies)] = displaced(
                statement.uncertainty(part, stage.handed, stage.gone), body
            )
    return all_seats, all_off


def _require_contacts(statement: Statement, names: list[str]) -> None:
    """No pair may touch, or overlap by more, than is allowed; and parts that were put down are kept clear."""
    stages, claim = statement.stages, statement.claim
    for phase, one, other, depth in claim.contacts.tolist():
        stage, pair = stages[int(phase)], (names[int(one)], names[int(other)])
        may, words = frozenset(pair) in stage.touching, " and ".join(pair)
        statement.require(may, Code.CONTACT, f"{words} may not touch", stage.when)
        deep = not may or depth <= stage.depth + SAME
        statement.require(deep, Code.CONTACT, f"{words} may not overlap by {depth:g} m", stage.when)
    stated: list[dict[str, set[str]]] = [{} for _ in stages]
    for (phase, body), row in zip(claim.put_down.tolist(), claim.supports, strict=True):
        kept = stated[int(phase)].setdefault(names[int(body)], set())
        kept.update(names[k] for k in np.flatnonzero(row))
    for stage, own in zip(stages, stated, strict=True):
        for part in stage.supports:
            statement.require(part in own, Code.CONTACT, f"{part} was put down, and is not kept clear", stage.when)
        for part, supports in own.items():
            for other in supports - stage.supports.get(part, set()):
                statement.require(False, Code.CONTACT, f"{part} does not rest on {other}", stage.when)


# Does the claim state how near bodies come: smallest clearances from both sides, others from above?

WITHIN_M = 5e-5
"""By how much a clearance, and how far a part is from tool or support, may be off, m: what a planner promises."""
FLANGE = "flange"


def require_touching(statement: Statement) -> None:
    """Where a step limits how far its part may be from tool or support, it is no farther."""
    for number, step in enumerate(statement.scene.task):
        allowed, beside = math.inf, "what it may rest on"
        if isinstance(step, Pick):
            allowed, beside = step.grip_within_m, "the tool"
        elif isinstance(step, Place):
            allowed = step.support_within_m
        near = allowed == math.inf or _is_handed(statement, number, allowed + WITHIN_M)
        what = f"the part of {step.name} may be farther from {beside} than is allowed"
        statement.require(near, Code.NEAREST, what)


def require_nearness(statement: Statement, claims: Claims) -> None:
    """Grips, supports, smallest clearances and pairs are as the answer states them."""
    for arrival in statement.plan.arrivals:
        for kind, stated in ((Pick, arrival.grip_m), (Place, arrival.support_m)):
            is_one = isinstance(statement.scene.task[arrival.step], kind)
            near = stated is None or (is_one and _is_handed(statement, arrival.step, stated + WITHIN_M))
            what = f"the part of {arrival.control_point} is not stated to be as near as the answer states"
            statement.require(near, Code.NEAREST, what, (arrival.until, arrival.until))
    named = [(each, False) for each in claims.pairs]
    for placed, column, claimed in (
        (False, c.REQUIRED_NEAREST, claims.nearest),
        (True, c.REQUIRED_PLACED, claims.placed),
    ):
        for nearest in claimed or ():
            least = c.LIMITLESS if nearest is None else nearest.gap_m - WITHIN_M
            kept = least <= 0.0 or statement.claim.required[0, column] >= least
            what = "pairs may come nearer than the smallest clearance that is stated"
            statement.require(kept, Code.NEAREST, what)
            named += [] if nearest is None else [(nearest, placed)]
    for each, placed in named:
        what = f"{' and '.join(each.bodies)} are not stated to be as near in {each.phase} as the answer states"
        near = _is_named(statement, each, is_placed=placed)
        statement.require(near, Code.NEAREST, what, (each.time, each.time))


def require_stated_contacts(statement: Statement, stated: tuple[Contact, ...]) -> None:
    """The contacts that are stated are those that the legs allow, each for as long as it lasts."""
    spans = dict[tuple[str, ...], list[list[float]]]()
    for stage in statement.stages:
        for bodies in stage.touching:
            own = spans.setdefault(tuple(sorted(bodies)), [])
            if own and stage.when[0] - own[-1][1] <= SAME:
                own[-1][1] = stage.when[1]
            else:
                own.append(list(stage.when))
    allowed = sorted((bodies, t0, t1) for bodies, own in spans.items() for t0, t1 in own)
    listed = sorted((tuple(sorted(each.bodies)), each.t0, each.t1) for each in stated)
    pairs = zip(allowed, listed, strict=False)
    same_contacts = len(allowed) == len(listed) and all(
        bodies == names and abs(t0 - first) <= SAME and abs(t1 - last) <= SAME
        for (bodies, t0, t1), (names, first, last) in pairs
    )
    what = "the contacts that are stated are not those that the legs allow"
    statement.require(same_contacts, Code.CONTACT, what)


def _is_handed(statement: Statement, number: int, most: float) -> bool:
    """Whether the part of a step is stated to be so near to the tool, or to what it may rest on, when it changes
    hands."""
    step, until = statement.scene.task[number], statement.arrivals[number].until
    others = {body.name for body in statement.scene.tool.bodies}
    if not isinstance(step, Pick):
        others = statement.supports(number)
    return step.part is not None and any(
        _is_near(statement, phase, until, (other, step.part), most)
        for phase, leg in enumerate(statement.plan.legs)
        if leg.step == number and leg.kind is LegKind.FOLLOW
        for other in others
    )


def _is_named(statement: Statement, each: Nearest, *, is_placed: bool) -> bool:
    """Whether two bodies that must keep apart are stated to be so near at a time in a phase of a kind."""
    kinds = [str(leg.kind) for leg in statement.plan.legs]
    return any(
        each.phase == (kinds[phase] if phase < len(kinds) else LegKind.WAIT)
        and stage.when[0] - SAME <= each.time <= stage.when[1] + SAME
        and _must_keep_apart(statement, stage, each.bodies, is_placed=is_placed)
        and _is_near(statement, phase, each.time, each.bodies, each.gap_m + WITHIN_M)
        for phase, stage in enumerate(statement.stages)
    )


def _must_keep_apart(statement: Statement, stage: Stage, names: tuple[str, str], *, is_placed: bool) -> bool:
    """Whether two bodies are a pair with one of the robot's, or one with a part that was put down."""
    links = _links(statement, stage)
    if not all(name in links for name in names) or frozenset(names) in stage.touching:
        return False
    one, other = (links[name] for name in names)
    if one is None and other is None:
        own = [(part, kept) for part, kept in stage.supports.items() if part in names]
        return is_placed and any(not set(names) - {part} & kept for part, kept in own)
    apart = None in (one, other) or any({one, other} == set(pair) for pair in statement.scene.robot.self_pairs)
    return stage.robot and not is_placed and apart


def _links(statement: Statement, stage: Stage) -> dict[str, str | None]:
    """By its name, the link that carries a body; None: it is on a frame."""
    scene = statement.scene
    links: dict[str, str | None] = {item.body.name: scene.robot.links[item.link] for item in scene.robot.bodies}
    links |= {body.name: FLANGE for body in scene.tool.bodies}
    return links | {body.name: FLANGE if stage.held == body.name else None for body in scene.bodies}


def _is_near(statement: Statement, phase: int, time: float, names: tuple[str, str], most: float) -> bool:
    """Whether two bodies are stated to be no farther apart than `most`, m, at a time in a phase."""
    numbers = [statement.bodies[name] for name in names]
    return any(
        statement.states(
            "distances",
            same(c.DISTANCE_TIME, time, phase, *pair),
            at_most(c.DISTANCE_MOST, most + SAME),
        )
        for pair in (numbers, numbers[::-1])
    )
