"""Who is let in, and when the others should come again: the books of what is waited for and what is worked on.

What a request will take is expected from what those before it took of the time that they might have taken. So a
long queue of quick requests differs from a short one of slow requests, and a request that would wait longer than the
service lets it wait is refused when it comes, not when it has waited.

Each client gets the same share of the workers' time, by start-time fair queueing (Goyal, Vin, Cheng 1996): a request is
tagged with the virtual time at which its client's earlier ones have been paid for, or with the present virtual time if
that is later; the least tag is next. A client that asks for much waits behind itself, not before others, and saves
nothing up while it is away. Costs and virtual times are seconds of a worker. Simulations have workers of their own, and
are queued apart: what they cost delays no plan of their client. Their clients hold no connection, so a simulation waits
until it is its turn.
"""

from __future__ import annotations

import heapq
import math
import time
from collections.abc import Callable
from dataclasses import dataclass

from assur.api.problems import Problem
from assur.api.workers.client import Client, Demand, Ticket

FIRST_SHARE = 0.1
"""So much of the time that it might take a request is expected to take, before any was seen."""
NEWS = 0.2
"""Weight of the last request in what is expected of the next."""
LONGEST_S = 3600.0
"""Longest time after which a client is to come again, s."""


@dataclass(frozen=True, slots=True)
class Places:
    """How many workers there are, and how many of these take only short requests; how many requests may wait, and for
    how long, s. `simulations`: so many further workers take simulations and nothing else."""

    workers: int
    short: int
    waiting: int
    wait_s: float
    simulations: int = 0


