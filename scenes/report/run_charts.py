"""Charts of a run, as SVG that stands in a page: what the arm does in each minute, throughput, and cycles."""

from __future__ import annotations

import html
import math
from collections.abc import Iterable, Sequence
from itertools import pairwise

WIDE, LINE, LEFT, BELOW = 900.0, 18.0, 46.0, 22.0
"""Width of a chart, height of a line of it, and the space for names on the left and for numbers below."""
HIGH = 150.0
MINUTE_S = 60.0
MOST_LINES = 60
"""Minutes that are drawn."""
BARS = 24
Span = tuple[float, float, str]
"""From when until when, s, and what: a class of the style."""


def by_minutes(spans: Iterable[Span], from_s: float, until_s: float, names: dict[str, str]) -> str:
    """A line for each minute with what was done when. `names`: of the classes, for the legend."""
    lines = min(MOST_LINES, max(1, math.ceil((until_s - from_s) / MINUTE_S)))
    parts = []
    for number in range(lines):
        y = LINE * number
        parts.append(f'<text x="0" y="{y + 13:.0f}">{(from_s + MINUTE_S * number) / 60:.0f} min</text>')
    for begin, end, what in spans:
        for number in range(lines):
            left = from_s + MINUTE_S * number
            a, b = max(begin, left), min(end, left + MINUTE_S)
            if a < b:
                at = LEFT + (a - left) / MINUTE_S * (WIDE - LEFT)
                size = f'x="{at:.2f}" width="{(b - a) / MINUTE_S * (WIDE - LEFT):.2f}"'
                title = f"<title>{html.escape(names[what])}, {begin:.2f} to {end:.2f} s</title>"
                parts.append(f'<rect class="{what}" y="{LINE * number:.0f}" height="{LINE - 4}" {size}>{title}</rect>')
    key = "".join(f'<span class="key"><i class="{what}"></i>{html.escape(name)}</span>' for what, name in names.items())
    return _svg(parts, LINE * lines) + f'<p class="keys">{key}</p>'


def over_time(times: Sequence[float], from_s: float, until_s: float) -> str:
    """How many of these events there were a minute, over the time, each counted over a minute around it."""
    steps = 120
    at = [from_s + (until_s - from_s) * k / steps for k in range(steps + 1)]
    values = []
    for t in at:
        a, b = max(from_s, t - MINUTE_S / 2), min(until_s, t + MINUTE_S / 2)
        values.append(MINUTE_S * sum(a <= time < b for time in times) / max(b - a, 1e-9))
    most = _above(max(values, default=0.0))
    points = " ".join(
        f"{LEFT + k / steps * (WIDE - LEFT):.1f},{HIGH - value / most * HIGH:.1f}" for k, value in enumerate(values)
    )
    marks = [from_s + (until_s - from_s) * k / 6 for k in range(7)]
    brief = until_s - from_s < 6.0 * MINUTE_S
    texts = [f"{mark:.0f} s" if brief else f"{mark / MINUTE_S:.3g} min" for mark in marks]
    numbers = [(LEFT + k / 6 * (WIDE - LEFT), text) for k, text in enumerate(texts)]
    return _svg([*_scale(most), f'<polyline class="curve" points="{points}"/>', *_below(numbers)], HIGH + BELOW)


def histogram(values: Sequence[float]) -> str:
    """How often each value, s, occurs."""
    if not values:
        return '<p class="faint">none</p>'
    low, high = min(values), max(values)
    edges = [low + max(high - low, 0.1) * k / BARS for k in range(BARS + 1)]
    counts = [sum(a <= value < b for value in values) for a, b in pairwise(edges)]
    counts[-1] += sum(value >= edges[-1] for value in values)
    most, wide, parts = _above(float(max(counts))), (WIDE - LEFT) / BARS, list[str]()
    for k, count in enumerate(counts):
        high_px = HIGH * count / most
        size = f'x="{LEFT + k * wide:.1f}" y="{HIGH - high_px:.1f}" width="{wide - 2:.1f}" height="{high_px:.1f}"'
        parts.append(
            f'<rect class="run-pick" {size}><title>{edges[k]:.2f} to {edges[k + 1]:.2f} s: {count}</title></rect>'
        )
    numbers = [(LEFT + k * wide, f"{edges[k]:.2f} s") for k in range(0, BARS + 1, 4)]
    return _svg([*_scale(most), *parts, *_below(numbers)], HIGH + BELOW)


def _above(value: float) -> float:
    """A round number that is not below a value: 1, 2 or 5 times a power of ten."""
    if value <= 0.0:
        return 1.0
    power = 10.0 ** math.floor(math.log10(value))
    return next(step * power for step in (1.0, 2.0, 5.0, 10.0) if step * power >= value)


def _scale(most: float) -> list[str]:
    lines = [(HIGH - share * HIGH, share * most) for share in (0.0, 0.5, 1.0)]
    return [
        f'<line x1="{LEFT:.0f}" x2="{WIDE:.0f}" y1="{y:.1f}" y2="{y:.1f}"/>'
        f'<text x="0" y="{max(y, 6) + 4:.1f}">{value:g}</text>'
        for y, value in lines
    ]


def _below(numbers: Iterable[tuple[float, str]]) -> list[str]:
    return [f'<text x="{min(x, WIDE - 40):.1f}" y="{HIGH + 16:.0f}">{html.escape(text)}</text>' for x, text in numbers]


def _svg(parts: Iterable[str], high: float) -> str:
    return f'<svg class="run" viewBox="0 -2 {WIDE:.0f} {high + 4:.0f}" role="img">{"".join(parts)}</svg>'
