"""Checks claims without trusting who made them, and proofs of refusals.

`assur.planner.checked` is the entry for plans.
"""

from __future__ import annotations

from assur.planner.checker.verdict import Code, Finding, Verdict

__all__ = ["Code", "Finding", "Verdict"]
