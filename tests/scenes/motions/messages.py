"""Messages of ROS for the tests: a smooth motion of a shipped arm in a bare cell, as ROS writes it."""

from __future__ import annotations

from typing import Any

JOINTS = ("j1", "j2", "j3", "j4")
START = (0.0, 1.0471975511965976, 0.25, 0.0)
CELL: dict[str, Any] = {
    "schema": "assur/1",
    "robot": {"model": "mitsubishi-rh-6frh5520", "tool": {"tcp_mm": [0, 0, -100]}},
    "start": {"joints": {"j1_deg": 0, "j2_deg": 60, "j3_mm": 250, "j4_deg": 0}},
    "bodies": [
        {
            "name": "post",
            "shape": {"cylinder": {"radius_mm": 20, "height_mm": 300}},
            "pose": {"at_mm": [-300, -300, 150]},
        }
    ],
    "task": [{"move": {"to": {"at_mm": [400, 0, 150]}}}],
}


def point(k: int, start: tuple[float, ...] = START) -> dict[str, Any]:
    """Point k of 0 to 10 of a motion of 1 s in which j1 turns by 0.5 rad and j4 by 0.3 rad."""
    s = k / 10
    x = [10 * s**3 - 15 * s**4 + 6 * s**5, 30 * s**2 - 60 * s**3 + 30 * s**4, 60 * s - 180 * s**2 + 120 * s**3]
    turned = [[0.5 * each, 0.0, 0.0, 0.3 * each] for each in x]
    return {
        "positions": [a + b for a, b in zip(start, turned[0], strict=True)],
        "velocities": turned[1],
        "accelerations": turned[2],
        "effort": [],
        "time_from_start": {"sec": k // 10, "nanosec": k % 10 * 10**8},
    }


def message(joints: tuple[str, ...] = JOINTS, start: tuple[float, ...] = START) -> dict[str, Any]:
    """A trajectory_msgs/JointTrajectory."""
    header = {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""}
    return {"header": header, "joint_names": list(joints), "points": [point(k, start) for k in range(11)]}


def yaml_text(value: Any, indent: str = "") -> str:
    """A message as ROS prints it: a key or an item in each line."""
    lines = []
    for key, item in value.items():
        if isinstance(item, dict):
            lines += [f"{indent}{key}:", yaml_text(item, indent + "  ")]
        elif isinstance(item, list) and item and isinstance(item[0], dict):
            lines.append(f"{indent}{key}:")
            for each in item:
                inner = yaml_text(each, indent + "  ")
                lines.append(f"{indent}- {inner[len(indent) + 2 :]}")
        else:
            shown = "''" if item == "" else str(item).replace("'", "") if isinstance(item, list) else repr(item)
            lines.append(f"{indent}{key}: {shown}")
    return "\n".join(lines)
