"""The log of a session, played: whether its plans follow each other in one world, and no part is hit that they do not
know. A part that is put on one that came on a stream goes into a slot of that which nothing was put into before, while
the slot is in its window.

The judge keeps a world of its own: where each part is by its sightings and by what the arm has done with it. A plan has
to begin in the state in which the one before is left, in time, with the parts of that world where they are; and what it
does not know it must not touch while it is executed, nor what may come on a stream unseen. Limits, collisions and
errors of each plan are judged as those of all answers are (`joints_kept`, `simulation`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise, product

import numpy as np

from benchmarks.judge.cell import Cell, grasp_of
from benchmarks.judge.faults import Violation, beyond
from benchmarks.judge.joints_kept import motion_kept
from benchmarks.judge.laws import seat, seat_then
from benchmarks.judge.motion import Motion, Phase
from benchmarks.judge.poses import Document, Floats, Poses, pose_in, short, si
from benchmarks.judge.product import as_si
from benchmarks.judge.simulation import FASTEST_M_S, FINER, STEP_S, simulated
from benchmarks.judge.slots_kept import PLACE_M, slots_kept, slots_of
from benchmarks.judge.solids import Solid, apart, gaps, middle, solid_of

JUMPS = (1e-9, 1e-7, 1e-5)
"""Most by which q, q̇ and q̈ may differ where one plan follows another, SI."""
PLACE_RAD, SOON_S = 1e-6, 1e-9
"""How exactly yaws and times of documents are the same."""
BEHIND_M = np.linspace(0.0, 1.0, 26)
"""How far behind the line parts are put that nobody has seen, m."""
AHEAD_S = 60.0
"""A part that is seen so much later is not near during a plan."""


@dataclass(eq=False)
class Executed:
    """A plan that was committed: proposed (`number`: of the call) and committed at these times of the clock, executed
    until `until_s`."""

    motion: Motion
    number: int
    proposed_s: float
    committed_s: float
    starts_s: float
    until_s: float = np.inf

    @property
    def cell(self) -> Cell:
        return self.motion.cell

    @property
    def proved_until_s(self) -> float:
        """To the end of the standstill; for ever where nothing moves by itself."""
        if not any(frame.moves for frame in self.cell.frames.values()):
            return np.inf
        return self.motion.end_s + float(self.motion.request.get("options", {}).get("stay_safe_s", 0.0))


@dataclass(frozen=True, eq=False)
class Sighting:
    """A part that was seen, by call `number` at `clock_s`: it was there at `seen_s`; frame and pose in it, what is not
    known of it, m and rad, and its solid."""

    name: str
    kind: str
    number: int
    clock_s: float
    seen_s: float
    frame: str
    pose: Poses
    unknown: Document
    solid: Solid


@dataclass(frozen=True, eq=False)
class Part:
    """A part of the world: on a frame, or in the gripper (`frame` None, pose in the flange); since when it is so."""

    frame: str | None
    pose: Poses
    since_s: float
    solid: Solid
    unknown: Document = field(default_factory=dict)


class Session:
    """What a log says: the plans that were executed, and when which part was seen and taken away."""

    def __init__(self, cell: Document, events: Sequence[Document]) -> None:
        first, self.document = events[0], cell
        self.planning_s = float(first["arguments"]["planning_ms"]) / 1e3
        self.refuge = cell["positions"][first["arguments"]["refuge"]]
        self.solids = {name: solid_of(kind["shape"]) for name, kind in cell.get("kinds", {}).items()}
        self.plans = [self._plan(first, 0, float(first["clock_s"]))]
        self.sightings: list[Sighting] = []
        self.removed: list[tuple[str, int, float]] = []
        """Parts that were taken away: by which call (those of a step: by none, 0), and when."""
        self.reached: list[tuple[float, float]] = []
        """Times to which the clock was set, and until when the motion was proved then."""
        proposed: dict[int, tuple[int, float]] = {}
        for number, event in enumerate(events):
            if "refused" in event:
                continue
            given, result, clock = event["arguments"], event["result"], event["clock_s"]
            if event["call"] == "see":
                self.sightings.append(self._sighting(number, given["name"], given["fields"], clock))
            elif event["call"] == "gone":
                self.removed.append((given["name"], number, clock))
            elif event["call"] == "propose":
                proposed[result["id"]] = number, clock
            elif event["call"] == "commit":
                made = self._plan(event, *proposed[given["number"]])
                self.plans = [each for each in self.plans if each.starts_s < made.starts_s]
                if self.plans:
                    self.plans[-1].until_s = made.starts_s
                self.plans.append(made)
            elif event["call"] == "advance":
                self.reached.append((given["to_s"], self.plans[-1].proved_until_s))
        self.ends_s = max([first["clock_s"], *[to_s for to_s, _ in self.reached]])
        begun = [each for each in self.plans if each.starts_s < self.ends_s]
        self.plans = [replace(each, until_s=min(each.until_s, self.ends_s)) for each in begun]

    def _plan(self, event: Document, number: int, proposed_s: float) -> Executed:
        result = event["result"]
        motion = Motion(as_si(result["request"]), result["answer"])
        return Executed(motion, number, proposed_s, event["clock_s"], result.get("starts_s", event["clock_s"]))

    def _sighting(self, number: int, name: str, fields: Document, clock_s: float) -> Sighting:
        cell, kind = self.plans[0].cell, self.document["kinds"][fields["kind"]] if "kind" in fields else fields
        stated = fields.get("pose", {})
        pose = {key: value for key, value in stated.items() if key in ("frame", "at_s")}
        there = pose_in(stated)
        if "slot" in fields:
            ((grid, counted),) = fields["slot"].items()
            there, of = [*slots_of(self.document["slots"][grid])][counted - 1], self.document["slots"][grid]
            while "body" in of:
                name_of_body = of["body"]
                of = next(each for each in self.document["bodies"] if each["name"] == name_of_body)["pose"]
                there = pose_in(of).then(there)
            pose |= {key: of[key] for key in ("frame",) if key in of}
        pose |= {"at_m": there.p.tolist(), "yaw_rad": float(there.yaw)}
        frame, inner = (seat_then if "at_s" in pose else seat)(cell.request, cell.frames, pose)
        off = {**kind.get("uncertainty", {}), **fields.get("uncertainty", {})}
        unknown = {key: float(si(off, key, 0.0)) for key in ("position", "vertical", "yaw")}
        named = fields.get("kind", "")
        seen_s, solid = float(pose.get("at_s", clock_s)), self.solids.get(named) or solid_of(kind["shape"])
        return Sighting(name, named, number, clock_s, seen_s, frame, inner, unknown, solid)


def broken_sessions(cell: Document, events: Sequence[Document], runs: int = 8) -> list[Violation]:
    """What is wrong with a session, by the calls of its log and its cell file; or with several, where each begins
    where the one before ends. Each plan is run so many times, with what is not known at its ends and at the worst
    corners that arrivals name."""
    found, before, used = list[Violation](), None, dict[tuple[str, str, int], str]()
    begins = [k for k, event in enumerate(events) if event["call"] == "session"]
    for begin, end in pairwise([*begins, len(events)]):
        session = Session(cell, events[begin:end])
        if before is not None:
            found += _follows(before.plans[-1], session.plans[0])
            found += beyond("start", "session", abs(session.plans[0].starts_s - before.ends_s), SOON_S, before.ends_s)
        found += _broken_session(session, runs) + slots_kept(session, used)
        before = session
    return found


def _broken_session(session: Session, runs: int) -> list[Violation]:
    found = _in_time(session)
    for number, plan in enumerate(session.plans):
        motion = plan.motion
        found += motion_kept(motion)
        outcome, _ = simulated(motion.request, motion.answer, runs, np.random.default_rng(number))
        for fault in outcome.faults:
            found.append(Violation(fault.kind, ", ".join(fault.about), fault.amount, fault.allowed, fault.time_s))
    world: dict[str, Part] = {}
    for number, plan in enumerate(session.plans):
        if number:
            found += _follows(session.plans[number - 1], plan)
        found += _ends_in_refuge(session, plan)
        _see(world, session, plan.starts_s)
        found += _same_world(session, world, plan)
        found += _untouched(session, world, plan)
        found += _clear_of_unseen(session, plan)
        world = _after(session, world, plan)
    return found


def _in_time(session: Session) -> list[Violation]:
    """No motion is decided late, and no instant is without a proof."""
    found = list[Violation]()
    for number, plan in enumerate(session.plans):
        found += beyond("late", f"commit {number}", plan.committed_s - plan.starts_s, SOON_S, plan.committed_s)
        if number:
            ready_s = plan.proposed_s + session.planning_s
            found += beyond("late", f"planning {number}", ready_s - plan.starts_s, SOON_S, plan.proposed_s)
        found += beyond("start", f"plan {number}", abs(plan.motion.start_s - plan.starts_s), SOON_S, plan.starts_s)
    for to_s, proved_s in session.reached:
        found += beyond("uncovered", "the clock", to_s - proved_s, SOON_S, to_s)
    return found


def _follows(one: Executed, other: Executed) -> list[Violation]:
    """The state of one plan, where it is left, is that in which the other begins."""
    found, at = list[Violation](), other.starts_s
    for order, (what, most) in enumerate(zip(("q", "q̇", "q̈"), JUMPS, strict=True)):
        left = _state(one.motion, at, order)
        found += beyond("jump", what, float(np.abs(left - _state(other.motion, at, order)).max()), most, at)
    return found


def _state(motion: Motion, at: float, order: int) -> Floats:
    inside = np.clip(at, motion.start_s, motion.end_s)
    rests = at > motion.end_s and order > 0
    return (
        np.zeros(motion.spline.coefficients.shape[1]) if rests else motion.spline.evaluate(np.array([inside]), order)[0]
    )


def _ends_in_refuge(session: Session, plan: Executed) -> list[Violation]:
    """The arm ends at rest in the refuge, with any yaw."""
    motion, end = plan.motion, np.array([plan.motion.end_s])
    there = motion.frame(session.refuge.get("frame", "world"), end).then(pose_in(session.refuge))
    off = float(np.linalg.norm(motion.tool(end).p - there.p))
    fast = float(np.abs(motion.spline.evaluate(end, 1)).max())
    return [*beyond("refuge", "place", off, 1e-5, end[0]), *beyond("refuge", "speed", fast, JUMPS[1], end[0])]


def _see(world: dict[str, Part], session: Session, until_s: float, since_s: float = -np.inf) -> None:
    """The world with what was seen and taken away, after one time of the clock and up to another."""
    for each in session.sightings:
        before = world.get(each.name)
        if since_s < each.clock_s <= until_s and (before is None or before.since_s <= each.seen_s):
            world[each.name] = Part(each.frame, each.pose, each.seen_s, each.solid, each.unknown)
    for name, _, clock_s in session.removed:
        if since_s < clock_s <= until_s and name in world and world[name].since_s <= clock_s:
            del world[name]


def _same_world(session: Session, world: dict[str, Part], plan: Executed) -> list[Violation]:
    """A plan has the parts that are there, where they are, known no better than they were seen."""
    cell, at, found = plan.cell, plan.starts_s, list[Violation]()
    own = {body["name"] for body in session.document.get("bodies", [])}
    listed = {body["name"] for body in plan.motion.request.get("bodies", [])} - own
    known = {each.name for each in session.sightings if each.number < plan.number}
    later = {name for name, number, _ in session.removed if number > plan.number}
    for name in sorted((world.keys() & known) - listed):
        found.append(Violation("parts", f"{name} is left out", 1.0, 0.0, at))
    for name in sorted(listed - world.keys() - later):
        found.append(Violation("parts", f"{name} is not there", 1.0, 0.0, at))
    holding = None if cell.held is None else cell.held[0]
    held = next((name for name, part in world.items() if part.frame is None), None)
    if holding != held:
        found.append(Violation("parts", f"{holding} is held by the plan, {held} by the arm", 1.0, 0.0, at))
    newer = {each.name for each in session.sightings if each.number > plan.number and each.clock_s <= at}
    for name in sorted((listed & world.keys()) - newer):
        part = world[name]
        if part.frame is None:
            planned, real = cell.held[1] if cell.held is not None and holding == name else None, part.pose
        else:
            frame, pose = cell.seats.get(name, (None, None))
            planned = None if pose is None else cell.frames[str(frame)].at(np.array(at)).then(pose)
            real = cell.frames[part.frame].at(np.array(at)).then(part.pose)
        if planned is None:
            continue
        off, turned = float(np.linalg.norm(planned.p - real.p)), float(abs(short(planned.yaw - real.yaw)))
        found += beyond("place", name, off, PLACE_M, at) + beyond("yaw", name, turned, PLACE_RAD, at)
        for key, unit in (("position", "m"), ("vertical", "m"), ("yaw", "rad")):
            stated = float(cell.unknown_of.get(name, {}).get(f"{key}_{unit}", 0.0))
            found += beyond("known", f"{name}, {key}", part.unknown.get(key, 0.0) - stated, 1e-9, at)
    return found


def _untouched(session: Session, world: dict[str, Part], plan: Executed) -> list[Violation]:
    """While a plan is executed the arm touches no part that the plan does not know: one that is seen later was there
    before, on its frame."""
    there = {name: part for name, part in world.items() if part.frame is not None}
    for each in session.sightings:
        if each.name not in there and plan.starts_s < each.clock_s <= plan.until_s + AHEAD_S and each.name not in world:
            there[each.name] = Part(each.frame, each.pose, each.seen_s, each.solid)
    listed = {body["name"] for body in plan.motion.request.get("bodies", [])}
    left = {name: time for name, _, time in session.removed if time < plan.until_s}
    alike = dict[tuple[Solid, str, float], list[str]]()
    for name in sorted(there.keys() - listed):
        alike.setdefault((there[name].solid, str(there[name].frame), left.get(name, np.inf)), []).append(name)
    others = []
    for (solid, frame, until_s), names in alike.items():
        places = [there[name].pose for name in names]
        poses = Poses(np.stack([each.r for each in places]), np.stack([each.p for each in places]))
        others.append(Other(names, solid, frame, poses, until_s))
    return hits(plan.motion, looks(plan.motion, plan.starts_s, plan.until_s), others)


def _clear_of_unseen(session: Session, plan: Executed) -> list[Violation]:
    """While a plan is executed the arm touches no part that may come on a stream and was not reported when the plan was
    proposed: at the line then, less the latency, or behind it, at both ends of its lane and of its yaw."""
    others, cell = list[Other](), plan.cell
    for name, stream in session.document.get("streams", {}).items():
        seen, at = stream["seen"], si(stream, "at", (0.0, 0.0, 0.0))
        at_s = plan.proposed_s - float(si(seen, "latency", 0.0))
        lanes = np.unique(si(stream, "lanes", si(stream, "lane", (0.0,))))
        yaws = np.unique(si(stream, "yaw", (0.0,)))
        for kind in [stream["kind"]] if "kind" in stream else stream["kinds"]:
            given = session.document["kinds"][kind]
            off = cell.frames[stream["frame"]].unknown.get("speed_m_s", 0.0) * float(si(seen, "latency", 0.0))
            ahead = float(si(given.get("uncertainty", {}), "position", 0.0)) + off
            x = float(si(seen, "at")) + ahead - BEHIND_M
            where = np.array([(*place, at[2]) for place in product(x, at[1] + lanes, yaws)])
            pose = {"frame": stream["frame"], "at_m": where[:, [0, 1, 3]], "yaw_rad": where[:, 2], "at_s": at_s}
            frame, inner = seat_then(cell.request, cell.frames, pose)
            others.append(Other([f"unseen {kind} on {name}"] * len(where), session.solids[kind], frame, inner))
    return hits(plan.motion, looks(plan.motion, plan.starts_s, plan.until_s), others)


@dataclass(frozen=True, eq=False)
class Other:
    """Solids of one shape that a plan does not know, at poses (K,) in a frame, until they are taken away."""

    names: list[str]
    solid: Solid
    frame: str
    poses: Poses
    until_s: float = np.inf


@dataclass(frozen=True, eq=False)
class Look:
    """Instants `t` (K,) of a phase, s, and where robot, tool and what is held are then."""

    phase: Phase
    t: Floats
    places: dict[str, Poses]


def looks(motion: Motion, from_s: float, until_s: float) -> list[Look]:
    """All phases of a motion between two times, at instants that are `STEP_S` apart."""
    found = list[Look]()
    for phase in motion.phases:
        begin = max(phase.stage.t0, from_s)
        end = until_s if phase.leg is None else min(phase.stage.t1, until_s)
        if begin < end:
            t = np.linspace(begin, end, max(int(np.ceil((end - begin) / STEP_S)), 1) + 1)
            found.append(Look(phase, t, motion.bodies(phase, t, set(phase.carried))))
    return found


def hits(motion: Motion, seen: list[Look], others: Sequence[Other]) -> list[Violation]:
    """How deep the robot, its tool and what it holds overlap with solids on frames."""
    found = list[Violation]()
    for look in seen:
        for other in others:
            now = look.t <= other.until_s
            frame = motion.frame(other.frame, look.t)
            middles = frame.points(middle(other.solid, other.poses)[:, None])
            for body, at in look.places.items():
                own = motion.cell.solids[body]
                near = (apart(own, middle(own, at), other.solid, middles) < FASTEST_M_S * STEP_S) & now
                for row in np.flatnonzero(near.any(axis=1)):
                    pose, there = other.poses[row], near[row]
                    gap = gaps(own, at[there], other.solid, frame[there].then(pose), 0.0)
                    k = int(np.flatnonzero(there)[gap.argmin()])
                    span = look.t[0], min(look.t[-1], other.until_s)
                    finer = np.clip(look.t[k] + np.linspace(-STEP_S, STEP_S, 2 * FINER + 1), *span)
                    place = motion.bodies(look.phase, finer, {body})[body]
                    deep = -gaps(own, place, other.solid, motion.frame(other.frame, finer).then(pose), 0.0)
                    worst = int(deep.argmax())
                    about = f"{body}, {other.names[row]}"
                    found += beyond("hit", about, float(deep[worst]), PLACE_M, float(finer[worst]))
    return found


def _after(session: Session, world: dict[str, Part], plan: Executed) -> dict[str, Part]:
    """The world when a plan is left: parts that it has picked and put down by then, and those that have gone."""
    motion, world = plan.motion, dict(world)
    clock = plan.starts_s
    for arrival in motion.answer["arrivals"]:
        until = float(arrival["until_s"])
        if until > plan.until_s:
            break
        ((kind, given),) = motion.request["task"][arrival["step"]].items()
        if kind not in ("pick", "place"):
            continue
        _see(world, session, until, clock)
        clock, name = until, given["part"]
        if name not in world:
            continue
        if kind == "pick":
            grasp = grasp_of(given, arrival["yaw_offset_rad"])
            world[name] = replace(world[name], frame=None, pose=motion.arm.tcp.then(grasp.inverse()), since_s=until)
            continue
        frame, pose = motion.cell.seat(given["to"])
        world[name] = replace(world[name], frame=frame, pose=pose, since_s=until, unknown={})
        if "gone_after_s" in given:
            session.removed.append((name, 0, until + float(given["gone_after_s"])))
    _see(world, session, plan.until_s, clock)
    return world
