"""Shows what a proof bundle claims, with ball arithmetic that is rounded outwards, or says what it cannot show.

It reads one document (form assur-bundle/1) and nothing else. Every number in it is taken as the double that it is. A
ball of Arb (`flint.arb`) holds every value that its centre and radius allow, a comparison of balls is true only if it
is true for all of them, and no rounding is lost. So there is no tolerance here: what may be off, and by how much, is
said in the bundle, as a part of the claim. What cannot be shown is refused, and so is what takes too much work.

Motion. Joints and frames follow polynomials between instants; a carrier (a link of an arm, or a frame) has its place
p(t) and the columns of its rotation R(t) from them. Over an interval every quantity is a series f, f', f''/2 of balls
that hold all its values there (P1). Sums, products, sines and roots of series bound the motion of all points.

Apart. A piece is centre + edges [-1, 1] + disc + ball, or the hull of its vertices. Its support along m is the largest
m·x of its points (P2). Pieces A and B have the gap -support_A(n) - support_B(-n) along a normal n, in lengths of n; no
distance is smaller. For points x of A and y of B n·(y - x) leaves its chord over an interval h long by M h²/8 at most,
if its second derivative is M at most. So with M for all points

    gap(t) >= min(gap(t0), gap(t1)) - max(M, 0) h²/8                                                        (P3)

A row of the bundle names an interval, two pieces and a normal. It holds if (P3) is no less than what is required over
all of the interval or over all of its parts, which are halved. Balls, and discs about the vertical on what turns about
the vertical only, add nothing to M, for they do not change. Where B is s ahead of the clock, s0 <= s <= s1, the least of
four corners counts, less max(M_B, 0) (s1 - s0)²/8 (P4).
"""

from __future__ import annotations

import json
import math
import sys
from bisect import bisect_right
from collections.abc import Callable, Iterable
from functools import cached_property
from itertools import pairwise, product
from pathlib import Path
from typing import Any

from flint import arb, arb_mat, arb_poly, arb_series, ctx

FORM, BITS, TERMS = "assur-bundle/1", 160, 3
WORK, DEEPEST, MOST_BYTES, MOST_TOLD = 2_000_000, 40, 64_000_000, 20
"""Evaluations in all; how often an interval is halved; the longest file; how many failures are told."""
Document, Vector = dict[str, Any], list[Any]


class UnreadableError(Exception):
    """The document is no bundle: where, and what is allowed."""


class NotKnownError(Exception):
    """A motion is asked for where it is not given, or there is no work left."""


def nth(items: Any, k: int, what: str) -> Any:
    """Item k of a list. Raises `UnreadableError` where there is none."""
    if not 0 <= k < len(items):
        raise UnreadableError(f"{what} {k} does not exist; there are {len(items)}")
    return items[k]


def dot(a: Vector, b: Vector) -> Any:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def length(a: Vector) -> arb:
    """No vector in a ball of vectors is longer."""
    return sum((x * x for x in a), arb(0)).max(arb(0)).upper().sqrt().upper()


def largest(balls: Iterable[arb]) -> arb:
    """No value in some balls is larger."""
    found = arb("-inf")
    for ball in balls:
        found = found.max(ball.upper())
    return found


def constant(x: Any) -> arb_series:
    return arb_series([arb(x)], TERMS)


class Curve:
    """Several coordinates: polynomials of the time since the begin of each piece, between `edges`."""

    def __init__(self, edges: list[float], pieces: list[Vector]) -> None:
        self.edges, self.pieces = edges, pieces

    def over(self, low: arb, high: arb) -> list[arb_series]:
        """Series of all coordinates over [low, high] (P1), from all pieces that are touched."""
        if not (low >= self.edges[0] and high <= self.edges[-1]):
            raise NotKnownError(f"a motion from {low} s to {high} s")
        found: list[Vector] = []
        for k in range(max(bisect_right(self.edges, float(low)) - 2, 0), len(self.pieces)):
            begin, end = arb(self.edges[k]), arb(self.edges[k + 1])
            if begin > high or (begin >= high and found):
                break
            if end < low or (end <= low and low < high):
                continue
            a, b = low.max(begin) - begin, high.min(end) - begin
            middle = ((a + b) / 2).mid()
            away, moved, here = a.union(b) - middle, arb_poly([middle, 1]), []
            for polynomial in self.pieces[k]:
                about = polynomial(moved)
                rate = about.derivative()
                here.append([about(away), rate(away), rate.derivative()(away) / 2])
            found = found and [
                [x.union(y) for x, y in zip(*both, strict=True)] for both in zip(found, here, strict=True)
            ]
            found = found or here
        return [arb_series(each, TERMS) for each in found]


