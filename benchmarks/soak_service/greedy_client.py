"""Row 4: one client asks for ten plans of 10 s at a time, again and again; two others ask for short ones now and then.
The short ones are all served, at most twice as slowly as without the greedy one."""

from __future__ import annotations

import hashlib
import json
import statistics
import threading
import time
from collections.abc import Callable
from pathlib import Path

from benchmarks.soak_service.client import Client, Reply, counted, served_times, together
from benchmarks.soak_service.row import Numbers, Run
from benchmarks.soak_service.served import Service, served

SECONDS, FEW_SECONDS = 60.0, 6.0
GREEDY, LIGHT, WORKERS = 10, 2, 2
GREEDY_S, LIGHT_S, PAUSE_S = 10.0, 0.15, 0.48
"""Budgets of both kinds, and the pause between two of the light ones, s."""
HEAD_START_S = 2.0
MOST_TIMES = 2.0

Connect = Callable[[str, int], Client]
"""A connection of a client by name; the number tells its connections apart."""


def body_of(service: Service, budget_s: float) -> bytes:
    """The demo, searched until its budget ends."""
    document = service.scene("demo")
    options = {key: value for key, value in document.get("options", {}).items() if key != "max_candidates"}
    return json.dumps({**document, "options": {**options, "stop": "budget", "budget_s": budget_s}}).encode()


def measure(run: Run) -> Numbers:
    """Both forms, by address and by key; each alone first, then beside the greedy client."""
    forms = {}
    logs = run.below("logs")
    addresses = {"greedy": "127.0.0.31", "light-0": "127.0.0.32", "light-1": "127.0.0.33"}
    with served(logs / "greedy-by-address.log", workers=WORKERS, patience_s=0.0) as service:
        bodies = body_of(service, LIGHT_S), body_of(service, GREEDY_S)
        forms["address"] = _form(run, bodies, lambda name, _: service.client(addresses[name]))
    path, keys = keys_file(run.below("greedy-client"), list(addresses))
    with served(logs / "greedy-by-key.log", workers=WORKERS, patience_s=0.0, keys_file=path) as service:
        forms["key"] = _form(run, bodies, lambda name, _: service.client(key=keys[name]))
    return {"forms": forms}


def _form(run: Run, bodies: tuple[bytes, bytes], connect: Connect) -> Numbers:
    light, greedy = bodies
    lasts_s = run.pick(FEW_SECONDS, SECONDS)
    alone = _light_ones(connect, light, lasts_s)
    run.say(f"alone: {_summary(alone)}")
    of_greedy: list[Reply] = []

    def asks(number: int, stop: threading.Event) -> None:
        client = connect("greedy", number)
        while not stop.is_set():
            reply = client.post("/v1/plans?certificate=digest", greedy)
            of_greedy.append(reply)
            if reply.status != 200:
                stop.wait(min(max(reply.again_s, 0.2), 5.0))
        client.close()

    # the requests of the greedy client end with the service
    with together(asks, GREEDY, patience_s=0.0):
        time.sleep(HEAD_START_S)
        beside = _light_ones(connect, light, lasts_s)
    run.say(f"beside: {_summary(beside)}")
    found: Numbers = {
        "alone": _summary(alone),
        "beside": _summary(beside),
        "greedy": counted(of_greedy),
    }
    medians = found["alone"]["median_s"], found["beside"]["median_s"]
    found["times"] = round(medians[1] / medians[0], 2) if all(medians) else None
    return found


def _light_ones(connect: Connect, body: bytes, lasts_s: float) -> list[Reply]:
    replies: list[Reply] = []

    def asks(number: int, _: threading.Event) -> None:
        client = connect(f"light-{number}", 0)
        end = time.monotonic() + lasts_s
        while time.monotonic() < end:
            replies.append(client.post("/v1/plans?certificate=digest", body))
            time.sleep(PAUSE_S)
        client.close()

    with together(asks, LIGHT):
        pass
    return replies


def _summary(replies: list[Reply]) -> Numbers:
    times = served_times(replies)
    return {
        "asked": len(replies),
        "served": len(times),
        "median_s": round(statistics.median(times), 3) if times else None,
        "longest_s": round(max(times), 3) if times else None,
        "replies": counted(replies),
    }


def judge(numbers: Numbers) -> list[str]:
    """In each form all light requests are served, also beside the greedy client."""
    found = [] if numbers["forms"] else ["nothing was requested"]
    for name, form in numbers["forms"].items():
        for phase in ("alone", "beside"):
            required, served_ = form[phase]["asked"], form[phase]["served"]
            if served_ < required or not required:
                found.append(f"by {name}, {phase}: {served_} of {required} served")
    return found


def judge_times(numbers: Numbers) -> list[str]:
    """In each form the median of the light requests at most doubles beside the greedy client."""
    found = []
    for name, form in numbers["forms"].items():
        if form["times"] is None or not form["times"] <= MOST_TIMES:
            found.append(f"by {name}: median {form['times']} times that alone, allowed at most {MOST_TIMES:g}")
    return found


def summary(numbers: Numbers) -> str:
    """The share that was served and the ratio of medians, by form."""
    return "; ".join(
        f"by {name}: {form['beside']['served']} of {form['beside']['asked']}, "
        + (f"{form['times']:g} times" if form["times"] is not None else "no median")
        for name, form in numbers["forms"].items()
    )


def keys_file(folder: Path, names: list[str]) -> tuple[Path, dict[str, str]]:
    """A file for ASSUR_KEYS_FILE with a key for each name, and the keys by name."""
    keys = {name: hashlib.sha256(f"soak {name}".encode()).hexdigest() for name in names}
    path = folder / "keys.json"
    hashed = [{"name": name, "sha256": hashlib.sha256(key.encode()).hexdigest()} for name, key in keys.items()]
    path.write_text(json.dumps({"schema": "assur-keys/1", "keys": hashed}), encoding="utf-8")
    return path, keys
