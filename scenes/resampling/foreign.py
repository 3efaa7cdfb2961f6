"""A motion from another program: whether it keeps the limits and the clearances, as one motion in travel.

It has no legs, so nothing is gripped or released: a part that is held at the start stays held, nothing may touch, and
the clearances are those of travel. It is a claim like that of a plan, with one phase and without points, and both
checkers judge it. The planner only searches the first violation, and the smallest clearance.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from assur.planner.checked import check, check_motion
from assur.planner.checker.verdict import Code, Finding
from assur.planner.collision.nearest import nearest
from assur.planner.collision.proof import Prover
from assur.planner.collision.rows import ProofFailure, Rows, written
from assur.planner.kernels.limits import NONE, first_limit_broken
from assur.planner.kernels.proof import ROW_COLUMNS
from assur.planner.model.attachments import at_start
from assur.planner.model.outcome import Arrival, Leg, LegKind, Nearest, Plan
from assur.planner.model.phases import Phase, handled_at_start, phases, stay_phases
from assur.planner.model.scene import Scene
from assur.planner.robots.facts import Limits
from assur.planner.trajectory import Trajectory, accepted_bands
from assur.scenes.resampling.certifying import kept_legs, unproved

REST = 1e-9
"""A joint slower than this is at rest, rad/s or m/s (and rad/s², m/s²): in an hour it goes 4 µm."""
NARROW_S = 1e-3
"""s. How exact the time of the first violation is: before that time less this, nothing is violated."""
SETTLING_S = 1e-3
"""s. Time in which a motion that ends nearly at rest comes to rest."""
RATES = ("position", "velocity", "acceleration", "jerk")


@dataclass(frozen=True, slots=True)
class Violation:
    """The first violation: `what`, at `time`, by how much (None: not proved, and not violated for certain); the pair
    that comes too near, or the joint."""

    what: str
    time: float
    amount: float | None
    unit: str
    bodies: tuple[str, str] | None = None
    joint: int | None = None


@dataclass(frozen=True)
class MotionVerdict:
    """The verdict on a motion: without findings it is proved. `clearance`: where the arm, its tool or its part comes
    nearest to a body, without uncertainties; None if no pair has a clearance, or the motion is not known."""

    findings: tuple[Finding, ...]
    first: Violation | None
    clearance: Nearest | None


def brought_to_rest(trajectory: Trajectory) -> Trajectory:
    """The motion, and `SETTLING_S` in which its last speed, up to `REST`, goes to 0, so that it is at rest afterwards.
    A motion that ends exactly at rest, or clearly in motion, is not changed."""
    if trajectory.rest_at_end or not ends_at_rest(trajectory):
        return trajectory
    still = np.zeros((1, trajectory.n))
    return Trajectory(
        np.append(trajectory.time, trajectory.end + SETTLING_S),
        np.concatenate([trajectory.q, trajectory.q[-1:]]),
        np.concatenate([trajectory.qd, still]),
        np.concatenate([trajectory.qdd, still]),
        jumps=trajectory.jumps,
    )


def travel(scene: Scene, trajectory: Trajectory) -> tuple[Phase, ...]:
    """The phases of a motion without legs: one in travel, and the standstill behind it that the request asks for, if
    the motion ends at rest."""
    attached, handled = at_start(scene), handled_at_start(scene)
    one = Phase(trajectory.start, trajectory.end, LegKind.MOVE, 0, attached, handled=handled)
    rest = stay_phases(scene, trajectory.end, attached, handled, ()) if ends_at_rest(trajectory) else []
    return (one, *(phase for phase in rest if phase.robot))


def ends_at_rest(trajectory: Trajectory) -> bool:
    """Whether the last knot is at rest up to `REST`, as the checker judges the end of a plan."""
    return bool((np.abs(trajectory.qd[-1]) <= REST).all() and (np.abs(trajectory.qdd[-1]) <= REST).all())


@np.errstate(all="ignore")
def judged(scene: Scene, trajectory: Trajectory, plan: Plan | None = None) -> MotionVerdict:
    """Whether a motion of the robot of `scene` keeps the limits and keeps everything apart. Its times are those of the
    scene's clock; it may be late by what the scene says (`start_tolerance_s`), and its joints may lag as that says.

    `plan`: whose legs the motion has, and whose arrivals it promises; None: it is one motion in travel.
    """
    trajectory = brought_to_rest(trajectory)
    legs: tuple[Leg, ...] = (Leg(LegKind.MOVE, 0, trajectory.start, trajectory.end),)
    arrivals: tuple[Arrival, ...] = ()
    if plan is None:
        of_motion = travel(scene, trajectory)
    else:
        legs, arrivals = kept_legs(plan, trajectory)
        of_motion = phases(scene, legs, arrivals)
    prover, proofs, resisted = Prover(scene), list[Rows](), None
    for phase in of_motion:
        rows = prover.prove(phase, trajectory)
        if isinstance(rows, ProofFailure):
            resisted = phase, rows
            break
        proofs.append(rows)
    none = Rows(prover.of(of_motion[0]), np.zeros((0, ROW_COLUMNS)))
    made = Plan(trajectory, legs, arrivals, written(scene, trajectory, legs, arrivals, proofs or [none]))
    over = beyond(scene, of_motion, trajectory)
    first = [] if over is None else [over]
    findings = [
        Finding(Code.LIMIT, each.what, float(each.amount or 0.0), each.unit, f"{each.time:.6g} s") for each in first
    ]
    if resisted is not None:
        earliest = _earliest(prover, *resisted, trajectory)
        findings.append(unproved(earliest, "travel" if plan is None else resisted[0].kind))
        amount = None if earliest.gap > earliest.required else earliest.required - earliest.gap
        first.append(Violation(findings[-1].what, earliest.time, amount, "m", earliest.bodies))
    else:
        verdict = check_motion(_ending(scene, trajectory), made, of_motion) if plan is None else check(scene, made)
        findings += [each for each in verdict.findings if not (first and each.code == Code.LIMIT)]
    if plan is None:
        findings += _still_moving(scene, trajectory)
    clearance = nearest(prover, trajectory, of_motion, of="arm")
    return MotionVerdict(tuple(findings), min(first, key=lambda each: each.time, default=None), clearance)


def _ending(scene: Scene, trajectory: Trajectory) -> Scene:
    """The scene with the end of a motion: after a motion that does not end at rest nothing is claimed. Blends have to
    end at rest."""
    moving = scene.options.jerk_limited and not ends_at_rest(trajectory)
    return replace(scene, options=replace(scene.options, end="moving")) if moving else scene


def _still_moving(scene: Scene, trajectory: Trajectory) -> list[Finding]:
    """A finding for a motion that shall end at rest and does not: after its end the place of the arm is not known."""
    if scene.options.end != "rest" or ends_at_rest(trajectory):
        return []
    fastest = max(float(np.abs(rate[-1]).max()) for rate in (trajectory.qd, trajectory.qdd))
    what = "the last point is not at rest: nothing after the end is proved"
    return [Finding(Code.END, what, fastest - REST, "1/s, 1/s²", f"{trajectory.end:.6g} s")]


def _earliest(prover: Prover, phase: Phase, resisted: ProofFailure, trajectory: Trajectory) -> ProofFailure:
    """The first part that cannot be proved, up to `NARROW_S`: the phase before that time less this is proved."""
    low, high, found = phase.t0, min(max(resisted.time, phase.t0), phase.t1), resisted
    while high - low > NARROW_S:
        middle = (low + high) / 2.0
        rows = prover.prove(replace(phase, t0=low, t1=middle), trajectory)
        if isinstance(rows, ProofFailure):
            high, found = min(middle, rows.time), rows
        else:
            low = middle
    return found


def beyond(scene: Scene, of_motion: tuple[Phase, ...], trajectory: Trajectory) -> Violation | None:
    """The first piece on which a joint exceeds a limit, with the load that is carried then; None: none does."""
    for phase in of_motion:
        first = max(int(np.searchsorted(trajectory.time, phase.t0, side="right")) - 1, 0)
        last = min(int(np.searchsorted(trajectory.time, phase.t1)), len(trajectory.time) - 1)
        if last > first:
            found = _beyond(scene, phase.attached.limits(scene), trajectory, first, last)
            if found is not None:
                return found
    return None


def _beyond(scene: Scene, own: Limits, trajectory: Trajectory, low: int, high: int) -> Violation | None:
    """The same between two knots, with these limits."""
    jerk = None if trajectory.jumps else own.jerk
    bands = accepted_bands(own.lower, own.upper, own.velocity, own.acceleration, jerk)
    knots = trajectory.knots
    if first_limit_broken(np.ascontiguousarray(knots[low : high + 1]), bands) == NONE:
        return None
    while high - low > 1:
        middle = (low + high) // 2
        if first_limit_broken(np.ascontiguousarray(knots[low : middle + 1]), bands) == NONE:
            low = middle
        else:
            high = middle
    kind, joint = divmod(int(first_limit_broken(np.ascontiguousarray(knots[low : high + 1]), bands)), trajectory.n)
    columns = (trajectory.time, trajectory.q, trajectory.qd, trajectory.qdd)
    least, most = Trajectory(*(each[low : high + 1] for each in columns), jumps=trajectory.jumps).extrema(kind)
    over = max(float(most[joint] - bands[kind, 1, joint]), float(bands[kind, 0, joint] - least[joint]))
    unit = ("rad" if scene.robot.joints[joint].kind == "revolute" else "m") + ("", "/s", "/s²", "/s³")[kind]
    what = f"{scene.robot.joints[joint].name} breaks its {RATES[kind]} limit"
    if kind and getattr(own, RATES[kind])[joint] != getattr(scene.robot.limits, RATES[kind])[joint]:
        what += " with the load that is carried"
    return Violation(what, float(trajectory.time[low]), over, unit, joint=joint)