def spline(arm: Document) -> Curve:
    """The quintic between each two knots that has their positions, velocities and accelerations (P5)."""
    time, pieces, edges = arm["time"], list[Vector](), arm["time"][:1]
    knots = list(zip(time, arm["q"], arm["qd"], arm["qdd"], strict=True))
    for (t0, *one), (t1, *other) in pairwise(knots):
        if t0 == t1 and one[:2] == other[:2]:
            continue  # the acceleration jumps
        h, own = arb(t1) - t0, []
        if not h > 0:
            raise UnreadableError("times of knots increase, or position and velocity are the same")
        for (x, v, a), (y, w, b) in zip(zip(*one, strict=True), zip(*other, strict=True), strict=True):
            d, u = arb(y) - x, h * h
            own.append(arb_poly([
                x, v, arb(a) / 2,
                (20 * d - (8 * arb(w) + 12 * arb(v)) * h - (3 * arb(a) - b) * u) / (2 * h * u),
                (-30 * d + (14 * arb(w) + 16 * arb(v)) * h + (3 * arb(a) - 2 * arb(b)) * u) / (2 * u * u),
                (12 * d - 6 * (arb(v) + w) * h + (arb(b) - a) * u) / (2 * h * u * u),
            ]))  # fmt: skip
        pieces.append(own)
        edges.append(t1)
    return Curve(edges, pieces)


def law(frame: Document) -> Curve:
    """Of a frame: its acceleration, integrated twice from pose and rate at the first edge, so that neither jumps (P6)."""
    pieces, state = [], [(arb(x), arb(v)) for x, v in zip(frame["pose"], frame["rate"], strict=True)]
    for (t0, t1), accelerations in zip(pairwise(frame["edges"]), frame["acceleration"], strict=True):
        h, own = arb(t1) - t0, []
        if not h > 0:
            raise UnreadableError("edges of a frame's motion increase")
        for (x, v), powers in zip(state, accelerations, strict=True):
            own.append(arb_poly([x, v, *(arb(a) / ((m + 1) * (m + 2)) for m, a in enumerate(powers))]))
        state = [(path(h), path.derivative()(h)) for path in own]
        pieces.append(own)
    return Curve(list(frame["edges"]), pieces)


class Carrier:
    """Series of a place (3) and of the columns (3 of 3) of a rotation; whether it turns about the vertical only."""

    def __init__(self, place: Vector, columns: list[Vector], upright: bool) -> None:
        self.place, self.columns, self.upright = place, columns, upright

    def point(self, local: Vector) -> Vector:
        """The series of a point that is fixed in it, or moves in it."""
        return [
            p + x * local[0] + y * local[1] + z * local[2] for p, x, y, z in zip(self.place, *self.columns, strict=True)
        ]

    @cached_property
    def orders(self) -> list[tuple[Vector, list[Vector]]]:
        """Place and columns as balls: values, rates, second derivatives."""
        return [
            ([s[k] * (k or 1) for s in self.place], [[s[k] * (k or 1) for s in column] for column in self.columns])
            for k in range(TERMS)
        ]


def upright(place: Vector, sine: arb_series, cosine: arb_series) -> Carrier:
    none, one = constant(0), constant(1)
    return Carrier(place, [[cosine, sine, none], [-sine, cosine, none], [none, none, one]], True)


def chain(arm: Document, q: Vector) -> list[Carrier]:
    """All links of an arm. The origin of a link is its offset in its parent and what its joint slides along the axis;
    its rotation is Rz(yaw) Ry(-pitch) Rx(roll), each angle a constant and shares of joints, a yaw from a coupler's."""
    found: list[Carrier] = []
    couplers: list[Vector] = []

    def turned(angle: Document) -> tuple[arb_series, arb_series]:
        shares = zip(angle["joints"], q, strict=True)
        return sum((value * arb(a) for a, value in shares if a), constant(angle["constant"])).sin_cos()  # type: ignore[no-any-return]

    for link in arm["links"]:
        place, slide = [constant(x) for x in link["offset"]], link["slide"]
        if slide is not None:
            place = [x + nth(q, slide["joint"], "joint") * arb(a) for x, a in zip(place, slide["axis"], strict=True)]
        if link["parent"] >= 0:
            place = nth(found, link["parent"], "an earlier link").point(place)
        s, c = turned(link["yaw"])
        if link["coupler"] >= 0:
            couplers = couplers or closed(nth(arm["loop"], 0, "loop"), found)
            x, y = nth(couplers, link["coupler"], "coupler")
            s, c = s * x + c * y, c * x - s * y
        if link["pitch"] is None:
            found.append(upright(place, s, c))
            continue
        (sp, cp), (sr, cr) = turned(link["pitch"]), turned(link["roll"])
        both = list(zip([-s, c, constant(0)], [-(sp * c), -(sp * s), cp], strict=True))
        columns = [[cr * level + sr * up for level, up in both], [cr * up - sr * level for level, up in both]]
        found.append(Carrier(place, [[cp * c, cp * s, sp], *columns], False))
    return found


