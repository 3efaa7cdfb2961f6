"""Rows about the tool and the joints: hand-made ones are shown as far as they are true, and no farther."""

from __future__ import annotations

import math

import pytest

from tests.prover.bundles import Document, agreed
from tests.prover.test_guards import ball, body, row, sliding

LITTLE = 1e-7
"""More than what the claim checker keeps for rounding, in second derivatives too; the prover keeps nothing."""
WHOLE = {"t0": 0.0, "t1": 1.0}


def slide() -> Document:
    """A slide at 2 t - 4 t³ + 2 t⁴: at 0 and 1 s it is at 0, at 0.5 s at 0.625 m."""
    return sliding(body("wall", ball(0.9)), rows=[row(0, 1)], speed=2.0)


def swinging() -> Document:
    """Two links of 1 m; the first turns from 0 to 1.5 rad, the second from 0 to -0.5 rad against the first."""
    document = sliding(body("wall", ball(9.0)), rows=[row(0, 1)])
    arm = document["arms"][0]
    arm.update(q=[[0.0, 0.0], [1.5, -0.5]], qd=[[0.0, 0.0]] * 2, qdd=[[0.0, 0.0]] * 2)
    second = {**arm["links"][1], "name": "second", "parent": 1, "offset": [1.0, 0.0, 0.0], "slide": None}
    arm["links"][1].update(slide=None)
    arm["links"].append(second)
    for link, shares in zip(arm["links"], ([0.0, 0.0], [1.0, 0.0], [1.0, 1.0]), strict=True):
        link["yaw"] = {"constant": 0.0, "joints": shares}
    document["required"]["lag"] = [0.0, 0.0]
    document["limits"][0].update({key: [x[0]] * 2 for key, x in document["limits"][0].items() if isinstance(x, list)})
    document["limits"][0]["shares"] = [0.0] * 4
    return document


def holds(document: Document, key: str, *rows: Document) -> bool:
    """Whether a bundle is shown with these rows more. What is not shown is one of them each."""
    assert agreed(document)[0]
    right, told = agreed({**document, key: [*document[key], *rows]})
    assert right or told[-1] == f"claims that are not shown: {len(told) - 1}"
    assert right or all(line.startswith(f"{key}, ") for line in told[:-1])
    return right


def summed(order: int, low: float, high: float, **changes: object) -> Document:
    return {**WHOLE, "order": order, "joints": [1.0], "low": low, "high": high, **changes}


RANGES = [(0, 0.0, 0.625), (1, -2.0, 2.0), (2, -6.0, 0.0), (3, -24.0, 24.0)]


@pytest.mark.parametrize(("order", "low", "high"), RANGES)
def test_a_sum_and_its_derivatives_are_in_their_range(order: int, low: float, high: float) -> None:
    document = slide()
    assert holds(document, "sums", summed(order, low - LITTLE, high + LITTLE))
    assert holds(document, "sums", summed(order, -2.0 * high - LITTLE, -2.0 * low + LITTLE, joints=[-2.0]))
    for narrow in ((low + LITTLE, high + LITTLE), (low - LITTLE, high - LITTLE)):
        assert not holds(document, "sums", summed(order, *narrow))


def test_a_sum_is_of_all_joints_at_an_instant_too() -> None:
    document, at_end = swinging(), {"t0": 1.0, "t1": 1.0}
    assert holds(document, "sums", summed(0, 3.5 - LITTLE, 3.5 + LITTLE, joints=[2.0, -1.0], **at_end))
    assert not holds(document, "sums", summed(0, 3.4, 3.5 - LITTLE, joints=[2.0, -1.0], **at_end))
    assert holds(document, "sums", summed(1, -LITTLE, LITTLE, joints=[2.0, -1.0], **at_end))
    with pytest.raises(ValueError, match=r"shorter"):
        agreed({**document, "sums": [summed(0, -9.0, 9.0)]})
    document["sums"] = [summed(0, -9.0, 9.0, joints=[1.0, 0.0]), summed(1, -1.0, 99.0, joints=[1.0, 0.0])]
    told = agreed(document)[1]
    assert told["times and intervals at which a sum of joints or a derivative of it is bounded"] == 2
    assert told["widest range of a sum"] == 100.0


