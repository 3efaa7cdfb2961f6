"""Proves the claims of a proof bundle, or lists those that it cannot prove, with ball arithmetic rounded outwards.

It reads one document. bundle.schema.json defines its form and its terms. Every number is taken as the double that it
is. A ball of Arb (`flint.arb`) holds every value that its centre and radius allow. A comparison is true only if it is
true for all these values. So no rounding is lost, and there is no tolerance here: the bundle states all tolerances as a
part of the claim. A claim that is not proved, or takes too much work, is refused. The labels (N1) to (N15) are those of
the equations in docs/bundle.md.

Motion. Over an interval every quantity f is a series of balls. They hold all values of f, of its rate and of the next
two derivatives (N1). A carrier (a link or a frame) has the series of its place p and of the columns of its rotation R.

Apart. The support of a piece along m is the largest m·x of its points (N2). Along a normal n two pieces have the gap
-support_A(n) - support_B(-n), in lengths of n. Their distance is no smaller. For points x of A and y of B, the function
n·(y - x) leaves its chord over an interval h long by M h²/8 at most, if its second derivative is M at most. So, with an
M that holds for all points,

    gap(t) >= min(gap(t0), gap(t1)) - max(M, 0) h²/8                                                        (N3)

If B is s ahead of the clock, s0 <= s <= s1, the least of four corners counts, and max(M_B, 0) (s1 - s0)²/8 is
subtracted as well (N4).

Within. The pieces of a mesh hold its surface and do not fill it. As long as two bodies stay apart, no piece of one
crosses the surface of the other. So it is enough if the surface goes round a point of each piece 0 times once (N11).
"""

from __future__ import annotations

import json
import math
from bisect import bisect_right
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from fractions import Fraction
from functools import cached_property, partial, reduce
from itertools import combinations, pairwise, permutations, product
from pathlib import Path
from typing import Any, NamedTuple

from flint import arb, arb_mat, arb_poly, arb_series, ctx, fmpq
from jsonschema_rs import validator_for

SCHEMA, BITS, TERMS = Path(__file__).parent / "bundle.schema.json", 160, 4
WORK, DEEPEST, MOST_BYTES, MOST_FAILURES = 5_000_000, 40, 32_000_000, 20
CLOSED, MOST_SIGNS = 1e-9, 10
"""At most: work (intervals, pairs, pieces of motions, and tens of triangles about a point), halvings of an interval,
bytes of a file, failures listed. CLOSED: what rounding may leave of a period, of weights, and where a point is chosen.
MOST_SIGNS: vectors whose signs are combined; shorter ones count in every direction."""
SHOWN, WRONG, IN_TIME, AHEAD = range(4)
"""Results of a test on an interval: proved; wrong; halve it in time; halve the time ahead."""
Document = dict[str, Any]
Vector = list[Any]


def nth(items: Any, k: int, what: str) -> Any:
    """Item k of a list. Raises `ValueError` if there is none: then this is no bundle."""
    if not 0 <= k < len(items):
        raise ValueError(f"{what} {k} does not exist; there are {len(items)}")
    return items[k]


def dot(a: Sequence[Any], b: Sequence[Any]) -> Any:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def length(vector: Iterable[Any]) -> arb:
    """An upper bound of the length of a vector of balls."""
    return sum((x * x for x in vector), arb(0)).upper().sqrt().upper()


def largest(balls: Iterable[arb]) -> arb:
    """An upper bound of all values in some balls."""
    return reduce(arb.max, (ball.upper() for ball in balls), arb("-inf"))


def constant(x: Any) -> arb_series:
    return arb_series([arb(x)], TERMS)


def united(found: list[Vector], here: list[Vector]) -> list[Vector]:
    """The smallest balls that hold those of two lists; `found` may be empty."""
    return [[x.union(y) for x, y in zip(*both, strict=True)] for both in zip(found or here, here, strict=True)]


class Curve:
    """Several coordinates: on each piece, between two `edges`, polynomials of the time since it began. With a `period`
    the pieces last one, and after it each coordinate is further by its `step`."""

    def __init__(self, edges: Vector, pieces: list[Vector], period: float = 0.0, step: Iterable[float] = ()) -> None:
        self.edges, self.pieces, self.period, self.step, self.touched = edges, pieces, period, list(step), 0

    def over(self, low: arb, high: arb) -> Vector:
        """Series of all coordinates over [low, high] (N1): of a motion that repeats, from all its periods (N13)."""
        if not self.period:
            return [arb_series(each, TERMS) for each in self.once(low, high)]
        first, last = (int(((t - self.edges[0]) / self.period).floor().unique_fmpz()) for t in (low, high))
        if first < 0 or last > first + 2:
            raise ArithmeticError("a motion is not given, or repeats more than twice")
        found: list[Vector] = []
        for k in range(first, last + 1):
            begin = arb(self.period) * k
            here = self.once((low - begin).max(arb(self.edges[0])), (high - begin).min(arb(self.edges[-1])))
            gone = ([x[0] + arb(step) * k, *x[1:]] for x, step in zip(here, self.step, strict=True))
            found = united(found, list(gone))
        return [arb_series(each, TERMS) for each in found]

    def once(self, low: arb, high: arb) -> list[Vector]:
        """Their powers over [low, high], from all pieces that the interval reaches. An instant is in the piece that
        begins there, and in the last one."""
        if not (low >= self.edges[0] and high <= self.edges[-1]):
            raise ArithmeticError("a motion is not given")
        found: list[Vector] = []
        for k in range(max(bisect_right(self.edges, float(low)) - 2, 0), len(self.pieces)):
            begin, end = arb(self.edges[k]), arb(self.edges[k + 1])
            if begin > high or (begin >= high and found):
                break
            if end < low or (end <= low and (low < high or k + 1 < len(self.pieces))):
                continue
            self.touched += 1
            a, b, here = low.max(begin) - begin, high.min(end) - begin, []
            middle = ((a + b) / 2).mid()
            for path in self.pieces[k]:
                path, powers = path(arb_poly([middle, 1])), []
                for m in range(TERMS):
                    powers.append(path(a.union(b) - middle) / math.factorial(m))
                    path = path.derivative()
                here.append(powers)
            found = united(found, here)
        return found


def spline(arm: Document) -> Curve:
    """The quintic between each two knots that has their positions, velocities and accelerations (N5)."""
    pieces, edges = list[Vector](), arm["time"][:1]
    for (t0, *one), (t1, *other) in pairwise(zip(arm["time"], arm["q"], arm["qd"], arm["qdd"], strict=True)):
        h, own = arb(t1) - t0, []
        if h == 0 and one[:2] == other[:2]:
            continue  # the acceleration jumps
        if not h > 0:
            raise ValueError("times of knots increase, or position and velocity are the same")
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
    """The motion of a frame: its acceleration is integrated twice, from pose and rate at the first edge (N6). If it
    repeats, what is missing as a period ends is added as a cubic polynomial, so that neither pose nor rate jumps (N13).
    Raises `ValueError` if that is more than rounding."""
    start = [(arb(x), arb(v)) for x, v in zip(frame["pose"], frame["rate"], strict=True)]
    pieces, state, edges, period = [], start, list(frame["edges"]), arb(frame["period"])
    if period > 0:
        if not (edges and edges[-1] >= edges[0] + frame["period"]):  # as doubles, in which a writer has the sum
            raise ValueError("the pieces of a frame that repeats last one period")
        edges[-1] = edges[0] + period
    for (t0, t1), accelerations in zip(pairwise(edges), frame["acceleration"], strict=True):
        h, own = arb(t1) - t0, []
        if not h > 0:
            raise ValueError("edges of a frame's motion increase")
        for (x, v), powers in zip(state, accelerations, strict=True):
            own.append(arb_poly([x, v, *(arb(a) / ((m + 1) * (m + 2)) for m, a in enumerate(powers))]))
        state = [(path(h), path.derivative()(h)) for path in own]
        pieces.append(own)
    for k, ((x0, v0), (x, v), step) in enumerate(zip(start, state, frame["step"], strict=True)) if period > 0 else ():
        missing, rate = x0 + step - x, v0 - v
        if not (abs(missing) <= CLOSED and abs(rate) <= CLOSED):
            raise ValueError("a frame that repeats ends a period where the next one begins")
        cubic = arb_poly([0, 0, (3 * missing / period - rate) / period, (rate - 2 * missing / period) / period**2])
        for t0, own in zip(edges, pieces, strict=False):
            own[k] = own[k] + cubic(arb_poly([arb(t0) - edges[0], 1]))
    return Curve(edges, pieces, frame["period"], frame["step"])


