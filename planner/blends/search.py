"""The beam for parabolic blends: its continuations are whole runs of steps, from rest through vias to rest.

How a via is blended past depends on the pose behind it, so nothing is proved of a run before all of it is timed.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import product

from assur.planner.blends.candidates import BlendSampler
from assur.planner.blends.extension import blend_extension, run_of
from assur.planner.blends.timed import BlendShape, Station
from assur.planner.collision.proof import Prover
from assur.planner.legs.control_point import control_point
from assur.planner.legs.meeting import meetings
from assur.planner.legs.tilt import tilts
from assur.planner.model.deadline import look
from assur.planner.model.phases import yaw_offsets
from assur.planner.model.progress import Watch
from assur.planner.model.refusal import OF_CANDIDATES, AccelerationTime, Reason, Refusal
from assur.planner.model.scene import Scene
from assur.planner.search.beam import Found, Search
from assur.planner.search.meeting_options import free_yaws
from assur.planner.search.partial_plan import Extension, PartialPlan, TimedCandidate
from assur.planner.search.rough_score import score_of


class BlendSearch(Search):
    """One run over one scene with `timing: parabolic_blend`."""

    def __init__(
        self, scene: Scene, prover: Prover, started: float, *, adaptive: bool = True, watch: Watch | None = None
    ) -> None:
        super().__init__(scene, prover, started, adaptive=adaptive, watch=watch)
        self.known: dict[PartialPlan, BlendSampler] = {}

    def run(self) -> Found:
        """As `Search.run`; what was not passed is the step of the run at which most was refused."""
        found = super().run()
        if found.plan is None:
            counts = dict.fromkeys(run_of(self.scene, min(found.deepest, len(self.scene.task) - 1)), 0)
            for line in found.census.census().lines:
                if line.refusal.step in counts and line.refusal.stage in OF_CANDIDATES:
                    counts[line.refusal.step] += line.count
            worst = max(counts, key=lambda step: counts[step])
            if counts[worst] > 0:
                found.deepest = worst
        return found

    def _explore(self, partial: PartialPlan) -> bool:
        if partial not in self.known:
            self.known[partial] = self._blend_sampler(partial)
        sampler = self.known[partial]
        batch = sampler.batch()
        batch = batch[: int(min(len(batch), self._left()))]
        made_: list[TimedCandidate | Extension] = []
        shapes: list[BlendShape] = []
        short: list[tuple[Refusal, AccelerationTime]] = []
        hopeless, timed = self.scene.options.acceleration_time_s is not None, False
        for shape in batch:
            if self._late():
                break
            self.found.census.candidates += 1
            made = blend_extension(self.scene, partial, shape)
            if isinstance(made, Refusal) and isinstance(made.facts, AccelerationTime):
                short.append((made, made.facts))
                continue
            if isinstance(made, Refusal):
                self.found.census.add(made)
                hopeless &= made.reason is Reason.MOTION_LIMIT
                if made.reason is Reason.NEAR_PARALLEL_SINGULARITY:
                    sampler.block(shape)  # it was timed; another way may stay clear of type 2
                continue
            timed = True
            if made.end < self._before():
                made_.append(made)
                shapes.append(shape)
        untimed = sampler.visits == 1 and not timed
        # the least time that does for any of the direct ways, so that it is the least there is
        does = [facts.enough_s for _, facts in short if untimed and facts.enough_s is not None]
        for refusal, facts in short:
            self.found.census.add(replace(refusal, facts=replace(facts, enough_s=min(does, default=None))))
        enough = self._enough()
        for draft, shape in sorted(zip(made_, shapes, strict=True), key=lambda pair: pair[0].end):
            if enough <= 0 or self._late():
                break
            screened, proved = self._tried(draft)
            sampler.learn(shape, score_of(screened.refusal))
            if proved is False:
                sampler.block(shape)
            enough -= proved is True
        nothing_else = hopeless or not (sampler.blocked or sampler.moving())
        if untimed and nothing_else:
            # no direct way keeps the acceleration time, or comes in time: free poses are there to go round bodies
            sampler.ways = ()
        return bool(batch)

    def _blend_sampler(self, partial: PartialPlan) -> BlendSampler:
        """The stations that each step of the run may be, in every turn, mode and yaw that is asked for."""
        choices = []
        for step in run_of(self.scene, partial.step):
            stations = []
            turns = yaw_offsets(self.scene, self.scene.task[step])
            attitudes = tilts(self.scene, self.scene.task[step], partial.state.q)
            yaws = free_yaws(self.scene, partial, step, self._modes(partial)) if turns is None else turns
            for turn, tilt in product(yaws, attitudes):
                look()
                point = control_point(self.scene, step, partial.attached, turn, tilt)
                found = meetings(self.scene, point, partial.state.time, 0.0, self._modes(partial), partial.state.q)
                for refusal in found.refusals:
                    self.found.census.note(refusal)
                stations += [Station(point, branch) for branch in found.branches]
            if not stations:
                self.found.deepest = max(self.found.deepest, step)
                return BlendSampler(self.scene, partial, (), self.rng, self.adaptive)
            choices.append(tuple(stations))
        return BlendSampler(self.scene, partial, tuple(choices), self.rng, self.adaptive)


def searcher(
    scene: Scene, prover: Prover, started: float, *, adaptive: bool = True, watch: Watch | None = None
) -> Search:
    """The search that the scene's timing asks for. `watch` is told how far it has come."""
    kind = BlendSearch if scene.options.blended else Search
    return kind(scene, prover, started, adaptive=adaptive, watch=watch)
