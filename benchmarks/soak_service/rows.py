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

ROWS = (
    mutated_requests.ROW,
    schemathesis_phases.ROW,
    killed_workers.ROW,
    greedy_client.ROW,
    slow_connections.ROW,
    large_requests.ROW,
    aborted_posts.ROW,
    rolling_restart.ROW,
    throughput.ROW,
)
