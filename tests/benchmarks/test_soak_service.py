"""The soak of the service: a seed sends the same each time, each judge refuses bad figures, the table tells them."""

from __future__ import annotations

import copy
import json
import math
import signal
import threading
from collections import Counter
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path
from typing import Any

import pytest

from assur.scenes.requests import shipped
from benchmarks.machine import ROOT
from benchmarks.soak_service import mutated_requests, schemathesis_phases
from benchmarks.soak_service.client import Client, Reply, until
from benchmarks.soak_service.killed_workers import lost_beyond
from benchmarks.soak_service.large_bodies import of_megabytes, torus
from benchmarks.soak_service.mutated_requests import statuses
from benchmarks.soak_service.mutations import (
    LONGER_BUDGET_S,
    MILD,
    OF_TEXT,
    WRONG,
    every_place,
    mutant,
    put,
    removed,
    text_of,
    value_at,
)
from benchmarks.soak_service.proxy import substituted
from benchmarks.soak_service.row import (
    IN_PART,
    MET,
    NOT_MET,
    NOT_THERE,
    NotThereError,
    Numbers,
    Row,
    RowError,
    Run,
    above,
    judged,
    run_row,
)
from benchmarks.soak_service.rows import ROWS
from benchmarks.soak_service.served import Watch, lost_workers, served
from benchmarks.soak_service.table import KEPT, NOTHING, PAGE, filled, read, table

BY_NAME = {row.name: row for row in ROWS}


def quiet(folder: Path, short: bool = True) -> Run:
    return Run(short, 0, folder, lambda _: None)


# mutants


@pytest.fixture(scope="module")
def scenarios() -> dict[str, dict[str, Any]]:
    return {name: dict(shipped(name).request) for name in ("demo", "transfer", "carton", "parabolic-blend")}


def test_a_mutant_depends_on_its_seed_and_number_alone(scenarios: dict[str, dict[str, Any]]) -> None:
    before = copy.deepcopy(scenarios)
    forwards = [mutant(7, number, scenarios) for number in range(60)]
    backwards = [mutant(7, number, scenarios) for number in reversed(range(60))]
    assert forwards == backwards[::-1]
    assert scenarios == before
    others = [mutant(8, number, scenarios) for number in range(60)]
    assert sum(one.body == other.body for one, other in zip(forwards, others, strict=True)) < 3


def test_every_mutation_is_made_and_the_budgets_stay_small(scenarios: dict[str, dict[str, Any]]) -> None:
    made = [mutant(0, number, scenarios) for number in range(600)]
    assert {each.kind for each in made} == {*WRONG, *MILD}
    assert {each.scenario for each in made} == set(scenarios)
    mild = [json.loads(each.body) for each in made if each.kind in ("jitter", "seed", "other order")]
    assert all(0.01 <= each["options"]["budget_s"] <= LONGER_BUDGET_S for each in mild)
    assert any(each["options"]["budget_s"] == LONGER_BUDGET_S for each in mild)
    assert sum(b"NaN" in each.body or b"1e999" in each.body for each in made if each.kind == "raw text") > 0
    assert max(each.body.count(b"[") + each.body.count(b"{") for each in made if each.kind == "nesting") > 1000
    assert set(WRONG) > OF_TEXT


def test_places_are_found_changed_and_removed() -> None:
    document: dict[str, Any] = {"a": [{"b": 1}], "c": 2}
    assert every_place(document) == [("a",), ("a", 0), ("a", 0, "b"), ("c",)]
    put(document, ("a", 0, "b"), 5)
    assert value_at(document, ("a", 0, "b")) == 5
    removed(document, ("a", 0))
    assert document == {"a": [], "c": 2}


def test_a_lone_surrogate_can_be_sent() -> None:
    assert text_of({"a": "\ud800"}) == b'{"a": "\\ud800"}'


@pytest.mark.slow
def test_large_bodies_are_as_large_as_they_say() -> None:
    assert len(torus(20, 10)) == 84 + 50 * 400
    assert all(300_000 < len(body) <= 1 << 20 for body in of_megabytes().values())


# what is wrong with an answer

