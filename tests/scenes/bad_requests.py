"""Requests that must be refused, each by a change to a good one, with the field that the refusal must name.

Shared by the tests of documents, service and command line. Every change leaves plain JSON.
"""

from __future__ import annotations

import base64
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import pytest

from assur.planner.errors import InputError
from assur.scenes.requests import scene_of
from tests.changed import GONE, changed

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


@dataclass(frozen=True)
class Bad:
    """A kind of bad request: `on`, with `changes`. `at` is the field that the refusal must name: what begins with a dot
    or a bracket is behind the place of the last change, and this place is meant where nothing is given. `said` is part
    of what must be said to be allowed, or to be meant."""

    name: str
    changes: Mapping[Any, Any]
    at: str = ""
    said: str = ""
    on: Mapping[str, Any] = field(default_factory=lambda: GOOD_REQUEST)

    @property
    def field(self) -> str:
        *_, last = self.changes
        place = ".".join(map(str, last)) if isinstance(last, tuple) else last
        return f"{place}{self.at}" if self.at[:1] in ("", ".", "[") else self.at

    def document(self) -> dict[str, Any]:
        """The request."""
        made: dict[str, Any] = changed(self.on, self.changes)
        return made

    def refused(self) -> InputError:
        """How it is refused, which must be at its field and in its words."""
        with pytest.raises(InputError) as caught:
            scene_of(self.document())
        assert caught.value.field == self.field
        assert caught.value.allowed
        assert self.said in caught.value.allowed
        return caught.value


def share(mass_kg: float, share: float) -> dict[str, float]:
    """A row of a table of shares by mass."""
    return {"mass_kg": mass_kg, "share": share}


STOP = {"move": {"to": {"at_mm": [350, 0, 120]}}}
YAWS, BY_LOAD = "robot.limits.forbidden_yaw_deg", "robot.limits.acceleration_by_load"
ON_BELT = {"frame": "belt", "at_mm": [0, 0, 100], "yaw_deg": 0}
BOX = {"name": "extra", "shape": {"box": {"size_mm": [10, 10, 10]}}, "pose": {"at_mm": [0, -500, 5]}}
OPEN_STL = (
    b"solid x\n" + b"facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 9 0 0\nvertex 0 9 0\nendloop\nendfacet\n" * 4
)
FANUC, LAB = (
    changed(GOOD_REQUEST, {"robot": {"model": model, "tool": {"tcp_mm": [0, 0, 0]}}, "start.joints": joints})
    for model, joints in (
        ("fanuc-sr-3ia", {"j1_deg": 0, "j2_deg": 0, "j3_mm": 10, "j4_deg": 0}),
        ("lab-scara", {"j1_deg": 0, "j2_mm": 90, "j3_deg": 10, "j4_deg": 0}),
    )
)
BY_FILE = {"file": "/etc/passwd", "tool": {"tcp_mm": [0, 0, 0]}}
KEYS = [{"time_s": 0, "at_mm": [0, 0, 0]}, {"time_s": 1, "at_mm": [0, 0, 1]}]
JOINT = {"name": "a", "range_deg": [-90, 90], "velocity_deg_s": 100, "acceleration_deg_s2": 1000, "jerk_deg_s3": 10000}
LIFT = {"name": "c", "range_mm": [0, 100], "velocity_mm_s": 100, "acceleration_mm_s2": 1000, "jerk_mm_s3": 10000}
ROD = {"name": "rod", "shape": BOX["shape"], "at_mm": [0, 0, 0]}
SWAYING = changed(
    GOOD_REQUEST,
    {
        "frames.gate": {
            "oscillation": {"at_mm": [600, 300, 160], "direction": [0, 0, 1], "amplitude_mm": 50, "period_s": 1.6}
        }
    },
)
INLINE = changed(
    GOOD_REQUEST,
    {
        "robot.model": GONE,
        "robot.limits": GONE,
        "robot.scara": {
            "l1_mm": 300,
            "l2_mm": 300,
            "joints": [JOINT, {**JOINT, "name": "b"}, LIFT, {**JOINT, "name": "d"}],
            "bodies": [],
            "self_pairs": [],
        },
        "start.joints": {"a_deg": 0, "b_deg": 60, "c_mm": 50, "d_deg": 0},
    },
)
"""An arm that the request writes out."""
NEIGHBOUR = changed(
    GOOD_REQUEST,
    {
        "neighbours": [
            {
                "name": "other",
                "robot": {
                    "model": "mitsubishi-rh-6frh5520",
                    "base": {"at_mm": [2000, 0, 0]},
                    "tool": {"tcp_mm": [0, 0, 0]},
                },
                "trajectory": {
                    "joint_names": ["j1", "j2", "j3", "j4"],
                    "joint_units": ["rad", "rad", "m", "rad"],
                    "time_s": [0.0, 1.0],
                    "position": [[0.0, 1.0, 0.3, 0.0], [0.2, 1.0, 0.3, 0.0]],
                    "velocity": [[0.0] * 4] * 2,
                    "acceleration": [[0.0] * 4] * 2,
                },
            }
        ]
    },
)
"""Another robot that moves from rest to rest."""

