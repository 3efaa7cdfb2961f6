"""What the prover tells of a bundle: of one that claims less, how much less."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from tests.prover.bundles import Document, bundle, shown

Change = Callable[[Document], object]


def test_a_held_part_accelerates_no_harder_than_is_said() -> None:
    document = bundle("belt-to-belt")
    document["rates"][0]["most"] *= 0.2
    told = shown(bundle("belt-to-belt"))[1]
    pulls = [row for row in bundle("belt-to-belt")["rates"] if row["order"] == 2]
    assert told["times and intervals at which the acceleration of a point is bounded"] == len(pulls)
    assert told["greatest acceleration, m/s²"] == max(row["most"] for row in pulls)
    right, lines = shown(document)
    assert (right, lines[-1]) == (False, "claims that are not shown: 1")


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
