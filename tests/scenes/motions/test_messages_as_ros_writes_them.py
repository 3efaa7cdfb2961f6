"""Trajectories in messages as ROS, MoveIt and rosbridge write them: each is judged as the plain message is, or refused
with the names, keys and numbers that were found."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest

from assur.api.cli.trajectories import lines
from assur.planner.errors import InputError
from assur.scenes.catalogue import shipped_robot
from assur.scenes.exports.documents import check_trajectory_document
from assur.scenes.faults import DocumentError
from assur.scenes.fitted_limits import fit_limits
from assur.scenes.motion_log import parse_log
from assur.scenes.motions.ros_motion import is_message
from tests.scenes.motions.messages import CELL, JOINTS, START, message, point, yaml_text

Made = dict[str, Any]


def judged(file: str, **how: Any) -> Made:
    return check_trajectory_document(CELL, {"file": file, "format": "ros2", **how})


@cache
def plain() -> Made:
    """The verdict on the plain message."""
    verdict = judged(yaml_text(message()))
    assert (verdict["ok"], verdict["points"], verdict["notes"], verdict["begins_off"]) == (True, 11, [], [])
    return verdict


def same(verdict: Made, *notes: str) -> None:
    assert {**verdict, "notes": []} == plain()
    assert verdict["notes"] == list(notes)


def timed(old: str, new: str, of: str = "nanosec", to: str = "nanosec") -> Made:
    """The message with other keys of times."""
    made: Made = json.loads(json.dumps(message()).replace(f'"{of}"', f'"{to}"').replace(f'"{old}"', f'"{new}"'))
    return made


GOAL = {
    "trajectory": message(),
    "path_tolerance": [],
    "goal_tolerance": [],
    "goal_time_tolerance": {"sec": 0, "nanosec": 0},
}
MANY_AXES: Made = {"header": {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""}, "joint_names": [], "points": []}
ROBOT_TRAJECTORY = {"joint_trajectory": message(), "multi_dof_joint_trajectory": MANY_AXES}
IN = "the trajectory is in the field {}"
READ: dict[str, tuple[str, tuple[str, ...]]] = {
    "ros2 topic echo": (yaml_text(message()) + "\n---\n", ()),
    "ros2 topic echo, once more": ("---\n" + yaml_text(message()) + "\n---\n---\n", ()),
    "a goal": (yaml_text(GOAL), (IN.format("trajectory"),)),
    "a goal of ROS 1": (
        yaml_text({"header": {"seq": 0}, "goal_id": {"id": ""}, "goal": GOAL}),
        (IN.format("goal.trajectory"),),
    ),
    "a goal with a tolerance": (
        yaml_text({**GOAL, "goal_time_tolerance": {"sec": 1, "nanosec": 0}}),
        (IN.format("trajectory"), "fields that are not used: goal_time_tolerance"),
    ),
    "RobotTrajectory": (yaml_text(ROBOT_TRAJECTORY), (IN.format("joint_trajectory"),)),
    "DisplayTrajectory": (
        yaml_text({"model_id": "", "trajectory": [ROBOT_TRAJECTORY]}),
        (IN.format("trajectory[0].joint_trajectory"),),
    ),
    "rosbridge": (
        json.dumps({"op": "publish", "topic": "/jtc/joint_trajectory", "msg": message()}),
        (IN.format("msg"), "fields that are not used: op, topic"),
    ),
    "JSON on lines": (json.dumps(message(), indent=1), ()),
    "nsec": (yaml_text(timed("sec", "sec", "nanosec", "nsec")), ()),
    "secs and nsecs": (yaml_text(timed("sec", "secs", "nanosec", "nsecs")), ()),
    "a prefix": (
        yaml_text(message(tuple(f"line3_{name}" for name in JOINTS))),
        ("the names of the joints are read without 'line3_'",),
    ),
    "a namespace": (
        yaml_text(message(tuple(f"/cell/{name}" for name in JOINTS))),
        ("the names of the joints are read without '/cell/'",),
    ),
    "a stamp": (
        yaml_text({**message(), "header": {"stamp": {"sec": 1700000000, "nanosec": 5}, "frame_id": "base"}}),
        (
            "header.stamp (sec: 1700000000, nanosec: 5) is not used: the motion begins when the request does, or at "
            "start_s",
        ),
    ),
    "effort": (
        yaml_text({**message(), "points": [{**point(k), "effort": [1.0, 0.0, 0.0, 0.0]} for k in range(11)]}),
        ("fields that are not used: effort",),
    ),
}  # fmt: skip


@pytest.mark.parametrize("how", READ)
def test_a_trajectory_is_read_as_ros_writes_it(how: str) -> None:
    file, notes = READ[how]
    assert is_message(file.encode())
    same(judged(file), *notes)


def test_joints_in_another_order_are_put_in_the_robots() -> None:
    turned = message(JOINTS[::-1])
    for each in turned["points"]:
        for key in ("positions", "velocities", "accelerations"):
            each[key] = each[key][::-1]
    same(judged(yaml_text(turned)))


def changed(change: Callable[[Made], Any]) -> str:
    made = message()
    change(made)
    return yaml_text(made)


def put(k: int, key: str, value: Any) -> Callable[[Made], Any]:
    return lambda made: made["points"][k].update({key: value})


TWO = yaml_text(message()) + "\n---\n"
CUT = yaml_text(message()).replace("- positions: " + str(point(10)["positions"]), "- '...'\n- positions: []")
REFUSED = {
    "two messages": (2 * TWO, "file", "2 trajectories: one in line 7, one in line 92", "one trajectory in a file"),
    "two robots": (
        yaml_text({"left": message(), "right": message()}),
        "file", "2 trajectories: left in line 8, right in line 93", "one trajectory in a file",
    ),
    "other joints": (yaml_text(message(("a", "b", "c", "j4"))), "joint_names", "a, b, c, j4", "j1, j2, j3, j4"),
    "fewer joints": (
        yaml_text({**message(), "joint_names": ["j1", "j2", "j3"],
                   "points": [{key: value[:3] if isinstance(value, list) else value for key, value in point(k).items()}
                              for k in range(11)]}),
        "joint_names", "j1, j2, j3", "the robot's joints, each once",
    ),
    "two prefixes": (
        yaml_text(message(("l_j1", "l_j2", "r_j3", "r_j4"))),
        "joint_names", "l_j1, l_j2, r_j3, r_j4", "one prefix or none",
    ),
    "a joint twice": (yaml_text(message(("j1", "j1", "j3", "j4"))), "joint_names", "j1, j1, j3, j4", "each once"),
    "other keys of time": (
        changed(put(0, "time_from_start", {"s": 0, "ns": 0})),
        "points[0].time_from_start", "{s: 0, ns: 0}", "sec and nanosec (or secs and nsecs)",
    ),
    "both keys of time": (
        changed(put(0, "time_from_start", {"nanosec": 0, "nsec": 0})),
        "points[0].time_from_start", "{nanosec: 0, nsec: 0}", "sec and nanosec",
    ),
    "a number for a time": (
        changed(put(3, "time_from_start", 0.3)), "points[3].time_from_start", 0.3, "sec and nanosec",
    ),
    "too many nanoseconds": (
        changed(put(3, "time_from_start", {"sec": 0, "nanosec": 3 * 10**9})),
        "points[3].time_from_start", "{sec: 0, nanosec: 3000000000}", "nanosec from 0 to 999999999",
    ),
    "no time": (
        changed(lambda made: made["points"][3].pop("time_from_start")), "points[3].time_from_start", None, "sec",
    ),
    "a late first point": (
        changed(lambda made: [each["time_from_start"].update(sec=1) for each in made["points"]]),
        "points[0].time_from_start", "1.0 s", "subtract this time from the times of all points",
    ),
    "no accelerations": (
        changed(lambda made: [each.update(accelerations=[]) for each in made["points"]]),
        "points[0].accelerations", None, "accelerations of j1 (j1_rad_s2 or j1_deg_s2 in CSV)",
    ),
    "accelerations at some points": (
        changed(put(4, "accelerations", [])), "points[4].accelerations", "0 numbers", "4 numbers, one for each joint",
    ),
    "another state only": (
        yaml_text({"header": {"frame_id": "a"}, "transforms": [{"x": 1}]}),
        "file", "messages with the keys header, transforms", "joint_names, points",
    ),
    "no names": (
        changed(lambda made: made.pop("joint_names")),
        "joint_names", "nothing, of the keys header, points", "names of joints",
    ),
    "joints with several axes": (
        yaml_text({"joint_names": ["a"], "points": [{"transforms": [{"x": 1}]}, {"transforms": [{"x": 1}]}]}),
        "points[0]", "transforms", "joints with one axis",
    ),
    "a message that was cut": (CUT, "points[10]", "'...', where the message was cut", "ros2 topic echo --full-length"),
    "lost messages": ("A message was lost!!!\n" + TWO, "file", "A message was lost", "a record without lost messages"),
    "a lift that is far": (
        changed(put(2, "positions", [0.0, 0.0, 250.0, 0.0])), "points[2].positions[2]", 250.0, "-100 to 100",
    ),
}  # fmt: skip


@pytest.mark.parametrize("how", REFUSED)
def test_what_is_ambiguous_or_wrong_is_refused_with_what_was_found(how: str) -> None:
    file, field, value, allowed = REFUSED[how]
    with pytest.raises(DocumentError) as caught:
        judged(file)
    assert caught.value.field == field
    assert value is None or caught.value.value == value
    assert allowed in caught.value.allowed
    assert "a list of" not in str(caught.value.value)
    assert "an object with" not in str(caught.value.value)


def test_where_a_motion_begins_elsewhere_than_the_request_that_is_said_and_by_how_much() -> None:
    verdict = judged(yaml_text(message(start=(0.2, START[1], 0.249, 0.0))))
    assert verdict["ok"]
    assert verdict["begins_off"] == [
        {"joint": "j1", "state": "position", "by": 0.2, "unit": "rad"},
        {"joint": "j3", "state": "position", "by": pytest.approx(0.001), "unit": "m"},
    ]
    told = [line for line in lines("x.yaml", verdict) if isinstance(line, str)]
    assert "begins 0.2 rad (j1), 0.001 m (j3) from the start of the request" in told
    assert not any("begins" in line for line in lines("x.yaml", plain()) if isinstance(line, str))


def test_a_motion_that_begins_faster_than_the_request_is_reported_too() -> None:
    moving = message()
    moving["points"] = [point(k) for k in range(5, 11)]
    for each in moving["points"]:
        k = each["time_from_start"]["sec"] * 10 + each["time_from_start"]["nanosec"] // 10**8 - 5
        each["time_from_start"] = {"sec": 0, "nanosec": k * 10**8}
    verdict = judged(yaml_text(moving))
    off = {(each["joint"], each["state"]): each["by"] for each in verdict["begins_off"]}
    assert off[("j1", "position")] == pytest.approx(0.25)
    assert off[("j1", "velocity")] == pytest.approx(0.9375)
    assert ("j2", "position") not in off


def test_digits_that_a_file_leaves_out_are_no_other_start() -> None:
    assert judged(yaml_text(message(start=(0.0, 1.0471975, 0.25, 0.0))))["begins_off"] == []
    assert len(judged(yaml_text(message(start=(0.0, 1.047, 0.25, 0.0))))["begins_off"]) == 1


def csv_of(title: str, first: int, digits: int, prefix: str = "") -> str:
    """The same motion in CSV, its times from `first` s on in a unit that is `digits` below the second."""
    units = ("rad", "rad", "m", "rad")
    titles = [
        f"{prefix}{name}_{unit}{rate}" for name, unit in zip(JOINTS, units, strict=True) for rate in ("", "_s", "_s2")
    ]
    rows = [";".join([title, *titles])]
    for k in range(11):
        states = [point(k)[key] for key in ("positions", "velocities", "accelerations")]
        time = str((10 * first + k) * 10 ** (digits - 1)) if digits else f"{first + k // 10}.{k % 10}"
        rows.append(";".join([time, *(repr(states[r][j]) for j in range(4) for r in range(3))]))
    return "# recorded\n" + "\n".join(rows) + "\n\n"


@pytest.mark.parametrize(
    ("file", "notes"),
    [
        (csv_of("time_s", 0, 0), []),
        (csv_of("t_ms", 0, 3, "line3_"), ["the names of the joints are read without 'line3_'"]),
        (csv_of("t_s", 1_700_000_000, 0), ["times count from the first row, 1700000000.0 s"]),
        (csv_of("timestamp", 1_700_000_000, 9), ["times count from the first row, 1700000000.000000000 s"]),
    ],
)
def test_the_same_reader_reads_csv_for_a_check(file: str, notes: list[str]) -> None:
    assert not is_message(file.encode())
    same(check_trajectory_document(CELL, {"file": file, "format": "csv"}), *notes)


def test_times_of_the_calendar_begin_where_the_question_says() -> None:
    late = {"file": csv_of("t_s", 1_700_000_000, 0), "format": "csv", "start_s": 2.5}
    assert check_trajectory_document(CELL, late)["start_s"] == 2.5
    with pytest.raises(InputError, match="the cell's clock"):
        check_trajectory_document(CELL, {**late, "file": csv_of("t_s", 0, 0)})


def joint_state(k: int, names: list[str], stamp: Made) -> Made:
    values = {name: 0.001 * k * (i + 1) for i, name in enumerate(JOINTS)}
    positions = [values[name.rpartition("/")[2]] for name in names]
    return {
        "header": {"stamp": stamp, "frame_id": ""},
        "name": names,
        "position": positions,
        "velocity": [],
        "effort": [],
    }


def states(count: int = 60, **change: Any) -> list[Made]:
    """A row of JointState messages, whose names come in either order."""
    names = [f"arm/{name}" for name in JOINTS]
    return [
        joint_state(k, names if k % 2 else names[::-1], {"sec": 1_700_000_000, "nanosec": 4_000_000 * k})
        for k in range(count)
    ]


@pytest.mark.parametrize("form", ["echo", "JSON lines", "rosbridge"])
def test_joint_states_are_a_log_of_the_robot(form: str) -> None:
    if form == "echo":
        file = "".join(f"{yaml_text(each)}\n---\n" for each in states())
    else:
        of = states() if form == "JSON lines" else [{"op": "publish", "topic": "/js", "msg": each} for each in states()]
        file = "\n".join(json.dumps(each) for each in of)
    log = parse_log(file.encode(), "echo.yaml")
    assert [joint.unit for joint in log.joints] == [None] * 4
    np.testing.assert_allclose(log.time, 0.004 * np.arange(60), atol=1e-15)
    found = fit_limits(log, robot=shipped_robot("mitsubishi-rh-6frh5520"))
    assert [(joint["name"], joint["unit"]) for joint in found["joints"]] == [
        ("j4", "rad"), ("j3", "m"), ("j2", "rad"), ("j1", "rad"),
    ]  # fmt: skip
    assert found["notes"] == [
        "60 JointState messages; only their positions are read",
        "times count from the first message, 1700000000.000000000 s",
        "the names of the joints are read without 'arm/'",
    ]
    for joint, i in zip(log.joints, (4, 3, 2, 1), strict=True):
        np.testing.assert_allclose(joint.position, 0.001 * i * np.arange(60))


def test_joint_states_that_are_no_log_are_refused() -> None:
    def refused(made: list[Made]) -> DocumentError:
        with pytest.raises(DocumentError) as caught:
            parse_log("".join(f"{yaml_text(each)}\n---\n" for each in made).encode(), "echo.yaml")
        return caught.value

    other = states()
    other[3]["name"] = ["wheel"]
    other[3]["position"] = [0.0]
    error = refused(other)
    assert (error.field, error.value) == ("name", "wheel")
    assert error.allowed.startswith("the joints of the first message: arm/j4")
    back = states()
    back[5]["header"]["stamp"] = {"sec": 1_699_999_999, "nanosec": 0}
    error = refused(back)
    assert (error.field, "later than the row before" in error.allowed) == ("header.stamp in s", True)
    no_stamp = states()
    no_stamp[0]["header"] = {"frame_id": "base"}
    assert refused(no_stamp).field == "header.stamp"


def test_joint_states_are_no_trajectory_for_a_check() -> None:
    file = "".join(f"{yaml_text(each)}\n---\n" for each in states())
    with pytest.raises(DocumentError, match="velocities of j1"):
        judged(file)


def test_a_trajectory_is_a_log_too() -> None:
    made = copy.deepcopy(message())
    made["points"] = [
        {**point(0), "time_from_start": {"sec": 0, "nanosec": 5_000_000 * k}, "velocities": [], "accelerations": []}
        for k in range(60)
    ]
    log = parse_log(yaml_text(made).encode(), "t.yaml")
    assert (len(log.time), [joint.name for joint in log.joints], log.notes) == (60, list(JOINTS), ())