DOCUMENTED = {200, 400, 422, 503, 504}
PROBLEM = {"type": "urn:assur:problem:bad-input", "errors": [{"field": "task", "allowed": "a list"}]}


@pytest.mark.parametrize(
    ("status", "document", "faults"),
    [
        (200, {"status": "planned"}, []),
        (422, PROBLEM, []),
        (418, {}, ["undocumented"]),
        (500, {}, ["undocumented", "status_500"]),
        (504, {}, ["status_504"]),
        (503, {"type": "urn:assur:problem:worker-crashed"}, ["worker_crashed"]),
        (200, None, ["not_json"]),
        (422, {"type": "urn:assur:problem:bad-input"}, ["without_field"]),
        (400, {"errors": [{"field": ""}]}, ["without_field"]),
    ],
)
def test_faults_of_an_answer(status: int, document: Any, faults: list[str]) -> None:
    body = b"<html>" if document is None else json.dumps(document).encode()
    assert mutated_requests.faults_of(Reply(status, body), DOCUMENTED) == faults


def test_no_answer_is_a_fault() -> None:
    assert mutated_requests.faults_of(Reply(0, b"", fault="ConnectionResetError"), DOCUMENTED) == ["no_answer"]


def test_described_statuses() -> None:
    described: Any = {"paths": {"/x": {"post": {"responses": {"200": {}, "4XX": {}, "503": {}}}}}}
    found = statuses(described, "POST", "/x")
    assert {200, 400, 499, 503} <= found
    assert not {500, 504, 201} & found
    described["paths"]["/x"]["post"]["responses"]["default"] = {}
    assert 504 in statuses(described, "post", "/x")


def test_a_kill_explains_one_request_that_was_under_way() -> None:
    assert lost_beyond([(0.0, 2.0), (9.0, 11.0)], [1.0, 10.0]) == 0
    assert lost_beyond([(0.0, 2.0), (0.5, 2.0)], [1.0]) == 1  # one worker had one request
    assert lost_beyond([(3.0, 3.1)], [1.0]) == 1  # it began after the kill
    assert lost_beyond([(0.0, 0.5)], [1.0]) == 1  # it had ended before


def test_workers_lost_by_the_metrics() -> None:
    text = (
        "# TYPE assur_worker_restarts_total counter\n"
        'assur_worker_restarts_total{cause="crash"} 2.0\nassur_worker_restarts_total{cause="max_tasks"} 9.0\n'
        'assur_worker_restarts_total{cause="time"} 0.0\n'
    )
    assert lost_workers(text) == {"crash": 2.0}
    with pytest.raises(RowError, match="does not count"):
        lost_workers("process_open_fds 9.0\n")


# verdicts

