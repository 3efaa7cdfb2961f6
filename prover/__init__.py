"""The second checker: it shows what a proof bundle claims, with rigorous arithmetic, and imports nothing of ours."""
