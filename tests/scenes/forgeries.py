"""Answers that lie: each a true answer of a cell, changed so that it says what is not so.

A forger knows the product: digests are made to fit, and a plan that is shown for another request repeats what that
request says. `FORGERIES` is the table that `test_forged_answers` goes through.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from tests.scenes.forged_cells import Document

Change = Callable[[Document], object]


@dataclass(frozen=True)
class Forgery:
    """A lie: the cell whose answer is changed, what is changed in it, and the request for which it is shown (None: its
    own). `sealed`: whether the digest of the certificate is made to fit."""

    name: str
    cell: str
    change: Change
    request: Change | None = None
    sealed: bool = True

    def __str__(self) -> str:
        return self.name.replace(" ", "-")


def at(inside: Any, path: Sequence[str | int]) -> Any:
    """What is at the end of a path of keys."""
    for key in path:
        inside = inside[key]
    return inside


def put(*path_and_value: Any) -> Change:
    """Sets the field at a path to a value."""
    *path, value = path_and_value

    def change(answer: Document) -> None:
        at(answer, path[:-1])[path[-1]] = value

    return change


def add(*path_and_amount: Any) -> Change:
    """Adds an amount to the number at a path."""
    *path, amount = path_and_amount

    def change(answer: Document) -> None:
        at(answer, path[:-1])[path[-1]] += amount

    return change


def scale(*path_and_factor: Any) -> Change:
    """Multiplies the number at a path."""
    *path, factor = path_and_factor

    def change(answer: Document) -> None:
        at(answer, path[:-1])[path[-1]] *= factor

    return change


def drop(*path: Any) -> Change:
    """Removes the field or the item at a path."""

    def change(answer: Document) -> None:
        del at(answer, path[:-1])[path[-1]]

    return change


def both(*changes: Change) -> Change:
    """One change after the other."""

    def change(answer: Document) -> None:
        for each in changes:
            each(answer)

    return change


def nothing(answer: Document) -> None:
    """The answer as it is: the lie is in the request that it is shown for."""


def rows(keep: Callable[[int], bool]) -> Change:
    """Keeps those rows of the certificate that `keep` says."""

    def change(answer: Document) -> None:
        certificate = answer["certificate"]
        kept = [i for i in range(certificate["rows"]) if keep(i)]
        for key, column in certificate.items():
            if isinstance(column, list) and key not in ("names", "covers"):
                certificate[key] = [column[i] for i in kept]
        certificate["rows"] = len(kept)

    return change


def each_row(column: str, turned: Callable[[Any], Any]) -> Change:
    """Changes a column of the certificate."""

    def change(answer: Document) -> None:
        answer["certificate"][column] = [turned(value) for value in answer["certificate"][column]]

    return change


def minus(vector: list[float]) -> list[float]:
    return [-x for x in vector]


def legs_of(answer: Document, kind: str) -> list[Document]:
    return [leg for leg in answer["legs"] if leg["kind"] == kind]


def edge(kind: str, later_s: float) -> Change:
    """The first leg of a kind begins later, and the leg before it ends later."""

    def change(answer: Document) -> None:
        number = next(i for i, leg in enumerate(answer["legs"]) if leg["kind"] == kind)
        answer["legs"][number]["from_s"] += later_s
        answer["legs"][number - 1]["to_s"] += later_s

    return change


def quicker(factor: float) -> Change:
    """The whole motion in less time."""

    def change(answer: Document) -> None:
        knots = answer["trajectory"]
        knots["time_s"] = [t * factor for t in knots["time_s"]]
        for name, power in (("velocity", 1), ("acceleration", 2)):
            knots[name] = [[x / factor**power for x in row] for row in knots[name]]
        for leg in answer["legs"]:
            leg["from_s"], leg["to_s"] = leg["from_s"] * factor, leg["to_s"] * factor
        for arrival in answer["arrivals"]:
            arrival["time_s"], arrival["until_s"] = arrival["time_s"] * factor, arrival["until_s"] * factor
        answer["duration_s"] *= factor
        certificate = answer["certificate"]
        for name in ("t0_s", "t1_s"):
            certificate[name] = [t * factor for t in certificate[name]]

    return change


def body(name: str, at_m: list[float], size_m: float) -> Change:
    """One more box in the request."""

    def change(request: Document) -> None:
        box = {"name": name, "shape": {"box": {"size_m": [size_m] * 3}}, "pose": {"at_m": at_m}}
        request["bodies"] = [*request["bodies"], box]

    return change


def repeated_step(request: Document) -> None:
    request["task"] = [*request["task"], copy.deepcopy(request["task"][-1])]


def option(name: str, value: Any) -> Change:
    """Another option in the request, in place of one in another unit."""

    def change(request: Document) -> None:
        request["options"] = {**request.get("options", {}), name: value}

    return change


def execution(**fields: Any) -> Change:
    def change(request: Document) -> None:
        request["execution"] = {**request.get("execution", {}), **fields}

    return change


def extra(*path: Any) -> Change:
    """A field that no answer has."""

    def change(answer: Document) -> None:
        at(answer, path)["certified"] = "TUV"

    return change


SAFE = "Certified safe under ISO 10218."
FIRST, SECOND = ("arrivals", 0), ("arrivals", 1)
TASK = ("task", 0, "move")


def _moved_knot(column: str, amount: float) -> Change:
    def change(answer: Document) -> None:
        knots = answer["trajectory"][column]
        knots[len(knots) // 2][0] += amount

    return change


OF_THE_PROOF = (
    Forgery("a digest that does not fit", "demo", put("certificate", "digest", "0" * 64), sealed=False),
    Forgery("a digest of another plan", "demo", add("trajectory", "time_s", -1, 1e-7), sealed=False),
    Forgery("a row is left out", "demo", rows(lambda i: i != 17)),
    Forgery("all rows are left out", "demo", rows(lambda _: False)),
    Forgery("normals are turned round", "demo", each_row("normal", minus)),
    Forgery("normals are longer", "demo", each_row("normal", lambda n: [1.001 * x for x in n])),
    Forgery("rows of the first body are of another", "demo", each_row("first", lambda _: 1)),
    Forgery("rows of no body", "demo", each_row("first", lambda _: 10_000)),
    Forgery("rows of pieces that there are not", "demo", each_row("first_piece", lambda _: 999)),
    Forgery("rows begin later", "demo", each_row("t0_s", lambda t: t + 1e-3)),
    Forgery("rows across phases", "demo", each_row("t1_s", lambda t: t + 0.5)),
    Forgery("names are exchanged", "demo", lambda a: a["certificate"]["names"].reverse()),
    Forgery("names twice", "demo", lambda a: a["certificate"]["names"].append(a["certificate"]["names"][0])),
    Forgery("unknown names", "demo", lambda a: a["certificate"]["names"].append("guard")),
    Forgery("covers less", "demo", lambda a: a["certificate"]["covers"].pop()),
    Forgery("covers more", "demo", lambda a: a["certificate"]["covers"].append("force")),
    Forgery("covers the jerk of blends", "blended", lambda a: a["certificate"]["covers"].append("jerk")),
    Forgery("more rows than there are", "demo", add("certificate", "rows", 1)),
    Forgery("a number of the proof that must be believed", "demo", lambda a: a["certificate"].update(gap_m=[1.0])),
)

OF_THE_MOTION = (
    Forgery("a duration 10 ms shorter", "demo", add("duration_s", -0.01)),
    Forgery("another start", "demo", add("start_s", 0.01)),
    Forgery("one percent faster", "demo", quicker(0.99)),
    Forgery("a knot moved by 1 µrad", "demo", _moved_knot("position", 1e-6)),
    Forgery("a knot faster by 1 mrad/s", "demo", _moved_knot("velocity", 1e-3)),
    Forgery("a knot with another acceleration", "demo", _moved_knot("acceleration", 1.0)),
    Forgery("jumps of the acceleration", "demo", put("trajectory", "acceleration_jumps", True)),
    Forgery("no jumps of the acceleration", "blended", put("trajectory", "acceleration_jumps", False)),
    Forgery("other names of joints", "demo", lambda a: a["trajectory"]["joint_names"].reverse()),
    Forgery("other units of joints", "demo", put("trajectory", "joint_units", 2, "rad")),
    Forgery("a move is called an approach", "demo", put("legs", 0, "kind", "APPROACH")),
    Forgery("a move is called an arch", "demo", put("legs", 0, "kind", "ARCH")),
    Forgery("a part is taken early", "demo", edge("DEPART", -0.02)),
    Forgery("an approach is longer", "demo", edge("APPROACH", -0.05)),
    Forgery("a depart is shorter", "demo", lambda a: (edge("DEPART", 0.0)(a), a["legs"][4].update(
        from_s=a["legs"][4]["from_s"] - 0.02), a["legs"][3].update(to_s=a["legs"][3]["to_s"] - 0.02))),
    Forgery("a leg for another step", "demo", put("legs", 8, "step", 1)),
    Forgery("a leg for no step", "demo", put("legs", 8, "step", 7)),
    Forgery("a leg is left out", "demo", drop("legs", 8)),
    Forgery("no legs", "demo", put("legs", [])),
    Forgery("a wait that is none", "waiting", lambda a: a["legs"][1].update(kind="WAIT")),
)  # fmt: skip

OF_ARRIVALS = (
    Forgery("a yaw offset of a quarter", "demo", put(*FIRST, "yaw_offset_rad", 1.5707963267948966)),
    Forgery("a yaw offset of the other half", "demo", put(*FIRST, "yaw_offset_rad", 0.0)),
    Forgery("a yaw offset of an arm without yaw", "elbow-arm", put(*FIRST, "yaw_offset_rad", 0.5)),
    Forgery("a pose 10 µm beside", "demo", add(*FIRST, "at_m", 0, 1e-5)),
    Forgery("another yaw", "demo", add(*FIRST, "yaw_rad", 1e-4)),
    Forgery("1 mm more along the conveyor", "demo", add(*FIRST, "along_m", 1e-3)),
    Forgery("along a conveyor where there is none", "demo", put(*SECOND, "along_m", 123.0)),
    Forgery("not along the conveyor that there is", "demo", put(*FIRST, "along_m", None)),
    Forgery("met 1 ms earlier", "demo", both(add(*FIRST, "time_s", -1e-3), add(*FIRST, "until_s", -1e-3))),
    Forgery("left later", "demo", add(*FIRST, "until_s", 1e-3)),
    Forgery("another control point", "demo", put(*FIRST, "control_point", "pick-9")),
    Forgery("arrivals are exchanged", "demo", lambda a: a["arrivals"].reverse()),
    Forgery("an arrival is left out", "demo", drop("arrivals", 2)),
    Forgery("not matched", "demo", put(*FIRST, "matched", False)),
    Forgery("a via is matched", "blended", put(*FIRST, "matched", True)),
    Forgery("other joints", "demo", add(*FIRST, "joints", 0, 1e-6)),
    Forgery("another mode", "demo", put(*FIRST, "mode", "left")),
    Forgery("a via is not missed", "blended", put(*FIRST, "missed_by", None)),
    Forgery("a via is missed by less", "blended", scale(*FIRST, "missed_by", "distance_m", 0.5)),
    Forgery("joints miss by less", "blended", scale(*FIRST, "missed_by", "joints", 0, 0.5)),
    Forgery("a point is missed that is met", "demo", put(*FIRST, "missed_by", {"joints": [0.0] * 4, "distance_m": 0})),
    Forgery("another pitch", "rv-m1", add(*FIRST, "pitch_rad", 1e-3)),
    Forgery("another roll", "rv-m1", add(*FIRST, "roll_rad", 1e-3)),
    Forgery("a pitch of an arm that has none", "demo", put(*FIRST, "pitch_rad", 0.0)),
    Forgery("a trace that is none", "demo", put(*FIRST, "trace", {
        "length_m": 0.1, "slowest_m_s": 0.1, "fastest_m_s": 0.1, "error_m": 0.0})),
    Forgery("a trace that is not said", "traced", put(*FIRST, "trace", None)),
    Forgery("a longer trace", "traced", add(*FIRST, "trace", "length_m", 1e-6)),
    Forgery("a steadier trace", "traced", lambda a: a["arrivals"][0]["trace"].update(
        slowest_m_s=0.15, fastest_m_s=0.15)),
    Forgery("a more exact trace", "traced", scale(*FIRST, "trace", "error_m", 0.1)),
)  # fmt: skip

OF_ERRORS = (
    Forgery("a smaller error", "demo", scale(*FIRST, "error", "position_m", 0.9)),
    Forgery("a larger error", "demo", scale(*FIRST, "error", "position_m", 2.0)),
    Forgery("a smaller error to the side", "demo", scale(*FIRST, "error", "horizontal_m", 0.9)),
    Forgery("a larger error to the side", "demo", scale(*FIRST, "error", "horizontal_m", 2.0)),
    Forgery("an error of the height", "demo", put(*FIRST, "error", "vertical_m", 0.01)),
    Forgery("an error of the yaw", "demo", put(*FIRST, "error", "yaw_rad", 0.01)),
    Forgery("no error", "demo", put(*FIRST, "error", None)),
    Forgery("an error where all is known", "known", put(*FIRST, "error", {
        "position_m": 0.0, "horizontal_m": 0.0, "vertical_m": 0.0, "yaw_rad": 0.0, "causes": [], "worst": []})),
    Forgery("another cause", "demo", put(*FIRST, "error", "causes", 0, "cause", "servo lag")),
    Forgery("a cause adds less", "demo", scale(*FIRST, "error", "causes", 0, "position_m", 0.5)),
    Forgery("a cause adds more", "demo", scale(*FIRST, "error", "causes", 0, "position_m", 2.0)),
    Forgery("a cause adds yaw", "demo", put(*FIRST, "error", "causes", 0, "yaw_rad", 0.01)),
    Forgery("no causes", "demo", put(*FIRST, "error", "causes", [])),
    Forgery("a cause too many", "demo", lambda a: a["arrivals"][0]["error"]["causes"].append(
        {"cause": "servo lag", "position_m": 0.0, "yaw_rad": 0.0})),
    Forgery("causes in another order", "uncertain", lambda a: a["arrivals"][0]["error"]["causes"].reverse()),
    Forgery("a worst case that is none", "demo", put(*FIRST, "error", "worst", [])),
    Forgery("a worst case of something else", "demo", put(*FIRST, "error", "worst", 0, "what", "dial along")),
    Forgery("half a worst case", "demo", put(*FIRST, "error", "worst", 0, "value", 0.5)),
    Forgery("a worst case that is not the worst", "uncertain", lambda a: a["arrivals"][0]["error"]["worst"][0].update(
        value=-a["arrivals"][0]["error"]["worst"][0]["value"])),
)  # fmt: skip

OF_MARGINS = (
    Forgery("nothing is nearer than 1 m", "demo", put("margins", "nearest", "gap_m", 1.0)),
    Forgery("0.1 mm more is left", "demo", add("margins", "nearest", "gap_m", 1e-4)),
    Forgery("1 mm less is left", "demo", add("margins", "nearest", "gap_m", -1e-3)),
    Forgery("nothing is near", "demo", put("margins", "nearest", None)),
    Forgery("another pair is nearest", "demo", put("margins", "nearest", "bodies", ["cup", "belt-bed"])),
    Forgery("nearest at another time", "demo", add("margins", "nearest", "time_s", 0.05)),
    Forgery("nearest in another phase", "demo", put("margins", "nearest", "phase", "FOLLOW")),
    Forgery("what was put down is farther", "put-down", add("margins", "placed", "gap_m", 1e-4)),
    Forgery("what was put down is nearer", "put-down", add("margins", "placed", "gap_m", -1e-3)),
    Forgery("nothing was put down", "put-down", put("margins", "placed", None)),
    Forgery("the arm's clearance for what was put down", "put-down", lambda a: a["margins"].update(
        placed=a["margins"]["nearest"])),
    Forgery("what was put down for the arm's clearance", "put-down", lambda a: a["margins"].update(
        nearest=a["margins"]["placed"])),
    Forgery("the arm is farther than it is", "put-down", add("margins", "nearest", "gap_m", 1e-3)),
    Forgery("something was put down", "demo", lambda a: a["margins"].update(placed=a["margins"]["nearest"])),
    Forgery("a pair that is not so near", "demo", add("margins", "travel_pairs", 1, "gap_m", -1e-3)),
    Forgery("a near pair that is not so near", "demo", add("margins", "near_pairs", 0, "gap_m", -1e-3)),
    Forgery("a slower joint", "demo", scale("margins", "peaks", 0, "velocity", 0.9)),
    Forgery("a faster joint", "demo", scale("margins", "peaks", 0, "velocity", 1.1)),
    Forgery("a gentler joint", "demo", scale("margins", "peaks", 0, "acceleration", 0.9)),
    Forgery("a joint with less jerk", "demo", scale("margins", "peaks", 0, "jerk", 0.9)),
    Forgery("a smaller share of a limit", "demo", scale("margins", "peaks", 0, "velocity_ratio", 0.9)),
    Forgery("a joint is left out", "demo", drop("margins", "peaks", 0)),
    Forgery("a slower tool", "demo", scale("margins", "tool", "speed_m_s", 0.5)),
    Forgery("fastest at another time", "demo", add("margins", "tool", "speed_at_s", 0.1)),
    Forgery("a gentler tool", "demo", scale("margins", "tool", "acceleration_m_s2", 0.5)),
    Forgery("a part is carried more gently", "demo", scale("margins", "tool_acceleration_m_s2", 0.5)),
    Forgery("a part is carried 3 % more gently", "demo", scale("margins", "tool_acceleration_m_s2", 0.97)),
    Forgery("a five-bar carries more gently", "five-bar", scale("margins", "tool_acceleration_m_s2", 0.97)),
    Forgery("a part is carried harder", "demo", scale("margins", "tool_acceleration_m_s2", 1.5)),
    Forgery("a limit of the carried part", "demo", put("margins", "tool_acceleration_limit_m_s2", 30.0)),
    Forgery("farther from a singular position", "demo", put("margins", "singularity", 0.99)),
    Forgery("nearer to a singular position", "demo", scale("margins", "singularity", 0.5)),
    Forgery("no singular position", "demo", put("margins", "singularity", None)),
    Forgery("an elbow arm is farther from a singular position", "elbow-arm", add("margins", "singularity", 0.05)),
    Forgery("a five-bar is farther from a singular position", "five-bar", add("margins", "singularity", 0.05)),
    Forgery("a five-bar is farther from type 2", "five-bar", add("margins", "parallel", 0.05)),
    Forgery("a five-bar is nearer to type 2", "five-bar", scale("margins", "parallel", 0.5)),
    Forgery("a closed chain that there is not", "demo", put("margins", "parallel", 0.9)),
    Forgery("an unbounded jerk", "demo", put("margins", "jerk", "unbounded")),
    Forgery("a limited jerk", "blended", put("margins", "jerk", "limited")),
)  # fmt: skip

OF_THE_REST = (
    Forgery("no contacts", "demo", put("contacts", [])),
    Forgery("a contact more", "demo", lambda a: a["contacts"].append(
        {"bodies": ["bar", "cup"], "from_s": 0.9, "to_s": 1.1})),
    Forgery("a contact that lasts longer", "demo", add("contacts", 1, "to_s", 0.1)),
    Forgery("no assumptions", "demo", put("assumptions", [])),
    Forgery("another notice", "demo", put("notice", SAFE)),
    Forgery("a digest of another request", "demo", put("request_digest", "0" * 64)),
    Forgery("another seed", "demo", put("seed", 77)),
    Forgery("a warning of no kind", "floating", lambda a: a["warnings"][0].update(kind="SAFE")),
    Forgery("a warning with a word more", "floating", extra("warnings", 0)),
    Forgery("a lighter part", "heavy", scale("load", "carried", 1, "mass_kg", 0.5)),
    Forgery("less inertia", "heavy", scale("load", "carried", 1, "inertia_kgm2", 0.5)),
    Forgery("a larger share of the acceleration", "heavy", put("load", "carried", 1, "acceleration_share", 1.0)),
    Forgery("carried for less time", "heavy", add("load", "carried", 1, "to_s", -0.1)),
    Forgery("another rated load", "heavy", put("load", "rated_kg", 50.0)),
    Forgery("another law of loads", "heavy", put("load", "law", "none")),
    Forgery("a field that no answer has", "demo", extra()),
    Forgery("a margin that no answer has", "demo", extra("margins")),
    Forgery("a peak that no answer has", "demo", extra("margins", "peaks", 0)),
    Forgery("a word in the census", "demo", extra("census")),
    Forgery("a word in an arrival", "demo", extra("arrivals", 0)),
    Forgery("a word in a leg", "demo", extra("legs", 0)),
    Forgery("a word in a route", "demo", extra("legs", 0, "route")),
    Forgery("a word in a load", "demo", extra("load")),
    Forgery("a word in the certificate", "demo", extra("certificate")),
    Forgery("a word in the trajectory", "demo", extra("trajectory")),
    Forgery("a word in a contact", "demo", extra("contacts", 0)),
    Forgery("another schema", "demo", put("schema", "assur/2")),
    Forgery("a census that counts words", "demo", put("census", "candidates", SAFE)),
    Forgery("a time that is a word", "demo", put("elapsed_s", SAFE)),
    Forgery("a clock that certifies", "demo", put("cut_by_clock", SAFE)),
)  # fmt: skip

SHOWN_FOR_ANOTHER_REQUEST = (
    Forgery("1 mm more clearance", "demo", nothing, option("clearance_mm", {"travel": 14, "near": 2.5})),
    Forgery("a late dispatch", "demo", nothing, execution(start_tolerance_s=0.1)),
    Forgery("servo lag", "demo", nothing, execution(lag={"j1_rad": 0.02, "j2_rad": 0.02})),
    Forgery("a faster gate", "demo", nothing, put("frames", "gate", "swing", "period_s", 1.2)),
    Forgery("a longer standstill", "demo", nothing, option("stay_safe_s", 3.0)),
    Forgery("one more step", "demo", nothing, repeated_step),
    Forgery("smaller limits", "demo", nothing, put("robot", "limits", "acceleration", 0.3)),
    Forgery("a limit of the carried acceleration", "demo", nothing, put("carry", {"acceleration_m_s2": 5.0})),
    Forgery("one more body near", "demo", nothing, body("guard", [0.35, 0.0, 0.15], 0.02)),
    Forgery("one more body far", "demo", nothing, body("fence", [3.0, 0.0, 0.5], 0.1)),
    Forgery("another part", "demo", nothing, put("bodies", 1, "pose", "at_mm", [-440, 0, 10])),
    Forgery("a latest end", "demo", nothing, option("latest_end_s", 1.0)),
    Forgery("another window", "demo", nothing, put("task", 0, "pick", "window_mm", [-200, 250])),
    Forgery("a longer dwell", "demo", nothing, put("task", 0, "pick", "dwell_ms", 90)),
    Forgery("a higher approach", "demo", nothing, put("task", 0, "pick", "approach", {"mm": 31})),
    Forgery("a depart with a stop", "demo", nothing, put("task", 0, "pick", "depart", {"mm": 40, "stop": True})),
    Forgery("a tolerance", "demo", nothing, put("task", 0, "pick", "tolerance_mm", 0.5)),
    Forgery("forbidden yaws", "demo", nothing, put("robot", "limits", "forbidden_yaw_deg", [[200, 260]])),
    Forgery("an arch", "demo", nothing, put("task", 2, "move", "arch", {"top_mm": 200})),
    Forgery("a singularity margin", "demo", nothing, option("singularity_margin", 0.99)),
    Forgery("a singularity margin of an elbow arm", "elbow-arm", nothing, option("singularity_margin", 0.95)),
    Forgery("a singularity margin of a straight leg", "line", nothing, option("singularity_margin", 0.99)),
    Forgery("a singularity margin of a five-bar", "five-bar", nothing, option("singularity_margin", 0.99)),
    Forgery("another elbow", "demo", nothing, option("elbow", "left")),
    Forgery("another elbow of an elbow arm", "elbow-arm", nothing, option("elbow", "down")),
    Forgery("another elbow of a five-bar", "five-bar", nothing, option("elbow", "right-left")),
    Forgery("the elbow of the start", "blended", nothing, option("elbow", "keep")),
    Forgery("a straight leg", "demo", nothing, put("task", 2, "move", "leg", "cartesian")),
    Forgery("a straight leg of an elbow arm", "bent-elbow", nothing, put(*TASK, "leg", "cartesian")),
    Forgery("a straight leg from a belt", "off-belt", nothing, put("task", 1, "move", "leg", "cartesian")),
    Forgery("a via", "stopped", nothing, put(*TASK, "via", True)),
    Forgery("a blended via", "blended-stop", both(put(*FIRST, "matched", False), put(
            *FIRST, "missed_by", {"joints": [0.0] * 4, "distance_m": 0.0})), put(*TASK, "via", True)),
    Forgery("the end at rest", "moving", nothing, option("end", "rest")),
    Forgery("a point at rest", "belt", nothing, put("task", 0, "follow", {
        "to": {"at_m": [0.2, 0.35, 0.08], "yaw_free": True}, "duration_ms": 100})),
    Forgery("a kept yaw", "stopped", nothing, put(*TASK, "to", {"at_mm": [250, 250, 150], "yaw_keep": True})),
    Forgery("a correction for the belt", "demo", nothing, execution(belt_correction=True)),
    Forgery("an acceleration time", "blended", nothing, option("acceleration_time_ms", 210)),
)  # fmt: skip

FORGERIES = (
    *OF_THE_PROOF,
    *OF_THE_MOTION,
    *OF_ARRIVALS,
    *OF_ERRORS,
    *OF_MARGINS,
    *OF_THE_REST,
    *SHOWN_FOR_ANOTHER_REQUEST,
)
