"""Samples ways to the next control point: the direct ones first, then arches, then free vias, waits and later meetings.

Seeded and adaptive: families that produced free or nearly free drafts get more samples, and such drafts are mutated.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from planner.chain import Chain, Sample
from planner.frames import Fixed
from planner.free_vias import free_vias
from planner.legs.arched import Hop
from planner.legs.joint import Shape, Via
from planner.outcome import Reason, Refusal
from planner.scene import Arch, Move, Scene
from planner.ways import Option

SIZES = (8, 12, 12, 16, 24)
"""Samples in the first random batches of a chain: small ones react sooner ..."""
MOST_RANDOM = 32
"""... and large ones are cheaper a sample, which counts where many are needed."""
MUTATED = 0.25
"""Share of random samples that are mutations of the best drafts so far, once there are any."""
ELITE = 6
"""Best drafts that are kept for mutation."""
HOPS = ((0.5, 0.5), (1.0, 1.0))
"""Overlaps of an arch that are tried first: half, none (corners stopped at)."""
FAMILIES = ("arch", "1 via", "2 vias", "wait", "later")


@dataclass(eq=False)
class Sampler:
    """Samples for one chain. What it learned stays with it."""

    scene: Scene
    chain: Chain
    options: tuple[Option, ...]
    rng: np.random.Generator
    adaptive: bool = True
    visits: int = 0
    tried: dict[str, int] = field(default_factory=dict)
    worth: dict[str, float] = field(default_factory=dict)
    elite: list[tuple[float, Sample]] = field(default_factory=list)

    def batch(self) -> list[tuple[Option, Sample]]:
        """The next batch; empty only if no control point can be met at all."""
        visit, self.visits = self.visits, self.visits + 1
        if not self.options:
            return []
        if visit == 0:
            return [*self._direct(), *self._arches()]
        if self._cartesian() and not self.chain.state.resting:
            return []  # a straight leg from a moving frame has nothing to choose: it has been tried
        later = visit - 1
        size = SIZES[later] if 0 <= later < len(SIZES) else MOST_RANDOM
        return [self._random() for _ in range(size)]

    def learn(self, sample: Sample, bad: float) -> None:
        """`bad`: the share of a draft's samples that were in the way of something; 0: it was free."""
        if not self.adaptive:
            return
        self.tried[sample.family] = self.tried.get(sample.family, 0) + 1
        self.worth[sample.family] = self.worth.get(sample.family, 0.0) + max(0.0, 1.0 - 2.0 * bad)
        self.elite.append((bad, sample))
        self.elite.sort(key=lambda pair: pair[0])
        del self.elite[ELITE:]

    def _direct(self) -> list[tuple[Option, Sample]]:
        step = self.scene.task[self.chain.step]
        if isinstance(step, Move) and step.arch is not None:
            return []
        paces = (0.7, 0.0) if isinstance(step, Move) and step.via else (0.0,)
        return [
            (option, Sample(option.yaw_offset, option.branch, Shape(through=pace), "direct"))
            for option in self.options[:6]
            for pace in paces
        ]

    def _arches(self) -> list[tuple[Option, Sample]]:
        tops = self._tops()
        if not tops or self._cartesian():
            return []
        through = 0.7 if self._is_via() else 0.0
        hops = HOPS[:1] if self._is_via() else HOPS
        return [
            (option, Sample(option.yaw_offset, option.branch, Shape(hop=Hop(top, rise, fall), through=through), "arch"))
            for option in self.options[:2]
            for top in tops[:1]
            for rise, fall in hops
        ]

    def _tops(self) -> list[float]:
        """Heights of the lift joint that an arch may go over, lowest sensible first."""
        scene, lift = self.scene, self.scene.robot.lift
        if lift is None:
            return []
        step = scene.task[self.chain.step]
        upper = float(scene.robot.limits.upper[lift])
        ends = [float(self.chain.state.q[lift]), *(float(o.branch.q[0, lift]) for o in self.options[:1])]
        asked = -np.inf
        if isinstance(step, Move) and step.arch is not None:
            asked = self._asked(step.arch)
            return [asked] if asked <= upper else []
        return [top for top in (upper, (max(ends) + upper) / 2) if top > max(ends) + 1e-3]

    def too_high(self) -> Refusal | None:
        """Why the arch that is asked for cannot be: the lift ends below it; None: it can, or none is asked."""
        scene, lift, step = self.scene, self.scene.robot.lift, self.scene.task[self.chain.step]
        if lift is None or not isinstance(step, Move) or step.arch is None or self._tops():
            return None
        joint, over = scene.robot.joints[lift].name, self._asked(step.arch) - float(scene.robot.limits.upper[lift])
        detail = f"for an arch up to {1e3 * step.arch.top_m:g} mm"
        return Refusal("inverse", Reason.JOINT_LIMIT, self.chain.step, (joint,), None, over, "m", detail)

    def _asked(self, arch: Arch) -> float:
        """The lift joint's value at the top of an arch."""
        scene, q = self.scene, self.chain.state.q
        flange, _ = scene.robot.forward(q)
        # the lift joint moves the flange one to one, so heights differ by a constant
        return arch.top_m - scene.tool.tcp.z - (float(flange[2]) - float(q[scene.robot.lift or 0]))

    def _is_via(self) -> bool:
        step = self.scene.task[self.chain.step]
        return isinstance(step, Move) and step.via

    def _cartesian(self) -> bool:
        step = self.scene.task[self.chain.step]
        return isinstance(step, Move) and step.leg == "cartesian"

    def _random(self) -> tuple[Option, Sample]:
        rng = self.rng
        if self.adaptive and self.elite and rng.random() < MUTATED:
            return self._mutated()
        count = len(self.options)
        option = self.options[min(count - 1, int(rng.geometric(0.45)) - 1)]
        family = self._family()
        shape = self._shape(family, option)
        effort = float(rng.choice([1.0, 1.0, 0.7, 0.4]))
        sample = Sample(option.yaw_offset, option.branch, shape, family, effort, float(rng.uniform(1.0, 2.0)))
        return option, sample

    def _family(self) -> str:
        choices = [name for name in FAMILIES if self._possible(name)]
        weights = np.array([BASE[name] + 3.0 * self._yield(name) for name in choices])
        return str(self.rng.choice(choices, p=weights / weights.sum()))

    def _yield(self, family: str) -> float:
        return self.worth.get(family, 0.0) / (1.0 + self.tried.get(family, 0))

    def _possible(self, family: str) -> bool:
        if self._cartesian():
            return family == "wait"
        step = self.scene.task[self.chain.step]
        if isinstance(step, Move) and step.arch is not None:
            return family == "arch"
        if family == "arch":
            return bool(self._tops())
        if family == "wait":
            return self.chain.state.resting
        if family == "later":
            return not self.options[0].branch.still
        return True

    def _shape(self, family: str, option: Option) -> Shape:
        rng = self.rng
        through = float(rng.uniform(0.2, 1.0)) if self._is_via() else 0.0
        wait = late = 0.0
        if family == "wait" or (self._moving() and self.chain.state.resting and rng.random() < 0.25):
            wait = float(rng.exponential(0.35))
        if family == "later" or (not option.branch.still and rng.random() < 0.2):
            late = float(rng.exponential(0.25))
        vias: tuple[Via, ...] = ()
        hop = None
        if family == "arch":
            tops = self._tops()
            low, high = (min(tops), max(tops)) if tops else (0.0, 0.0)
            hop = Hop(
                float(rng.uniform(low, high)) if rng.random() < 0.5 else high, float(rng.random()), float(rng.random())
            )
        elif family in ("1 via", "2 vias"):
            vias = self._vias(1 if family == "1 via" else 2, option)
        elif rng.random() < 0.5 and not self._cartesian():
            vias = self._vias(1, option)
        return Shape(wait, late, vias, hop, through=through)

    def _moving(self) -> bool:
        return any(not isinstance(frame.law, Fixed) for frame in self.scene.frames.values())

    def _vias(self, count: int, option: Option) -> tuple[Via, ...]:
        goal = option.branch.q[int(np.argmax(option.branch.legal))]
        return free_vias(self.rng, self.scene.robot, self.chain.state.q, goal, count)

    def _mutated(self) -> tuple[Option, Sample]:
        rng, limits = self.rng, self.scene.robot.limits
        _, parent = self.elite[int(rng.integers(len(self.elite)))]
        option = next(o for o in self.options if o.branch is parent.branch)
        shape = parent.shape
        spread = float(rng.choice([0.03, 0.08])) * (limits.upper - limits.lower)
        spread[3:] = 0.0
        vias = tuple(
            Via(
                np.clip(via.q + rng.normal(0.0, 1.0, len(via.q)) * spread, limits.lower, limits.upper),
                max(0.0, via.pace + float(rng.normal(0.0, 0.2))),
            )
            for via in shape.vias
        )
        hop = shape.hop
        if hop is not None:
            hop = Hop(
                hop.top,
                float(np.clip(hop.rise + rng.normal(0, 0.15), 0, 1)),
                float(np.clip(hop.fall + rng.normal(0, 0.15), 0, 1)),
            )
        wait, late = shape.wait, shape.late
        if self._moving() and self.chain.state.resting and rng.random() < 0.5:
            wait = max(0.0, wait + float(rng.normal(0.0, 0.1)))
        if not option.branch.still and rng.random() < 0.5:
            late = max(0.0, late + float(rng.normal(0.0, 0.1)))
        if not vias and hop is None and rng.random() < 0.6 and not self._cartesian():
            vias = self._vias(1, option)
        return option, replace(parent, shape=replace(shape, vias=vias, hop=hop, wait=wait, late=late))


BASE = {"arch": 0.3, "1 via": 1.6, "2 vias": 1.6, "wait": 0.3, "later": 0.5}
"""Weights of the families before anything is known."""
