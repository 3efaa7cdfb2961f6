"""Source 000, figure 4: time to solve the RRR dyad in four formulations, one dyad at a time and in batches.

The source's comparison, again: 100 repeats, natural coordinates from the solution plus Gaussian noise and restarted
until they land on the same assembly. It prints neither its code nor the spread of the noise, and ran in Matlab; so
the spread is varied, and the linear systems of the other two formulations are solved both by Cramer's rule and by
the general solver that Matlab's backslash is.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from assur.experiments import dyad_race as race
from assur.experiments.experiment import Drawing, Result, paragraphs
from assur.experiments.figures import BLUE, GREEN, INK, ORANGE, RED, SKY
from assur.planner.arrays import FloatArray

CLAIMED = {"relative": 0.45, "natural": 0.17}
"""Time of the Assur form as a share of the other's, in the source."""
NOTE: dict[str, Any] = {
    "textcoords": "offset points",
    "fontsize": 7,
    "bbox": {"boxstyle": "square,pad=0.1", "fc": "w", "ec": "none", "alpha": 0.85},
    "zorder": 5,
}


def run() -> Result:
    """All comparisons. Timings are this machine's; everything else is the same at every run."""
    given = race.dyads(race.BATCHES[-1])
    times, tried, worst = race.one_by_one(given)
    batches, batch_starts = race.in_batches(given)
    spread_s, spread_starts = race.by_spread(given)
    median = {name: float(np.median(row)) for name, row in times.items()}
    shares = {name: median["printed"] / median[name] for name in median if name[:3] in ("rel", "nat")}
    solved = {name: (shares[name], shares[f"{name}, general"]) for name in CLAIMED}
    mean = {name: float(np.mean(row)) for name, row in times.items()}
    mean_shares = {name: mean["printed"] / mean[name] for name in shares}
    ours = {name: median["vector"] / median[name] for name in median if name != "vector"}
    batch_shares = {
        name: float(batches["printed"][-1] / batches[name][-1]) for name in ("relative", "natural", "kernel")
    }

    between = [min(ends) <= CLAIMED[name] <= max(ends) for name, ends in solved.items()]
    place = (
        "Neither of the paper's numbers lies",
        "One of the paper's numbers lies",
        "Both of the paper's numbers lie",
    )

    numbers = {
        "repeats": race.REPEATS,
        "guess_spread_of_l1": race.SPREAD,
        "largest_relative_difference_from_vector_form": worst,
        "starts_until_same_solution_mean": float(tried.mean()),
        "starts_until_same_solution_most": int(tried.max()),
        "starts_mean_in_largest_batch": batch_starts,
        "spreads_of_l1": list(race.SPREADS),
        "starts_mean_by_spread": spread_starts.tolist(),
        "claimed_share_of_time": CLAIMED,
        "timings": {
            "median_us": {name: 1e6 * value for name, value in median.items()},
            "printed_as_share_of": shares,
            "printed_as_share_of_by_means": mean_shares,
            "vector_as_share_of": ours,
            "batch_sizes": list(race.BATCHES),
            "batch_us_per_dyad": {name: (1e6 * row).tolist() for name, row in batches.items()},
            "printed_as_share_of_in_largest_batch": batch_shares,
            "printed_as_share_of_natural_by_spread": {
                name: (median["printed"] / row).tolist() for name, row in spread_s.items()
            },
        },
    }
    paragraph = paragraphs(
        "The source solves its dyad in 45 % of the time of relative coordinates and in 17 % of that of natural ones "
        "(its figure 4), in Matlab. It prints neither its code nor the spread of its guesses.",
        f"Panel (a), on plain floats, one dyad at a time, medians of {race.REPEATS} repeats: the printed equations "
        f"take {100 * shares['relative']:.0f} % of the time of relative coordinates whose two 2 × 2 systems are "
        f"solved by Cramer's rule, and {100 * shares['relative, general']:.0f} % with the library's general solver; "
        f"of natural coordinates {100 * shares['natural']:.0f} % and {100 * shares['natural, general']:.0f} % (by "
        f"means, which restarts draw out, {100 * mean_shares['natural']:.0f} % and "
        f"{100 * mean_shares['natural, general']:.0f} %). These start from a guess that spreads by {race.SPREAD:g} "
        f"l1, and needed {tried.mean():.2f} starts on average, at most {tried.max()}, to land on the same "
        f"assembly.\n\n"
        f"Panel (b), in batches of {race.BATCHES[-1]:,}: the planner's kernel takes "
        f"{1e9 * batches['kernel'][-1]:.0f} ns for a dyad, the printed form {1e9 * batches['printed'][-1]:.0f} ns, "
        f"relative coordinates {1e9 * batches['relative'][-1]:.0f} ns, natural ones "
        f"{1e9 * batches['natural'][-1]:.0f} ns. All formulations agree to {max(worst.values()):.0e} (relative), "
        f"natural coordinates being the farthest.",
        f"It depends on what is not printed. {place[sum(between)]} between those of the two solvers, panel (c): the "
        f"shares depend more on the code for the linear systems than on the formulation, for by Cramer's rule relative "
        f"coordinates take {1 / shares['relative']:.1f} times the time of the printed equations. The gain over natural "
        f"coordinates grows with the spread of the guess; they alone need luck, and their times scatter. "
        f"The vector form of this project takes {100 * ours['printed']:.0f} % of the time of the printed one, with the "
        f"same numbers.",
    )
    by_spread = {name: median["printed"] / row for name, row in spread_s.items()}
    return Result(numbers, paragraph, (7.2, 5.6), lambda figure: draw(figure, times, batches, by_spread, shares))


