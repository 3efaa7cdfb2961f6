"""Shows what a proof bundle claims, with ball arithmetic that is rounded outwards, or says what it cannot show.

It reads one document, whose form and meaning are in bundle.schema.json, and takes every number as the double that it
is. A ball of Arb (`flint.arb`) holds every value that its centre and radius allow, and a comparison of balls is true
only if it is true for all of them. So no rounding is lost and there is no tolerance here: what may be off by how much
is said in the bundle, as a part of the claim. What is not shown is refused, and so is what takes too much work.

Motion. Joints and frames follow polynomials between instants; a carrier (a link of an arm, or a frame) has its place
p(t) and the columns of its rotation R(t) from them. Over an interval every quantity is a series f, f', f''/2, f'''/6 of
balls that hold all its values there (P1); sums, products, sines and roots of series bound the motion of all points.

Apart. A piece is centre + edges [-1, 1] + disc + ball, or the hull of its vertices; its support along m is the largest
m·x of its points (P2). Pieces A and B have the gap -support_A(n) - support_B(-n) along a normal n, in lengths of n; no
distance is smaller. For points x of A and y of B n·(y - x) leaves its chord over an interval h long by M h²/8 at most,
if its second derivative is M at most. So with M for all points

    gap(t) >= min(gap(t0), gap(t1)) - max(M, 0) h²/8                                                        (P3)

A row of the bundle names an interval, two pieces and a normal. It holds if (P3) is no less than what is required over
all of the interval, or over all of its parts. Balls, and discs about the vertical on what turns about the vertical
only, do not change and add nothing to M. Where B is s ahead of the clock, s0 <= s <= s1, the least of four corners
counts, less max(M_B, 0) (s1 - s0)²/8 (P4).
"""

from __future__ import annotations

import json
import math
from bisect import bisect_right
from collections.abc import Callable, Iterable
from functools import cached_property
from itertools import pairwise, product
from pathlib import Path
from typing import Any

from flint import arb, arb_mat, arb_poly, arb_series, ctx
from jsonschema import Draft202012Validator

SCHEMA, BITS, TERMS = Path(__file__).parent / "bundle.schema.json", 160, 4
WORK, DEEPEST, MOST_BYTES, MOST_TOLD = 1_000_000, 40, 32_000_000, 20
"""Carriers in all; how often an interval is halved; the longest file; how many failures are told."""
Document, Vector = dict[str, Any], list[Any]
Test = Callable[[float, float, float, float], str]
SHOWN, WRONG, IN_TIME, AHEAD = "shown", "wrong", "in time", "ahead"
"""What a test says of an interval: it is shown, it is not so, or it is to be halved, in time or in what is ahead."""


class UnreadableError(Exception):
    """The document is no bundle: where, and what is allowed."""


class NotKnownError(Exception):
    """A motion is asked for where it is not given or not known, or there is no work left."""


def nth(items: Any, k: int, what: str) -> Any:
    """Item k of a list. Raises `UnreadableError` where there is none."""
    if not 0 <= k < len(items):
        raise UnreadableError(f"{what} {k} does not exist; there are {len(items)}")
    return items[k]


def dot(a: Vector, b: Vector) -> Any:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def length(vector: Iterable[Any]) -> arb:
    """No vector in a ball of vectors is longer."""
    return sum((x * x for x in vector), arb(0)).max(arb(0)).upper().sqrt().upper()


def largest(balls: Iterable[arb]) -> arb:
    """No value in some balls is larger."""
    found = arb("-inf")
    for ball in balls:
        found = found.max(ball.upper())
    return found


def constant(x: Any) -> arb_series:
    return arb_series([arb(x)], TERMS)