def test_where_an_acceleration_jumps_an_instant_is_in_what_begins_there() -> None:
    document = slide()
    q, speed = 0.625, 0.5
    document["arms"][0].update(
        time=[0.0, 0.5, 0.5, 1.0], q=[[0.0], [q], [q], [0.0]], qd=[[2.0], [speed], [speed], [-2.0]],
        qdd=[[0.0], [1.0], [-3.0], [0.0]],
    )  # fmt: skip
    for at, (low, high) in {0.5: (-3.0, -3.0), 0.0: (0.0, 0.0), 1.0: (0.0, 0.0)}.items():
        instant = {"t0": at, "t1": at}
        assert holds(document, "sums", summed(2, low - LITTLE, high + LITTLE, **instant))
        assert not holds(document, "sums", summed(2, low + LITTLE, high + 9.0, **instant))
        assert holds(document, "rates", rate(2, -low - LITTLE if low else 0.0, -low + LITTLE, **instant))
    # an interval has both of its ends in its own pieces
    assert holds(document, "sums", summed(2, 1.0 - 1e-9, 1.0 + 1e-3, t0=0.5 - 1e-9, t1=0.5)) is False
    assert holds(document, "sums", summed(2, 1.0 - 1e-3, 1.0 + 1e-3, t0=0.5 - 1e-9, t1=0.5))


def test_an_acceleration_that_jumps_to_another_direction_is_no_harder_than_both() -> None:
    document, q, qd = swinging(), [0.75, -0.25], [1.0, -0.3]
    knots = [[0.0, 0.0], q, q, [1.5, -0.5]], [[0.0, 0.0], qd, qd, [0.0, 0.0]]
    document["arms"][0].update(
        time=[0.0, 0.5, 0.5, 1.0], q=knots[0], qd=knots[1], qdd=[[0.0, 0.0], [2.0, 1.0], [-3.0, 2.0], [0.0, 0.0]]
    )
    v = 1.0  # rad/s of the first link
    # of the end of the first link: with the angle's acceleration a it is hypot(a, v²), in two directions
    for at, a in ((math.nextafter(0.5, 0.0), 2.0), (0.5, -3.0)):
        there = {"t0": at, "t1": at, "point": [1.0, 0.0, 0.0]}
        assert holds(document, "rates", rate(2, math.hypot(a, v) - 1e-6, math.hypot(a, v) + 1e-6, **there))
    around = {"t0": 0.49999, "t1": 0.50001, "point": [1.0, 0.0, 0.0]}
    assert holds(document, "rates", rate(2, 0.0, math.hypot(3.0, v) + 1e-2, **around))
    assert holds(document, "rates", rate(2, math.hypot(2.0, v) - 1e-2, math.hypot(3.0, v) + 1e-2, **around))
    assert not holds(document, "rates", rate(2, 0.0, math.hypot(3.0, v) - 1e-2, **around))


def rate(order: int, least: float, most: float, **changes: object) -> Document:
    where = {"name": "a point", "link": 1, "point": [0.3, 0.2, 0.1], "frame": -1}
    return {**WHOLE, **where, "order": order, "least": least, "most": most, **changes}


@pytest.mark.parametrize(
    ("order", "frame", "least", "most"),
    # the belt goes with 1 m/s across the slide
    [(1, -1, 0.0, 2.0), (1, 0, 0.0, 2.0), (1, 1, 1.0, math.sqrt(5.0)), (2, -1, 0.0, 6.0)],
)
def test_a_point_is_as_fast_in_a_frame_as_is_said(order: int, frame: int, least: float, most: float) -> None:
    document = slide()
    assert holds(document, "rates", rate(order, max(least - LITTLE, 0.0), most + LITTLE, frame=frame))
    assert not holds(document, "rates", rate(order, max(least - LITTLE, 0.0), most - LITTLE, frame=frame))
    assert not holds(document, "rates", rate(order, least + LITTLE, most + LITTLE, frame=frame))


def test_a_frame_that_turns_has_a_point_that_is_still_in_the_world_move() -> None:
    document = slide()
    document["arms"][0].update(qd=[[0.0], [0.0]])
    document["frames"][1]["rate"] = [0.0, 0.0, 0.0, 2.0]
    far, off = 2.0 * math.hypot(0.3, 0.2), 1e-5
    for least, most, right in ((far, far, True), (0.1, far - 2 * off, False), (far + 2 * off, 9.0, False)):
        assert holds(document, "rates", rate(1, least - off, most + off, frame=1)) is right
    with pytest.raises(ValueError, match=r"^rates\.0\.frame: "):
        agreed({**document, "rates": [rate(2, 0.0, 99.0, frame=1)]})


