"""A body in chunks, and how small these may be: each costs the event loop as much as hundreds of bytes."""

from __future__ import annotations

import h11

CHUNK_BYTES = 512
"""Least size of the chunks of a body, on average."""
FIRST_CHUNKS = 128
"""So many chunks do not count: a small body may come in pieces of any size."""
SMALL_CHUNKS = "assur.small_chunks"
"""Key of the state of a request whose body was given up for its small chunks."""
MOST_INCOMPLETE = 16 << 10
"""So long may a head be, or a line of a chunk, that is not complete, bytes; as h11 has it."""


class SmallChunksError(Exception):
    """The chunks of a body are too small, and too many."""


class CountedConnection(h11.Connection):
    """The server's side of a connection, which counts the chunks of each body, and the bytes that it sends."""

    def __init__(self, most_incomplete: int | None) -> None:
        super().__init__(h11.SERVER, MOST_INCOMPLETE if most_incomplete is None else most_incomplete)
        self._chunks = self._bytes = 0
        self.sent = 0
        """Bytes of all that was to be written."""

    def send(self, event: h11.Event) -> bytes | None:  # type: ignore[override]
        """As h11's."""
        data: bytes | None = super().send(event)
        self.sent += len(data or b"")
        return data

    def next_event(self) -> h11.Event | type[h11.NEED_DATA] | type[h11.PAUSED]:
        """As h11's. Raises `SmallChunksError` at the first chunk that is one too many."""
        event = super().next_event()
        if isinstance(event, h11.Request):
            self._chunks = self._bytes = 0
        elif isinstance(event, h11.Data):
            if event.chunk_start:
                self._chunks += 1
                if self._chunks - FIRST_CHUNKS > self._bytes / CHUNK_BYTES:
                    raise SmallChunksError
            self._bytes += len(event.data)
        return event
