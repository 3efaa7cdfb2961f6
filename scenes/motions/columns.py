"""What the columns of a CSV file are, by their titles.

Read are titles as our own files have them (`t_s`, `time_ms`, `j1_deg`, `j1_deg_s`, also `j1 [deg/s]`), and those that
programs write of recorded ROS messages: `/joint_states/j1/position`, `field.position0` with `field.name0`, `__time`,
`%time`, `header.stamp.sec` with `header.stamp.nanosec`.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from assur.scenes.bounds import MAX_JOINTS
from assur.scenes.faults import NOTHING, DocumentError
from assur.scenes.motions.motion import ACCELERATION, POSITION, STATES, VELOCITY
from assur.scenes.text.scalars import LONGEST_SHOWN
from assur.scenes.units import any_unit, si_key, twin_of

HEADER = (
    "a header with time_s (or time_ms, time_us, time_ns, t_s, t_ms ...), and each joint's name with its unit (j1_deg, "
    "j1_rad, j3_mm or j3_m; speeds j1_deg_s, accelerations j1_deg_s2)"
)
NAME = re.compile(r"[A-Za-z][A-Za-z0-9_./:-]{0,63}")
CLOCK = re.compile(r"(?:t|time|timestamp|stamp|__time|%time)(?:_(s|ms|us|ns))?", re.IGNORECASE)
OF_RECORDER = {"__time": "s", "%time": "ns"}
"""Titles of times that recorders write, and their units."""
BRACKETS = re.compile(r"(.*?)\s*[\[(]\s*([^\])]+?)\s*[\])]")
ORDERS = {"": POSITION, "_s": VELOCITY, "_s2": ACCELERATION}
"""What follows rad or m in a unit → the order of the state."""
KINDS = {"position": POSITION, "velocity": VELOCITY, "acceleration": ACCELERATION}
KINDS |= {state: order for order, state in enumerate(STATES)}
NUMBERED = re.compile(r"(?:.*[./])?(name|position|velocity|acceleration)s?[.\[_]?([0-9]{1,2})\]?")
SPLIT = re.compile(r"[/.]")
SECONDS, NANOSECONDS = ("sec", "secs"), ("nanosec", "nanosecs", "nsec", "nsecs")
NOT_USED = re.compile(r"(?:.*[./])?(?:seq|frame_id|header[./].*|effort.*|.*[./]effort)", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Column:
    """A column: its place in a row and its title; of a joint, its name (or the number of its name's column), the order
    of the state, its SI unit (None: not stated) and the unit that it is written in, where that is another."""

    place: int
    title: str
    joint: str | int
    order: int
    unit: str | None = None
    twin: str | None = None


@dataclass(frozen=True)
class Columns:
    """The columns of a file: those of its times, of the names of joints by number, of states, and the titles of those
    that are not used. `clock`: (place, unit) of each time column; unit None: not stated."""

    clock: tuple[tuple[int, str | None], ...]
    names: dict[int, int]
    states: tuple[Column, ...]
    unused: tuple[str, ...]


def columns_of(titles: list[str], rows: list[list[str]], name: str, line: int) -> Columns:
    """The columns of a header, with the cells of the rows behind it. Raises `DocumentError` at the column at fault."""
    clocks: list[tuple[int, str | None]] = []
    stamps: dict[str, int] = {}
    names: dict[int, int] = {}
    states: list[Column] = []
    unused: list[str] = []
    for place, title in enumerate(titles):
        key = _plain(title)
        numbered = NUMBERED.fullmatch(key)
        last = SPLIT.split(key)[-1]
        clock = CLOCK.fullmatch(key)
        if clock is not None:
            if clocks:
                raise DocumentError(f"{name}: column", title, "one column for t", line)
            clocks.append((place, clock[1].lower() if clock[1] else OF_RECORDER.get(key)))
        elif last in (*SECONDS, *NANOSECONDS, "stamp"):
            kind = "s" if last in SECONDS else "ns" if last in NANOSECONDS else "stamp"
            if stamps.setdefault(kind, place) != place:
                allowed = f"one stamp; {titles[stamps[kind]]} is of another: remove what does not count"
                raise DocumentError(f"{name}: column", title, allowed, line)
        elif numbered is not None and numbered[1] == "name":
            if names.setdefault(int(numbered[2]), place) != place:
                raise DocumentError(f"{name}: column", title, "one column of names for a number", line)
        elif (column := _state(place, title, key, numbered)) is not None:
            states.append(column)
        elif NOT_USED.fullmatch(key):
            unused.append(title)
        else:
            shown = title[:LONGEST_SHOWN] if len(title) > 2 * LONGEST_SHOWN else title
            raise DocumentError(f"{name}: column", shown, f"{HEADER}, and no other columns", line)
    _check_states(states, names, name, line)
    own, other = _clock(clocks, stamps, rows)
    if not own:
        raise DocumentError(f"{name}: column", NOTHING, f"a column of times: {HEADER}", line)
    return Columns(own, names, tuple(states), (*unused, *(titles[place] for place in other)))


def _plain(title: str) -> str:
    """A title with its unit behind an underscore: `j1 [deg/s^2]` → `j1_deg_s2`."""
    found = BRACKETS.fullmatch(title)
    if found is None:
        return title
    unit = found[2].replace("°", "deg").replace("²", "2").replace("µ", "u").replace("/", "_").replace("^", "")
    return f"{found[1]}_{unit}"


def _state(place: int, title: str, key: str, numbered: re.Match[str] | None) -> Column | None:
    """The column of a joint's state; None for another."""
    if numbered is not None:
        return Column(place, title, int(numbered[2]), KINDS[numbered[1]])
    parts = SPLIT.split(key)
    if len(parts) > 1 and parts[-1] in KINDS and NAME.fullmatch(parts[-2]):
        return Column(place, title, parts[-2], KINDS[parts[-1]])
    if len(parts) > 1 and parts[-2] in KINDS and NAME.fullmatch(parts[-1]) and any_unit(key) is None:
        return Column(place, title, parts[-1], KINDS[parts[-2]])
    twin, unit = si_key(key), any_unit(key)
    if unit is None:
        return None
    si = unit if twin is None else any_unit(twin[0])
    head, _, rate = str(si).partition("_")
    of, order = key[: -len(unit) - 1], ORDERS.get(f"_{rate}" if rate else "")
    if head not in ("rad", "m") or order is None or NAME.fullmatch(of) is None or CLOCK.fullmatch(of):
        return None
    return Column(place, title, of, order, head, None if twin is None else unit)


def _check_states(states: list[Column], names: dict[int, int], name: str, line: int) -> None:
    """Raises `DocumentError` unless each joint has one column of positions, one at most of each rate, in units of one
    kind, and a name."""
    seen: dict[tuple[str | int, int], Column] = {}
    for column in states:
        before = seen.setdefault((column.joint, column.order), column)
        if before is not column:
            si = f"{column.joint}_{column.unit}{('', '_s', '_s2')[column.order]}"
            both = f"{si} or {twin_of(si)}" if column.unit is not None and before.unit == column.unit else column.joint
            raise DocumentError(f"{name}: column", column.title, f"one column for {both}", line)
        if isinstance(column.joint, int) and column.joint not in names:
            allowed = "a column of the joint's name for each number (name0, position0), or the name in the title"
            raise DocumentError(f"{name}: column", column.title, allowed, line)
    joints = {column.joint: column for column in reversed(states)}
    for joint, column in joints.items():
        position = seen.get((joint, POSITION))
        if position is None:
            raise DocumentError(f"{name}: column", column.title, f"a column of the positions of {joint}, too", line)
        if any(seen[key].unit != position.unit for key in seen if key[0] == joint):
            raise DocumentError(f"{name}: column", column.title, f"rad or m in all columns of {joint}", line)
    if not 1 <= len(joints) <= MAX_JOINTS:
        raise DocumentError(name, f"{len(joints)} joints", f"columns of 1 to {MAX_JOINTS} joints: {HEADER}", line)


def _clock(
    clocks: list[tuple[int, str | None]], stamps: dict[str, int], rows: list[list[str]]
) -> tuple[tuple[tuple[int, str | None], ...], list[int]]:
    """The columns of times that count, and the places of those that do not: the stamp of a message counts before the
    time of its recorder, unless it was left 0 in every row."""
    found: tuple[tuple[int, str | None], ...] = ()
    if "s" in stamps and "ns" in stamps:
        found = ((stamps["s"], "s"), (stamps["ns"], "ns"))
    elif "stamp" in stamps:
        found = ((stamps["stamp"], None),)
    left_out = all(set(row[place]) <= set("0.") for row in rows for place, _ in found if place < len(row))
    if clocks and (not found or left_out):
        return tuple(clocks), [*stamps.values()]
    used = {place for place, _ in found}
    return found, [place for place in (*(each for each, _ in clocks), *stamps.values()) if place not in used]