def everywhere(t0: float, t1: float, s0: float, s1: float, test: Test) -> bool:
    """Whether a test is shown on an interval, or on all parts of it."""
    stack = [(t0, t1, s0, s1, 0)]
    while stack:
        t0, t1, s0, s1, depth = stack.pop()
        try:
            said = test(t0, t1, s0, s1)
        except NotKnownError:
            said = IN_TIME  # a loop may be known to be closed on parts of what is too wide
        if said == SHOWN:
            continue
        if said == WRONG or depth >= DEEPEST or (t0 == t1 and s0 == s1):
            return False
        t, s = (t0 + t1) / 2, (s0 + s1) / 2
        halves = [(t0, t1, s0, s), (t0, t1, s, s1)] if said == AHEAD else [(t0, t, s0, s1), (t, t1, s0, s1)]
        stack += [(*half, depth + 1) for half in halves]
    return True


class Curve:
    """Several coordinates: polynomials of the time since the begin of each piece, between `edges`."""

    def __init__(self, edges: list[float], pieces: list[Vector]) -> None:
        self.edges, self.pieces = edges, pieces

    def over(self, low: arb, high: arb) -> Vector:
        """Series of all coordinates over [low, high] (P1), from all pieces that are touched."""
        if not (low >= self.edges[0] and high <= self.edges[-1]):
            raise NotKnownError("a motion is not given")
        found: list[Vector] = []
        for k in range(max(bisect_right(self.edges, float(low)) - 2, 0), len(self.pieces)):
            begin, end = arb(self.edges[k]), arb(self.edges[k + 1])
            if begin > high or (begin >= high and found):
                break
            if end < low or (end <= low and low < high):
                continue
            a, b, here = low.max(begin) - begin, high.min(end) - begin, []
            middle = ((a + b) / 2).mid()
            for path in self.pieces[k]:
                path, powers = path(arb_poly([middle, 1])), []
                for m in range(TERMS):
                    powers.append(path(a.union(b) - middle) / math.factorial(m))
                    path = path.derivative()
                here.append(powers)
            both = zip(found or here, here, strict=True)
            found = [[x.union(y) for x, y in zip(*each, strict=True)] for each in both]
        return [arb_series(each, TERMS) for each in found]


def spline(arm: Document) -> Curve:
    """The quintic between each two knots that has their positions, velocities and accelerations (P5)."""
    pieces, edges = list[Vector](), arm["time"][:1]
    for (t0, *one), (t1, *other) in pairwise(zip(arm["time"], arm["q"], arm["qd"], arm["qdd"], strict=True)):
        h, own = arb(t1) - t0, []
        if h == 0 and one[:2] == other[:2]:
            continue  # the acceleration jumps
        if not h > 0:
            raise UnreadableError("times of knots increase, or position and velocity are the same")
        for state in zip(*one, *other, strict=True):
            x, v, a, y, w, b = map(arb, state)
            d, u = y - x, h * h
            third = (20 * d - (8 * w + 12 * v) * h - (3 * a - b) * u) / (2 * h * u)
            fourth = (-30 * d + (14 * w + 16 * v) * h + (3 * a - 2 * b) * u) / (2 * u * u)
            fifth = (12 * d - 6 * (v + w) * h + (b - a) * u) / (2 * h * u * u)
            own.append(arb_poly([x, v, a / 2, third, fourth, fifth]))
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
        rows = zip(self.place, *self.columns, strict=True)
        return [p + x * local[0] + y * local[1] + z * local[2] for p, x, y, z in rows]

    @cached_property
    def orders(self) -> list[tuple[Vector, list[Vector]]]:
        """Place and columns as balls: values, rates, second derivatives."""
        columns = [[[s[k] * (k or 1) for s in column] for column in self.columns] for k in range(3)]
        return [([s[k] * (k or 1) for s in self.place], columns[k]) for k in range(3)]


def upright(place: Vector, sine: arb_series, cosine: arb_series) -> Carrier:
    none, one = constant(0), constant(1)
    return Carrier(place, [[cosine, sine, none], [-sine, cosine, none], [none, none, one]], True)