REPLIES = {"asked": 60, "served": 60, "median_s": 0.15, "longest_s": 0.3, "replies": {"200": 60}}
ATTACKED = {
    "livez": 100,
    "livez_failed": 0,
    "livez_ms": {"50": 2.0, "99": 20.0, "max": 30.0},
    "posts": 9,
    "posts_served": 9,
    "attackers": {"idle connections": 512},
}
LARGE = {
    "group": "seconds",
    "request": "follow",
    "status": 200,
    "outcome": "planned",
    "peak_mib": 200,
    "certificate_bytes": 9000,
}
GOOD: dict[str, Numbers] = {
    "mutated-requests": {
        **dict.fromkeys(mutated_requests.LIMITS, 0),
        "requests": 50_000,
        "asked": 50_000,
        "turned_away": 3,
        "checks": 800,
    },
    "schemathesis": {"asked": 10, "cases": 12, "failures": 0, "phases": [*schemathesis_phases.PHASES]},
    "killed-workers": {
        "seconds": 600,
        "kills": 118,
        "served": 5000,
        "failed": 60,
        "lost_beyond": 0,
        "quarantined": 0,
        "wrong": 0,
        "zombies": 0,
        "web_growth_mib": 1.5,
    },
    "greedy-client": {
        "forms": {name: {"alone": REPLIES, "beside": REPLIES, "times": 1.2} for name in ("address", "key")},
    },
    "slow-connections": {
        "forms": {"without the proxy": {"attacked": ATTACKED, "quiet": ATTACKED}},
        "missing": [],
    },
    "large-requests": {"requests": [LARGE], "peak_mib": 200, "idle_worker_mib": 150},
    "aborted-posts": {
        "aborted": 30,
        "readyz": 600,
        "readyz_failed": 0,
        "quick": 100,
        "quick_failed": 0,
        "workers_lost": 0,
    },
    "rolling-restart": {
        "restarts": 6,
        "requests": 900,
        "lost": 0,
        "jobs_not_told": 0,
        "ended_badly": 0,
        "jobs": {"done": 18},
    },
    "throughput": {
        "ratio": 1.8,
        "plan_ms": 50.0,
        "failed": 0,
        "per_second": 36.0,
        "in_process_per_second": 20.0,
        "options": {"stop": "first"},
    },
}
BAD: list[tuple[str, tuple[Any, ...], Any]] = [
    *(("mutated-requests", (name,), 1) for name in mutated_requests.LIMITS),
    ("mutated-requests", ("requests",), 49_000),
    ("mutated-requests", ("turned_away",), 5000),
    ("mutated-requests", ("checks",), 0),
    ("mutated-requests", ("workers_lost",), math.nan),
    ("schemathesis", ("failures",), 1),
    ("schemathesis", ("failures",), None),
    ("schemathesis", ("cases",), 9),
    ("schemathesis", ("phases",), ["examples", "coverage", "stateful"]),
    *(("killed-workers", (name,), 1) for name in ("lost_beyond", "quarantined", "wrong", "zombies")),
    ("killed-workers", ("web_growth_mib",), 100.0),
    ("killed-workers", ("kills",), 3),
    ("killed-workers", ("served",), 10),
    ("greedy-client", ("forms", "key", "times"), 2.1),
    ("greedy-client", ("forms", "address", "times"), None),
    ("greedy-client", ("forms", "address", "beside", "served"), 59),
    ("slow-connections", ("forms", "without the proxy", "attacked", "livez_failed"), 1),
    ("slow-connections", ("forms", "without the proxy", "attacked", "livez_ms", "99"), 51.0),
    ("slow-connections", ("forms", "without the proxy", "attacked", "livez_ms", "99"), None),
    ("slow-connections", ("forms", "without the proxy", "attacked", "posts_served"), 8),
    ("slow-connections", ("forms", "without the proxy", "attacked", "attackers"), None),
    ("large-requests", ("requests", 0, "peak_mib"), 401),
    ("large-requests", ("requests", 0, "peak_mib"), 0),
    ("large-requests", ("requests", 0, "status"), 504),
    ("large-requests", ("requests", 0, "certificate_bytes"), 100_001),
    ("large-requests", ("requests",), []),
    *(("aborted-posts", (name,), 1) for name in ("readyz_failed", "quick_failed", "workers_lost")),
    ("aborted-posts", ("aborted",), 0),
    *(("rolling-restart", (name,), 1) for name in ("lost", "jobs_not_told", "ended_badly")),
    ("rolling-restart", ("requests",), 20),
    ("rolling-restart", ("jobs",), {"not accepted": 18}),
    ("throughput", ("ratio",), 1.4),
    ("throughput", ("ratio",), math.nan),
    ("throughput", ("plan_ms",), 9.0),
    ("throughput", ("failed",), 1),
]


def test_every_row_has_a_figure_that_is_good_and_some_that_are_not() -> None:
    assert set(GOOD) == set(BY_NAME) == {name for name, _, _ in BAD}
    assert len(BY_NAME) == len(ROWS)


@pytest.mark.parametrize("name", GOOD)
def test_a_good_figure_is_accepted_and_told(name: str) -> None:
    row = BY_NAME[name]
    assert judged(row, GOOD[name]) == (MET, [])
    assert row.module.summary(GOOD[name])


