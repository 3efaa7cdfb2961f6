"""How far the tool may be from its control point: the worst of all that a request does not know (equation N15).

The error is part less tool. What a frame, a late start and lagging joints add has a direction each, so the worst is one
of the combinations of their signs: all are evaluated. What is the same in every horizontal direction adds to the
longest of them. A point that joints move by small angles leaves the straight line of their Jacobian by half the bound
of its acceleration at most, which is added.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Motion, Pose, Sweep
from assur.planner.laws.law import EXACT, PoseUncertainty
from assur.planner.model.arrival_error import ArrivalError, Cause, Share
from assur.planner.model.attachments import Attachments
from assur.planner.model.phases import GraspUncertainty, on_way
from assur.planner.model.refusal import Inaccurate, Quantity, Reason, Refusal, Stage
from assur.planner.model.scene import Pick, Place, Scene, Trace

RESERVE_M, RESERVE_RAD = 2e-6, 2e-6
"""Added to what is found: the tool meets its point within 1 µm and 1 µrad, and the checker has bounds of its own."""
LEAST = 1e-12
"""m or rad. Less than this is rounding, and no error."""
LATE_STEPS = 16
"""Parts of the time by which a start may be late, at whose ends a frame's way is evaluated."""
UP = np.array([0.0, 0.0, 1.0])
LATE, DIRECTION = "late start s", "direction rad"
"""Names in a realisation: by how much the robot is late, s; the direction of what is the same in all horizontal ones,
rad in the world."""


@dataclass(eq=False)
class _Terms:
    """What adds to an error: `signed` vectors (3,) that count with either sign, by name and cause; the way of the frame
    for late starts, `late` (K, 3), with its times (K,); (radius, height, yaw) that count in full, by cause."""

    signed: list[tuple[Cause, str, FloatArray]] = field(default_factory=list)
    late: FloatArray = field(default_factory=lambda: np.zeros((1, 3)))
    late_s: FloatArray = field(default_factory=lambda: np.zeros(1))
    full: dict[Cause, FloatArray] = field(default_factory=dict)

    @property
    def whole(self) -> list[float]:
        """Radius, height and yaw that count in full, of all causes."""
        return [float(each) for each in sum(self.full.values(), np.zeros(3))]

    def only(self, cause: Cause) -> _Terms:
        """Those of one cause."""
        signed = [each for each in self.signed if each[0] is cause]
        full = {cause: self.full[cause]} if cause in self.full else {}
        return _Terms(signed, self.late, self.late_s, full) if cause is Cause.LATE else _Terms(signed, full=full)

    def combined(self) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """All combinations of signs (S, N), and for each and each lateness the sum of all vectors (S, K, 3), how far it
        is off on the level and along the vertical (S, K), m, with what counts in full."""
        signs = _signs(len(self.signed))
        vectors = np.array([vector for _, _, vector in self.signed]).reshape(-1, 3)
        sums, (flat, upright, _) = (signs @ vectors)[:, None, :] + self.late[None, :, :], self.whole
        return signs, sums, np.hypot(sums[..., 0], sums[..., 1]) + flat, np.abs(sums[..., 2]) + upright

    def add(self, cause: Cause, flat: float = 0.0, upright: float = 0.0, yaw: float = 0.0) -> None:
        if max(flat, upright, yaw) > 0.0:
            self.full[cause] = self.full.get(cause, np.zeros(3)) + np.array([flat, upright, yaw])

    def add_signed(self, cause: Cause, name: str, vector: FloatArray) -> None:
        if vector.any():
            self.signed.append((cause, name, vector))


def arrival_error(
    scene: Scene, number: int, attached: Attachments, handled: GraspUncertainty, q: FloatArray, until: float
) -> ArrivalError | None:
    """How far the tool may be from the control point of step `number` at time `until`, s, with joints at q (n,); None
    where nothing is left open."""
    return None if scene.exact else _worst(*_terms_of(scene, number, attached, handled, q, until))


def realised(
    scene: Scene, number: int, attached: Attachments, handled: GraspUncertainty, q: FloatArray, until: float,
    worst: Mapping[str, float],
) -> float | None:  # fmt: skip
    """How far the tool is from the control point of step `number`, m, in a realisation as `ArrivalError.worst` states
    it; None: it is none of what is uncertain there. The rest: as `arrival_error`."""
    terms, grasp = _terms_of(scene, number, attached, handled, q, until)
    flat, upright, yaw = terms.whole
    names = [name for _, name, _ in terms.signed]
    names += [LATE] * (len(terms.late_s) > 1) + [DIRECTION] * (flat > LEAST)
    if sorted(names) != sorted(worst) or any(abs(worst[name]) != 1.0 for _, name, _ in terms.signed):
        return None
    late = worst.get(LATE, 0.0)
    if not terms.late_s[0] - LEAST <= late <= terms.late_s[-1] + LEAST:
        return None
    off = sum((worst[name] * vector for _, name, vector in terms.signed), np.zeros(3))
    off = off + np.array([np.interp(late, terms.late_s, terms.late[:, k]) for k in range(3)])
    way = worst.get(DIRECTION, 0.0)
    level = math.hypot(off[0] + flat * math.cos(way), off[1] + flat * math.sin(way))
    return math.hypot(level, abs(float(off[2])) + upright) + yaw * grasp