def chain(arm: Document, q: Vector) -> list[Carrier]:
    """All links of an arm. The origin of a link is its offset in its parent and what its joint slides along the axis;
    its rotation is Rz(yaw) Ry(-pitch) Rx(roll), each angle a constant and shares of joints, a yaw from a coupler's."""
    found, couplers = list[Carrier](), list[Vector]()

    def turned(angle: Document) -> tuple[arb_series, arb_series]:
        total = constant(angle["constant"])
        for share, value in zip(angle["joints"], q, strict=True):
            total = total + value * arb(share) if share else total
        return total.sin_cos()  # type: ignore[no-any-return]

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
    side. With s from end to end, fold = (s² - a² - b²)/(2 a b) is the cosine of the angle between them, and the margin
    sqrt(1 - fold²) is as large as is claimed (P7)."""
    tips = [[arb(r), arb(0), arb(0)] for r in loop["lengths"]]
    (x, y, _), (u, v, _) = (nth(found, k, "link").point(tip) for k, tip in zip(loop["cranks"], tips, strict=True))
    (a, b), dx, dy = map(arb, loop["couplers"]), u - x, v - y
    square = dx * dx + dy * dy
    fold = (square - (a * a + b * b)) / (2 * a * b)
    margin = 1 - fold * fold
    if not (margin[0] >= arb(loop["least"]) ** 2 and arb(loop["least"]) > 0):
        raise NotKnownError("a loop may come apart")
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

        corners = [[a + b for a, b in zip(at, turned(v), strict=True)] for v in [piece["centre"], *piece["vertices"]]]
        self.centre, self.edges, self.corners = corners[0], [turned(edge) for edge in piece["edges"]], corners[1:]
        self.disc, self.axis, self.ball = arb(piece["disc"]), turned(piece["axis"]), arb(piece["ball"])
        self.hull = arb_mat(len(corners) - 1, 3, [x for corner in corners[1:] for x in corner])
        if not (self.disc >= 0 and self.ball >= 0 and dot(self.axis, self.axis) > 0):
            raise UnreadableError("a disc and a ball are not negative, an axis is not zero")

    @cached_property
    def reach(self) -> arb:
        """How far its points are from the carrier's axis."""
        rims = self.corners or [self.centre]
        for edge in self.edges:
            rims = [[x + sign * y for x, y in zip(rim, edge, strict=True)] for rim in rims for sign in (-1, 1)]
        return largest(length(rim[:2]) for rim in rims) + self.disc + self.ball

    def support(self, place: Vector, columns: list[Vector], m: Vector, size: arb | None, upright: bool) -> arb:
        """The largest m·x (P2). `size`: |m|; None: of derivatives, where what does not change counts nothing."""
        g, (x, y, z) = [dot(column, m) for column in columns], self.axis
        base = largest((self.hull * arb_mat(3, 1, g)).entries()) if self.corners else dot(g, self.centre)
        found = sum((abs(dot(g, edge)) for edge in self.edges), dot(m, place) + base)
        if self.disc > 0 and size is not None:
            across = length([g[1] * z - g[2] * y, g[2] * x - g[0] * z, g[0] * y - g[1] * x])
            found += self.disc * across / length(self.axis).lower()
        elif self.disc > 0 and not (upright and x == 0 and y == 0):
            found += self.disc * length(g)
        return found if size is None else found + self.ball * size


