"""The proved partial plans of a search, by how many steps they have, and which of them are continued next."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from assur.planner.collision.proof import Prover
from assur.planner.collision.rows import ProofFailure
from assur.planner.model.scene import Scene
from assur.planner.search.partial_plan import PartialPlan
from assur.planner.search.tuning import BEAM, KEPT_PLANS
from assur.planner.search.waiting import departures, waits


class Pool:
    """`plans`: by their steps, in the order of their ends. `leaving`: by step, the parts in its way that will be
    gone."""

    def __init__(self, scene: Scene, prover: Prover) -> None:
        self.scene, self.prover = scene, prover
        self.plans: list[list[PartialPlan]] = [[] for _ in range(len(scene.task) + 1)]
        self.leaving: list[set[str]] = [set() for _ in scene.task]

    def add(self, partial: PartialPlan) -> None:
        """Adds a partial plan, and those in which the arm waits behind it for a part to be gone, as far as they are
        proved. The earliest are kept."""
        plans = self.plans[partial.step]
        plans.append(partial)
        if self.scene.clears:
            plans += self._waited(partial)
        plans.sort(key=lambda each: each.state.time)
        for waited in (False, True) if len(plans) > KEPT_PLANS else ():
            for late in [each for each in plans if each.waited is waited][KEPT_PLANS:]:
                plans.remove(late)

    def _waited(self, partial: PartialPlan) -> Iterator[PartialPlan]:
        for after, motion, phases in waits(self.scene, partial):
            rows = [self.prover.prove(phase, motion) for phase in phases]
            proofs = tuple(each for each in rows if not isinstance(each, ProofFailure))
            if len(proofs) == len(phases):
                yield replace(after, proofs=partial.proofs + proofs)

    def note(self, before: PartialPlan, bodies: set[str]) -> None:
        """Remembers which of the bodies in the way of a motion from a partial plan will be gone."""
        self.leaving[before.step] |= bodies & departures(self.scene, before).keys()

    def continued(self, length: int, width: int) -> Iterator[PartialPlan]:
        """The partial plans of this length to be continued, and behind them the first that has waited until what is in
        the way is gone."""
        beam = self._beam(length, width)
        yield from beam
        parts = self.leaving[length]
        for partial in self.plans[length] if parts else ():
            if partial not in beam and all(partial.attached.has_gone(self.scene, part) for part in parts):
                yield partial
                return

    def _beam(self, length: int, width: int) -> list[PartialPlan]:
        """The earliest, and the earliest of each other mode, and of those that were to stop, or have waited."""
        every = self.plans[length]
        of_kind: dict[tuple[int, bool, bool], PartialPlan] = {}
        for partial in every:
            of_kind.setdefault((partial.mode, partial.stops, partial.waited), partial)
        first = list(of_kind.values())
        return (first + [partial for partial in every if partial not in first])[: min(width, BEAM)]
