"""What each client may take of what all of them share: a turn where bodies are read one at a time, and room in the
folder for meshes."""

from __future__ import annotations

import asyncio
import time
from collections import OrderedDict, deque
from collections.abc import Callable

from assur.api.workers.admission import busy, too_many
from assur.api.workers.client import Client
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


MOST_WAITING = 128
"""So many wait for a turn at a time, of all clients: each holds a body of up to 1 MiB."""


class Turns:
    """One turn at a time. Each client has one place in the round; what else it asks for waits behind that."""

    def __init__(self, most: int = MOST_WAITING) -> None:
        self._most = most
        self._taken = False
        self._waiting: OrderedDict[str, deque[asyncio.Future[None]]] = OrderedDict()

    def __len__(self) -> int:
        """How many wait."""
        return sum(map(len, self._waiting.values()))

    async def take(self, client: Client) -> None:
        """Returns when it is the turn of this client; `give_on` ends the turn.

        Raises `Problem`: too-many-requests where as many of the client wait as may, busy where too many wait in all.
        """
        if not self._taken:
            self._taken = True
            return
        own = len(self._waiting.get(client.name, ()))
        if own >= max(client.waiting, 1):
            raise too_many(1.0, f"{own} large bodies of this client wait to be read already, and no more may.")
        if len(self) >= self._most:
            raise busy(1.0, "Too many large bodies wait to be read.")
        turn: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._waiting.setdefault(client.name, deque()).append(turn)
        try:
            await turn
        except asyncio.CancelledError:
            if turn.cancelled():
                self._leave(client.name, turn)
            else:
                self.give_on()  # it was given the turn, and does not want it any more
            raise

    def give_on(self) -> None:
        """Ends the turn that was taken, and gives one to the client that has waited for it longest."""
        if not self._waiting:
            self._taken = False
            return
        name, turns = self._waiting.popitem(last=False)
        turns.popleft().set_result(None)
        if turns:
            self._waiting[name] = turns  # at the end of the round

    def _leave(self, name: str, turn: asyncio.Future[None]) -> None:
        self._waiting[name].remove(turn)
        if not self._waiting[name]:
            del self._waiting[name]