class World:
    """Where every body of a bundle is at every time."""

    def __init__(self, bundle: Document) -> None:
        self.bundle, self.work, self.kept = bundle, WORK, dict[Any, Any]()
        self.splines = [spline(arm) for arm in bundle["arms"]]
        self.laws = [law(frame) if frame["edges"] else None for frame in bundle["frames"]]

    def box(self, body: Document) -> Document:
        """The box in a body's own axes that holds its pieces."""
        solids, centre, edges = [Solid(piece, [0] * 4) for piece in body["pieces"]], list[arb](), list[Vector]()
        unit = [[arb(int(i == k)) for i in range(3)] for k in range(3)]
        for way in unit:
            back = [-x for x in way]
            high, low = (largest(one.support([0] * 3, unit, m, arb(1), False) for one in solids) for m in (way, back))
            centre.append(((high - low) / 2).mid())
            edges.append([x * largest([high - centre[-1], low + centre[-1]]) for x in way])
        return {"centre": centre, "edges": edges, "disc": 0, "axis": [0, 0, 1], "ball": 0, "vertices": []}

    def solid(self, seat: Document, piece: int) -> Solid:
        """A piece of a body where it sits; -1: the box that holds them all."""
        key = (id(seat), piece)
        if key not in self.kept:
            body = nth(self.bundle["bodies"], seat["body"], "body")
            given = self.box(body) if piece < 0 else nth(body["pieces"], piece, "piece")
            self.kept[key] = Solid(given, seat["pose"])
        return self.kept[key]  # type: ignore[no-any-return]

    def stands(self, f: int) -> bool:
        """Whether a frame never moves."""
        frame = nth(self.bundle["frames"], f, "frame")
        return self.laws[f] is None and frame["arm"] < 0 and not frame["waves"]

    def carrier(self, link: int, f: int, t0: float, t1: float, s0: float = 0.0, s1: float = 0.0) -> Carrier:
        """A link of the robot, which follows the clock, or else a frame, which is s ahead of it."""
        ahead = (0.0, 0.0) if link >= 0 else (s0, s1)
        key = (-1 if link >= 0 else f, *((0.0,) * 4 if link < 0 and self.stands(f) else (t0, t1, *ahead)))
        if key not in self.kept:
            self.work -= 1
            if self.work < 0:
                raise NotKnownError("there is no work left")
            low, high = arb(t0) + ahead[0], arb(t1) + ahead[1]
            self.kept[key] = self._links(0, low, high) if link >= 0 else self._frame(f, low, high)
        return nth(self.kept[key], link, "link") if link >= 0 else self.kept[key]  # type: ignore[no-any-return]

    def _links(self, arm: int, low: arb, high: arb) -> list[Carrier]:
        return chain(nth(self.bundle["arms"], arm, "arm"), self.splines[arm].over(low, high))

    def _frame(self, f: int, low: arb, high: arb) -> Carrier:
        frame, own = self.bundle["frames"][f], self.laws[f]
        if frame["arm"] >= 0:
            return nth(self._links(frame["arm"], low, high), frame["link"], "link")  # type: ignore[no-any-return]
        now = [constant(x) for x in frame["pose"]] if own is None else own.over(low, high)
        for wave in frame["waves"]:
            angle = arb_series([low.union(high), 1], TERMS) * arb(wave["rate"]) + arb(wave["phase"])
            now[wave["coordinate"]] = now[wave["coordinate"]] + angle.sin() * arb(wave["amplitude"])
        return upright(now[:3], *now[3].sin_cos())


class Duty:
    """Bodies a and b of a phase must stay `least` apart (less than 0: may touch as deep), before what is not known of
    them; a is looked at by the clock, b from `early` to `late` ahead of it."""

    def __init__(self, a: int, b: int, least: float, early: float, late: float) -> None:
        self.a, self.b, self.least, self.early, self.late, self.rows = a, b, least, early, late, list[int]()