@pytest.mark.parametrize(("name", "place", "value"), BAD)
def test_a_bad_figure_is_refused(name: str, place: tuple[Any, ...], value: Any) -> None:
    numbers = json.loads(json.dumps(GOOD[name]))  # nothing is in two places
    put(numbers, place, value)
    verdict, reasons = judged(BY_NAME[name], numbers)
    assert verdict == NOT_MET
    assert len(reasons) == 1


def test_times_are_told_and_not_judged_in_the_short_form() -> None:
    slow = {**GOOD["throughput"], "ratio": 1.1}
    assert judged(BY_NAME["throughput"], slow)[0] == NOT_MET
    verdict, reasons = judged(BY_NAME["throughput"], slow, short=True)
    assert verdict == IN_PART
    assert "1.1 times" in reasons[0]
    assert judged(BY_NAME["throughput"], {**slow, "failed": 1}, short=True)[0] == NOT_MET


def test_what_is_missing_is_not_met_in_part_only() -> None:
    numbers = {**GOOD["slow-connections"], "missing": ["behind the proxy"]}
    assert judged(BY_NAME["slow-connections"], numbers) == (IN_PART, ["not there: behind the proxy"])


def test_a_figure_that_is_not_there_or_no_number_is_above_every_limit() -> None:
    assert above({"lost": 1}, {"lost": 1}) == []
    assert len(above({"lost": math.nan, "wrong": 2}, {"lost": 0, "wrong": 1, "other": 3})) == 3


class Raising:
    """The module of a row that cannot be measured."""

    def __init__(self, error: Exception) -> None:
        self._error = error

    def measure(self, run: Run) -> Numbers:  # noqa: ARG002
        raise self._error

    def judge(self, numbers: Numbers) -> list[str]:
        raise AssertionError(numbers)

    def summary(self, numbers: Numbers) -> str:
        raise AssertionError(numbers)


def test_a_row_that_cannot_be_measured_is_a_result(tmp_path: Path) -> None:
    for error, verdict in ((NotThereError("the proxy"), NOT_THERE), (RowError("it does not start"), NOT_MET)):
        row = Row("x", "", "", "", Raising(error))
        result = run_row(row, quiet(tmp_path))
        assert (result.verdict, result.reasons) == (verdict, [str(error)])


# the table


def result_of(name: str, verdict: str, **more: Any) -> dict[str, Any]:
    given = {
        "told": "7 of 9",
        "reasons": ["7 | 8 lost"],
        "short": False,
        "load": 1.0,
        "commit": "abcdef" * 6,
        "changed": False,
    }
    return {"name": name, "verdict": verdict, "date": "2026-01-02", **given, **more}


def test_the_table_says_what_was_found_and_what_was_not_run() -> None:
    machine = {"cpu": "a processor", "cores": 2, "python": "3.11"}
    rows = {
        "mutated-requests": result_of("mutated-requests", NOT_MET),
        "throughput": result_of("throughput", MET, short=True, load=12.3, changed=True),
    }
    text = table(ROWS, {"machine": machine, "rows": rows})
    head, *lines = [line for line in text.splitlines() if line]
    assert "2026-01-02 at abcdefabcd, abcdefabcd*" in head
    assert "Of 9 rows 1 are met, 0 in part, 1 not; 7 were not measured" in head
    shown = [line for line in lines if line.startswith("| ") and not line.startswith("| figure")]
    assert len(shown) == len(ROWS)
    assert shown[0].endswith("| 0 / 0 / 0 of 50,000 | 7 of 9 | not met: 7 \\| 8 lost |")
    assert shown[-1].endswith("| 7 of 9 (short form, load 12) | met |")
    assert shown[1].endswith("| not run | not run |")
    assert table(ROWS, {"machine": None, "rows": {}}) == NOTHING


def test_the_page_shows_the_results_that_are_kept() -> None:
    page = PAGE.read_text(encoding="utf-8")
    assert filled(page, table(ROWS, read(KEPT))) == page


def test_a_page_without_a_place_for_the_table_is_refused() -> None:
    with pytest.raises(ValueError, match="0 places"):
        filled("# A page\n", "table")


# the proxy

