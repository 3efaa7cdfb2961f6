"""Limits of acceleration and jerk, found in a log of recorded motion: as a document, and as a part to paste into a
robot's file and a request.

A part holds the lower end of what was found: a plan that keeps it keeps the limit itself.
"""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from assur.scenes.catalogue import RobotFile
from assur.scenes.faults import DocumentError, likeliest
from assur.scenes.motion_log import LoggedJoint, MotionLog, load_log
from assur.scenes.motions.motion import matched
from assur.scenes.units import TWIN_UNITS, to_si

if TYPE_CHECKING:
    from assur.scenes.identification.limits import Estimate, JointLimits

RATES = {"acceleration": "_s2", "jerk": "_s3"}
"""What is found of a joint, and the end of its unit."""
DIGITS = 4
"""Digits of the numbers in a part."""
WHY = {
    "STILL": "the joint hardly moved",
    "NO_MOVES": "no moves from rest to rest: after at most 6 moves the joint must stand still for 30 ms",
    "MISFIT": "the readings are not those of moves of constant jerk behind a servo that lags by first order",
    "UNCERTAIN": "the readings are too coarse, too far apart, or too few",
    "NO_PLATEAU": "it was reached, but not held: longer moves are needed",
    "ONE_LENGTH": "only moves of one length show it: moves of other lengths are needed",
    "IN_PROPORTION": "another joint moves in proportion, and may be the one at its limit: the joint must move alone",
    "LEVELS": "some moves go beyond what the others share",
    "ASYMMETRIC": "speeding up and braking differ, or one of them is too short for a plateau",
}
"""Why a limit is not identified, by the reason."""


def fit_limits(
    log: str | Path | MotionLog, *, commanded: bool = False, robot: RobotFile | None = None
) -> dict[str, Any]:
    """What a log says of the limits of each joint: `assur fit-limits --json` prints it, docs/robots.md explains it.

    `commanded`: the log holds commanded positions, behind which no servo lags. `robot`: whose joints they are; its own
    numbers are then in the document, and `limits` by which a request narrows them.
    Raises `DocumentError` with column and line, or `OSError` for a file that cannot be read.
    """
    from assur.scenes.identification.limits import joint_limits
    from assur.scenes.identification.recording import JointRecord

    if not isinstance(log, MotionLog):
        log = load_log(Path(log))
    known: dict[str, dict[str, float]] = {}
    if robot is None:
        _check_units(log)
    else:
        log, known = _of_robot(log, robot)
    records = [JointRecord(log.time, joint.position) for joint in log.joints]
    joints = []
    for i, joint in enumerate(log.joints):
        found = joint_limits(records[i], [*records[:i], *records[i + 1 :]], not commanded)
        joints.append(_joint(joint.name, str(joint.unit), found, known.get(joint.name, {})))
    duration = float(log.time[-1])
    document: dict[str, Any] = {
        "log": {"file": log.name, "rows": len(log.time), "duration_s": duration, "step_s": records[0].step},
        "notes": list(log.notes),
        "positions": "commanded" if commanded else "measured",
        "joints": joints,
    }
    if robot is not None:
        document |= {"robot": robot.listed()["model"], "limits": _limits(joints)}
        logged = {joint["name"] for joint in joints}
        document["not_logged"] = [
            _not_logged(joint) for joint in robot.listed()["joints"] if joint["name"] not in logged
        ]
    return document


def _check_units(log: MotionLog) -> None:
    """Raises `DocumentError` for a log that does not say which joints turn: nobody else knows it without a robot."""
    for logged in log.joints:
        if logged.unit is None:
            allowed = "a robot (--robot) that says which joints turn: messages of ROS have rad and m alike"
            raise DocumentError(log.name, f"{logged.name} without a unit", allowed)


def _of_robot(log: MotionLog, robot: RobotFile) -> tuple[MotionLog, dict[str, dict[str, float]]]:
    """The log with the robot's own names and units of its joints, and their acceleration and jerk in SI. Raises
    `DocumentError` for a joint that it has not."""
    joints = {joint["name"]: joint for joint in robot.listed()["joints"]}
    found = matched([logged.name for logged in log.joints], joints)
    if found is None:
        name = next((each.name for each in log.joints if each.name not in joints), log.joints[0].name)
        allowed = f"a joint of the robot: {likeliest(name, joints)}; all may have one prefix"
        raise DocumentError(f"{log.name}: column", name, allowed, 1)
    named = []
    for logged, name in zip(log.joints, found[0], strict=True):
        units = ("rad", "deg") if joints[name]["kind"] == "revolute" else ("m", "mm")
        if logged.unit not in (None, *units):
            allowed = f"{' or '.join(units)}, for this joint of the robot"
            raise DocumentError(f"{log.name}: column {logged.name}", logged.unit, allowed, 1)
        named.append(LoggedJoint(name, units[0], logged.position))
    if found[1]:
        log = replace(log, notes=(*log.notes, f"the names of the joints are read without {found[1]!r}"))
    known = {name: {rate: _in_si(joint[rate]) for rate in RATES} for name, joint in joints.items()}
    return replace(log, joints=tuple(named)), known