class Separation:
    """Which bodies must stay apart in each phase, and whether the rows of the bundle show it."""

    def __init__(self, world: World) -> None:
        self.world, self.failures, bundle = world, list[str](), world.bundle
        self.frames, self.bodies, self.rows, self.must = (bundle[x] for x in ("frames", "bodies", "rows", "required"))
        self.phases, self.names = bundle["phases"], [body["name"] for body in bundle["bodies"]]
        self.seats = [[nth(bundle["seats"], k, "seat") for k in phase["seats"]] for phase in self.phases]
        if any([seat["body"] for seat in seats] != list(range(len(self.bodies))) for seats in self.seats):
            raise UnreadableError("a phase has a seat of each body, in their order")

    def ahead(self, f: int, late: float) -> tuple[float, float]:
        """Between which times a frame may be ahead of a robot that starts up to `late` late."""
        least, most = self.frames[f]["shift"]
        return (0.0, 0.0) if self.world.stands(f) else (-most, late - least)

    def duties(self, p: int) -> dict[frozenset[int], Duty]:
        """The robot's bodies and all others; those on links that are asked to stay apart; parts that were put down and
        what is on another frame, if one of both moves and they were not put on it."""
        phase, at, found, stands = self.phases[p], self.seats[p], dict[frozenset[int], Duty](), self.world.stands
        touching = {frozenset(each["bodies"]): each["depth"] for each in phase["contacts"]}
        asked = [frozenset(pair) for pair in self.must["self_pairs"]]

        def add(a: int, b: int, kind: str, early: float = 0.0, late: float = 0.0) -> None:
            least, key = self.must[kind], frozenset((a, b))
            for rule in self.must["exceptions"]:
                if any(x in (rule["first"] or [x]) and y in (rule["second"] or [y]) for x, y in ((a, b), (b, a))):
                    least = rule[kind]
            found.setdefault(key, Duty(a, b, -touching[key] if key in touching else least, early, late))

        for a, b in product(range(len(at)), repeat=2) if phase["robot"] else ():
            one, other, kind = at[a]["link"], at[b]["link"], "near" if phase["near"] else "travel"
            if one >= 0 > other:
                add(a, b, kind, *self.ahead(at[b]["frame"], self.must["late"]))
            elif one >= 0 and a < b and one != other and frozenset((one, other)) in asked:
                add(a, b, kind)
        for part in phase["put_down"]:
            here = nth(at, part["body"], "body")["frame"]
            for b, there in enumerate(seat["frame"] for seat in at):
                if there in (-1, here) or b in part["supports"] or (stands(here) and stands(there)):
                    continue
                (low, high), (first, last) = self.ahead(there, 0.0), self.ahead(here, 0.0)
                add(part["body"], b, "near", *((0.0, 0.0) if stands(there) else (low - last, high - first)))
        return found

    def show(self) -> tuple[int, int]:
        """Shows all rows, and that they cover every pair for the whole of every phase; how many rows and pairs."""
        rows, many, begins = self.rows, 0, [phase["t0"] for phase in self.phases]
        duties, outside = [self.duties(p) for p in range(len(begins))], [set[frozenset[int]]() for _ in begins]
        for r, (t0, t1) in enumerate(zip(rows["t0"], rows["t1"], strict=True)):
            pair, p = (rows["first"][r], rows["second"][r]), bisect_right(begins, t0) - 1
            one, other = (nth(self.names, k, "body") for k in pair)
            duty = duties[p].get(frozenset(pair)) if p >= 0 and t0 <= t1 <= self.phases[p]["t1"] else None
            if duty is None or ((duty.early, duty.late) != (0.0, 0.0) and duty.a != pair[0]):
                continue  # nobody asks for it, or it is not within one phase
            if not self.holds(p, r, duty):
                self.failures.append(f"row {r}: {one} and {other} from {t0:.9g} s to {t1:.9g} s")
                continue
            duty.rows.append(r)
            many += 1
            boxes = [k < 0 or len(self.bodies[body]["pieces"]) == 1 for body, k in self.pieces(r).items()]
            outside[p] |= {frozenset(pair)} if duty.least >= 0 and all(boxes) else set()
        for p, phase in enumerate(self.phases):
            for key, duty in duties[p].items() if phase["t1"] > phase["t0"] else ():
                where = f"{self.names[duty.a]} and {self.names[duty.b]} in {phase['kind']} from {phase['t0']:.9g} s"
                if not self.covered(p, duty):
                    self.failures.append(f"{where}: no row for a part of it")
                if duty.least >= 0 and any(self.bodies[k]["hollow"] for k in key):
                    # as long as a pair stays apart, one is within what is hollow all the time, or never
                    ends = [k for k, each in enumerate(duties) if not (key in each and each[key].least >= 0)]
                    first, last = (
                        max((k + 1 for k in ends if k < p), default=0),
                        min((k for k in ends if k > p), default=None),
                    )
                    if not any(key in each for each in outside[first:last]):
                        self.failures.append(f"{where}: nothing shows that one is not within the other")
        return many, sum(map(len, duties))

    def pieces(self, r: int) -> dict[int, int]:
        rows = self.rows
        return {rows["first"][r]: rows["first_piece"][r], rows["second"][r]: rows["second_piece"][r]}

    def holds(self, p: int, r: int, duty: Duty) -> bool:
        """Whether a row holds on its interval, or on all parts of it (P3, P4)."""
        world, n, rows = self.world, [arb(x) for x in self.rows["normal"][r]], self.rows
        (one, a), (other, b) = ((self.seats[p][k], world.solid(self.seats[p][k], j)) for k, j in self.pieces(r).items())
        size, back = length(n), [-x for x in n]

        def test(t0: float, t1: float, s0: float, s1: float) -> str:
            far = []
            for t, s in product((t0, t1), {s0, s1}):
                on, beside = self.under(one, t, t, 0.0, 0.0), self.under(other, t, t, s, s)
                reach = a.support(*on.orders[0], n, size, on.upright)
                far.append(reach + b.support(*beside.orders[0], back, size, beside.upright))
            need = self.need(p, duty, n, size, t0, t1, ((one, a), (other, b)))
            if any(-x < need for x in far):
                return WRONG
            on, beside = self.under(one, t0, t1, 0.0, 0.0), self.under(other, t0, t1, s0, s1)
            bend_s = b.support(*beside.orders[2], n, None, beside.upright)
            bend_t = bend_s + a.support(*on.orders[2], back, None, on.upright)
            less_t = largest([bend_t, arb(0)]) * (arb(t1) - t0) ** 2 / 8
            less_s = largest([bend_s, arb(0)]) * (arb(s1) - s0) ** 2 / 8
            if -largest(far) - less_t - less_s - need >= 0:
                return SHOWN
            return AHEAD if s1 > s0 and (t0 == t1 or not less_t >= less_s) else IN_TIME

        return everywhere(rows["t0"][r], rows["t1"][r], rows["s0"][r], rows["s1"][r], test)

    def under(self, seat: Document, t0: float, t1: float, s0: float, s1: float) -> Carrier:
        return self.world.carrier(seat["link"], seat["frame"], t0, t1, s0, s1)

    def need(self, p: int, duty: Duty, n: Vector, size: arb, t0: float, t1: float, sides: Any) -> arb:
        """The gap that is required along a normal, and how much nearer what is not known may bring both bodies (P8)."""
        found, flat, phase, must = duty.least * size, length(n[:2]), self.phases[p], self.must
        lasts = (arb(t1) + must["late"] - must["since"]).max(arb(0))
        tools = [seat["link"] >= must["tool_from"] for seat, _ in sides]
        for f, frame in enumerate(self.frames):
            here = [seat["frame"] == f for seat, _ in sides]
            for each in frame["unknown"] if not all(tools) else ():
                given = phase["shares"][f] if each["shared"] else (0.0, 0.0)
                (a, b), (c, d) = (
                    (1.0, 1.0) if x else given if y else (0.0, 0.0) for x, y in zip(here, tools, strict=True)
                )
                along = abs(dot(n, each["direction"])) if each["direction"] else flat
                found += max(abs(d - a), abs(b - c)) * (each["amount"] + each["growth"] * lasts) * along
            for on, (_, solid) in zip(here, sides, strict=True) if frame["yaw"] else ():
                found += frame["yaw"] * solid.reach * flat if on else 0
        for seat, solid in sides:
            across, upwards = phase["unknown"][seat["body"]]
            found += across * flat + upwards * abs(n[2])
            if seat["link"] >= 0 and any(must["lag"]):
                now, lags = self.world.splines[0].over(arb(t0), arb(t1)), [arb(0, x) for x in must["lag"]]
                moved = [arb_series([x[0] + lag, lag], TERMS) for x, lag in zip(now, lags, strict=True)]
                carrier = nth(chain(self.world.bundle["arms"][0], moved), seat["link"], "link")
                found += solid.support(*carrier.orders[1], n, None, carrier.upright)
        return found

    def covered(self, p: int, duty: Duty) -> bool:
        """Whether rows of all pieces of a pair follow each other over a whole phase, for all shifts of its window."""
        rows, t0, t1 = self.rows, self.phases[p]["t0"], self.phases[p]["t1"]
        own = sorted(duty.rows, key=rows["t0"].__getitem__)
        at = {r: [self.pieces(r)[body] for body in (duty.a, duty.b)] for r in own}
        many = [range(len(self.bodies[body]["pieces"])) for body in (duty.a, duty.b)]
        edges = {x for r in own for x in (rows["s0"][r], rows["s1"][r]) if duty.early < x < duty.late}
        for low, high in pairwise([duty.early, *sorted(edges), duty.late]):
            there = [r for r in own if rows["s0"][r] <= low and high <= rows["s1"][r]]
            for pair in product(*many) if any(at[r] != [-1, -1] for r in there) else [(-1, -1)]:
                reached = t0
                for r in there:
                    if rows["t0"][r] <= reached and all(k in (-1, j) for k, j in zip(at[r], pair, strict=True)):
                        reached = max(reached, rows["t1"][r])
                if reached < t1:
                    return False
        return True