SHIPPED = """\
global
    log stdout format raw local0
    user haproxy
defaults
    mode http
resolvers docker
    nameserver dns 127.0.0.11:53
frontend in
    bind :8443 ssl crt /etc/cert.pem
    # bind :8444
    default_backend both
backend both
    option httpchk GET /readyz
    default-server check inter 500ms resolvers docker init-addr last,none
    server first assur-1:8000
    server second assur-2:8000 backup
backend jobs_of_the_second
    server second assur-2:8000 check resolvers docker init-addr none
"""


def test_the_proxy_gets_addresses_of_this_machine_and_keeps_the_rest() -> None:
    lines = [line.strip() for line in substituted(SHIPPED, 4000, [5001, 5002]).splitlines()]
    assert "bind 127.0.0.1:4000 ssl crt /etc/cert.pem" in lines
    assert [line for line in lines if line.startswith("server")] == [
        "server first 127.0.0.1:5001",
        "server second 127.0.0.1:5002 backup",
        "server second 127.0.0.1:5002 check",
    ]
    assert {"option httpchk GET /readyz", "default-server check inter 500ms", "# bind :8444"} <= set(lines)
    assert not any("docker" in line or "user" in line for line in lines)
    with pytest.raises(NotThereError):
        substituted("frontend in\n    bind :80\n", 4000, [5001])


def test_one_service_stands_for_all_names_once_in_a_backend() -> None:
    lines = [line.strip() for line in substituted(SHIPPED, 4000, [5001]).splitlines()]
    assert [line for line in lines if line.startswith("server")] == [
        "server first 127.0.0.1:5001",
        "server second 127.0.0.1:5001 check",
    ]


# client and processes


class Telling(BaseHTTPRequestHandler):
    """Answers with the address that it was asked from."""

    def do_GET(self) -> None:
        body = json.dumps({"from": self.client_address[0], "key": self.headers["Authorization"]}).encode()
        self.send_response(200)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, *_: object) -> None:
        """Nothing is printed."""


def test_clients_have_addresses_and_keys_of_their_own_and_a_lost_answer_is_an_outcome() -> None:
    with HTTPServer(("127.0.0.1", 0), Telling) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        client = Client(server.server_port, "127.0.0.9", {"Authorization": "Bearer x"})
        assert client.get("/").document() == {"from": "127.0.0.9", "key": "Bearer x"}
        client.close()
        server.shutdown()
        thread.join()
        port = server.server_port
    reply = Client(port).get("/")
    assert reply.status == 0
    assert "refused" in reply.fault


def test_a_service_with_a_setting_that_it_does_not_know_does_not_start(tmp_path: Path) -> None:
    with pytest.raises(RowError, match="ASSUR_UNHEARD"), served(tmp_path / "log", unheard=1):
        raise AssertionError("it runs with a setting that it cannot know")


@pytest.mark.slow
def test_a_service_is_asked_and_a_worker_that_ends_is_seen(tmp_path: Path) -> None:
    with served(tmp_path / "log", workers=1, max_budget_s=1.0, grace_s=30) as service:
        (worker,) = service.workers()
        client = service.client()
        demo = client.get("/v1/scenes/demo").document()
        bodies = [mutant(3, number, {"demo": demo}).body for number in range(12)]
        replies = [client.post(mutated_requests.PATH, body) for body in bodies]
        assert Counter(fault for reply in replies for fault in mutated_requests.faults_of(reply, DOCUMENTED)) == {}
        assert {reply.status for reply in replies} <= {200, 400, 422}
        with Watch(service) as watch:
            assert until(10.0, lambda: worker.pid in watch.seen)
            worker.send_signal(signal.SIGKILL)
            assert until(30.0, lambda: sum(service.lost().values()) == 1)
        assert watch.peak_mib > 50
        assert service.zombies() == 0 or until(10.0, lambda: service.zombies() == 0)
        client.close()
        assert service.log_lines()[1] == []
    assert not service.web.is_running()


def test_the_rows_are_named_on_the_page() -> None:
    content = PAGE.read_text(encoding="utf-8")
    assert all(f"| {name.replace('-', ' ')} |" in content for name in BY_NAME)
    assert (ROOT / "benchmarks" / "soak_service").is_dir()
