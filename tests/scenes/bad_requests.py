"""Requests that must be refused, each by one change to a good one, with the field that the refusal must name.

Shared by the tests of documents, service and command line. Every change leaves plain JSON.
"""

from __future__ import annotations

import base64
import copy
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

Change = Callable[[dict[str, Any]], None]


@dataclass(frozen=True)
class Bad:
    """A kind of bad request: `change` spoils a copy of the good one, `field` is what the error must name, and `said` is
    part of what it must say is allowed, or was meant."""

    name: str
    change: Change
    field: str
    said: str = ""

    def document(self) -> dict[str, Any]:
        """The good request, spoilt."""
        request = copy.deepcopy(GOOD_REQUEST)
        self.change(request)
        return request


GOOD_REQUEST: dict[str, Any] = {
    "schema": "assur/1",
    "robot": {
        "model": "mitsubishi-rh-6frh5520",
        "tool": {
            "tcp_mm": [0, 0, -100],
            "mass_kg": 0.45,
            "bodies": [
                {"name": "cup", "shape": {"cylinder": {"radius_mm": 15, "height_mm": 100}}, "at_mm": [0, 0, -50]}
            ],
        },
        "limits": {"acceleration": 0.6, "j4_deg": [-270, 270]},
    },
    "start": {"at_s": 0.0, "joints": {"j1_deg": 17.2, "j2_deg": 68.8, "j3_mm": 250, "j4_deg": 0}},
    "frames": {
        "belt": {"conveyor": {"at_mm": [0, 350, 50], "speed_mm_s": 250}, "uncertainty": {"speed_mm_s": 2}},
        "dial": {"turntable": {"at_mm": [340, -150, 60], "rate_deg_s": 60}},
        "gate": {"swing": {"pivot_mm": [600, 300, 160], "amplitude_deg": 50, "period_s": 1.6}},
    },
    "bodies": [
        {"name": "bed", "shape": {"box": {"size_mm": [1400, 300, 50]}}, "pose": {"at_mm": [0, 350, 25]}},
        {
            "name": "part",
            "shape": {"mesh": {"asset": "bracket", "unit": "mm"}},
            "pose": {"frame": "belt", "at_mm": [-450, 0, 10], "yaw_deg": 33},
            "mass_kg": 0.12,
            "yaw_symmetry": 2,
        },
        {
            "name": "bar",
            "shape": {"capsule": {"radius_mm": 15, "length_mm": 200, "axis": "x"}},
            "pose": {"frame": "gate", "at_mm": [0, 0, 0]},
        },
        {
            "name": "plate",
            "shape": {"cylinder": {"radius_mm": 190, "height_mm": 20}},
            "pose": {"frame": "dial", "at_mm": [0, 0, -10]},
        },
    ],
    "task": [
        {
            "pick": {
                "part": "part",
                "grasp_mm": [0, 0, 10],
                "window_mm": [-300, 250],
                "approach": {"mm": 30},
                "dwell_ms": 80,
                "depart": {"mm": 40},
            }
        },
        {
            "place": {
                "part": "part",
                "to": {"frame": "dial", "at_mm": [150, 0, 10], "yaw_deg": 0},
                "approach": {"mm": 20},
                "dwell_ms": 60,
                "depart": {"mm": 30},
                "contact_with": ["plate"],
            }
        },
        {"move": {"to": {"at_mm": [350, 0, 120]}}},
    ],
    "options": {
        "seed": 1,
        "budget_s": 30.0,
        "stop": "first",
        "clearance_mm": {"travel": 8, "near": 1.5},
        "singularity_margin": 0.2,
    },
}
"""A small pick and place, quickly planned."""


def shortly_followed(request: dict[str, Any]) -> None:
    point = {"frame": "belt", "at_mm": [0, 0, 100], "yaw_deg": 0}
    request["task"].append({"follow": {"to": point, "duration_ms": 0.01}})


def _at(*path: str | int) -> Callable[[dict[str, Any]], Any]:
    def find(document: Any) -> Any:
        for part in path:
            document = document[part]
        return document

    return find


def put(*path: str | int, value: Any) -> Change:
    """Sets the value at `path`."""

    def change(document: dict[str, Any]) -> None:
        _at(*path[:-1])(document)[path[-1]] = value

    return change


def drop(*path: str | int) -> Change:
    """Removes the value at `path`."""

    def change(document: dict[str, Any]) -> None:
        del _at(*path[:-1])(document)[path[-1]]

    return change


def add(*path: str | int, value: Any) -> Change:
    """Appends to the list at `path`."""

    def change(document: dict[str, Any]) -> None:
        _at(*path)(document).append(value)

    return change


def all_of(*changes: Change) -> Change:
    """Makes several changes, one after the other."""

    def change(document: dict[str, Any]) -> None:
        for each in changes:
            each(document)

    return change


PART, PICK, PLACE = ("bodies", 1), ("task", 0, "pick"), ("task", 1, "place")
BELT, TOOL = ("frames", "belt", "conveyor"), ("robot", "tool")
BY_LOAD = ("robot", "limits", "acceleration_by_load")


