"""Plain facts about later steps are proved after the first few candidates, and name the step that is to blame."""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import Any

import pytest

from assur.scenes import check, plan

CUP = {"name": "cup", "shape": {"cylinder": {"radius_mm": 10, "height_mm": 80}}, "at_mm": [0, 0, -40]}
CELL: dict[str, Any] = {
    "schema": "assur/1",
    "robot": {"model": "fanuc-sr-3ia", "tool": {"tcp_mm": [0, 0, -80], "bodies": [CUP]}},
    "start": {"joints": {"j1_deg": 20, "j2_deg": 60, "j3_mm": 20, "j4_deg": 0}},
    "frames": {"belt": {"conveyor": {"at_mm": [-300, 280, 40], "speed_mm_s": 150}}},
    "bodies": [
        {"name": "bed", "shape": {"box": {"size_mm": [1200, 120, 40]}}, "pose": {"at_mm": [0, 280, 20]}},
        {"name": "table", "shape": {"box": {"size_mm": [200, 200, 40]}}, "pose": {"at_mm": [250, -150, 20]}},
        {
            "name": "part",
            "shape": {"box": {"size_mm": [30, 30, 20]}},
            "pose": {"frame": "belt", "at_mm": [0, 0, 10]},
            "yaw_symmetry": 4,
        },
    ],
    "task": [
        {
            "pick": {
                "part": "part",
                "grasp_mm": [0, 0, 10],
                "approach": {"mm": 20},
                "dwell_ms": 60,
                "depart": {"mm": 20},
                "contact_with": ["bed"],
            }
        },
        {
            "place": {
                "part": "part",
                "to": {"at_mm": [250, -150, 50], "yaw_deg": 0},
                "approach": {"mm": 20},
                "dwell_ms": 60,
                "depart": {"mm": 20},
            }
        },
    ],
    "options": {
        "stop": "first",
        "budget_s": 60,
        "max_candidates": 400,
        "elbow": "auto",
        "clearance_mm": {"travel": 5, "near": 1},
        "explain_budget_s": 0,
    },
}
FEW = 12
"""Candidates after which a plain fact is proved, at most: those of one round."""
Change = Callable[[dict[str, Any]], object]


def put(at_mm: list[float]) -> Change:
    return lambda cell: cell["task"][1]["place"]["to"].update(at_mm=at_mm)


def also(step: dict[str, Any]) -> Change:
    return lambda cell: cell["task"].append(step)


def stand(name: str, size_mm: list[float], at_mm: list[float]) -> Change:
    body = {"name": name, "shape": {"box": {"size_mm": size_mm}}, "pose": {"at_mm": at_mm}}
    return lambda cell: cell["bodies"].append(body)


def any_yaw_and_far(cell: dict[str, Any]) -> None:
    cell["bodies"][2]["yaw_symmetry"] = 0
    put([900, -500, 50])(cell)


def belt_that_ends(cell: dict[str, Any]) -> None:
    cell["frames"]["other"] = {"conveyor": {"at_mm": [250, 0, 40], "speed_mm_s": 50}, "valid_s": [-1, 0.5]}
    also({"follow": {"to": {"frame": "other", "at_mm": [0, 0, 80], "yaw_free": True}, "duration_s": 0.8}})(cell)


def part_in_a_desk(cell: dict[str, Any]) -> None:
    stand("desk", [120, 120, 40], [250, 120, 20])(cell)
    cell["bodies"][2]["pose"] = {"at_mm": [250, 120, 45]}  # 5 mm deep
    del cell["task"][0]["pick"]["contact_with"]


def part_in_the_wall_of_a_tray(cell: dict[str, Any]) -> None:
    tray = {"name": "tray", "shape": {"mesh": {"asset": "tray", "unit": "mm"}}, "pose": {"at_mm": [250, -150, 70]}}
    cell["bodies"].append(tray)
    put([250 + 100 - 15, -150, 56])(cell)  # the wall is 6 mm thick and 100 mm from the middle


