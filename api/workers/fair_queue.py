"""The order in which requests that wait are given workers: each client gets the same share of the workers' time.

Start-time fair queueing (Goyal, Vin, Cheng 1996): a request is tagged with the virtual time at which its client's
earlier ones have been paid for, or with the present virtual time if that is later; the least tag is next. A client that
asks for much waits behind itself, not before others, and saves nothing up while it is away.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from assur.api.workers.client import Ticket


class FairQueue:
    """Tickets that wait. Costs and virtual times are seconds of a worker."""

    def __init__(self) -> None:
        self._waiting: list[Ticket] = []
        self._paid: dict[str, float] = {}
        self._now = 0.0

    def __len__(self) -> int:
        return len(self._waiting)

    def __iter__(self) -> Iterator[Ticket]:
        """Those that wait, in the order in which they would be taken."""
        return iter(sorted(self._waiting, key=lambda ticket: ticket.tag))

    def tag(self, client: str) -> float:
        """The virtual time from which a request of this client counts that comes now."""
        return max(self._now, self._paid.get(client, 0.0))

    def add(self, ticket: Ticket) -> None:
        """Puts a ticket, tagged by `tag`, into the queue; its client is charged what it is expected to cost."""
        self._waiting.append(ticket)
        self._paid[ticket.demand.client.name] = ticket.tag + ticket.expected_s

    def take(self, fits: Callable[[Ticket], bool]) -> Ticket | None:
        """The ticket that is next among those that `fits` accepts, taken out; of equal ones the one that came first."""
        found = min(filter(fits, self._waiting), key=lambda ticket: ticket.tag, default=None)
        if found is not None:
            self._waiting.remove(found)
            self._now = max(self._now, found.tag)
        return found

    def put_back(self, ticket: Ticket) -> None:
        """Puts a ticket that was taken into the queue again, where it was: its client is charged already."""
        self._waiting.append(ticket)

    def remove(self, ticket: Ticket) -> None:
        """Takes out a ticket whose request is not wanted any more; its client gets back what it was charged."""
        self._waiting.remove(ticket)
        self.settle(ticket, 0.0)

    def settle(self, ticket: Ticket, cost_s: float) -> None:
        """Charges the client of a ticket what its request has cost, s, in place of what was expected."""
        name = ticket.demand.client.name
        self._paid[name] = self._paid.get(name, ticket.tag + ticket.expected_s) + cost_s - ticket.expected_s
        # whoever is paid up is tagged with the present time, as one who is not known: nothing need be kept of them
        self._paid = {name: paid for name, paid in self._paid.items() if paid > self._now}
