"""The check of a claim from its form to its verdict: everything that it says is shown, or it is refused."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.checker.claim import tables as tb
from assur.planner.checker.claim.chain import frame_over
from assur.planner.checker.claim.enclosure import first_within, link_rows, open_body
from assur.planner.checker.claim.form import FITS, MISFITS, bound_name, bounds, misfit, wrong_table
from assur.planner.checker.claim.joint_bounds import KEPT, NO_LIMITS, first_joint_beyond
from assur.planner.checker.claim.motion import make_curves, make_laws
from assur.planner.checker.claim.obligations import make_pairs, number_bodies, require_second
from assur.planner.checker.claim.points import ERRORS
from assur.planner.checker.claim.rows import first_uncovered, first_wrong_row, resolve
from assur.planner.checker.claim.solids import place_solids
from assur.planner.checker.claim.tables import F1, F2, I1, f8, i8
from assur.planner.checker.claim.tool import claim_holds
from assur.planner.checker.verdict import Code
from assur.planner.claim import columns as c
from assur.planner.claim.columns import Claim
from assur.planner.compiled import kernel, types

MOST_WORK = 4_000_000
"""Work after which a claim is refused, some seconds: rows on parts of intervals, parts of limits and points, possible
pairs of bodies, tens of pieces of motions, and tens of triangles about a point."""
MOST_FINDINGS = 8
"""Findings after which a check ends."""


KNOTS, PHASES, LIMIT, ROW, COVER, WITHIN, GAP_ROW, GAP_COVER, MUCH, FORM = range(ERRORS + 1, ERRORS + 11)
KINDS = (
    (Code.POINT, "points", "the tool is not at its point, or does not move with it"),
    (Code.RATE, "rates", "the tool is faster or slower, or accelerates harder, than is claimed"),
    (Code.DIRECTION, "axes", "an axis, or the way to a point, is not within its directions"),
    (Code.GUIDE, "guides", "the tool leaves its way"),
    (Code.CORRECTION, "phases", "a joint or the arm leaves its range while a correction shifts the tool"),
    (Code.JOINTS, "sums", "a sum of joints, or a derivative of it, is not within its bounds"),
    (Code.DISTANCE, "distances", "two bodies may be farther apart than is claimed"),
    (Code.ERROR, "errors", "the tool may be farther from its point than is claimed"),
    (Code.MOTION, "", "times of knots go back, or the motion jumps"),
    (Code.PHASE, "", "phases have gaps, end too early, or the robot need not keep clear while it moves"),
    (Code.LIMIT, "joints", "a limit is not kept"),
    (Code.ROW, "rows", "a row does not hold"),
    (Code.COVER, "phases", "no rows for all of the time"),
    (Code.CONTAINMENT, "phases", "nothing shows that one is not within the other"),
    (Code.NEAREST, "gap_rows", "the smallest clearance is not shown"),
    (Code.NEAREST, "phases", "the smallest clearance is not shown"),
    (Code.WORK, "", "more work than is allowed"),
    (Code.FORM, "", "tables do not fit together"),
)
"""Of what kernels report by number: the code, the table of the row that it is about, and what is not shown."""
FINDING_KIND, FINDING_ROW, FINDING_WHEN, FINDING_AMOUNT, FINDING = range(5)
"""Columns of a finding as kernels have it: one of the numbers above; the row, the joint or the pair that it is about; a
time; and an amount."""


class ClaimFinding(NamedTuple):
    """One thing that is not shown: `what` in words; the table and the row that it is about ("": none; "joints": a joint
    of the robot); bodies (-1: whatever never moves); from which time on, s, and by how much, m (NaN: no number)."""

    code: Code
    what: str
    table: str = ""
    row: int = -1
    bodies: tuple[int, ...] = ()
    when: float = math.nan
    amount: float = math.nan


class ClaimVerdict(NamedTuple):
    """Whether all of a claim is shown, and what is not. Counts: rows that were needed, pairs of bodies in all phases,
    halvings of rows, the deepest of them, and work as in MOST_WORK."""

    accepted: bool
    findings: tuple[ClaimFinding, ...]
    rows: int = 0
    pairs: int = 0
    halvings: int = 0
    deepest: int = 0
    work: int = 0


@kernel(types.Tuple((tb.GEOMETRY, tb.SCRATCH))(tb.CLAIM), allocates=True)
def prepare(k: Claim) -> tuple[tb.Geometry, tb.Scratch]:
    """Room for the geometry and the jets of a claim that fits together. Carriers are written, and the jets of those
    that never move."""
    links, frames, solids, vertices, lags = len(k.links), len(k.frames), 0, 0, 0
    for s in range(len(k.seats)):
        body = k.bodies[int(k.seats[s, c.SEAT_BODY])]
        solids += int(body[c.BODY_PIECES]) + 1
        for i in range(int(body[c.BODY_PIECE]), int(body[c.BODY_PIECE] + body[c.BODY_PIECES])):
            vertices += int(k.pieces[i, c.PIECE_VERTICES])
    geometry = tb.Geometry(
        np.zeros((len(k.knots), tb.CURVE)),
        np.zeros((len(k.arms), 2)),
        np.zeros((len(k.laws), tb.LAW_CURVE)),
        np.zeros((links + frames, tb.CARRIER)),
        np.zeros((frames, 1)),
        np.zeros((links + frames, tb.ROUNDS)),
        np.zeros((solids, tb.SOLID)),
        np.zeros((vertices, 3)),
        np.zeros((len(k.seats), 2)),
        np.zeros((1, 2)),
    )
    for j in range(c.MOST_JOINTS):
        lags = c.MOST_JOINTS if k.required[0, c.REQUIRED_LAG + j] > 0.0 else lags
    scratch = tb.Scratch(
        np.zeros((tb.INSTANTS + tb.INTERVALS + lags, links + frames, 12, 6)),
        np.full((tb.INSTANTS + tb.INTERVALS + max(lags, 1), links + frames, 3), np.nan),
        np.zeros((len(k.angles), 2, 6)),
        np.zeros((2, 2, 6)),
        np.zeros((c.MOST_JOINTS, 6)),
        np.zeros((4, 3, 6)),
        np.zeros(3),
        np.zeros(tb.LAW_POWERS + 2),
        np.zeros((links + frames, 2)),
    )
    scratch.jets[:, :, 11, 0] = 1.0
    for a in range(len(k.arms)):
        for i in range(int(k.arms[a, c.ARM_LINK]), int(k.arms[a, c.ARM_LINK] + k.arms[a, c.ARM_LINKS])):
            own = geometry.carriers[i]
            own[tb.CARRIER_ARM], own[tb.CARRIER_FRAME], own[tb.CARRIER_FIRST] = a, -1.0, k.arms[a, c.ARM_LINK]
            own[tb.CARRIER_UPRIGHT] = 1.0 if k.links[i, c.LINK_PITCH] < 0.0 else 0.0
    for f in range(frames):
        frame, own = k.frames[f], geometry.carriers[links + f]
        alone = frame[c.FRAME_ARM] < 0.0
        geometry.on[f, 0] = links + f if alone else frame[c.FRAME_LINK]
        own[tb.CARRIER_ARM], own[tb.CARRIER_FRAME], own[tb.CARRIER_FIRST] = -1.0, f, links + f
        own[tb.CARRIER_UPRIGHT] = 1.0
        if alone and frame[c.FRAME_PIECES] + frame[c.FRAME_WAVES] == 0.0:
            own[tb.CARRIER_FIXED] = 1.0
            frame_over(k, geometry, f, links + f, 0.0, 0.0, scratch.jets[0], scratch)
    return geometry, scratch


@kernel(types.boolean(tb.CLAIM))
def phases_fit(k: Claim) -> bool:
    """Whether phases follow each other from the first knot to the end that is required, and the robot must keep clear
    in all of them until its last knot."""
    phases, last = len(k.phases), k.knots[int(k.arms[0, c.ARM_KNOTS]) - 1, c.KNOT_TIME]
    fit = k.phases[0, c.PHASE_T0] == k.knots[0, c.KNOT_TIME]
    fit = fit and k.phases[phases - 1, c.PHASE_T1] >= k.required[0, c.REQUIRED_UNTIL]
    fit = fit and k.required[0, c.REQUIRED_UNTIL] >= last and k.phases[phases - 1, c.PHASE_T1] >= last
    for p in range(phases):
        fit = fit and (p == 0 or k.phases[p, c.PHASE_T0] == k.phases[p - 1, c.PHASE_T1])
        fit = fit and (k.phases[p, c.PHASE_ROBOT] > 0.0 or k.phases[p, c.PHASE_T0] >= last)
    return bool(fit)


@kernel(i8(F2, i8, i8, f8, f8))
def add_finding(findings: FloatArray, many: int, kind: int, row: float, when: float) -> int:
    """Writes a finding without an amount to row `many`, and returns the number of findings."""
    own = findings[many]
    own[FINDING_KIND], own[FINDING_ROW], own[FINDING_WHEN], own[FINDING_AMOUNT] = kind, row, when, math.nan
    return many + 1


@kernel(i8(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, tb.PROOF, F2, F2, i8), allocates=True)
def add_proof_findings(
    k: Claim, g: tb.Geometry, s: tb.Scratch, proof: tb.Proof, stack: FloatArray, findings: FloatArray, many: int
) -> int:
    """Adds what rows do not show of the distances in `proof.pairs`. Returns the number of findings."""
    resolve(k, g, proof)
    link_rows(k, g, s, proof, stack)
    wrong = first_wrong_row(k, g, s, proof)
    second = proof.state[tb.PAIRS] > 0.0 and proof.pairs[0, tb.PAIR_CERTAIN] > 0.0
    if wrong >= 0:
        many = add_finding(findings, many, GAP_ROW if second else ROW, wrong, proof.rows[wrong, c.ROW_T0])
    # a row that fails leaves its pair without cover: that is reported once
    for code in range(COVER if wrong < 0 else WITHIN, WITHIN if second else WITHIN + 1):
        pair = -1
        while many < MOST_FINDINGS and proof.state[tb.WORK] > 0.0:
            pair = first_uncovered(k, proof, pair) if code == COVER else first_within(k, g, s, proof, pair)
            if pair < 0:
                break
            begin = k.phases[int(proof.pairs[pair, tb.PAIR_PHASE]), c.PHASE_T0]
            many = add_finding(findings, many, GAP_COVER if second else code, pair, begin)
    return many


@kernel(types.Tuple((F2, F2, F1))(tb.CLAIM, F2, I1, I1), allocates=True)
def check_tables(
    k: Claim, table: FloatArray, order: IntArray, gap_order: IntArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """What is not shown of a claim (.., FINDING), or what does not fit together (`misfit`, with its `table`); the pairs
    that must keep apart (.., PAIR), and the numbers of the check (STATE,). `order`, `gap_order`: of its rows and gap
    rows, by begin and end."""
    findings, state, many = np.zeros((MOST_FINDINGS + 2, FINDING)), np.zeros(tb.STATE), 0
    state[tb.WORK], fits = MOST_WORK, misfit(k, table)
    if fits != FITS:
        many = add_finding(findings, 0, FORM, fits, math.nan)
        return findings[:many], np.empty((0, tb.PAIR)), state
    g, s = prepare(k)
    moves = make_laws(k, g, s) and make_curves(k, g, s)
    if not (moves and phases_fit(k)):
        many = add_finding(findings, 0, PHASES if moves else KNOTS, 0.0, k.phases[0, c.PHASE_T0])
        return findings[:many], np.empty((0, tb.PAIR)), state
    place_solids(k, g)
    stack = np.zeros((2 * tb.DEEPEST + 8, max(tb.POWERS + 1, c.SUM, tb.OBJECT)))
    joint = first_joint_beyond(k, stack, state)
    if joint != KEPT:
        many = add_finding(findings, many, LIMIT, joint, stack[len(stack) - 1, tb.POWERS])
    tables = (k.points, k.rates, k.axes, k.guides, k.phases, k.sums, k.distances, k.errors)
    for kind, table in enumerate(tables):
        for i in range(len(table)):
            state[tb.AMOUNT] = math.nan
            if many < MOST_FINDINGS and not claim_holds(k, g, s, kind, i, table[i], stack, state):
                many = add_finding(findings, many, kind, i, table[i, 0])
                findings[many - 1, FINDING_AMOUNT] = state[tb.AMOUNT]
    bodies, phases, planes, numbers = len(k.bodies), len(k.phases), 0, np.full(len(k.bodies), -1)
    for i in range(len(k.rows)):
        planes += 1 if k.rows[i, c.ROW_BODY + 1] < 0.0 else 0
    robots = number_bodies(k, numbers)
    size = phases * robots * bodies
    state[tb.WORK] -= float(size) * (1.0 + len(k.rules)) + 0.5 * planes * bodies
    if not state[tb.WORK] > 3.0 * size:
        many = add_finding(findings, many, MUCH, 0.0, k.phases[0, c.PHASE_T0])
        return findings[:many], np.empty((0, tb.PAIR)), state
    rows_of, pairs, heads = np.full((phases, robots, bodies), -1), np.empty((size, tb.PAIR)), np.full(size, -1)
    links = np.empty((max(len(k.rows) + planes * bodies, len(k.gap_rows)), 2), np.int64)
    objects = np.empty((max(len(k.rows), len(k.gap_rows)), tb.OBJECT))
    proof = tb.Proof(k.rows, numbers, rows_of, pairs, objects, order, links, heads, state)
    make_pairs(k, g, proof)
    many = add_proof_findings(k, g, s, proof, stack, findings, many)
    if many < MOST_FINDINGS and max(k.required[0, c.REQUIRED_NEAREST], k.required[0, c.REQUIRED_PLACED]) >= 0.0:
        none = require_second(k, proof)
        if none >= 0:
            many = add_finding(findings, many, GAP_COVER, none, k.phases[int(pairs[none, tb.PAIR_PHASE]), c.PHASE_T0])
        else:
            heads[:] = -1
            proof = tb.Proof(k.gap_rows, numbers, rows_of, pairs, objects, gap_order, links, heads, state)
            many = add_proof_findings(k, g, s, proof, stack, findings, many)
    if not state[tb.WORK] > 0.0:
        many = add_finding(findings, many, MUCH, 0.0, k.phases[0, c.PHASE_T0])
    return findings[:many], pairs[: int(state[tb.PAIRS])], state


BOUNDS = bounds()


def check_claim(claim: Claim) -> ClaimVerdict:
    """Whether everything that a claim says is shown. Tables that are none of a claim are refused, not raised."""
    name = wrong_table(claim)
    if name:
        return _refused(ClaimFinding(Code.FORM, f"{name}: not the table of a claim", name))
    order, gap_order = [np.lexsort((rows[:, c.ROW_T1], rows[:, c.ROW_T0])) for rows in (claim.rows, claim.gap_rows)]
    try:
        rows, pairs, state = check_tables(claim, BOUNDS, order, gap_order)
    except (ZeroDivisionError, OverflowError, ValueError, IndexError) as error:
        return _refused(ClaimFinding(Code.FORM, f"numbers that overflow, or a division by 0: {type(error).__name__}"))
    body = open_body(claim) if len(rows) == 0 or rows[0, FINDING_KIND] != FORM else -1
    if body >= 0:
        return _refused(ClaimFinding(Code.SURFACE, "the surface is not closed", bodies=(body,)))
    findings = tuple(_finding(claim, row, pairs) for row in rows)
    needed, many, halvings, deepest = [int(state[number]) for number in (tb.ROWS, tb.PAIRS, tb.HALVINGS, tb.DEPTH)]
    return ClaimVerdict(not findings, findings, needed, many, halvings, deepest, int(MOST_WORK - state[tb.WORK]))


def _refused(finding: ClaimFinding) -> ClaimVerdict:
    return ClaimVerdict(False, (finding,))


def _finding(claim: Claim, own: FloatArray, pairs: FloatArray) -> ClaimFinding:
    """A finding of `check_tables`, with the rows and the bodies that it is about."""
    kind, row, bodies = int(own[FINDING_KIND]), int(own[FINDING_ROW]), np.empty(0)
    code, table, what = KINDS[kind]
    if kind in (COVER, WITHIN, GAP_COVER):
        bodies, row = pairs[row, [tb.PAIR_A, tb.PAIR_B]], int(pairs[row, tb.PAIR_PHASE])
    elif kind in (ROW, GAP_ROW):
        bodies = (claim.rows if kind == ROW else claim.gap_rows)[row, c.ROW_BODY : c.ROW_PIECE]
    elif kind == FORM:
        row, what = -1, MISFITS.get(row) or bound_name(row)
    elif kind == LIMIT and row == NO_LIMITS:
        table, what = "", "no limits are for all of the motion"
    when, amount = float(own[FINDING_WHEN]), float(own[FINDING_AMOUNT])
    return ClaimFinding(code, what, table, row, tuple(bodies.astype(int).tolist()), when, amount)
