"""The names of the rules, for readers of documents: no compiler is loaded for them."""

from __future__ import annotations

from typing import Literal, get_args

Rule = Literal["look-ahead", "fifo", "nearest", "spt", "edd"]
"""What a cell may name. `fifo`: the first that was seen. `nearest`: the nearest to the tool now, those within the
window first. `spt` (shortest processing time): the one whose cycle ends first. `edd` (earliest due date): the one that
leaves the window first. `look-ahead`: the one that begins the best order of a few."""
RULES: tuple[Rule, ...] = get_args(Rule)
