"""Planning a request into a file: what `POST /v1/plans?format=…` has a worker do."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from assur.api.checked_report import checked_report
from assur.api.documents import to_json
from assur.api.workers.jobs import Answer, Reply, bordered, how_planned, request_in
from assur.api.workers.worker_process import Line
from assur.planner.model.deadline import Stopwatch
from assur.scenes.exports.documents import export_document
from assur.scenes.exports.export import file_bytes
from assur.scenes.requests import cell_of, plan_document, plan_scenario, shipped

REPORT, TITLE = "report", "plan"
MEDIA_TYPES = {
    "csv": "text/csv",
    "ros2": "application/yaml",
    "ros2-json": "application/json",
    "glb": "model/gltf-binary",
    "spel": "text/plain",
    "melfa": "text/plain",
    REPORT: "text/html",
}
"""Formats of a file, and what their responses are."""
HEADERS = {
    "Assur-Status": "`planned` or `not_planned`",
    "Assur-Verdict": "`right`: the checker has accepted what is in the file",
    "Assur-Duration-S": "duration of the motion in the file, s",
    "Assur-Request-Digest": "digest of the request against which the motion in the file is proved",
    "Assur-Certificate-Digest": "digest of its proof",
}
"""Headers of a response that is a file, and what each holds; a refusal has the first and the fourth."""


def plan_file(source: bytes | str, how: dict[str, Any], most_budget_s: float, line: Line) -> Reply:
    """The file of a plan: of the request in a body, or of the shipped scenario of that name. `how`: the fields of
    an export, or {"format": "report"}. Where there is no plan, the answer that says so, with the status 409; a report
    of it is a page like any other."""
    given = how_planned("full", most_budget_s, line)
    laps = given["laps"]

    def work() -> Answer:
        if isinstance(source, str):
            scenario = shipped(source)
            request, folder, about = scenario.request, scenario.folder, scenario.about
            answer = plan_scenario(scenario, **given)
        else:
            request, folder, about = request_in(source), None, ""
            answer = plan_document(request, **given)
        return file_of(request, answer, how, laps, folder, about)

    return bordered(work)


def file_of(
    request: dict[str, Any],
    answer: dict[str, Any],
    how: dict[str, Any],
    laps: Stopwatch,
    folder: Path | None = None,
    about: str = "",
) -> Answer:
    """The file of an answer to a request, as `plan_file`. Raises `InputError`."""
    form = how["format"]
    status, reason = answer["status"], str(answer.get("reason", ""))
    stated = {"Assur-Status": status, "Assur-Request-Digest": answer["request_digest"]}
    if form == REPORT:
        page, verdict = checked_report(cell_of(request, folder=folder), answer, TITLE, about)
        laps.lap("draw")
        stated |= {} if verdict is None else {"Assur-Verdict": "right" if verdict["ok"] else "wrong"}
        return Answer(page.encode(), status, reason, laps.seconds, media_type=MEDIA_TYPES[form], headers=stated)
    if status != "planned":
        return Answer(to_json(answer), status, reason, laps.seconds, status=409, headers=stated)
    made = export_document(request, answer, how, folder=folder)
    laps.lap("export")
    stated |= {
        "Assur-Verdict": "right",  # an export is refused unless the checker accepts its motion
        "Assur-Duration-S": str(made["duration_s"]),
        "Assur-Request-Digest": made["request_digest"],
        "Assur-Certificate-Digest": made["certificate_digest"],
        "Content-Disposition": f'attachment; filename="plan.{made["ending"]}"',
    }
    return Answer(file_bytes(made), status, "", laps.seconds, media_type=MEDIA_TYPES[form], headers=stated)
