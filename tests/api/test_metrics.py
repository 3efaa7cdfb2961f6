"""What operators read: every metric is described, every alert is about one that is there, and the counts are right."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import httpx
import yaml
from prometheus_client.parser import text_string_to_metric_families

from assur.api.keys import KeysDocument, write
from assur.api.telemetry.meters import CAUSES, STAGES, Meters
from assur.api.web.app import create_app
from assur.api.web.settings import Settings

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "operating.md").read_text(encoding="utf-8")
ALERTS = ROOT / "deploy" / "alerts.yaml"
SECRET = "the-customers-own-words"


def metrics(text: str) -> dict[str, tuple[str, frozenset[str]]]:
    """Of each metric of ours in a text its type and labels, by the name that a query has."""
    found = {}
    for family in text_string_to_metric_families(text):
        name = family.name + ("_total" if family.type == "counter" else "")
        labels = {label for sample in family.samples for label in sample.labels} - {"le"}
        if name.startswith("assur_"):
            found[name] = (family.type, frozenset(labels))
    return found


def all_metrics() -> dict[str, tuple[str, frozenset[str]]]:
    """Those of a service that has everything, in which everything has happened once."""
    with TemporaryDirectory() as folder:
        write(Path(folder, "keys"), KeysDocument())
        settings = Settings(workers=1, keys_file=str(Path(folder, "keys")), mesh_folder=folder)
        meters: Meters = create_app(settings).state.service.meters
    meters.answered("/v1/plans", "POST", 429, "", "busy", 0.1)
    meters.worked("plan", "not_planned", "OUT_OF_REACH", {"search": 0.1})
    meters.queued(0.1)
    meters.restarted("crash")
    meters.results.labels("hit").inc()
    return metrics(meters.text().decode())


def test_the_table_of_metrics_is_whole_with_types_and_labels() -> None:
    section = PAGE.partition("## Metrics")[2].partition("## Tracing")[0]
    rows = re.findall(r"^\| `(assur_\w+)` \| (\w+) \|([^|]*)\|", section, re.MULTILINE)
    assert {name: (kind, frozenset(re.findall(r"`(\w+)`", labels))) for name, kind, labels in rows} == all_metrics()
    for word in (*CAUSES, *STAGES):
        assert f"`{word}`" in section, word


def not_there(expression: str, known: set[str]) -> set[str]:
    """Metrics that an expression names and that are not known."""
    return {name for name in re.findall(r"\bassur_\w+", expression) if re.sub("_bucket$", "", name) not in known}


def test_every_alert_is_about_metrics_that_are_there_and_says_what_to_do() -> None:
    known = set(all_metrics())
    rules: list[dict[str, Any]] = yaml.safe_load(ALERTS.read_text(encoding="utf-8"))["groups"][0]["rules"]
    assert len(rules) >= 8
    for rule in rules:
        assert "assur_" in rule["expr"]
        assert not_there(rule["expr"], known) == set(), rule["alert"]
        assert rule["annotations"].keys() == {"summary", "action"}
        for cause in re.findall(r'cause=~?"([a-z_|]+)"', rule["expr"]):
            assert set(cause.split("|")) <= set(CAUSES)
    assert not_there("rate(assur_request_total[5m])", known) == {"assur_request_total"}


def test_the_tool_of_prometheus_takes_the_alerts_where_it_is_installed() -> None:
    tool = shutil.which("promtool")
    checked = (
        None if tool is None else subprocess.run([tool, "check", "rules", ALERTS], capture_output=True, check=False)
    )
    assert checked is None or checked.returncode == 0, checked.stdout


def value(text: str, name: str, **labels: str) -> float:
    """Of a metric, those samples added that have these labels."""
    return sum(
        sample.value
        for family in text_string_to_metric_families(text)
        for sample in family.samples
        if sample.name == name and labels.items() <= sample.labels.items()
    )


def test_requests_are_counted_by_route_status_outcome_and_problem_and_never_by_what_was_sent(
    client: httpx.Client, small: dict[str, Any]
) -> None:
    before = client.get("/metrics").text
    client.post("/v1/plans", json=small)
    client.post("/v1/plans", json={SECRET: 1})
    client.get(f"/{SECRET}")
    client.request(SECRET.upper(), "/v1/plans")
    answer = client.get("/metrics")
    assert answer.headers["content-type"].startswith("text/plain; version=")
    after = answer.text
    for labels in (
        {"route": "/v1/plans", "method": "POST", "status": "200", "outcome": "planned", "problem": ""},
        {"route": "/v1/plans", "method": "POST", "status": "422", "outcome": "", "problem": "bad-input"},
        {"route": "none", "method": "GET", "status": "404", "problem": "not-found"},
        {"method": "OTHER", "status": "405", "problem": "method-not-allowed"},
    ):
        name = "assur_requests_total"
        assert value(after, name, **labels) == value(before, name, **labels) + 1, labels
    for stage in ("read", "build", "search", "margins", "write"):
        name = "assur_stage_seconds_count"
        assert value(after, name, stage=stage) == value(before, name, stage=stage) + 1
    assert value(after, "assur_stage_seconds_count", stage="queue") == 2 + value(
        before, "assur_stage_seconds_count", stage="queue"
    )
    assert value(after, "assur_workers_ready") == value(after, "assur_workers") == 1
    assert value(after, "assur_requests_running") == value(after, "assur_requests_waiting") == 0
    assert value(after, "assur_resident_memory_bytes", process="worker-0") > 10e6
    assert SECRET.lower() not in after.lower()


def test_two_services_of_a_process_do_not_share_counts() -> None:
    one, other = Meters(), Meters()
    one.restarted("crash")
    assert value(one.text().decode(), "assur_worker_restarts_total", cause="crash") == 1
    assert value(other.text().decode(), "assur_worker_restarts_total", cause="crash") == 0
