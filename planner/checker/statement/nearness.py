"""Does the claim state how near bodies come: smallest clearances from both sides, others from above?"""

from __future__ import annotations

import math
from collections.abc import Iterator

from assur.planner.checker.statement.differences import SAME, Difference, Topic
from assur.planner.checker.statement.holding import Handling
from assur.planner.checker.statement.phases import Stage
from assur.planner.checker.statement.solids import bodies_of
from assur.planner.claim import columns as c
from assur.planner.model.claims import Claims
from assur.planner.model.outcome import Contact, LegKind, Nearest
from assur.planner.model.scene import Pick, Place

WITHIN_M = 5e-5
"""By how much a clearance, and how far a part is from tool or support, may be off, m: what a planner promises."""
FLANGE = "flange"


class Nearness:
    """What a claim states of distances in the stages of a plan."""

    def __init__(self, handling: Handling, stages: list[Stage], claim: c.Claim) -> None:
        self.handling, self.stages, self.claim = handling, stages, claim
        self.number = {body.name: k for k, body in enumerate(bodies_of(handling.scene))}
        kinds = [str(leg.kind) for leg in handling.plan.legs]
        self.kinds = kinds + [str(LegKind.WAIT)] * (len(stages) - len(kinds))

    def touching_agrees(self) -> Iterator[Difference]:
        """Where a step limits how far its part may be from tool or support, it is no farther."""
        for number, step in enumerate(self.handling.scene.task):
            allowed = step.grip_within_m if isinstance(step, Pick) else math.inf
            allowed = step.support_within_m if isinstance(step, Place) else allowed
            if allowed < math.inf and not self._is_handed(number, allowed + WITHIN_M):
                beside = "the tool" if isinstance(step, Pick) else "what it may rest on"
                yield Difference(
                    Topic.NEARNESS, f"the part of {step.name} may be farther from {beside} than is allowed"
                )

    def stated_agrees(self, claims: Claims) -> Iterator[Difference]:
        """Grips, supports, smallest clearances and pairs are as the answer states them."""
        for arrival in self.handling.plan.arrivals:
            for kind, stated in ((Pick, arrival.grip_m), (Place, arrival.support_m)):
                is_one = isinstance(self.handling.scene.task[arrival.step], kind)
                if stated is not None and not (is_one and self._is_handed(arrival.step, stated + WITHIN_M)):
                    what = f"the part of {arrival.control_point} is not stated to be as near as the answer states"
                    yield Difference(Topic.NEARNESS, what, (arrival.until, arrival.until))
        for is_placed, said in ((False, claims.nearest), (True, claims.placed)):
            if said is None:
                continue
            kept = self.claim.required[0, c.REQUIRED_PLACED if is_placed else c.REQUIRED_NEAREST]
            nearest = said[0]
            least = c.LIMITLESS if nearest is None else nearest.gap_m - WITHIN_M
            if not (least <= 0.0 or kept >= least):
                yield Difference(Topic.NEARNESS, "pairs may come nearer than the smallest clearance that is stated")
            if nearest is not None and not self._is_named(nearest, is_placed=is_placed):
                yield self._not_so_near(nearest)
        for each in claims.pairs:
            if not self._is_named(each, is_placed=False):
                yield self._not_so_near(each)

    def contacts_agree(self, stated: tuple[Contact, ...] | None) -> Iterator[Difference]:
        """The contacts that are stated are those that the legs allow, each for as long as it lasts."""
        if stated is None:
            return
        spans = dict[tuple[str, ...], list[list[float]]]()
        for stage in self.stages:
            for bodies in stage.touching:
                own = spans.setdefault(tuple(sorted(bodies)), [])
                if own and stage.when[0] - own[-1][1] <= SAME:
                    own[-1][1] = stage.when[1]
                else:
                    own.append(list(stage.when))
        true = sorted((bodies, t0, t1) for bodies, own in spans.items() for t0, t1 in own)
        told = sorted((tuple(sorted(each.bodies)), each.t0, each.t1) for each in stated)
        same = [each[0] for each in true] == [each[0] for each in told]
        if not (
            same
            and all(
                abs(x - y) <= SAME for a, b in zip(true, told, strict=True) for x, y in zip(a[1:], b[1:], strict=True)
            )
        ):
            yield Difference(Topic.CONTACT, "the contacts that are stated are not those that the legs allow")

    def _not_so_near(self, each: Nearest) -> Difference:
        what = f"{' and '.join(each.bodies)} are not stated to be as near in {each.phase} as the answer states"
        return Difference(Topic.NEARNESS, what, (each.time, each.time))

    def _is_handed(self, number: int, most: float) -> bool:
        """Whether the part of a step is stated to be so near to the tool, or to what it may rest on, when it changes
        hands."""
        step, until = self.handling.scene.task[number], self.handling.arrivals[number].until
        if isinstance(step, Pick):
            others = {body.name for body in self.handling.scene.tool.bodies}
        else:
            others = self.handling.supports(number)
        pairs = [(other, step.part) for other in others if step.part is not None]
        legs = enumerate(self.handling.plan.legs)
        phases = [p for p, leg in legs if leg.step == number and leg.kind is LegKind.FOLLOW]
        return any(self._is_near(p, until, pair, most) for p in phases for pair in pairs)

    def _is_named(self, each: Nearest, *, is_placed: bool) -> bool:
        """Whether two bodies that must keep apart are stated to be so near at a time in a phase of a kind."""
        return any(
            self.kinds[p] == each.phase
            and stage.when[0] - SAME <= each.time <= stage.when[1] + SAME
            and self._must_keep_apart(stage, each.bodies, is_placed=is_placed)
            and self._is_near(p, each.time, each.bodies, each.gap_m + WITHIN_M)
            for p, stage in enumerate(self.stages)
        )

    def _must_keep_apart(self, stage: Stage, names: tuple[str, str], *, is_placed: bool) -> bool:
        """Whether two bodies are a pair with one of the robot's, or one with a part that was put down."""
        if not all(name in self.number for name in names) or frozenset(names) in stage.touching:
            return False
        links = [self._link(stage, name) for name in names]
        if links == [None, None]:
            own = [(part, kept) for part, kept in stage.supports.items() if part in names]
            return is_placed and any(not set(names) - {part} & kept for part, kept in own)
        pairs = self.handling.scene.robot.self_pairs
        apart = None in links or any(set(links) == set(pair) for pair in pairs)
        return stage.robot and not is_placed and apart

    def _link(self, stage: Stage, name: str) -> str | None:
        """The link that carries a body; None: it is on a frame."""
        scene, at = self.handling.scene, self.number[name]
        if at < len(scene.robot.bodies):
            return scene.robot.links[scene.robot.bodies[at].link]
        is_tool = at < len(scene.robot.bodies) + len(scene.tool.bodies)
        return FLANGE if is_tool or stage.held == name else None

    def _is_near(self, phase: int, time: float, names: tuple[str, str], most: float) -> bool:
        bodies = sorted(self.number[name] for name in names)
        return any(
            row[c.DISTANCE_PHASE] == phase
            and abs(row[c.DISTANCE_TIME] - time) <= SAME
            and sorted(row[c.DISTANCE_BODY : c.DISTANCE_PIECE]) == bodies
            and row[c.DISTANCE_MOST] <= most + SAME
            for row in self.claim.distances.tolist()
        )
