"""A glance at many ways at once: rough motions, looked at at a few times each, tell which are worth timing.

Nothing is accepted or refused by it. It orders the ways; those that are tried are timed by Ruckig and screened.
"""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.collision.proof import Prover
from assur.planner.model.outcome import LegKind
from assur.planner.model.phases import Phase
from assur.planner.search.meeting_options import Option
from assur.planner.search.partial_plan import Chain
from assur.planner.search.rough_motion import Rough, RoughMotions
from assur.planner.search.via_batch import Prospects

LOOKS = 24
"""Times at which a way is looked at."""
COARSE = 3
"""Every third of them comes first ..."""
CLOSER = 3
"""... and only the best third of the ways is looked at at the others."""
REMEMBERED = 6
"""Times at which ways that had seemed free were found not to be; they are looked at as well ..."""
APART_S = 0.01
"""... if they are this far apart, s."""
DEPTH_M = 0.05
"""What is deeper than this in something counts as so deep, m: how deep a large body is entered says little."""


class Glance:
    """Looks at the ways from one chain to its options."""

    def __init__(self, prover: Prover, chain: Chain, options: tuple[Option, ...]) -> None:
        self.prover, self.chain = prover, chain
        self.rough = RoughMotions(prover.scene.robot, chain, options)
        self.pairs = len(prover.pairs(prover.arrangement(chain.carried, chain.moved), self._way(chain.state.time)))
        """How many pairs of bodies must be kept apart on the way."""
        self.times: list[float] = []
        """When ways that had seemed free were in the way of something, s."""
        latest = prover.scene.options.latest_end_s
        self.latest = np.inf if latest is None else latest

    def remember(self, time: float) -> None:
        """Look at this time, s, too: something was in the way of a way then that had seemed free."""
        if all(abs(time - other) > APART_S for other in self.times):
            self.times = [*self.times, time][-REMEMBERED:]

    @np.errstate(invalid="ignore")  # where a law is not known, or a meeting is missed, there is NaN
    def __call__(self, ways: Prospects, rng: np.random.Generator) -> tuple[FloatArray, FloatArray]:
        """For each way (N,) how much it is in the way of something, 0: free as far as was looked; and its end, s.

        All ways are looked at a few times, and the better ones more closely; 1: it cannot be.
        """
        rough, start = self.rough(ways), self.chain.state.time
        end = rough.end
        bad = np.where(rough.possible(self.prover.scene.robot) & (end <= self.latest), 0.0, 1.0)
        # each way at other times: what passes between the looks at one is seen at its likes
        share = (np.arange(LOOKS) + rng.random((len(ways), 1))) / LOOKS
        times = start + (end - start)[:, None] * share
        coarse = np.arange(LOOKS) % COARSE == 0
        known = np.broadcast_to(np.array(self.times), (len(ways), len(self.times)))
        first = np.concatenate([times[:, coarse], np.where(known < end[:, None], known, start)], -1)
        possible = np.flatnonzero(bad == 0)
        bad[possible] = self._depth(rough, possible, first[possible]) / LOOKS
        order = possible[np.lexsort((end[possible], bad[possible]))]
        closer, rest = np.split(order, [max(1, len(ways) // CLOSER)])
        bad[closer] += self._depth(rough, closer, times[closer][:, ~coarse]) / LOOKS
        bad[rest] += 0.5 / LOOKS  # not known to be free
        return np.minimum(bad, 1.0), end

    def _depth(self, rough: Rough, ways: IntArray, t: FloatArray) -> FloatArray:
        """How deep (W,) some of the ways are in something at times t (W, L), in `DEPTH_M`, 1 at most for each time."""
        if not t.size:
            return np.zeros(len(ways))
        robot = self.prover.scene.robot
        q, times = rough.some(ways).at(t).reshape(-1, len(robot.joints)), t.reshape(-1)
        depth = np.ones(len(times))
        possible = np.flatnonzero(robot.within(q) & robot.assembled(q, q))
        depth[possible] = self.prover.depth(self._way(float(t.max())), q[possible], times[possible], DEPTH_M)
        return np.asarray(depth.reshape(t.shape).sum(-1))

    def _way(self, until: float) -> Phase:
        """A way to the next control point that ends at `until`, s."""
        chain = self.chain
        return Phase(
            chain.state.time, until, LegKind.MOVE, chain.step, chain.carried, chain.moved, frozenset(), None, ()
        )
