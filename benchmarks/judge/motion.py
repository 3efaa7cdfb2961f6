"""A plan as it is planned: where every body is in each phase, and which pairs of bodies count."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from benchmarks.judge.cell import Cell
from benchmarks.judge.poses import Document, Floats, Poses
from benchmarks.judge.spline import Spline
from benchmarks.judge.stages import Pair, Stage, gone, stages


@dataclass(frozen=True, eq=False)
class Phase:
    """A leg or the standstill behind the last one. `kind`: of the leg, `REST` for the standstill; `carried`: link and
    place of each body on the robot; `seated`: frame and place of each other body; `leg`: of the answer, or None."""

    stage: Stage
    kind: str
    leg: Document | None
    pairs: tuple[Pair, ...]
    carried: dict[str, tuple[str, Poses]]
    seated: dict[str, tuple[str, Poses]]

    def put_down(self, pair: Pair) -> bool:
        """Whether the robot bears neither body of a pair: one of them is a part that was put down."""
        return pair.first in self.seated and pair.second in self.seated


class Motion:
    """A planned answer to a request in SI, as it is planned."""

    def __init__(self, request: Document, answer: Document) -> None:
        self.request, self.answer = request, answer
        self.cell = Cell.of(request)
        self.arm = self.cell.arm
        self.spline = Spline.of(answer["trajectory"])
        self.shapes = self.cell.shapes
        self._extremes: dict[int, tuple[Floats, Floats]] = {}
        self.phases = tuple(self._phases())

    @property
    def start_s(self) -> float:
        return float(self.spline.time[0])

    @property
    def end_s(self) -> float:
        return float(self.spline.time[-1])

    def extremes(self, derivative: int) -> tuple[Floats, Floats]:
        """Least and greatest value (n,) of a derivative of the joints, between knots, too."""
        if derivative not in self._extremes:
            self._extremes[derivative] = self.spline.extremes(derivative)
        return self._extremes[derivative]

    def joints(self, t: Floats) -> Floats:
        """(N, n) at times (N,); before and after the trajectory the arm is at rest."""
        return self.spline.evaluate(np.clip(t, self.start_s, self.end_s))

    def links(self, t: Floats) -> dict[str, Poses]:
        return self.arm.links(self.joints(t))

    def tool(self, t: Floats) -> Poses:
        """The tool point in the world at times (N,)."""
        return self.arm.tool(self.joints(t))

    def frame(self, name: str, t: Floats) -> Poses:
        return self.cell.frames[name].at(t)

    def bodies(self, phase: Phase, t: Floats, names: set[str]) -> dict[str, Poses]:
        """Where these bodies are at times (N,) of a phase."""
        links, frames, found = self.links(t), dict[str, Poses](), dict[str, Poses]()
        for name in sorted(names):
            if name in phase.carried:
                link, place = phase.carried[name]
                found[name] = links[link].then(place)
            else:
                frame, place = phase.seated[name]
                if frame not in frames:
                    frames[frame] = self.frame(frame, t)
                found[name] = frames[frame].then(place)
        return found

    def _phases(self) -> Iterator[Phase]:
        own, seated = {b.name: (b.link, b.pose) for b in self.arm.bodies}, dict(self.cell.seats)
        held = {} if self.cell.held is None else {self.cell.held[0]: ("flange", self.cell.held[1])}
        legs: list[Document | None] = [*self.answer["legs"], None]
        last: Stage | None = None
        for stage, leg in zip(stages(self.cell, self.answer, self.spline), legs, strict=False):
            seated = {name: there for name, there in seated.items() if name not in stage.gone}
            part = next(iter(held), None)
            pairs = self.cell.pairs(stage, part, {name: frame for name, (frame, _) in seated.items()})
            yield Phase(stage, "REST" if leg is None else leg["kind"], leg, tuple(pairs), {**own, **held}, dict(seated))
            last = stage
            if stage.handed_over is None:
                continue
            ((kind, given),) = self.request["task"][stage.handed_over].items()
            arrival = next(each for each in self.answer["arrivals"] if each["step"] == stage.handed_over)
            if kind == "pick":
                held = {given["part"]: ("flange", self.cell.grasped(given, arrival))}
                seated.pop(given["part"])
            else:
                t, (name, _) = np.array([arrival["until_s"]]), self.cell.seat(given["to"])
                part_in_world = self.links(t)["flange"].then(held[given["part"]][1])
                seated[given["part"]] = name, self.frame(name, t).inverse().then(part_in_world)[0]
                held = {}
        late = float(self.request.get("execution", {}).get("start_tolerance_s", 0.0))
        if last is not None and last.placed and late > 0.0:
            # parts that were put down are kept clear for as long as the robot may be late
            away = gone(self.request, self.answer, len(self.request["task"]), last.t1)
            there = {part: supports for part, supports in last.placed.items() if part not in away}
            seated = {name: seat for name, seat in seated.items() if name not in away}
            stage = Stage(last.t1, last.t1 + late, False, placed=there, gone=away)
            pairs = self.cell.pairs(stage, None, {name: frame for name, (frame, _) in seated.items()})
            kept = tuple(pair for pair in pairs if pair.first in there)
            yield Phase(stage, "REST", None, kept, own, dict(seated))