def _terms_of(
    scene: Scene, number: int, attached: Attachments, handled: GraspUncertainty, q: FloatArray, until: float
) -> tuple[_Terms, float]:
    """What adds to the error at a control point, and how far the tool point is from the part's axis, m."""
    step, terms = scene.task[number], _Terms()
    name, local = attached.point(scene, step)
    if isinstance(step, Trace):
        local = step.end  # where the tool is when it is done
    here = scene.frames[name].law.motion(np.array(until)).at(local)
    corrected = step.tracks and scene.corrects_all(name)
    _add_frame(scene, name, here, until, corrected, terms)
    if not step.tracks:
        _add_correction(scene, [belt for belt in on_way(scene, number) if belt != name], until, terms)
    _add_late(scene, name, local, until, terms)
    _add_lag(scene, here, q, terms)
    if isinstance(step, Pick):
        known = handled.of(step.part) or scene.index[step.part].uncertainty
        terms.add(Cause.PART, known.position_m, known.vertical_m, known.yaw_rad)
    if isinstance(step, Place):
        held = handled.of(step.part) or EXACT
        terms.add(Cause.GRIP, held.position_m, held.vertical_m, held.yaw_rad)
    grasp = step.grasp if isinstance(step, Pick) else Pose()
    return terms, math.hypot(grasp.x, grasp.y)


def _add_frame(scene: Scene, name: str, here: Motion, until: float, corrected: bool, terms: _Terms) -> None:
    frame = scene.frames[name]
    known, along = frame.uncertainty, frame.law.line
    lasts = max(until + scene.execution.start_tolerance_s - scene.start.time, 0.0)
    amount = 0.0 if corrected else known.position_m + known.speed_m_s * lasts
    if along is None:
        terms.add(Cause.FRAME, amount + known.lateral_m)
    else:
        level = math.hypot(along[0], along[1])
        terms.add_signed(Cause.FRAME, f"{name} along", amount * along)
        if level > 0.0:
            terms.add_signed(Cause.FRAME, f"{name} across", known.lateral_m / level * _across(along))
        else:
            terms.add(Cause.FRAME, known.lateral_m)
    terms.add_signed(Cause.FRAME, f"{name} up", known.vertical_m * UP)
    if known.yaw_rad > 0.0:
        arm = here.p - frame.law.motion(np.array(until)).p
        terms.add_signed(Cause.FRAME, f"{name} turned", known.yaw_rad * _across(arm))
        # a turn by an angle leaves the tangent by less than half its square
        far = math.hypot(float(arm[0]), float(arm[1]))
        terms.add(Cause.FRAME, 0.5 * far * known.yaw_rad**2, yaw=known.yaw_rad)


def _across(vector: FloatArray) -> FloatArray:
    """The vertical times a vector (3,)."""
    return np.array([0.0 - vector[1], vector[0], 0.0])


def _add_correction(scene: Scene, belts: list[str], until: float, terms: _Terms) -> None:
    """How far a controller that corrects for belts may have shifted the tool, which is on its way from or to them."""
    lasts = max(until + scene.execution.start_tolerance_s - scene.start.time, 0.0)
    for name in belts:
        known, along = scene.frames[name].uncertainty, scene.frames[name].law.line
        if along is not None:
            terms.add_signed(Cause.FRAME, f"{name} along", -(known.position_m + known.speed_m_s * lasts) * along)


def _add_late(scene: Scene, name: str, local: Pose, until: float, terms: _Terms) -> None:
    """How far the point goes on while the robot is late, or the frame's whole motion is shifted in time."""
    frame = scene.frames[name]
    early, late = -frame.uncertainty.shift_s[1], scene.execution.start_tolerance_s - frame.uncertainty.shift_s[0]
    if frame.law.is_fixed or not late > early:
        return
    times = np.unique(np.append(np.linspace(early, late, LATE_STEPS + 1), 0.0))
    way = frame.law.motion(until + times).at(local)
    here = frame.law.motion(np.array(until)).at(local)
    terms.late, terms.late_s = way.p - here.p, times
    swept = frame.law.sweep(until + early, until + late)
    between = float(np.diff(times).max())
    bend = float(swept.point(2, local.x, local.y, local.z).max())
    turned = float(np.abs(way.yaw - here.yaw).max()) + swept.turning(1) * between / 2.0
    bow = math.sqrt(3.0) * bend * between**2 / 8.0
    terms.add(Cause.LATE, bow, bow, turned if np.any(way.yaw != here.yaw) else 0.0)