class Admission:
    """The tickets of one service: those that wait, and those that are worked on.

    Workers have numbers; the first `places.short` of them are kept for short requests. A long one may borrow such a
    worker while no short one waits, and gives it back when one does: then it waits again, and borrows none any more.
    Those behind the first `places.workers` are for simulations. `free` says which workers could begin now.
    """

    def __init__(
        self, places: Places, free: Callable[[], set[int]], clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._places = places
        self._free = free
        self._clock = clock
        self._waiting: list[Ticket] = []
        # virtual time until which the requests of a client have been paid for: those for simulations, and the others
        self._paid: dict[tuple[str, bool], float] = {}
        self._virtual_s = {False: 0.0, True: 0.0}
        self._running: dict[Ticket, int] = {}
        self._shares: dict[str, float] = {}
        self._balances: dict[str, tuple[float, float]] = {}

    @property
    def waiting(self) -> int:
        """How many requests wait for a worker."""
        return len(self._waiting)

    @property
    def running(self) -> int:
        """How many requests are worked on."""
        return len(self._running)

    @property
    def owed_s(self) -> float:
        """How many seconds of workers the requests are expected to take that were accepted."""
        return sum(t.expected_s for t in self._waiting) + sum(self._left_s(t) for t in self._running)

    def require_room(self, client: Client, *, simulation: bool = False) -> None:
        """Raises the `Problem` that a request of this client would meet, whatever it asks for: its body need not be
        read."""
        self._require_balance(client)
        self._require_place(client, simulation=simulation)

    def enter(self, demand: Demand) -> Ticket:
        """Accepts a request: it waits. Raises `Problem`: too-many-requests, busy."""
        self._require_balance(demand.client)
        self._require_place(demand.client, simulation=demand.simulation)
        expected_s = demand.wall_s * self._share(demand)
        account = _account(demand)
        tag = max(self._virtual_s[demand.simulation], self._paid.get(account, 0.0))
        ticket = Ticket(demand, expected_s, tag, self._clock())
        start, _ = self._forecast(ticket)[ticket] if self._running or self._waiting else (0.0, 0.0)
        if start > self._places.wait_s and not demand.simulation:
            raise busy(
                start - self._places.wait_s,
                f"It would wait {start:.0f} s for a worker, and at most {self._places.wait_s:g} s are allowed.",
            )
        self._waiting.append(ticket)
        self._paid[account] = tag + expected_s
        return ticket

    def next(self, number: int, *, lend: bool) -> Ticket | None:
        """The ticket that worker `number`, which is free, is to be given now; it is worked on from now on. `lend`: such
        a worker may be lent to a long one. Ask first without: a worker for all may be free."""
        kept = number < self._places.short

        def fits(ticket: Ticket) -> bool:
            suits = ticket.demand.short or not kept or (lend and not ticket.recalled)
            return suits and self._suits(number, ticket.demand.simulation) and self._may_run(ticket.demand.client)

        ticket = min(filter(fits, self._waiting), key=lambda each: each.tag, default=None)
        if ticket is not None:
            self._waiting.remove(ticket)
            kind = ticket.demand.simulation
            self._virtual_s[kind] = max(self._virtual_s[kind], ticket.tag)
            ticket.begun, ticket.borrows = self._clock(), kept and not ticket.demand.short
            self._running[ticket] = number
        return ticket

    def recall(self) -> Ticket | None:
        """The ticket that must give back the worker that it has borrowed, if a short request waits for one: of several
        the one that began last."""
        if not self._waiting:
            return None
        wanted = sum(ticket.demand.short and self._may_run(ticket.demand.client) for ticket in self._waiting)
        if wanted <= sum(ticket.borrows and ticket.recalled for ticket in self._running):
            return None
        borrowers = [ticket for ticket in self._running if ticket.borrows and not ticket.recalled]
        found = max(borrowers, key=lambda ticket: ticket.begun or 0.0, default=None)
        if found is not None:
            found.recalled = True
        return found

    def _suits(self, number: int, simulation: bool) -> bool:
        """Whether worker `number` is for simulations, or for the others, as the request is."""
        return (number >= self._places.workers) == simulation

    def _may_run(self, client: Client) -> bool:
        """Whether one more request of a client may be worked on."""
        if math.isinf(client.running):
            return True
        return sum(ticket.demand.client.name == client.name for ticket in self._running) < client.running

    def put_back(self, ticket: Ticket) -> None:
        """Has a ticket wait again that has given back its worker. Its client does not pay for what was in vain."""
        del self._running[ticket]
        ticket.begun, ticket.borrows = None, False
        self._waiting.append(ticket)  # where it was, by its tag; its client is charged already

    def leave(self, ticket: Ticket) -> None:
        """Ends a ticket, wherever it is; one that has ended stays so. Its client pays for the time that it took."""
        if not ticket.held:
            return
        ticket.held = False
        if ticket.begun is None:
            self._waiting.remove(ticket)
            self._settle(ticket, 0.0)
            return
        del self._running[ticket]
        took_s, demand = self._clock() - ticket.begun, ticket.demand
        self._settle(ticket, took_s)
        share = min(1.0, took_s / demand.wall_s) if demand.wall_s > 0.0 else 0.0
        self._shares[demand.kind] = self._share(demand) + NEWS * (share - self._share(demand))
        self.charge(demand.client, took_s)

    def _settle(self, ticket: Ticket, cost_s: float) -> None:
        """Charges the client of a ticket what its request has cost, s, in place of what was expected."""
        account = _account(ticket.demand)
        self._paid[account] = self._paid.get(account, ticket.tag + ticket.expected_s) + cost_s - ticket.expected_s
        # a client that owes nothing gets the present time as its tag, like an unknown client: nothing is kept of it
        self._paid = {each: paid for each, paid in self._paid.items() if paid > self._virtual_s[each[1]]}

    def charge(self, client: Client, took_s: float) -> None:
        """Has a client pay for so many seconds of a worker, or of what else was done for it."""
        if math.isinf(client.seconds):
            return
        now = self._clock()
        self._balances[client.name] = self._balance(client) - took_s, now
        # a client that owes nothing and has sent nothing for a minute has all of its seconds again, as an unknown one
        self._balances = {
            name: (balance, at) for name, (balance, at) in self._balances.items() if balance < 0.0 or now - at < 60.0
        }

    def full(self, *, simulation: bool = False) -> Problem:
        """The problem of a request that finds no place to wait: one is free when the next of those that wait begins."""
        forecast = {each: when for each, when in self._forecast().items() if each.demand.simulation == simulation}
        starts = [start for ticket, (start, _) in forecast.items() if ticket.begun is None]
        ends = [end for ticket, (_, end) in forecast.items() if ticket.begun is not None]
        return busy(min(starts or ends, default=0.0), "All workers are busy, and the queue is full.")

    def _require_place(self, client: Client, *, simulation: bool) -> None:
        if self._may_run(client) and any(self._suits(number, simulation) for number in self._free()):
            return
        waiting = [ticket for ticket in self._waiting if ticket.demand.simulation == simulation]
        if len(waiting) >= self._places.waiting:
            raise self.full(simulation=simulation)
        own = [ticket for ticket in waiting if ticket.demand.client.name == client.name]
        if len(own) >= client.waiting:
            forecast = self._forecast()
            raise too_many(
                min((forecast[ticket][0] for ticket in own), default=1.0),
                f"{len(own)} requests of this client wait already, and {client.waiting:g} may.",
            )

    def _require_balance(self, client: Client) -> None:
        if math.isinf(client.seconds):
            return
        balance, per_second = self._balance(client), client.seconds / 60.0
        if balance <= 0.0:
            raise too_many(-balance / per_second, f"This client has used its {client.seconds:g} s of workers a minute.")

    def _balance(self, client: Client) -> float:
        """How many seconds of workers a client may still use, s; what it has not used for a minute is lost."""
        now = self._clock()
        balance, at = self._balances.get(client.name, (client.seconds, now))
        return min(client.seconds, balance + (now - at) * client.seconds / 60.0)

    def _share(self, demand: Demand) -> float:
        """What part of the time that it might take a request of this kind is expected to take."""
        return self._shares.get(demand.kind, FIRST_SHARE)

    def _left_s(self, ticket: Ticket) -> float:
        """How long a request that is worked on is expected to go on, s."""
        begun = self._clock() if ticket.begun is None else ticket.begun
        elapsed = self._clock() - begun
        later = self._share(ticket.demand) * (ticket.demand.wall_s - elapsed)
        return max(ticket.expected_s - elapsed, later, 0.0)

    def _forecast(self, *more: Ticket) -> dict[Ticket, tuple[float, float]]:
        """When each request is expected to begin and to end, s from now; `more`: as if they waited, too."""
        found: dict[Ticket, tuple[float, float]] = {}
        ends: dict[str, list[float]] = {}
        busy_until = dict.fromkeys(range(self._places.workers + self._places.simulations), 0.0)
        for ticket, number in self._running.items():
            end = busy_until[number] = self._left_s(ticket)
            found[ticket] = 0.0, end
            ends.setdefault(ticket.demand.client.name, []).append(end)
        ends_of = [*busy_until.values()]
        short, any_ = ends_of[: self._places.short], ends_of[self._places.short : self._places.workers]
        simulations = ends_of[self._places.workers :]
        for heap in (short, any_, simulations, *ends.values()):
            heapq.heapify(heap)
        for ticket in sorted((*self._waiting, *more), key=lambda ticket: ticket.tag):
            lent = ticket.demand.short or not ticket.recalled
            heap = short if lent and short and (not any_ or short[0] <= any_[0]) else any_
            heap = simulations if ticket.demand.simulation else heap
            own = ends.setdefault(ticket.demand.client.name, [])
            start = heap[0]
            if len(own) >= ticket.demand.client.running:
                start = max(start, heapq.heappop(own))
            end = start + ticket.expected_s
            heapq.heapreplace(heap, end)
            heapq.heappush(own, end)
            found[ticket] = start, end
        return found


def _account(demand: Demand) -> tuple[str, bool]:
    """Who pays for a request, and for which kind of worker."""
    return demand.client.name, demand.simulation


def busy(after_s: float, why: str) -> Problem:
    """The problem of a request for which there is no worker; it may be sent again after a time, s."""
    return _again("busy", after_s, why)


def too_many(after_s: float, why: str) -> Problem:
    """The problem of a client that has used its share; it may come again after a time, s."""
    return _again("too-many-requests", after_s, why)


def _again(kind: str, after_s: float, why: str) -> Problem:
    after = math.ceil(min(max(after_s, 1.0), LONGEST_S))
    return Problem(kind, f"{why} Come again in {after} s.", again_s=after)
