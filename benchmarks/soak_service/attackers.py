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


async def _slow(port: int, told: Counter[str]) -> None:
    reader, writer = await _connected(port)
    told["slow connections"] += 1
    writer.write(HEAD.format(SLOW_BYTES).encode())
    answer = asyncio.ensure_future(reader.readline())
    try:
        for _ in range(SLOW_BYTES):
            writer.write(b"{")
            await writer.drain()
            await asyncio.wait({answer}, timeout=1.0)
            if answer.done():
                told[f"slow bodies answered {_status(answer.result())}"] += 1
                return
    finally:
        answer.cancel()
        writer.close()


async def _idle(port: int, told: Counter[str]) -> None:
    reader, writer = await _connected(port)
    told["idle connections"] += 1
    try:
        told[f"idle connections ended {_status(await reader.read(64))}"] += 1
    finally:
        writer.close()


async def _large(port: int, told: Counter[str], body: bytes) -> None:
    reader, writer = await _connected(port)
    try:
        writer.write(HEAD.format(len(body)).encode() + body)
        await writer.drain()
        told[f"large bodies answered {_status(await reader.readline())}"] += 1
    finally:
        writer.close()
    await asyncio.sleep(LARGE_AGAIN_S)


async def _chunks(port: int, told: Counter[str], body: bytes) -> None:
    reader, writer = await _connected(port)
    told["bodies in small chunks"] += 1
    try:
        writer.write(CHUNKED.encode() + body)
        told[f"small chunks answered {_status(await reader.readline())}"] += 1
    finally:
        writer.close()


def _status(line: bytes) -> str:
    return line[9:12].decode(errors="replace") if line.startswith(b"HTTP/1.") else "without a word"


async def _again_and_again(kind: str, port: int, told: Counter[str], body: bytes) -> None:
    while True:
        try:
            if body:
                await (_large if kind == "large" else _chunks)(port, told, body)
            else:
                await (_slow if kind == "slow" else _idle)(port, told)
        except OSError as error:
            told[f"{kind}: {type(error).__name__}"] += 1
        await asyncio.sleep(AGAIN_S)


async def attack(port: int, seconds: float, slow: int, idle: int, large: int, chunks: int) -> Counter[str]:
    """Attacks for some seconds, and counts what came back."""
    told: Counter[str] = Counter()
    bodies = {"large": unknown_fields(), "chunks": b"1\r\n{\r\n" * MANY_CHUNKS + b"0\r\n\r\n"}
    kinds = ["idle"] * idle + ["slow"] * slow + ["large"] * large + ["chunks"] * chunks
    tasks = [asyncio.ensure_future(_again_and_again(kind, port, told, bodies.get(kind, b""))) for kind in kinds]
    await asyncio.sleep(seconds)
    for task in tasks:
        task.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)
    return told


def main() -> None:
    """Reads the arguments, attacks, and prints the counts."""
    port, seconds, *counts = (float(word) for word in sys.argv[1:])
    files, most = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (max(files, min(4096, most)), most))
    print(json.dumps(asyncio.run(attack(int(port), seconds, *map(int, counts)))))


if __name__ == "__main__":
    main()