def _add_lag(scene: Scene, here: Motion, q: FloatArray, terms: _Terms) -> None:
    """How far joints that lag move the tool at the point."""
    execution, robot = scene.execution, scene.robot
    if not execution.lags:
        return
    flange, none = len(robot.links) - 1, np.zeros_like(q)
    still = robot.link_motion(flange, q, none, none, none)
    at = Pose(yaw=-float(still.yaw)).then(
        Pose(*(float(a - b) for a, b in zip(here.p, still.p, strict=True)))
    )  # the point in the flange
    if "pitch" in robot.coordinates or robot.tilting:
        at = Pose()
    for j, amount in enumerate(execution.lag):
        if amount > 0.0:
            rate = none.copy()
            rate[j] = amount
            moved = robot.link_motion(flange, q, rate, none, none).at(at)
            terms.add_signed(Cause.LAG, robot.joints[j].name, -moved.v)
    lag = np.array(execution.lag)
    joints = np.column_stack([q, lag, none, lag, none, none])
    swept = robot.sweep(joints, flange)
    bend = float(np.linalg.norm(swept.point(2, at.x, at.y, at.z)))
    # twice for each half of the bow: the checker bounds the bent way from its ends
    bow = 1.5 * math.sqrt(2.0) * bend
    turn = 0.0 if robot.tilting else _turned(scene, q, lag, swept)
    terms.add(Cause.LAG, bow, bow if robot.tilting else 0.0, turn)


def _turned(scene: Scene, q: FloatArray, lag: FloatArray, swept: Sweep) -> float:
    """How far joints that lag turn the tool, rad: the heading of a closed chain is bent as well."""
    if scene.robot.yaw_joints is not None:
        return float(lag[list(scene.robot.yaw_joints)].sum())
    corners = scene.robot.forward(q + lag * _signs(len(lag)))[1] - scene.robot.forward(q)[1]
    most = float(np.abs(np.remainder(corners + np.pi, 2.0 * np.pi) - np.pi).max())
    # more than the bow of a heading: the checker bounds its cosine and its sine apart, over all of the lag
    return most + 2.0 * math.sqrt(2.0) * (swept.turning(2) + swept.turning(1) ** 2)


def _worst(terms: _Terms, grasp: float) -> ArrivalError:
    """The worst combination of signs and lateness, and what each cause adds at most."""
    (signs, sums, level, height), (flat, _, yaw) = terms.combined(), terms.whole
    size = np.hypot(level, height)
    row, k = np.unravel_index(int(size.argmax()), size.shape)
    worst = [(name, float(sign)) for (_, name, _), sign in zip(terms.signed, signs[row].tolist(), strict=True)]
    if len(terms.late_s) > 1:
        worst.append((LATE, float(terms.late_s[k])))
    if flat > LEAST:
        worst.append((DIRECTION, math.atan2(float(sums[row, k, 1]), float(sums[row, k, 0]))))
    position = float(size.max()) + yaw * grasp
    within = PoseUncertainty(
        float(level.max()) + RESERVE_M if level.max() > LEAST else 0.0,
        float(height.max()) + RESERVE_M if height.max() > LEAST else 0.0,
        yaw + RESERVE_RAD if yaw > LEAST else 0.0,
    )
    return ArrivalError(position + RESERVE_M if position > LEAST else 0.0, within, _shares(terms), tuple(worst))


@cache
def _signs(count: int) -> FloatArray:
    """All combinations of count signs (2^count, count)."""
    numbers = np.arange(2**count)[:, None] >> np.arange(count)[None, :]
    signs = np.asarray(1.0 - 2.0 * (numbers & 1), dtype=np.float64)
    signs.flags.writeable = False
    return signs


def _shares(terms: _Terms) -> tuple[Share, ...]:
    found = []
    for cause in Cause:
        one = terms.only(cause)
        if not (one.signed or one.full or one.late.any()):
            continue
        _, _, level, height = one.combined()
        position, yaw = float(np.hypot(level, height).max()), one.whole[2]
        if position > LEAST or yaw > LEAST:
            found.append(Share(cause, position, yaw))
    return tuple(sorted(found, key=lambda share: (-share.position_m, -share.yaw_rad)))


def too_far(scene: Scene, number: int, error: ArrivalError | None) -> Refusal | None:
    """Whether the tool may be farther off than a step allows."""
    allowed = scene.task[number].tolerance
    if error is None or (error.position_m <= allowed.position_m and error.within.yaw_rad <= allowed.yaw_rad):
        return None
    far = error.position_m > allowed.position_m
    worst = max(error.shares, key=lambda share: share.position_m if far else share.yaw_rad)
    amount = error.position_m - allowed.position_m if far else error.within.yaw_rad - allowed.yaw_rad
    return Refusal(
        stage=Stage.TRACKING,
        reason=Reason.TOLERANCE,
        step=number,
        amount=Quantity.of(amount, "m" if far else "rad"),
        facts=Inaccurate(
            position_m=error.position_m,
            yaw_rad=error.within.yaw_rad,
            allowed_m=None if math.isinf(allowed.position_m) else allowed.position_m,
            allowed_rad=None if math.isinf(allowed.yaw_rad) else allowed.yaw_rad,
            cause=worst.cause,
            most=worst.position_m if far else worst.yaw_rad,
        ),
    )
