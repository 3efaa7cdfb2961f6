"""Whether the tool rises as high as an arch asks."""

from __future__ import annotations

import numpy as np

from assur.planner.checker.meeting import MEET_M
from assur.planner.checker.spline import Spline
from assur.planner.checker.verdict import Code, Finding
from assur.planner.model.outcome import Leg, LegKind
from assur.planner.model.scene import Move, Scene

INSTANTS = 256
"""Times at which the height is looked at, each round between the neighbours of the highest."""
ROUNDS = 4
"""Rounds; the last looks every 0.01 µs of a leg of 1 s."""


def arches(scene: Scene, line: Spline, legs: tuple[Leg, ...]) -> list[Finding]:
    """Whether the tool point rises as high as an arch asks: a value that is taken proves it."""
    findings = []
    for number, step in enumerate(scene.task):
        spans = [leg for leg in legs if leg.step == number and leg.kind is LegKind.ARCH]
        if not isinstance(step, Move) or step.arch is None or not spans:
            continue
        low, high = spans[0].t0, spans[-1].t1
        for _ in range(ROUNDS):
            t = np.linspace(low, high, INSTANTS + 1)
            z = scene.robot.forward(line.state(t)[0])[0][:, 2] + scene.tool.tcp.z
            top = int(np.argmax(z))
            low, high = float(t[max(0, top - 1)]), float(t[min(INSTANTS, top + 1)])
        missing = step.arch.top_m - float(z[top])
        if not missing <= MEET_M:
            findings.append(Finding(Code.ARCH, f"the arch to {step.name} is too low", missing, "m", f"{t[top]:.6g} s"))
    return findings
