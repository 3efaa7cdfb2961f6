"""One service with one real worker for all tests of HTTP that do not kill anything."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from typing import Any

import httpx
import pytest

from assur.api.workers.jobs import FIRST_PLAN
from tests.api.running import running


@pytest.fixture(scope="session")
def anyio_backend() -> str:
    """The library in whose event loop tests run that are coroutines (`pytest.mark.anyio`)."""
    return "asyncio"


@pytest.fixture(scope="session")
def client() -> Iterator[httpx.Client]:
    """A client of a service that is ready."""
    with running() as made:
        yield made


@pytest.fixture
def small() -> dict[str, Any]:
    """A small request that is planned: a copy to change at will."""
    return copy.deepcopy(FIRST_PLAN)
