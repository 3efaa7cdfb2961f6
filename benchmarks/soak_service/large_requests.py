"""Row 6: requests that state 100,000 s, meshes that are dear to cover, many bodies, corners and points, bodies of 1 MB,
and of 16 MB to check. A worker stays below 400 MiB, each is answered in its time, and the proof of a long time is as
short as that of a short one."""

from __future__ import annotations

import json
from typing import Any

from benchmarks.soak_service.client import fetch, until
from benchmarks.soak_service.large_bodies import of_checks, of_counts, of_megabytes, of_meshes, of_seconds
from benchmarks.soak_service.row import Numbers, Run
from benchmarks.soak_service.served import MIB, Service, Watch, forget_peak, peak_kib, served

MOST_MIB, MOST_CERTIFICATE_BYTES = 400.0, 100_000
ANSWERED = frozenset({200, 400, 413, 422})
"""What may come back. 503 and 504 say that the service could not keep what it promises."""
OF_SECONDS, OF_CHECKS = "seconds", "checks"
ADDRESS = {OF_CHECKS: "/v1/plans/check"}
SCENES = ("parabolic-blend", "crowded", "z-down")


def measure(run: Run) -> Numbers:
    """Posts each request twice to a service with one worker, and reads the worker's peak from the system."""
    costs: list[Numbers] = []
    longer_s = run.pick(3.0, 20.0)
    with served(run.below("logs") / "large-requests.log", workers=1) as service:
        scenes = {name: service.scene(name) for name in SCENES}
        idle = service.workers()
        idle_mib = round(idle[0].memory_info().rss / MIB) if idle else None
        groups = {
            OF_SECONDS: of_seconds(scenes, longer_s),
            "meshes": of_meshes(scenes, longer_s),
            "counts": of_counts(),
            "megabytes": of_megabytes(),
            OF_CHECKS: of_checks(),
        }
        with Watch(service) as watch:
            for group, bodies in groups.items():
                for name, body in bodies.items():
                    for _ in range(1 if run.short else 2):
                        cost = _cost(service, ADDRESS.get(group, "/v1/plans"), body)
                        costs.append({"group": group, "request": name, "bytes": len(body), **cost})
                        run.say(str(costs[-1]))
            lost = service.lost()
    peaks = [each["peak_mib"] for each in costs]
    return {
        "idle_worker_mib": idle_mib,
        "peak_mib": max(peaks),
        "web_peak_mib": round(watch.web_peak_mib),
        "workers_lost_by_cause": lost,
        "requests": costs,
    }


def _cost(service: Service, address: str, body: bytes) -> Numbers:
    """What a request costs: the status, the time, the bytes that came, and the peak of the worker."""
    until(60.0, lambda: bool(service.workers()) and service.ready)
    for worker in service.workers():
        forget_peak(worker.pid)
    with Watch(service) as watch:
        reply = fetch(service.port, address, body)
        last = max((peak_kib(worker.pid) for worker in service.workers()), default=0) / 1024
    document: Any = reply.document()
    plan = document if isinstance(document, dict) else {}
    return {
        "status": reply.status,
        "outcome": str(plan.get("status")) if reply.status == 200 else reply.kind or reply.fault,
        "seconds": round(reply.seconds, 2),
        "answer_bytes": len(reply.body),
        "certificate_bytes": len(json.dumps(plan["certificate"])) if "certificate" in plan else 0,
        "peak_mib": round(max(watch.peak_mib, last)),
    }


def judge(numbers: Numbers) -> list[str]:
    """Every request is answered, below 400 MiB, and a proof of 100,000 s has at most 100 kB."""
    found = [] if numbers["requests"] else ["nothing was requested"]
    for each in numbers["requests"]:
        if each["status"] not in ANSWERED:
            found.append(f"{each['request']}: {each['status']} {each['outcome']}")
        if not 0 < each["peak_mib"] <= MOST_MIB:
            found.append(f"{each['request']}: the worker had {each['peak_mib']} MiB, allowed at most {MOST_MIB:g}")
        if each["group"] == OF_SECONDS and each["certificate_bytes"] > MOST_CERTIFICATE_BYTES:
            found.append(f"{each['request']}: a certificate of {each['certificate_bytes']} bytes")
    return found


def summary(numbers: Numbers) -> str:
    """The highest peak, and whose it was."""
    worst = max(numbers["requests"], key=lambda each: each["peak_mib"])
    failed = sum(each["status"] not in ANSWERED for each in numbers["requests"])
    return (
        f"{numbers['peak_mib']} MiB ({worst['request']}), idle {numbers['idle_worker_mib']}; "
        f"{failed} of {len(numbers['requests'])} not answered"
    )
