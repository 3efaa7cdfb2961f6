"""Row 5: slow bodies, idle sockets, large bodies and bodies in small chunks at the same time. /livez is answered at
once, others' posts are served; without the proxy, and behind it."""

from __future__ import annotations

import json
import subprocess
import sys
import threading
import time
from contextlib import ExitStack

from benchmarks.machine import ROOT
from benchmarks.soak_service.client import Reply, counted, fetch, served_times, together
from benchmarks.soak_service.large_bodies import small
from benchmarks.soak_service.proxy import proxied
from benchmarks.soak_service.row import NotThereError, Numbers, Run
from benchmarks.soak_service.served import served

SECONDS, FEW_SECONDS, QUIET_S = 60.0, 8.0, 3.0
SLOW, IDLE, LARGE, CHUNKS = 64, 512, 20, 8
PROBE_S, POST_S, PATIENCE_S = 0.05, 0.5, 3.0
"""Time between two requests of /livez and of a quick plan; how long a probe waits, s. Orchestrators wait 1 to 5 s."""
MOST_MS = 50.0
ATTACKED, QUIET = "attacked", "quiet"
BEHIND = {"forwarded_from": "127.0.0.1"}
"""With which a service believes the proxy who asks."""


def measure(run: Run) -> Numbers:
    """Both forms; each is quiet for some seconds first, to measure the machine without load."""
    forms: dict[str, Numbers] = {}
    missing: list[str] = []
    for name in ("without the proxy", "behind the proxy"):
        folder = run.below("slow-connections")
        with (
            ExitStack() as stack,
            served(run.below("logs") / f"slow, {name}.log", workers=1, patience_s=0.0, settings=BEHIND) as service,
        ):
            port = service.port
            if name == "behind the proxy":
                try:
                    port = stack.enter_context(proxied(folder, [service.port]))
                except NotThereError as absent:
                    missing.append(f"{name}: {absent}")
                    continue
            probe = port if fetch(port, "/livez", timeout=PATIENCE_S).status == 200 else service.port
            forms[name] = {
                "livez_through_proxy": probe != service.port,
                QUIET: _probed(probe, port, QUIET_S),
                ATTACKED: _attacked(probe, port, run.pick(FEW_SECONDS, SECONDS)),
                "web_mib": round(service.rss_mib()),
            }
            run.say(f"{name}: {forms[name]}")
    return {"forms": forms, "missing": missing}


def _attacked(probe: int, port: int, lasts_s: float) -> Numbers:
    words = [str(port), str(lasts_s + 3), str(SLOW), str(IDLE), str(LARGE), str(CHUNKS)]
    command = [sys.executable, "-m", "benchmarks.soak_service.attackers", *words]
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True) as attackers:
        time.sleep(1.5)  # they have connected
        found = _probed(probe, port, lasts_s)
        printed, _ = attackers.communicate()
    last = printed.strip().splitlines()[-1:]
    return {**found, "attackers": json.loads(last[0]) if last else None}


def _probed(probe: int, port: int, lasts_s: float) -> Numbers:
    """Probes of /livez, each on a connection of its own, and quick plans of another client, for some seconds."""
    body = small(options={"stop": "first", "budget_s": 5})
    plans: list[Reply] = []

    def asks(_: int, stop: threading.Event) -> None:
        while not stop.is_set():
            plans.append(fetch(port, "/v1/plans?certificate=digest", body, "127.0.0.51", timeout=30.0))
            stop.wait(POST_S)

    probes: list[Reply] = []
    end = time.monotonic() + lasts_s
    with together(asks, 1):
        while time.monotonic() < end:
            probes.append(fetch(probe, "/livez", source="127.0.0.52", timeout=PATIENCE_S))
            time.sleep(PROBE_S)
    times = sorted(1e3 * seconds for seconds in served_times(probes))
    return {
        "livez": len(probes),
        "livez_failed": len(probes) - len(times),
        "livez_ms": {name: _quantile(times, share) for name, share in (("50", 0.5), ("99", 0.99), ("max", 1.0))},
        "posts": len(plans),
        "posts_served": sum(reply.status == 200 for reply in plans),
        "post_replies": counted(plans),
        "longest_post_s": round(max((reply.seconds for reply in plans), default=0.0), 2),
    }


def _quantile(ordered: list[float], share: float) -> float | None:
    return round(ordered[min(len(ordered) - 1, int(share * len(ordered)))], 1) if ordered else None


def judge(numbers: Numbers) -> list[str]:
    """In each form no probe fails, and every post of others is served."""
    found = [] if numbers["forms"] else ["nothing was requested"]
    for name, form in numbers["forms"].items():
        attacked = form[ATTACKED]
        if attacked["livez_failed"] or not attacked["livez"]:
            found.append(f"{name}: {attacked['livez_failed']} of {attacked['livez']} probes of /livez failed")
        if attacked["posts_served"] < attacked["posts"] or not attacked["posts"]:
            found.append(f"{name}: {attacked['posts_served']} of {attacked['posts']} posts of others were served")
        if not attacked["attackers"]:
            found.append(f"{name}: the attack did not take place")
    return found


def judge_times(numbers: Numbers) -> list[str]:
    """In each form 99 % of the probes are answered within 50 ms."""
    late = {name: form[ATTACKED]["livez_ms"]["99"] for name, form in numbers["forms"].items()}
    return [
        f"{name}: 99 % of /livez within {each} ms, allowed at most {MOST_MS:g}"
        for name, each in late.items()
        if each is None or not each <= MOST_MS
    ]


def summary(numbers: Numbers) -> str:
    """99 % of /livez, failures, and posts of others, by form."""
    return "; ".join(
        f"{name}: {form[ATTACKED]['livez_ms']['99']} ms ({form[QUIET]['livez_ms']['99']} when quiet), "
        f"{form[ATTACKED]['livez_failed']} of {form[ATTACKED]['livez']} failed, "
        f"{form[ATTACKED]['posts_served']} of {form[ATTACKED]['posts']} posts served"
        for name, form in numbers["forms"].items()
    )
