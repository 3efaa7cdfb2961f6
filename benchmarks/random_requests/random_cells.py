"""Random cells of all kinds, in SI: a kind and a seed make the same request on every machine."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from benchmarks.judge.poses import Document
from benchmarks.random_requests.drafts import (
    FIVE_BAR,
    SCARAS,
    THREE_AXES,
    Draft,
    drafted,
    finished,
    neighbour_of,
    part_shape,
    start_above,
    tool_reach,
)


def random_cell(kind: str, seed: int) -> Document:
    """The request of a kind (one of `KINDS`) and a seed."""
    rng = np.random.default_rng([seed, list(KINDS).index(kind)])
    return finished(KINDS[kind](rng).request)


# where parts come from and go to: the frame, the pose of what lies there, and on what it lies


def _table(draft: Draft, name: str) -> tuple[str, list[float], list[str]]:
    angle, radius = tool_reach(draft)
    top = draft.low + draft.between(0.05, 0.3) * draft.stroke
    law = {"fixed": {"at_m": draft.at(angle, radius, top), "yaw_rad": draft.yaw(angle)}}
    draft.add_frame(name, law, draft.of_frame(False, 0.7))
    draft.count(draft.request["frames"][name].get("uncertainty", {}))
    size = [4.5 * draft.half[0], 4.5 * draft.half[1], 0.02]
    draft.add_body(f"{name}-top", {"box": {"size_m": size}}, [0.0, 0.0, -0.01], frame=name)
    return name, [0.0, 0.0, draft.half[2]], [f"{name}-top"]


def _belt(draft: Draft, name: str, due_s: float | None = None) -> tuple[str, list[float], list[str]]:
    angle, radius = tool_reach(draft)
    top, start = draft.low + draft.between(0.05, 0.3) * draft.stroke, draft.request["start"].get("at_s", 0.0)
    speed = draft.between(0.1, 0.5) * draft.reach
    along = angle + draft.one_of(-1.0, 1.0) * math.pi / 2.0 + draft.between(-0.2, 0.2)
    due = start + (draft.between(0.5, 1.2) if due_s is None else due_s)
    x, y, z = draft.at(angle, radius, top)
    heading = draft.yaw(along)
    law: Document = {"at_m": [x, y, z], "yaw_rad": heading, "at_s": due}
    if draft.chance(0.25):
        velocity = [speed * math.cos(heading), speed * math.sin(heading), 0.0]
        draft.add_frame(name, {"linear": {**law, "velocity_m_s": velocity}}, draft.of_frame(True))
    else:
        law["speed_m_s"] = speed
        if draft.chance(0.25):
            after = {"at_s": due + 0.3, "speed_m_s": 0.7 * speed, "acceleration_m_s2": 1.0, "jerk_m_s3": 20.0}
            law["changes"] = [after]
        draft.add_frame(name, {"conveyor": law}, draft.of_frame(True))
    draft.count(draft.request["frames"][name].get("uncertainty", {}))
    size = [1.6 * draft.reach, 4.0 * draft.half[1], 0.02]
    draft.add_body(f"{name}-bed", {"box": {"size_m": size}}, [x, y, z - 0.01], heading)
    return name, [0.0, 0.0, draft.half[2]], [f"{name}-bed"]


def _dial(draft: Draft, name: str) -> tuple[str, list[float], list[str]]:
    angle, radius = tool_reach(draft)
    top, start = draft.low + draft.between(0.05, 0.3) * draft.stroke, draft.request["start"].get("at_s", 0.0)
    pose = {"at_m": draft.at(angle, radius, top), "yaw_rad": draft.between(-3.0, 3.0)}
    if draft.chance(0.5):
        law: Document = {"turntable": {**pose, "rate_rad_s": draft.one_of(-1.0, 1.0) * draft.between(0.1, 0.8)}}
    else:
        moves = {
            "step_rad": draft.between(-0.8, 0.8),
            "move_s": draft.between(0.3, 0.6),
            "dwell_s": draft.between(0.6, 1.5),
        }
        law = {"indexer": {**pose, **moves, "start_s": start + draft.between(-1.0, 0.5)}}
    draft.add_frame(name, law, draft.of_frame(False, 0.7))
    draft.count(draft.request["frames"][name].get("uncertainty", {}))
    plate = {"cylinder": {"radius_m": 0.1 * draft.reach + 2.0 * max(draft.half[:2]), "height_m": 0.02}}
    draft.add_body(f"{name}-plate", plate, [0.0, 0.0, -0.01], frame=name)
    return name, [0.08 * draft.reach, 0.0, draft.half[2]], [f"{name}-plate"]


def _tray(draft: Draft, name: str) -> tuple[str, list[float], list[str]]:
    """The shipped tray, 200 x 150 x 60 mm, whose floor is 6 mm thick."""
    angle, radius = tool_reach(draft)
    floor = draft.low + draft.between(0.05, 0.15) * draft.stroke
    draft.add_frame(name, {"fixed": {"at_m": draft.at(angle, radius, floor), "yaw_rad": draft.yaw(angle)}}, {})
    draft.add_body(f"{name}-mesh", {"mesh": {"asset": "tray", "unit": "mm"}}, [0.0, 0.0, 0.024], frame=name)
    return name, [draft.between(-0.03, 0.03), draft.between(-0.02, 0.02), draft.half[2]], [f"{name}-mesh"]


PLACES: dict[str, Callable[[Draft, str], tuple[str, list[float], list[str]]]] = {
    "table": _table,
    "belt": _belt,
    "dial": _dial,
    "tray": _tray,
}


def _straight(draft: Draft) -> Document:
    return {"m": draft.between(0.08, 0.2) * draft.stroke}


def _handled(draft: Draft, source: str, goal: str) -> None:
    """A pick and a place, with what contacts must give way."""
    frame, at, stands = PLACES[source](draft, "source")
    part = draft.add_body("part", part_shape(draft), at, frame=frame)
    draft.count(draft.loosen(part))
    part["yaw_symmetry"] = draft.one_of(1, 2) if "box" in part["shape"] else 0
    beside = draft.request.get("beside_m")
    sideways = (
        0.0
        if beside is None
        else max(draft.loose_m + 0.05 * draft.request["execution"].get("start_tolerance_s", 0.0), 0.0)
    )
    give = 2.2 * (draft.upright_m + sideways) + 5e-5
    pick: Document = {
        "part": "part", "grasp_m": [0.0, 0.0, draft.half[2]], "approach": _straight(draft), "depart": _straight(draft),
        "dwell_s": draft.between(0.0, 0.1), "contact_with": stands, "contact_tolerance_m": give,
    }  # fmt: skip
    if draft.chance(0.4):
        pick["held_within"] = {"position_m": draft.between(0.0, 1e-3), "yaw_rad": draft.between(0.0, 0.01)}
        if draft.chance(0.4):
            pick["held_within"]["vertical_m"] = draft.between(0.0, 2e-4)
            draft.upright_m += pick["held_within"]["vertical_m"]
    draft.request["task"].append({"pick": pick})
    _place(draft, goal, give)


def _place(draft: Draft, goal: str, give: float) -> None:
    loose, upright = draft.loose_m, draft.upright_m
    frame, at, stands = _belt(draft, "goal", draft.between(1.5, 2.5)) if goal == "belt" else PLACES[goal](draft, "goal")
    sideways = 0.0 if draft.request.get("beside_m") is None else draft.loose_m + loose
    place: Document = {
        "part": "part",
        "to": {"frame": frame, "at_m": at, "yaw_rad": draft.between(-1.5, 1.5)},
        "approach": _straight(draft),
        "depart": _straight(draft),
        "dwell_s": draft.between(0.0, 0.1),
        "contact_with": stands,
        "contact_tolerance_m": 1.1 * (draft.upright_m + upright + sideways) + give,
    }
    if goal == "tray":
        place["approach"] = place["depart"] = {"m": 0.06}
    draft.request["task"].append({"place": place})
    if draft.chance(0.4):
        _aside(draft)


def _aside(draft: Draft) -> None:
    angle, radius = tool_reach(draft)
    z = draft.low + draft.between(0.7, 0.95) * draft.stroke
    draft.request["task"].append({"move": {"to": {"at_m": draft.at(angle, radius, z)}}})


# obstacles and moving frames


def surround(draft: Draft, most: int) -> None:
    """Up to `most` obstacles of all kinds; and distances of their own for some pairs."""
    for number in range(int(draft.rng.integers(most + 1))):
        draft.one_of(*OBSTACLES)(draft, f"obstacle-{number}")
    bodies = [body["name"] for body in draft.request["bodies"] if body["name"].startswith("obstacle")]
    if bodies and draft.chance(0.3):
        distances = {"travel": draft.between(0.0, 8e-3), "near": draft.between(0.0, 4e-3)}
        rule = {"between": [draft.one_of(*bodies)], "clearance_m": distances}
        draft.request["options"]["clearance_exceptions"] = [rule]


def _shape(draft: Draft, height: float) -> Document:
    r = draft.reach
    kind = draft.one_of("box", "cylinder", "capsule", "sphere", "rail", "bar")
    if kind == "box":
        return {"box": {"size_m": [draft.between(0.03, 0.2) * r, draft.between(0.03, 0.2) * r, height]}}
    if kind == "cylinder":
        return {"cylinder": {"radius_m": draft.between(0.02, 0.08) * r, "height_m": height}}
    if kind == "capsule":
        return {"capsule": {"radius_m": draft.between(0.02, 0.06) * r, "length_m": height}}
    if kind == "sphere":
        return {"sphere": {"radius_m": draft.between(0.03, 0.1) * r}}
    if kind == "rail":
        shape = {"radius_m": draft.between(0.02, 0.05) * r, "height_m": draft.between(0.1, 0.4) * r, "axis": "x"}
        return {"cylinder": shape}
    return {
        "capsule": {"radius_m": draft.between(0.02, 0.05) * r, "length_m": draft.between(0.1, 0.4) * r, "axis": "y"}
    }


def _somewhere(draft: Draft) -> tuple[float, float, float]:
    angle = draft.between(-1.0, 1.0) if draft.five_bar else draft.between(-2.2, 2.2)
    radius = draft.between(0.6, 1.15) * draft.reach
    return angle, radius, draft.low + draft.between(-0.1, 0.6) * draft.stroke


def _stands(draft: Draft, name: str) -> None:
    angle, radius, z = _somewhere(draft)
    body = draft.add_body(
        name,
        _shape(draft, draft.between(0.3, 1.0) * draft.stroke),
        draft.at(angle, radius, z),
        draft.between(-3.0, 3.0),
    )
    draft.loosen(body, 2.0)


def _oscillates(draft: Draft, name: str) -> None:
    angle, radius, z = _somewhere(draft)
    law = {
        "at_m": draft.at(angle, radius, z + draft.between(0.0, 0.5) * draft.stroke),
        "yaw_rad": draft.between(-3.0, 3.0),
        "direction": draft.one_of([0.0, 0.0, 1.0], [1.0, 0.5, 0.0], [0.0, 1.0, 0.3]),
        "amplitude_m": draft.between(0.1, 0.4) * draft.reach,
        "period_s": draft.between(0.8, 3.0),
        "phase_rad": draft.between(-3.0, 3.0),
    }
    _moving(draft, name, {"oscillation": law})


def _swings(draft: Draft, name: str) -> None:
    angle, radius, z = _somewhere(draft)
    law = {
        "pivot_m": draft.at(angle, radius + 0.1 * draft.reach, z),
        "yaw_rad": draft.between(-3.0, 3.0),
        "amplitude_rad": draft.between(0.3, 1.5),
        "period_s": draft.between(0.8, 3.0),
        "phase_rad": draft.between(-3.0, 3.0),
    }
    draft.add_frame(f"{name}-frame", {"swing": law}, draft.of_frame(False))
    size = [draft.between(0.2, 0.4) * draft.reach, 0.03 * draft.reach, draft.between(0.1, 0.5) * draft.stroke]
    draft.add_body(name, {"box": {"size_m": size}}, [size[0] / 2.0, 0.0, 0.0], frame=f"{name}-frame")


def _passes(draft: Draft, name: str) -> None:
    """Through poses, once or again and again."""
    start, repeat = draft.request["start"].get("at_s", 0.0), draft.chance(0.6)
    times = start - 0.5 + np.concatenate([[0.0], np.cumsum(draft.rng.uniform(0.4, 1.0, 3 if repeat else 7))])
    points = []
    for time in times.tolist():
        angle, radius, z = _somewhere(draft)
        turn = draft.between(-0.5, 0.5)
        points.append({"time_s": time, "at_m": draft.at(angle, radius + 0.1 * draft.reach, z), "yaw_rad": turn})
    if repeat:
        points[-1] = {**points[0], "time_s": points[-1]["time_s"]}
    else:
        points[-1]["time_s"] += 30.0
    _moving(draft, name, {"keyframes": {"points": points, **({"repeat": True} if repeat else {})}})


def _crosses(draft: Draft, name: str) -> None:
    angle, radius, z = _somewhere(draft)
    heading, speed = draft.yaw(draft.between(-3.0, 3.0)), draft.between(0.2, 1.0) * draft.reach
    law = {
        "at_m": draft.at(angle, radius, z),
        "velocity_m_s": [speed * math.cos(heading), speed * math.sin(heading), draft.between(-0.1, 0.1) * speed],
        "at_s": draft.request["start"].get("at_s", 0.0) + draft.between(0.0, 2.0),
    }
    _moving(draft, name, {"linear": law})


def _moving(draft: Draft, name: str, law: Document) -> None:
    draft.add_frame(f"{name}-frame", law, draft.of_frame("linear" in law))
    body = draft.add_body(
        name, _shape(draft, draft.between(0.2, 0.6) * draft.stroke), [0.0, 0.0, 0.0], frame=f"{name}-frame"
    )
    draft.loosen(body, 2.0)


OBSTACLES = (_stands, _stands, _oscillates, _swings, _passes, _crosses)


# kinds of cells


def _transfer(
    source: str, goal: str, models: tuple[str, ...] = SCARAS, tool: str = "cup", corrected: bool = False
) -> Callable[[np.random.Generator], Draft]:
    def make(rng: np.random.Generator) -> Draft:
        draft = drafted(rng, str(rng.choice(models)), tool)
        start_above(draft, *tool_reach(draft))
        if corrected:
            draft.request["execution"]["belt_correction"] = True
        _handled(draft, source, goal)
        surround(draft, 3)
        return draft

    return make


def _following(models: tuple[str, ...], corrected: bool) -> Callable[[np.random.Generator], Draft]:
    """Points on belts and dials that the tool follows, with a move between."""

    def make(rng: np.random.Generator) -> Draft:
        draft = drafted(rng, str(rng.choice(models)), "cup")
        start_above(draft, *tool_reach(draft))
        if corrected:
            draft.request["execution"]["belt_correction"] = True
        for number, place in enumerate(("belt", draft.one_of("dial", "belt", "table"))):
            name = f"point-{number}"
            frame, at, _ = _belt(draft, name, 2.0) if number and place == "belt" else PLACES[place](draft, name)
            free = draft.model == THREE_AXES
            to = {"frame": frame, "at_m": [at[0], at[1], draft.between(0.02, 0.05) * draft.reach]}
            to |= {} if free else draft.one_of({"yaw_free": True}, {"yaw_rad": draft.between(-1.0, 1.0)})
            draft.request["task"].append({"follow": {"to": to, "duration_s": draft.between(0.05, 0.4)}})
            if number == 0 and draft.chance(0.4):
                _aside(draft)
        surround(draft, 3)
        return draft

    return make


def _holding(rng: np.random.Generator) -> Draft:
    draft = drafted(rng, str(rng.choice(SCARAS)), "cup")
    start_above(draft, *tool_reach(draft))
    within = {
        "position_m": draft.between(0.0, 2e-3),
        "yaw_rad": draft.between(0.0, 0.02),
        "vertical_m": draft.between(0.0, 3e-4),
    }
    draft.request["start"]["holding"] = {"part": "part", "grasp_m": [0.0, 0.0, draft.half[2]], "within": within}
    draft.request["bodies"].append({"name": "part", "shape": part_shape(draft)})
    draft.count(within)
    _place(draft, draft.one_of("table", "belt", "dial"), draft.upright_m)
    surround(draft, 3)
    return draft


def _beside(rng: np.random.Generator) -> Draft:
    """Beside another robot."""
    draft = drafted(rng, str(rng.choice(SCARAS)), "cup")
    start_above(draft, *tool_reach(draft))
    _handled(draft, draft.one_of("table", "belt"), draft.one_of("table", "dial"))
    draft.request["neighbours"] = [neighbour_of(draft, int(rng.integers(3, 6)))]
    surround(draft, 1)
    return draft


LARGE = SCARAS[:2]
KINDS: dict[str, Callable[[np.random.Generator], Draft]] = {
    "table to table": _transfer("table", "table"),
    "belt to table": _transfer("belt", "table"),
    "belt to table, corrected": _transfer("belt", "table", corrected=True),
    "belt to belt, corrected": _transfer("belt", "belt", corrected=True),
    "belt to dial": _transfer("belt", "dial"),
    "dial to belt": _transfer("dial", "belt"),
    "table to tray": _transfer("table", "tray", models=LARGE),
    "jaws, table to dial": _transfer("table", "dial", tool="jaws"),
    "jaws, belt to table": _transfer("belt", "table", tool="jaws"),
    "part held at the start": _holding,
    "beside a robot": _beside,
    "follow": _following((*SCARAS, THREE_AXES, FIVE_BAR), corrected=False),
    "follow, corrected": _following(SCARAS, corrected=True),
    "five-bar": _transfer("table", "table", models=(FIVE_BAR,)),
    "five-bar, belt": _transfer("belt", "dial", models=(FIVE_BAR,)),
}