def test_the_greatest_velocity_and_acceleration_are_printed() -> None:
    document = slide()
    document["rates"] = [rate(1, 0.0, 7.0), rate(1, 0.0, 5.0), rate(2, 0.0, 11.0)]
    told = agreed(document)[1]
    assert [
        told[f"times and intervals at which the {x} of a point is bounded"] for x in ("velocity", "acceleration")
    ] == [
        2,
        1,
    ]
    assert [told["greatest velocity, m/s"], told["greatest acceleration, m/s²"]] == [7.0, 11.0]


def axis(low: float, high: float, **changes: object) -> Document:
    where = {"name": "an axis", "link": 2, "place": False, "axis": [1.0, 0.0, 0.0], "other": -1}
    return {**WHOLE, **where, "direction": [1.0, 0.0, 0.0], "low": low, "high": high, **changes}


AXES: dict[str, tuple[dict[str, object], float, float]] = {
    "an axis in the world": ({}, math.cos(1.0), 1.0),
    "an axis against that of another link": ({"other": 1}, math.cos(0.5), 1.0),
    "the sine of an elbow": ({"other": 1, "direction": [0.0, 1.0, 0.0]}, -math.sin(0.5), 0.0),
    "a place in the world": ({"place": True, "axis": [0.0] * 3}, math.cos(1.5), 1.0),
    "a height": ({"place": True, "axis": [0.5, 0.2, 0.3], "direction": [0.0, 0.0, 1.0]}, 0.3, 0.3),
    "a place as another link has it": ({"place": True, "other": 1}, 1.0 + math.cos(0.5), 2.0),
    "the base as a link has it": ({"link": 0, "other": 2, "place": True, "axis": [0.0] * 3}, -1.0, -math.cos(0.5)),
}


@pytest.mark.parametrize("what", AXES)
def test_a_scalar_product_is_in_its_range(what: str) -> None:
    document, (changes, low, high) = swinging(), AXES[what]
    assert holds(document, "axes", axis(low - LITTLE, high + LITTLE, **changes))
    assert not holds(document, "axes", axis(low + LITTLE, high + LITTLE, **changes))
    assert not holds(document, "axes", axis(low - LITTLE, high - LITTLE, **changes))


def test_the_widest_range_of_a_direction_is_printed() -> None:
    document = swinging()
    document["axes"] = [axis(-5.0, 5.0), axis(-7.0, 5.0, place=True)]
    told = agreed(document)[1]
    assert told["times and intervals at which an axis has a direction, or a point a place along one"] == 2
    assert told["widest range of these, or m"] == 12.0


def guide(**changes: object) -> Document:
    where = {"link": 1, "tool": [0.0, 0.1, 0.0], "frames": [0, 1], "from": [0.0, 0.1, 0.0], "to": [0.0, 0.1, 0.0]}
    return {**WHOLE, **where, "shares": [0.0, 0.0], "most": LITTLE, **changes}


def test_a_tool_is_at_its_guide() -> None:
    document = slide()
    assert holds(document, "guides", guide(most=0.625 + LITTLE))
    assert not holds(document, "guides", guide(most=0.625 - LITTLE))
    # with 1 m/s it goes straight from 0 to 1 m, as the guide does from a point that stands to one of the belt
    document["arms"][0].update(q=[[0.0], [1.0]], qd=[[1.0], [1.0]])
    document["frames"][1]["rate"] = [0.0] * 4
    document["rows"] = [{**row(0, 1), "normal": [0.0, 1.0, 0.0]}]
    document["seats"][1]["pose"] = [0.0, 9.0, 0.0, 0.0]
    straight = {"shares": [0.0, 1.0], "to": [1.0, 0.1, 0.0]}
    assert holds(document, "guides", guide(**straight))
    assert not holds(document, "guides", guide(**{**straight, "shares": [0.0, 1.0 - 1e-6]}))
    assert not holds(document, "guides", guide(**{**straight, "shares": [1e-6, 1.0]}))
    assert not holds(document, "guides", guide(**straight, tool=[0.0, 0.1, 1e-6]))
    # B moves away: at t the guide is t (2 + t) farther along y
    document["frames"][1]["rate"] = [0.0, 1.0, 0.0, 0.0]
    document["frames"][1]["pose"] = [0.0, 1.0, 0.0, 0.0]
    assert holds(document, "guides", guide(**straight, most=3.0 + LITTLE))
    assert not holds(document, "guides", guide(**straight, most=3.0 - LITTLE))