def draw(
    figure: Drawing,
    times: dict[str, FloatArray],
    batches: dict[str, FloatArray],
    by_spread: dict[str, FloatArray],
    shares: dict[str, float],
) -> None:
    """The source's figure 4, the same in arrays, and what the unstated spread of the guesses does."""
    upper, lower = figure.subfigures(2, 1, height_ratios=(1, 1))
    strips = upper.subplots()
    rows = (
        ("vector", "vector form (this project)", BLUE),
        ("printed", "Assur, printed (000)", GREEN),
        ("kernel", "planner's kernel, call of one", SKY),
        ("relative", "relative, Cramer's rule", ORANGE),
        ("relative, general", "relative, general solver", ORANGE),
        ("natural", "natural, Cramer's rule", RED),
        ("natural, general", "natural, general solver", RED),
    )
    jitter = np.linspace(-0.22, 0.22, race.REPEATS)
    for place, (name, _, colour) in enumerate(rows):
        strips.plot(1e6 * times[name], place + jitter, ".", ms=3, color=colour, alpha=0.6)
        middle = float(np.median(times[name])) * 1e6
        strips.plot([middle, middle], [place - 0.36, place + 0.36], color=INK, lw=1.4)
        strips.annotate(f"{middle:.1f}", (middle, place), (0, 10), textcoords="offset points", ha="center", fontsize=7)
    strips.set_xscale("log")
    strips.xaxis.set_major_formatter("{x:g}")
    strips.set_yticks(range(len(rows)), [label for _, label, _ in rows])
    strips.set_ylim(len(rows) - 0.4, -0.8)
    strips.grid(axis="y", visible=False)
    strips.set_xlabel(f"time of a solution [µs], one at a time; {race.REPEATS} repeats, bar: median")
    strips.set_title("(a) figure 4 of 000 again: position, velocity, acceleration of one dyad")
    batch, spread = lower.subplots(1, 2)
    for name, colour, mark, label in (
        ("natural", RED, "^:", "natural, Cramer's rule"),
        ("relative", ORANGE, "s--", "relative, Cramer's rule"),
        ("printed", GREEN, "D-.", "Assur, printed"),
        ("kernel", BLUE, "o-", "planner's kernel (vector form)"),
    ):
        batch.loglog(race.BATCHES, 1e6 * batches[name], mark, color=colour, lw=1, label=label)
    batch.set_ylim(0.01, 2000)
    for axis in (batch.xaxis, batch.yaxis):
        axis.set_major_formatter("{x:,g}")
    batch.set_xlabel("dyads in a batch")
    batch.set_ylabel("time of a dyad [µs]")
    batch.legend(loc="upper right")
    batch.set_title("(b) in arrays")
    for name, way, mark in (("natural", "Cramer's rule", "o-"), ("natural, general", "general solver", "s-")):
        spread.loglog(race.SPREADS, 100 * by_spread[name], mark, color=RED, lw=1)
        spread.annotate(f"natural, {way}", (0.009, 100 * by_spread[name][0]), (0, -13), color=RED, **NOTE)
    for name, colour, key in (("relative", ORANGE, "relative"), ("natural", RED, "natural")):
        claim = 100 * CLAIMED[key]
        spread.axhline(claim, color=colour, lw=1, ls="--")
        spread.annotate(f"the paper, {name}: {claim:.0f} %", (3.3, claim), (0, 3), ha="right", color=colour, **NOTE)
    for name, way, place in (("relative", "Cramer's rule", 3), ("relative, general", "general solver", -9)):
        spread.axhline(100 * shares[name], color=ORANGE, lw=1)
        spread.annotate(f"relative, {way}", (0.009, 100 * shares[name]), (0, place), color=ORANGE, **NOTE)
    spread.set_ylim(1, 300)
    spread.xaxis.set_major_formatter("{x:g}")
    spread.yaxis.set_major_formatter("{x:g}")
    spread.set_xlim(0.008, 3.8)
    spread.set_xlabel("spread of the guess / $l_1$")
    spread.set_ylabel("time of Assur, printed / the other's [%]")
    spread.set_title("(c) what the unstated spread of the guess does")
