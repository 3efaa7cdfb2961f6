"""What a compiled kernel would bring: the hot functions of the planner once more, compiled by numba.

They are put in place of the originals in the experiment's process only, and measured against them. The planner itself
stays NumPy; nothing of it imports this.
"""
