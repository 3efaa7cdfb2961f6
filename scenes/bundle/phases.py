"""What is required in each phase, and what is not known: of frames, bodies, joints and the start."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from assur.planner.laws.law import EXACT, Frame
from assur.planner.model.phases import CONTACT_M, Phase
from assur.planner.model.scene import Scene
from assur.scenes.bundle.arms import link_number
from assur.scenes.bundle.solids import bodies_in

Document = dict[str, Any]


def phases_of(scene: Scene, phases: Sequence[Phase], seats: list[list[int]]) -> list[Document]:
    """Phases with the seats of all bodies, the contacts that are allowed, and parts that were put down."""
    bodies = bodies_in(scene)
    number = {body.name: k for k, body in enumerate(bodies)}
    own = {item.name: item.uncertainty for item in scene.bodies}
    found = []
    for phase, row in zip(phases, seats, strict=True):
        held = None if phase.attached.held is None else phase.attached.held.part
        known = dict(phase.handled.within)
        unknown = []
        for body in bodies:
            within = known.get(body.name) or own.get(body.name, EXACT)
            unknown.append([within.position_m + within.yaw_rad * body.radius, within.vertical_m])
        contacts = [
            tuple(sorted(number[name] for name in pair)) for pair in sorted(phase.contacts) if set(pair) <= set(number)
        ]
        put_down = []
        for name, _ in phase.handled.within:
            if name != held:
                supports = sorted(
                    number[x] for pair in phase.handled.supports if name in pair for x in pair if x != name
                )
                put_down.append({"body": number[name], "supports": supports})
        found.append(
            {
                "t0": phase.t0,
                "t1": phase.t1,
                "kind": str(phase.kind),
                "near": phase.near,
                "robot": phase.robot,
                "seats": row,
                "unknown": unknown,
                "shares": _shares(scene, phase),
                "contacts": [
                    {"bodies": list(pair), "depth": CONTACT_M + phase.contact_tolerance_m} for pair in contacts
                ],
                "put_down": put_down,
            }
        )
    return found


def _shares(scene: Scene, phase: Phase) -> list[list[float]]:
    """What share of each frame's error along its line the tool has, at least and at most, by belt correction."""
    followed = phase.corrected if phase.tracked is None else (phase.tracked,)
    found = []
    for name in scene.frames:
        whole = phase.tracked is not None and scene.corrects_all(name)
        some = name in followed and scene.corrects(name)
        found.append([1.0 if some and whole else 0.0, 1.0 if some else 0.0])
    return found


def frame_of(frame: Frame) -> Document:
    """What is not known of a frame."""
    known, line = frame.uncertainty, None if frame.law.line is None else frame.law.line.tolist()
    across = None if line is None or math.hypot(line[0], line[1]) == 0.0 else [-line[1], line[0], 0.0]
    if across is not None:
        level = math.hypot(*across)
        across = [x / level for x in across]
    terms = [
        (line, known.position_m, known.speed_m_s, True),
        (across, known.lateral_m, 0.0, False),
        ([0.0, 0.0, 1.0], known.vertical_m, 0.0, False),
    ]
    unknown = [
        {"direction": list(way or ()), "amount": amount, "growth": growth, "shared": shared}
        for way, amount, growth, shared in terms
        if amount != 0.0 or growth != 0.0
    ]
    return {"shift": list(known.shift_s), "yaw": known.yaw_rad, "unknown": unknown}


def required_of(scene: Scene, until: float) -> Document:
    """Distances, pairs of links, lag and lateness."""
    asked, links, names = scene.options.clearance, scene.robot.links, [body.name for body in bodies_in(scene)]
    rules = [
        {
            "first": [k for k, name in enumerate(names) if name in rule.first],
            "second": [k for k, name in enumerate(names) if name in rule.second],
            "travel": rule.travel_m,
            "near": rule.near_m,
        }
        for rule in asked.exceptions
    ]
    return {
        "travel": asked.travel_m,
        "near": asked.near_m,
        "self_pairs": [
            [link_number(scene.robot, links.index(name)) for name in names_] for names_ in scene.robot.self_pairs
        ],
        "until": until,
        "lag": list(scene.execution.lag) or [0.0] * len(scene.robot.joints),
        "late": scene.execution.start_tolerance_s,
        "since": scene.start.time,
        "tool_from": links.index("quill" if "quill" in links else "flange"),
        "exceptions": rules,
    }
