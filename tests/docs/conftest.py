"""One service for all that the pages show of HTTP."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.api.processes import serving, until
from tests.docs.pages import ENVIRONMENT


@pytest.fixture(scope="session")
def service() -> Iterator[str]:
    """`assur serve` as a process of its own on a free port; its address."""
    with serving(others=ENVIRONMENT, WORKERS="1", GRACE_S="30") as server:
        until(server.ready)
        yield server.address