def share(mass_kg: float, share: float) -> dict[str, float]:
    """A row of a table of shares by mass."""
    return {"mass_kg": mass_kg, "share": share}


BOX = {"name": "extra", "shape": {"box": {"size_mm": [10, 10, 10]}}, "pose": {"at_mm": [0, -500, 5]}}
OPEN_STL = (
    b"solid x\n" + b"facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 9 0 0\nvertex 0 9 0\nendloop\nendfacet\n" * 4
)
BY_FILE = {"file": "/etc/passwd", "tool": {"tcp_mm": [0, 0, 0]}}
KEYS = [{"time_s": 0, "at_mm": [0, 0, 0]}, {"time_s": 1, "at_mm": [0, 0, 1]}]
JOINT = {"name": "a", "range_deg": [-90, 90], "velocity_deg_s": 100, "acceleration_deg_s2": 1000, "jerk_deg_s3": 10000}
LIFT = {"name": "c", "range_mm": [0, 100], "velocity_mm_s": 100, "acceleration_mm_s2": 1000, "jerk_mm_s3": 10000}


def _loaded_start(document: dict[str, Any]) -> None:
    """Half of the acceleration is left by any load; more of it at the start."""
    put(*BY_LOAD, value=[share(0, 0.5), share(5, 0.5)])(document)
    put("start", "acceleration", value={"j1_rad_s2": 40, "j2_rad_s2": 0, "j3_m_s2": 0, "j4_rad_s2": 0})(document)


def _inline(**changes: Any) -> Change:
    """An inline robot in place of the model, spoilt by `changes`; the start is made to fit it."""

    def change(document: dict[str, Any]) -> None:
        joints = [dict(JOINT), {**JOINT, "name": "b"}, dict(LIFT), {**JOINT, "name": "d"}]
        scara = {"l1_mm": 300, "l2_mm": 300, "joints": joints, "bodies": [], "self_pairs": []}
        for key, value in changes.items():
            if key.startswith("joint_"):
                joints[int(key[6:])].update(value)
            else:
                scara[key] = value
        document["robot"] = {"scara": scara, "tool": document["robot"]["tool"]}
        document["start"]["joints"] = {"a_deg": 0, "b_deg": 60, "c_mm": 50, "d_deg": 0}

    return change


def _neighbour(**changes: Any) -> Change:
    """A neighbour with a trajectory of two knots, spoilt by `changes`."""

    def change(document: dict[str, Any]) -> None:
        rest = [[0.0] * 4, [0.0] * 4]
        trajectory: dict[str, Any] = {
            "joint_names": ["j1", "j2", "j3", "j4"],
            "joint_units": ["rad", "rad", "m", "rad"],
            "time_s": [0.0, 1.0],
            "position": [[0.0, 1.0, 0.3, 0.0], [0.2, 1.0, 0.3, 0.0]],
            "velocity": rest,
            "acceleration": rest,
        }
        robot = {"model": "mitsubishi-rh-6frh5520", "base": {"at_mm": [2000, 0, 0]}, "tool": {"tcp_mm": [0, 0, 0]}}
        trajectory.update(changes)
        document["neighbours"] = [{"name": "other", "robot": robot, "trajectory": trajectory}]

    return change


def _neighbour_by(**keys: Any) -> Change:
    """A neighbour that has these keys in place of its trajectory."""

    def change(document: dict[str, Any]) -> None:
        _neighbour()(document)
        del document["neighbours"][0]["trajectory"]
        document["neighbours"][0].update(keys)

    return change


def _oscillation(**changes: Any) -> Change:
    """A gate that goes up and down, spoilt by `changes`."""
    law = {"at_mm": [600, 300, 160], "direction": [0, 0, 1], "amplitude_mm": 50, "period_s": 1.6}
    return put("frames", "gate", value={"oscillation": {**law, **changes}})


def _belt_in_metres(document: dict[str, Any]) -> None:
    conveyor = document["frames"]["belt"]["conveyor"]
    conveyor["at_m"] = conveyor.pop("at_mm")


def _twin_cups(document: dict[str, Any]) -> None:
    bodies = document["robot"]["tool"]["bodies"]
    bodies.append(bodies[0])


def _wristless(document: dict[str, Any]) -> None:
    document["robot"]["model"] = "oviedo-scara"
    document["robot"].pop("limits")
    document["start"]["joints"] = {"theta1_deg": 0, "theta2_deg": 60, "l3_mm": 50}
    document["task"][0]["pick"]["grasp_yaw_deg"] = 90


def _ride_on_the_part(document: dict[str, Any]) -> None:
    document["bodies"].append({**BOX, "pose": {"body": "part", "at_mm": [0, 0, 20]}})


def _pick_twice(document: dict[str, Any]) -> None:
    document["task"][1] = document["task"][0]


def _data(content: bytes, form: str = "stl") -> dict[str, Any]:
    return {"mesh": {"data": base64.b64encode(content).decode(), "format": form, "unit": "mm"}}


def _on(frame: str, **beside: Any) -> Change:
    """A frame that is fixed on another."""
    return put("frames", "nest", value={"fixed": {"frame": frame, "at_m": [0, 0, 0]}, **beside})


