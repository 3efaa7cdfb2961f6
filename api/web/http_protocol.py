"""HTTP/1.1 on one connection: uvicorn's h11 protocol, with a time for everything that a client may delay.

uvicorn gives a kept connection a time to begin its next request, and nothing else: a client may send the headers for
ever, or not take its answer. It also takes a client that has finished writing for one that has gone.
"""

from __future__ import annotations

import asyncio
import fcntl
import socket
import struct
import termios
import time
from typing import Any

import h11
from uvicorn.config import Config
from uvicorn.protocols.http.h11_impl import H11Protocol, RequestResponseCycle
from uvicorn.server import ServerState

from assur.api.documents import problem_response
from assur.api.problems import Problem
from assur.api.web.addresses import network
from assur.api.web.body_reader import SMALL_CHUNKS, CountedConnection, SmallChunksError
from assur.api.web.connections import CROWDED, Connections

PIECE_BYTES = 64 << 10
"""What a client must take of an answer in `write_s`, or all of it."""
UNSENT_BYTES = 256 << 10
"""So much of an answer the system keeps of its own for a client, bytes, and not the megabytes to which it would go."""
PROBES_S = (0.25, 1.0, 4.0, 16.0)
"""When a client that has closed its side is asked again whether it is still there, s after the time before."""
LINGER_S = 0.5
"""A service that stops leaves a connection open that was used so short a time ago, s; so long, too, one that has been
told to send larger chunks, for a connection that is closed while more comes loses the answer on its way."""
READ_BYTES = 16 << 10
"""So much is read and parsed of a connection at a time; then it is the turn of the others."""
_BUFFER = memoryview(bytearray(READ_BYTES))
"""What has just been read: all protocols of the process are called by one event loop, and none keeps it."""