def closed(loop: Document, found: list[Carrier]) -> list[Vector]:
    """Cosine and sine of both couplers of a loop, which go from the ends of two cranks to where they meet, on the given
    side. With s from end to end, fold = (s² - a² - b²)/(2 a b) is the cosine of the angle between them (P7); where the
    margin sqrt(1 - fold²) is not shown to be as large as is claimed, the loop is not known to be closed."""
    ends = [
        nth(found, k, "link").point([arb(r), arb(0), arb(0)])
        for k, r in zip(loop["cranks"], loop["lengths"], strict=True)
    ]
    a, b = map(arb, loop["couplers"])
    dx, dy = ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]
    square = dx * dx + dy * dy
    fold = (square - (a * a + b * b)) / (2 * a * b)
    margin = 1 - fold * fold
    if not (margin[0] >= arb(loop["least"]) ** 2 and arb(loop["least"]) > 0):
        raise NotKnownError("a loop that may come apart")
    along, across = (square + (a * a - b * b)) / (square * 2), margin.sqrt() / square * (arb(loop["side"]) * a * b)
    ex, ey = along * dx - across * dy, along * dy + across * dx
    return [[ex / a, ey / a], [(ex - dx) / b, (ey - dy) / b]]


class Solid:
    """A piece of a body at a pose in its carrier."""

    def __init__(self, piece: Document, pose: Vector) -> None:
        at, (s, c) = [arb(x) for x in pose[:3]], arb(pose[3]).sin_cos()

        def turned(v: Vector) -> Vector:
            x, y, z = map(arb, v)
            return [c * x - s * y, s * x + c * y, z]

        def put(v: Vector) -> Vector:
            return [a + b for a, b in zip(at, turned(v), strict=True)]

        self.centre, self.edges, corners = (
            put(piece["centre"]),
            [turned(edge) for edge in piece["edges"]],
            list(map(put, piece["vertices"])),
        )
        self.disc, self.axis, self.ball = arb(piece["disc"]), turned(piece["axis"]), arb(piece["ball"])
        self.hull = arb_mat(len(corners), 3, [x for corner in corners for x in corner]) if corners else None
        if not (self.disc >= 0 and self.ball >= 0 and dot(self.axis, self.axis) > 0):
            raise UnreadableError("a piece has a disc and a ball that are not negative, and an axis that is not zero")
        signed = product((-1, 1), repeat=min(len(self.edges), 6))
        rims = [
            [sum((k * e[i] for k, e in zip(signs, self.edges, strict=False)), self.centre[i]) for i in (0, 1)]
            for signs in signed
        ]
        self.reach = largest(map(length, [corner[:2] for corner in corners] or rims)) + self.disc + self.ball

    def support(self, place: Vector, columns: list[Vector], m: Vector, size: arb | None, upright: bool) -> arb:
        """The largest m·x (P2). `size`: |m|; None: of derivatives, where what does not change counts nothing."""
        g, (x, y, z) = [dot(column, m) for column in columns], self.axis
        found = dot(m, place)
        if self.hull is not None:
            found += largest((self.hull * arb_mat(3, 1, g)).entries())
        else:
            found += sum((abs(dot(g, edge)) for edge in self.edges), dot(g, self.centre))
        if self.disc > 0 and (size is not None or not (upright and x == 0 and y == 0)):
            across = (
                length(g)
                if size is None
                else length([g[1] * z - g[2] * y, g[2] * x - g[0] * z, g[0] * y - g[1] * x]) / length(self.axis).lower()
            )
            found += self.disc * across
        return found if size is None else found + self.ball * size


