"""Margins of a plan, and the sentences that tell an outcome."""
