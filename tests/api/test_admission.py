"""Who is let in, in which order, and when the others are told to come again: the books alone, with their own clock."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.api.problems import Problem
from assur.api.workers.admission import FIRST_SHARE, Admission, Places
from assur.api.workers.client import Client, Demand, Ticket

GREEDY, MODEST = Client("greedy"), Client("modest")
PLACES = Places(workers=2, short=1, waiting=100, wait_s=1e9)


@dataclass
class Service:
    """The books, and workers that take exactly as long as they are told to."""

    places: Places = PLACES
    now: float = 0.0
    working: dict[int, Ticket] = field(default_factory=dict)
    ended: list[Ticket] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.books = Admission(self.places, self.free, lambda: self.now)

    def free(self) -> set[int]:
        return set(range(self.places.workers + self.places.simulations)) - self.working.keys()

    def post(
        self, client: Client, wall_s: float = 10.0, *, short: bool = False, kind: str = "plan", simulation: bool = False
    ) -> Ticket:
        ticket = self.books.enter(Demand(client, wall_s, short, kind, simulation))
        self.hand_out()
        return ticket

    def refused(self, client: Client, **demand: Any) -> Problem:
        with pytest.raises(Problem) as caught:
            self.post(client, **demand)
        return caught.value

    def hand_out(self) -> None:
        for lend in (False, True):
            for number in sorted(self.free()):
                ticket = self.books.next(number, lend=lend)
                if ticket is not None:
                    self.working[number] = ticket

    def put_back(self, ticket: Ticket) -> None:
        self.working = {number: each for number, each in self.working.items() if each is not ticket}
        self.books.put_back(ticket)
        self.hand_out()

    def end(self, ticket: Ticket, after_s: float = 0.0) -> None:
        self.now += after_s
        self.working = {number: each for number, each in self.working.items() if each is not ticket}
        self.books.leave(ticket)
        self.ended.append(ticket)
        self.hand_out()


def names(tickets: list[Ticket]) -> list[str]:
    return [ticket.demand.client.name for ticket in tickets]


def test_whoever_asks_for_little_waits_behind_one_request_of_whoever_asks_for_much() -> None:
    service = Service(replace(PLACES, workers=1, short=0))
    for _ in range(10):
        service.post(GREEDY)
    service.post(MODEST)
    while service.working:
        (ticket,) = service.working.values()
        service.end(ticket, 10.0)
    assert names(service.ended).index("modest") <= 2


def test_two_clients_that_ask_for_as_much_are_served_in_turn() -> None:
    service = Service(replace(PLACES, workers=1, short=0))
    for client in [GREEDY] * 6 + [MODEST] * 6:
        service.post(client)
    while service.working:
        (ticket,) = service.working.values()
        service.end(ticket, 1.0)
    order = names(service.ended)
    assert {tuple(order[k : k + 2]) for k in range(2, 10, 2)} <= {("greedy", "modest"), ("modest", "greedy")}


def test_nobody_saves_anything_up_while_away() -> None:
    service = Service(replace(PLACES, workers=1, short=0))
    for _ in range(3):
        service.end(service.post(GREEDY), 100.0)
    waiting = [service.post(client) for client in (GREEDY, GREEDY, MODEST, MODEST)]
    while service.working:
        (ticket,) = service.working.values()
        service.end(ticket, 1.0)
    assert names(service.ended[3:]).count("modest") == 2
    assert names(service.ended[3:5]).count("modest") >= 1
    assert all(not ticket.held for ticket in waiting)


def test_long_requests_give_back_the_workers_that_are_kept_for_short_ones() -> None:
    service = Service()
    first, second, third = (service.post(GREEDY) for _ in range(3))
    assert service.working == {0: second, 1: first}
    borrower, other = second, first
    assert service.books.recall() is None
    short = service.post(MODEST, 1.0, short=True)
    assert service.books.recall() is borrower
    assert service.books.recall() is None  # it is on its way
    service.put_back(borrower)
    assert service.working == {0: short, 1: other}
    service.end(short)
    assert service.working == {0: third, 1: other}  # who gave it back once does not take it again
    service.post(MODEST, 1.0, short=True)
    assert service.books.recall() is third
    service.end(other)
    assert service.working[1] is borrower


def test_no_worker_is_asked_for_by_a_client_that_may_not_have_it() -> None:
    service = Service()
    limited = Client("limited", running=1)
    service.post(limited, 1.0, short=True)
    service.post(GREEDY)
    service.post(limited, 1.0, short=True)
    assert service.books.recall() is None


def test_short_requests_take_every_worker() -> None:
    service = Service()
    tickets = [service.post(MODEST, 1.0, short=True) for _ in range(3)]
    assert set(service.working.values()) == set(tickets[:2])


def test_a_client_is_worked_for_as_often_at_a_time_as_it_may_and_others_pass_it() -> None:
    service = Service()
    limited = Client("limited", running=1)
    first, second = (service.post(limited, 1.0, short=True) for _ in range(2))
    other = service.post(MODEST, 1.0, short=True)
    assert set(service.working.values()) == {first, other}
    service.end(other)
    assert set(service.working.values()) == {first}
    service.end(first)
    assert set(service.working.values()) == {second}


def test_who_has_waited_for_its_own_limit_does_not_let_newcomers_pass() -> None:
    service = Service(replace(PLACES, short=0))
    first, second = (service.post(Client("limited", running=1)) for _ in range(2))
    for ticket in [service.post(GREEDY) for _ in range(5)][:4]:
        service.end(ticket, ticket.expected_s)
    early = service.post(MODEST)
    service.end(first)
    service.post(Client("late"))
    service.end(second)
    assert early in service.working.values()


def test_one_request_more_than_may_wait_is_told_when_the_next_begins() -> None:
    service = Service(replace(PLACES, workers=1, short=0, waiting=1))
    service.end(service.post(MODEST), 10.0)  # what is learnt: they take more than was expected
    for _ in range(30):
        service.end(service.post(MODEST), 10.0)
    service.post(MODEST)
    service.post(GREEDY)
    service.now += 4.0
    problem = service.refused(MODEST)
    assert problem.kind == "busy"
    assert int(problem.headers["Retry-After"]) == 6


def test_one_request_more_of_a_client_than_may_wait_is_its_own_matter() -> None:
    service = Service(replace(PLACES, workers=1, short=0))
    greedy = replace(GREEDY, waiting=2)
    for _ in range(3):
        service.post(greedy)
    problem = service.refused(greedy)
    assert problem.kind == "too-many-requests"
    assert problem.status == 429
    assert int(problem.headers["Retry-After"]) >= 1
    service.post(MODEST)


def test_a_client_that_may_not_wait_is_served_while_a_worker_is_free() -> None:
    service = Service(replace(PLACES, workers=1, short=0))
    impatient = Client("impatient", waiting=0)
    ticket = service.post(impatient)
    assert service.refused(impatient).kind == "too-many-requests"
    service.end(ticket)
    service.post(impatient)


def test_a_request_that_would_wait_too_long_is_refused_when_it_comes() -> None:
    service = Service(replace(PLACES, workers=1, short=0, wait_s=25.0))
    for _ in range(40):
        service.end(service.post(MODEST), 10.0)
    for _ in range(3):
        service.post(MODEST)  # the last is expected to begin after 20 s
    problem = service.refused(MODEST)
    assert problem.kind == "busy"
    assert "30 s" in problem.detail
    assert int(problem.headers["Retry-After"]) == 5
    service.now += 5.5
    service.post(MODEST)


def test_what_is_quick_although_it_might_be_slow_is_let_in() -> None:
    service = Service(replace(PLACES, workers=1, short=0, wait_s=25.0))
    for _ in range(40):
        service.end(service.post(MODEST, 60.0), 0.1)
    for _ in range(90):
        service.post(MODEST, 60.0)
    assert service.books.waiting == 89
    assert service.books.owed_s < 25.0


def test_a_client_pays_with_seconds_of_workers_and_gets_new_ones_each_minute() -> None:
    service = Service(replace(PLACES, workers=1, short=0))
    poor = Client("poor", seconds=30.0)
    service.end(service.post(poor), 40.0)  # it had 30, and got none while they were full
    assert service.books.owed_s == 0.0
    problem = service.refused(poor)
    assert problem.kind == "too-many-requests"
    assert "30 s of workers a minute" in problem.detail
    after = int(problem.headers["Retry-After"])
    assert after == 20  # 10 s too many, at 0.5 s each second
    service.post(MODEST)
    service.now += after + 0.1
    service.post(poor)


def test_a_request_that_is_given_up_while_it_waits_costs_nothing() -> None:
    service = Service(replace(PLACES, workers=1, short=0))
    first, second = service.post(GREEDY), service.post(GREEDY)
    service.end(second)
    assert service.books.waiting == 0
    third = service.post(GREEDY)
    assert third.tag == second.tag > first.tag
    service.end(third)
    service.end(first)
    service.end(first)
    assert service.books.running == 0
    assert not service.working


def test_before_anything_was_seen_little_is_expected() -> None:
    service = Service()
    assert service.post(MODEST, 50.0).expected_s == pytest.approx(50.0 * FIRST_SHARE)


@given(
    st.lists(
        st.tuples(st.sampled_from("abc"), st.floats(0.01, 60.0), st.booleans(), st.floats(0.0, 1.0), st.integers(0, 5)),
        max_size=60,
    )
)
def test_whatever_comes_everyone_is_served_and_the_books_end_empty(
    demands: list[tuple[str, float, bool, float, int]],
) -> None:
    """Every forecast is finite, nothing is served twice, and what is borrowed can be had back."""
    service = Service(replace(PLACES, workers=3, waiting=20))
    clients = {name: Client(name, running=2, waiting=6, seconds=40.0) for name in "abc"}
    accepted, refused = [], []
    for name, wall_s, short, share, ends in demands:
        try:
            accepted.append(service.post(clients[name], wall_s, short=short))
        except Problem as problem:
            refused.append(problem)
        for number in list(service.working)[:ends]:
            ticket = service.working[number]
            service.end(ticket, share * ticket.demand.wall_s)
        recalled = service.books.recall()
        if recalled is not None:
            service.put_back(recalled)
        assert all(
            ticket.borrows == (number == 0 and not ticket.demand.short) for number, ticket in service.working.items()
        )
    while service.working:
        service.end(next(iter(service.working.values())), 1.0)
    assert sorted(map(id, service.ended)) == sorted(map(id, accepted))
    assert (service.books.waiting, service.books.running, service.books.owed_s) == (0, 0, 0.0)
    assert {problem.kind for problem in refused} <= {"busy", "too-many-requests"}
    assert all(1 <= int(problem.headers["Retry-After"]) <= 3600 for problem in refused)


def test_simulations_take_no_worker_of_plans_and_no_place_where_plans_wait() -> None:
    service = Service(replace(PLACES, waiting=1, simulations=1))
    first, second = (service.post(GREEDY, simulation=True) for _ in range(2))
    assert service.working == {2: first}
    assert service.refused(MODEST, simulation=True).kind == "busy"
    plans = [service.post(GREEDY) for _ in range(3)]
    assert service.working == {0: plans[1], 1: plans[0], 2: first}
    assert service.refused(MODEST).kind == "busy"
    service.end(first)
    assert service.working[2] is second
    service.end(plans[0])
    assert service.working[1] is plans[2]


def test_a_plan_takes_no_worker_for_simulations_and_what_these_cost_does_not_delay_it() -> None:
    service = Service(replace(PLACES, workers=1, short=0, simulations=1))
    service.post(GREEDY, 600.0, simulation=True)
    running, own, other = service.post(MODEST), service.post(GREEDY), service.post(MODEST)
    assert service.working[0] is running
    service.end(running, 1.0)
    assert service.working[0] is own
    service.end(own, 1.0)
    assert service.working[0] is other


def test_a_simulation_waits_however_long_the_one_before_it_takes_and_no_plan_does() -> None:
    service = Service(replace(PLACES, workers=1, short=0, waiting=2, wait_s=30.0, simulations=1))
    long, next_one, last = (service.post(MODEST, 6000.0, simulation=True) for _ in range(3))
    refused = service.refused(MODEST, wall_s=6000.0, simulation=True)
    assert refused.kind == "busy"
    assert int(refused.headers["Retry-After"]) > 30
    service.post(MODEST, 6000.0)
    assert service.refused(MODEST, wall_s=6000.0).kind == "busy"
    service.end(long, 600.0)
    assert service.working[1] is next_one
    service.end(next_one, 600.0)
    assert service.working[1] is last
