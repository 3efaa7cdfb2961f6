"""A motion as text: CSV, and `trajectory_msgs/JointTrajectory` of ROS 2 as YAML or JSON."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from assur.scenes.exports.export import Motion, columns, statement

NANOS = 1_000_000_000


def csv_text(motion: Motion) -> str:
    """Comma-separated values: lines that begin with # say what it is, then a header, then a row for each point.

    `time_s` is the cell's clock; then of each joint its position, its velocity and its acceleration, in deg or mm.
    """
    time, *states = columns(motion)
    header, scaled = ["time_s"], [time]
    for i, joint in enumerate(motion.cell.conventions):
        unit = "deg" if joint.kind == "revolute" else "mm"
        for state, rate in zip(states, ("", "_s", "_s2"), strict=True):
            header.append(f"{joint.name}_{unit}{rate}")
            scaled.append(np.degrees(state[:, i]) if unit == "deg" else state[:, i] * 1000.0)
    rows = np.stack(scaled, 1).tolist()
    lines = [f"# {line}" for line in statement(motion)]
    lines += [",".join(header), *(",".join(map(repr, row)) for row in rows)]
    return "\n".join(lines) + "\n"


def ros2_message(motion: Motion) -> dict[str, Any]:
    """The message: times since the start in whole nanoseconds, joints as their maker counts them, rad and m.

    With a lead a motion that begins at rest stands for so long first: the first point is at 0 s, as without.
    """
    time, *states = columns(motion)
    since = np.rint((time - time[0]) * NANOS).astype(np.int64)
    lead = 0 if motion.handover is None else round(motion.handover.lead_s * NANOS)
    if lead:
        since += lead
        if not (states[1][0].any() or states[2][0].any()):
            since, *states = (
                np.concatenate([first, each])
                for first, each in ((since[:1] - lead, since), *((each[:1], each) for each in states))
            )
    keys, points = ("positions", "velocities", "accelerations"), []
    for nanos, *rows in zip(since.tolist(), *(state.tolist() for state in states), strict=True):
        stamp = {"sec": nanos // NANOS, "nanosec": nanos % NANOS}
        points.append({**dict(zip(keys, rows, strict=True)), "time_from_start": stamp})
    return {
        "header": {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""},
        "joint_names": [joint.name for joint in motion.cell.conventions],
        "points": points,
    }


def ros2_yaml(motion: Motion) -> str:
    """The message as YAML, as `ros2 topic pub` reads it; comments say what it is."""
    message = ros2_message(motion)
    lines = [f"# {line}" for line in statement(motion)]
    lines += ["header:", "  stamp: {sec: 0, nanosec: 0}", "  frame_id: ''"]
    lines += [f"joint_names: [{', '.join(message['joint_names'])}]", "points:"]
    for point in message["points"]:
        since = point["time_from_start"]
        for mark, key in (("- ", "positions"), ("  ", "velocities"), ("  ", "accelerations")):
            lines.append(f"{mark}{key}: [{', '.join(map(_yaml, point[key]))}]")
        lines.append(f"  time_from_start: {{sec: {since['sec']}, nanosec: {since['nanosec']}}}")
    return "\n".join(lines) + "\n"


def _yaml(value: float) -> str:
    """A number that YAML 1.1 takes for one, too: 1e-05 would be text there."""
    text = repr(value)
    if "e" in text and "." not in text:
        mantissa, _, exponent = text.partition("e")
        return f"{mantissa}.0e{exponent}"
    return text


def ros2_json(motion: Motion) -> str:
    """The message as JSON. The export describes the file, since a message has no field for that."""
    return json.dumps(ros2_message(motion), allow_nan=False, indent=None) + "\n"
