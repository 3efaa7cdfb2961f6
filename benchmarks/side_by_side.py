"""``python -m benchmarks.side_by_side``: ours and the peers from PyPI, one after the other on each static problem.

A peer's answer goes through the recheck that ours goes through, and counts as solved where it collides with nothing,
begins at the start and ends at the goal. Only ours has a limit of jerk: this is reported, and peers may be without it.
Times are of solved problems only. Ours is the first answer; the peers' time is to a trajectory: MPlib with TOPPRA's
timing, OMPL with its path simplified and then driven from point to point. The moving sets have no peer on PyPI: OMPL's
ST-RRT* is not in its Python package.
"""

from __future__ import annotations

from typing import Annotated

import typer

from benchmarks.best_known import PATH, found, lower
from benchmarks.commits import WARM_UP_SEEDS, ask, planning
from benchmarks.figures import Document, Figure, Records, finish, progress, quantile, unclean
from benchmarks.judge.problems import Finding, recheck
from benchmarks.judged import judged, label, problem_set
from benchmarks.machine import ROOT, pin
from benchmarks.peers.running import peers, question
from benchmarks.problem_set import Problem, ProblemSet
from benchmarks.translation import Terms, request, unrelated_problem

BUDGET_S = 1.0
SAMPLE = 10
OURS = "ours"
TITLES = {"ompl": "OMPL RRTConnect", "mplib": "MPlib"}
FATAL = frozenset({"collision", "goal", "form", "status"})
"""Kinds of finding after which a problem is not solved, whatever the limits."""


def main(quick: Annotated[bool, typer.Option("--quick", help="Every tenth problem.")] = False) -> None:
    """Measure ours and the peers."""
    parameters: Document = {"set": "static", "budget_s": BUDGET_S, "every": SAMPLE if quick else 1, "pinned": pin()}
    problems = problem_set("static")
    records: dict[str, Document] = {}
    with planning(ROOT, problems) as program, peers(tuple(TITLES)) as others:
        for seed in WARM_UP_SEEDS[:2]:
            standing = unrelated_problem(seed, False)
            standing["obstacles"] = standing["obstacles"][:1]
            for name in TITLES:
                others.ask(name, question(standing, problems.limits, BUDGET_S))
        for problem in progress(problems.problems[:: parameters["every"]], "peers"):
            document = request(problem, problems.limits, Terms(BUDGET_S, "first"))
            records[f"{OURS}/{problem['id']}"] = judged(problems, problem, ask(program, document), "position", document)
            for name, title in TITLES.items():
                answer = others.ask(name, question(problem, problems.limits, BUDGET_S))
                records[f"{title}/{problem['id']}"] = rechecked(problems, problem, answer)
    figures = [figure for title in (OURS, *TITLES.values()) for figure in figures_of(records, title)]
    parameters["versions"] = {TITLES[name]: version for name, version in others.versions.items()}
    finish("side_by_side", "ours and the peers, static problems", quick, parameters, records, figures)
    if not quick:
        for title in TITLES.values():
            # a peer's motion that keeps every limit, jerk included, is a record like any other
            kept = {item: r | {"findings": r["findings"] + r["limits"]} for item, r in of(records, title).items()}
            version = parameters["versions"].get(title, "")
            lower(PATH, found(label("static", "position"), kept, f"{title} {version}".strip()))


def fatal(finding: Finding) -> bool:
    """Whether a finding means that the problem is not solved. A peer may begin and end with a jump in acceleration,
    for it has no limit of jerk; nothing else at the ends may be wrong."""
    if finding.kind in ("start", "end"):
        return "at rest" not in finding.text or "q̇ [0.0, 0.0, 0.0, 0.0]" not in finding.text.replace("-0.0", "0.0")
    if finding.kind == "goal velocity":
        return "q̈" not in finding.text
    return finding.kind in FATAL


def rechecked(problems: ProblemSet, problem: Problem, answer: Document) -> Document:
    """A peer's answer without its trajectory: `findings` that are fatal, and the `limits` that it does not keep."""
    # our checker knows no plan without a certificate
    findings = (
        recheck(problems, problem, answer | {"checked": True}, "position") if answer["status"] == "planned" else []
    )
    return {key: value for key, value in answer.items() if key != "trajectory"} | {
        "findings": [str(finding) for finding in findings if fatal(finding)],
        "limits": sorted({finding.kind for finding in findings if not fatal(finding)}),
    }


def of(records: Records, title: str) -> dict[str, Document]:
    """Records of one planner by problem."""
    return {item.rpartition("/")[2]: r for item, r in records.items() if item.startswith(f"{title}/")}


def solved(record: Document) -> bool:
    """Whether there is a motion without a fatal fault."""
    return record["status"] == "planned" and not record["findings"]


def figures_of(records: Records, title: str) -> list[Figure]:
    """Share solved within a second, time to a trajectory, duration. A fault of our answer refuses the figure; a fault
    of a peer's answer makes the problem unsolved."""
    rows = of(records, title)
    missing = sorted({record["reason"] for record in rows.values() if record["status"] == "missing"})
    why = (unclean(rows) if title == OURS else None) or (f"missing: {missing[0]}" if missing else None)
    good = [record for record in rows.values() if solved(record)]
    fast = [record for record in good if record["first_s"] <= BUDGET_S]
    collide = sum("collision" in str(record["findings"]) for record in rows.values())
    limits = sum(not record.get("limits") for record in good)
    note = f"{collide} collide; {limits} of {len(good)} keep all limits"
    first = [1e3 * record["first_s"] for record in good]
    figures = (
        Figure(f"{title}: solved within 1 s", (100 * len(fast) / len(rows),), "%", decimals=0, note=note),
        Figure(f"{title}: to a trajectory, median", (quantile(first, 0.5),), "ms"),
        Figure(f"{title}: to a trajectory, 95 %", (quantile(first, 0.95),), "ms"),
        Figure(f"{title}: duration, median", (quantile([r["duration_s"] for r in good], 0.5),), "s", decimals=3),
    )
    return [Figure(each.name, (None,), each.unit, refused=why) for each in figures] if why else list(figures)


if __name__ == "__main__":
    typer.run(main)
