"""Forged claims: each says something false, or has lost a part of its proof. A forgery changes the bundle of a shipped
scenario."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from assur.planner.checker.verdict import Code
from assur.planner.claim.columns import Claim
from tests.forgeries.changes import Change, Document, both, places, plus, put, times
from tests.forgeries.stated import STATED
from tests.planner.claim import reading

T = Code


def read(document: Document) -> Claim:
    """The tables of a bundle. Raises `InputError`."""
    return reading.read(document)[0]


class Forgery(NamedTuple):
    """What is forged, in which scenario's claim, how, and the code of a finding (None: reading refuses it)."""

    what: str
    scenario: str
    change: Change
    code: Code | None


def body(document: Document, name: str) -> int:
    return [each["name"] for each in document["bodies"]].index(name)


def lasting(document: Document) -> list[Document]:
    """Rows that take time."""
    return [row for row in document["rows"] if row["t1"] > row["t0"]]


def law_of(document: Document) -> Document:
    """The first frame with a law."""
    return next(frame for frame in document["frames"] if frame["edges"])


def moved(name: str, axis: int, by: float) -> Change:
    """A body has other places on what it sits on."""

    def change(document: Document) -> None:
        for seat in document["seats"]:
            if seat["body"] == body(document, name):
                seat["pose"][axis] += by

    return change


def without_pair(document: Document) -> None:
    """No row of the first pair of the second phase that has one."""
    begin, end = document["phases"][1]["t0"], document["phases"][1]["t1"]
    first = next(row for row in lasting(document) if begin <= row["t0"] and row["t1"] <= end)
    document["rows"] = [
        row for row in document["rows"] if not (row["bodies"] == first["bodies"] and begin <= row["t0"] < end)
    ]


def without_put_down(document: Document) -> None:
    """No row of two bodies that are both on frames."""
    phases, seats = document["phases"], document["seats"]
    on_frames = [{seats[k]["body"] for k in phase["seats"] if seats[k]["frame"] >= 0} for phase in phases]

    def is_of_frames(row: Document) -> bool:
        return set(row["bodies"]) <= on_frames[max(k for k, phase in enumerate(phases) if phase["t0"] <= row["t0"])]

    document["rows"] = [row for row in document["rows"] if not is_of_frames(row)]


def without_phase(number: int) -> Change:
    """A phase and the rows that are about it are left out; rows of later phases follow."""

    def change(document: Document) -> None:
        document["phases"].pop(number)
        gone = number % (len(document["phases"]) + 1)
        for table in filter(lambda each: isinstance(each, list), document.values()):
            table[:] = [row for row in table if row.get("phase") != gone]
            for row in table:
                if row.get("phase", gone) > gone:
                    row["phase"] -= 1

    return change


def swapped(document: Document) -> None:
    """The bodies of all rows change places."""
    for row in document["rows"]:
        row.update(bodies=row["bodies"][::-1], pieces=row["pieces"][::-1])


def seen_from_other_side(document: Document) -> None:
    """Rows are of the same bodies, with the other one first."""
    swapped(document)
    put("rows.*.normal", times(-1.0))(document)


def of_first_piece(document: Document) -> None:
    """Rows of the first body with several pieces are all of its first piece."""
    many = next(k for k, each in enumerate(document["bodies"]) if len(each["pieces"]) > 1)
    for row in document["rows"]:
        row["pieces"] = [0 if b == many else p for b, p in zip(row["bodies"], row["pieces"], strict=True)]


def with_vertex(document: Document) -> None:
    """Hulls have one more corner."""
    for each in document["bodies"]:
        for piece in each["pieces"]:
            if piece["vertices"]:
                piece["vertices"].append([0.0, 0.0, 1.0])


def first_triangle(change: Callable[[Document], object]) -> Change:
    """Changes the first piece that has triangles."""

    def of(document: Document) -> None:
        change(next(piece for each in document["bodies"] for piece in each["pieces"] if piece["triangles"]))

    return of


def swings(document: Document) -> None:
    """Frames without a law swing."""
    for frame in document["frames"]:
        if not frame["edges"]:
            frame["waves"] = [{"coordinate": 3, "amplitude": 0.8, "rate": 3.0, "phase": 0.0}]


