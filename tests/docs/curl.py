"""What a line of curl sends, sent by httpx, for machines that have no curl: `python -m tests.docs.curl -s ADDRESS`."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import httpx

SILENT = ("-s", "-sf")
"""Options that change nothing of what is sent."""


def sent(words: Sequence[str], folder: Path) -> httpx.Response:
    """The response to the words of a line after `curl`; an option that is not understood is an error."""
    given, headers, body, method, target = list(words), {}, None, None, None
    while given:
        word = given.pop(0)
        if word == "-H":
            name, _, headers[name] = (part.strip() for part in given.pop(0).partition(":"))
        elif word in ("-d", "--data-binary"):
            data = given.pop(0)
            body = (folder / data[1:]).read_bytes() if data.startswith("@") else data.encode()
        elif word == "-X":
            method = given.pop(0)
        elif word not in SILENT:
            assert target is None
            assert word.startswith("http://"), word
            target = word
    assert target is not None
    method = method or ("GET" if body is None else "POST")
    return httpx.request(method, target, headers=headers, content=body, timeout=120)


if __name__ == "__main__":
    response = sent(sys.argv[1:], Path())
    response.raise_for_status()
    sys.stdout.write(response.text)
