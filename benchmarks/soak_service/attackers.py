"""``python -m benchmarks.soak_service.attackers PORT SECONDS SLOW IDLE LARGE CHUNKS``: clients that do harm.

A process of its own, so that what it does costs the measuring process nothing. SLOW connections send a body a byte a
second, IDLE ones send nothing, LARGE ones send at once a body of 1 MB each that is refused only after it was read, and
CHUNKS ones a body in chunks of a byte; all come again when they are answered or closed. Its last line is JSON: how
often that was.
"""

from __future__ import annotations

import asyncio
import json
import resource
import sys
from collections import Counter

from benchmarks.soak_service.large_bodies import unknown_fields

SOURCE = "127.0.0.66"
HEAD = "POST /v1/plans HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Type: application/json\r\nContent-Length: {}\r\n\r\n"
CHUNKED = HEAD.replace("Content-Length: {}", "Transfer-Encoding: chunked")
MANY_CHUNKS = 200_000
"""Chunks of such a body."""
AGAIN_S = 0.5
"""Pause before a connection that was closed comes again, s."""
LARGE_AGAIN_S = 10.0
SLOW_BYTES = 1000

Streams = tuple[asyncio.StreamReader, asyncio.StreamWriter]


async def _connected(port: int) -> Streams:
    return await asyncio.open_connection("127.0.0.1", port, local_addr=(SOURCE, 0))


async def _slow(port: int, counts: Counter[str], head: bytes) -> None:
    reader, writer = await _connected(port)
    counts["slow connections"] += 1
    writer.write(head)
    answer = asyncio.ensure_future(reader.readline())
    try:
        for _ in range(SLOW_BYTES):
            writer.write(b"{")
            await writer.drain()
            await asyncio.wait({answer}, timeout=1.0)
            if answer.done():
                counts[f"slow bodies answered {_status(answer.result())}"] += 1
                return
    finally:
        answer.cancel()
        writer.close()


async def _sent(port: int, counts: Counter[str], kind: str, data: bytes) -> None:
    """Sends all at once, or nothing, and waits for what comes."""
    reader, writer = await _connected(port)
    counts[f"{kind} connections"] += 1
    try:
        writer.write(data)
        counts[f"{kind} answered {_status(await reader.readline())}"] += 1
    finally:
        writer.close()


def _status(line: bytes) -> str:
    return line[9:12].decode(errors="replace") if line.startswith(b"HTTP/1.") else "without a word"


async def _again_and_again(kind: str, port: int, counts: Counter[str], data: bytes) -> None:
    while True:
        try:
            await (_slow(port, counts, data) if kind == "slow" else _sent(port, counts, kind, data))
        except OSError as error:
            counts[f"{kind}: {type(error).__name__}"] += 1
        await asyncio.sleep(LARGE_AGAIN_S if kind == "large" else AGAIN_S)


async def attack(port: int, seconds: float, slow: int, idle: int, large: int, chunks: int) -> Counter[str]:
    """Attacks for some seconds, and counts what came back."""
    counts: Counter[str] = Counter()
    body, chunked = unknown_fields(), b"1\r\n{\r\n" * MANY_CHUNKS + b"0\r\n\r\n"
    sent = {
        "idle": b"",
        "slow": HEAD.format(SLOW_BYTES).encode(),
        "large": HEAD.format(len(body)).encode() + body,
        "chunks": CHUNKED.encode() + chunked,
    }
    kinds = ["idle"] * idle + ["slow"] * slow + ["large"] * large + ["chunks"] * chunks
    tasks = [asyncio.ensure_future(_again_and_again(kind, port, counts, sent[kind])) for kind in kinds]
    await asyncio.sleep(seconds)
    for task in tasks:
        task.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)
    return counts


def main() -> None:
    """Reads the arguments, attacks, and prints the counts."""
    port, seconds, *counts = (float(word) for word in sys.argv[1:])
    files, most = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (max(files, min(4096, most)), most))
    print(json.dumps(asyncio.run(attack(int(port), seconds, *map(int, counts)))))


if __name__ == "__main__":
    main()