class World:
    """Where every body of a bundle is at every time."""

    def __init__(self, bundle: Document) -> None:
        self.bundle, self.work = bundle, WORK
        self.splines = [spline(arm) for arm in bundle["arms"]]
        self.laws = [law(frame) if frame["edges"] else None for frame in bundle["frames"]]
        self.kept: dict[Any, Any] = {}
        self.boxes = [self._box(body["pieces"]) for body in bundle["bodies"]]

    @staticmethod
    def _box(pieces: list[Document]) -> Document:
        """The box in a body's own axes that holds its pieces."""
        solids, ends = [Solid(piece, [0] * 4) for piece in pieces], []
        unit = [[arb(int(i == k)) for i in range(3)] for k in range(3)]
        for k, sign in product(range(3), (-1, 1)):
            m = [sign * x for x in unit[k]]
            ends.append(sign * largest(each.support([0] * 3, unit, m, arb(1), False) for each in solids))
        centre = [((a + b) / 2).mid() for a, b in zip(ends[::2], ends[1::2], strict=True)]
        half = [(b - c).max(c - a).upper() for a, b, c in zip(ends[::2], ends[1::2], centre, strict=True)]
        edges = [[x * h for x in unit[k]] for k, h in enumerate(half)]
        return {"centre": centre, "edges": edges, "disc": 0, "axis": [0, 0, 1], "ball": 0, "vertices": []}

    def stands(self, f: int) -> bool:
        """Whether a frame never moves."""
        frame = nth(self.bundle["frames"], f, "frame")
        return self.laws[f] is None and frame["arm"] < 0 and not frame["waves"]

    def links(self, arm: int, low: arb, high: arb) -> list[Carrier]:
        return chain(nth(self.bundle["arms"], arm, "arm"), self.splines[arm].over(low, high))

    def _frame(self, f: int, low: arb, high: arb) -> Carrier:
        frame, own = self.bundle["frames"][f], self.laws[f]
        if frame["arm"] >= 0:
            return nth(self.links(frame["arm"], low, high), frame["link"], "link")  # type: ignore[no-any-return]
        now = [constant(x) for x in frame["pose"]] if own is None else own.over(low, high)
        for wave in frame["waves"]:
            angle = arb_series([low.union(high), 1], TERMS) * arb(wave["rate"]) + arb(wave["phase"])
            now[wave["coordinate"]] += angle.sin() * arb(wave["amplitude"])
        return upright(now[:3], *now[3].sin_cos())

    def carrier(self, seat: Document, t0: float, t1: float, s0: float = 0.0, s1: float = 0.0) -> Carrier:
        """What a body sits on: a link of the robot, which follows the clock, or a frame, s ahead of it."""
        link, f = seat["link"], seat["frame"]
        key: tuple[Any, ...] = (-1, t0, t1) if link >= 0 else (f, t0, t1, s0, s1)
        if link < 0 and self.stands(f):
            key = (f, 0.0, 0.0, 0.0, 0.0)
        if key not in self.kept:
            self.work -= 1
            if self.work < 0:
                raise NotKnownError("more work than is allowed")
            low, high = (arb(key[1]), arb(key[2])) if link >= 0 else (arb(key[1]) + key[3], arb(key[2]) + key[4])
            self.kept[key] = self.links(0, low, high) if link >= 0 else self._frame(f, low, high)
        return nth(self.kept[key], link, "link") if link >= 0 else self.kept[key]  # type: ignore[no-any-return]

    def solid(self, seat: Document, piece: int) -> Solid:
        """A piece of a body where it sits; -1: the box that holds them all."""
        key = (id(seat), piece)
        if key not in self.kept:
            pieces = nth(self.bundle["bodies"], seat["body"], "body")["pieces"]
            self.kept[key] = Solid(self.boxes[seat["body"]] if piece < 0 else nth(pieces, piece, "piece"), seat["pose"])
        return self.kept[key]  # type: ignore[no-any-return]


class Duty:
    """Bodies a and b of a phase must stay `least` apart (less than 0: may touch as deep), before what is not known of
    them; a is looked at by the clock, b from `early` to `late` ahead of it."""

    def __init__(self, a: int, b: int, least: float, early: float, late: float) -> None:
        self.a, self.b, self.least, self.early, self.late, self.rows = a, b, least, early, late, list[int]()