def limits(world: World) -> list[str]:
    """Each joint keeps its limits on every piece of the spline that reaches into the time for which they count."""
    own, failures, covered = world.splines[0], list[str](), False
    for span in world.bundle["limits"]:
        lower, upper = ([arb(x) for x in span[key]] for key in ("lower", "upper"))
        rates = [span[key] for key in ("velocity", "acceleration", "jerk") if span[key]]
        covered = covered or (span["t0"] <= own.edges[0] and own.edges[-1] <= span["t1"])

        def test(
            t0: float,
            t1: float,
            *_: float,
            span: Document = span,
            rates: Vector = rates,
            lower: Vector = lower,
            upper: Vector = upper,
        ) -> str:
            for q, low, high, *most in zip(own.over(arb(t0), arb(t1)), lower, upper, *rates, strict=True):
                slack = (high - low) / 2 * span["shares"][0]
                kept = [q[0] - high <= slack, low - q[0] <= slack]
                for k, (x, share) in enumerate(zip(most, span["shares"][1:], strict=False), start=1):
                    kept.append(abs(q[k]) * math.factorial(k) <= arb(x) * (1 + arb(share)))
                if not all(kept):
                    return IN_TIME
            return SHOWN

        for t0, t1 in pairwise(own.edges):
            if t1 > span["t0"] and t0 < span["t1"] and not everywhere(t0, t1, 0.0, 0.0, test):
                failures.append(f"a joint does not keep its limits from {t0:.9g} s to {t1:.9g} s")
    return failures if covered else [*failures, "no limits count for all of the motion"]


