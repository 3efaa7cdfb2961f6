"""What a plan promises of the ways between its points: tracking, straight legs, arches, yaws, the pull on a part."""

from __future__ import annotations

import numpy as np

from benchmarks.judge.arrivals_kept import Target, Targets
from benchmarks.judge.faults import Violation, beyond
from benchmarks.judge.joints_kept import carrying
from benchmarks.judge.motion import Motion
from benchmarks.judge.poses import Document, Floats, short

TRACKED_M, TRACKED_RAD = 1e-5, 1e-4
"""The promise of tracking legs; of straight legs, too."""
READ_M = 1e-7
"""Error of the measurements here."""
STEP_S = 1e-3
CARRY = 1e-4
"""Of the limit of the pull, for what a second difference makes of it."""
YAW_RAD = 1e-8


def ways_kept(motion: Motion, targets: Targets) -> list[Violation]:
    found = list[Violation]()
    begin = motion.start_s
    for phase in motion.phases:
        leg = phase.leg
        if leg is None:
            continue
        found += beyond("legs", leg["kind"], abs(leg["from_s"] - begin), 1e-9, begin)
        begin = leg["to_s"]
        t = _instants(leg["from_s"], leg["to_s"])
        ((kind, given),) = motion.request["task"][leg["step"]].items()
        if leg["kind"] in ("APPROACH", "FOLLOW", "DEPART") and kind != "trace":
            found += _tracks(motion, leg, given, targets.of_step[leg["step"]], t)
        if leg["kind"] == "WAIT":
            still = float(np.ptp(motion.joints(t), axis=0).max())
            found += beyond("wait", str(leg["step"]), still, 1e-8, leg["from_s"])
        if _straight(leg, given):
            found += _on_a_line(motion, leg, targets, t)
    found += beyond("legs", "the last", abs(motion.end_s - begin), 1e-9, begin)
    found += _arches(motion) + _yaws(motion) + _pull(motion) + _contacts(motion)
    return found


def _instants(t0: float, t1: float) -> Floats:
    return np.linspace(t0, t1, min(max(int((t1 - t0) / STEP_S), 8), 400) + 1)


def _tracks(motion: Motion, leg: Document, given: Document, target: Target, t: Floats) -> list[Violation]:
    """The tool keeps to its moving target: in all coordinates in a FOLLOW, at some height above it else."""
    tool, wanted, name = motion.tool(t), target.at(motion, t), f"{leg['kind']} of step {leg['step']}"
    off, found = tool.p - wanted.p, list[Violation]()
    if leg["kind"] == "FOLLOW":
        far = np.linalg.norm(off, axis=1)
    else:
        far = np.hypot(np.hypot(off[:, 0], off[:, 1]), np.minimum(off[:, 2], 0.0))
        end, outer = ("approach", off[0, 2]) if leg["kind"] == "APPROACH" else ("depart", off[-1, 2])
        required = float(given.get(end, {}).get("m", 0.0))
        found += beyond("straight part", name, required - float(outer), TRACKED_M, leg["from_s"])
    k = int(far.argmax())
    found += beyond("tracking", name, float(far[k]), TRACKED_M + READ_M, t[k])
    if not motion.arm.turns:
        return found
    turn = short(tool.yaw - wanted.yaw)
    turn = turn if target.yaw else short(turn - turn[-1 if leg["kind"] == "APPROACH" else 0])
    k = int(np.abs(turn).argmax())
    return found + beyond("tracking", f"{name}, yaw", float(np.abs(turn[k])), TRACKED_RAD + READ_M, t[k])


def _straight(leg: Document, given: Document) -> bool:
    route = leg.get("route")
    return bool(given.get("leg") == "cartesian" and "path" not in given and route and route["course"] == "straight")


def _on_a_line(motion: Motion, leg: Document, targets: Targets, t: Floats) -> list[Violation]:
    """The tool point is on the line from its last place to its moving target, and never goes back on it. The last place
    moves with the frame of the step before, if the tool met that step with its velocity."""
    p, goal = motion.tool(t).p, targets.of_step[leg["step"]].at(motion, t).p
    before, since = np.broadcast_to(p[0], p.shape), t[:1]
    arrivals = {arrival["step"]: arrival for arrival in motion.answer["arrivals"]}
    if leg["step"] > 0 and arrivals[leg["step"] - 1]["matched"]:
        frame = targets.of_step[leg["step"] - 1].frame
        before = motion.frame(frame, t).then(motion.frame(frame, since).inverse().then(motion.tool(since))).p
    way = goal - before
    length = np.linalg.norm(way, axis=1)
    if length.min() < 1e-4:
        return []
    share = np.einsum("ij,ij->i", p - before, way) / length**2
    off = np.linalg.norm(p - before - share[:, None] * way, axis=1)
    k = int(off.argmax())
    name = f"step {leg['step']}"
    found = beyond("straight leg", name, float(off[k]), TRACKED_M + READ_M, t[k])
    back = float((-np.diff(share) * length[:-1]).max())
    return found + beyond("straight leg", f"{name}, back", back, TRACKED_M, leg["from_s"])