class Separation:
    """Which bodies must stay apart in each phase, and whether the rows of the bundle show it."""

    def __init__(self, world: World, failed: Callable[[str], None]) -> None:
        self.world, self.failed, bundle = world, failed, world.bundle
        self.frames, self.bodies, self.rows, self.must = (
            bundle[key] for key in ("frames", "bodies", "rows", "required")
        )
        self.phases, self.arm = bundle["phases"], bundle["arms"][0]
        self.seats = [[nth(bundle["seats"], k, "seat") for k in phase["seats"]] for phase in self.phases]
        if any([at["body"] for at in seats] != list(range(len(self.bodies))) for seats in self.seats):
            raise UnreadableError("seats of a phase: one of each body is allowed, in their order")

    def ahead(self, f: int, late: float) -> tuple[float, float]:
        """Between which times a frame may be ahead of a robot that starts up to `late` late."""
        least, most = self.frames[f]["shift"]
        return (0.0, 0.0) if self.world.stands(f) else (-most, late - least)

    def duties(self, p: int) -> dict[frozenset[int], Duty]:
        """The robot's bodies and all others; those on links that are asked to stay apart; parts that were put down and
        what is on another frame, if one of both moves and they were not put on it."""
        phase, at, found = self.phases[p], self.seats[p], dict[frozenset[int], Duty]()
        touching = {frozenset(each["bodies"]): each["depth"] for each in phase["contacts"]}
        asked = [frozenset(pair) for pair in self.must["self_pairs"]]

        def add(a: int, b: int, near: bool, early: float = 0.0, late: float = 0.0) -> None:
            least, key = self.must["near" if near else "travel"], frozenset((a, b))
            for rule in self.must["exceptions"]:
                if any(x in (rule["first"] or [x]) and y in (rule["second"] or [y]) for x, y in ((a, b), (b, a))):
                    least = rule["near" if near else "travel"]
            found.setdefault(key, Duty(a, b, -touching[key] if key in touching else least, early, late))

        for a, b in product(range(len(at)), repeat=2) if phase["robot"] else ():
            one, other = at[a]["link"], at[b]["link"]
            if one >= 0 > other:
                add(a, b, phase["near"], *self.ahead(at[b]["frame"], self.must["late"]))
            elif one >= 0 and a < b and one != other and frozenset((one, other)) in asked:
                add(a, b, phase["near"])
        for part in phase["put_down"]:
            here = nth(at, part["body"], "body")["frame"]
            for b, there in enumerate(seat["frame"] for seat in at):
                if (
                    there in (-1, here)
                    or b in part["supports"]
                    or (self.world.stands(here) and self.world.stands(there))
                ):
                    continue
                (low, high), (first, last) = self.ahead(there, 0.0), self.ahead(here, 0.0)
                add(part["body"], b, True, *((0.0, 0.0) if self.world.stands(there) else (low - last, high - first)))
        return found

    def show(self) -> tuple[int, int]:
        """Shows all rows, and that they cover every pair for the whole of every phase; how many rows and pairs."""
        duties, begins = [self.duties(p) for p in range(len(self.phases))], [phase["t0"] for phase in self.phases]
        outside: list[set[frozenset[int]]] = [set() for _ in self.phases]
        for r, row in enumerate(zip(*(self.rows[key] for key in ("t0", "t1", "first", "second")), strict=True)):
            t0, t1, first, second = row
            p, names = bisect_right(begins, t0) - 1, [nth(self.bodies, k, "body")["name"] for k in (first, second)]
            if not (p >= 0 and t0 <= t1 <= self.phases[p]["t1"]):
                self.failed(f"row {r} is not within one phase")
                continue
            duty = duties[p].get(frozenset((first, second)))
            if duty is None or ((duty.early, duty.late) != (0.0, 0.0) and duty.a != first):
                continue  # a row that nobody asks for
            if not self.holds(p, r, duty):
                self.failed(f"row {r}: {' and '.join(names)} from {t0:.9g} s to {t1:.9g} s")
                continue
            duty.rows.append(r)
            pieces = {first: self.rows["first_piece"][r], second: self.rows["second_piece"][r]}
            if duty.least >= 0 and all(k < 0 or len(self.bodies[body]["pieces"]) == 1 for body, k in pieces.items()):
                outside[p].add(frozenset((first, second)))
        for p, phase in enumerate(self.phases):
            for key, duty in duties[p].items():
                names = " and ".join(self.bodies[k]["name"] for k in (duty.a, duty.b)) + f" in {phase['kind']}"
                hole = self.hole(p, duty) if phase["t1"] > phase["t0"] else None
                if hole is not None:
                    self.failed(f"{names}: no row from {hole:.9g} s on")
                # on all phases in a row in which a pair must stay apart it is inside of what is hollow, or never is
                apart = [key in each and each[key].least >= 0 for each in duties]
                first = max((k + 1 for k in range(p) if not apart[k]), default=0)
                last = min((k for k in range(p, len(apart)) if not apart[k]), default=len(apart))
                if (
                    any(self.bodies[k]["hollow"] for k in key)
                    and not any(key in each for each in outside[first:last])
                    and last > first
                ):
                    self.failed(f"{names}: nothing shows that one is not within the other")
        return sum(len(each.rows) for own in duties for each in own.values()), sum(map(len, duties))

    def holds(self, p: int, r: int, duty: Duty) -> bool:
        """Whether a row holds on its interval, or on all parts of it (P3, P4)."""
        rows, world, n = self.rows, self.world, [arb(x) for x in self.rows["normal"][r]]
        one, other = (self.seats[p][rows[key][r]] for key in ("first", "second"))
        a, b = world.solid(one, rows["first_piece"][r]), world.solid(other, rows["second_piece"][r])
        size, back = length(n), [-x for x in n]
        stack = [(rows["t0"][r], rows["t1"][r], rows["s0"][r], rows["s1"][r], 0)]
        while stack:
            t0, t1, s0, s1, depth = stack.pop()
            far, h, ahead = list[arb](), arb(t1) - t0, arb(s1) - s0
            bend_t = bend_s = arb(math.nan)
            try:
                for t, s in product((t0, t1), {s0, s1}):
                    on, beside = world.carrier(one, t, t), world.carrier(other, t, t, s, s)
                    far.append(
                        a.support(*on.orders[0], n, size, on.upright)
                        + b.support(*beside.orders[0], back, size, beside.upright)
                    )
                on, beside = world.carrier(one, t0, t1), world.carrier(other, t0, t1, s0, s1)
                bend_s = b.support(*beside.orders[2], n, None, beside.upright)
                bend_t = (bend_s + a.support(*on.orders[2], back, None, on.upright)).max(arb(0)) * h * h / 8
                bend_s = bend_s.max(arb(0)) * ahead * ahead / 8
                need = self.need(p, duty, n, size, t0, t1, ((one, a), (other, b)))
                if -largest(far) - bend_t - bend_s - need >= 0:
                    continue
                if any(-x < need.lower() for x in far):
                    return False
            except NotKnownError:
                pass  # a loop may be known to be closed on parts of what is too wide
            if depth >= DEEPEST or world.work < 0 or (t0 == t1 and s0 == s1):
                return False
            split = s1 > s0 and (t0 == t1 or not bend_t >= bend_s)
            t, s = (t0 + t1) / 2, (s0 + s1) / 2
            parts = [(t0, t1, s0, s), (t0, t1, s, s1)] if split else [(t0, t, s0, s1), (t, t1, s0, s1)]
            stack += [(*part, depth + 1) for part in parts]
        return True

    def need(self, p: int, duty: Duty, n: Vector, size: arb, t0: float, t1: float, sides: Any) -> arb:
        """The gap that is required along a normal: the distance, and how much nearer what is not known may bring both
        bodies (P8)."""
        found, flat, phase = duty.least * size, length(n[:2]), self.phases[p]
        lasts = (arb(t1) + self.must["late"] - self.must["since"]).max(arb(0))
        tools = [seat["link"] >= self.must["tool_from"] for seat, _ in sides]
        for f, frame in enumerate(self.frames):
            on = [seat["frame"] == f for seat, _ in sides]
            for each in frame["unknown"] if not all(tools) else ():
                given = phase["shares"][f] if each["shared"] else (0.0, 0.0)
                (a, b), (c, d) = (
                    (1.0, 1.0) if here else given if tool else (0.0, 0.0) for here, tool in zip(on, tools, strict=True)
                )
                along = abs(dot(n, each["direction"])) if each["direction"] else flat
                found += max(abs(d - a), abs(b - c)) * (each["amount"] + each["growth"] * lasts) * along
            found += sum(frame["yaw"] * solid.reach * flat for here, (_, solid) in zip(on, sides, strict=True) if here)
        for seat, solid in sides:
            across, upwards = phase["unknown"][seat["body"]]
            found += across * flat + upwards * abs(n[2])
            if seat["link"] >= 0 and any(self.must["lag"]):
                lags = [arb(0, x) for x in self.must["lag"]]
                now = self.world.splines[0].over(arb(t0), arb(t1))
                moved = [arb_series([x[0] + lag, lag], TERMS) for x, lag in zip(now, lags, strict=True)]
                carrier = nth(chain(self.arm, moved), seat["link"], "link")
                found += solid.support(*carrier.orders[1], n, None, carrier.upright)
        return found

    def hole(self, p: int, duty: Duty) -> float | None:
        """When a pair is first not covered, for a shift of its window; None: never."""
        rows, phase, own = self.rows, self.phases[p], []
        many = [len(self.bodies[body]["pieces"]) for body in (duty.a, duty.b)]
        for r in sorted(duty.rows, key=rows["t0"].__getitem__):
            pieces = rows["first_piece"][r], rows["second_piece"][r]
            own.append(
                (
                    rows["t0"][r],
                    rows["t1"][r],
                    rows["s0"][r],
                    rows["s1"][r],
                    pieces if rows["first"][r] == duty.a else pieces[::-1],
                )
            )
        edges = sorted({x for row in own for x in row[2:4] if duty.early < x < duty.late})
        for low, high in pairwise([duty.early, *edges, duty.late]):
            there = [(t0, t1, at) for t0, t1, s0, s1, at in own if s0 <= low and high <= s1]
            whole = all(at == (-1, -1) for _, _, at in there)
            for pair in [(-1, -1)] if whole else product(*map(range, many)):
                reached = phase["t0"]
                for t0, t1, at in there:
                    if t0 <= reached and all(x in (-1, y) for x, y in zip(at, pair, strict=True)):
                        reached = max(reached, t1)
                if reached < phase["t1"]:
                    return float(reached)
        return None