THREE_AXES = changed(
    GOOD_REQUEST,
    {
        "robot": {"model": "elbow-arm", "tool": {"tcp_mm": [0, 0, 0]}},
        "start": {"joints": {"theta1_deg": 0, "theta2_deg": 70, "theta3_deg": -90}},
        "task": [{"move": {"to": {"at_mm": [300, 0, 300]}}}] * 2,
    },
)
"""An arm without a wrist."""


def _data(content: bytes, form: str = "stl") -> dict[str, Any]:
    return {"mesh": {"data": base64.b64encode(content).decode(), "format": form, "unit": "mm"}}


def _on(frame: str, **beside: Any) -> dict[str, Any]:
    """A frame that is fixed on another."""
    return {"fixed": {"frame": frame, "at_m": [0, 0, 0]}, **beside}


BAD_REQUESTS: tuple[Bad, ...] = (
    # the document as such
    Bad(
        "three wrong names",
        {"bodies[1].pose.frame": "blet", "task[0].pick.part": "prat", "robot.model": "mitsubishi"},
    ),
    Bad(
        "a follow of no length",
        {"task[+]": {"follow": {"to": ON_BELT, "duration_ms": 0.01}}},
        "task[3].follow.duration_ms",
        "0, or 0.1 ms and more",
    ),
    Bad("unknown field", {"color": "red"}),
    Bad("an answer", {"status": "planned"}, said="this is an answer, not a request"),
    Bad("expect in a request", {"expect": {"status": "planned"}}),
    Bad("schema left out", {"schema": GONE}, said="assur/1, which must be given"),
    Bad("schema of another version", {"schema": "assur/2"}),
    Bad("null for a value", {"carry": None}),
    Bad("list for a mapping", {"frames": []}),
    Bad("mapping for a list", {"bodies": {}}),
    Bad("robot left out", {"robot": GONE}),
    # units
    Bad("no unit in the key", {"frames.belt.conveyor.speed": 250}, said="speed_m_s or speed_mm_s?"),
    Bad("a place without unit", {"frames.belt.conveyor.at": [0, 1, 2]}, said="mean at_m or at_mm?"),
    Bad("a time without unit", {"frames.belt.conveyor.at": 3}, said="mean at_s or at_ms?"),
    Bad("misspelt", {"frames.belt.conveyor.sped_mm_s": 3}, said="mean speed_m_s or speed_mm_s?"),
    Bad("both twins", {"frames.belt.conveyor.speed_m_s": 0.25}, "frames.belt.conveyor.speed_mm_s"),
    Bad("a unit that does not fit", {"frames.belt.conveyor.yaw_mm": 3}),
    Bad("text for a number", {"frames.belt.conveyor.speed_mm_s": "250"}),
    Bad("boolean for a number", {"frames.belt.conveyor.speed_mm_s": True}),
    Bad("two coordinates", {"frames.belt.conveyor.at_mm": [0, 350]}),
    Bad(
        "metres taken for millimetres",
        {"frames.belt.conveyor.at_mm": GONE, "frames.belt.conveyor.at_m": [0, 350, 50]},
        "[1]",
        "did you mean at_mm?",
    ),
    Bad("a coordinate beyond every cell", {"bodies[0].pose.at_mm": [0, 0, 1e9]}, "[2]"),
    # robot
    Bad("unknown model", {"robot.model": "fanuc-sr-3a"}, said="did you mean fanuc-sr-3ia?"),
    Bad("model by its short name", {"robot.model": "6frh"}, said="mean mitsubishi-rh-6frh5520?"),
    Bad("beginning of two models", {"robot.model": "mitsubishi-rh"}, said="rh-6crh6020 or mitsu"),
    Bad("model in capitals", {"robot.model": "RH-6FRH5520"}, said="mean mitsubishi-rh-6frh5520?"),
    Bad("model and inline", {"robot.scara": {}}),
    Bad("neither model nor inline", {"robot.model": GONE}, "robot"),
    Bad("no tool", {"robot.tool": GONE}),
    Bad("no tool point", {"robot.tool.tcp_mm": GONE}, "robot.tool.tcp_m"),
    Bad(
        "two bodies of the tool of one name",
        {"robot.tool.bodies[+]": GOOD_REQUEST["robot"]["tool"]["bodies"][0]},
        "robot.tool.bodies[0].name",
    ),
    Bad("negative mass", {"robot.tool.mass_kg": -1}),
    Bad("mass in grams", {"robot.tool.mass_g": 450}, said="did you mean mass_kg?"),
    Bad("negative inertia", {"robot.tool.inertia_kgm2": -0.1}),
    Bad("no rows of shares", {BY_LOAD: []}),
    Bad("share above one", {BY_LOAD: [share(1, 1.2)]}, "[0].share"),
    Bad("share of zero", {BY_LOAD: [share(1, 0)]}, "[0].share"),
    Bad("share of a negative mass", {BY_LOAD: [share(-1, 1)]}, "[0].mass_kg"),
    Bad("masses that do not increase", {BY_LOAD: [share(3, 1), share(3, 0.5)]}, "[1].mass_kg", "more than 3 kg"),
    Bad("shares that increase", {BY_LOAD: [share(3, 0.5), share(4, 0.6)]}, "[1].share", "up to 0.5"),
    Bad(
        "rated load above the maximum",
        {"robot.scara.rated_load_kg": 5, "robot.scara.max_load_kg": 3},
        "robot.scara.rated_load_kg",
        "3 kg",
        on=INLINE,
    ),
    Bad(
        "stated rated load above the maximum",
        {
            "robot.scara.rated_load_kg": {"value": 5, "status": "vendor", "source": "manual"},
            "robot.scara.max_load_kg": 3,
        },
        "robot.scara.rated_load_kg.value",
        "3 kg",
        on=INLINE,
    ),
    Bad("maximum load of nothing", {"robot.scara.max_load_kg": 0}, on=INLINE),
    Bad("maximum inertia of nothing", {"robot.scara.max_inertia_kgm2": 0}, said="positive", on=INLINE),
    Bad(
        "an arm's shares that increase",
        {"robot.scara.acceleration_by_load": [share(3, 0.5), share(4, 0.6)]},
        "[1].share",
        "up to 0.5",
        on=INLINE,
    ),
    Bad("forbidden yaws: no list", {YAWS: 5}),
    Bad("forbidden yaws: text", {YAWS: "all"}),
    Bad("forbidden yaws: empty", {YAWS: []}),
    Bad("forbidden yaws: a number", {YAWS: [10]}, "[0]"),
    Bad("forbidden yaws: one end", {YAWS: [[10]]}, "[0]"),
    Bad("forbidden yaws: three ends", {YAWS: [[10, 20, 30]]}, "[0]"),
    Bad("forbidden yaws: no number", {YAWS: [[10, "x"]]}, "[0][1]"),
    Bad("forbidden yaws: nothing", {YAWS: [[10, None]]}, "[0][1]"),
    Bad("forbidden yaws: true", {YAWS: [[True, 20]]}, "[0][0]"),
    Bad("forbidden yaws: too far", {YAWS: [[10, 20], [10, 361]]}, "[1][1]"),
    Bad("forbidden yaws: equal ends", {YAWS: [[10, 10]]}, "[0]", "differ"),
    Bad("forbidden yaws: a full turn", {YAWS: [[-180, 180]]}, "[0]", "360° apart"),
    Bad("forbidden yaws: too narrow", {YAWS: [[10, 10.05]]}, "[0]", "0.1°"),
    Bad("forbidden yaws: all of the circle", {YAWS: [[0, 200], [180, 10]]}, said="leave a yaw free"),
    Bad("forbidden yaws: too many", {YAWS: [[i, i + 1] for i in range(17)]}),
    Bad("scale above one", {"robot.limits.velocity": 1.5}),
    Bad("scale of zero", {"robot.limits.jerk": 0}),
    Bad("wider range", {"robot.limits.j4_deg": [-400, 270]}),
    Bad("range upside down", {"robot.limits.j1_deg": [90, -90]}),
    Bad("range of an unknown joint", {"robot.limits.j9_deg": [-1, 1]}),
    Bad("key called like a form of a fact", {("[plain]",): 1}),
    Bad("frame called like a mark of pydantic's", {("frames", "[key]"): {}}),
    Bad("inline with two joints", {"robot.scara.joints": [JOINT, JOINT]}, on=INLINE),
    Bad(
        "inline with a turning lift",
        {"robot.scara.joints[2].range_deg": [0, 9], "robot.scara.joints[2].range_mm": [0, 9]},
        on=INLINE,
    ),
    Bad(
        "inline lift in degrees",
        {"robot.scara.joints": [JOINT, {**JOINT, "name": "b"}, {**JOINT, "name": "c"}]},
        "[2].range_deg",
        on=INLINE,
    ),
    Bad("inline joints of one name", {"robot.scara.joints[1].name": "a"}, on=INLINE),
    Bad("inline range upside down", {"robot.scara.joints[0].range_deg": [90, -90]}, on=INLINE),
    Bad("inline zero of a turning joint", {"robot.scara.joints[0].zero_mm": 3}, on=INLINE),
    Bad("inline sign of two", {"robot.scara.joints[0].sign": 2}, on=INLINE),
    Bad("inline pair of a link with itself", {"robot.scara.self_pairs": [["flange", "flange"]]}, "[0]", on=INLINE),
    Bad("inline pair of unknown links", {"robot.scara.self_pairs": [["base", "hand"]]}, "[0][1]", on=INLINE),
    Bad(
        "inline quill that is no solid of revolution",
        {"robot.scara.bodies": [{**ROD, "link": "quill"}]},
        "[0].shape",
        on=INLINE,
    ),
    Bad("inline body on no link", {"robot.scara.bodies": [ROD]}, "[0].link", on=INLINE),
    # start
    Bad("no start", {"start": GONE}),
    Bad("a joint left out", {"start.joints.j2_deg": GONE}, "start.joints.j2_rad"),
    Bad("joint in the wrong unit", {"start.joints.j3_deg": 0}),
    Bad("joint without unit", {"start.joints.j1": 0}),
    Bad("a start below its range", {"start.joints.j3_mm": 30}, said="133 to 333"),
    Bad("a start beyond a narrowed range", {"start.joints.j4_deg": 300}, said="-270 to 270"),
    Bad(
        "a start in radians beyond its range",
        {"start.joints": {"j1_rad": 0, "j2_rad": 9, "j3_m": 0.2, "j4_rad": 0}},
        ".j2_rad",
        "-2.53073 to 2.53073",
    ),
    Bad(
        "a start in metres taken for millimetres",
        {"start.joints": {"j1_deg": 17, "j2_deg": 68, "j3_m": 250, "j4_deg": 0}},
        ".j3_m",
        "0.133 to 0.333; did you mean j3_mm?",
    ),
    Bad(
        "a start faster than the arm",
        {"start.velocity": {"j1_deg_s": 0, "j2_deg_s": -800, "j3_mm_s": 0, "j4_deg_s": 0}},
        ".j2_deg_s",
        "-670 to 670",
    ),
    Bad(
        "a start that speeds up more than the arm",
        {"start.acceleration": {"j1_rad_s2": 80, "j2_rad_s2": 0, "j3_m_s2": 0, "j4_rad_s2": 0}},
        ".j1_rad_s2",
        "-75.384 to 75.384",
    ),
    Bad(
        "a start that speeds up more than its load leaves",
        {
            BY_LOAD: [share(0, 0.5), share(5, 0.5)],
            "start.acceleration": {"j1_rad_s2": 40, "j2_rad_s2": 0, "j3_m_s2": 0, "j4_rad_s2": 0},
        },
        ".j1_rad_s2",
        "-37.692 to 37.692 (with 0.45 kg at the flange the joints have 50 % of their acceleration)",
    ),
    Bad("velocity of one joint only", {"start.velocity": {"j1_deg_s": 5}}, ".j2_rad_s"),
    *(
        Bad(f"a start beyond a range of {model}", {"start.joints." + key: value}, said=said, on=on)
        for model, on, key, value, said in (
            ("a joint that counts downwards", FANUC, "j3_mm", -1, "0 to 200"),
            ("a lift that comes second", LAB, "j2_mm", 50, "60 to 420"),
            ("a joint after the lift", LAB, "j3_deg", 170, "-150 to 150"),
        )
    ),
    # frames
    Bad("frame without law", {"frames.belt": {}}),
    Bad("frame with two laws", {"frames.belt.fixed": {"at_m": [0, 0, 0]}}, "frames.belt.conveyor"),
    Bad("unknown law", {"frames.belt": {"teleport": {}}}, said="teleport is none of them"),
    Bad(
        "unknown field of a frame called like a field",
        {"frames.valid_s": {"conveyor": {"colour": 3}}},
        ".conveyor.colour",
        "one of at_m",
    ),
    Bad("frame called world", {"frames.world": {"fixed": {"at_m": [0, 0, 0]}}}),
    Bad("frame with a slash", {"frames.a/b": {"fixed": {"at_m": [0, 0, 0]}}}),
    Bad(
        "a frame on no frame",
        {"frames.nest": _on("blet")},
        ".fixed.frame",
        "one of belt, dial, gate, nest, world; did you",
    ),
    Bad("a frame on a neighbour's link", {"frames.nest": _on("other/flange")}, ".fixed.frame", "one of belt, dial"),
    Bad("a frame on itself", {"frames.nest": _on("nest")}, ".fixed.frame", "nest on nest"),
    Bad(
        "two frames on each other",
        {"frames.nest": _on("tray"), "frames.tray": _on("nest")},
        ".fixed.frame",
        "nest on tray on nest",
    ),
    Bad("a frame that is not fixed, on a frame", {"frames.belt.conveyor.frame": "dial"}),
    Bad(
        "an uncertain frame on a frame",
        {"frames.nest": _on("belt", uncertainty={"position_mm": 1})},
        ".uncertainty",
        "goes with belt and has its uncertainty",
    ),
    Bad(
        "a frame on a frame, known for a time",
        {"frames.nest": _on("dial", valid_s=[0, 1])},
        ".valid_s",
        "as long as dial",
    ),
    Bad("period of zero", {"frames.gate.swing.period_s": 0}),
    Bad("validity upside down", {"frames.belt.valid_s": [5, 1]}),
    Bad("validity of no duration", {"frames.belt.valid_s": [1, 1]}),
    Bad("negative uncertainty", {"frames.belt.uncertainty": {"position_mm": -1}}, ".position_mm"),
    Bad(
        "one keyframe",
        {"frames.gate": {"keyframes": {"points": [{"time_s": 0, "at_m": [0, 0, 0]}]}}},
        ".keyframes.points",
    ),
    Bad(
        "keyframes out of order",
        {"frames.gate": {"keyframes": {"points": [{"time_s": t, "at_m": [0, 0, 0]} for t in (1, 0)]}}},
        ".keyframes.points[1].time_s",
    ),
    Bad(
        "keyframes that repeat and do not come back",
        {"frames.gate": {"keyframes": {"points": KEYS, "repeat": True}}},
        ".keyframes.points[1].at_mm",
        "that of the first point",
    ),
    Bad(
        "keyframes that repeat from rest to rest",
        {"frames.gate": {"keyframes": {"points": [KEYS[0]] * 2, "repeat": True, "ends": "clamped"}}},
        ".keyframes.ends",
    ),
    Bad("oscillation to nowhere", {"frames.gate.oscillation.direction": [0, 0, 0]}, on=SWAYING),
    Bad("oscillation in metres", {"frames.gate.oscillation.direction": [0, 0, 300]}, "[2]", on=SWAYING),
    Bad("oscillation in a plane", {"frames.gate.oscillation.direction": [0, 1]}, on=SWAYING),
    Bad("oscillation with no period", {"frames.gate.oscillation.period_s": 0}, on=SWAYING),
    Bad("oscillation that is too quick", {"frames.gate.oscillation.period_s": 1e-4}, on=SWAYING),
    Bad(
        "overlapping changes of speed",
        {
            "frames.belt.conveyor.changes": [
                {"at_s": t, "speed_m_s": t, "acceleration_m_s2": 1e-3, "jerk_m_s3": 1} for t in (1, 2)
            ]
        },
        "[1].at_s",
    ),
    Bad(
        "a change of speed to no speed",
        {"frames.belt.conveyor.changes": [{"at_s": 1, "acceleration_m_s2": 1, "jerk_m_s3": 1}]},
        "[0].speed_m_s",
    ),
    Bad(
        "indexer that both turns and travels",
        {"frames.gate": {"indexer": {"at_m": [0, 0, 0], "step_deg": 9, "step_mm": 9, "move_s": 1, "dwell_s": 1}}},
        ".indexer.step_mm",
    ),
    # bodies
    Bad("two bodies of one name", {"bodies[+]": {**BOX, "name": "bed"}}, "bodies[4].name"),
    Bad("a body called like the tool's", {"bodies[+]": {**BOX, "name": "cup"}}, "bodies[4].name"),
    Bad("a body called like the robot's", {"bodies[+]": {**BOX, "name": "link-1"}}, "bodies[4].name"),
    Bad("name with a space", {"bodies[0].name": "belt bed"}),
    Bad("body without pose", {"bodies[0].pose": GONE}),
    Bad("body in an unknown frame", {"bodies[1].pose.frame": "bellt"}, said="mean belt?"),
    Bad("body in a frame and on a body", {"bodies[1].pose.body": "bed"}),
    Bad("body on a later body", {"bodies[0].pose": {"body": "plate", "at_mm": [0, 0, 0]}}, ".body"),
    Bad(
        "body on a part that is picked",
        {"bodies[+]": {**BOX, "pose": {"body": "part", "at_mm": [0, 0, 20]}}},
        "bodies[4].pose.body",
    ),
    Bad("a part that is tilted", {"bodies[1].pose.pitch_deg": 3}, said="0: a step picks part"),
    Bad("a tilt of no number", {"bodies[0].pose.roll_deg": "free"}),
    Bad("both units of a tilt", {"bodies[0].pose.roll_rad": 0.1, "bodies[0].pose.roll_deg": 3}),
    Bad("a tilt of a tool's body", {"robot.tool.bodies[0].pitch_deg": 3}),
    Bad("a time of a pose in no frame", {"bodies[0].pose.at_s": 1}, said="none: a pose relative to a body"),
    Bad("a time of a pose that is too late", {"bodies[1].pose.at_s": 1e6}, said="at most 100000"),
    Bad(
        "a time of a pose in keyframes",
        {"frames.gate": {"keyframes": {"points": KEYS}}, "bodies[2].pose.at_s": 0.5},
        said="none: gate states no single pose",
    ),
    Bad("a time of a target", {"task[2].move.to.at_s": 1}),
    Bad("no shape", {"bodies[0].shape": {}}),
    Bad("two shapes", {"bodies[0].shape.sphere": {"radius_mm": 3}}),
    Bad("negative size", {"bodies[0].shape.box.size_mm": [10, 10, -10]}, "[2]"),
    Bad("a sheet of nothing", {"bodies[0].shape.box.size_mm": [10, 10, 1e-4]}, "[2]"),
    Bad("unknown axis", {"bodies[2].shape.capsule.axis": "w"}),
    Bad("fraction of a symmetry", {"bodies[1].yaw_symmetry": 2.5}),
    # meshes
    Bad("mesh without unit", {"bodies[1].shape.mesh.unit": GONE}, said="one of m, mm, cm, in,"),
    Bad(
        "mesh as large as a hall",
        {"bodies[1].shape": {"mesh": {"asset": "bracket", "unit": "m"}}},
        ".mesh.unit",
        "m large; is the unit right?",
    ),
    Bad("mesh in furlongs", {"bodies[1].shape.mesh.unit": "furlong"}),
    Bad("asset that is not shipped", {"bodies[1].shape.mesh.asset": "teapot"}),
    Bad("asset by path", {"bodies[1].shape.mesh.asset": "../assets/bracket"}),
    Bad("robot by file", {"robot": {**BY_FILE, "file": "arm.yaml"}}, ".file"),
    Bad("robot by a path", {"robot": BY_FILE}, ".file"),
    Bad("model by path", {"robot.model": "../robots/lab-scara"}),
    Bad("mesh by file", {"bodies[1].shape.mesh": {"file": "bracket.stl", "unit": "mm"}}, ".file"),
    Bad("mesh by URL", {"bodies[1].shape.mesh": {"url": "http://localhost/x.stl", "unit": "mm"}}),
    Bad("mesh that is not base64", {"bodies[1].shape.mesh": {"data": "***", "format": "stl", "unit": "mm"}}, ".data"),
    Bad("mesh without format", {"bodies[1].shape.mesh": {"data": "AAAA", "unit": "mm"}}, ".format"),
    Bad("mesh as an archive", {"bodies[1].shape": _data(b"PK\x03\x04" + bytes(200))}, ".mesh.data"),
    Bad("mesh that is open", {"bodies[1].shape": _data(OPEN_STL + b"endsolid x\n")}, ".mesh.data"),
    Bad("mesh of the wrong format", {"bodies[1].shape": _data(OPEN_STL, "glb")}, ".mesh.data"),
    # neighbours
    Bad(
        "neighbour's joints of other names",
        {"neighbours[0].trajectory.joint_names": ["a", "b", "c", "d"]},
        on=NEIGHBOUR,
    ),
    Bad(
        "neighbour's joints in degrees",
        {"neighbours[0].trajectory.joint_units": ["deg", "deg", "mm", "deg"]},
        "[0]",
        on=NEIGHBOUR,
    ),
    Bad("neighbour's rows too few", {"neighbours[0].trajectory.position": [[0.0] * 4] * 3}, on=NEIGHBOUR),
    Bad(
        "neighbour's row too short", {"neighbours[0].trajectory.velocity": [[0.0] * 4, [0.0] * 3]}, "[1]", on=NEIGHBOUR
    ),
    Bad("neighbour's times backwards", {"neighbours[0].trajectory.time_s": [1.0, 0.0]}, "[1]", on=NEIGHBOUR),
    Bad("neighbour that never stops", {"neighbours[0].trajectory.velocity": [[0.0] * 4, [0.1, 0, 0, 0]]}, on=NEIGHBOUR),
    Bad(
        "neighbour by a plan's file",
        {"neighbours[0].trajectory": GONE, "neighbours[0].plan": {"file": "other.json"}},
        ".file",
        on=NEIGHBOUR,
    ),
    Bad(
        "neighbour by a path",
        {"neighbours[0].trajectory": GONE, "neighbours[0].plan": {"file": "/etc/passwd"}},
        ".file",
        on=NEIGHBOUR,
    ),
    Bad(
        "neighbour that does nothing",
        {"neighbours[0].trajectory": GONE},
        "neighbours[0]",
        "exactly one of trajectory, plan",
        on=NEIGHBOUR,
    ),
    # task
    Bad("no task", {"task": GONE}),
    Bad("empty task", {"task": []}),
    Bad("too many steps", {"task": [{"move": {"to": {"at_mm": [350, 0, 120]}}}] * 65}),
    Bad("step of two kinds", {"task[2].follow": {}}),
    Bad("step of no kind", {"task[2]": {}}),
    Bad("step of a misspelt kind", {"task[2]": {"mvoe": {}}}, said="none of them, did you mean move?"),
    Bad(
        "target in metres taken for millimetres",
        {"task[2].move.to": {"at_m": [350, 0, 120]}},
        ".at_m[0]",
        "did you mean at_mm?",
    ),
    Bad(
        "target on the part in the gripper",
        {"task[1]": {"move": {"to": {"body": "part", "at_mm": [0, 0, 50]}}}},
        ".move.to.body",
    ),
    Bad("two steps of one name", {"task[2].move.name": "pick-1"}),
    Bad("part that is not there", {"task[0].pick.part": "angel"}, said="bar, bed, part, plate"),
    Bad("part that is misspelt", {"task[0].pick.part": "parrt"}, said="did you mean part?"),
    Bad(
        "a grasp turned by a wrist that is not there",
        {
            "robot.model": "oviedo-scara",
            "robot.limits": GONE,
            "start.joints": {"theta1_deg": 0, "theta2_deg": 60, "l3_mm": 50},
            "task[0].pick.grasp_yaw_deg": 90,
        },
    ),
    Bad("place before pick", {"task[0]": GONE}, ".place.part"),
    Bad("place of another part", {"task[1].place.part": "bed"}),
    Bad("a second pick with a full gripper", {"task[1]": GOOD_REQUEST["task"][0]}, ".pick.part"),
    Bad("place without yaw", {"task[1].place.to.yaw_deg": GONE}, "task[1].place.to.yaw_rad"),
    Bad(
        "place with a free yaw",
        {"task[1].place.to": {"frame": "dial", "at_mm": [150, 0, 10], "yaw_free": True}},
        ".yaw_free",
    ),
    Bad("yaw and free yaw", {"task[2].move.to": {"at_m": [0.3, 0, 0.1], "yaw_deg": 3, "yaw_free": True}}, ".yaw_free"),
    Bad("a pitch of a SCARA", {"task[2].move.to.pitch_deg": -90}),
    Bad("a free roll of a SCARA", {"task[2].move.to.roll_deg": "free"}),
    Bad("a pitch in words", {"task[2].move.to.pitch_rad": "down"}),
    Bad("a pitch of many turns", {"task[2].move.to.pitch_deg": 1e6}),
    Bad("a roll that is a truth", {"task[2].move.to.roll_deg": True}),
    Bad("target in an unknown frame", {"task[1].place.to.frame": "dail"}, said="mean dial?"),
    Bad("window in millimetres on a dial", {"task[1].place.window_mm": [0, 1]}),
    Bad("window upside down", {"task[0].pick.window_mm": [250, -300]}, said="250 is not below -300"),
    Bad("approach without its unit", {"task[0].pick.approach": 30}, said="did you mean {mm: 30}?"),
    Bad("approach left out", {"task[0].pick.approach": GONE}, said="fields: m/mm, stop, which must"),
    Bad("negative approach", {"task[0].pick.approach": {"mm": -3}}, ".mm"),
    Bad("no dwell", {"task[0].pick.dwell_ms": GONE}, "task[0].pick.dwell_s"),
    Bad(
        "grip within a distance, by a tool without bodies",
        {"robot.tool.bodies": GONE, "task[0].pick.grip_within_mm": 1},
        said="none: the tool has no bodies",
    ),
    Bad("grip within less than nothing", {"task[0].pick.grip_within_mm": -1}),
    Bad("grip of a place", {"task[1].place.grip_within_mm": 1}),
    Bad("support of a pick", {"task[0].pick.support_within_mm": 1}),
    Bad("support beyond a hall", {"task[1].place.support_within_mm": 1e9}),
    Bad(
        "support within a distance, by nothing that is named",
        {"task[1].place.contact_with": GONE, "task[1].place.support_within_mm": 1},
        said="none without contact_with",
    ),
    Bad("contact with what is not there", {"task[1].place.contact_with": ["table"]}, "[0]"),
    Bad("contact of the part with itself", {"task[1].place.contact_with": ["part"]}, "[0]"),
    Bad("unknown manner", {"task[2].move.match": "roughly"}),
    Bad("a pick without a wrist", {"task[1]": GOOD_REQUEST["task"][0]}, ".pick", on=THREE_AXES),
    Bad("an arch without a lift", {"task[1].move.arch": {"top_mm": 400}}, on=THREE_AXES),
    Bad("a free yaw without a wrist", {"task[1].move.to.yaw_free": True}, on=THREE_AXES),
    Bad(
        "a free yaw of a follow without a wrist",
        {"task[1]": {"follow": {"to": {"at_mm": [300, 0, 300], "yaw_free": True}, "duration_s": 1}}},
        ".follow.to.yaw_free",
        on=THREE_AXES,
    ),
    Bad(
        "a via whose manner is left out",
        {
            "options": {"timing": "parabolic_blend"},
            "task": [STOP, {"move": {"to": {"frame": "dial", "at_mm": [0, 0, 100], "yaw_deg": 0}, "via": True}}, STOP],
        },
        "[1].move.match",
    ),
    # options, execution, carry
    Bad("no time at all", {"options.budget_s": 0}),
    Bad("all day", {"options.budget_s": 86400}),
    Bad("a fraction of a seed", {"options.seed": 1.5}),
    Bad("negative seed", {"options.seed": -1}),
    Bad("one clearance", {"options": {"clearance_mm": 5}}, ".clearance_mm", "fields: travel, near"),
    Bad("one clearance for both", {"options.clearance_mm": {"travel": 8}}, ".near"),
    Bad("negative clearance", {"options.clearance_mm": {"travel": 8, "near": -1}}, ".near"),
    Bad("margin of one", {"options.singularity_margin": 1}),
    Bad("unknown elbow", {"options.elbow": "up"}),
    Bad("text for a boolean", {"execution": {"belt_correction": "yes"}}, ".belt_correction"),
    Bad(
        "carry limit that only rounds", {"carry": {"acceleration_m_s2": 5e-324}}, ".acceleration_m_s2", "at least 1e-06"
    ),
    Bad("scale that only rounds", {"robot.limits.velocity": 1e-310}, said="at least 1e-06"),
    Bad(
        "approach that is 0 in metres",
        {"task[0].pick.approach": {"mm": 5e-324}},
        ".mm",
        "a number that is not rounded to 0 in m",
    ),
    Bad("carry limit of zero", {"carry": {"acceleration_m_s2": 0}}, ".acceleration_m_s2"),
)
