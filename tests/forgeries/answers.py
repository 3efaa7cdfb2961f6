"""Forged answers: each is a right answer of a cell in which something was changed, so that it states what is not so.

A forger knows the product: digests are made to fit. `ANSWERS` is the table of all, with what must be found in each.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from tests.forgeries.changes import Change, Document, append, both, drop, plus, put, reverse, times, update


class Forgery(NamedTuple):
    """The cell whose answer is changed, how one of the findings begins, and the change. `sealed`: whether the digest
    of the certificate is made to fit."""

    name: str
    cell: str
    finds: str
    change: Change
    sealed: bool = True


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


def edge(kind: str, later_s: float) -> Change:
    """The first leg of a kind begins later, and the leg before it ends later."""

    def change(answer: Document) -> None:
        number = next(i for i, leg in enumerate(answer["legs"]) if leg["kind"] == kind)
        answer["legs"][number]["from_s"] += later_s
        answer["legs"][number - 1]["to_s"] += later_s

    return change


def renamed(kind: str, other: str) -> Change:
    """Legs of a kind are of another one."""
    return put("legs.*.kind", lambda own: other if own == kind else own)


def shorter_depart(answer: Document) -> None:
    """The first depart lasts from 20 ms earlier to 20 ms earlier."""
    edge("DEPART", 0.0)(answer)
    answer["legs"][4]["from_s"] -= 0.02
    answer["legs"][3]["to_s"] -= 0.02


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


def knot_in(kind: str, column: str, joint: int, by: float) -> Change:
    """A joint is elsewhere at a knot in the middle of the first leg of a kind."""

    def change(answer: Document) -> None:
        leg, knots = next(each for each in answer["legs"] if each["kind"] == kind), answer["trajectory"]
        inside = [i for i, t in enumerate(knots["time_s"]) if leg["from_s"] < t < leg["to_s"]]
        knots[column][inside[len(inside) // 2]][joint] += by

    return change


def bent_parabola(answer: Document) -> None:
    """A joint is elsewhere at both knots at the time of the middle."""
    knots = answer["trajectory"]
    middle = knots["time_s"][len(knots["time_s"]) // 2]
    for t, state in zip(knots["time_s"], knots["position"], strict=True):
        state[0] += 1e-4 * (t == middle)


def met_later(by: float) -> Change:
    """The first point is met and left later."""
    return both(put("arrivals.0.time_s", plus(by)), put("arrivals.0.until_s", plus(by)))


def late_in_its_blend(answer: Document) -> None:
    """The first via is due 1 ms after the middle of its blend."""
    met_later(1e-3)(answer)
    answer["legs"][0]["to_s"] += 1e-3
    answer["legs"][1]["from_s"] += 1e-3


def exchanged_margins(one: str, other: str) -> Change:
    """One of the margins is stated as another one."""
    return lambda answer: answer["margins"].update({one: answer["margins"][other]})


SAFE = "Certified safe under ISO 10218."
NOT_MISSED = {"joints": [0.0] * 4, "distance_m": 0.0}
NO_TRACE = {"length_m": 0.1, "slowest_m_s": 0.1, "fastest_m_s": 0.1, "error_m": 0.0}
NO_ERROR = {"position_m": 0.0, "horizontal_m": 0.0, "vertical_m": 0.0, "yaw_rad": 0.0, "causes": [], "worst": []}
LAG = {"cause": "servo lag", "position_m": 0.0, "yaw_rad": 0.0}
CONTACT = {"bodies": ["bar", "cup"], "from_s": 0.9, "to_s": 1.1}
OPEN = ("demo.margins", "demo.margins.peaks.0", "demo.census", "demo.arrivals.0", "demo.legs.0", "demo.legs.0.route",
        "demo.load", "demo.certificate", "demo.trajectory", "demo.contacts.0", "floating.warnings.0")  # fmt: skip
"""The cell, and the path of a part of its answer, which has no field but its own."""

OF_THE_PROOF = (
    Forgery("a digest that does not fit", "demo", "DIGEST", put("certificate.digest", "0" * 64), sealed=False),
    Forgery("a digest of another plan", "demo", "DIGEST", put("trajectory.time_s.-1", plus(1e-7)), sealed=False),
    Forgery("a row is left out", "demo", "COVER", rows(lambda i: i != 17)),
    Forgery("all rows are left out", "demo", "COVER", rows(lambda _: False)),
    Forgery("normals are turned round", "demo", "ROW", put("certificate.normal.*", times(-1.0))),
    Forgery("normals are longer", "demo", "ROW", put("certificate.normal.*", times(1.001))),
    Forgery("rows of the first body are of another", "demo", "ROW", put("certificate.first.*", 1)),
    Forgery("rows of no body", "demo", "ROW", put("certificate.first.*", 10_000)),
    Forgery("rows of pieces that there are not", "demo", "FORM", put("certificate.first_piece.*", 999)),
    Forgery("rows begin later", "demo", "COVER", put("certificate.t0_s.*", plus(1e-3))),
    Forgery("rows across phases", "demo", "COVER", put("certificate.t1_s.*", plus(0.5))),
    Forgery("names are exchanged", "demo", "ROW", reverse("certificate.names")),
    Forgery("names twice", "demo", "plan: ", put("certificate.names", lambda own: [*own, own[0]])),
    Forgery("unknown names", "demo", "ROW", append("certificate.names", "guard")),
    Forgery("covers less", "demo", "FORM", drop("certificate.covers.-1")),
    Forgery("covers more", "demo", "FORM", append("certificate.covers", "force")),
    Forgery("covers the jerk of blends", "blended", "FORM", append("certificate.covers", "jerk")),
    Forgery("more rows than there are", "demo", "plan.certificate.t0_s", put("certificate.rows", plus(1))),
)
OF_THE_MOTION = (
    Forgery("a duration 10 ms shorter", "demo", "FORM", put("duration_s", plus(-0.01))),
    Forgery("another start", "demo", "FORM", put("start_s", plus(0.01))),
    Forgery("a start 10 nrad aside", "demo", "START", put("trajectory.position.0.0", plus(1e-8))),
    Forgery("an end in motion", "demo", "END", put("trajectory.velocity.-1.0", plus(1e-6))),
    Forgery("one percent faster", "demo", "ARRIVAL", quicker(0.99)),
    Forgery("a knot moved by 1 µrad", "demo", "LIMIT", put("trajectory.position.-3.0", plus(1e-6))),
    Forgery("a knot faster by 1 mrad/s", "demo", "LIMIT", knot_in("MOVE", "velocity", 0, 1e-3)),
    Forgery("a knot with another acceleration", "demo", "LIMIT", put("trajectory.acceleration.middle.0", plus(1.0))),
    Forgery("a bump in a follow", "demo", "POINT", knot_in("FOLLOW", "position", 0, 6e-5)),
    Forgery("a bump in a path", "traced", "GUIDE", knot_in("FOLLOW", "position", 0, 5e-5)),
    Forgery("a bump beside a path, and its speed", "traced", "RATE", knot_in("FOLLOW", "position", 0, -5e-5)),
    Forgery("a bump in a lead-in", "traced", "GUIDE", knot_in("APPROACH", "position", 0, 1e-4)),
    Forgery("no parabola", "blended", "BLEND: a piece is no parabola", bent_parabola),
    Forgery("jumps of the acceleration", "demo", "FORM", put("trajectory.acceleration_jumps", True)),
    Forgery("no jumps of the acceleration", "blended", "plan.trajectory", put("trajectory.acceleration_jumps", False)),
    Forgery("other names of joints", "demo", "plan.trajectory.joint_names", reverse("trajectory.joint_names")),
    Forgery("other units of joints", "demo", "plan.trajectory.joint_units", put("trajectory.joint_units.2", "rad")),
    Forgery("a move is called an approach", "demo", "LEGS", put("legs.0.kind", "APPROACH")),
    Forgery("a move is called a follow", "demo", "LEGS", put("legs.4.kind", "FOLLOW")),
    Forgery("a move is called an arch", "demo", "ARCH", put("legs.0.kind", "ARCH")),
    Forgery("approaches are called moves", "demo", "LEGS", renamed("APPROACH", "MOVE")),
    Forgery("a lead-in is called a move", "traced", "LEGS", renamed("APPROACH", "MOVE")),
    Forgery("a lead-out is called a move", "traced", "LEGS", renamed("DEPART", "MOVE")),
    Forgery("a part is taken early", "demo", "ARRIVAL", edge("DEPART", -0.02)),
    Forgery("a part is taken late", "demo", "ARRIVAL", edge("DEPART", 0.02)),
    Forgery("an approach is longer", "demo", "CONTACT", edge("APPROACH", -0.05)),
    Forgery("a depart is shorter", "demo", "POINT", shorter_depart),
    Forgery("a leg that begins later", "demo", "LEGS", put("legs.1.from_s", plus(1e-3))),
    Forgery("a leg for another step", "demo", "LEGS", put("legs.8.step", 1)),
    Forgery("a leg for no step", "demo", "FORM", put("legs.8.step", 7)),
    Forgery("a leg is left out", "demo", "LEGS", drop("legs.8")),
    Forgery("no legs", "demo", "LEGS", put("legs", [])),
    Forgery("a wait that is none", "waiting", "LEGS", put("legs.1.kind", "WAIT")),
)
OF_ARRIVALS = (
    Forgery("a yaw offset of a quarter", "demo", "ARRIVAL", put("arrivals.0.yaw_offset_rad", 1.5707963267948966)),
    Forgery("a yaw offset of the other half", "demo", "POINT", put("arrivals.0.yaw_offset_rad", 0.0)),
    Forgery("a yaw offset of an arm without yaw", "elbow-arm", "ARRIVAL", put("arrivals.0.yaw_offset_rad", 0.5)),
    Forgery("a pose 2 µm beside", "demo", "ARRIVAL", put("arrivals.0.at_m.0", plus(2e-6))),
    Forgery("another yaw", "demo", "ARRIVAL", put("arrivals.0.yaw_rad", plus(2e-6))),
    Forgery("2 µm more along the conveyor", "demo", "ARRIVAL", put("arrivals.0.along_m", plus(2e-6))),
    Forgery("along a conveyor where there is none", "demo", "ARRIVAL", put("arrivals.1.along_m", 123.0)),
    Forgery("not along the conveyor that there is", "demo", "CLAIM", put("arrivals.0.along_m", None)),
    Forgery("met 10 µs earlier", "demo", "ARRIVAL", met_later(-1e-5)),
    Forgery("met 1 ms later", "demo", "ARRIVAL", met_later(1e-3)),
    Forgery("left later", "demo", "ARRIVAL", put("arrivals.0.until_s", plus(1e-3))),
    Forgery("another control point", "demo", "ARRIVAL", put("arrivals.0.control_point", "pick-9")),
    Forgery("arrivals are exchanged", "demo", "ARRIVAL", reverse("arrivals")),
    Forgery("an arrival is left out", "demo", "ARRIVAL", drop("arrivals.2")),
    Forgery("an arrival twice", "demo", "ARRIVAL", put("arrivals", lambda own: [own[0], *own])),
    Forgery("not matched", "demo", "ARRIVAL", put("arrivals.0.matched", False)),
    Forgery("a trace is not matched", "traced", "ARRIVAL", put("arrivals.0.matched", False)),
    Forgery("a via is matched", "blended", "CLAIM", put("arrivals.0.matched", True)),
    Forgery("other joints", "demo", "FORM", put("arrivals.0.joints.0", plus(1e-6))),
    Forgery("another mode", "demo", "DIRECTION", put("arrivals.0.mode", "left")),
    Forgery("another mode of a five-bar", "five-bar", "DIRECTION", put("arrivals.0.mode", "right-left")),
    Forgery("another mode of an arm that tilts", "elbow-arm", "DIRECTION", put("arrivals.0.mode", "back-up")),
    Forgery("a mode that there is not", "demo", "ELBOW", put("arrivals.0.mode", "up")),
    Forgery("a grip that is nearer", "demo", "NEAREST", put("arrivals.0.grip_m", plus(-1e-4))),
    Forgery("a place with a grip", "demo", "NEAREST", update("arrivals.1", grip_m=1.0)),
    Forgery("a support that is nearer", "demo", "NEAREST", put("arrivals.1.support_m", plus(-1e-4))),
    Forgery("a via is not missed", "blended", "BLEND", put("arrivals.0.missed_by", None)),
    Forgery("a via is missed by 10 µm less", "blended", "BLEND", put("arrivals.0.missed_by.distance_m", plus(-1e-5))),
    Forgery("a via is missed by 2 µm more", "blended", "BLEND", put("arrivals.0.missed_by.distance_m", plus(2e-6))),
    Forgery("a via is missed by less than none", "blended", "FORM", put("arrivals.0.missed_by.distance_m", -0.05)),
    *(Forgery(f"joint {k} misses by another amount", "blended", "BLEND",
              put(f"arrivals.0.missed_by.joints.{k}", plus(2e-9))) for k in range(4)),
    Forgery("a via due beside its blend", "blended", "BLEND: pose2 is not due in the middle", late_in_its_blend),
    Forgery("a point is missed that is met", "demo", "BLEND", put("arrivals.0.missed_by", NOT_MISSED)),
    Forgery("another pitch", "rv-m1", "ARRIVAL", put("arrivals.0.pitch_rad", plus(1e-4))),
    Forgery("another pitch where any is allowed", "rv-m1", "JOINTS", put("arrivals.1.pitch_rad", plus(1e-4))),
    Forgery("another roll", "rv-m1", "JOINTS", put("arrivals.0.roll_rad", plus(1e-4))),
    Forgery("no pitch", "rv-m1", "ARRIVAL", put("arrivals.0.pitch_rad", None)),
    Forgery("no roll", "rv-m1", "ARRIVAL", put("arrivals.0.roll_rad", None)),
    Forgery("a yaw offset of an arm that tilts", "rv-m1", "ARRIVAL", put("arrivals.0.yaw_offset_rad", 0.1)),
    Forgery("a pitch of an arm that has none", "demo", "ARRIVAL", put("arrivals.0.pitch_rad", 0.0)),
    Forgery("a roll of an arm that has none", "demo", "ARRIVAL", put("arrivals.0.roll_rad", 0.0)),
    Forgery("a trace that is none", "demo", "ARRIVAL", put("arrivals.0.trace", NO_TRACE)),
    Forgery("a trace that is not said", "traced", "ARRIVAL", put("arrivals.0.trace", None)),
    Forgery("a longer trace", "traced", "ARRIVAL", put("arrivals.0.trace.length_m", plus(1e-6))),
    Forgery("a trace that is too fast", "traced", "ARRIVAL", put("arrivals.0.trace.fastest_m_s", 1.02 * 0.15)),
    Forgery("a trace that is too slow", "traced", "ARRIVAL", put("arrivals.0.trace.slowest_m_s", 0.98 * 0.15)),
    Forgery("a trace that is not so slow", "traced", "RATE", put("arrivals.0.trace.slowest_m_s", 0.15)),
    Forgery("a trace that is not so fast", "traced", "RATE", put("arrivals.0.trace.fastest_m_s", 0.15)),
    Forgery("a trace that is too far off", "traced", "ARRIVAL", put("arrivals.0.trace.error_m", 1.1e-5)),
    Forgery("a more exact trace", "traced", "GUIDE", put("arrivals.0.trace.error_m", times(0.1))),
)  # fmt: skip
OF_ERRORS = (
    *(Forgery(f"{name} that is {'larger' if by > 0.0 else 'smaller'}", "demo", "ERROR",
              put(f"arrivals.0.error.{key}", plus(by)))
      for name, key in (("an error", "position_m"), ("an error to the side", "horizontal_m")) for by in (1e-6, -1e-6)),
    Forgery("an error of the height", "demo", "ERROR", put("arrivals.0.error.vertical_m", 0.01)),
    Forgery("an error of the yaw", "demo", "ERROR", put("arrivals.0.error.yaw_rad", 0.01)),
    Forgery("no error", "demo", "ARRIVAL", put("arrivals.0.error", None)),
    Forgery("an error where all is known", "known", "ERROR", put("arrivals.0.error", NO_ERROR)),
    Forgery("another cause", "demo", "ERROR", put("arrivals.0.error.causes.0.cause", "servo lag")),
    Forgery("a cause adds less", "demo", "ERROR", put("arrivals.0.error.causes.0.position_m", times(0.5))),
    Forgery("a cause adds more", "demo", "ERROR", put("arrivals.0.error.causes.0.position_m", times(2.0))),
    Forgery("a cause adds yaw", "demo", "ERROR", put("arrivals.0.error.causes.0.yaw_rad", 0.01)),
    Forgery("no causes", "demo", "ERROR", put("arrivals.0.error.causes", [])),
    Forgery("a cause too many", "demo", "ERROR", append("arrivals.0.error.causes", LAG)),
    Forgery("causes in another order", "uncertain", "ERROR", reverse("arrivals.0.error.causes")),
    Forgery("a worst case that is none", "demo", "ERROR", put("arrivals.0.error.worst", [])),
    Forgery("a worst case of something else", "demo", "ERROR", put("arrivals.0.error.worst.0.what", "dial along")),
    Forgery("half a worst case", "demo", "ERROR", put("arrivals.0.error.worst.0.value", 0.5)),
    Forgery("a worst case that is not the worst", "uncertain", "ERROR",
            put("arrivals.0.error.worst.0.value", times(-1.0))),
)  # fmt: skip
OF_MARGINS = (
    *(Forgery(f"{name} is {1e3 * by:+g} mm", cell, "NEAREST", put(f"margins.{of}.gap_m", plus(by)))
      for name, cell, of in (("the nearest", "demo", "nearest"), ("the nearest to the arm", "put-down", "nearest"),
                             ("what was put down", "put-down", "placed")) for by in (1e-4, -1e-4)),
    Forgery("nothing is near", "demo", "NEAREST", put("margins.nearest", None)),
    Forgery("another pair is nearest", "demo", "NEAREST", put("margins.nearest.bodies", ["cup", "belt-bed"])),
    Forgery("a body that there is not is nearest", "demo", "NEAREST", put("margins.nearest.bodies", ["cup", "nobody"])),
    Forgery("nearest 5 ms later", "demo", "NEAREST", put("margins.nearest.time_s", plus(5e-3))),
    Forgery("nearest in another phase", "demo", "NEAREST", put("margins.nearest.phase", "FOLLOW")),
    Forgery("nothing was put down", "put-down", "NEAREST", put("margins.placed", None)),
    Forgery("the arm's clearance for what was put down", "put-down", "NEAREST", exchanged_margins("placed", "nearest")),
    Forgery("what was put down for the arm's clearance", "put-down", "NEAREST", exchanged_margins("nearest", "placed")),
    Forgery("something was put down", "demo", "NEAREST", exchanged_margins("placed", "nearest")),
    Forgery("a pair that is not so near", "demo", "NEAREST", put("margins.travel_pairs.1.gap_m", plus(-1e-4))),
    Forgery("a near pair that is not so near", "demo", "NEAREST", put("margins.near_pairs.0.gap_m", plus(-1e-4))),
    Forgery("a slower joint", "demo", "PEAK", put("margins.peaks.0.velocity", times(1.0 - 1e-5))),
    Forgery("a faster joint", "demo", "PEAK", put("margins.peaks.0.velocity", times(1.0 + 1e-5))),
    Forgery("a gentler joint", "demo", "PEAK", put("margins.peaks.1.acceleration", times(1.0 - 1e-5))),
    Forgery("a joint with less jerk", "demo", "PEAK", put("margins.peaks.0.jerk", times(0.99))),
    Forgery("no jerk", "demo", "PEAK", update("margins.peaks.0", jerk=None, jerk_ratio=None)),
    Forgery("a jerk without a limit", "blended", "PEAK", update("margins.peaks.0", jerk=1.0, jerk_ratio=0.5)),
    Forgery("a smaller share of a limit", "demo", "PEAK", put("margins.peaks.0.velocity_ratio", times(0.99))),
    Forgery("a larger share of a limit", "heavy", "JOINTS", put("margins.peaks.0.acceleration_ratio", times(1.01))),
    Forgery("a joint is left out", "demo", "PEAK", drop("margins.peaks.0")),
    Forgery("a slower tool", "demo", "RATE", put("margins.tool.speed_m_s", times(0.99))),
    Forgery("a faster tool", "demo", "RATE", put("margins.tool.speed_m_s", times(1.01))),
    Forgery("fastest at another time", "demo", "RATE", put("margins.tool.speed_at_s", plus(0.1))),
    Forgery("a gentler tool", "demo", "RATE", put("margins.tool.acceleration_m_s2", times(0.99))),
    Forgery("a tool that jumps harder", "blended", "RATE", put("margins.tool.acceleration_m_s2", times(1.01))),
    Forgery("a part is carried more gently", "demo", "RATE", put("margins.tool_acceleration_m_s2", times(0.98))),
    Forgery("a five-bar carries more gently", "five-bar", "RATE", put("margins.tool_acceleration_m_s2", times(0.97))),
    Forgery("a part is carried harder", "demo", "RATE", put("margins.tool_acceleration_m_s2", times(1.01))),
    Forgery("a limit of the carried part", "demo", "CLAIM", put("margins.tool_acceleration_limit_m_s2", 30.0)),
    *(Forgery(f"{name} is {by:+g}", cell, "DIRECTION", put(f"margins.{of}", plus(by)))
      for name, cell, of in (("the margin", "demo", "singularity"), ("that of a five-bar", "five-bar", "singularity"),
                             ("that of an elbow arm", "elbow-arm", "singularity"),
                             ("that of type 2", "five-bar", "parallel")) for by in (2e-3, -2e-3)),
    Forgery("no singular position", "demo", "SINGULARITY", put("margins.singularity", None)),
    Forgery("no closed chain", "five-bar", "SINGULARITY", put("margins.parallel", None)),
    Forgery("a closed chain that there is not", "demo", "SINGULARITY", put("margins.parallel", 0.9)),
    Forgery("an unbounded jerk", "demo", "CLAIM", put("margins.jerk", "unbounded")),
    Forgery("a limited jerk", "blended", "CLAIM", put("margins.jerk", "limited")),
)  # fmt: skip
OF_THE_REST = (
    Forgery("no contacts", "demo", "CONTACT", put("contacts", [])),
    Forgery("a contact more", "demo", "CONTACT", append("contacts", CONTACT)),
    Forgery("a contact that lasts longer", "demo", "CONTACT", put("contacts.1.to_s", plus(1e-6))),
    Forgery("no assumptions", "demo", "CLAIM", put("assumptions", [])),
    Forgery("another notice", "demo", "CLAIM", put("notice", SAFE)),
    Forgery("a digest of another request", "demo", "CLAIM", put("request_digest", "0" * 64)),
    Forgery("another seed", "demo", "CLAIM", put("seed", 77)),
    Forgery("a warning of no kind", "floating", "plan.warnings[0].kind", put("warnings.0.kind", "SAFE")),
    Forgery("a lighter part", "heavy", "LOAD", put("load.carried.1.mass_kg", plus(-1e-6))),
    Forgery("less inertia", "heavy", "LOAD", put("load.carried.1.inertia_kgm2", plus(-1e-9))),
    Forgery("no inertia", "heavy", "LOAD", put("load.carried.1.inertia_kgm2", None)),
    Forgery("a larger share of the acceleration", "heavy", "LOAD", put("load.carried.1.acceleration_share", 1.0)),
    Forgery("carried for less time", "heavy", "LOAD", put("load.carried.1.to_s", plus(-1e-6))),
    Forgery("another part is carried", "demo", "LOAD", put("load.carried.1.part", "bar")),
    Forgery("a load is left out", "demo", "LOAD", drop("load.carried.-1")),
    Forgery("another rated load", "heavy", "CLAIM", put("load.rated_kg", 50.0)),
    Forgery("another law of loads", "heavy", "CLAIM", put("load.law", "none")),
    Forgery("a number that must be believed", "demo", "plan.certificate.gap_m", update("certificate", gap_m=[1.0])),
    Forgery("a field that no answer has", "demo", "plan.certified", lambda answer: answer.update(certified="TUV")),
    *(Forgery(f"a word more in {part}", part.partition(".")[0], "plan.",
              update(part.partition(".")[2], certified="TUV")) for part in OPEN),
    Forgery("another schema", "demo", "plan.schema", put("schema", "assur/2")),
    Forgery("a census that counts words", "demo", "plan.census.candidates", put("census.candidates", SAFE)),
    Forgery("a time that is a word", "demo", "plan.elapsed_s", put("elapsed_s", SAFE)),
    Forgery("a clock that certifies", "demo", "plan.cut_by_clock", put("cut_by_clock", SAFE)),
)  # fmt: skip
ANSWERS = (*OF_THE_PROOF, *OF_THE_MOTION, *OF_ARRIVALS, *OF_ERRORS, *OF_MARGINS, *OF_THE_REST)
