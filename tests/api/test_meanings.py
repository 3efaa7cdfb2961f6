"""What a request means, by which a service knows it again that has ended workers: what is asked, and of what."""

from __future__ import annotations

import json
import socket
from collections.abc import Callable
from typing import Any

import pytest

from assur.api.workers import jobs
from assur.api.workers.jobs import FIRST_PLAN
from assur.api.workers.worker_process import About, Line

JOBS: tuple[Callable[[bytes, Line], Any], ...] = (
    jobs.check, jobs.view, jobs.report, jobs.export, jobs.check_trajectory, jobs.ik,
)  # fmt: skip


class Heard(Line):
    """A line that keeps what it is told."""

    def __init__(self) -> None:
        self.ends = socket.socketpair()
        super().__init__(self.ends[0], About({}, suspect=True))
        self.meanings: list[str] = []

    def means(self, digest: Callable[[], str]) -> None:
        self.meanings.append(digest())


def meaning(job: Callable[..., Any], *arguments: Any) -> str:
    heard = Heard()
    try:
        job(*arguments, heard)
    finally:
        for end in heard.ends:
            end.close()
    (found,) = heard.meanings
    return found


def test_another_kind_of_work_on_the_same_body_is_another_request() -> None:
    body = json.dumps({"request": FIRST_PLAN, "plan": {}}).encode()
    assert len({meaning(job, body) for job in JOBS}) == len(JOBS)


@pytest.mark.parametrize("job", JOBS)
def test_the_same_work_on_the_same_document_is_the_same_request(job: Callable[..., Any]) -> None:
    document = {"request": FIRST_PLAN, "plan": {}}
    turned = {"plan": {}, "request": dict(reversed(FIRST_PLAN.items()))}
    assert meaning(job, json.dumps(document).encode()) == meaning(job, json.dumps(turned, indent=3).encode())
    assert meaning(job, json.dumps(document).encode()) != meaning(job, b'{"request": {}, "plan": {}}')


def test_a_plan_with_the_whole_certificate_is_another_request_than_one_with_its_digest() -> None:
    body = json.dumps(FIRST_PLAN).encode()
    other_seed = json.dumps({**FIRST_PLAN, "options": {**FIRST_PLAN["options"], "seed": 5}}).encode()
    full, digest = (meaning(jobs.plan, body, detail, 10.0) for detail in ("full", "digest"))
    assert full != digest
    assert full == meaning(jobs.plan, other_seed, "full", 10.0)
