"""Ways round what blocks the direct one: drawn by dozens, looked at roughly in one batch; the best are tried.

free vias ─► prospects (drawn, varied) ─► rough motions ─► a glance (how much in the way, how late) ─► population
"""
