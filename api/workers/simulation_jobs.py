"""Simulations: what `POST /v1/simulations` and `POST /v1/cells/{sha256}/simulations` have a worker do."""

from __future__ import annotations

import hashlib
import json
import os
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from typing import Any, Literal

from assur.api.documents import to_json
from assur.api.problems import Problem
from assur.api.version import version
from assur.api.workers.cell_jobs import kept_cell
from assur.api.workers.end import Tell
from assur.api.workers.jobs import PROGRESS_S, Answer, Reply, bordered, document_in
from assur.api.workers.worker_process import CalledOffError, Line
from assur.planner.errors import FaultError, InputError
from assur.planner.model.deadline import OutOfTimeError, Stopwatch
from assur.scenes.bounds import MAX_SET
from assur.scenes.faults import NOTHING, DocumentError, documented, together
from assur.scenes.report.run_report import SHOWN_S, run_report
from assur.scenes.scenario import with_files
from assur.scenes.scenarios import CELLS
from assur.scenes.session.recorded import Events
from assur.scenes.set_values import Changed, unknown_paths
from assur.scenes.simulation.simulate import Arguments, Simulation, arguments
from assur.scenes.tasks.joining import FIELDS
from assur.scenes.text.yaml_text import Lines, line_of, parse_yaml

Document = dict[str, Any]
FIRST: Document = {"minutes": 10.0, "seed": 1, "seeds": 1, "planning_ms": 20.0, "set": {}, "helps": False}
"""The fields of a question, and what is taken where they are left out: as the command line has it."""
CELL = "cell"
OF_SET = "set."
TEXT = "scenario"
"""What a text in YAML is called in its faults."""
NOT_ON_PAGE = ("certificate", "trajectory")
"""Fields of an answer that the page does not need of plans that begin behind the minute that it plays."""
NICE = 10
"""A worker for simulations yields the processor to all others, by this priority of the system."""
Placed = Callable[[DocumentError], DocumentError]
"""Gives the faults of a cell where the question has them."""
Stage = Literal["runs", "changes", "page"]


@dataclass(frozen=True)  # with slots, Python code would pickle it
class Question:
    """What is to be simulated, the values that are set in the cell, and whether changes that would help are tried.
    `cell`: its document, or its text in YAML; None: the address names it."""

    arguments: Arguments
    values: Document
    helps: bool
    cell: Document | str | None

    @property
    def simulated_s(self) -> float:
        """The simulated time of all runs, s."""
        return 60.0 * self.arguments.minutes * self.arguments.seeds


@dataclass(frozen=True)
class SimulationProgress:
    """A simulation so far. `stage`: the runs, the trials of changes that would help, or the page of the first run.

    `elapsed_s`: since the worker has begun; `share` of the stage that is over; of the run that is made now its `seed`
    (None: no run is) and its `simulated_s`; `change` that is tried (None: none is).
    """

    stage: Stage
    elapsed_s: float
    share: float
    seed: int | None = None
    simulated_s: float | None = None
    change: str | None = None


def question_in(body: bytes, *, with_cell: bool) -> Question:
    """The question in a body. Raises `Problem`, and `InputError` naming the field."""
    names = [*FIRST, CELL] if with_cell else [*FIRST]
    document = document_in(body, f"an object with some of the fields {', '.join(names)}")
    for name, value in document.items():
        if name not in names:
            raise InputError(name, value, f"no field but {', '.join(names)}")
    given = {**FIRST, **document}
    values, helps, cell = given["set"], given["helps"], given.get(CELL)
    if not isinstance(values, dict) or len(values) > MAX_SET:
        raise InputError("set", values, f"an object with at most {MAX_SET} values of the cell by their paths")
    if not isinstance(helps, bool):
        raise InputError("helps", helps, "true or false")
    if with_cell and not isinstance(cell, dict | str):
        raise InputError(CELL, document.get(CELL, NOTHING), "a cell: the document of a cell file, or its text in YAML")
    own = arguments(*(given[name] for name in ("minutes", "seed", "seeds", "planning_ms")))
    return Question(own, values, helps, cell)


def simulate(digest: str | None, question: Question, most_s: float, line: Line) -> Reply:
    """What `assur simulate --json` prints of a cell, with the page of the first run: the cell with this digest, or that
    of the question. `line` takes how far the simulation has come.

    A simulation that is called off sends the answer that there is by then. One that takes longer than `most_s` ends
    with that.
    """
    laps = Stopwatch()

    def work() -> Answer:
        os.setpriority(os.PRIO_PROCESS, 0, NICE)
        line.means(lambda: f"simulate {_meaning(digest, question)}")
        return _simulated(digest, question, most_s, line, laps)

    return bordered(work)


def _meaning(digest: str | None, question: Question) -> str:
    return hashlib.sha256(json.dumps([digest, asdict(question)], sort_keys=True).encode()).hexdigest()


