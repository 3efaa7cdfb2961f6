"""What was found in a log as a document, and as parts that a robot's file and a request take."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from assur.scenes.catalogue import load_robot, shipped_robot
from assur.scenes.faults import DocumentError
from assur.scenes.fitted_limits import RATES, WHY, fit_limits, in_words, kept, part
from assur.scenes.motion_log import LoggedJoint, MotionLog, load_log
from assur.scenes.text.yaml_text import parse_yaml
from benchmarks.recorded_motion import example

LOG = Path(__file__).parents[2] / "docs" / "logs" / "cycle.csv"
TRUTH = {"j1": (60.0, 2100.0), "j2": (95.0, 3600.0), "j3": (10.0, 420.0)}
"""Acceleration and jerk of the joints of the shipped log."""


@pytest.fixture(scope="module")
def found() -> dict[str, Any]:
    return fit_limits(LOG, robot=shipped_robot("fanuc-sr-3ia"))


def test_the_shipped_log_is_what_its_program_writes() -> None:
    assert example() == LOG.read_text(encoding="utf-8")


def test_the_limits_of_the_shipped_log_are_found(found: dict[str, Any]) -> None:
    assert {joint["name"] for joint in found["joints"]} == set(TRUTH)
    for joint in found["joints"]:
        for rate, truth in zip(RATES, TRUTH[joint["name"]], strict=True):
            estimate = joint[rate]
            assert estimate["status"] == "identified"
            assert abs(estimate["value"] - truth) <= estimate["error"] <= 0.05 * truth
            assert estimate["unit"] == joint["unit"] + RATES[rate]
            assert (estimate["reason"], estimate["sentence"]) == (None, None)
    assert found["log"] == pytest.approx({"file": "cycle.csv", "rows": 724, "duration_s": 2.892, "step_s": 0.004})
    assert json.loads(json.dumps(found)) == found


def test_a_part_belongs_into_a_robots_file_and_holds_lower_ends(found: dict[str, Any], tmp_path: Path) -> None:
    pasted, _ = parse_yaml(part(found).encode())
    robot = shipped_robot("fanuc-sr-3ia")
    document = json.loads(json.dumps(robot.document))
    for joint in pasted["joints"]:
        (own,) = (one for one in document["scara"]["joints"] if one["name"] == joint["name"])
        for key in [key for key in own if key.startswith(tuple(RATES))]:
            del own[key]
        own |= joint
    file = tmp_path / "measured.yaml"
    file.write_text(json.dumps(document))
    listed = load_robot(file).listed()
    for joint, own in zip(listed["joints"], found["joints"], strict=False):
        for rate in RATES:
            assert joint[rate]["status"] == "measured"
            assert "cycle.csv" in joint[rate]["source"]
            assert 0.95 * own[rate]["value"] < joint[rate]["value"] <= own[rate]["value"] - own[rate]["error"]
    assert any("jerk" in words and "measured: cycle.csv" in words for words in listed["assumptions"])


def test_the_limits_of_a_request_keep_every_joint_below_what_was_found(found: dict[str, Any]) -> None:
    scales = found["limits"]
    assert part(found).splitlines()[-1] == "limits: {" + ", ".join(f"{k}: {v:g}" for k, v in scales.items()) + "}"
    for rate in RATES:
        assert 0 < scales[rate] <= 1
        ratios = [(one[rate]["value"] - one[rate]["error"]) / one[rate]["of_robot"] for one in found["joints"]]
        assert min(ratios) - 0.002 < scales[rate] <= min(ratios)


def test_a_joint_that_is_not_in_the_log_is_named_with_the_limits_that_it_keeps(found: dict[str, Any]) -> None:
    (joint,) = found["not_logged"]
    (own,) = (each for each in shipped_robot("fanuc-sr-3ia").listed()["joints"] if each["name"] == "j4")
    assert joint["name"] == "j4"
    for rate in RATES:
        assert own[rate]["unit"].startswith("deg")
        assert joint[rate]["of_robot"] == pytest.approx(np.radians(own[rate]["value"]))
        assert joint[rate]["unit"].startswith("rad")
    (sentence,) = kept(found)
    scaled = joint["jerk"]["of_robot"] * found["limits"]["jerk"]
    assert sentence.startswith("j4 is not in the log and keeps the limits of the robot: acceleration ")
    assert sentence.endswith(f"with the scale {scaled:.4g}")
    assert f"# {sentence}" in part(found).splitlines()


def test_a_log_of_every_joint_leaves_none_out_and_one_without_a_robot_knows_of_none() -> None:
    joints = tuple(LoggedJoint(f"j{i + 1}", "m" if i == 2 else "rad", np.zeros(60)) for i in range(4))
    log = MotionLog("all.csv", np.arange(0.0, 60) * 0.004, joints)
    document = fit_limits(log, robot=shipped_robot("fanuc-sr-3ia"))
    assert (document["not_logged"], kept(document)) == ([], [])
    assert kept(fit_limits(few())) == []


def test_a_robot_that_is_slower_than_what_was_found_is_not_narrowed(found: dict[str, Any]) -> None:
    slow = fit_limits(few("j3", "m"), robot=shipped_robot("fanuc-sr-3ia"))
    assert slow["limits"] == {}
    assert "limits:" not in part(slow)


def few(name: str = "j1", unit: str = "rad") -> MotionLog:
    """A log of a joint that stands still."""
    return MotionLog("still.csv", np.arange(0.0, 60) * 0.004, (LoggedJoint(name, unit, np.zeros(60)),))


def test_what_is_not_identified_is_told_and_no_part_of_a_robot() -> None:
    document = fit_limits(few())
    for rate in RATES:
        estimate = document["joints"][0][rate]
        assert (estimate["status"], estimate["value"], estimate["reason"]) == ("not_identifiable", None, "STILL")
        assert estimate["sentence"] == WHY["STILL"]
        assert in_words(estimate) == "not identifiable"
    pasted, _ = parse_yaml(part(document).encode())
    assert pasted == {"joints": [{"name": "j1"}]}
    assert "robot" not in document


def test_every_reason_has_its_sentence() -> None:
    from typing import get_args

    from assur.scenes.identification.limits import Reason

    assert set(WHY) == set(get_args(Reason))


@pytest.mark.parametrize(
    ("log", "words"),
    [
        (few("j7"), "got 'j7'; allowed: a joint of the robot: j1, j2, j3, j4"),
        (few("j3"), "got 'rad'; allowed: m or mm, for this joint"),
        (few("j1", "m"), "got 'm'; allowed: rad or deg, for this joint"),
    ],
)
def test_a_log_of_another_robot_is_refused(log: MotionLog, words: str) -> None:
    with pytest.raises(DocumentError) as caught:
        fit_limits(log, robot=shipped_robot("fanuc-sr-3ia"))
    assert words in str(caught.value)


def test_a_lower_bound_is_told_as_one() -> None:
    estimate = {"status": "lower_bound", "value": 12.3456, "error": None, "unit": "rad_s3"}
    assert in_words(estimate) == "at least 12.35 rad/s3"


def test_the_log_is_read_from_its_file_with_its_units() -> None:
    assert [(joint.name, joint.unit) for joint in load_log(LOG).joints] == [("j1", "rad"), ("j2", "rad"), ("j3", "m")]