def points(world: World) -> list[str]:
    """The tool point is where it must be, as fast as it must be, and with a part it accelerates no harder than allowed."""
    failures = []
    for point in world.bundle["points"]:

        def test(t0: float, t1: float, *_: float, point: Document = point) -> str:
            limits, h = [*point["height"], point["position"], *point["yaw"]], arb(t1) - t0
            bends = [length(s[2] * 2 for s in vector) * h * h / 8 for vector in relative(world, point, t0, t1)]
            for t in (t0, t1):
                for vector, most, bend in zip(relative(world, point, t, t), limits, bends, strict=True):
                    if not length(s[0] for s in vector) + bend <= most:  # as in (P3)
                        return IN_TIME
            fast = zip(relative(world, point, t0, t0), point["rates"], strict=False)
            return SHOWN if all(length(s[1] for s in vector) <= most for vector, most in fast) else WRONG

        if not everywhere(point["t0"], point["t1"], 0.0, 0.0, test):
            failures.append(f"the tool is not at {point['name']} from {point['t0']:.9g} s to {point['t1']:.9g} s")
    for pull in world.bundle["pulls"]:

        def gentle(t0: float, t1: float, *_: float, pull: Document = pull) -> str:
            tool = world.carrier(pull["link"], -1, t0, t1).point(pull["tool"])
            return SHOWN if length(s[2] * 2 for s in tool) <= arb(pull["most"]) * (1 + arb(pull["share"])) else IN_TIME

        if not everywhere(pull["t0"], pull["t1"], 0.0, 0.0, gentle):
            failures.append(f"the tool may accelerate too hard from {pull['t0']:.9g} s to {pull['t1']:.9g} s")
    return failures