def straight(which: str, mm: float) -> Change:
    return lambda cell: cell["task"][1]["place"].update({which: {"mm": mm, "stop": True}})


def depart_and_away(cell: dict[str, Any]) -> None:
    straight("depart", 3)(cell)
    also({"move": {"to": {"at_mm": [250, 0, 120]}}})(cell)


def arch(top_mm: float) -> Change:
    return lambda cell: cell["task"][1]["place"].update(arch={"top_mm": top_mm})


FOLLOW = {"to": {"frame": "belt", "at_mm": [0, 0, 80], "yaw_free": True}, "duration_s": 1.0, "window_mm": [300, 320]}
CASES: dict[str, tuple[Change, str, int]] = {
    "place out of reach": (put([900, -500, 50]), "OUT_OF_REACH", 1),
    "place below the lift": (put([250, -150, -250]), "JOINT_LIMIT", 1),
    "place above the lift with its approach": (put([250, -150, 160]), "JOINT_LIMIT", 1),
    "place into the table": (put([250, -150, 45]), "CONTROL_POINT_IN_COLLISION", 1),
    "an arch above the lift": (arch(400), "JOINT_LIMIT", 1),
    "something in the nest": (stand("block", [60, 60, 60], [250, -150, 70]), "CONTROL_POINT_IN_COLLISION", 1),
    "a lid over the nest": (stand("lid", [80, 80, 5], [250, -150, 75]), "CONTROL_POINT_IN_COLLISION", 1),
    "place out of reach, taken in any yaw": (any_yaw_and_far, "OUT_OF_REACH", 1),
    "a later move out of reach": (also({"move": {"to": {"at_mm": [600, 0, 100]}}}), "OUT_OF_REACH", 2),
    "a later window that is too short": (also({"follow": FOLLOW}), "WINDOW_MISSED", 2),
    "a later law that ends too soon": (belt_that_ends, "LAW_ENDS", 2),
    "a part that is inside its support": (part_in_a_desk, "CONTROL_POINT_IN_COLLISION", 0),
    "a place in the wall of a tray": (part_in_the_wall_of_a_tray, "CONTROL_POINT_IN_COLLISION", 1),
    "an approach shorter than the clearance": (straight("approach", 2), "CONTROL_POINT_IN_COLLISION", 1),
    "no approach": (straight("approach", 0), "CONTROL_POINT_IN_COLLISION", 1),
    "a depart shorter than the clearance": (depart_and_away, "CONTROL_POINT_IN_COLLISION", 1),
}


def test_the_cell_itself_is_planned() -> None:
    assert plan(CELL)["status"] == "planned"


def test_what_would_help_is_what_the_refusal_is_about() -> None:
    """More search helps nothing that is proved, and no other height of a point that is out of reach by a metre."""
    helps = {
        "place above the lift with its approach": ("heights", "approach 10 mm, depart 10 mm"),
        "something in the nest": ("without", "block"),
        "a lid over the nest": ("without", "lid"),
        "place out of reach": None,
    }
    for name, expected in helps.items():
        cell = copy.deepcopy(CELL)
        CASES[name][0](cell)
        if name.startswith("place above"):
            put([250, -150, 149])(cell)
        cell["options"]["explain_budget_s"] = 30
        answer = plan(cell)
        assert answer["proved"]
        found = answer["relaxation"]
        assert (None if found is None else (found["what"], found["value"])) == expected
        assert not any(tried.startswith("budget") for tried in answer["tried"])


@pytest.mark.parametrize("name", CASES)
def test_it_is_proved_after_one_round(name: str) -> None:
    change, reason, step = CASES[name]
    cell = copy.deepcopy(CELL)
    change(cell)
    answer = plan(cell)
    assert answer["status"] == "not_planned"
    assert (answer["reason"], answer["proved"]) == (reason, True), answer["sentence"]
    assert answer["refusal"]["step"] == step
    assert answer["census"]["candidates"] <= FEW


