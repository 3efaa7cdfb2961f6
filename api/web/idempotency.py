"""`Idempotency-Key`: a request that is sent again with the same key gets the first answer, and starts nothing again.

As the draft of the IETF's httpapi group has it. A key belongs to its client and its address. Answers are kept, problems
are not: after a problem, the same key may be sent again.
"""

from __future__ import annotations

import re
import time
from collections import OrderedDict
from collections.abc import Awaitable, Callable
from dataclasses import dataclass

from starlette.requests import Request
from starlette.responses import Response

from assur.api.documents import digest_of
from assur.api.problems import Problem
from assur.api.telemetry.meters import Meters
from assur.api.telemetry.trace import current
from assur.planner.errors import InputError

HEADER = "Idempotency-Key"
KEPT_S = 600.0
"""So long is an answer kept for its key, s."""
MOST_KEYS = 1000
MOST_BYTES = 64 << 20
"""So many keys, and so many bytes of their answers, are kept; the oldest goes first."""
_KEY = re.compile(r'"?([\x21\x23-\x5b\x5d-\x7e]{1,255})"?')
"""A key: visible ASCII characters but for `"` and the backslash, in quotes or without."""


@dataclass(slots=True)
class _Entry:
    """What a key means: the digest of its request, until when, and the answer (None: it is worked on)."""

    request: str
    until: float
    response: Response | None = None

    @property
    def size(self) -> int:
        return 0 if self.response is None else len(self.response.body)


class Idempotency:
    """The keys of one service."""

    def __init__(
        self, meters: Meters, *, kept_s: float = KEPT_S, most: int = MOST_KEYS, most_bytes: int = MOST_BYTES
    ) -> None:
        self._kept_s, self._most, self._most_bytes = kept_s, most, most_bytes
        self._entries: OrderedDict[str, _Entry] = OrderedDict()
        self.bytes = 0
        """Bytes of all answers that are kept."""
        meters.gauge("assur_idempotency_keys", "Idempotency keys that are remembered.", lambda: len(self._entries))

    def __len__(self) -> int:
        return len(self._entries)

    async def once(self, request: Request, body: bytes, work: Callable[[], Awaitable[Response]]) -> Response:
        """What `work` answers, unless its request has a key that was answered before: then that answer.

        Raises `Problem`, of `work` and: bad-input, for a header that is no key; key-reused, key-in-use.
        """
        key = _key_of(request)
        if key is None:
            return await work()
        wanted = digest_of(request.url.query, body)
        self._forget()
        entry = self._entries.get(key)
        if entry is not None:
            return _again(entry, wanted)
        entry = self._entries[key] = _Entry(wanted, time.monotonic() + self._kept_s)
        try:
            response = await work()
            if 200 <= response.status_code < 300:
                entry.response, entry.until = response, time.monotonic() + self._kept_s
                self.bytes += entry.size
                self._entries.move_to_end(key)
            return response
        finally:
            if entry.response is None and self._entries.get(key) is entry:
                del self._entries[key]
            self._forget()

    def _forget(self) -> None:
        """Forgets what is over, and what is too much: of the answers the oldest, which is the first one."""
        now = time.monotonic()
        for key, entry in list(self._entries.items()):
            if entry.response is None:
                continue  # it is worked on, and the queue bounds how many are
            if entry.until > now and len(self._entries) <= self._most and self.bytes <= self._most_bytes:
                break
            self.bytes -= entry.size
            del self._entries[key]


def _again(entry: _Entry, wanted: str) -> Response:
    """The answer to a request whose key is known."""
    if entry.request != wanted:
        raise Problem("key-reused", f"This {HEADER} was sent with another request. Take a new key for each request.")
    if entry.response is None:
        raise Problem(
            "key-in-use",
            f"The request with this {HEADER} is still worked on. Send it again in 1 s.",
            again_s=1,
        )
    current().replayed("key")
    return entry.response


def _key_of(request: Request) -> str | None:
    """Whose key it is, where, and which; None where none is sent. Raises `Problem` for a header that is no key."""
    sent = request.headers.getlist(HEADER)
    if not sent:
        return None
    found = _KEY.fullmatch(sent[0]) if len(sent) == 1 else None
    if found is None:
        allowed = "one key of 1 to 255 visible ASCII characters, without quotation marks and backslashes within"
        raise Problem.of_input(InputError(HEADER, ", ".join(sent), allowed))
    address = request.client.host if request.client else ""
    client = str(current().facts.get("client", address))
    return digest_of(client, request.url.path, found[1])