def _rates(per: str, **given: float) -> dict[str, float]:
    """Rates of all joints of the good request's arm, zero where not `given`."""
    return {f"{j}_{'mm' if j == 'j3' else 'deg'}{per}": given.get(j, 0.0) for j in ("j1", "j2", "j3", "j4")}


BAD_REQUESTS: tuple[Bad, ...] = (
    # the document as such
    Bad("a follow of no length", shortly_followed, "task[3].follow.duration_ms", "0, or 0.1 ms and more"),
    Bad("unknown field", put("color", value="red"), "color"),
    Bad("an answer", put("status", value="planned"), "status", "this is an answer, not a request"),
    Bad("expect in a request", put("expect", value={"status": "planned"}), "expect"),
    Bad("schema left out", drop("schema"), "schema", "assur/1, which must be given"),
    Bad("schema of another version", put("schema", value="assur/2"), "schema"),
    Bad("null for a value", put("carry", value=None), "carry"),
    Bad("list for a mapping", put("frames", value=[]), "frames"),
    Bad("mapping for a list", put("bodies", value={}), "bodies"),
    Bad("robot left out", drop("robot"), "robot"),
    # units
    Bad("no unit in the key", put(*BELT, "speed", value=250), "frames.belt.conveyor.speed", "speed_m_s or speed_mm_s?"),
    Bad("a place without unit", put(*BELT, "at", value=[0, 1, 2]), "frames.belt.conveyor.at", "mean at_m or at_mm?"),
    Bad("a time without unit", put(*BELT, "at", value=3), "frames.belt.conveyor.at", "mean at_s or at_ms?"),
    Bad(
        "misspelt", put(*BELT, "sped_mm_s", value=3), "frames.belt.conveyor.sped_mm_s", "mean speed_m_s or speed_mm_s?"
    ),
    Bad("both twins", put(*BELT, "speed_m_s", value=0.25), "frames.belt.conveyor.speed_mm_s"),
    Bad("a unit that does not fit", put(*BELT, "yaw_mm", value=3), "frames.belt.conveyor.yaw_mm"),
    Bad("text for a number", put(*BELT, "speed_mm_s", value="250"), "frames.belt.conveyor.speed_mm_s"),
    Bad("boolean for a number", put(*BELT, "speed_mm_s", value=True), "frames.belt.conveyor.speed_mm_s"),
    Bad("two coordinates", put(*BELT, "at_mm", value=[0, 350]), "frames.belt.conveyor.at_mm"),
    Bad("metres taken for millimetres", _belt_in_metres, "frames.belt.conveyor.at_m[1]", "did you mean at_mm?"),
    Bad(
        "a coordinate beyond every cell",
        put("bodies", 0, "pose", "at_mm", value=[0, 0, 1e9]),
        "bodies[0].pose.at_mm[2]",
    ),
    # robot
    Bad("unknown model", put("robot", "model", value="fanuc-sr-3a"), "robot.model", "did you mean fanuc-sr-3ia?"),
    Bad("model by its short name", put("robot", "model", value="6frh"), "robot.model", "mean mitsubishi-rh-6frh5520?"),
    Bad("beginning of two models", put("robot", "model", value="mitsubishi-rh"), "robot.model", "rh-6crh6020 or mitsu"),
    Bad("model in capitals", put("robot", "model", value="RH-6FRH5520"), "robot.model", "mean mitsubishi-rh-6frh5520?"),
    Bad("model and inline", put("robot", "scara", value={}), "robot.scara"),
    Bad("neither model nor inline", drop("robot", "model"), "robot"),
    Bad("no tool", drop("robot", "tool"), "robot.tool"),
    Bad("no tool point", drop(*TOOL, "tcp_mm"), "robot.tool.tcp_m"),
    Bad("two bodies of the tool of one name", _twin_cups, "robot.tool.bodies[0].name"),
    Bad("negative mass", put(*TOOL, "mass_kg", value=-1), "robot.tool.mass_kg"),
    Bad("mass in grams", put(*TOOL, "mass_g", value=450), "robot.tool.mass_g", "did you mean mass_kg?"),
    Bad("negative inertia", put(*TOOL, "inertia_kgm2", value=-0.1), "robot.tool.inertia_kgm2"),
    Bad("no rows of shares", put(*BY_LOAD, value=[]), ".".join(BY_LOAD)),
    Bad("share above one", put(*BY_LOAD, value=[share(1, 1.2)]), "robot.limits.acceleration_by_load[0].share"),
    Bad("share of zero", put(*BY_LOAD, value=[share(1, 0)]), "robot.limits.acceleration_by_load[0].share"),
    Bad(
        "share of a negative mass", put(*BY_LOAD, value=[share(-1, 1)]), "robot.limits.acceleration_by_load[0].mass_kg"
    ),
    Bad(
        "masses that do not increase",
        put(*BY_LOAD, value=[share(3, 1), share(3, 0.5)]),
        "robot.limits.acceleration_by_load[1].mass_kg",
        "more than 3 kg",
    ),
    Bad(
        "shares that increase",
        put(*BY_LOAD, value=[share(3, 0.5), share(4, 0.6)]),
        "robot.limits.acceleration_by_load[1].share",
        "up to 0.5",
    ),
    Bad("rated load above the maximum", _inline(rated_load_kg=5, max_load_kg=3), "robot.scara.rated_load_kg", "3 kg"),
    Bad(
        "stated rated load above the maximum",
        _inline(rated_load_kg={"value": 5, "status": "vendor", "source": "manual"}, max_load_kg=3),
        "robot.scara.rated_load_kg.value",
        "3 kg",
    ),
    Bad("maximum load of nothing", _inline(max_load_kg=0), "robot.scara.max_load_kg"),
    Bad("maximum inertia of nothing", _inline(max_inertia_kgm2=0), "robot.scara.max_inertia_kgm2", "positive"),
    Bad(
        "an arm's shares that increase",
        _inline(acceleration_by_load=[share(3, 0.5), share(4, 0.6)]),
        "robot.scara.acceleration_by_load[1].share",
        "up to 0.5",
    ),
    *(
        Bad(f"forbidden yaws: {name}", put("robot", "limits", "forbidden_yaw_deg", value=value), field, said)
        for name, value, field, said in (
            ("no list", 5, "robot.limits.forbidden_yaw_deg", ""),
            ("text", "all", "robot.limits.forbidden_yaw_deg", ""),
            ("empty", [], "robot.limits.forbidden_yaw_deg", ""),
            ("a number", [10], "robot.limits.forbidden_yaw_deg[0]", ""),
            ("one end", [[10]], "robot.limits.forbidden_yaw_deg[0]", ""),
            ("three ends", [[10, 20, 30]], "robot.limits.forbidden_yaw_deg[0]", ""),
            ("no number", [[10, "x"]], "robot.limits.forbidden_yaw_deg[0][1]", ""),
            ("nothing", [[10, None]], "robot.limits.forbidden_yaw_deg[0][1]", ""),
            ("true", [[True, 20]], "robot.limits.forbidden_yaw_deg[0][0]", ""),
            ("too far", [[10, 20], [10, 361]], "robot.limits.forbidden_yaw_deg[1][1]", ""),
            ("equal ends", [[10, 10]], "robot.limits.forbidden_yaw_deg[0]", "differ"),
            ("a full turn", [[-180, 180]], "robot.limits.forbidden_yaw_deg[0]", "360° apart"),
            ("too narrow", [[10, 10.05]], "robot.limits.forbidden_yaw_deg[0]", "0.1°"),
            ("all of the circle", [[0, 200], [180, 10]], "robot.limits.forbidden_yaw_deg", "leave a yaw free"),
            ("too many", [[i, i + 1] for i in range(17)], "robot.limits.forbidden_yaw_deg", ""),
        )
    ),
    Bad("scale above one", put("robot", "limits", "velocity", value=1.5), "robot.limits.velocity"),
    Bad("scale of zero", put("robot", "limits", "jerk", value=0), "robot.limits.jerk"),
    Bad("wider range", put("robot", "limits", "j4_deg", value=[-400, 270]), "robot.limits.j4_deg"),
    Bad("range upside down", put("robot", "limits", "j1_deg", value=[90, -90]), "robot.limits.j1_deg"),
    Bad("range of an unknown joint", put("robot", "limits", "j9_deg", value=[-1, 1]), "robot.limits.j9_deg"),
    Bad("key called like a form of a fact", put("[plain]", value=1), "[plain]"),
    Bad("frame called like a mark of pydantic's", put("frames", "[key]", value={}), "frames.[key]"),
    Bad("inline with two joints", _inline(joints=[JOINT, JOINT]), "robot.scara.joints"),
    Bad(
        "inline with a turning lift",
        _inline(joint_2={"range_deg": [0, 9], "range_mm": [0, 9]}),
        "robot.scara.joints[2].range_mm",
    ),
    Bad(
        "inline lift in degrees",
        _inline(joints=[JOINT, {**JOINT, "name": "b"}, {**JOINT, "name": "c"}]),
        "robot.scara.joints[2].range_deg",
    ),
    Bad("inline joints of one name", _inline(joint_1={"name": "a"}), "robot.scara.joints[1].name"),
    Bad("inline range upside down", _inline(joint_0={"range_deg": [90, -90]}), "robot.scara.joints[0].range_deg"),
    Bad("inline zero of a turning joint", _inline(joint_0={"zero_mm": 3}), "robot.scara.joints[0].zero_mm"),
    Bad("inline sign of two", _inline(joint_0={"sign": 2}), "robot.scara.joints[0].sign"),
    Bad("inline pair of a link with itself", _inline(self_pairs=[["flange", "flange"]]), "robot.scara.self_pairs[0]"),
    Bad("inline pair of unknown links", _inline(self_pairs=[["base", "hand"]]), "robot.scara.self_pairs[0][1]"),
    Bad(
        "inline quill that is no solid of revolution",
        _inline(bodies=[{"name": "rod", "link": "quill", "shape": BOX["shape"], "at_mm": [0, 0, 0]}]),
        "robot.scara.bodies[0].shape",
    ),
    Bad(
        "inline body on no link",
        _inline(bodies=[{"name": "rod", "shape": BOX["shape"], "at_mm": [0, 0, 0]}]),
        "robot.scara.bodies[0].link",
    ),
    # start
    Bad("no start", drop("start"), "start"),
    Bad("a joint left out", drop("start", "joints", "j2_deg"), "start.joints.j2_rad"),
    Bad("joint in the wrong unit", put("start", "joints", "j3_deg", value=0), "start.joints.j3_deg"),
    Bad("joint without unit", put("start", "joints", "j1", value=0), "start.joints.j1"),
    Bad("a start below its range", put("start", "joints", "j3_mm", value=30), "start.joints.j3_mm", "133 to 333"),
    Bad(
        "a start beyond a narrowed range",
        put("start", "joints", "j4_deg", value=300),
        "start.joints.j4_deg",
        "-270 to 270",
    ),
    Bad(
        "a start in radians beyond its range",
        put("start", "joints", value={"j1_rad": 0, "j2_rad": 9, "j3_m": 0.2, "j4_rad": 0}),
        "start.joints.j2_rad",
        "-2.53073 to 2.53073",
    ),
    Bad(
        "a start in metres taken for millimetres",
        put("start", "joints", value={"j1_deg": 17, "j2_deg": 68, "j3_m": 250, "j4_deg": 0}),
        "start.joints.j3_m",
        "0.133 to 0.333; did you mean j3_mm?",
    ),
    Bad(
        "a start faster than the arm",
        put("start", "velocity", value=_rates("_s", j2=-800)),
        "start.velocity.j2_deg_s",
        "-670 to 670",
    ),
    Bad(
        "a start that speeds up more than the arm",
        put("start", "acceleration", value={"j1_rad_s2": 80, "j2_rad_s2": 0, "j3_m_s2": 0, "j4_rad_s2": 0}),
        "start.acceleration.j1_rad_s2",
        "-75.384 to 75.384",  # 0.6 of the maker's
    ),
    Bad(
        "a start that speeds up more than its load leaves",
        _loaded_start,
        "start.acceleration.j1_rad_s2",
        "-37.692 to 37.692 (with 0.45 kg at the flange the joints have 50 % of their acceleration)",
    ),
    Bad("velocity of one joint only", put("start", "velocity", value={"j1_deg_s": 5}), "start.velocity.j2_rad_s"),
    # frames
    Bad("frame without law", put("frames", "belt", value={}), "frames.belt"),
    Bad("frame with two laws", put("frames", "belt", "fixed", value={"at_m": [0, 0, 0]}), "frames.belt.conveyor"),
    Bad("unknown law", put("frames", "belt", value={"teleport": {}}), "frames.belt", "teleport is none of them"),
    Bad(
        "unknown field of a frame called like a field",
        put("frames", "valid_s", value={"conveyor": {"colour": 3}}),
        "frames.valid_s.conveyor.colour",
        "one of at_m",
    ),
    Bad("frame called world", put("frames", "world", value={"fixed": {"at_m": [0, 0, 0]}}), "frames.world"),
    Bad("frame with a slash", put("frames", "a/b", value={"fixed": {"at_m": [0, 0, 0]}}), "frames.a/b"),
    Bad("a frame on no frame", _on("blet"), "frames.nest.fixed.frame", "one of belt, dial, gate, nest, world; did you"),
    Bad("a frame on a neighbour's link", _on("other/flange"), "frames.nest.fixed.frame", "one of belt, dial"),
    Bad("a frame on itself", _on("nest"), "frames.nest.fixed.frame", "nest on nest"),
    Bad(
        "two frames on each other",
        lambda document: document["frames"].update(
            nest={"fixed": {"frame": "tray", "at_m": [0, 0, 0]}}, tray={"fixed": {"frame": "nest", "at_m": [0, 0, 0]}}
        ),
        "frames.tray.fixed.frame",
        "nest on tray on nest",
    ),
    Bad("a frame that is not fixed, on a frame", put(*BELT, "frame", value="dial"), "frames.belt.conveyor.frame"),
    Bad(
        "an uncertain frame on a frame",
        _on("belt", uncertainty={"position_mm": 1}),
        "frames.nest.uncertainty",
        "goes with belt and has its uncertainty",
    ),
    Bad("a frame on a frame, known for a time", _on("dial", valid_s=[0, 1]), "frames.nest.valid_s", "as long as dial"),
    Bad("period of zero", put("frames", "gate", "swing", "period_s", value=0), "frames.gate.swing.period_s"),
    Bad("validity upside down", put("frames", "belt", "valid_s", value=[5, 1]), "frames.belt.valid_s"),
    Bad(
        "negative uncertainty",
        put("frames", "belt", "uncertainty", value={"position_mm": -1}),
        "frames.belt.uncertainty.position_mm",
    ),
    Bad(
        "one keyframe",
        put("frames", "gate", value={"keyframes": {"points": [{"time_s": 0, "at_m": [0, 0, 0]}]}}),
        "frames.gate.keyframes.points",
    ),
    Bad(
        "keyframes out of order",
        put("frames", "gate", value={"keyframes": {"points": [{"time_s": t, "at_m": [0, 0, 0]} for t in (1, 0)]}}),
        "frames.gate.keyframes.points[1].time_s",
    ),
    Bad(
        "keyframes that repeat and do not come back",
        put("frames", "gate", value={"keyframes": {"points": KEYS, "repeat": True}}),
        "frames.gate.keyframes.points[1].at_mm",
        "that of the first point",
    ),
    Bad(
        "keyframes that repeat from rest to rest",
        put("frames", "gate", value={"keyframes": {"points": [KEYS[0]] * 2, "repeat": True, "ends": "clamped"}}),
        "frames.gate.keyframes.ends",
    ),
    Bad("oscillation to nowhere", _oscillation(direction=[0, 0, 0]), "frames.gate.oscillation.direction"),
    Bad("oscillation in metres", _oscillation(direction=[0, 0, 300]), "frames.gate.oscillation.direction[2]"),
    Bad("oscillation in a plane", _oscillation(direction=[0, 1]), "frames.gate.oscillation.direction"),
    Bad("oscillation with no period", _oscillation(period_s=0), "frames.gate.oscillation.period_s"),
    Bad("oscillation that is too quick", _oscillation(period_s=1e-4), "frames.gate.oscillation.period_s"),
    Bad(
        "overlapping changes of speed",
        put(
            *BELT,
            "changes",
            value=[{"at_s": t, "speed_m_s": t, "acceleration_m_s2": 1e-3, "jerk_m_s3": 1} for t in (1, 2)],
        ),
        "frames.belt.conveyor.changes[1].at_s",
    ),
    Bad(
        "a change of speed to no speed",
        put(*BELT, "changes", value=[{"at_s": 1, "acceleration_m_s2": 1, "jerk_m_s3": 1}]),
        "frames.belt.conveyor.changes[0].speed_m_s",
    ),
    Bad(
        "indexer that both turns and travels",
        put(
            "frames",
            "gate",
            value={"indexer": {"at_m": [0, 0, 0], "step_deg": 9, "step_mm": 9, "move_s": 1, "dwell_s": 1}},
        ),
        "frames.gate.indexer.step_mm",
    ),
    # bodies
    Bad("two bodies of one name", add("bodies", value={**BOX, "name": "bed"}), "bodies[4].name"),
    Bad("a body called like the tool's", add("bodies", value={**BOX, "name": "cup"}), "bodies[4].name"),
    Bad("a body called like the robot's", add("bodies", value={**BOX, "name": "link-1"}), "bodies[4].name"),
    Bad("name with a space", put("bodies", 0, "name", value="belt bed"), "bodies[0].name"),
    Bad("body without pose", drop("bodies", 0, "pose"), "bodies[0].pose"),
    Bad("body in an unknown frame", put(*PART, "pose", "frame", value="bellt"), "bodies[1].pose.frame", "mean belt?"),
    Bad("body in a frame and on a body", put(*PART, "pose", "body", value="bed"), "bodies[1].pose.body"),
    Bad(
        "body on a later body",
        put("bodies", 0, "pose", value={"body": "plate", "at_mm": [0, 0, 0]}),
        "bodies[0].pose.body",
    ),
    Bad("body on a part that is picked", _ride_on_the_part, "bodies[4].pose.body"),
    Bad("no shape", put("bodies", 0, "shape", value={}), "bodies[0].shape"),
    Bad("two shapes", put("bodies", 0, "shape", "sphere", value={"radius_mm": 3}), "bodies[0].shape.sphere"),
    Bad(
        "negative size",
        put("bodies", 0, "shape", "box", "size_mm", value=[10, 10, -10]),
        "bodies[0].shape.box.size_mm[2]",
    ),
    Bad(
        "a sheet of nothing",
        put("bodies", 0, "shape", "box", "size_mm", value=[10, 10, 1e-4]),
        "bodies[0].shape.box.size_mm[2]",
    ),
    Bad("unknown axis", put("bodies", 2, "shape", "capsule", "axis", value="w"), "bodies[2].shape.capsule.axis"),
    Bad("fraction of a symmetry", put(*PART, "yaw_symmetry", value=2.5), "bodies[1].yaw_symmetry"),
    # meshes
    Bad(
        "mesh without unit", drop(*PART, "shape", "mesh", "unit"), "bodies[1].shape.mesh.unit", "one of m, mm, cm, in,"
    ),
    Bad(
        "mesh as large as a hall",
        put(*PART, "shape", value={"mesh": {"asset": "bracket", "unit": "m"}}),
        "bodies[1].shape.mesh.unit",
        "m large; is the unit right?",
    ),
    Bad("mesh in furlongs", put(*PART, "shape", "mesh", "unit", value="furlong"), "bodies[1].shape.mesh.unit"),
    Bad(
        "asset that is not shipped", put(*PART, "shape", "mesh", "asset", value="teapot"), "bodies[1].shape.mesh.asset"
    ),
    Bad("asset by path", put(*PART, "shape", "mesh", "asset", value="../assets/bracket"), "bodies[1].shape.mesh.asset"),
    Bad("robot by file", put("robot", value={**BY_FILE, "file": "arm.yaml"}), "robot.file"),
    Bad("robot by a path", put("robot", value=BY_FILE), "robot.file"),
    Bad("model by path", put("robot", "model", value="../robots/lab-scara"), "robot.model"),
    Bad(
        "mesh by file",
        put(*PART, "shape", "mesh", value={"file": "bracket.stl", "unit": "mm"}),
        "bodies[1].shape.mesh.file",
    ),
    Bad(
        "mesh by URL",
        put(*PART, "shape", "mesh", value={"url": "http://localhost/x.stl", "unit": "mm"}),
        "bodies[1].shape.mesh",
    ),
    Bad(
        "mesh that is not base64",
        put(*PART, "shape", "mesh", value={"data": "***", "format": "stl", "unit": "mm"}),
        "bodies[1].shape.mesh.data",
    ),
    Bad(
        "mesh without format",
        put(*PART, "shape", "mesh", value={"data": "AAAA", "unit": "mm"}),
        "bodies[1].shape.mesh.format",
    ),
    Bad(
        "mesh as an archive", put(*PART, "shape", value=_data(b"PK\x03\x04" + bytes(200))), "bodies[1].shape.mesh.data"
    ),
    Bad("mesh that is open", put(*PART, "shape", value=_data(OPEN_STL + b"endsolid x\n")), "bodies[1].shape.mesh.data"),
    Bad("mesh of the wrong format", put(*PART, "shape", value=_data(OPEN_STL, "glb")), "bodies[1].shape.mesh.data"),
    # neighbours
    Bad(
        "neighbour's joints of other names",
        _neighbour(joint_names=["a", "b", "c", "d"]),
        "neighbours[0].trajectory.joint_names",
    ),
    Bad(
        "neighbour's joints in degrees",
        _neighbour(joint_units=["deg", "deg", "mm", "deg"]),
        "neighbours[0].trajectory.joint_units[0]",
    ),
    Bad("neighbour's rows too few", _neighbour(position=[[0.0] * 4] * 3), "neighbours[0].trajectory.position"),
    Bad(
        "neighbour's row too short", _neighbour(velocity=[[0.0] * 4, [0.0] * 3]), "neighbours[0].trajectory.velocity[1]"
    ),
    Bad("neighbour's times backwards", _neighbour(time_s=[1.0, 0.0]), "neighbours[0].trajectory.time_s[1]"),
    Bad(
        "neighbour that never stops",
        _neighbour(velocity=[[0.0] * 4, [0.1, 0, 0, 0]]),
        "neighbours[0].trajectory.velocity",
    ),
    Bad("neighbour by a plan's file", _neighbour_by(plan={"file": "other.json"}), "neighbours[0].plan.file"),
    Bad("neighbour by a path", _neighbour_by(plan={"file": "/etc/passwd"}), "neighbours[0].plan.file"),
    Bad("neighbour that does nothing", _neighbour_by(), "neighbours[0]", "exactly one of trajectory, plan"),
    # task
    Bad("no task", drop("task"), "task"),
    Bad("empty task", put("task", value=[]), "task"),
    Bad("too many steps", put("task", value=[{"move": {"to": {"at_mm": [350, 0, 120]}}}] * 65), "task"),
    Bad("step of two kinds", put("task", 2, "follow", value={}), "task[2].follow"),
    Bad("step of no kind", put("task", 2, value={}), "task[2]"),
    Bad("step of a misspelt kind", put("task", 2, value={"mvoe": {}}), "task[2]", "none of them, did you mean move?"),
    Bad(
        "target in metres taken for millimetres",
        put("task", 2, "move", "to", value={"at_m": [350, 0, 120]}),
        "task[2].move.to.at_m[0]",
        "did you mean at_mm?",
    ),
    Bad(
        "target on the part in the gripper",
        put("task", 1, value={"move": {"to": {"body": "part", "at_mm": [0, 0, 50]}}}),
        "task[1].move.to.body",
    ),
    Bad("two steps of one name", put("task", 2, "move", "name", value="pick-1"), "task[2].move.name"),
    Bad("part that is not there", put(*PICK, "part", value="angel"), "task[0].pick.part", "bar, bed, part, plate"),
    Bad("part that is misspelt", put(*PICK, "part", value="parrt"), "task[0].pick.part", "did you mean part?"),
    Bad("a grasp turned by a wrist that is not there", _wristless, "task[0].pick.grasp_yaw_deg"),
    Bad("place before pick", drop("task", 0), "task[0].place.part"),
    Bad("place of another part", put(*PLACE, "part", value="bed"), "task[1].place.part"),
    Bad("a second pick with a full gripper", _pick_twice, "task[1].pick.part"),
    Bad("place without yaw", drop(*PLACE, "to", "yaw_deg"), "task[1].place.to.yaw_rad"),
    Bad(
        "place with a free yaw",
        put(*PLACE, "to", value={"frame": "dial", "at_mm": [150, 0, 10], "yaw_free": True}),
        "task[1].place.to.yaw_free",
    ),
    Bad(
        "yaw and free yaw",
        put("task", 2, "move", "to", value={"at_m": [0.3, 0, 0.1], "yaw_deg": 3, "yaw_free": True}),
        "task[2].move.to.yaw_free",
    ),
    Bad("a pitch of a SCARA", put("task", 2, "move", "to", "pitch_deg", value=-90), "task[2].move.to.pitch_deg"),
    Bad("a free roll of a SCARA", put("task", 2, "move", "to", "roll_deg", value="free"), "task[2].move.to.roll_deg"),
    Bad("a pitch in words", put("task", 2, "move", "to", "pitch_rad", value="down"), "task[2].move.to.pitch_rad"),
    Bad("a pitch of many turns", put("task", 2, "move", "to", "pitch_deg", value=1e6), "task[2].move.to.pitch_deg"),
    Bad("a roll that is a truth", put("task", 2, "move", "to", "roll_deg", value=True), "task[2].move.to.roll_deg"),
    Bad("target in an unknown frame", put(*PLACE, "to", "frame", value="dail"), "task[1].place.to.frame", "mean dial?"),
    Bad("window in millimetres on a dial", put(*PLACE, "window_mm", value=[0, 1]), "task[1].place.window_mm"),
    Bad(
        "window upside down",
        put(*PICK, "window_mm", value=[250, -300]),
        "task[0].pick.window_mm",
        "250 is not below -300",
    ),
    Bad(
        "approach without its unit", put(*PICK, "approach", value=30), "task[0].pick.approach", "did you mean {mm: 30}?"
    ),
    Bad(
        "approach left out",
        drop(*PICK, "approach"),
        "task[0].pick.approach",
        "fields: m/mm, stop, which must",
    ),
    Bad("negative approach", put(*PICK, "approach", value={"mm": -3}), "task[0].pick.approach.mm"),
    Bad("no dwell", drop(*PICK, "dwell_ms"), "task[0].pick.dwell_s"),
    Bad(
        "grip within a distance, by a tool without bodies",
        all_of(drop(*TOOL, "bodies"), put(*PICK, "grip_within_mm", value=1)),
        "task[0].pick.grip_within_mm",
        "none: the tool has no bodies",
    ),
    Bad("grip within less than nothing", put(*PICK, "grip_within_mm", value=-1), "task[0].pick.grip_within_mm"),
    Bad("grip of a place", put(*PLACE, "grip_within_mm", value=1), "task[1].place.grip_within_mm"),
    Bad("support of a pick", put(*PICK, "support_within_mm", value=1), "task[0].pick.support_within_mm"),
    Bad("support beyond a hall", put(*PLACE, "support_within_mm", value=1e9), "task[1].place.support_within_mm"),
    Bad(
        "support within a distance, by nothing that is named",
        all_of(drop(*PLACE, "contact_with"), put(*PLACE, "support_within_mm", value=1)),
        "task[1].place.support_within_mm",
        "none without contact_with",
    ),
    Bad(
        "contact with what is not there", put(*PLACE, "contact_with", value=["table"]), "task[1].place.contact_with[0]"
    ),
    Bad(
        "contact of the part with itself", put(*PLACE, "contact_with", value=["part"]), "task[1].place.contact_with[0]"
    ),
    Bad("unknown manner", put("task", 2, "move", "match", value="roughly"), "task[2].move.match"),
    # options, execution, carry
    Bad("no time at all", put("options", "budget_s", value=0), "options.budget_s"),
    Bad("all day", put("options", "budget_s", value=86400), "options.budget_s"),
    Bad("a fraction of a seed", put("options", "seed", value=1.5), "options.seed"),
    Bad("negative seed", put("options", "seed", value=-1), "options.seed"),
    Bad("one clearance", put("options", value={"clearance_mm": 5}), "options.clearance_mm", "fields: travel, near"),
    Bad("one clearance for both", put("options", "clearance_mm", value={"travel": 8}), "options.clearance_mm.near"),
    Bad(
        "negative clearance",
        put("options", "clearance_mm", value={"travel": 8, "near": -1}),
        "options.clearance_mm.near",
    ),
    Bad("margin of one", put("options", "singularity_margin", value=1), "options.singularity_margin"),
    Bad("unknown elbow", put("options", "elbow", value="up"), "options.elbow"),
    Bad("text for a boolean", put("execution", value={"belt_correction": "yes"}), "execution.belt_correction"),
    Bad(
        "carry limit that only rounds",
        put("carry", value={"acceleration_m_s2": 5e-324}),
        "carry.acceleration_m_s2",
        "at least 1e-06",
    ),
    Bad(
        "scale that only rounds",
        put("robot", "limits", "velocity", value=1e-310),
        "robot.limits.velocity",
        "at least 1e-06",
    ),
    Bad(
        "approach that is 0 in metres",
        put("task", 0, "pick", "approach", value={"mm": 5e-324}),
        "task[0].pick.approach.mm",
        "a number that is not rounded to 0 in m",
    ),
    Bad("carry limit of zero", put("carry", value={"acceleration_m_s2": 0}), "carry.acceleration_m_s2"),
)
