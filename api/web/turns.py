"""Who is next where one at a time is served: the clients in turn, whatever each of them has asked for."""

from __future__ import annotations

import asyncio
from collections import OrderedDict, deque

from assur.api.workers.admission import busy, too_many
from assur.api.workers.client import Client

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