def _not_logged(joint: dict[str, Any]) -> dict[str, Any]:
    """A joint of the robot that is not in the log: it keeps the limits of the robot's document."""
    own = {rate: {"of_robot": _in_si(joint[rate]), "unit": _si_unit(joint[rate]["unit"])} for rate in RATES}
    return {"name": joint["name"], **own}


def _si_unit(unit: str) -> str:
    return TWIN_UNITS.get(unit, unit)


def kept(document: dict[str, Any]) -> list[str]:
    """A sentence for each joint of the robot that is not in the log: what it keeps, and what the scales of `limits` do
    to it."""
    scales, found = document.get("limits", {}), []
    for joint in document.get("not_logged", ()):
        own = []
        for rate in RATES:
            value, unit = joint[rate]["of_robot"], joint[rate]["unit"].replace("_", "/")
            scaled = f", with the scale {value * scales[rate]:.{DIGITS}g}" if rate in scales else ""
            own.append(f"{rate} {value:.{DIGITS}g} {unit}{scaled}")
        found.append(f"{joint['name']} is not in the log and keeps the limits of the robot: {'; '.join(own)}")
    return found


def _in_si(quantity: dict[str, Any]) -> float:
    value, unit = quantity["value"], quantity["unit"]
    return float(to_si(value, unit) if unit in TWIN_UNITS else value)  # type: ignore[arg-type]


def _joint(name: str, unit: str, found: JointLimits, known: dict[str, float]) -> dict[str, Any]:
    step = found.encoder_step
    return {
        "name": name,
        "unit": unit,
        "velocity": {"status": "lower_bound", "value": found.velocity, "unit": f"{unit}_s"},
        **{rate: _estimate(rate, unit, getattr(found, rate), known) for rate in RATES},
        "encoder_step": None if step is None else {"value": step, "unit": unit},
        "deviation": {"value": found.deviation, "unit": unit},
        "time_error_s": found.time_error_s,
        "lag_s": None if found.lag_s is None else list(found.lag_s),
        "segments": {"found": found.segments, "fitted": found.fitted, "explained": found.explained},
    }


def _estimate(rate: str, unit: str, found: Estimate, known: dict[str, float]) -> dict[str, Any]:
    """A limit with the word that says what it is; `of_robot`: what the robot's own document has."""
    estimate: dict[str, Any] = {"status": found.status, "value": found.value, "error": found.error}
    estimate |= {"unit": unit + RATES[rate], "moves": found.moves, "reason": found.reason}
    estimate["sentence"] = None if found.reason is None else WHY[found.reason]
    return estimate | ({"of_robot": known[rate]} if known else {})


def _lower_end(estimate: dict[str, Any]) -> float | None:
    """The number that a part holds, of an identified limit, with few digits and never above what was found."""
    if estimate["status"] != "identified":
        return None
    low = estimate["value"] - estimate["error"]
    grain = 10.0 ** (math.floor(math.log10(low)) + 1 - DIGITS)
    return float(f"{math.floor(low / grain) * grain:.{DIGITS}g}")


def _limits(joints: list[dict[str, Any]]) -> dict[str, float]:
    """Scales by which a request keeps all limits that were found, where they are below the robot's."""
    scales = {}
    for rate in RATES:
        found = [(_lower_end(joint[rate]), joint[rate]["of_robot"]) for joint in joints]
        least = min((low / own for low, own in found if low is not None), default=1.0)
        if least < 1:
            scales[rate] = math.floor(least * 1000) / 1000
    return scales


def part(document: dict[str, Any]) -> str:
    """YAML to paste: what belongs into each joint of a robot's file, and the `limits` of a request's robot, if there
    are any."""
    file = document["log"]["file"]
    lines = [
        f"# Found by assur fit-limits in {json.dumps(file)}, from {document['positions']} positions.",
        "# For the joints of a robot's file, in place of their acceleration and jerk. Values are lower ends.",
        "joints:",
    ]
    for joint in document["joints"]:
        name = joint["name"]
        lines.append(f"  - name: {name if name.isalnum() else json.dumps(name)}")
        for rate in RATES:
            estimate = joint[rate]
            low = _lower_end(estimate)
            if low is None:
                lines.append(f"    # {rate}: {in_words(estimate)}; {estimate['sentence']}")
            else:
                source = json.dumps(f"{file}: {in_words(estimate)} in {estimate['moves']} moves; the lower end")
                lines.append(f"    {rate}_{estimate['unit']}: {{value: {low:g}, status: measured, source: {source}}}")
    if document.get("limits"):
        scales = ", ".join(f"{rate}: {scale:g}" for rate, scale in document["limits"].items())
        lines += [f"# For the robot of a request, with model {document['robot']} as it is; each holds for all joints:"]
        lines += [*(f"# {sentence}" for sentence in kept(document)), f"limits: {{{scales}}}"]
    return "\n".join(lines) + "\n"


def in_words(estimate: dict[str, Any], *, unit: bool = True) -> str:
    """A limit in words, in SI: 40.1 +- 0.2 rad/s2."""
    of = f" {estimate['unit'].replace('_', '/')}" * unit
    if estimate["status"] == "identified":
        return f"{estimate['value']:.{DIGITS}g} +- {estimate['error']:.2g}{of}"
    return "not identifiable" if estimate["value"] is None else f"at least {estimate['value']:.{DIGITS}g}{of}"
