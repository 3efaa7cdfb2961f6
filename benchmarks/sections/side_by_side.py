"""Ours and the peers from PyPI on the static problems, one after the other on each, on the same core.

A peer's answer goes through the recheck that ours goes through, and counts as solved where it collides with nothing,
begins at the start and ends at the goal; that none but ours has a limit of jerk is told beside it, not held against it.
Times are of solved problems only. Ours is the first answer; the peers' time is to a trajectory: MPlib with TOPPRA's
timing, OMPL with its path simplified and then driven from point to point. The moving sets have no peer on PyPI: OMPL's
ST-RRT* is not in its Python package.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from benchmarks.best_known import PATH, Known, found, merged, read, write
from benchmarks.cold import forget
from benchmarks.figures import Figure, figure, quantile
from benchmarks.judged import WARM_UP_SEEDS, judged, label, problem_set, said, warm_up
from benchmarks.peers.running import environment_of, peers, question
from benchmarks.problem_set import Problem, ProblemSet
from benchmarks.recheck.findings import Finding, recheck
from benchmarks.run_problems import answer
from benchmarks.section import Document, Item, Records, Section, Summary, died
from benchmarks.translation import Manners, unrelated_problem

BUDGET_S = 1.0
SAMPLE = 10
TITLES = {"assur": "ours", "ompl": "OMPL RRTConnect", "mplib": "MPlib"}
PEERS = ("ompl", "mplib")
FATAL = frozenset({"collision", "goal", "form", "status"})
"""Kinds of finding after which a problem is not solved, whatever the limits."""


def parameters(quick: bool) -> Document:
    return {"set": "static", "budget_s": BUDGET_S, "seed": 0, "every": SAMPLE if quick else 1}


def items(parameters: Document) -> list[Item]:
    problems = problem_set(parameters["set"]).problems[:: parameters["every"]]
    return [Item("static", str(problem["id"])) for problem in problems]


def fatal(finding: Finding) -> bool:
    """Whether a finding means that the problem is not solved. A peer may begin and end with a jump in acceleration,
    for it has no limit of jerk; nothing else at the ends may be wrong."""
    if finding.kind in ("start", "end"):
        return "at rest" not in finding.text or "q̇ [0.0, 0.0, 0.0, 0.0]" not in finding.text.replace("-0.0", "0.0")
    if finding.kind == "goal velocity":
        return "q̈" not in finding.text
    return finding.kind in FATAL


def rechecked(problems: ProblemSet, problem: Problem, theirs: Document) -> Document:
    """A peer's answer without its trajectory: what is wrong with it, and how much of that is fatal."""
    if theirs["status"] != "planned":
        return {"status": theirs["status"], "reason": theirs.get("reason"), "fatal": [], "limits": []}
    # our checker knows no plan without a certificate
    told = recheck(problems, problem, theirs | {"checked": True}, "position")
    return {
        "status": "planned",
        "first_s": theirs["first_s"],
        "path_s": theirs.get("path_s"),
        "duration_s": theirs["duration_s"],
        "fatal": [said(finding) for finding in told if fatal(finding)],
        "limits": sorted({finding.kind for finding in told if not fatal(finding)}),
    }


@contextmanager
def measuring(parameters: Document, _group: str) -> Iterator[Callable[[str], Document]]:
    problems = problem_set(parameters["set"])
    by_id = {problem["id"]: problem for problem in problems.problems}
    budget, seed = parameters["budget_s"], parameters["seed"]
    warm_up(problems)
    with peers(PEERS, environment_of()) as others:
        for number in WARM_UP_SEEDS:
            standing = unrelated_problem(number, False)
            standing["obstacles"] = standing["obstacles"][:1]
            for name in PEERS:
                others.ask(name, question(standing, problems.limits, budget, seed))

        def measure(item: str) -> Document:
            problem = by_id[item]
            forget()
            ours = judged(
                problems, problem, answer(problem, problems, Manners(budget, "first", "position", seed)), "position"
            )
            record: Document = {"assur": ours, "versions": others.versions}
            record |= {"findings": ours["findings"], "answers": ours["answers"]}
            for name in PEERS:
                theirs = others.ask(name, question(problem, problems.limits, budget, seed))
                record[name] = rechecked(problems, problem, theirs)
            return record

        yield measure