class Carrier:
    """A place (3 series), the columns of a rotation (3 of 3 series), and whether it turns about the vertical only."""

    def __init__(self, place: Vector, columns: list[Vector], upright: bool) -> None:
        self.place, self.columns, self.upright = place, columns, upright

    def point(self, local: Vector) -> Vector:
        """The series of a point, from its coordinates in the carrier, which may change."""
        return [p + x for p, x in zip(self.place, self.direction(local), strict=True)]

    def direction(self, local: Vector) -> Vector:
        """The series of a vector, from its coordinates in the carrier."""
        return [x * local[0] + y * local[1] + z * local[2] for x, y, z in zip(*self.columns, strict=True)]

    @cached_property
    def orders(self) -> list[tuple[Vector, list[Vector]]]:
        """Place and columns as balls: their values, their rates, their second derivatives."""
        columns = [[[s[k] * (k or 1) for s in column] for column in self.columns] for k in range(3)]
        return [([s[k] * (k or 1) for s in self.place], columns[k]) for k in range(3)]


def upright(place: Vector, sine: arb_series, cosine: arb_series) -> Carrier:
    none, one = constant(0), constant(1)
    return Carrier(place, [[cosine, sine, none], [-sine, cosine, none], [none, none, one]], True)


def chain(arm: Document, q: Vector) -> list[Carrier]:
    """All links of an arm. The origin of a link is at its offset in its parent, and further along an axis if a joint
    slides it. Its rotation is Rz(yaw) Ry(-pitch) Rx(roll). Each angle is a constant and a sum of shares of joint
    values. If a link is on a coupler, the coupler's yaw is added."""
    found, couplers = list[Carrier](), list[Vector]()

    def turned(angle: Document) -> tuple[arb_series, arb_series]:
        total = constant(angle["constant"])
        for share, value in zip(angle["joints"], q, strict=True):
            total = total + value * arb(share) if share else total
        return total.sin_cos()

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
    """Cosine and sine of the yaws of both couplers of a loop (N7). They go from the ends of two cranks to where they
    meet, on the given side. With s from end to end, fold = (s² - a² - b²)/(2 a b) is the cosine of the angle between
    them. The sine of that angle, sqrt(1 - fold²), must be as large as is claimed."""
    tips = [[arb(r), arb(0), arb(0)] for r in loop["lengths"]]
    (x, y, _), (u, v, _) = (nth(found, k, "link").point(tip) for k, tip in zip(loop["cranks"], tips, strict=True))
    (a, b), dx, dy = map(arb, loop["couplers"]), u - x, v - y
    square = dx * dx + dy * dy
    fold = (square - (a * a + b * b)) / (2 * a * b)
    margin = 1 - fold * fold
    if not (margin[0] >= arb(loop["least"]) ** 2 and arb(loop["least"]) > 0):
        raise ArithmeticError("a loop may come apart")
    along, across = (square + (a * a - b * b)) / (square * 2), margin.sqrt() / square * (arb(loop["side"]) * a * b)
    ex, ey = along * dx - across * dy, along * dy + across * dx
    return [[ex / a, ey / a], [(ex - dx) / b, (ey - dy) / b]]


class Solid:
    """A piece at a pose in its carrier: centre (or hull of vertices) + s_i edge_i, s_i from -1 to 1, + disc + ball."""

    def __init__(self, piece: Document, pose: Vector) -> None:
        at, (s, c) = [arb(x) for x in pose[:3]], arb(pose[3]).sin_cos()
        turned = [[c * x - s * y, s * x + c * y, arb(z)] for x, y, z in piece["edges"] + [piece["axis"]]]
        points = [[c * x - s * y, s * x + c * y, arb(z)] for x, y, z in piece["vertices"] or [piece["centre"]]]
        self.points = [[a + b for a, b in zip(at, point, strict=True)] for point in points]
        self.hull = arb_mat(len(points), 3, [x for point in self.points for x in point])
        self.edges, self.axis = turned[:-1], turned[-1]
        self.disc, self.ball, self.size = arb(piece["disc"]), arb(piece["ball"]), dot(self.axis, self.axis).sqrt()

    @cached_property
    def reach(self) -> arb:
        """An upper bound of the distance of its points from the carrier's vertical axis."""
        rims = self.points
        for edge in self.edges:
            rims = [[x + sign * y for x, y in zip(rim, edge, strict=True)] for rim in rims for sign in (-1, 1)]
        return largest(length(rim[:2]) for rim in rims) + self.disc + self.ball

    def farthest(self, g: Vector) -> Vector:
        """A point that is farthest along a unit vector g of the carrier. Any point would do: what is across g within
        CLOSED counts with its middle, and of vertices the first that no other exceeds by that."""
        heights = [float(dot(point, g).mid()) for point in self.points]
        found = self.points[next((k for k, x in enumerate(heights) if x >= max(heights) - CLOSED), 0)]
        for edge in self.edges:
            along = float(dot(edge, g).mid())
            sign = 0 if abs(along) <= CLOSED else 1 if along > 0 else -1
            found = [x + sign * y for x, y in zip(found, edge, strict=True)]
        back = dot(g, self.axis) / dot(self.axis, self.axis)
        across = [x - back * y for x, y in zip(g, self.axis, strict=True)]
        sine = dot(across, across).sqrt()
        disc = self.disc / sine if float(sine.mid()) > CLOSED else arb(0)
        return [x + disc * y + self.ball * z for x, y, z in zip(found, across, g, strict=True)]

    def support(self, place: Vector, columns: list[Vector], m: Vector, size: arb | None, upright: bool) -> arb:
        """The largest m·x (N2). `size` is |m|. None: `place` and `columns` are derivatives. What does not change then
        adds nothing: balls, and discs about the vertical on what turns about the vertical only."""
        g, (x, y, z) = [dot(column, m) for column in columns], self.axis
        found = dot(m, place) + largest((self.hull * arb_mat(3, 1, g)).entries())
        found += sum(abs(dot(g, edge)) for edge in self.edges)
        if self.disc > 0 and size is not None:
            across = length([g[1] * z - g[2] * y, g[2] * x - g[0] * z, g[0] * y - g[1] * x])
            found += self.disc * across / self.size
        elif self.disc > 0 and not (upright and x == 0 and y == 0):
            found += self.disc * length(g)
        return arb(found if size is None else found + self.ball * size)


def box(pieces: list[Document]) -> Document:
    """The box in a body's own axes that holds its pieces."""
    solids, centre, edges = [Solid(piece, [0] * 4) for piece in pieces], list[arb](), list[Vector]()
    unit = [[arb(int(i == k)) for i in range(3)] for k in range(3)]
    for way in unit:
        back = [-x for x in way]
        high, low = (largest(one.support([0] * 3, unit, m, arb(1), False) for one in solids) for m in (way, back))
        centre.append(((high - low) / 2).mid())
        edges.append([x * largest([high - centre[-1], low + centre[-1]]) for x in way])
    return {"centre": centre, "edges": edges, "disc": 0, "axis": [0, 0, 1], "ball": 0, "vertices": []}


