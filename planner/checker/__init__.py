"""Checks plans without trusting who made them: `check(scene, plan)`."""

from planner.checker.check import check
from planner.checker.verdict import Code, Finding, Verdict

__all__ = ["Code", "Finding", "Verdict", "check"]
