"""How much each client adds to the folder for meshes, so that none of them fills it for all."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable

from assur.api.workers.admission import too_many
from assur.scenes.bounds import MAX_MESH_BYTES

SHARE = 0.25
"""So much of the folder's quota a client may add in `WINDOW_S`, but at least one mesh of the largest size."""
WINDOW_S = 3600.0


class Uploads:
    """The bytes that clients have added in the last `WINDOW_S`. `quota_bytes`: of the folder."""

    def __init__(self, quota_bytes: int, clock: Callable[[], float] = time.monotonic) -> None:
        self._share = max(int(SHARE * quota_bytes), MAX_MESH_BYTES)
        self._clock = clock
        self._added: dict[str, deque[tuple[float, int]]] = {}

    def add(self, client: str, size: int) -> None:
        """Counts an upload of `size` bytes. Raises the `Problem` of a client that has added its share."""
        now = self._clock()
        for name, added in list(self._added.items()):
            while added and added[0][0] <= now - WINDOW_S:
                added.popleft()
            if not added:
                del self._added[name]
        own = self._added.get(client, deque())
        beyond = sum(each for _, each in own) + size - self._share
        if beyond > 0:
            after_s = 0.0
            for at, each in own:
                after_s, beyond = at + WINDOW_S - now, beyond - each
                if beyond <= 0:
                    break
            raise too_many(after_s, f"This client may add {self._share} bytes of meshes in {WINDOW_S / 60:g} minutes.")
        self._added.setdefault(client, deque()).append((now, size))

    def take_back(self, client: str, size: int) -> None:
        """Counts an upload no longer that added nothing."""
        own = self._added.get(client, deque())
        for place, (_, each) in enumerate(own):
            if each == size:
                del own[place]
                return