def keeps(polynomial: Any, h: arb, low: arb, high: arb) -> bool:
    """Whether a polynomial is between two bounds on [0, h]: its control values hold it, those at the ends are taken (P9)."""
    powers = [a * h**k for k, a in enumerate(polynomial.coeffs())] or [arb(0)]
    n = len(powers) - 1
    stack = [[sum(arb(math.comb(i, k)) / math.comb(n, k) * powers[k] for k in range(i + 1)) for i in range(n + 1)]]
    for _ in range(WORK):
        if not stack:
            return True
        values = stack.pop()
        if all(low <= value <= high for value in values):
            continue
        if len(stack) > DEEPEST or any(
            not (value >= low.lower() and value <= high.upper()) for value in (values[0], values[-1])
        ):
            return False
        left, right, row = [values[0]], [values[-1]], values
        while len(row) > 1:
            row = [(a + b) / 2 for a, b in pairwise(row)]
            left.append(row[0])
            right.append(row[-1])
        stack += [right[::-1], left]
    return False


def limits(world: World, failed: Callable[[str], None]) -> None:
    """Each joint keeps its limits on every piece of the spline that reaches into the time for which they count."""
    own, covered = world.splines[0], False
    for span in world.bundle["limits"]:
        covered = covered or (span["t0"] <= own.edges[0] and own.edges[-1] <= span["t1"])
        for k, (t0, t1) in enumerate(pairwise(own.edges)):
            if t1 < span["t0"] or t0 > span["t1"]:
                continue
            rates = [[-x for x in span[key]] for key in ("velocity", "acceleration", "jerk")]
            bounds = [
                (span["lower"], span["upper"]),
                *zip(rates, (span[key] for key in ("velocity", "acceleration", "jerk")), strict=True),
            ]
            for j, path in enumerate(own.pieces[k]):
                for (low, high), kind in zip(bounds, ("position", "velocity", "acceleration", "jerk"), strict=True):
                    if low and not keeps(path, arb(t1) - t0, arb(low[j]), arb(high[j])):
                        failed(f"joint {j + 1} does not keep its {kind} from {t0:.9g} s to {t1:.9g} s")
                    path = path.derivative()
    if not covered:
        failed("no limits count for all of the motion")


