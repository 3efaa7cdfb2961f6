"""The client of a request, and how much of the service is theirs."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf


@dataclass(frozen=True, slots=True)
class Client:
    """One client: the holder of a key, or all who use one address.

    `name`: for the books and the log. `running` and `waiting`: so many of its requests are worked on, and wait, at a
    time; inf: no limit of its own. `seconds`: so many seconds of workers are its own each minute.
    """

    name: str
    running: float = inf
    waiting: float = inf
    seconds: float = inf


@dataclass(frozen=True, slots=True)
class Demand:
    """What a request asks of the workers. `wall_s`: after so long its worker is killed, s. `short`: it may use the
    workers that are kept for requests with small budgets. `kind`: what one of a kind took is expected of the next.
    `simulation`: it is one, and uses the workers for simulations and no others."""

    client: Client
    wall_s: float
    short: bool
    kind: str
    simulation: bool = False


@dataclass(eq=False, slots=True)
class Ticket:
    """A request that has been accepted: it waits for a worker, has one, or has ended.

    Times are of a monotonic clock, s; `begun` is None while it waits. `tag`: its place in the fair queue. `expected_s`:
    how long it is expected to take, s.
    """

    demand: Demand
    expected_s: float
    tag: float
    entered: float
    begun: float | None = None
    held: bool = True
    borrows: bool = False
    """It is worked on by a worker that is kept for short requests, though it is none."""
    recalled: bool = False
    """It had to give such a worker back, and takes none again."""

    @property
    def waited_s(self) -> float:
        """How long it waited for a worker, s; of one that still waits, nothing yet."""
        return 0.0 if self.begun is None else self.begun - self.entered
