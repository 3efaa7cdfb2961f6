"""The reverse proxy that the project ships, in front of services of this machine: its own configuration, with other
addresses."""

from __future__ import annotations

import re
import shutil
import socket
import subprocess
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from benchmarks.machine import ROOT
from benchmarks.soak_service.client import fetch, until
from benchmarks.soak_service.row import NotThereError, RowError

CONFIGURATION = ROOT / "deploy" / "haproxy.cfg"
PROGRAM = "haproxy"
START_S = 20.0
OF_NAMES = re.compile(r"\s(?:resolvers|init-addr|resolve-opts|resolve-prefer)\s+\S+")
"""Options of a server by which its name is looked up."""
ELSEWHERE = re.compile(r"\s*(?:user|group|chroot|daemon|pidfile|stats\s+socket)\b")
"""Lines that need a user or a folder of a machine that this one need not be."""


def free_port() -> int:
    """A port of this machine that nobody listens on."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def substituted(text: str, port: int, servers: Sequence[int]) -> str:
    """A configuration of HAProxy that listens on `port` and has the ports `servers` for its servers, which are
    distinguished by their names, in order. Where there are fewer ports than names, several names have one, once in a
    backend.

    The first line with `bind` gets the port, further ones get free ports.
    """
    lines: list[str] = []
    names: list[str] = []
    here: set[int] = set()
    bound, skipping = 0, False
    for line in text.splitlines():
        words = line.split()
        if words and not line[0].isspace():
            here = set()
            skipping = words[0] == "resolvers"
        if skipping or ELSEWHERE.match(line):
            continue
        if words and words[0] == "bind":
            rest = "".join(f" {word}" for word in words[2:])
            lines.append(f"    bind 127.0.0.1:{port if not bound else free_port()}{rest}")
            bound += 1
        elif words and words[0] == "server":
            names += [] if words[1] in names else [words[1]]
            to = servers[names.index(words[1]) % len(servers)]
            rest = OF_NAMES.sub("", "".join(f" {word}" for word in words[3:]))
            lines += [] if to in here else [f"    server {words[1]} 127.0.0.1:{to}{rest}"]
            here.add(to)
        else:
            lines.append(OF_NAMES.sub("", line) if words and words[0] == "default-server" else line)
    if not bound or not names:
        raise NotThereError("a bind and a server in the configuration of the proxy")
    return "\n".join(lines) + "\n"


@contextmanager
def proxied(folder: Path, servers: Sequence[int]) -> Iterator[int]:
    """The port of the shipped proxy in front of services on the ports `servers`; it ends with the block.

    Raises `NotThereError` where there is no configuration, or no HAProxy.
    """
    if not CONFIGURATION.exists():
        raise NotThereError("the configuration of the proxy, deploy/haproxy.cfg")
    program = shutil.which(PROGRAM) or shutil.which(PROGRAM, path="/usr/sbin:/usr/local/sbin")
    if program is None:
        raise NotThereError("HAProxy (Debian: apt-get install haproxy)")
    port = free_port()
    path, log = folder / "haproxy.cfg", folder / "haproxy.log"
    path.write_text(substituted(CONFIGURATION.read_text(encoding="utf-8"), port, servers), encoding="utf-8")
    with log.open("wb") as stream:
        process = subprocess.Popen([program, "-db", "-f", str(path)], stdout=stream, stderr=stream)
    try:
        if not until(START_S, lambda: _passes(port) or process.poll() is not None) or process.poll() is not None:
            raise RowError(f"the proxy does not start: {log.read_text(encoding='utf-8', errors='replace')[-300:]!r}")
        yield port
    finally:
        process.terminate()
        process.wait()


def _passes(port: int) -> bool:
    return fetch(port, "/v1/scenes", timeout=5.0).status == 200