def relative(world: World, point: Document, t0: float, t1: float) -> list[tuple[Vector, arb]]:
    """Of a tool point against its control point: vectors of series, and how long each may be."""
    tool, target, found = point["tool"], point["target"], []
    here = world.carrier({"link": point["link"], "frame": -1}, t0, t1)
    there = world.carrier({"link": -1, "frame": point["frame"]}, t0, t1)
    away = [x - y for x, y in zip(here.point(tool), there.point(target), strict=True)]
    for height in point["height"]:  # it may be so high above it
        found.append(([away.pop() - height / 2], arb(height) / 2 + point["position"]))
    found.append((away, arb(point["position"])))
    for yaw in point["yaw"]:
        (s, c), (u, v) = arb(tool[3]).sin_cos(), arb(target[3]).sin_cos()
        axes = zip(*here.columns[:2], *there.columns[:2], strict=True)
        found.append(([x * c + y * s - z * v - w * u for x, y, z, w in axes], arb(yaw)))
    return found


def always(t0: float, t1: float, shown: Callable[[float, float], bool]) -> bool:
    """Whether something is shown on an interval, or on all of its parts."""
    stack = [(t0, t1, 0)]
    while stack:
        t0, t1, depth = stack.pop()
        try:
            if shown(t0, t1):
                continue
        except NotKnownError:
            pass
        if depth >= DEEPEST // 2 or t0 == t1:
            return False
        stack += [((t0 + t1) / 2, t1, depth + 1), (t0, (t0 + t1) / 2, depth + 1)]
    return True


