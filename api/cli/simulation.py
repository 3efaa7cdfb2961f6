"""`assur simulate`: runs a cell against its streams."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from assur.api.cli import console_report
from assur.api.cli.border import INTERRUPTED, RIGHT, WRONG, AsJson, say, show, show_json, writable
from assur.api.cli.cell_reading import announce_compilation
from assur.api.cli.console_report import rows
from assur.api.cli.inputs import Values, set_values
from assur.api.version import version
from assur.planner.errors import InputError
from assur.scenes.simulation.words import (
    LEGS,
    ONE_SEED,
    PARTS,
    TRIALS,
    changes,
    legs,
    pick_error,
    share_of_time,
    trials,
    waits,
)

if TYPE_CHECKING:
    from assur.scenes.session.recorded import Events, Record
    from assur.scenes.simulation.simulate import Simulation, Watch

Document = dict[str, Any]
HELPS = "Then try what would help: changes of the cell, the best three with motions that are proved, too."


def simulate(
    cell: Annotated[str, typer.Argument(metavar="CELL", help="A cell file with streams, or a shipped cell's name.")],
    minutes: Annotated[float, typer.Option(help="Length of each run, on its own clock.")] = 10.0,
    seed: Annotated[int, typer.Option(help="Seed of the first run.")] = 1,
    seeds: Annotated[int, typer.Option(help="Number of runs, each with the next seed.")] = 1,
    planning_ms: Annotated[float, typer.Option(help="How long planning takes on the clock of the run.")] = 20.0,
    values: Values = None,
    as_json: AsJson = False,
    out: Annotated[Path | None, typer.Option("--out", help="Write the result to this file, as JSON.")] = None,
    log: Annotated[Path | None, typer.Option(help="Write the log of the first run to this file (MCAP).")] = None,
    page: Annotated[Path | None, typer.Option(help="Write a page about the first run to this file (HTML).")] = None,
    helps: Annotated[bool, typer.Option("--what-helps", help=HELPS)] = False,
) -> int:
    """Run CELL against its streams with motions that are proved and checked: parts a minute, and why not more."""
    from assur.scenes.session.recorded import Events
    from assur.scenes.simulation.cell_file import cell_named
    from assur.scenes.simulation.helps import Helps
    from assur.scenes.simulation.simulate import Simulation

    stated = set_values(values)
    given = cell_named(cell, stated)
    for option, file, others in (("--out", out, (log, page)), ("--log", log, (page,)), ("--page", page, ())):
        writable(file, cell, *others, option=option)
    announce_compilation()
    with given.located():
        made = Simulation(given.document, minutes, seed, seeds, planning_ms)
        for note in made.cell.heights:
            say(f"note: {note}")
        interrupted, events, trials = False, Events(), Helps(made)
        try:
            with _shown(made) as watch, _recorded(made, log, events if page else None) as record:
                made.run(watch, record)
            if helps:
                with _progress("what would help", 1.0) as update:
                    trials.run(lambda what, share: update(share, what))
        except KeyboardInterrupt:
            if not made.runs:
                raise
            interrupted = True
    found = trials.document if helps else made.document
    if out is not None:
        out.write_text(json.dumps(found, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    if page is not None:
        written = _written(page, given.name, given.document, events.events, found=found, values=stated)
        say(f"page of the first run: {written}")
    if as_json:
        show_json(found)
    else:
        show(*words(given.name, found))
    return say("interrupted: these are the figures until then", INTERRUPTED) if interrupted else RIGHT


@contextmanager
def _recorded(made: Simulation, log: Path | None, events: Events | None) -> Iterator[Record | None]:
    """What gets the calls of the first run: a log in a file, these events, both or nothing."""
    if log is None:
        yield events
        return
    from assur.scenes.session.log import SessionLog
    from assur.scenes.session.recorded import Several

    with closing(SessionLog(log, made.cell.document)) as written:
        yield written if events is None else Several(written, events)


@contextmanager
def _shown(made: Simulation) -> Iterator[Watch]:
    """Shows how far the runs are."""
    with _progress(f"seed {made.first}", made.count * made.until_s) as update:
        yield lambda run, now_s: update(run * made.until_s + now_s, f"seed {made.first + run}")


@contextmanager
def _progress(begin: str, total: float) -> Iterator[Callable[[float, str], None]]:
    """Shows on standard error, if it is a terminal, how much of a total is over, and what is going on."""
    shown = console_report.console(stderr=True)
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.percentage:3.0f} %"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=shown, transient=True, disable=not shown.is_terminal) as bar:
        task = bar.add_task(begin, total=total)
        yield lambda completed, what: bar.update(task, completed=completed, description=what)


def words(name: str, found: Document) -> Iterator[Any]:
    """The result in words."""
    runs, low_high = found["runs"], found["interval"]
    minutes = sum(run["simulated_s"] for run in runs) / 60.0
    seeds = f", seeds {runs[0]['seed']} to {runs[-1]['seed']}" if len(runs) > 1 else f", seed {runs[0]['seed']}"
    yield f"{name}: {found['parts_per_minute']:.1f} parts a minute{_within(low_high)}"
    yield found["bottleneck"]
    yield f"simulated {minutes:.4g} min{seeds}, {found['selection']}, elbow {found['elbow'] or 'as the arm has it'}"
    yield ""
    cycle_s = "none" if found["cycle_s"] is None else f"{found['cycle_s']:.3f} s"
    lines = [(key, f"{found[key]}") for key in PARTS]
    lines += [("mean cycle", f"{cycle_s} (without obstacles and waits {found['table_cycle_s']:.3f} s)")]
    lines += [("the arm takes parts", share_of_time(found["moving"])), *waits(found)]
    lines += [("worst error of a pick", pick_error(found))]
    lines += [("motions checked", f"{found['checked']}, of {found['plans']} that were planned")]
    lines += [(f"not planned: {reason}", f"{count}") for reason, count in found["refusals"].items()]
    yield rows(("parts", ""), lines)
    yield from (f"{reason}, {found['examples'][reason]}" for reason in found["refusals"])
    yield from ("", rows(LEGS, [*legs(found)])) if found["legs"] else ()
    yield from ([""] if found["notes"] else [])
    yield from (f"note: {note}" for note in found["notes"])
    if "helps" in found:
        yield from _words_of_helps(found["helps"], len(runs))


def _words_of_helps(helps: list[Document], seeds: int) -> Iterator[Any]:
    """What the changes of a cell give, and how each is made."""
    yield ""
    if not helps:
        yield "what would help: no change was tried"
        return
    yield rows(TRIALS, [*trials(helps)])
    if seeds == 1:
        yield ONE_SEED
    yield from changes(helps)


def replay(
    log: Annotated[Path, typer.Argument(metavar="LOG", help="The log of a session or a simulation (MCAP).")],
    page: Annotated[Path | None, typer.Option(help="Write a page about it to this file (HTML).")] = None,
    from_s: Annotated[float, typer.Option(help="When, since the start, the minute begins that the page plays.")] = 0.0,
) -> int:
    """Do the calls of a LOG again, in a new session, and compare what each gives: the plans to the bit."""
    from assur.api.python.session import replay as again

    if not log.is_file():
        raise InputError("LOG", str(log), "a file that exists: the log of a session")
    writable(page, str(log), option="--page")
    announce_compilation()
    with console_report.working(f"replaying {log.name}"):
        found = again(log)
    if not found.same:
        return say(f"{log.name}: {found.calls} calls give the same, the next one does not. {found.difference}", WRONG)
    show(f"{log.name}: {found.calls} calls, each gives the same again")
    if page is not None:  # of calls that are known to be right
        from assur.scenes.session.log import read_log

        show(f"page of {log.name}: {_written(page, log.stem, *read_log(log), from_s=from_s)}")
    return RIGHT


def _written(page: Path, title: str, cell: Document, events: Iterable[Document], **more: Any) -> str:
    """Writes the page of a run to a file, and says how large it is."""
    from assur.scenes.report.run_report import run_report

    text = run_report(events, title=title, about=str(cell.get("about", "")), version=version(), **more)
    page.write_bytes(text.encode())
    return f"{page}, {len(text) / 1000:.0f} kB, opens in a browser without network"


def _within(low_high: list[float] | None) -> str:
    return "" if low_high is None else f" (95 % interval {low_high[0]:.1f} to {low_high[1]:.1f})"