def where(key: str, path: str, value: Any) -> Change:
    """Puts a value into those points or frames in which a list is not empty."""
    table, rest = path.split(".", 1)

    def change(document: Document) -> None:
        for each in document[table]:
            if each[key]:
                put(rest, value)(each)

    return change


def reversed_range(path: str, low: str, high: str) -> Change:
    """The second number of a range becomes less than the first."""

    def change(document: Document) -> None:
        for items, key in places(document, path.split(".")):
            items[key][high] = math.nextafter(items[key][low], -math.inf)

    return change


def alone(row: Document) -> Document:
    """A row of its first body, the other way round: it shows nothing."""
    return {**row, "bodies": [row["bodies"][0], -1], "pieces": [-1, -1], "normal": times(-1.0)(row["normal"])}


def earlier(time: float) -> float:
    """An ulp before a time."""
    return math.nextafter(time, -math.inf)


later_point = both(put("points.0.t0", plus(0.1)), put("points.0.t1", plus(0.1)))


def exception(document: Document) -> None:
    """A distance of its own for the part."""
    rule = {"first": [], "second": [body(document, "part")], "travel": 0.3, "near": 0.3}
    document["required"]["exceptions"].append(rule)


ROWS = [
    Forgery("a pair has no row", "demo", without_pair, T.COVER),
    Forgery("a row ends an ulp too early", "demo", put("rows.lasting.t1", earlier), T.COVER),
    Forgery(
        "a row begins an ulp too late", "demo", put("rows.lasting.t0", lambda t: math.nextafter(t, math.inf)), T.COVER
    ),
    Forgery("a normal points the other way", "demo", put("rows.lasting.normal", times(-1.0)), T.ROW),
    Forgery("a normal is zero", "demo", put("rows.lasting.normal", [0.0, 0.0, 0.0]), T.COVER),
    Forgery("a normal is turned", "demo", put("rows.lasting.normal", lambda n: n[1:] + n[:1]), T.ROW),
    Forgery("a row is of another body", "demo", lambda d: put("rows.lasting.bodies.0", body(d, "shaft"))(d), T.ROW),
    Forgery("a row is of one body twice", "demo", put("rows.lasting.bodies", lambda b: [b[1], b[1]]), T.COVER),
    Forgery("bodies of all rows change places", "demo", swapped, T.ROW),
    Forgery("no rows", "demo", put("rows", []), T.COVER),
    Forgery("rows of one piece for a body of two", "demo", of_first_piece, T.COVER),
    Forgery(
        "rows are of too few time differences",
        "beside-a-neighbour",
        put("rows.*", lambda r: {**r, "s1": max(r["s0"], r["s1"] - 1e-9)}),
        T.COVER,
    ),
    Forgery(
        "rows are of later time differences",
        "beside-a-neighbour",
        put("rows.*", lambda r: {**r, "s0": min(r["s0"] + 1e-9, r["s1"])}),
        T.COVER,
    ),
    Forgery("another body is ahead of the clock", "beside-a-neighbour", seen_from_other_side, T.COVER),
]
REQUIRED = [
    Forgery("greater distance in travel", "demo", put("required.travel", 0.2), T.ROW),
    Forgery("greater distance near points", "demo", put("required.near", 0.05), T.ROW),
    Forgery("a pair has a distance of its own", "demo", exception, T.ROW),
    Forgery("it lasts longer", "demo", put("required.until", plus(1.0)), T.PHASE),
    Forgery("it ends before the motion", "demo", lambda d: put("required.until", d["phases"][0]["t1"])(d), T.PHASE),
    Forgery("joints lag", "demo", put("required.lag", [0.05] * 4), T.ROW),
    Forgery("joints of an arm that tilts lag", "rv-m1", put("required.lag", [0.05] * 5), T.ROW),
    Forgery("joints of a five-bar lag", "five-bar", put("required.lag", [0.03] * 4), T.ROW),
    Forgery("the robot starts late", "demo", put("required.late", 0.5), T.COVER),
    Forgery("it starts later than was shown", "beside-a-neighbour", put("required.late", plus(1e-6)), T.COVER),
    Forgery(
        "another pair of links must keep apart", "demo", lambda d: d["required"]["self_pairs"].append([0, 1]), T.COVER
    ),
    Forgery(
        "displacements grow from an earlier time",
        "dense-flow",
        both(put("required.since", -100.0), put("frames.*.unknown.*.growth", 0.01)),
        T.CORRECTION,
    ),
]
PHASES_AND_BODIES = [
    Forgery("a phase is missing", "demo", without_phase(2), T.PHASE),
    Forgery("phases end too early", "demo", without_phase(-1), T.PHASE),
    Forgery("a phase begins late", "demo", put("phases.1.t0", plus(1e-9)), T.PHASE),
    Forgery("the robot need not keep clear while it moves", "demo", put("phases.*.robot", False), T.PHASE),
    Forgery("nor in the last phase of its motion", "demo", put("phases.-1.robot", False), T.PHASE),
    Forgery("travel distance counts all the time", "demo", put("phases.*.near", False), T.ROW),
    Forgery("no contacts are allowed", "demo", put("phases.*.contacts", []), T.ROW),
    Forgery(
        "contacts are deeper than is allowed",
        "demo",
        both(put("phases.*.contacts.*.depth", 0.0), moved("part", 2, -1e-5)),
        T.ROW,
    ),
    Forgery("a part is in no gripper", "demo", lambda d: put("phases.*.seats", d["phases"][0]["seats"])(d), T.ROW),
    Forgery("a part that was put down has no rows", "belt-to-belt", without_put_down, T.COVER),
    Forgery("bodies may be off their places", "demo", put("phases.*.unknown.*", [0.1, 0.1]), T.ROW),
    Forgery("the part is higher", "demo", moved("part", 2, 2e-2), T.ROW),
    Forgery("a bar is thicker", "demo", put("bodies.bar.pieces.*.ball", plus(0.3)), T.ROW),
    Forgery("a body of the robot is thicker", "demo", put("bodies.link-2.pieces.*.ball", plus(0.3)), T.ROW),
    Forgery("a cylinder is thicker", "demo", put("bodies.shaft.pieces.*.disc", plus(0.3)), T.ROW),
    Forgery("a box is longer", "demo", put("bodies.link-2.pieces.0.edges", lambda e: [*e, [0.0, 0.0, 0.3]]), T.ROW),
    Forgery("a hull has another corner", "demo", with_vertex, T.ROW),
    Forgery("hulls of a mesh have another corner", "tray", with_vertex, T.ROW),
    Forgery("a triangle is missing", "tray", first_triangle(lambda piece: piece["triangles"].pop()), T.SURFACE),
    Forgery("a triangle is turned", "tray", first_triangle(lambda piece: piece["triangles"][0].reverse()), T.SURFACE),
    Forgery("a triangle has a corner of no piece", "tray", first_triangle(put("triangles.0.0", 10**6)), None),
]
MOTION = [
    Forgery("a position is another", "demo", put("arms.0.q.middle.1", plus(1e-3)), T.LIMIT),
    Forgery("a velocity is another", "demo", put("arms.0.qd.middle.0", plus(1e-2)), T.LIMIT),
    Forgery("an acceleration is another", "demo", put("arms.0.qdd.middle.0", plus(1e4)), T.LIMIT),
    Forgery("a lift is another", "demo", put("arms.0.q.middle.2", plus(1e-4)), T.LIMIT),
    Forgery("a velocity beyond its limit", "demo", put("arms.0.qd.middle.0", plus(50.0)), T.LIMIT),
    Forgery("times of knots go back", "demo", lambda d: put("arms.0.time.3", d["arms"][0]["time"][5])(d), T.MOTION),
    Forgery("a jump of the position", "parabolic-blend", put("arms.0.q.2.0", plus(1e-9)), T.MOTION),
    Forgery("links are longer", "demo", put("arms.0.links.2.offset.0", 0.4), T.POINT),
    Forgery("a link turns with another joint", "demo", put("arms.0.links.2.yaw.joints.1", 0.0), T.POINT),
    Forgery("a link has another parent", "demo", put("arms.0.links.3.parent", 1), T.ROW),
    Forgery("the lift goes down", "demo", put("arms.0.links.*.slide.axis", [0.0, 0.0, -1.0]), T.POINT),
    Forgery("a link tilts the other way", "rv-m1", put("arms.0.links.*.pitch.joints.1", -1.0), T.POINT),
    Forgery("a loop has a greater margin", "five-bar", put("arms.0.loop.0.least", 0.99), T.POINT),
    Forgery("a loop meets on the other side", "five-bar", put("arms.0.loop.0.side", times(-1.0)), T.POINT),
    Forgery("a coupler is longer", "five-bar", put("arms.0.loop.0.couplers.0", plus(0.02)), T.POINT),
    Forgery("cranks change places", "five-bar", put("arms.0.loop.0.cranks", lambda k: k[::-1]), T.POINT),
    Forgery("a belt runs faster", "demo", lambda d: put("rate.0", plus(1e-3))(law_of(d)), T.POINT),
    Forgery("a belt speeds up", "demo", lambda d: put("acceleration.0.0", [0.05])(law_of(d)), T.POINT),
    Forgery("a belt is known for half a second", "demo", lambda d: put("edges.-1", 0.5)(law_of(d)), T.POINT),
    Forgery("a dial is elsewhere", "demo", put("frames.2.pose.0", plus(0.01)), T.POINT),
    Forgery("frames swing", "demo", swings, T.POINT),
    Forgery("a door is in another phase", "shutter", put("frames.*.waves.*.phase", plus(1.0)), T.ROW),
    Forgery(
        "another robot moves otherwise",
        "two-robots",
        put("arms.1.time", lambda t: [t[0], *(x + 0.2 for x in t[1:-1]), t[-1]]),
        T.ROW,
    ),
    Forgery("another robot has longer links", "two-robots", put("arms.1.links.2.offset.0", 1.0), T.ROW),
]
UNCERTAINTY = [
    Forgery(
        "errors of frames are larger",
        "demo",
        put("frames.*.unknown.*", lambda u: {**u, "amount": 0.5, "direction": [0.0, 0.0, 1.0]}),
        T.ROW,
    ),
    Forgery(
        "errors of frames have any direction",
        "dense-flow",
        put("frames.*.unknown.*", lambda u: {**u, "amount": 0.5, "direction": []}),
        T.CORRECTION,
    ),
    Forgery("frames may be turned", "demo", put("frames.*.yaw", 0.5), T.ROW),
    Forgery("a frame may be late", "demo", put("frames.*.shift", [0.0, 0.1]), T.COVER),
    Forgery("a frame may be early", "demo", put("frames.*.shift", [-0.1, 0.0]), T.COVER),
    Forgery("nothing is corrected", "dense-flow", put("phases.*.shares.*", [0.0, 0.0]), T.ROW),
    Forgery(
        "a correction is larger",
        "dense-flow",
        put("frames.*.unknown.*", lambda u: {**u, "amount": 0.2} if u["shared"] else u),
        T.CORRECTION,
    ),
]
LIMITS_AND_TOOL = [
    Forgery("a smaller limit of velocity", "demo", put("limits.*.velocity", times(0.5)), T.LIMIT),
    Forgery("smaller by a millionth", "parabolic-blend", put("limits.*.velocity", times(1.0 - 1e-6)), T.LIMIT),
    Forgery("a smaller limit of acceleration", "demo", put("limits.*.acceleration", times(0.9)), T.LIMIT),
    Forgery("a smaller limit of jerk", "demo", put("limits.*.jerk", times(0.5)), T.LIMIT),
    Forgery("a smaller range", "demo", put("limits.*.upper", times(0.5)), T.LIMIT),
    Forgery(
        "an empty range",
        "demo",
        put("limits.*", lambda each: {**each, "lower": each["upper"], "upper": each["lower"]}),
        T.LIMIT,
    ),
    Forgery("limits count for a part of the motion", "demo", put("limits.0.t1", times(0.5)), T.LIMIT),
    Forgery("no limits", "demo", put("limits", []), T.LIMIT),
    Forgery("a load leaves less", "heavy-casting", put("limits.-1.acceleration", times(0.5)), T.LIMIT),
    Forgery("the tool is elsewhere", "demo", put("points.*.tool.2", plus(1e-4)), T.POINT),
    Forgery("the tool is turned", "demo", put("points.*.tool.3", plus(1e-3)), T.POINT),
    Forgery("a point is elsewhere", "demo", put("points.0.target.0", plus(1e-5)), T.POINT),
    Forgery("a point is turned", "demo", put("points.0.target.3", plus(1e-5)), T.POINT),
    Forgery("a point is met later", "demo", later_point, T.POINT),
    Forgery("a point is on another frame", "demo", put("points.0.frame", lambda f: (f + 1) % 3), T.POINT),
    Forgery("a point is of another link", "demo", put("points.0.link", 1), T.POINT),
    Forgery("nothing may be off", "demo", put("points.*.position", 0.0), T.POINT),
    Forgery("no yaw may be off", "demo", put("points.*.yaw", [0.0]), T.POINT),
    Forgery("heights have less room", "demo", where("height", "points.height.0", times(0.5)), T.POINT),
    Forgery("heights have another middle", "demo", where("height", "points.middle", plus(1e-3)), T.POINT),
    Forgery("no relative velocity may be left", "demo", where("rates", "points.rates", [0.0, 0.0]), T.POINT),
    Forgery("a part may be pulled less", "belt-to-belt", put("rates.0.most", times(0.2)), T.RATE),
    Forgery("a greater range of yaw is forbidden", "hose-on-gripper", put("axes.0.high", plus(-0.6)), T.DIRECTION),
    Forgery(
        "another pitch at an arrival",
        "rv-m1",
        put("axes.0", lambda axis: {**axis, "low": axis["low"] - 4e-3, "high": axis["low"]}),
        T.DIRECTION,
    ),
]
NEW_ROWS = [
    *(
        Forgery(f"a joint's derivative {order} is less", STATED, put(f"sums.{order}.high", times(0.8)), T.JOINTS)
        for order in range(4)
    ),
    Forgery("a joint stays above its least value", STATED, put("sums.0.low", plus(0.01)), T.JOINTS),
    Forgery("a joint has a larger share", STATED, put("sums.0.joints", times(2.0)), T.JOINTS),
    Forgery("a sum lasts longer than the motion", STATED, put("sums.0.t1", plus(1e-9)), T.JOINTS),
    Forgery("the tool is slower", STATED, put("rates.-2.most", times(0.95)), T.RATE),
    Forgery("the tool was faster at an instant", STATED, put("rates.-1.least", times(1.1)), T.RATE),
    Forgery("a speed is that of another frame", STATED, put("rates.-1.frame", 1), T.RATE),
    Forgery("an elbow is less bent", STATED, put("axes.-2.low", plus(0.01)), T.DIRECTION),
    Forgery("an elbow is that of another link", STATED, put("axes.-2.other", 1), T.DIRECTION),
    Forgery("the tool is lower", STATED, put("axes.-1.high", plus(-0.01)), T.DIRECTION),
    Forgery("a way begins at another link", STATED, put("axes.-1.other", 4), T.DIRECTION),
    Forgery("a place is an axis", STATED, put("axes.-1.place", False), T.DIRECTION),
    Forgery("a guide is narrower than the slack", STATED, put("guides.0.most", 0.0), T.GUIDE),
    Forgery("a guide ends elsewhere", STATED, put("guides.0.to.0", plus(1e-3)), T.GUIDE),
    Forgery("a guide is of another frame", STATED, put("guides.0.frames", [0, 0]), T.GUIDE),
    Forgery("a guide has two shares at once", STATED, put("guides.0.shares", [0.4, 0.5]), T.GUIDE),
    Forgery("the tool is nearer to its point", STATED, put("errors.0.distance", 0.0), T.ERROR),
    Forgery("it is nearer horizontally", STATED, put("errors.0.horizontal", 0.0), T.ERROR),
    Forgery(
        "it is nearer vertically", STATED, both(put("errors.0.off.1", 0.05), put("errors.0.vertical", 0.04)), T.ERROR
    ),
    Forgery("it is turned by less", STATED, both(put("errors.0.off.2", 0.05), put("errors.0.yaw", 0.04)), T.ERROR),
    Forgery("a yaw moves a long grasp", STATED, both(put("errors.0.off.2", 0.05), put("errors.0.arm", 9.0)), T.ERROR),
    Forgery("an error is of another point", STATED, put("errors.0.target.2", plus(0.2)), T.ERROR),
    Forgery("an error is of another phase", STATED, put("errors.0.phase", 0), T.ERROR),
    Forgery("two bodies are nearer", STATED, put("distances.0.most", 0.0), T.DISTANCE),
    Forgery("weights of points are too small", STATED, put("distances.0.weights", [0.9, 0.0, 0.0, 0.0]), T.DISTANCE),
    Forgery("a point has no direction", STATED, put("distances.0.directions", [0.0] * 12), T.DISTANCE),
    Forgery("a distance is of another phase", STATED, put("distances.0.phase", 0), T.DISTANCE),
    Forgery("a distance names no piece", STATED, put("distances.0.pieces", [9, 0]), T.FORM),
    Forgery("a second distance is greater", STATED, put("required.nearest", 0.2), T.NEAREST),
    Forgery("no pair has a second distance", STATED, put("required.nearest", 1e300), T.NEAREST),
    Forgery("a second distance has no rows", STATED, put("gap_rows", []), T.NEAREST),
    Forgery("a gap row ends too early", STATED, put("gap_rows.lasting.t1", earlier), T.NEAREST),
    Forgery("a gap row is of one body", STATED, put("gap_rows.0.bodies.1", -1), T.FORM),
    Forgery("a row is of one body alone", "demo", put("rows.lasting", alone), T.COVER),
    Forgery("a row of one body is ahead", "demo", put("rows.lasting", lambda r: {**alone(r), "s1": 0.1}), T.FORM),
]
EMPTY_RANGES = [
    Forgery("a phase ends before it begins", "demo", reversed_range("phases.1", "t0", "t1"), T.FORM),
    Forgery("limits end before they begin", "demo", reversed_range("limits.0", "t0", "t1"), T.FORM),
    Forgery("a point ends before it begins", "demo", reversed_range("points.0", "t0", "t1"), T.FORM),
    Forgery("a rate ends before it begins", "belt-to-belt", reversed_range("rates.0", "t0", "t1"), T.FORM),
    Forgery("a direction ends before it begins", "rv-m1", reversed_range("axes.0", "t0", "t1"), T.FORM),
    Forgery("no direction is allowed", "rv-m1", reversed_range("axes.0", "low", "high"), T.FORM),
    Forgery("a row ends before it begins", "demo", reversed_range("rows.0", "t0", "t1"), T.FORM),
    Forgery("a row is of no time difference", "beside-a-neighbour", reversed_range("rows.0", "s0", "s1"), T.FORM),
    Forgery("a frame has no shift", "demo", put("frames.1.shift", [0.1, 0.0]), T.FORM),
    Forgery("a share is none", "dense-flow", put("phases.1.shares.0", [0.5, 0.4]), T.FORM),
]
DOCUMENTS = [
    Forgery("a row names a body that does not exist", "demo", put("rows.lasting.bodies", [99, 0]), T.FORM),
    Forgery("a row names a piece that does not exist", "demo", put("rows.lasting.pieces", [5, 0]), T.FORM),
    Forgery("a row names a body before the first", "demo", put("rows.lasting.bodies", [-1, 0]), T.FORM),
    Forgery("a seat is on no carrier", "demo", both(put("seats.0.link", -1), put("seats.0.frame", -1)), T.FORM),
    Forgery("a seat is on a link that does not exist", "demo", put("seats.0.link", 77), T.FORM),
    Forgery("a phase has a seat of another body", "demo", put("phases.0.seats", lambda s: s[::-1]), T.FORM),
    Forgery("a number is none", "demo", put("rows.lasting.t1", math.nan), None),
    Forgery("a number is infinite", "demo", put("required.travel", -math.inf), None),
    Forgery("a distance is negative", "demo", put("required.travel", -1.0), T.FORM),
    Forgery("a depth is negative", "demo", put("phases.*.contacts.*.depth", -0.1), T.FORM),
    Forgery("a parent comes later", "demo", put("arms.0.links.1.parent", 3), T.FORM),
    Forgery("a key is missing", "demo", lambda d: d["required"].pop("late"), None),
    Forgery("a key is too many", "demo", put("rows.0.note", "it holds"), None),
    Forgery(
        "pieces of a law have no length", "loader", lambda d: put("edges.1", law_of(d)["edges"][3])(law_of(d)), T.FORM
    ),
    Forgery("a time beyond what rounding is bounded for", "demo", put("arms.0.time.-1", 2e7), T.FORM),
]
CLAIMS = [
    *ROWS,
    *REQUIRED,
    *PHASES_AND_BODIES,
    *MOTION,
    *UNCERTAINTY,
    *LIMITS_AND_TOOL,
    *NEW_ROWS,
    *EMPTY_RANGES,
    *DOCUMENTS,
]