def summary(_parameters: Document, records: Records) -> Summary:
    figures: list[Figure] = []
    rows: Document = {}
    for name, title in TITLES.items():
        of_name = {item: record.get(name) for item, record in records.items()}
        lines = {item: line for item, line in of_name.items() if line is not None}
        faulty = {item: record for item, record in records.items() if name not in record}
        missing = sorted({line["reason"] for line in lines.values() if line["status"] == "missing"})
        if name == "assur" or not missing:
            figures += _figures(title, lines | faulty)
        else:
            figures += [Figure(f"{title}: {what}", None, refused=f"missing: {missing[0]}") for what in WHAT]
        answered = [line for line in lines.values() if line["status"] == "planned"]
        good = [line for line in answered if _solved(line)]
        version = next((r["versions"].get(name) for r in records.values() if r.get("versions", {}).get(name)), None)
        rows[title] = {
            "version": version,
            "missing": missing[0] if missing else None,
            "problems": len(lines),
            "answered": len(answered),
            "collide": sum("collision" in str(line.get("fatal", line.get("findings"))) for line in answered),
            "solved": len(good),
            "all_limits": sum(not line.get("limits") for line in good),
            "path_s": quantile([line["path_s"] for line in good if line.get("path_s")], 0.5),
            "first_s": [[item, line["first_s"]] for item, line in lines.items() if line in good],
            "duration_s": quantile([line["duration_s"] for line in good], 0.5),
        }
    return Summary(tuple(figures), {"peers": rows})


def lower_records(parameters: Document, records: Records) -> None:
    """What a peer found that keeps every limit, jerk included, is a record like any other."""
    known = read(PATH)
    new: Known = {}
    for name in PEERS:
        kept = {
            item: record[name] | {"findings": record[name]["fatal"] + record[name]["limits"]}
            for item, record in records.items()
            if record.get(name, {}).get("status") == "planned"
        }
        versions = {record["versions"].get(name) for record in records.values() if "versions" in record}
        by = f"{TITLES[name]} {', '.join(sorted(filter(None, versions)))}"
        new = merged(new, found(label(parameters["set"], "position"), kept, by))[0]
    everything, lowered = merged(known, new)
    if lowered:
        write(PATH, everything)


WHAT = ("solved within 1 s", "time to a trajectory, median", "time to a trajectory, 95 %")


def _figures(title: str, lines: dict[str, Document]) -> list[Figure]:
    def at(share: float) -> Callable[[Any], float | None]:
        return lambda rows: quantile([1e3 * row["first_s"] for row in rows if _solved(row)], share)

    def solved(rows: Any) -> float:
        return 100 * len([row for row in rows if _solved(row) and row["first_s"] <= BUDGET_S]) / len(rows)

    # ours is refused when it is not clean; what is wrong with a peer's answer makes it unsolved instead
    held: dict[str, Document] = {item: {"findings": []} | line for item, line in lines.items()}
    return [
        figure(f"{title}: {WHAT[0]}", held, solved, "%"),
        figure(f"{title}: {WHAT[1]}", held, at(0.5), "ms"),
        figure(f"{title}: {WHAT[2]}", held, at(0.95), "ms"),
    ]


def _solved(line: Document) -> bool:
    return line["status"] == "planned" and not line.get("fatal") and not line.get("findings")


SECTION = Section(
    "peers",
    "ours and the peers from PyPI, side by side",
    parameters,
    items,
    measuring,
    summary,
    limit_s=900.0,
    again=lambda record: died(record) or any(record[name]["status"] == "missing" for name in PEERS),
    after=lower_records,
)
