"""Every claim of a bundle is broken once, or a row of its proof, and the prover does not show it."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

from tests.prover.bundles import Document, bundle, shown

Change = Callable[[Document], object]


def body(document: Document, name: str) -> int:
    return [each["name"] for each in document["bodies"]].index(name)


def asked(document: Document) -> list[Document]:
    """Rows that a pair of the robot and its surroundings needs, which last."""
    return [row for row in document["rows"] if row["t1"] > row["t0"]]


def without_row(document: Document) -> None:
    """The first row of a pair in the second phase."""
    begin, end = document["phases"][1]["t0"], document["phases"][1]["t1"]
    rows = [row for row in asked(document) if begin <= row["t0"] and row["t1"] <= end]
    bodies = rows[0]["bodies"]
    document["rows"] = [row for row in document["rows"] if not (row in rows and row["bodies"] == bodies)]


def without_phase(document: Document, number: int) -> None:
    """A phase and the rows that are about it are left out; rows of later phases follow."""
    document["phases"].pop(number)
    for table in [each for each in document.values() if isinstance(each, list)]:
        rows = [row for row in table if isinstance(row, dict) and "phase" in row]
        for row in rows:
            if row["phase"] == number:
                table.remove(row)
            elif row["phase"] > number:
                row["phase"] -= 1


def hole_in_time(document: Document) -> None:
    row = asked(document)[0]
    row["t1"] = math.nextafter(row["t1"], -math.inf)


def moved(name: str, axis: int, by: float) -> Change:
    def change(document: Document) -> None:
        for seat in document["seats"]:
            if seat["body"] == body(document, name):
                seat["pose"][axis] += by

    return change


def grown(name: str, by: float) -> Change:
    def change(document: Document) -> None:
        for piece in document["bodies"][body(document, name)]["pieces"]:
            piece["ball"] += by

    return change


def knot(column: str, joint: int, by: float) -> Change:
    def change(document: Document) -> None:
        arm = document["arms"][0]
        arm[column][len(arm["time"]) // 2][joint] += by

    return change


def law_of(document: Document) -> Document:
    return next(frame for frame in document["frames"] if frame["edges"])


def no_contacts(document: Document) -> None:
    for phase in document["phases"]:
        phase["contacts"] = []


def shallow(document: Document) -> None:
    for phase in document["phases"]:
        for contact in phase["contacts"]:
            contact["depth"] = 0.0
            # the part stands in the belt by a hundredth of a millimetre
            moved("part", 2, -1e-5)(document)


def halved(key: str) -> Change:
    def change(document: Document) -> None:
        for span in document["limits"]:
            span[key] = [0.5 * x for x in span[key]]

    return change


CHANGES: dict[str, Change] = {
    "a row is missing": without_row,
    "a row ends an ulp too early": hole_in_time,
    "a normal points the other way": lambda d: asked(d)[0].update(normal=[-x for x in asked(d)[0]["normal"]]),
    "a normal is zero": lambda d: asked(d)[0].update(normal=[0.0, 0.0, 0.0]),
    "a normal is turned": lambda d: asked(d)[0].update(normal=asked(d)[0]["normal"][1:] + asked(d)[0]["normal"][:1]),
    "a row is of another body": lambda d: asked(d)[0].update(bodies=[body(d, "shaft"), asked(d)[0]["bodies"][1]]),
    "all rows are missing": lambda d: d.update(rows=[]),
    "greater distances are required": lambda d: d["required"].update(travel=0.2, near=0.2),
    "a distance of its own is required of a pair": lambda d: d["required"]["exceptions"].append(
        {"first": [], "second": [body(d, "part")], "travel": 0.3, "near": 0.3}
    ),
    "the part stands higher": moved("part", 2, 2e-2),
    "a bar is thicker": grown("bar", 0.3),
    "a body of the robot is larger": grown("link-2", 0.3),
    "a position is another": knot("q", 1, 1e-3),
    "a velocity is another": knot("qd", 0, 1e-2),
    "a lift is another": knot("q", 2, 1e-4),
    "a velocity beyond its limit": knot("qd", 0, 50.0),
    "a smaller limit of velocity": halved("velocity"),
    "a smaller limit of acceleration": halved("acceleration"),
    "a smaller limit of jerk": halved("jerk"),
    "a smaller range": halved("upper"),
    "an empty range": lambda d: [s.update(lower=s["upper"], upper=s["lower"]) for s in d["limits"]],
    "limits count for a part of the motion only": lambda d: d["limits"][0].update(t1=0.5 * d["limits"][0]["t1"]),
    "a belt runs faster": lambda d: law_of(d)["rate"].__setitem__(0, law_of(d)["rate"][0] + 1e-3),
    "a belt speeds up": lambda d: law_of(d)["acceleration"][0].__setitem__(0, [0.05]),
    "a belt is known for half a second only": lambda d: law_of(d)["edges"].__setitem__(-1, 0.5),
    "a dial is elsewhere": lambda d: d["frames"][2]["pose"].__setitem__(0, d["frames"][2]["pose"][0] + 0.01),
    "no contacts are allowed": no_contacts,
    "contacts are deeper than is allowed": shallow,
    "a part is in no gripper": lambda d: [p.update(seats=d["phases"][0]["seats"]) for p in d["phases"]],
    "the tool is elsewhere": lambda d: [p["tool"].__setitem__(2, p["tool"][2] + 1e-4) for p in d["points"]],
    "a point is elsewhere": lambda d: d["points"][0]["target"].__setitem__(0, d["points"][0]["target"][0] + 1e-5),
    "a point is turned": lambda d: d["points"][0]["target"].__setitem__(3, d["points"][0]["target"][3] + 1e-5),
    "a point is met later": lambda d: d["points"][0].update({k: d["points"][0][k] + 0.1 for k in ("t0", "t1")}),
    "nothing may be off": lambda d: [p.update(position=0.0) for p in d["points"]],
    "the velocity of a point is another": lambda d: [p.update(rates=[0.0, 0.0]) for p in d["points"] if p["rates"]],
    "joints lag": lambda d: d["required"].update(lag=[0.05, 0.05, 0.05, 0.05]),
    "the robot starts late": lambda d: d["required"].update(late=0.5),
    "errors of frames are larger": lambda d: [
        each.update(amount=0.5, direction=[0.0, 0.0, 1.0]) for frame in d["frames"] for each in frame["unknown"]
    ],
    "frames may be turned": lambda d: [frame.update(yaw=0.5) for frame in d["frames"]],
    "a frame may be late": lambda d: [frame.update(shift=[0.0, 0.1]) for frame in d["frames"]],
    "bodies may be off their places": lambda d: [p.update(unknown=[[0.1, 0.1]] * 10) for p in d["phases"]],
    "a phase is missing": lambda d: without_phase(d, 2),
    "phases end too early": lambda d: without_phase(d, len(d["phases"]) - 1),
    "it is asked for a second more": lambda d: d["required"].update(until=d["required"]["until"] + 1.0),
    "more pairs of links are asked to stay apart": lambda d: d["required"]["self_pairs"].append([0, 1]),
    "links are longer": lambda d: d["arms"][0]["links"][2]["offset"].__setitem__(0, 0.4),
    "a link turns with another joint": lambda d: d["arms"][0]["links"][2]["yaw"]["joints"].__setitem__(1, 0.0),
    "the robot need not keep clear while it moves": lambda d: [p.update(robot=False) for p in d["phases"]],
    "nothing is asked for after the first leg": lambda d: d["required"].update(until=d["phases"][0]["t1"]),
}  # fmt: skip


@pytest.mark.parametrize("what", CHANGES)
def test_a_bundle_in_which_something_was_changed_is_not_shown(what: str) -> None:
    document = bundle("demo")
    CHANGES[what](document)
    assert document != bundle("demo")
    right, lines = shown(document)
    assert not right
    assert lines[-1].startswith("claims that are not shown: ")


def test_as_it_was_written_it_is_shown() -> None:
    assert shown(bundle("demo"))[0]


def test_a_held_part_accelerates_no_harder_than_is_said() -> None:
    document = bundle("belt-to-belt")
    document["rates"][0]["most"] *= 0.2
    told = shown(bundle("belt-to-belt"))[1]
    pulls = [row for row in bundle("belt-to-belt")["rates"] if row["order"] == 2]
    assert told["times and intervals at which the acceleration of a point is bounded"] == len(pulls)
    assert told["greatest acceleration, m/s²"] == max(row["most"] for row in pulls)
    right, lines = shown(document)
    assert (right, lines[-1]) == (False, "claims that are not shown: 1")


def test_of_a_correction_nothing_may_be_left_out() -> None:
    document = bundle("dense-flow")
    for phase in document["phases"]:
        phase["shares"] = [[0.0, 0.0] for _ in phase["shares"]]
    assert not shown(document)[0]


def test_a_loop_has_the_margin_that_is_claimed() -> None:
    document = bundle("five-bar")
    document["arms"][0]["loop"][0]["least"] = 0.9
    assert not shown(document)[0]
    document = bundle("five-bar")
    document["arms"][0]["loop"][0]["side"] *= -1.0
    assert not shown(document)[0]


def test_a_robot_beside_it_that_moves_otherwise_is_not_what_was_proved() -> None:
    document = bundle("two-robots")
    time = document["arms"][1]["time"]
    document["arms"][1]["time"] = [time[0], *(t + 0.2 for t in time[1:-1]), time[-1]]
    assert not shown(document)[0]


@pytest.mark.parametrize("name", ["hose-on-gripper", "rv-m1"])
def test_the_tool_has_the_directions_that_are_said(name: str) -> None:
    document = bundle(name)
    assert document["axes"]
    assert shown(document)[0]
    for axis in document["axes"]:
        low, high = axis["low"], axis["high"]
        axis["low"], axis["high"] = low - 4e-3, low - 1e-9  # which ends where it began
        right, lines = shown(document)
        assert (right, lines[-1]) == (False, "claims that are not shown: 1")
        axis["low"], axis["high"] = low, high


SHARES = "largest share by which a limit may be exceeded"
LIES: dict[str, tuple[Change, object]] = {
    "deepest contact, m": (lambda d: [c.update(depth=10.0) for p in d["phases"] for c in p["contacts"]], 10.0),
    SHARES: (lambda d: d["limits"][0].update(shares=[1e9] * 4), 1e9),
    "limits of each joint, jerk": (lambda d: [span.update(jerk=[]) for span in d["limits"]], "not limited"),
    "limits of each joint, velocity": (lambda d: [s.update(velocity=[1e9] * 4) for s in d["limits"]], [1e9] * 4),
    "limits of each joint, acceleration": (lambda d: [s.update(acceleration=[9e9]*4) for s in d["limits"]], [9e9] * 4),
    "limits of each joint, lower": (lambda d: [s.update(lower=[-99.0] * 4) for s in d["limits"]], [-99.0] * 4),
    "limits of each joint, upper": (lambda d: [s.update(upper=[99.0] * 4) for s in d["limits"]], [99.0] * 4),
    "distances in travel and near a control point, m": (lambda d: d["required"].update(travel=0, near=0), [0, 0]),
    "smallest distance of a pair, m": (
        lambda d: d["required"]["exceptions"].append({"first": [], "second": [3], "travel": 1e-9, "near": 1e-6}), 1e-9,
    ),
    "greatest lag of a joint, rad or m": (lambda d: d["required"].update(lag=[0.0, 0.0, 1e-9, 0.0]), 1e-9),
    "greatest delay of the robot's start, s": (lambda d: d["required"].update(late=0.0), 0.0),
    "frames with an uncertainty": (
        lambda d: [frame.update(unknown=[], yaw=0.0, shift=[0.0, 0.0]) for frame in d["frames"]], 0,
    ),
    "its greatest growth, m/s": (lambda d: [x.update(growth=0.0) for f in d["frames"] for x in f["unknown"]], 0.0),
    "greatest displacement of a body, m": (
        lambda d: [p.update(unknown=[[0.0, 0.0]] * len(p["unknown"])) for p in d["phases"]], 0.0,
    ),
    "bodies from meshes, with what they enclose": (
        lambda d: [piece.update(triangles=[]) for each in d["bodies"] for piece in each["pieces"]], 0,
    ),
    "pairs of the robot's links that keep apart": (lambda d: d["required"].update(self_pairs=[]), 0),
    "parts that were put down, counted in each phase": (lambda d: [p.update(put_down=[]) for p in d["phases"]], 0),
    "farthest that it may be off, m": (lambda d: d["points"][0].update(position=7.0), 7.0),
    "times and intervals at which the tool is where it must be": (lambda d: d.update(points=[]), 0),
}  # fmt: skip


def test_a_pair_of_links_that_is_there_twice_or_bears_no_bodies_does_not_count() -> None:
    words, document = "pairs of the robot's links that keep apart", bundle("demo")
    own = document["required"]["self_pairs"]
    document["required"]["self_pairs"] = [*own, *([b, a] for a, b in own), *([a, a] for a, _ in own), [0, 99], [98, 99]]
    right, told = shown(document)
    assert right
    assert told == shown(bundle("demo"))[1]
    assert told[words] == len({frozenset(pair) for pair in own}) > 0


@pytest.mark.parametrize("words", LIES)
def test_a_bundle_that_claims_less_is_shown_and_its_number_says_so(words: str) -> None:
    before = shown(bundle("demo"))[1]
    change, value = LIES[words]
    document = bundle("demo")
    change(document)
    right, told = shown(document)
    assert (right, told[words]) == (True, value)
    assert {key for key in before if key not in told} == set()
    assert before[words] != value or document == bundle("demo")
