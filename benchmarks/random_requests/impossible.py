"""Random small requests, in SI. Many cannot be planned: by much, by little, or only in appearance."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from benchmarks.judge.arms import Arm, robot_file, tilt
from benchmarks.judge.poses import Document, Floats, si
from benchmarks.random_requests.drafts import FIVE_BAR, SCARAS, THREE_AXES, TILTING, Choices, finished

UPRIGHT = (*SCARAS, THREE_AXES, FIVE_BAR)
SMALL = (0.0, 1e-15, 1e-12, 1e-10, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0)
"""By how much a requirement is missed or kept, m or rad."""


class SmallRequest(Choices):
    """A request that is being written: an arm with a tool, at rest somewhere within its ranges, nothing around it."""

    def __init__(self, rng: np.random.Generator, models: tuple[str, ...], tool: bool = False) -> None:
        self.rng, self.model = rng, str(rng.choice(models))
        robot: Document = {"model": self.model, "tool": {"tcp_m": [0.0, 0.0, 0.0]}}
        if self.chance(0.5):
            robot["base"] = {"at_m": self.round(rng.uniform(-0.5, 0.5, 3)), "yaw_rad": float(rng.uniform(-3, 3))}
        if self.model in UPRIGHT:
            self.length = 0.001 * int(rng.integers(0, 80))
            down = next(iter(robot_file(self.model).values())).get("tool_frame") == "z_down"
            aside = 0.001 * int(rng.integers(-40, 40)) if self.chance(0.2) and self.model != THREE_AXES else 0.0
            robot["tool"]["tcp_m"] = [aside, 0.0, self.length if down else -self.length]
            if tool:
                z = self.length / 2.0 if down else -self.length / 2.0
                shape = self.one_of(
                    {"cylinder": {"radius_m": 0.01, "height_m": self.length + 0.02}},
                    {"box": {"size_m": [0.03, 0.012, self.length + 0.02]}},
                    {"sphere": {"radius_m": 0.015}},
                )
                robot["tool"]["bodies"] = [{"name": "cup", "shape": shape, "at_m": [0.0, 0.0, z]}]
        self.arm = Arm.of(robot)
        self.q = self.joints()
        self.request: Document = {
            "schema": "assur/1",
            "robot": robot,
            "start": {"at_s": self.one_of(0.0, 0.0, 3.5), "joints": self.arm.named(self.q)},
            "frames": {},
            "bodies": [],
            "task": [],
            "options": {
                "seed": int(rng.integers(100)),
                "budget_s": 60,
                "max_candidates": int(rng.integers(1, 4)),
                "stop": "first",
                "report": "full",
                "elbow": self.one_of("auto", "auto", "keep"),
                "singularity_margin": self.one_of(0.0, 0.05),
            },
        }

    def round(self, values: Floats) -> list[float]:
        """Whole millimetres, or as they are."""
        return [round(float(v), 3) if self.chance(0.7) else float(v) for v in values]

    def off(self) -> float:
        """By how much, either way."""
        return float(self.one_of(*SMALL) * self.one_of(-1.0, 1.0, 1.0))

    def joints(self, share: float = 0.7) -> Floats:
        middle, half = (self.arm.lower + self.arm.upper) / 2.0, (self.arm.upper - self.arm.lower) / 2.0
        while True:
            q = middle + half * self.rng.uniform(-share, share, len(half))
            if self.arm.family == "five_bar":
                q[0], q[1] = self.rng.uniform(0.4, 1.5), -self.rng.uniform(0.4, 1.5)
            if np.isfinite(self.arm.links(q)["flange"].p).all():
                return np.asarray(q)

    def target(self, q: Floats, yaw: bool = True) -> Document:
        """Where the tool is with these joints, in the world."""
        place, links = self.arm.tool(q), self.arm.links(q)
        found: Document = {"at_m": [float(x) for x in place.p]}
        if self.arm.turns:
            found |= {"yaw_rad": float(place.yaw)} if yaw else {"yaw_free": True}
        if "link4" in links:
            found["pitch_rad"], found["roll_rad"] = (float(angle) for angle in tilt(links))
        return found

    def move(self, to: Document) -> Document:
        """A step to a target: a move or a follow."""
        if self.chance(0.3):
            if self.arm.turns and "yaw_rad" not in to:
                to["yaw_free"] = True
            return {"follow": {"to": to, "duration_s": self.one_of(0.0, 0.1)}}
        return {"move": {"to": to, **({"match": "position"} if self.chance(0.3) else {})}}


def at_the_edge_of_reach(rng: np.random.Generator) -> SmallRequest:
    """A fixed point, near the end of the reach or of the lift."""
    cell = SmallRequest(rng, (*UPRIGHT, *TILTING))
    to = cell.target(cell.joints(), yaw=cell.chance(0.5))
    base, angle = cell.arm.base, float(rng.uniform(-2.0, 2.0))
    if cell.arm.family == "scara":
        l1, l2 = cell.arm.length("l1"), cell.arm.length("l2")
        edge = (l1 + l2 if cell.chance(0.7) else abs(l1 - l2)) + cell.off()
    elif cell.arm.family == "polar_arm":
        edge = float(cell.one_of(cell.arm.lower[2], cell.arm.upper[2])) + cell.off()
    else:
        edge = float(rng.uniform(0.1, 0.7)) + cell.off()
    if cell.chance(0.6):
        x, y = base.p[0] + edge * math.cos(base.yaw + angle), base.p[1] + edge * math.sin(base.yaw + angle)
        to["at_m"][:2] = cell.round(np.array([x, y])) if cell.chance(0.2) else [float(x), float(y)]
    if cell.arm.turns and cell.chance(0.5):
        lift = int(np.argmin(cell.arm.upper - cell.arm.lower))
        q = cell.joints()
        q[lift] = cell.one_of(cell.arm.lower[lift], cell.arm.upper[lift]) + cell.off()
        to["at_m"][2] = cell.round(cell.arm.tool(q).p[2:])[0]
    elif cell.arm.tilts:
        above = float(rng.uniform(-0.3, 0.4)) * float(cell.chance(0.7))
        to["at_m"][2] = float(base.p[2]) + cell.arm.length("height") + above
    if cell.arm.family == "five_axis_arm" and cell.chance(0.5):
        to.pop("pitch_rad")
    cell.request["task"].append(cell.move(to))
    return cell


def at_the_end_of_a_range(rng: np.random.Generator) -> SmallRequest:
    """A point that is met with a joint about at the end of its range."""
    cell = SmallRequest(rng, (*UPRIGHT, *TILTING))
    limits = cell.request["robot"].setdefault("limits", {})
    j = int(rng.integers(len(cell.arm.names)))
    q = cell.joints(0.6)
    lower, upper = float(cell.arm.lower[j]), float(cell.arm.upper[j])
    slides = upper - lower < 0.5
    if cell.chance(0.5) and cell.arm.family != "five_bar":
        high = lower + (upper - lower) * float(rng.uniform(0.6, 0.95))
        upper = round(high, 3) if slides else math.radians(round(math.degrees(high)))
        limits[f"{cell.arm.names[j]}_{'m' if slides else 'rad'}"] = [lower, upper]
        cell.arm = Arm.of(cell.request["robot"])
        cell.q = cell.joints()
        cell.request["start"]["joints"] = cell.arm.named(cell.q)
        q = cell.joints(0.6)
    q[j] = cell.one_of(lower, upper) + cell.off()
    if not np.isfinite(cell.arm.tool(q).p).all():
        q[j] = (lower + upper) / 2.0
    cell.request["task"].append(cell.move(cell.target(q, yaw=cell.chance(0.8))))
    return cell


def in_a_window(rng: np.random.Generator) -> SmallRequest:
    """A point on a belt or a linear frame that stops, turns back, or is known for some time only."""
    cell = SmallRequest(rng, (*SCARAS, THREE_AXES))
    to, start = cell.target(cell.joints(0.5), yaw=False), cell.request["start"]["at_s"]
    heading = float(rng.uniform(-3, 3))
    travel = float(rng.uniform(-1.0, 1.0)) * cell.one_of(0.1, 0.6, 5.0)
    along = np.array([math.cos(heading), math.sin(heading), 0.0])
    at = np.array(to["at_m"]) - travel * along
    speed = cell.one_of(0.0, 0.001, 0.05, 0.25, 1.0) * cell.one_of(-1.0, 1.0, 1.0)
    law: Document = {"at_m": [float(x) for x in at], "yaw_rad": heading, "speed_m_s": speed}
    law["at_s"] = start + float(rng.uniform(-1.0, 1.0))
    time = law["at_s"]
    changes = []
    for _ in range(int(rng.integers(0, 4))):
        time += cell.one_of(0.5, 2.0, 20.0, 70.0, 200.0) * float(rng.uniform(0.5, 1.5))
        changes.append(
            {
                "at_s": time,
                "speed_m_s": cell.one_of(0.0, 0.05, -0.05, 0.25, -0.25),
                "acceleration_m_s2": 1.0,
                "jerk_m_s3": 100.0,
            }
        )
        time += 2.5
    if changes:
        law["changes"] = changes
    frame: Document = {"conveyor": law}
    if cell.chance(0.35):
        frame["valid_s"] = [start + cell.one_of(-10.0, 0.5), start + cell.one_of(0.1, 0.6, 2.0, 30.0, 100.0)]
    if cell.chance(0.15):
        velocity = [float(speed * along[0]), float(speed * along[1]), 0.0]
        law.pop("changes", None)
        frame = {**frame, "linear": {**{k: law[k] for k in ("at_m", "yaw_rad", "at_s")}, "velocity_m_s": velocity}}
        frame.pop("conveyor")
    cell.request["frames"]["belt"] = frame
    step: Document = {"to": {**to, "frame": "belt", "at_m": [0.0, 0.0, 0.0]}}
    if cell.arm.turns:
        step["to"]["yaw_free"] = True
    if cell.chance(0.75):
        width = cell.one_of(0.0, 1e-6, 0.001, 0.05, 0.3)
        begin = travel + float(rng.uniform(-0.3, 0.3))
        if "conveyor" in frame:
            step["window_m"] = [begin, begin + width]
    if cell.chance(0.4):
        opens = start + cell.one_of(-3.0, 0.0, 1.0, 10.0)
        step["window_s"] = [opens, opens + cell.one_of(0.05, 0.5, 2.0, 5.0)]
    if cell.chance(0.15):
        cell.request["options"]["latest_end_s"] = start + cell.one_of(0.01, 0.5, 4.0)
    cell.request["task"].append({"follow": {**step, "duration_s": cell.one_of(0.0, 0.05, 0.2, 1.0, 3.0)}})
    if cell.chance(0.3):
        cell.request["frames"]["cart"] = {
            "linear": {"at_m": [5.0, 5.0, 0.0], "velocity_m_s": [0.1, 0.0, 0.0]},
            "valid_s": [start - 20.0, start + cell.one_of(-10.0, 1.0)],
        }
        if cell.chance(0.4):
            box = {"box": {"size_m": [0.1, 0.1, 0.1]}}
            pose = {"frame": "cart", "at_m": [0.0, 0.0, 0.0]}
            cell.request["bodies"].append({"name": "crate", "shape": box, "pose": pose})
    return cell


def never_near(rng: np.random.Generator) -> SmallRequest:
    """A point on a frame that repeats its motion, about as near as the links end."""
    cell = SmallRequest(rng, (*SCARAS, THREE_AXES))
    assert not cell.arm.tilts
    reach = cell.arm.length("l1") + cell.arm.length("l2")
    z, base = float(cell.arm.tool(cell.joints()).p[2]), cell.arm.base.p
    r, period = float(rng.uniform(0.02, 0.4)), float(rng.uniform(0.3, 4.0))
    far = reach + r + cell.off()
    angle, amplitude = float(rng.uniform(-1.5, 1.5)) + float(cell.arm.base.yaw), float(rng.uniform(0.2, 1.5))
    middle = [float(base[0] + far * math.cos(angle)), float(base[1] + far * math.sin(angle)), z]
    kind, at = cell.one_of("turntable", "swing", "oscillation", "keyframes"), [r, 0.0, 0.0]
    if kind == "turntable":
        law: Document = {"at_m": middle, "rate_rad_s": cell.one_of(-1.0, 1.0) * 2.0 * math.pi / period}
    elif kind == "swing":
        yaw = angle + math.pi + cell.one_of(0.0, amplitude, float(rng.uniform(-2, 2)))
        law = {"pivot_m": middle, "yaw_rad": yaw, "amplitude_rad": amplitude, "period_s": period}
    elif kind == "oscillation":
        way = [math.cos(angle), math.sin(angle), 0.0]
        law, at = {"at_m": middle, "direction": way, "amplitude_m": r, "period_s": period}, [0.0, 0.0, 0.0]
    else:
        other = [middle[0] - r * math.cos(angle), middle[1] - r * math.sin(angle), z]
        points = [{"time_s": t, "at_m": p} for t, p in ((0.0, middle), (period / 2, other), (period, middle))]
        law, at = {"repeat": True, "points": points}, [0.0, 0.0, 0.0]
    cell.request["frames"]["mover"] = {kind: law}
    to: Document = {"frame": "mover", "at_m": at, **({"yaw_free": True} if cell.arm.turns else {})}
    cell.request["task"].append(cell.move(to))
    return cell


def near_a_body(rng: np.random.Generator) -> SmallRequest:
    """A body about so near to the tool at a point, or to the arm at the start, as is allowed."""
    cell = SmallRequest(rng, SCARAS, tool=True)
    q = cell.joints(0.5)
    to, at_start = cell.target(q, yaw=cell.chance(0.7)), cell.chance(0.35)
    travel, near = cell.one_of(0.0, 0.002, 0.01), cell.one_of(0.0, 0.001)
    cell.request["options"]["clearance_m"] = {"travel": travel, "near": near}
    place = cell.arm.tool(cell.q if at_start else q)
    half = float(rng.uniform(0.01, 0.05))
    shape = cell.one_of({"box": {"size_m": [2 * half] * 3}}, {"sphere": {"radius_m": half}})
    kept = cell.one_of(travel, near) + cell.off()
    # below the tool: the tool point is the lowest of it where its bodies end there
    at = [float(place.p[0]), float(place.p[1]), float(place.p[2]) - 0.01 - half - kept]
    if cell.chance(0.4):
        at = [float(v) for v in place.p + rng.uniform(-0.06, 0.06, 3)]
    cell.request["bodies"].append({"name": "block", "shape": shape, "pose": {"at_m": at}})
    step: Document = cell.move(to)
    cell.request["task"].append(step)
    return cell


def picked(rng: np.random.Generator) -> SmallRequest:
    """A part on a plate, which may be too high; or the tool is too long for the surroundings."""
    cell = SmallRequest(rng, SCARAS, tool=True)
    place = cell.arm.tool(cell.joints(0.5))
    half, z = [float(v) for v in rng.uniform(0.008, 0.02, 3)], float(place.p[2])
    shape = cell.one_of(
        {"box": {"size_m": [2 * v for v in half]}}, {"cylinder": {"radius_m": 0.01, "height_m": 2 * half[2]}}
    )
    at, yaw = [float(place.p[0]), float(place.p[1]), z - half[2]], float(rng.uniform(-3, 3))
    part = {"name": "part", "shape": shape, "pose": {"at_m": at, "yaw_rad": yaw}, "mass_kg": cell.one_of(0.0, 0.2)}
    part["yaw_symmetry"] = cell.one_of(0, 1, 2, 4)
    plate_z = z - 2.0 * half[2] - 0.01 + cell.one_of(0.0, 0.0, cell.off())
    plate = {"name": "plate", "shape": {"box": {"size_m": [0.1, 0.1, 0.02]}}, "pose": {"at_m": [at[0], at[1], plate_z]}}
    cell.request["bodies"] += [plate, part]
    cell.request["options"]["clearance_m"] = {"travel": cell.one_of(0.0, 0.002), "near": cell.one_of(0.0, 0.001)}
    if cell.chance(0.6):
        aside = {"name": "wall", "shape": {"box": {"size_m": [0.01, 0.1, 0.2]}}}
        gap = 0.015 + abs(cell.off())
        aside["pose"] = {"at_m": [at[0] + max(half[0], 0.015) + gap, at[1], z]}
        cell.request["bodies"].append(aside)
    straight = {"m": cell.one_of(0.005, 0.02, 0.1)}
    pick: Document = {
        "part": "part", "grasp_m": [0.0, 0.0, half[2] + cell.one_of(0.0, 0.012, cell.off() * 0.01)],
        "approach": straight, "depart": straight, "dwell_s": 0.05, "contact_with": ["plate"],
    }  # fmt: skip
    cell.request["task"].append({"pick": pick})
    if cell.chance(0.5):
        cell.request["task"].append({"move": {"to": cell.target(cell.joints(0.5))}})
    return cell


def forbidden(rng: np.random.Generator) -> SmallRequest:
    """A yaw about at the end of a forbidden range."""
    cell = SmallRequest(rng, SCARAS)
    to = cell.target(cell.joints(0.5))
    yaw = to["yaw_rad"] if cell.chance(0.7) else float(cell.arm.tool(cell.q).yaw)
    width, off = float(rng.uniform(0.1, 1.0)), cell.off()
    first = yaw + off if cell.chance(0.5) else yaw - width - off
    first = (first + math.pi) % (2.0 * math.pi) - math.pi
    cell.request["robot"].setdefault("limits", {})["forbidden_yaw_rad"] = [[first, first + width]]
    cell.request["task"].append(cell.move(to))
    return cell


def loaded(rng: np.random.Generator) -> SmallRequest:
    """Tool and part about as heavy as what may be carried."""
    cell = picked(rng)
    given = next(iter(robot_file(cell.model).values()))
    most = float(si(given, "max_load") if "max_load_m" in given else given.get("max_load_kg", {"value": 5.0})["value"])
    tool = float(rng.uniform(0.0, most))
    cell.request["robot"]["tool"]["mass_kg"] = tool
    for body in cell.request["bodies"]:
        if body["name"] == "part":
            body["mass_kg"] = max(most - tool + cell.off(), 0.0)
    if cell.chance(0.4):
        rows = [{"mass_kg": 0.5, "share": 1.0}, {"mass_kg": most * 0.9, "share": 0.4}]
        cell.request["robot"].setdefault("limits", {})["acceleration_by_load"] = rows
    return cell


def arched(rng: np.random.Generator) -> SmallRequest:
    """An arch about as high as the lift goes."""
    cell = SmallRequest(rng, SCARAS)
    assert not cell.arm.tilts
    lift = int(np.argmin(cell.arm.upper - cell.arm.lower))
    tops = []
    for end in (cell.arm.lower[lift], cell.arm.upper[lift]):
        q = cell.q.copy()
        q[lift] = end
        tops.append(float(cell.arm.tool(q).p[2]))
    step = {"move": {"to": cell.target(cell.joints(0.5)), "arch": {"top_m": max(tops) + cell.off()}}}
    cell.request["task"].append(step)
    return cell


KINDS: dict[str, Callable[[np.random.Generator], SmallRequest]] = {
    "edge of reach": at_the_edge_of_reach,
    "end of a range": at_the_end_of_a_range,
    "window": in_a_window,
    "never near": never_near,
    "near a body": near_a_body,
    "picked": picked,
    "forbidden yaw": forbidden,
    "load": loaded,
    "arch": arched,
}


def random_request(kind: str, seed: int) -> Document:
    """The request of a kind (one of `KINDS`) and a seed: the same on every machine."""
    return finished(KINDS[kind](np.random.default_rng([seed, 2000 + list(KINDS).index(kind)])).request)
