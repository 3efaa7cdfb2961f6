"""The rows in the order of the table."""

from __future__ import annotations

from benchmarks.soak_service import (
    aborted_posts,
    greedy_client,
    killed_workers,
    large_requests,
    mutated_requests,
    rolling_restart,
    schemathesis_phases,
    slow_connections,
    throughput,
)
from benchmarks.soak_service.row import Row

ROWS = (
    Row(
        "mutated-requests",
        "mutated requests over HTTP: undocumented or 500 / 504 / worker lost",
        "0 / 167 / 169 of 28,000",
        "0 / 0 / 0 of 50,000",
        mutated_requests,
    ),
    Row(
        "schemathesis",
        "schemathesis, all phases, cases: failures",
        "fuzzing impossible",
        "20,000: 0",
        schemathesis_phases,
    ),
    Row(
        "killed-workers",
        "worker killed every 5 s for 10 min under load, identical bodies: requests lost beyond those in flight",
        "3,496 quarantined",
        "0",
        killed_workers,
    ),
    Row(
        "greedy-client",
        "one greedy client (10 × 10 s budgets): others served, median against alone",
        "0 of 114",
        "all, at most 2 times",
        greedy_client,
        greedy_client.judge_times,
    ),
    Row(
        "slow-connections",
        "64 slow bodies, 512 idle sockets, twenty 1 MB bodies: `/livez` 99 %, without the proxy and with it",
        "503; 3.0 s",
        "at most 50 ms, 0 failures",
        slow_connections,
        slow_connections.judge_times,
    ),
    Row(
        "large-requests",
        "requests that state 1e5 s, dear meshes, bodies of 1 MB: peak of a worker",
        "0.9 to 3.3 GiB",
        "at most 400 MiB, all answered",
        large_requests,
    ),
    Row(
        "aborted-posts",
        "aborted posts, one each 2 s, one worker: `/readyz` failing",
        "38 %",
        "0",
        aborted_posts,
    ),
    Row(
        "rolling-restart",
        "rolling restart under load (two replicas behind the shipped proxy): requests lost",
        "–",
        "0",
        rolling_restart,
    ),
    Row(
        "throughput",
        "requests a second on 2 workers, `demo`, digest, against one after another in process, at 20 ms or more a plan",
        "–",
        "at least 1.5 times",
        throughput,
        throughput.judge_times,
    ),
)
