"""Arms as trees of links, and their motion as knots."""

from __future__ import annotations

from typing import Any

from assur.planner.errors import FaultError
from assur.planner.robots.elbow_arm import ElbowArm
from assur.planner.robots.five_axis_arm import FiveAxisArm
from assur.planner.robots.five_bar import FiveBar
from assur.planner.robots.polar_arm import PolarArm
from assur.planner.robots.robot import Robot
from assur.planner.robots.scara import Scara
from assur.planner.trajectory import Trajectory
from assur.scenes.bundle.unstated import unstated

Document = dict[str, Any]
NONE = (0.0, 0.0, 0.0)
UP, AHEAD = [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]


def arm_of(robot: Robot, path: Trajectory, begin: float, until: float) -> Document:
    """An arm that follows a trajectory, and stands before and after it, from `begin` to `until`, s.

    Raises `InputError` for a trajectory that does not rest at an end beyond which it is asked for.
    """
    time, q, qd, qdd = (getattr(path, name).tolist() for name in ("time", "q", "qd", "qdd"))
    still = [0.0] * path.n
    if begin < time[0]:
        if any(qd[0] + qdd[0]):
            raise unstated("a motion that is not at rest when it begins, and is needed before")
        time, q, qd, qdd = [begin, *time], [q[0], *q], [still, *qd], [still, *qdd]
    if until > time[-1]:
        if any(qd[-1] + qdd[-1]):
            raise unstated("a motion that is not at rest when it ends, and is needed after")
        time, q, qd, qdd = [*time, until], [*q, q[-1]], [*qd, still], [*qdd, still]
    return {"name": robot.name, "time": time, "q": q, "qd": qd, "qdd": qdd, **_chain(robot)}


def _chain(robot: Robot) -> Document:
    base, loop = robot.base, []
    links = [_Links(len(robot.joints)).link("base", -1, (base.x, base.y, base.z), base.yaw)]
    make = _Links(len(robot.joints), base.yaw)
    if isinstance(robot, Scara):
        rise = make.slide(2, UP) if robot.arms_rise else None
        lift = None if robot.arms_rise else make.slide(2, UP)
        links.append(make.link("link1", 0, NONE, joints=(0,), slide=rise))
        links.append(make.link("link2", 1, (robot.l1, 0.0, 0.0), joints=(0, 1)))
        links.append({**make.link("quill", 2, (robot.l2, 0.0, 0.0), slide=lift), "yaw": make.angle(0.0)})
        turned = (0, 1, 3)[: len(robot.joints) - 1]
        links.append(make.link("flange", 2, (robot.l2, 0.0, 0.0), joints=turned, slide=lift))
    elif isinstance(robot, FiveBar):
        loop.append(
            {
                "cranks": [1, 2],
                "lengths": list(robot.proximal),
                "couplers": list(robot.distal),
                "side": float(robot.sigma),
                "least": robot.parallel_least,
            }
        )
        half, lift = robot.separation / 2.0, make.slide(2, UP) if len(robot.joints) > 2 else None
        links.append(make.link("proximal-left", 0, (0.0, half, 0.0), joints=(0,)))
        links.append(make.link("proximal-right", 0, (0.0, -half, 0.0), joints=(1,)))
        links.append({**make.link("distal-left", 1, (robot.proximal[0], 0.0, 0.0), coupler=0), "yaw": make.angle(0.0)})
        links.append({**make.link("distal-right", 2, (robot.proximal[1], 0.0, 0.0), coupler=1), "yaw": make.angle(0.0)})
        end = (robot.distal[0], 0.0, 0.0)
        links.append({**make.link("quill", 3, end, slide=lift), "yaw": make.angle(0.0)})
        wrist = (3,) if len(robot.joints) > 3 else ()
        links.append({**make.link("flange", 3, end, slide=lift, coupler=0), "yaw": make.angle(0.0, wrist)})
    elif isinstance(robot, FiveAxisArm | ElbowArm | PolarArm):
        links.append(make.link("link1", 0, (0.0, 0.0, robot.height), joints=(0,)))
        links.append(make.link("link2", 1, NONE, joints=(0,), pitch=(1,)))
        if isinstance(robot, PolarArm):
            out = make.slide(2, AHEAD)
            links.append(make.link("link3", 2, NONE, joints=(0,), pitch=(1,), slide=out))
            links.append(make.link("flange", 2, NONE, joints=(0,), pitch=(1,), slide=out))
        else:
            links.append(make.link("link3", 2, (robot.l1, 0.0, 0.0), joints=(0,), pitch=(1, 2)))
            end = (robot.l2, 0.0, 0.0)
            if isinstance(robot, FiveAxisArm):
                links.append(make.link("link4", 3, end, joints=(0,), pitch=(1, 2, 3)))
                hand = make.link("flange", 4, (robot.l3, 0.0, 0.0), joints=(0,), pitch=(1, 2, 3))
                links.append({**hand, "roll": make.angle(0.0, (4,))})
            else:
                links.append(make.link("flange", 3, end, joints=(0,), pitch=(1, 2)))
    else:
        raise unstated(f"the kinematics of {robot.name}")
    if sorted(link["name"] for link in links) != sorted(robot.links):
        raise FaultError(f"links of {robot.name}")
    return {"links": links, "loop": loop}


def link_number(robot: Robot, link: int) -> int:
    """The number in a bundle of a link of an arm: those of a closed chain come after both cranks."""
    return {2: 3, 3: 2}.get(link, link) if isinstance(robot, FiveBar) else link


class _Links:
    """Links of an arm with `n` joints, whose yaws count from `yaw`."""

    def __init__(self, n: int, yaw: float = 0.0) -> None:
        self.n, self.yaw = n, yaw

    def angle(self, constant: float, joints: tuple[int, ...] = ()) -> Document:
        """The sum of some joints."""
        return {"constant": constant, "joints": [1.0 if j in joints else 0.0 for j in range(self.n)]}

    @staticmethod
    def slide(joint: int, axis: list[float]) -> Document:
        return {"joint": joint, "axis": axis}

    def link(
        self,
        name: str,
        parent: int,
        offset: tuple[float, float, float],
        yaw: float | None = None,
        *,
        joints: tuple[int, ...] = (),
        pitch: tuple[int, ...] = (),
        slide: Document | None = None,
        coupler: int = -1,
    ) -> Document:
        tilts = bool(pitch)
        return {
            "name": name,
            "parent": parent,
            "offset": list(offset),
            "slide": slide,
            "yaw": self.angle(self.yaw if yaw is None else yaw, joints),
            "pitch": self.angle(0.0, pitch) if tilts else None,
            "roll": self.angle(0.0) if tilts else None,
            "coupler": coupler,
        }