def surface(body: Document) -> Document:
    """The triangles of all pieces of a body as those of one piece; none: its pieces fill it. Raises `ValueError` for a
    surface that is not closed: an edge is not run through as often one way as the other."""
    numbers, triangles, runs = dict[tuple[float, ...], int](), list[list[int]](), Counter[tuple[int, int]]()
    for vertices, corners in ((piece["vertices"], each) for piece in body["pieces"] for each in piece["triangles"]):
        places = [tuple(nth(vertices, k, "vertex")) for k in corners]
        triangles.append([numbers.setdefault(place, len(numbers)) for place in places])
        runs.update(pairwise([*triangles[-1], triangles[-1][0]]))
    for (a, b), many in runs.items():
        if a != b and runs[b, a] != many:
            raise ValueError(f"{body['name']:.80}: its surface is open at an edge that begins at {list(numbers)[a]}")
    return {**body["pieces"][0], "vertices": list(numbers), "triangles": triangles}


def rounds(points: list[Vector], triangles: list[list[int]], place: Vector) -> arb:
    """How often a closed surface goes round a point, by the solid angles of its triangles (N11)."""
    far, total = [[x - y for x, y in zip(point, place, strict=True)] for point in points], arb(0)
    if any(all(x[k] * way > 0 for x in far) for k, way in product(range(3), (1, -1))):
        return total  # all of the surface is on one side of the point
    sizes = [dot(x, x).sqrt() for x in far]
    for i, j, k in triangles:
        a, b, c = far[i], far[j], far[k]
        rest = sizes[i] * dot(b, c) + sizes[j] * dot(c, a) + sizes[k] * dot(a, b) + sizes[i] * sizes[j] * sizes[k]
        total += arb.atan2(arb_mat([a, b, c]).det(), rest)
    return total / (2 * arb.pi())


def farthest(away: Vector, straight: list[Vector], flat: arb, upright: arb) -> tuple[arb, arb, arb]:
    """Upper bounds of the length of a vector, of its horizontal part and of its height, if all vectors of `straight`
    are added with one sign or the other, and then what may be in any direction (N15)."""
    sums, found = [away], [arb(0)] * 3
    for k, way in enumerate(sorted(straight, key=lambda way: -float(length(way)))):
        if k >= MOST_SIGNS or (way[0] == 0 and way[1] == 0):
            flat, upright = flat + length(way[:2]), upright + abs(way[2])
        else:
            sums = [[x + sign * y for x, y in zip(each, way, strict=True)] for each in sums for sign in (1, -1)]
    for each in sums:
        side, height = length(each[:2]) + flat, abs(each[2]) + upright
        found = [largest(both) for both in zip(found, (length([side, height]), side, height), strict=True)]
    return found[0], found[1], found[2]


def swung(arm: Document, tool_from: int, elbow: arb, shift: arb) -> tuple[arb, arb, arb]:
    """Of the two links that carry the tool of a SCARA: the length of the first, and the greatest angles by which both
    turn if the tool is shifted (N10). The value of the elbow joint is a ball. Each angle is shift / (length sin elbow),
    with the least sine at all radii to which the shift may lead. It is at the smallest or the largest of them."""
    first, second, tool = (nth(arm["links"], k, "link") for k in (1, 2, tool_from))
    parents = [link["parent"] for link in (first, second, tool)]
    yaws = [sum(abs(a - b) for a, b in zip(link["yaw"]["joints"], yaw, strict=False)) for link, yaw in (
        (first, (1, 0, 0, 0)), (second, (1, 1, 0, 0)))]  # fmt: skip
    plain = all(link["pitch"] is None and link["coupler"] < 0 for link in (first, second))
    plain = plain and not any(link["slide"] and any(link["slide"]["axis"][:2]) for link in (second, tool))
    elbow = elbow + (arb(second["yaw"]["constant"]) - first["yaw"]["constant"])
    a, b, aside = second["offset"][0], tool["offset"][0], any(link["offset"][1] for link in (second, tool))
    if parents != [0, 1, 2] or any(yaws) or not plain or aside or not (a > 0 and b > 0) or len(arm["q"][0]) != 4:
        raise ValueError("only the tool of a SCARA with four axes has a share in a displacement")
    square = arb(a) ** 2 + arb(b) ** 2 + 2 * arb(a) * b * elbow.cos()
    radii, sines = [square.lower().max(arb(0)).sqrt().lower() - shift, square.upper().sqrt() + shift], []
    for radius in radii:
        cosine = (radius * radius - arb(a) ** 2 - arb(b) ** 2) / (2 * arb(a) * b)
        sines.append(1 - cosine * cosine)
    if not (radii[0] > abs(arb(a) - b) and radii[1] < arb(a) + b and all(sine > 0 for sine in sines)):
        raise ArithmeticError("an arm that a correction may stretch or fold")
    sine = sines[0].min(sines[1]).lower().sqrt().lower()
    return arb(a), shift / (a * sine), shift / (b * sine)


class Duty(NamedTuple):
    """Two bodies of a phase that must stay `least` apart, m; less than 0: they may touch so deep. Their uncertainties
    are added, unless `planned`. The first follows the clock, the second is from `early` to `late` ahead of it, s."""

    bodies: tuple[int, int]
    least: float
    early: Fraction
    late: Fraction
    rows: list[Document]
    planned: bool = False


