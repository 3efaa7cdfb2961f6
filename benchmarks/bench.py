"""``python -m benchmarks.bench [--quick]``: every script of the benchmark, each in a process of its own.

A script whose result is there and was measured with these sources on this machine is not run again, so a run that was
stopped goes on with the script at which it was; `--fresh` runs all. A quick run takes a sample of everything.
"""

from __future__ import annotations

import subprocess
import sys
from typing import Annotated

import typer
from rich.console import Console

from benchmarks.figures import FOLDER, SAMPLES, read
from benchmarks.judged import SETS
from benchmarks.machine import ROOT, machine, sources

SCRIPTS = ("first_answer", "durations", "demo_cycle", "session", "scaling", "legs", "service", "side_by_side")


def main(
    quick: Annotated[bool, typer.Option("--quick", help="A sample of everything, in under 3 minutes.")] = False,
    only: Annotated[list[str] | None, typer.Option(help="Only this script; repeatable.")] = None,
    beside: Annotated[str | None, typer.Option(help="A commit that answers the sets in turn with this one.")] = None,
    fresh: Annotated[bool, typer.Option("--fresh", help="Measure everything again.")] = False,
) -> None:
    """Run the benchmark. Exit 1 if a script failed."""
    console, failed = Console(), []
    for script in only or SCRIPTS:
        path = (SAMPLES if quick else FOLDER) / f"{script}.jsonl"
        if path.exists() and not (fresh or only):
            head = read(path)[0]
            if head["sources"] == sources() and head["machine"] == machine():
                console.print(f"{script}: measured already")
                continue
        more = ["--quick"] if quick else []
        more += ["--beside", beside] if beside and script == "first_answer" else []
        if not run(script, *more):
            failed.append(script)
    if not quick and not only:
        profiles = FOLDER / "profile.jsonl"
        profiles.unlink(missing_ok=True)
        for name, match in SETS:
            for of in ([], *([["--commit", beside]] if beside else [])):
                run("profile", name, "--match", match, "--out", str(profiles), *of)
    if failed:
        console.print(f"failed: {', '.join(failed)}")
    raise typer.Exit(1 if failed else 0)


def run(script: str, *arguments: str) -> bool:
    """Whether a script ended well."""
    return (
        subprocess.run([sys.executable, "-m", f"benchmarks.{script}", *arguments], cwd=ROOT, check=False).returncode
        == 0
    )


if __name__ == "__main__":
    typer.run(main)