def test_an_arch_above_the_lift_is_told_with_the_highest_that_fits_and_needs_no_search() -> None:
    cell = copy.deepcopy(CELL)
    arch(400)(cell)
    answer = plan(cell)
    assert answer["census"]["candidates"] == 0
    most = 400 - 1e3 * answer["refusal"]["amount"]
    told = f"for an arch up to 400 mm (the lift allows {most:.4g} mm), j3 would have to go to "
    assert answer["sentence"].startswith(f"place-2: {told}")
    arch(most)(cell)
    assert plan(cell)["status"] == "planned"
    arch(most + 0.01)(cell)
    assert plan(cell)["proved"]


@pytest.mark.parametrize(
    ("name", "words", "value", "limit"),
    [
        # J3 counts downwards, from 0 to 200 mm
        ("place below the lift", "410 mm, 210 mm beyond the end of its range at 200 mm", 0.41, 0.2),
        ("place above the lift with its approach", "-20 mm, 20 mm beyond the end of its range at 0 mm", -0.02, 0.0),
    ],
)
def test_a_joint_beyond_its_range_is_told_as_its_maker_counts_it(
    name: str, words: str, value: float, limit: float
) -> None:
    cell = copy.deepcopy(CELL)
    CASES[name][0](cell)
    answer = plan(cell)
    assert f"j3 would have to go to {words}" in answer["sentence"]
    facts = answer["refusal"]["facts"]
    assert facts["value"] == pytest.approx(value)
    assert facts["limit"] == pytest.approx(limit)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (
            straight("approach", 2),
            ["approach is too short: 2 mm above the point", "gap 2 mm, required 5 mm (clearance in travel 5 mm)"],
        ),
        (
            straight("approach", 0),
            ["approach is too short: 0 mm above the point", "required 5 mm (clearance in travel 5 mm)"],
        ),
        (
            depart_and_away,
            ["depart is too short: 3 mm above the point", "gap 3 mm, required 5 mm (clearance in travel 5 mm)"],
        ),
    ],
)
def test_a_straight_part_that_is_too_short_is_told_with_one_that_is_long_enough(
    change: Change, words: list[str]
) -> None:
    cell = copy.deepcopy(CELL)
    change(cell)
    sentence = plan(cell)["sentence"]
    assert all(each in sentence for each in [*words, "; it must be at least 5.1 mm"]), sentence
    enough = copy.deepcopy(CELL)
    change(enough)
    straight(words[0].split()[0], 5.1)(enough)
    assert plan(enough)["status"] == "planned"


def test_a_part_that_is_to_rest_on_what_is_in_its_way_is_told_how_to_say_so() -> None:
    """Where the part is just above the body. Where it is 5 mm in it, to name the body would not help."""
    cell = copy.deepcopy(CELL)
    part_in_a_desk(cell)
    hint = "; if part is to rest on desk, name it in contact_with."
    deep = plan(cell)["sentence"]
    assert "part would hit desk: they would overlap by up to 5 mm" in deep
    assert "contact_with" not in deep
    desk = next(body for body in cell["bodies"] if body["name"] == "desk")
    desk["pose"]["at_mm"][2] -= 5.5
    assert plan(cell)["sentence"].endswith(hint)


def test_a_straight_part_that_is_longer_than_asked_for_is_told() -> None:
    cell = copy.deepcopy(CELL)
    cell["task"][1]["place"]["approach"] = {"mm": 3}
    cell["task"][1]["place"]["depart"] = {"mm": 3, "stop": True}
    answer = plan(cell)
    assert check(cell, answer)["ok"]
    told = [text for text in answer["assumptions"] if "the straight part of" in text]
    assert told == [
        "place-2: the straight part of approach is 5.5 mm long, not 3 mm: at least 1.1 times the clearance of travel, "
        "5 mm, unless it has stop: true"
    ]
    assert not [text for text in plan(CELL)["assumptions"] if "the straight part of" in text]