class TimedProtocol(H11Protocol, asyncio.BufferedProtocol):
    """One connection. Make it by `functools.partial` with the `Connections` of the service."""

    def __init__(
        self,
        connections: Connections,
        config: Config,
        server_state: ServerState,
        app_state: dict[str, Any],
        _loop: asyncio.AbstractEventLoop | None = None,
    ) -> None:
        super().__init__(config, server_state, app_state, _loop)
        self.conn = self._counted = CountedConnection(config.h11_max_incomplete_event_size)
        self._all = connections
        self._settings = connections.settings
        self._begun = False  # some of the headers of a request are there
        self._closed_side = False  # the client has finished writing
        self._stopping = False
        self._given_up = False  # its chunks are too small: what else it sends is read and dropped
        self._unsent: tuple[float, int] | None = None  # when, and how much of the answers had been taken by then
        self._probe: asyncio.TimerHandle | None = None
        self.address = ""
        self.crowded = False
        self.used = False
        self.since = time.monotonic()

    @property
    def idle(self) -> bool:
        """Whether it waits for a request, or for the rest of the headers of one."""
        cycle: RequestResponseCycle | None = self.cycle  # None before the first request, whatever uvicorn declares
        return cycle is None or cycle.response_complete

    @property
    def waiting(self) -> bool:
        """Whether only its client keeps it: it is idle, or its answer is not taken."""
        return self.idle or (self.flow.write_paused and self.cycle.response_started)

    # --- what the transport tells ---

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        super().connection_made(transport)
        self.address = network(self.client[0] if self.client else "")
        door = transport.get_extra_info("socket")
        if door is not None:
            door.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, UNSENT_BYTES)
        if not self._all.admit(self):
            transport.abort()
        if self.crowded:
            self.app_state = {**self.app_state, CROWDED: True}

    def connection_lost(self, exc: Exception | None) -> None:
        self._all.leave(self)
        self._unset_keepalive_if_required()
        self._unset_probe()
        super().connection_lost(exc)

    def get_buffer(self, sizehint: int) -> memoryview:  # noqa: ARG002 - the protocol of asyncio has it
        """Where the transport is to write what it reads next."""
        return _BUFFER

    def buffer_updated(self, nbytes: int) -> None:
        """The transport has read so many bytes."""
        self.data_received(bytes(_BUFFER[:nbytes]))

    def data_received(self, data: bytes) -> None:
        if self._given_up:
            return
        if self.idle and not self._begun and self.conn.their_state is h11.IDLE:
            self._begun, self.since = True, time.monotonic()
        super().data_received(data)

    def eof_received(self) -> bool:  # type: ignore[override]
        """A client may finish writing and still wait for its answer. True: the connection stays open for it."""
        self._closed_side = True
        if self.idle or self.cycle.more_body:
            return False
        self._ask_whether_there(0)
        return True

    # --- what uvicorn does with it ---

    def handle_events(self) -> None:
        if self._given_up:
            return
        try:
            super().handle_events()
        except SmallChunksError:  # whoever reads the body answers; `look` closes the connection then
            self._given_up = True
            self.scope["state"][SMALL_CHUNKS] = True
            self.cycle.more_body = False
            self.cycle.message_event.set()
        if not self.idle:
            self._begun = False

    def _unsupported_upgrade_warning(self) -> None:
        """Nothing: to ask for another protocol is no trouble of the service. `Gate` refuses WebSockets."""

    def on_response_complete(self) -> None:
        self._unset_probe()
        self.used, self.since = True, time.monotonic()
        super().on_response_complete()
        if self.transport.is_closing():
            return
        if self.idle:
            self._begun = self.conn.their_state is h11.IDLE and bool(self.conn.trailing_data[0])
        if self._closed_side and (self.idle or self.cycle.more_body):
            self._close()  # of what was sent before the client finished, all has been answered
        elif self._stopping and self.idle and not self._begun:
            self._close()

    def timeout_keep_alive_handler(self) -> None:
        if self.idle and not self._begun and not self._arriving():
            super().timeout_keep_alive_handler()

    def shutdown(self) -> None:
        """The service does not take connections any more. What was begun is answered; what was used a moment ago, or is
        new, may have a request on its way: it is left for `LINGER_S`."""
        self._stopping = True
        if self.idle:
            self._stop_if_quiet(time.monotonic())

    # --- what `Connections` asks ---

    def look(self, now: float) -> None:
        """Closes what has taken too long: headers, the rest of a body that nobody reads, an answer not taken."""
        size = self.transport.get_write_buffer_size()
        taken = self._counted.sent - size
        if size == 0:
            self._unsent = None
        elif self._unsent is None or taken >= self._unsent[1] + PIECE_BYTES:
            self._unsent = (now, taken)
        elif now - self._unsent[0] > self._settings.write_s:
            self._all.leave(self)
            self.transport.abort()
            return
        if not self.idle or self.transport.is_closing():
            return
        waited = now - self.since
        if self._begun or not self.used:
            if waited > self._settings.header_s and (self._begun or not self._arriving()):
                self._refuse_late_headers() if self._begun else self._close()
                return
        elif self.conn.their_state is not h11.IDLE and waited > (LINGER_S if self._given_up else self._settings.body_s):
            self._close()  # it was answered before its body had come, and goes on sending
            return
        if self._stopping:
            self._stop_if_quiet(now)

    def give_way(self) -> None:
        """Closes it at once, which is `waiting`, in favour of another: `Connections` has forgotten it already."""
        self.transport.abort() if self.transport.get_write_buffer_size() else self._close()

    # --- ends ---

    def _stop_if_quiet(self, now: float) -> None:
        quiet = not self._begun and not self._arriving()
        if quiet and now - self.since >= LINGER_S:
            self._close()

    def _arriving(self) -> bool:
        """Whether something has come that has not been read yet."""
        door = self.transport.get_extra_info("socket")
        if door is None or self.transport.is_closing() or door.fileno() < 0:
            return False
        waiting = fcntl.ioctl(door.fileno(), termios.FIONREAD, struct.pack("i", 0))
        return bool(struct.unpack("i", waiting)[0])

    def _close(self) -> None:
        """Closes the connection after what has been written to it; `look` sees to it that this ends."""
        if not self.transport.is_closing():
            self.transport.close()

    def _refuse_late_headers(self) -> None:
        problem = Problem("too-slow", f"The headers were not complete after {self._settings.header_s:g} s.")
        answer = problem_response(problem)
        headers = [*answer.raw_headers, (b"connection", b"close")]
        written = [
            self.conn.send(h11.Response(status_code=answer.status_code, headers=headers, reason=b"Request Timeout")),
            self.conn.send(h11.Data(data=bytes(answer.body))),
            self.conn.send(h11.EndOfMessage()),
        ]
        self.transport.write(b"".join(part for part in written if part))
        self._close()

    # --- whether a client that has finished writing is still there ---

    def _ask_whether_there(self, times: int) -> None:
        """Writes an interim answer, which every client of HTTP/1.1 skips.

        A client that has closed its side and one that has gone look the same until something is written to them: the
        machine of the latter then resets the connection, and the next time that something is written this is an error.
        """
        if self.idle or self.cycle.response_started or self.scope["http_version"] != "1.1":
            return
        if self.transport.is_closing():
            return
        event = h11.InformationalResponse(status_code=100, headers=[], reason=b"Continue")
        self.transport.write(self.conn.send(event) or b"")
        if times < len(PROBES_S):
            self._probe = self.loop.call_later(PROBES_S[times], self._ask_whether_there, times + 1)

    def _unset_probe(self) -> None:
        if self._probe is not None:
            self._probe.cancel()
            self._probe = None