def _arches(motion: Motion) -> list[Violation]:
    """The tool point rises as high as an arch asks."""
    found = list[Violation]()
    for number, step in enumerate(motion.request["task"]):
        ((_, given),) = step.items()
        legs = [leg for leg in motion.answer["legs"] if leg["step"] == number and leg["kind"] == "ARCH"]
        if "arch" not in given:
            continue
        if not legs:
            found.append(Violation("arch", f"step {number}: none", 0.0, 0.0))
            continue
        t = np.linspace(legs[0]["from_s"], legs[-1]["to_s"], 2000)
        top = float(motion.tool(t).p[:, 2].max())
        found += beyond("arch", f"step {number}", float(given["arch"]["top_m"]) - top, 5e-6, legs[0]["from_s"])
    return found


def _yaws(motion: Motion) -> list[Violation]:
    """The tool is in no range of forbidden yaws."""
    ranges = motion.request["robot"].get("limits", {}).get("forbidden_yaw_rad", [])
    if not ranges:
        return []
    t, found = np.linspace(motion.start_s, motion.end_s, 3000), list[Violation]()
    yaw = motion.tool(t).yaw
    for first, last in ranges:
        width = (last - first) % (2.0 * np.pi)
        inside = np.minimum((yaw - first) % (2.0 * np.pi), width - (yaw - first) % (2.0 * np.pi))
        k = int(inside.argmax())
        found += beyond("forbidden yaw", f"{first:.4f} to {last:.4f}", float(inside[k]), YAW_RAD, t[k])
    return found


def _pull(motion: Motion) -> list[Violation]:
    """The tool point accelerates no harder than a held part bears."""
    limit = motion.request.get("carry", {}).get("acceleration_m_s2")
    found, h = list[Violation](), 1e-4
    if limit is None or motion.request.get("options", {}).get("timing") == "parabolic_blend":
        return []
    for t0, t1 in carrying(motion):
        t = np.linspace(t0 + h, t1 - h, max(int((t1 - t0) / STEP_S), 2))
        p = [motion.tool(t + k * h).p for k in (-1, 0, 1)]
        size = np.linalg.norm(p[0] - 2.0 * p[1] + p[2], axis=1) / h**2
        k = int(size.argmax())
        found += beyond("carry", "", float(size[k]) / float(limit), 1.0 + CARRY, t[k])
    return found


def _contacts(motion: Motion) -> list[Violation]:
    """The reported contacts are those of the legs."""
    known = {name for phase in motion.phases for name in (*phase.carried, *phase.seated)}
    legs = [phase for phase in motion.phases if phase.leg is not None]
    mine = _merged([(pair, p.stage.t0, p.stage.t1) for p in legs for pair in p.stage.contacts if pair <= known])
    stated = _merged([(frozenset(c["bodies"]), c["from_s"], c["to_s"]) for c in motion.answer["contacts"]])
    same = [each[0] for each in mine] == [each[0] for each in stated] and np.allclose(
        [each[1:] for each in mine], [each[1:] for each in stated], rtol=0.0, atol=1e-9
    )
    about = f"{mine}, reported {stated}"
    return [] if same else [Violation("contacts", about, float(len(stated)), float(len(mine)))]


def _merged(spans: list[tuple[frozenset[str], float, float]]) -> list[tuple[list[str], float, float]]:
    """Contacts in order; one that begins where another of its pair ends is joined to it."""
    found: list[tuple[list[str], float, float]] = []
    for pair, t0, t1 in sorted(spans, key=lambda each: (sorted(each[0]), each[1])):
        name = sorted(pair)
        if found and found[-1][0] == name and abs(found[-1][2] - t0) <= 1e-9:
            t0 = found.pop()[1]
        found.append((name, t0, t1))
    return [each for each in found if each[2] > each[1]]