def _simulated(digest: str | None, question: Question, most_s: float, line: Line, laps: Stopwatch) -> Answer:
    from assur.scenes.simulation.helps import Helps

    given = question.cell if digest is None else kept_cell(digest).file.written
    cell, placed = _text(given) if isinstance(given, str) else (given or {}, _in_cell)
    changed, watch, events = _changed(cell, question.values), _Watch(line.tell, most_s), EventsForPage()

    def result() -> Document:
        return trials.document if question.helps else made.document

    def answer(outcome: str) -> Answer:
        return Answer(to_json(result()), outcome, stages=laps.seconds)

    try:
        made = Simulation(changed.document, *question.arguments)
        trials, outcome = Helps(made), "complete"
        laps.lap("build")
        try:
            made.run(lambda run, now_s: watch.run(made, run, now_s), events)
            if question.helps:
                trials.run(lambda change, share: watch.tell("changes", share, change=change))
        except CalledOffError:
            if made.runs:
                line.tell(answer("incomplete"))
            raise
        except OutOfTimeError as late:
            if not made.runs:
                raise Problem("worker-timeout", f"After {most_s:g} s nothing was simulated.") from late
            outcome = "incomplete"
        laps.lap("simulate")
    except InputError as error:
        raise placed(documented(error).relocated(changed.field)) from error
    except FaultError as fault:
        raise Problem("simulation-fault", str(fault)) from fault
    found = answer(outcome)
    line.tell(found)  # it stays where the job is called off while its page is drawn
    watch.drawing()
    about = str(changed.document.get("about", ""))
    page = run_report(
        events.events,
        title=f"seed {made.first}",
        about=about,
        version=version(),
        found=result(),
        values=question.values,
    )
    laps.lap("draw")
    return replace(found, page=page.encode())


def _changed(cell: Document, values: Document) -> Changed:
    """The cell with the values that are set in it. Raises `InputError` at the path that is wrong."""
    if unknown := unknown_paths(values, OF_SET, FIELDS):
        raise together([*unknown.values()])
    return Changed(cell, values, OF_SET)


def _text(text: str) -> tuple[Document, Placed]:
    """The cell in a text, with the shipped files that it names, and where its faults are: each at its line. Raises
    `InputError`."""
    lines = Lines()

    def line(field: str) -> int | None:
        own = field.removeprefix(f"{CELL}: ")
        return None if own == field else line_of(own, lines)  # of a value that is set, or a field of the question

    def placed(error: DocumentError) -> DocumentError:
        return error.relocated(lambda field: _in_question(field, ": "), line)

    try:
        document, lines = parse_yaml(text.encode("utf-8", "surrogatepass"))
    except InputError as error:  # the text as a whole is the field `cell`
        named = documented(error).relocated(lambda field: CELL if field == TEXT else _in_question(field, ": "))
        raise named from error
    if not isinstance(document, dict):
        raise DocumentError(CELL, document, "a cell", 1)
    try:
        return with_files(document, CELLS), placed
    except InputError as error:
        raise placed(documented(error)) from error


def _in_cell(error: DocumentError) -> DocumentError:
    return error.relocated(lambda field: _in_question(field, "."))


def _in_question(field: str, behind: str) -> str:
    """Where a field of the question, of its values or of the cell is: those of the cell begin with `cell`, and what is
    `behind` it."""
    known = field.partition(".")[0].partition("[")[0]
    return field if field.startswith(OF_SET) or known in FIRST else f"{CELL}{behind}{field}"


class EventsForPage(Events):
    """The calls of the first run, without the tables that its page does not need: in an hour they would be 500 MB."""

    def called(self, event: Document) -> None:
        """As a record."""
        result = event.get("result")
        if event["call"] == "commit" and result is not None and result["starts_s"] > SHOWN_S:
            answer = {key: value for key, value in result["answer"].items() if key not in NOT_ON_PAGE}
            event = {**event, "result": {**result, "answer": answer}}
        super().called(event)


class _Watch:
    """Reports how far a simulation has come, every `PROGRESS_S`. Raises `OutOfTimeError` after `most_s`, and
    `CalledOffError`."""

    def __init__(self, tell: Tell, most_s: float) -> None:
        self._tell, self._most_s, self._began, self._told_s = tell, most_s, time.perf_counter(), -PROGRESS_S

    def run(self, made: Simulation, run: int, now_s: float) -> None:
        share = (run * made.until_s + now_s) / (made.count * made.until_s)
        self.tell("runs", share, seed=made.first + run, simulated_s=now_s)

    def tell(self, stage: Stage, share: float, **more: Any) -> None:
        elapsed_s = time.perf_counter() - self._began
        if elapsed_s > self._most_s:
            raise OutOfTimeError
        if elapsed_s - self._told_s < PROGRESS_S:
            self._tell(None)
            return
        self._told_s = elapsed_s
        self._tell(asdict(SimulationProgress(stage, elapsed_s, share, **more)))

    def drawing(self) -> None:
        """The page is drawn now."""
        self._tell(asdict(SimulationProgress("page", time.perf_counter() - self._began, 0.0)))
