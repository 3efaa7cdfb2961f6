"""A client of the service: one connection that is kept, from an address of its own in 127.0.0.0/8.

Nothing is sent a second time: a failure is an outcome. A kept connection that was idle for longer than servers keep one
is opened again, as careful clients do.
"""

from __future__ import annotations

import http.client
import json
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import closing, contextmanager
from dataclasses import dataclass, field
from typing import Any

IDLE_S = 2.0
"""A connection that was idle for longer is not used again, s."""
TIMEOUT_S = 120.0


@dataclass(frozen=True)
class Reply:
    """The reply. `status` 0: there is none, and `fault` says why. `began` and `ended` by the monotonic clock, s."""

    status: int
    body: bytes
    headers: Mapping[str, str] = field(default_factory=dict)
    began: float = 0.0
    ended: float = 0.0
    fault: str = ""

    @property
    def seconds(self) -> float:
        return self.ended - self.began

    def document(self) -> Any:
        """The JSON of the body; None where it is none."""
        try:
            return json.loads(self.body)
        except ValueError:
            return None

    @property
    def kind(self) -> str:
        """The end of a problem's type; empty for anything else."""
        document = self.document()
        kind = document.get("type") if isinstance(document, dict) else None
        return kind.rpartition(":")[2] if isinstance(kind, str) else ""

    @property
    def name(self) -> str:
        """The outcome in a word or two: the status, and the kind of problem or of fault."""
        return f"{self.status} {self.kind or self.fault.partition(':')[0]}".strip()

    @property
    def again_s(self) -> float:
        """What `Retry-After` says, s; 1 without one."""
        seconds = self.headers.get("retry-after", "")
        return float(seconds) if seconds.isdigit() else 1.0


class Client:
    """A client at `source`, an address of this machine; `headers` go with every request."""

    def __init__(
        self, port: int, source: str = "127.0.0.1", headers: Mapping[str, str] | None = None, timeout: float = TIMEOUT_S
    ) -> None:
        self._connection = http.client.HTTPConnection("127.0.0.1", port, timeout=timeout, source_address=(source, 0))
        self._headers = dict(headers or {})
        self._used = time.monotonic()

    def get(self, path: str) -> Reply:
        return self.send("GET", path)

    def post(self, path: str, body: bytes) -> Reply:
        return self.send("POST", path, body, {"Content-Type": "application/json"})

    def send(
        self, method: str, path: str, body: bytes | None = None, headers: Mapping[str, str] | None = None
    ) -> Reply:
        """Sends a request and waits for its answer. Raises nothing: see `Reply`."""
        began = time.monotonic()
        if began - self._used > IDLE_S:
            self._connection.close()
        try:
            self._connection.request(method, path, body, {**self._headers, **(headers or {})})
            response = self._connection.getresponse()
            content = response.read()
        except (OSError, http.client.HTTPException) as fault:
            self._connection.close()
            return Reply(0, b"", {}, began, time.monotonic(), f"{type(fault).__name__}: {fault}")
        self._used = time.monotonic()
        received = {name.lower(): value for name, value in response.getheaders()}
        return Reply(response.status, content, received, began, self._used)

    def close(self) -> None:
        self._connection.close()


def fetch(
    port: int, path: str, body: bytes | None = None, source: str = "127.0.0.1", timeout: float = TIMEOUT_S
) -> Reply:
    """The reply to one request on a connection of its own: a GET, or the POST of `body`."""
    with closing(Client(port, source, timeout=timeout)) as client:
        return client.get(path) if body is None else client.post(path, body)


def counted(replies: Iterable[Reply]) -> dict[str, int]:
    """How often each outcome came."""
    return dict(Counter(reply.name for reply in replies))


def served_times(replies: Iterable[Reply]) -> list[float]:
    """How long the requests took that were answered with 200, s."""
    return [reply.seconds for reply in replies if reply.status == 200]


@contextmanager
def together(
    asks: Callable[[int, threading.Event], None], count: int, patience_s: float | None = None
) -> Iterator[threading.Event]:
    """Calls `asks` in `count` threads, each with its number and an event. The event is set when the block ends, or by
    the block; then each thread is waited for, at most `patience_s` (None: until it ends)."""
    stop = threading.Event()
    threads = [threading.Thread(target=asks, args=(number, stop), daemon=True) for number in range(count)]
    for thread in threads:
        thread.start()
    yield stop
    stop.set()
    for thread in threads:
        thread.join(patience_s)


def until(limit_s: float, condition: Callable[[], bool], pause_s: float = 0.1) -> bool:
    """Whether `condition` became true within a time."""
    end = time.monotonic() + limit_s
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(pause_s)
    return True
