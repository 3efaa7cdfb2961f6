"""Plain facts about later steps are proved after the first few candidates, and name the step that is to blame."""

from __future__ import annotations

from typing import Any

import pytest

from assur.scenes import check, plan
from tests.changed import GONE, changed

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
Changes = dict[str, Any]
PLACE = "task[1].place"
MOVE_AWAY: Changes = {"task[+]": {"move": {"to": {"at_mm": [250, 0, 120]}}}}


def put(at_mm: list[float]) -> Changes:
    return {f"{PLACE}.to.at_mm": at_mm}


def stand(name: str, size_mm: list[float], at_mm: list[float]) -> Changes:
    return {"bodies[+]": {"name": name, "shape": {"box": {"size_mm": size_mm}}, "pose": {"at_mm": at_mm}}}


def straight(which: str, mm: float) -> Changes:
    return {f"{PLACE}.{which}": {"mm": mm, "stop": True}}


def arch(top_mm: float) -> Changes:
    return {f"{PLACE}.arch": {"top_mm": top_mm}}


def planned(*changes: Changes) -> dict[str, Any]:
    """The answer to the cell with changes."""
    answer: dict[str, Any] = plan(changed(CELL, {key: value for each in changes for key, value in each.items()}))
    return answer


BELT_THAT_ENDS: Changes = {
    "frames.other": {"conveyor": {"at_mm": [250, 0, 40], "speed_mm_s": 50}, "valid_s": [-1, 0.5]},
    "task[+]": {"follow": {"to": {"frame": "other", "at_mm": [0, 0, 80], "yaw_free": True}, "duration_s": 0.8}},
}
PART_IN_A_DESK: Changes = {
    **stand("desk", [120, 120, 40], [250, 120, 20]),
    "bodies[2].pose": {"at_mm": [250, 120, 45]},  # 5 mm deep
    "task[0].pick.contact_with": GONE,
}
TRAY = {"name": "tray", "shape": {"mesh": {"asset": "tray", "unit": "mm"}}, "pose": {"at_mm": [250, -150, 70]}}
IN_ITS_WALL = put([250 + 100 - 15, -150, 56])
"""The wall is 6 mm thick and 100 mm from the middle."""
DEPART_AND_AWAY = straight("depart", 3) | MOVE_AWAY
FOLLOW = {"to": {"frame": "belt", "at_mm": [0, 0, 80], "yaw_free": True}, "duration_s": 1.0, "window_mm": [300, 320]}
FAR_MOVE = {"move": {"to": {"at_mm": [600, 0, 100]}}}
IN_COLLISION = "CONTROL_POINT_IN_COLLISION"
CASES: dict[str, tuple[Changes, str, int]] = {
    "place out of reach": (put([900, -500, 50]), "OUT_OF_REACH", 1),
    "place below the lift": (put([250, -150, -250]), "JOINT_LIMIT", 1),
    "place above the lift with its approach": (put([250, -150, 160]), "JOINT_LIMIT", 1),
    "place into the table": (put([250, -150, 45]), IN_COLLISION, 1),
    "an arch above the lift": (arch(400), "JOINT_LIMIT", 1),
    "something in the nest": (stand("block", [60, 60, 60], [250, -150, 70]), IN_COLLISION, 1),
    "a lid over the nest": (stand("lid", [80, 80, 5], [250, -150, 75]), IN_COLLISION, 1),
    "place out of reach, taken in any yaw": (
        put([900, -500, 50]) | {"bodies[2].yaw_symmetry": 0},
        "OUT_OF_REACH",
        1,
    ),
    "a later move out of reach": ({"task[+]": FAR_MOVE}, "OUT_OF_REACH", 2),
    "a later window that is too short": ({"task[+]": {"follow": FOLLOW}}, "WINDOW_MISSED", 2),
    "a later law that ends too soon": (BELT_THAT_ENDS, "LAW_ENDS", 2),
    "a part that is inside its support": (PART_IN_A_DESK, IN_COLLISION, 0),
    "a place in the wall of a tray": ({"bodies[+]": TRAY} | IN_ITS_WALL, IN_COLLISION, 1),
    "an approach shorter than the clearance": (straight("approach", 2), IN_COLLISION, 1),
    "no approach": (straight("approach", 0), IN_COLLISION, 1),
    "a depart shorter than the clearance": (DEPART_AND_AWAY, IN_COLLISION, 1),
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
        near = put([250, -150, 149]) if name.startswith("place above") else {}
        answer = planned(CASES[name][0], near, {"options.explain_budget_s": 30})
        assert answer["proved"]
        found = answer["relaxation"]
        assert (None if found is None else (found["what"], found["value"])) == expected
        assert not any(tried.startswith("budget") for tried in answer["tried"])


@pytest.mark.parametrize("name", CASES)
def test_it_is_proved_after_one_round(name: str) -> None:
    changes, reason, step = CASES[name]
    answer = planned(changes)
    assert answer["status"] == "not_planned"
    assert (answer["reason"], answer["proved"]) == (reason, True), answer["sentence"]
    assert answer["refusal"]["step"] == step
    assert answer["census"]["candidates"] <= FEW


def test_an_arch_above_the_lift_is_told_with_the_highest_that_fits_and_needs_no_search() -> None:
    answer = planned(arch(400))
    assert answer["census"]["candidates"] == 0
    most = 400 - 1e3 * answer["refusal"]["amount"]
    told = f"for an arch up to 400 mm (the lift allows {most:.4g} mm), j3 would have to go to "
    assert answer["sentence"].startswith(f"place-2: {told}")
    assert planned(arch(most))["status"] == "planned"
    assert planned(arch(most + 0.01))["proved"]


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
    answer = planned(CASES[name][0])
    assert f"j3 would have to go to {words}" in answer["sentence"]
    facts = answer["refusal"]["facts"]
    assert facts["value"] == pytest.approx(value)
    assert facts["limit"] == pytest.approx(limit)


@pytest.mark.parametrize(
    ("which", "mm", "more", "words"),
    [
        ("approach", 2, {}, "gap 2 mm, required 5 mm (clearance in travel 5 mm)"),
        ("approach", 0, {}, "required 5 mm (clearance in travel 5 mm)"),
        ("depart", 3, MOVE_AWAY, "gap 3 mm, required 5 mm (clearance in travel 5 mm)"),
    ],
)
def test_a_straight_part_that_is_too_short_is_told_with_one_that_is_long_enough(
    which: str, mm: float, more: Changes, words: str
) -> None:
    sentence = planned(straight(which, mm), more)["sentence"]
    for each in (f"{which} is too short: {mm} mm above the point", words, "; it must be at least 5.1 mm"):
        assert each in sentence
    assert planned(straight(which, 5.1), more)["status"] == "planned"


def test_a_part_that_is_to_rest_on_what_is_in_its_way_is_told_how_to_say_so() -> None:
    """Where the part is just above the body. Where it is 5 mm in it, to name the body would not help."""
    deep = planned(PART_IN_A_DESK)["sentence"]
    assert "part would hit desk: they would overlap by up to 5 mm" in deep
    assert "contact_with" not in deep
    lower = planned(PART_IN_A_DESK, stand("desk", [120, 120, 40], [250, 120, 20 - 5.5]))["sentence"]
    assert lower.endswith("; if part is to rest on desk, name it in contact_with.")


def test_a_straight_part_that_is_longer_than_asked_for_is_told() -> None:
    cell = changed(CELL, {f"{PLACE}.approach": {"mm": 3}, f"{PLACE}.depart": {"mm": 3, "stop": True}})
    answer = plan(cell)
    assert check(cell, answer)["ok"]
    told = [text for text in answer["assumptions"] if "the straight part of" in text]
    assert told == [
        "place-2: the straight part of approach is 5.5 mm long, not 3 mm: at least 1.1 times the clearance of travel, "
        "5 mm, unless it has stop: true"
    ]
    assert not [text for text in plan(CELL)["assumptions"] if "the straight part of" in text]