def test_a_guide_at_an_instant_has_one_share() -> None:
    document, instant = slide(), {"t0": 0.0, "t1": 0.0}
    assert holds(document, "guides", guide(**instant))
    assert not holds(document, "guides", guide(**instant, shares=[0.0, 1.0], most=9.0))
    document["guides"] = [guide(most=3.0), guide(**instant)]
    told = agreed(document)[1]
    assert told["times and intervals at which a point is at its guide"] == 2
    assert told["farthest from a guide, m"] == 3.0


def apart(*weighted: tuple[float, list[float]], most: float, **changes: object) -> Document:
    filled = [*weighted, *[(0.0, [0.0] * 3)] * (4 - len(weighted))]
    where = {"time": 0.5, "phase": 0, "bodies": [0, 1], "pieces": [0, 0], "most": most}
    return {**where, "weights": [w for w, _ in filled], "directions": [x for _, d in filled for x in d], **changes}


PIECES: dict[str, tuple[Document, list[tuple[float, list[float]]], float]] = {
    "a ball": (ball(0.9), [(1.0, [5.0, 0.0, 0.0])], 0.9 - 0.1),
    "a disc across its axis": ({**ball(0.9, 0.0), "disc": 0.1}, [(1.0, [1.0, 0.0, 1e-12])], 0.9 - 0.1),
    "a disc along its axis": ({**ball(0.9, 0.0), "disc": 0.1, "axis": [1.0, 0.0, 0.0]}, [(1.0, [2.0, 0.0, 0.0])], 0.9),
    "edges": (
        {**ball(0.9, 0.0), "edges": [[0.1, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, -0.1]]},
        [(1.0, [1.0, 0.0, 0.0])], 0.8,
    ),
    "two vertices, halfway": (
        {**ball(0.9, 0.0), "vertices": [[0.8, 1.0, 0.0], [0.8, -1.0, 0.0]]},
        [(0.5, [1.0, 0.5, 0.0]), (0.5, [1.0, -0.5, 0.0])], 0.8,
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", PIECES)
def test_two_bodies_are_as_near_as_is_said(what: str) -> None:
    piece, weighted, far = PIECES[what]
    document = sliding(body("wall", piece), rows=[row(0, 1)], speed=0.2)
    # the ball has come out to 0.0625 m; the weighted points of "vertices" are off its own middle by half of the ball
    gap = far - 0.0625 - 0.1 * sum(w * d[0] / math.hypot(*d) for w, d in weighted)
    assert holds(document, "distances", apart(*weighted, most=gap + LITTLE))
    assert not holds(document, "distances", apart(*weighted, most=gap - LITTLE))
    assert holds(document, "distances", apart(*weighted, most=gap + 0.0625 + LITTLE, time=0.0))
    assert not holds(document, "distances", apart(*weighted, most=gap + LITTLE, time=0.0))


def test_weights_of_a_distance_have_the_sum_one_and_its_time_is_in_its_phase() -> None:
    document, ahead = sliding(body("wall", ball(0.9)), rows=[row(0, 1)]), [1.0, 0.0, 0.0]
    assert holds(document, "distances", apart((0.5, ahead), (0.5 + 1e-10, ahead), most=0.7 + LITTLE))
    assert not holds(document, "distances", apart((0.5, ahead), (0.4, ahead), most=9.0))
    assert not holds(document, "distances", apart(most=9.0))
    assert not holds(document, "distances", apart((1.0, [0.0] * 3), most=9.0))
    assert not holds(document, "distances", apart((1.0, ahead), most=9.0, time=1.0 + 1e-9))
    with pytest.raises(ValueError, match="phase 1 does not exist"):
        agreed({**document, "distances": [apart((1.0, ahead), most=9.0, phase=1)]})
    document["distances"] = [apart((1.0, ahead), most=3.0)]
    assert agreed(document)[1]["farthest of these, m"] == 3.0