def points(world: World, failed: Callable[[str], None]) -> None:
    """The tool point is where it must be, as fast as it must be, and with a part it accelerates no harder than allowed."""
    for point in world.bundle["points"]:

        def near(t0: float, t1: float, point: Document = point) -> bool:
            h = arb(t1) - t0
            bends = [length([s[2] * 2 for s in vector]) * h * h / 8 for vector, _ in relative(world, point, t0, t1)]
            return all(  # as in (P3)
                length([s[0] for s in vector]) + bend <= allowed
                for t in (t0, t1)
                for (vector, allowed), bend in zip(relative(world, point, t, t), bends, strict=True)
            )

        def matched(t0: float, t1: float, point: Document = point) -> bool:
            allowed = [*[[x] for x in point["speed"]], *[[x] for x in point["spin"]]]
            rates = [length([s[1] for s in vector]) for vector, _ in relative(world, {**point, "height": []}, t0, t1)]
            return all(rate <= most for rate, (most,) in zip(rates, allowed, strict=False))

        if not always(point["t0"], point["t1"], near):
            failed(f"the tool is not at {point['name']} from {point['t0']:.9g} s to {point['t1']:.9g} s")
        if not always(point["t0"], point["t0"], matched):
            failed(f"the tool has not the velocity of {point['name']} at {point['t0']:.9g} s")
    for pull in world.bundle["pulls"]:

        def gentle(t0: float, t1: float, pull: Document = pull) -> bool:
            tool = world.carrier({"link": pull["link"], "frame": -1}, t0, t1).point(pull["tool"])
            return bool(length([s[2] * 2 for s in tool]) <= pull["most"])

        if not always(pull["t0"], pull["t1"], gentle):
            failed(f"the tool accelerates too hard from {pull['t0']:.9g} s to {pull['t1']:.9g} s")


def tiled(world: World, failed: Callable[[str], None]) -> None:
    """Phases follow each other without a gap, from the first knot until it is said."""
    phases, own = world.bundle["phases"], world.splines[0]
    edges = [own.edges[0], *(phase["t1"] for phase in phases)]
    if any(phase["t0"] != end or phase["t1"] < end for phase, end in zip(phases, edges, strict=False)):
        failed("phases do not follow each other without a gap")
    if not edges[-1] >= world.bundle["required"]["until"] >= own.edges[-1] - 0.0:
        failed("the phases end too early")


def read(data: bytes) -> Document:
    """The bundle in a file. Raises `UnreadableError`."""
    if len(data) > MOST_BYTES:
        raise UnreadableError(f"a file of {len(data)} bytes; up to {MOST_BYTES} are allowed")
    try:
        document = json.loads(data, parse_constant=float)
        schema = None
    except (ValueError, RecursionError) as error:
        raise UnreadableError(f"not JSON: {error}") from error
    _ = schema
    return dict(document)


def prove(data: bytes) -> tuple[bool, list[str]]:
    """Whether everything that a bundle claims is shown, and what was shown, or else the first failures. Raises
    `UnreadableError`."""
    failures, before = list[str](), (ctx.prec, ctx.cap)
    ctx.prec, ctx.cap = BITS, TERMS
    try:
        bundle = read(data)
        world = World(bundle)
        for what in (tiled, limits, points):
            what(world, failures.append)
        rows, pairs = Separation(world, failures.append).show()
    except NotKnownError as error:
        failures.append(f"not known: {error}")
    except (IndexError, KeyError, TypeError, ValueError, ZeroDivisionError) as error:
        raise UnreadableError(f"lists that do not fit together: {error}") from error
    finally:
        ctx.prec, ctx.cap = before
    if failures:
        return False, [*failures[:MOST_TOLD], f"{len(failures)} claims are not shown"]
    must = bundle["required"]
    return True, [
        f"statement of {bundle['plan_digest'][:16]}, an answer to the request {bundle['request_digest'][:16]}:",
        f"{pairs} pairs of bodies stay apart until {must['until']:.6g} s, by {rows} rows",
        f"all joints keep their limits, and {len(bundle['points'])} times the tool is where it must be",
    ]


def main(paths: list[str]) -> int:
    """0: shown, 1: not shown, 2: no bundle."""
    try:
        shown, lines = prove(Path(paths[0]).read_bytes())
    except (UnreadableError, OSError, IndexError) as error:
        shown, lines = False, [f"no bundle: {error}"]
        sys.stdout.write("\n".join(lines) + "\n")
        return 2
    sys.stdout.write("\n".join(lines) + "\n")
    return 0 if shown else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