class World:
    """The bodies, the motion and the requirements of a bundle. `failures` lists the claims that are not proved."""

    def __init__(self, bundle: Document) -> None:
        self.bundle, self.work, self.kept, self.failures = bundle, WORK, dict[Any, Any](), list[str]()
        self.splines = [spline(arm) for arm in bundle["arms"]]
        self.laws = [law(frame) if frame["edges"] or frame["period"] else None for frame in bundle["frames"]]
        self.frames, self.bodies = bundle["frames"], bundle["bodies"]
        self.phases, self.must = bundle["phases"], bundle["required"]
        self.seats = [[nth(bundle["seats"], k, "seat") for k in phase["seats"]] for phase in self.phases]
        self.surfaces = [surface(body) for body in self.bodies]
        if any([seat["body"] for seat in seats] != list(range(len(self.bodies))) for seats in self.seats):
            raise ValueError("a phase has a seat of each body, in their order")

    def spend(self, work: int) -> None:
        self.work -= work
        if self.work < sum(curve.touched for curve in (*self.splines, *self.laws) if curve is not None):
            raise RuntimeError("more work than is allowed")

    def everywhere(self, test: Callable[..., int], t0: float, t1: float, s0: Any = 0.0, s1: Any = 0.0) -> bool:
        """Whether a test is shown on an interval, or on all parts of it."""
        stack = [(t0, t1, s0, s1, 0)]
        while stack:
            t0, t1, s0, s1, depth = stack.pop()
            self.spend(1)
            try:
                status = test(t0, t1, s0, s1)
            except ArithmeticError:  # a motion is not known there or repeats too often, or a loop may come apart
                status = AHEAD if arb(s1) - s0 > arb(t1) - t0 else IN_TIME
            if status == SHOWN:
                continue
            if status == WRONG or depth >= DEEPEST or (t0 == t1 and s0 == s1):
                return False
            t, s = (t0 + t1) / 2, (s0 + s1) / 2
            halves = [(t0, t1, s0, s), (t0, t1, s, s1)] if status == AHEAD else [(t0, t, s0, s1), (t, t1, s0, s1)]
            stack += [(*half, depth + 1) for half in halves]
        return True

    def fixed(self, f: int) -> bool:
        """Whether a frame never moves."""
        frame = nth(self.frames, f, "frame")
        return self.laws[f] is None and frame["arm"] < 0 and not frame["waves"]

    def carrier(self, link: int, f: int, t0: float, t1: float, s0: Any = 0.0, s1: Any = 0.0) -> Carrier:
        """A link of the robot, which follows the clock; or, if `link` is -1, a frame, which is s ahead of it."""
        s0, s1 = (0.0, 0.0) if link >= 0 else (s0, s1)
        key = (-1, t0, t1, s0, s1) if link >= 0 else (f, 0, 0, 0, 0) if self.fixed(f) else (f, t0, t1, s0, s1)
        if key not in self.kept:
            low, high = arb(t0) + s0, arb(t1) + s1
            self.kept[key] = self.links(0, low, high) if link >= 0 else self.frame(f, low, high)
        return nth(self.kept[key], link, "link") if link >= 0 else self.kept[key]  # type: ignore[no-any-return]

    def links(self, arm: int, low: arb, high: arb) -> list[Carrier]:
        return chain(nth(self.bundle["arms"], arm, "arm"), self.splines[arm].over(low, high))

    def frame(self, f: int, low: arb, high: arb) -> Carrier:
        frame, own = self.frames[f], self.laws[f]
        if frame["arm"] >= 0:
            found: Carrier = nth(self.links(frame["arm"], low, high), frame["link"], "link")
            if not found.upright:
                raise ValueError("a frame turns about the vertical only")
            return found
        now = [constant(x) for x in frame["pose"]] if own is None else own.over(low, high)
        for wave in frame["waves"]:
            angle = arb_series([low.union(high), 1], TERMS) * arb(wave["rate"]) + arb(wave["phase"])
            now[wave["coordinate"]] = now[wave["coordinate"]] + angle.sin() * arb(wave["amplitude"])
        return upright(now[:3], *now[3].sin_cos())

    def solid(self, seat: Document, piece: int) -> Solid:
        """A piece of a body at its place on its carrier. -1: the box in the body's own axes that holds all pieces."""
        key = (id(seat), piece)
        if key not in self.kept:
            pieces = self.bodies[seat["body"]]["pieces"]
            self.kept[key] = Solid(box(pieces) if piece < 0 else nth(pieces, piece, "piece"), seat["pose"])
            if piece < 0:  # what it holds turns with a frame, and not the box
                self.kept[key].reach = largest(self.solid(seat, k).reach for k in range(len(pieces)))
        return self.kept[key]  # type: ignore[no-any-return]

    def ahead(self, f: int, late: float) -> tuple[Fraction, Fraction]:
        """How far a frame may be ahead of a robot that starts up to `late` late, at least and at most, s."""
        least, most = map(Fraction, self.frames[f]["shift"])
        return (Fraction(0), Fraction(0)) if self.fixed(f) else (-most, Fraction(late) - least)

    def duties(self, p: int) -> dict[frozenset[int], Duty]:
        """The pairs of bodies that must stay apart in phase p. These are: a body of the robot and one on a frame; two
        bodies on links that are required to stay apart; a part that was put down and a body on another frame, if one of
        both frames moves and that body is no support of the part."""
        phase, at, found, must = self.phases[p], self.seats[p], dict[frozenset[int], Duty](), self.must
        touching = {frozenset(each["bodies"]): -each["depth"] for each in phase["contacts"]}
        self_pairs = [frozenset(pair) for pair in must["self_pairs"]]
        self.spend(len(at) ** 2 * (1 + len(self_pairs) + len(must["exceptions"])))

        def add(a: int, b: int, kind: str, early: Fraction = Fraction(0), late: Fraction = Fraction(0)) -> None:
            least, key = must[kind], frozenset((a, b))
            for rule in must["exceptions"]:
                if any(x in (rule["first"] or [x]) and y in (rule["second"] or [y]) for x, y in ((a, b), (b, a))):
                    least = rule[kind]
            found.setdefault(key, Duty((a, b), touching.get(key, least), early, late, []))

        for a, b in product(range(len(at)), repeat=2) if phase["robot"] else ():
            one, other, kind = at[a]["link"], at[b]["link"], "near" if phase["near"] else "travel"
            if one >= 0 > other:
                add(a, b, kind, *self.ahead(at[b]["frame"], must["late"]))
            elif one >= 0 and a < b and one != other and frozenset((one, other)) in self_pairs:
                add(a, b, kind)
        for a, supports in ((part["body"], part["supports"]) for part in phase["put_down"]):
            here = nth(at, a, "body")["frame"]
            for b, there in enumerate(seat["frame"] for seat in at):
                if there not in (-1, here) and b not in supports and not (self.fixed(here) and self.fixed(there)):
                    (low, high), (first, last) = self.ahead(there, 0.0), self.ahead(here, 0.0)
                    add(a, b, "near", *(() if self.fixed(there) else (low - last, high - first)))
        return found

    def planned(self, p: int) -> dict[frozenset[int], Duty]:
        """The pairs of bodies that must keep a second distance in phase p, if nothing is unknown: those that must stay
        apart and may not touch."""
        found, touching = self.duties(p), {frozenset(each["bodies"]) for each in self.phases[p]["contacts"]}
        for key, duty in found.items():
            kind = "nearest" if any(self.seats[p][k]["link"] >= 0 for k in key) else "placed"
            found[key] = Duty(duty.bodies, self.must[kind], Fraction(0), Fraction(0), [], planned=True)
        return {key: duty for key, duty in found.items() if key not in touching and duty.least >= 0}

    def meant(self, p: int, row: Document, duties: dict[frozenset[int], Duty]) -> Iterator[tuple[Document, Duty]]:
        """A row with the pair that it is of, if that pair needs it. A plane is a row for the box of each body that
        stands, and needs no time differences."""
        (a, b), at = row["bodies"], self.seats[p]
        for other in [b] if b >= 0 else range(len(at)):
            duty = duties.get(frozenset((a, other)))
            fixed = at[other]["link"] < 0 and self.fixed(at[other]["frame"])
            if duty and (duty.early == duty.late == 0 or duty.bodies[0] == a) and (b >= 0 or fixed):
                yield {**row, "bodies": [a, other]}, duty

    def apart(self, key: str) -> tuple[int, int]:
        """Shows all rows of a table, and that they cover each pair in all of each phase; counts rows and pairs."""
        begins, names = [phase["t0"] for phase in self.phases], [body["name"] for body in self.bodies]
        duties = [self.duties(p) if key == "rows" else self.planned(p) for p in range(len(begins))]
        for row in self.bundle[key]:
            about = " and ".join(nth(names, body, "body") for body in row["bodies"] if body >= 0)
            p = bisect_right(begins, row["t0"]) - 1
            within = p >= 0 and row["t0"] <= row["t1"] <= self.phases[p]["t1"]
            for each, duty in self.meant(p, row, duties[p]) if within else ():
                if self.holds(p, each, duty):
                    duty.rows.append(each)
                elif row["bodies"][1] >= 0:
                    self.failures.append(f"a row of {about} from {row['t0']:.9g} s to {row['t1']:.9g} s")
        for p, phase in enumerate(self.phases):
            for pair, duty in duties[p].items():
                about = f"{' and '.join(names[k] for k in duty.bodies)} in {phase['kind']} from {phase['t0']:.9g} s"
                if phase["t1"] > phase["t0"] and not self.covered(duty, phase["t0"], phase["t1"]):
                    self.failures.append(f"{about}: no row for a part of it{', in gap_rows' if duty.planned else ''}")
                last, hollow = duties[p - 1].get(pair) if p else None, any(self.surfaces[k]["triangles"] for k in pair)
                # as long as a pair stays apart on its seats, one is within a closed surface all the time, or never
                stays = last is not None and last.bodies == duty.bodies and last.least >= 0
                stays = stays and all(self.seats[p - 1][k] is self.seats[p][k] for k in pair)
                if hollow and duty.least >= 0 and not (stays or duty.planned) and not self.outside(p, duty):
                    self.failures.append(f"{about}: nothing shows that one is not within the other")
        return sum(len(duty.rows) for each in duties for duty in each.values()), sum(map(len, duties))

    def outside(self, p: int, duty: Duty) -> bool:
        """Whether none of two bodies is within the other as phase p begins: (N11) about a point of each piece."""
        seats, early = [self.seats[p][k] for k in duty.bodies], fmpq(duty.early.numerator, duty.early.denominator)

        def test(t: float, *_: float) -> int:
            on = [self.carrier(x["link"], x["frame"], t, t, s, s) for x, s in zip(seats, (0.0, early), strict=True)]
            for (seat, here), (other, there) in permutations(zip(seats, on, strict=True)):
                shell, (place, columns) = self.surfaces[seat["body"]], here.orders[0]
                points = Solid(shell, seat["pose"]).points if shell["triangles"] else []
                for k in range(len(self.bodies[other["body"]]["pieces"])) if points else ():
                    away = [a[0] - b for a, b in zip(there.point(self.solid(other, k).points[0]), place, strict=True)]
                    self.spend(1 + len(shell["triangles"]) // 10)
                    if not abs(rounds(points, shell["triangles"], [dot(column, away) for column in columns])) < 1:
                        return WRONG
            return SHOWN

        return self.everywhere(test, self.phases[p]["t0"], self.phases[p]["t0"])

    def holds(self, p: int, row: Document, duty: Duty) -> bool:
        """Whether a row holds on its interval, or on all parts of it (N3, N4)."""
        (one, other), n = (self.seats[p][k] for k in row["bodies"]), [arb(x) for x in row["normal"]]
        (a, b), size, back = map(self.solid, (one, other), row["pieces"]), dot(n, n).sqrt(), [-x for x in n]
        need = partial(self.need, p, duty, n, size, ((one, a), (other, b)))

        def test(t0: float, t1: float, s0: float, s1: float) -> int:
            far = []
            for t, s in product((t0, t1), {s0, s1}):
                on = self.carrier(one["link"], one["frame"], t, t)
                beside = self.carrier(other["link"], other["frame"], t, t, s, s)
                reach = a.support(*on.orders[0], n, size, on.upright)
                far.append((t, reach + b.support(*beside.orders[0], back, size, beside.upright)))
            most = need(t0, t1)
            if any(-x < most and -x < need(t, t) for t, x in far):
                return WRONG
            on = self.carrier(one["link"], one["frame"], t0, t1)
            beside = self.carrier(other["link"], other["frame"], t0, t1, s0, s1)
            bend_s = b.support(*beside.orders[2], n, None, beside.upright)
            bend_t = bend_s + a.support(*on.orders[2], back, None, on.upright)
            less_t = largest([bend_t, arb(0)]) * (arb(t1) - t0) ** 2 / 8
            less_s = largest([bend_s, arb(0)]) * (arb(s1) - s0) ** 2 / 8
            if -largest(x for _, x in far) - less_t - less_s - most > 0:
                return SHOWN
            return AHEAD if s1 > s0 and (t0 == t1 or not less_t >= less_s) else IN_TIME

        return bool(size > 0) and self.everywhere(test, row["t0"], row["t1"], row["s0"], row["s1"])

    def need(self, p: int, duty: Duty, n: Vector, size: arb, sides: Any, t0: float, t1: float) -> arb:
        """The gap that is required along a normal, and how much nearer uncertainties may bring both bodies (N8)."""
        found, flat, phase, must = duty.least * size, length(n[:2]), self.phases[p], self.must
        if duty.planned:
            return arb(found)
        tools = [seat["link"] >= must["tool_from"] for seat, _ in sides]
        for f, frame in enumerate(self.frames):
            on = [seat["frame"] == f for seat, _ in sides]
            for each in frame["unknown"] if not all(tools) else ():
                given = phase["shares"][f] if each["shared"] else (0.0, 0.0)
                amount = self.amount(each, t1)
                shares = [(1.0, 1.0) if x else given if tool else (0.0, 0.0) for x, tool in zip(on, tools, strict=True)]
                share = largest(abs(arb(shares[i][1]) - shares[1 - i][0]) for i in (0, 1))
                along = abs(dot(n, each["direction"])) if each["direction"] else flat
                found += share * amount * along
            found += sum(frame["yaw"] * solid.reach * flat for x, (_, solid) in zip(on, sides, strict=True) if x)
        for seat, solid in sides:
            across, upwards = phase["unknown"][seat["body"]]
            found += across * flat + upwards * abs(n[2])
            shift = self.shifted(phase, t1)[0] if 0 < seat["link"] < must["tool_from"] else arb(0)
            if seat["link"] < 0 or not (any(must["lag"]) or shift > 0):
                continue
            arm, now = self.bundle["arms"][0], self.splines[0].over(arb(t0), arb(t1))
            values = [x[0] + arb(0, lag) for x, lag in zip(now, must["lag"], strict=True)]
            for k, lag in enumerate(must["lag"]):
                # each joint by itself: with the rates of all joints in balls, a closed chain is bounded badly
                moved = [arb_series([x, int(j == k)], TERMS) for j, x in enumerate(values)]
                on = nth(chain(arm, moved), seat["link"], "link")
                found += lag * largest(solid.support(*on.orders[1], m, None, on.upright) for m in (n, [-x for x in n]))
            if shift > 0:
                inner, first, second = swung(arm, must["tool_from"], values[1], shift)
                turns = [solid.reach * first, inner * first + solid.reach * second]
                found += flat * nth(turns, seat["link"] - 1, "link of two that a correction turns, less one,")
        return found

    def amount(self, each: Document, t: float) -> arb:
        """The size of a displacement at a time, if the robot is as late as it may be, m."""
        lasts = (arb(t) + self.must["late"] - self.must["since"]).max(arb(0))
        return arb(each["amount"] + each["growth"] * lasts)

    def shifted(self, phase: Document, t: float) -> tuple[arb, arb]:
        """How far a correction may have shifted the tool until a time, horizontally, and up or down, m."""
        flat, upright = arb(0), arb(0)
        for frame, given in zip(self.frames, phase["shares"], strict=True):
            for each in (each for each in frame["unknown"] if each["shared"]):
                x, y, z = map(arb, each["direction"] or (1, 0, 0))
                amount = largest(map(abs, map(arb, given))) * self.amount(each, t)
                flat, upright = flat + amount * length([x, y]), upright + amount * abs(z)
        return flat, upright

    def covered(self, duty: Duty, t0: float, t1: float) -> bool:
        """Whether the rows of all pieces of a pair cover a whole phase, for all times by which one may be ahead."""
        many = [range(len(self.bodies[body]["pieces"])) for body in duty.bodies]
        edges = {x for row in duty.rows for x in (row["s0"], row["s1"]) if duty.early < x < duty.late}
        for low, high in pairwise([duty.early, *sorted(edges), duty.late]):
            rows, split = [], False
            for row in sorted(duty.rows, key=lambda row: row["t0"]):
                if row["s0"] <= low and high <= row["s1"]:
                    pieces = row["pieces"] if row["bodies"][0] == duty.bodies[0] else row["pieces"][::-1]
                    rows.append((row["t0"], row["t1"], pieces))
                    split = split or pieces != [-1, -1]
            for pair in product(*many) if split else [(-1, -1)]:
                self.spend(len(rows))
                reached = t0
                for begin, end, pieces in rows:
                    if begin <= reached and all(k in (-1, j) for k, j in zip(pieces, pair, strict=True)):
                        reached = max(reached, end)
                if reached < t1:
                    return False
        return True

    def limited(self) -> None:
        """Shows that joints keep their limits, on every piece of the spline that reaches into their time, and
        their ranges with corrections."""
        own, spans = self.splines[0], self.bundle["limits"]
        if not any(span["t0"] <= own.edges[0] and own.edges[-1] <= span["t1"] for span in spans):
            self.failures.append("no limits count for all of the motion")

        def test(span: Document, t0: float, t1: float, *_: float) -> int:
            joints = own.over(arb(t0), arb(t1))
            kept, more = list[bool](), self.corrections(joints, t0, t1)
            for q, low, high, off in zip(joints, span["lower"], span["upper"], more, strict=True):
                half = (arb(high) - low) / 2
                kept.append(abs(q[0] - (arb(high) + low) / 2) + off <= half * (1 + arb(span["shares"][0])))
            given = [span[x] for x in ("velocity", "acceleration", "jerk") if span[x]]
            for q, *most in zip(joints, *given, strict=True):
                for k, (x, share) in enumerate(zip(most, span["shares"][1:], strict=False), start=1):
                    kept.append(abs(q[k]) * math.factorial(k) <= x * (1 + arb(share)))
            return SHOWN if all(kept) else IN_TIME

        for span, (t0, t1) in product(spans, pairwise(own.edges)):
            if t1 > span["t0"] and t0 < span["t1"] and not self.everywhere(partial(test, span), t0, t1):
                self.failures.append(f"a joint does not keep its limits from {t0:.9g} s to {t1:.9g} s")

    def corrections(self, joints: Vector, t0: float, t1: float) -> Vector:
        """By how much corrections may bring each joint off its position, at most (N10)."""
        found = [arb(0)] * len(joints)
        for phase in (x for x in self.phases if x["robot"] and x["t0"] <= t1 and t0 <= x["t1"]):
            shift, rise = self.shifted(phase, t1)
            if not (shift == 0 and rise == 0):
                elbow = nth(joints, 1, "joint")[0] + arb(0, nth(self.must["lag"], 1, "lag"))
                _, first, second = swung(self.bundle["arms"][0], self.must["tool_from"], elbow, shift)
                found = [x.max(y) for x, y in zip(found, (first, first + second, rise, second), strict=True)]
        return found

    def stated(self) -> None:
        """Shows all rows about the tool and the joints."""
        tests: dict[str, Callable[..., int]] = {"points": self.near, "rates": self.fast, "axes": self.aimed}
        tests |= {"sums": self.summed, "guides": self.led, "distances": self.close, "errors": self.missed}
        for key, test in tests.items():
            for k, row in enumerate(self.bundle[key]):
                t0, t1 = (row.get(end, row.get("time")) for end in ("t0", "t1"))
                phase = nth(self.phases, row["phase"], "phase") if "phase" in row else {"t0": t0, "t1": t1}
                ahead = self.ahead(row["frame"], self.must["late"]) if key == "errors" else (Fraction(0), Fraction(0))
                low, high = (fmpq(s.numerator, s.denominator) for s in ahead)
                # accelerations jump at knots, to another direction
                cuts = [t0, *(x for x in self.splines[0].edges if t0 < x < t1 and key == "rates"), t1]
                kept = all(self.everywhere(partial(test, row), *span, low, high) for span in pairwise(cuts))
                if not (kept and phase["t0"] <= t0 <= t1 <= phase["t1"]):
                    self.failures.append(f"{key}, {row.get('name', k)}, from {t0:.9g} s to {t1:.9g} s")

    def short(self, vectors: Callable[[float, float], list[Vector]], limits: Vector, t0: float, t1: float) -> int:
        """Whether vectors are no longer than their limits from t0 to t1 (N9)."""
        most = (arb(t1) - t0) ** 2 / 8
        bends = [length(s[2] * 2 for s in vector) * most for vector in vectors(t0, t1)]
        for t in (t0, t1):
            here = zip(vectors(t, t), bends, limits, strict=True)
            if not all(length(s[0] for s in vector) + bend <= limit for vector, bend, limit in here):
                return IN_TIME
        return SHOWN

    def near(self, point: Document, t0: float, t1: float, *_: float) -> int:
        """Whether the tool is at its point; and how fast it leaves it as that time begins."""
        limits = [*point["height"], point["position"], *point["yaw"]]
        found = self.short(partial(self.relative, point), limits, t0, t1)
        rates = self.relative({**point, "height": []}, point["t0"], point["t0"]) if point["rates"] else []
        fast = [length(s[1] for s in v) <= most for v, most in zip(rates, point["rates"], strict=True)]
        return found if all(fast) else WRONG

    def fast(self, rate: Document, t0: float, t1: float, *_s: float) -> int:
        """Whether the velocity of a point in a frame, or its acceleration in the world, is as long as is claimed: for
        all values of a time at once, or by the rate of its square (N12)."""
        order, middle, least, most = rate["order"], (t0 + t1) / 2, arb(rate["least"]), arb(rate["most"])

        def moving(a: float, b: float) -> tuple[Vector, Vector]:
            way = self.carrier(rate["link"], -1, a, b).point(rate["point"])
            if rate["frame"] >= 0:
                there = self.carrier(-1, rate["frame"], a, b)
                away = [x - y for x, y in zip(way, there.place, strict=True)]
                way = [dot(column, away) for column in there.columns]
            return [s[order] * order for s in way], [s[order + 1] * math.factorial(order + 1) for s in way]

        (over, change), (here, _) = moving(t0, t1), moving(middle, middle)
        if length(over) <= most and sum((x * x for x in map(arb.abs_lower, over)), arb(0)) >= least * least:
            return SHOWN
        square, off = dot(here, here), 2 * abs(dot(over, change)) * (arb(t1) - middle).max(middle - arb(t0))
        return SHOWN if square - off >= least * least and square + off <= most * most else IN_TIME

    def aimed(self, axis: Document, t0: float, t1: float, *_: float) -> int:
        """Whether a scalar product of an axis, or of the way to a point, and a direction is in its range."""
        middle, half = (arb(axis["high"]) + axis["low"]) / 2, (arb(axis["high"]) - axis["low"]) / 2

        def off(a: float, b: float) -> list[Vector]:
            on, direction = self.carrier(axis["link"], -1, a, b), [constant(x) for x in axis["direction"]]
            way = on.point(axis["axis"]) if axis["place"] else on.direction(axis["axis"])
            if axis["other"] >= 0:
                base = self.carrier(axis["other"], -1, a, b)
                direction = base.direction(axis["direction"])
                way = [x - y for x, y in zip(way, base.place, strict=True)] if axis["place"] else way
            return [[dot(way, direction) - middle]]

        return self.short(off, [half], t0, t1)

    def summed(self, row: Document, t0: float, t1: float, *_: float) -> int:
        """Whether a sum of shares of the joints, or a derivative of it, is in its range."""
        joints, order = self.splines[0].over(arb(t0), arb(t1)), row["order"]
        total = sum((q[order] * share for q, share in zip(joints, row["joints"], strict=True)), arb(0))
        total *= math.factorial(order)
        return SHOWN if total >= row["low"] and total <= row["high"] else IN_TIME

    def led(self, guide: Document, t0: float, t1: float, *_: float) -> int:
        """Whether the tool is at its guide, from a point of one frame to a point of another."""
        (first, last), h = map(arb, guide["shares"]), arb(guide["t1"]) - guide["t0"]
        slope = (last - first) / h if first != last else arb(0)

        def off(a: float, b: float) -> list[Vector]:
            share = arb_series([first + slope * (arb(a).union(arb(b)) - guide["t0"]), slope], TERMS)
            tool = self.carrier(guide["link"], -1, a, b).point(guide["tool"])
            ends = zip(guide["frames"], (guide["from"], guide["to"]), strict=True)
            one, other = (self.carrier(-1, f, a, b).point(end) for f, end in ends)
            return [[w - x - share * (y - x) for w, x, y in zip(tool, one, other, strict=True)]]

        # two shares at an instant are wrong
        return self.short(off, [guide["most"]], t0, t1) if first == last or guide["t0"] < guide["t1"] else WRONG

    def close(self, row: Document, t: float, *_: float) -> int:
        """Whether two bodies are as near each other as is claimed: points of both are, which weights choose (N14)."""
        p, weights, found = row["phase"], row["weights"], [arb(0)] * 3
        total = sum(map(arb, weights), arb(0))
        for body, piece, sign in zip(row["bodies"], row["pieces"], (-1, 1), strict=True):
            seat = nth(self.seats[p], body, "body")
            solid, (place, columns) = self.solid(seat, piece), self.carrier(seat["link"], seat["frame"], t, t).orders[0]
            for k, weight in enumerate(weights):
                if weight > 0:
                    way = [arb(x) * -sign for x in row["directions"][3 * k : 3 * k + 3]]
                    size = dot(way, way).sqrt()
                    point = solid.farthest([dot(column, way) / size for column in columns])
                    at = [x + dot(axes, point) for x, *axes in zip(place, *columns, strict=True)]
                    found = [x + sign * weight * y / total for x, y in zip(found, at, strict=True)]
        return SHOWN if abs(total - 1) <= CLOSED and length(found) <= row["most"] else WRONG

    def missed(self, row: Document, t: float, _: float, s0: Any, s1: Any) -> int:
        """Whether the tool is no farther from its point than is claimed, while the frame is from s0 to s1 ahead of the
        clock (N15). Of its way the ends count and how far it bends between them; of its turn all of it."""
        f, yaw = row["frame"], arb(self.frames[row["frame"]]["yaw"])
        if (id(row), t) not in self.kept:
            self.kept[id(row), t] = self.unsure(row, self.phases[row["phase"]], t)
        straight, flat, upright, turn = self.kept[id(row), t]
        tool, point = self.carrier(row["link"], -1, t, t).point(row["tool"][:3]), row["target"][:3]
        now, over = self.carrier(-1, f, t, t), self.carrier(-1, f, t, t, s0, s1)
        way, bend = over.point(point), (arb(s1) - s0) ** 2 / 4
        (a, b), (x, y) = ((axis[0] for axis in on.columns[0][:2]) for on in (now, over))
        turned = turn + abs(arb.atan2(a * y - b * x, a * x + b * y)).upper()
        arm = length(x[2] - y[2] for x, y in zip(way[:2], over.place, strict=False))
        flat, upright = flat + (length(x[2] for x in way[:2]) + yaw * arm) * bend, upright + abs(way[2][2]) * bend
        for there in (self.carrier(-1, f, t, t, s, s) for s in (s0, s1)):
            x, y, z = (x[0] for x in there.point(point))
            tangent = [yaw * (there.place[1][0] - y), yaw * (x - there.place[0][0]), arb(0)]
            away = [a[0] - b for a, b in zip(tool, (x, y, z), strict=True)]
            far, side, height = farthest(away, [*straight, tangent], flat, upright)
            kept = far + turned * row["arm"] <= row["distance"] and side <= row["horizontal"]
            if not (kept and height <= row["vertical"] and turned <= row["yaw"]):
                return AHEAD
        return SHOWN

    def unsure(self, row: Document, phase: Document, t: float) -> tuple[list[Vector], arb, arb, arb]:
        """What adds to an error at any lateness (N15): vectors that count with either sign, how far it may be
        horizontally in each direction, how far up or down, m, and how far it may be turned, rad."""
        flat, upright, turn = map(arb, row["off"])
        straight, tools, f = list[Vector](), row["link"] >= self.must["tool_from"], row["frame"]
        for k, (frame, given) in enumerate(zip(self.frames, phase["shares"], strict=True)):
            for each in frame["unknown"]:
                shares = given if each["shared"] and tools else (0, 0)
                share = largest(abs(arb(int(k == f)) - x) for x in shares)
                amount = share * self.amount(each, t)
                if each["direction"]:
                    straight.append([amount * x for x in each["direction"]])
                else:
                    flat += amount
        yaw, lag, link = arb(self.frames[f]["yaw"]), self.must["lag"], row["link"]
        flat, turn = flat + length(map(arb, row["target"][:2])) * yaw * yaw / 2, turn + yaw
        moves, arm = [k for k, x in enumerate(lag) if x > 0], self.bundle["arms"][0]
        own, coupled = nth(arm["links"], link, "link"), arm["links"][link]["coupler"] >= 0
        now = [x[0] for x in self.splines[0].over(arb(t), arb(t))]
        near = [x + arb(0, most) for x, most in zip(now, lag, strict=True)]
        first = chain(arm, [constant(x) for x in now])[link].columns[0]

        def moved(values: Vector, *joints: int) -> Vector:
            """The tool point, and the sine of its turn on a coupler, as series, while these joints move at the rates of
            their lag."""
            rates = [arb(most) if k in joints else arb(0) for k, most in enumerate(lag)]
            on = chain(arm, [arb_series([x, rate], TERMS) for x, rate in zip(values, rates, strict=True)])[link]
            (x, y), (u, v) = on.columns[0][:2], (a[0] for a in first[:2])
            if coupled and not u * x[0] + v * y[0] > 0:
                raise ArithmeticError("joints that lag turn the tool too far")
            return [*on.point(row["tool"][:3]), y * u - x * v if coupled else constant(0)]

        sine, halves = arb(0), {k: [x[2] for x in moved(near, k)] for k in moves}
        for k in moves:
            *way, turned = (x[1] for x in moved(now, k))
            straight.append(way)
            sine += abs(turned)
        bows = list(halves.values())
        for j, k in combinations(moves, 2):
            bows.append([x[2] - y - z for x, y, z in zip(moved(near, j, k), halves[j], halves[k], strict=True)])
        for x, y, z, turned in bows:
            flat, upright, sine = flat + length([x, y]), upright + abs(z), sine + abs(turned)
        if own["pitch"] is None:
            shares = zip(own["yaw"]["joints"], lag, strict=True)
            turn += sine.upper().asin() if coupled else sum((abs(arb(x)) * most for x, most in shares), arb(0))
        return straight, flat, upright, turn

    def relative(self, point: Document, t0: float, t1: float) -> list[Vector]:
        """The tool point as its control point sees it, as vectors. If a range of heights is allowed: how far it is from
        the middle of them. How far it is from the point (horizontally, if heights are allowed). If the yaw counts: the
        difference of the x axes of tool and target."""
        (*tool, turn), (*target, yaw), found = point["tool"], point["target"], list[Vector]()
        here, there = self.carrier(point["link"], -1, t0, t1), self.carrier(-1, point["frame"], t0, t1)
        away = [x - y for x, y in zip(here.point(tool), there.point(target), strict=True)]
        if point["height"]:
            found.append([away.pop() - arb(point["middle"])])
        (s, c), (u, v) = arb(turn).sin_cos(), arb(yaw).sin_cos()
        axes = zip(*here.columns[:2], *there.columns[:2], strict=True)
        found += [away, [x * c + y * s - z * v - w * u for x, y, z, w in axes]]
        return found if point["yaw"] else found[:-1]


def once(pairs: list[tuple[str, Any]]) -> Document:
    """An object of JSON. Raises `ValueError` if one of its keys is there twice."""
    found = dict(pairs)
    if len(found) < len(pairs):
        raise ValueError(f"a key is there twice: {min(k for k, _ in pairs if [x for x, _ in pairs].count(k) > 1):.80}")
    return found


def finite(text: str) -> int:
    """A whole number that a double holds exactly. Raises `ValueError` for a longer one, and for NaN and infinities."""
    if len(text.lstrip("-")) > 15 or not text.lstrip("-").isdigit():
        raise ValueError(f"{text:.20} is not allowed; finite numbers are, whole ones of up to 15 digits")
    return int(text)


FORMER, TABLES = "assur-bundle/2", ("sums", "guides", "distances", "errors", "gap_rows")
"""The form before, and the tables that it does not have. It has `pulls` in place of `rates`."""
ADDED: Document = {"frames": {"period": 0.0, "step": [0.0] * 4}, "axes": {"place": False, "other": -1}}
UNCLAIMED = {"nearest": -1.0, "placed": -1.0}
"""What other parts of the form before do not have, and what means the same: frames, axes, and what is required."""


def converted(document: Any) -> Document:
    """A document of the form before in the present one: a pull is a rate of order 2, no greater than it allows. Raises
    `ValueError` if parts are missing, or are not of that form."""
    parts: Any = [(document, {x: [] for x in (*TABLES, "rates")}), (document["required"], UNCLAIMED)]
    parts += [(each, ADDED[key]) for key in ADDED for each in document[key]]
    for each, added in parts:
        if each.keys() & added.keys():
            raise ValueError(f"{min(each.keys() & added.keys())} is no part of {FORMER}")
        each.update(added)
    for pull in document.pop("pulls"):
        most = min(Fraction(pull.pop("most")) * (1 + Fraction(pull.pop("share"))), Fraction(1e300))
        pull.update(point=pull.pop("tool")[:3], frame=-1, order=2, least=0.0, most=math.nextafter(float(most), 0.0))
        document["rates"].append(pull)
    return {**document, "schema": "assur-bundle/3"}


def read(data: bytes) -> Document:
    """The bundle in a file, in the present form. Raises `ValueError`."""
    if len(data) > MOST_BYTES:
        raise ValueError(f"{len(data)} bytes; up to {MOST_BYTES} are allowed")
    try:
        document = json.loads(data, object_pairs_hook=once, parse_constant=finite, parse_int=finite)
        if isinstance(document, dict) and document.get("schema") == FORMER:
            document = converted(document)
        wrong = next(validator_for(json.loads(SCHEMA.read_bytes())).iter_errors(document), None)
    except RecursionError as error:
        raise ValueError("lists within lists, too deep") from error
    if wrong is not None:
        raise ValueError(f"{'.'.join(map(str, wrong.instance_path)) or 'bundle'}: {wrong.message:.200}")
    for where, low, high in ranges(document):
        if low > high:  # nothing is in this range, so that nothing would be claimed
            raise ValueError(f"{where}: {high:.9g} is less than {low:.9g}, with which its range begins")
    return dict(document)


def ranges(bundle: Document) -> Iterator[tuple[str, float, float]]:
    """The ranges of a bundle: for each the place of its second number, and both numbers."""
    parts = ("phases", "limits", "points", "rates", "axes", "sums", "guides", "rows", "gap_rows")
    for part, (low, high) in product(parts, (("t0", "t1"), ("s0", "s1"), ("low", "high"), ("least", "most"))):
        yield from ((f"{part}.{k}.{high}", x[low], x[high]) for k, x in enumerate(bundle[part]) if low in x)
    yield from ((f"frames.{k}.shift.1", *frame["shift"]) for k, frame in enumerate(bundle["frames"]))
    shares = ((k, f, share) for k, phase in enumerate(bundle["phases"]) for f, share in enumerate(phase["shares"]))
    yield from ((f"phases.{k}.shares.{f}.1", *share) for k, f, share in shares)


def claimed(world: World, alone: float, rows: int, pairs: int, gap_rows: int, gap_pairs: int) -> Document:
    """What a bundle claims, in words and numbers: how much of each kind, and the most that it allows."""
    bundle, must, own, limits = world.bundle, world.must, world.splines[0].edges, world.bundle["limits"]
    contacts, put_down = ([each for phase in world.phases for each in phase[key]] for key in ("contacts", "put_down"))
    apart, links = set(map(frozenset, must["self_pairs"])), {seat["link"] for seats in world.seats for seat in seats}
    unsure = [frame for frame in world.frames if frame["unknown"] or frame["yaw"] or any(frame["shift"])]

    def kept(key: str) -> Any:
        whole = [span[key] for span in limits if span["t0"] <= own[0] and own[-1] <= span["t1"] and span[key]]
        return [max(x) if key == "lower" else min(x) for x in zip(*whole, strict=True)] or "not limited"

    def counted(what: str, most: str, values: list[float]) -> Document:
        return {f"times and intervals {what}": len(values), most: max([0, *values])}

    def most(table: str, key: str) -> list[float]:
        return [each[key] for each in bundle[table]]

    speeds, pulls = ([each["most"] for each in bundle["rates"] if each["order"] == order] for order in (1, 2))
    axes, sums = ([each["high"] - each["low"] for each in bundle[key]] for key in ("axes", "sums"))
    second = [{1e300: "no pair"}.get(x, x) if x >= 0 else "not claimed" for x in (must["nearest"], must["placed"])]
    return {
        **{key: bundle[key] for key in ("plan_digest", "request_digest")},
        "the robot keeps clear from and until, s": [own[0], alone],
        "parts that it put down keep clear until, s": must["until"],
        "pairs of bodies that keep their distance, counted in each phase": pairs,
        "rows that show it": rows,
        "planes among the rows": sum(row["bodies"][1] < 0 for row in bundle["rows"]),
        "distances in travel and near a control point, m": [must["travel"], must["near"]],
        "smallest distance of a pair, m": min(x for r in (must, *must["exceptions"]) for x in (r["travel"], r["near"])),
        "second distances of the robot's bodies and of parts that were put down, m": second,
        "pairs that keep a second distance, counted in each phase, and rows that show it": [gap_pairs, gap_rows],
        "bodies from meshes, with what they enclose": sum(bool(shell["triangles"]) for shell in world.surfaces),
        "pairs of the robot's links that keep apart": sum(len(pair) == 2 and pair <= links for pair in apart),
        "parts that were put down, counted in each phase": len(put_down),
        "pairs that may touch, counted in each phase": len(contacts),
        "deepest contact, m": max([0, *(each["depth"] for each in contacts)]),
        "greatest delay of the robot's start, s": must["late"],
        "greatest lag of a joint, rad or m": max(must["lag"]),
        "frames that repeat their motion": sum(frame["period"] > 0 for frame in world.frames),
        "frames with an uncertainty": len(unsure),
        "greatest displacement of a frame, m": max([0, *(x["amount"] for frame in unsure for x in frame["unknown"])]),
        "its greatest growth, m/s": max([0, *(x["growth"] for frame in unsure for x in frame["unknown"])]),
        "greatest turn of a frame, rad": max([0, *(frame["yaw"] for frame in unsure)]),
        "greatest shift of a frame, s": max([0, *(abs(x) for frame in unsure for x in frame["shift"])]),
        "greatest displacement of a body, m": max([0, *(max(x) for phase in world.phases for x in phase["unknown"])]),
        "largest share by which a limit may be exceeded": max(x for span in limits for x in span["shares"]),
        **{f"limits of each joint, {key}": kept(key) for key in ("lower", "upper", "velocity", "acceleration", "jerk")},
        "times and intervals at which the tool is where it must be": len(bundle["points"]),
        "farthest that it may be off, m": max([0, *(each["position"] for each in bundle["points"])]),
        **counted("at which the velocity of a point is bounded", "greatest velocity, m/s", speeds),
        **counted("at which the acceleration of a point is bounded", "greatest acceleration, m/s²", pulls),
        **counted(
            "at which an axis has a direction, or a point a place along one", "widest range of these, or m", axes
        ),
        **counted("at which a sum of joints or a derivative of it is bounded", "widest range of a sum", sums),
        **counted("at which a point is at its guide", "farthest from a guide, m", most("guides", "most")),
        **counted("at which two bodies are near each other", "farthest of these, m", most("distances", "most")),
        **counted("at which the error of the tool is bounded", "greatest error, m", most("errors", "distance")),
        "greatest turn in an error, rad": max([0, *most("errors", "yaw")]),
    }


def prove(data: bytes) -> tuple[bool, Any]:
    """Whether everything that a bundle claims is shown. If so, what that is, in words and numbers (a dict); if not, the
    first claims that are not shown (lines). Raises `ValueError` if this is no bundle."""
    before = ctx.prec, ctx.cap
    ctx.prec, ctx.cap = BITS, TERMS
    try:
        world = World(read(data))
        failures, phases, edges = world.failures, world.phases, world.splines[0].edges
        alone = next((phase["t0"] for phase in phases if not phase["robot"]), world.must["until"])
        ends = [edges[0], *(phase["t1"] for phase in phases)]
        if any(phase["t0"] != t for phase, t in zip(phases, ends, strict=False)):
            failures.append("phases do not follow each other without a gap")
        if not ends[-1] >= world.must["until"]:
            failures.append("the phases end too early")
        if not alone >= edges[-1]:
            failures.append(f"the robot keeps clear until {alone:.9g} s, and moves until {edges[-1]:.9g} s")
        world.limited()
        world.stated()
        counts = (*world.apart("rows"), *world.apart("gap_rows"))
        lines = [*failures[:MOST_FAILURES], f"claims that are not shown: {len(failures)}"]
        return not failures, lines if failures else claimed(world, alone, *counts)
    except (AttributeError, LookupError, TypeError) as error:
        raise ValueError(f"values that do not fit together: {error}") from error
    except (OverflowError, RuntimeError):
        return False, [f"more work than {WORK} intervals, pairs and pieces of motions"]
    finally:
        ctx.prec, ctx.cap = before