def relative(world: World, point: Document, t0: float, t1: float) -> list[Vector]:
    """Of a tool point against its control point: how far it is from the middle of the heights that it may have, if it
    may have any, how far it is beside it, or away from it, and, of arms with a yaw, the difference of directions."""
    (*tool, turn), (*target, yaw), found = point["tool"], point["target"], list[Vector]()
    here, there = world.carrier(point["link"], -1, t0, t1), world.carrier(-1, point["frame"], t0, t1)
    away = [x - y for x, y in zip(here.point(tool), there.point(target), strict=True)]
    if point["height"]:
        found.append([away.pop() - arb(point["middle"])])
    (s, c), (u, v) = arb(turn).sin_cos(), arb(yaw).sin_cos()
    axes = zip(*here.columns[:2], *there.columns[:2], strict=True)
    turned = [x * c + y * s - z * v - w * u for x, y, z, w in axes]
    return [*found, away, turned][: len(found) + 1 + len(point["yaw"])]


def read(data: bytes) -> Document:
    """The bundle in a file. Raises `UnreadableError`."""
    if len(data) > MOST_BYTES:
        raise UnreadableError(f"{len(data)} bytes; up to {MOST_BYTES} are allowed")
    try:
        document = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise UnreadableError(f"not JSON: {error}") from error
    error = next(Draft202012Validator(json.loads(SCHEMA.read_bytes())).iter_errors(document), None)
    if error is not None:
        raise UnreadableError(f"{error.json_path}: {error.message:.200}")
    return dict(document)


def prove(data: bytes) -> tuple[bool, list[str]]:
    """Whether everything that a bundle claims is shown, and what was shown, or else the first failures.

    Raises `UnreadableError`."""
    before = ctx.prec, ctx.cap
    ctx.prec, ctx.cap = BITS, TERMS
    try:
        bundle = read(data)
        world, must, failures = World(bundle), bundle["required"], list[str]()
        edges = [world.splines[0].edges[0], *(phase["t1"] for phase in bundle["phases"])]
        if any(not phase["t0"] == t <= phase["t1"] for phase, t in zip(bundle["phases"], edges, strict=False)):
            failures.append("phases do not follow each other without a gap")
        if not edges[-1] >= must["until"]:
            failures.append("the phases end too early")
        separation = Separation(world)
        rows, pairs = separation.show()
        failures += limits(world) + points(world) + separation.failures
    except (IndexError, TypeError, ValueError, RecursionError) as error:
        raise UnreadableError(f"lists that do not fit together: {error}") from error
    finally:
        ctx.prec, ctx.cap = before
    if failures:
        return False, [*failures[:MOST_TOLD], f"{len(failures)} claims are not shown"]
    return True, [
        f"Shown of the plan {bundle['plan_digest'][:16]} for the request {bundle['request_digest'][:16]}:",
        f"{pairs} pairs of bodies stay apart, in {len(edges) - 1} phases until {must['until']:.6g} s, by {rows} rows",
        f"the joints keep their limits; {len(bundle['points'])} times the tool is where it must be",
    ]
