"""Checks plans without trusting who made them: `check(scene, plan)`."""

from assur.planner.checker.check import check
from assur.planner.checker.verdict import Code, Finding, Verdict

__all__ = ["Code", "Finding", "Verdict", "check"]
