"""Numbers that tune how candidates are sampled, scored and chosen. None of them decides what is accepted as a plan."""

from __future__ import annotations

TRACKING_EFFORTS = (1.0, 1.0, 0.7, 0.4)
"""Shares of the limits that tracking legs at a point use."""
STOPS = 0.3
"""How often the tool stops behind a depart although it need not."""
THROUGH_PACES = (0.7, 0.0)
"""Paces at which a via control point is passed in the first batch."""
DIRECT, ONE_VIA, TWO_VIAS = 0.5, 1.6, 1.6
"""Weights of candidates without, with one and with two vias. Without one there must be a wait, or a later meeting."""
TOWARDS = 0.45
"""Share of candidates that lead to the first option, of the rest that lead to the second, and so on."""

EVALUATED = (64, 96, 128)
"""Candidates that are scored in the first rounds from a partial plan, and in all later ones: the first react sooner."""
MOST_ROWS = 200_000
"""Candidates of a round × instants of each × pairs of bodies, about: in large cells fewer are scored ..."""
FEWEST = 16
"""... but never fewer than this."""
KEPT = 64
"""Candidates that are remembered."""
FREE = 0.005
"""With this score or less a candidate counts as free. Such direct ways and arches are tried before vias are drawn."""
LATER = 2
"""Rounds of candidates by vias before direct ways and arches are tried that seem to be in the way of something."""
PARENTS = 24
"""The best of them are varied."""
VARIED = 0.5
"""Share of a round that are variations, once there is something to vary."""
NEARLY_FREE = 0.06
"""A candidate with this score or less may be free: so few instants say little, and rough motions are rough."""
CHECKED = 32
"""Candidates of a round that may be free and are evaluated at `FINE` instants, at most."""
TRIED = 8
"""Candidates of a round that are timed, at most."""

INSTANTS = 12
"""Times at which the rough motion of each candidate is evaluated,"""
FINE, WAITING = 56, 8
"""and those of the motion and of the wait of one that may be free, before it is timed: that costs ten times as much."""
GIVEN_UP = 1.5
"""A candidate that is in the way of something at more of them, or about as many, is not evaluated at the others."""
REMEMBERED = 6
"""Times at which candidates that had seemed free were found not to be; they are evaluated as well ..."""
APART_S = 0.01
"""... if they are this far apart, s."""
DEPTH_M = 0.05
"""What is deeper than this in something counts as so deep, m: how deep a large body is entered says little."""

LEAST_RISE_M = 1e-3
"""Over its ends an arch rises by so much at least, m."""
ARCH_CORNERS = (0.5, 1.0)
"""Corners of an arch that are tried first: half overlapped, stopped at; full overlap where the tool does not stop above
its point: 0."""
ARCHED = 2
"""Options to which arches are tried first."""
BATCH = 12
"""Arches in a batch, where an arch is required, or waits before a straight leg."""
FILLED = 3
"""Batches of candidates through vias that are smaller are filled up with arches, and to larger ones ..."""
ARCHES_TOO = 0.3
"""... one is added this often."""
ARCH_WAITS = 0.25
"""How often an arch waits first."""
ELITE = 6
"""Best arches that are varied."""
CORNER_NUDGE = 0.15
"""Spread of the corners of a varied arch."""
ANY_OPTION = 0.45
"""An arch or a wait leads to each option this often, of those that the options before it left over."""
EVALUATED_MEETINGS = 300
"""Meeting times, about, at which a lower bound of the duration orders the options."""

BEAM = 4
"""Partial plans of one length that are continued in a round."""
KEPT_PLANS = 12
"""Partial plans of one length that are remembered: the beam, and those of other modes."""
PROVED_A_BATCH = 3
"""Candidates proved in one batch, after which the others, which end later, are left alone; 1 with `stop: first`."""
MOST_OPTIONS = 12
"""Options to meet a control point that are kept, the quickest; one a pitch where the pitch is free."""
SHARE_OF_A_TURN = 0.01
"""A turn of the wrist is worth this share of a duration: of two options of the same duration the one that turns less
comes first."""
SAME_DURATION = 0.01
"""Durations that differ by this share count as equal: of such plans that with less travel of the wrist is better ..."""
ROUNDING_S = 1e-9
"""A plan that ends sooner by no more than this, s, is no better: the first that was found stays."""
SAME_TRAVEL = 1e-3
"""... if that differs by more than this, rad."""
ANY_YAW = 8
"""Yaws that are tried where a control point leaves the yaw free."""
